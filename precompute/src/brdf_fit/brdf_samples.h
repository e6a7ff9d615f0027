#pragma once

#include <vector>

#include "burnish/formats/measured_brdf.h"
#include "burnish/precompute/fit_brdf.h"
#include "burnish/sphere/direction.h"

namespace burnish {

/// Half vectors in cells of a polar grid whose angles are dense near the normal: angle(u) =
/// width sinh(u asinh(pi / 2 / width)), so that a narrow distribution has as many cells as a wide
/// one.
struct HalfVectorGrid {
  int angles = 0, azimuths = 0;
  double width = 0.5;  ///< radians: cells of less are even, those beyond grow with the angle

  int cells() const { return angles * azimuths; }
  double angle(double u) const;  ///< u of 0..1
  int cell_of(const Vector3d& half) const;
  Vector3d center(int cell) const;
  double solid_angle(int cell) const;
};

/// A pair of directions with its measured value, as a row of a least-squares problem.
struct BrdfPair {
  Vector3f outgoing, incoming;
  Rgb value;     ///< of f, sr^-1
  float weight;  ///< of f in the residual: root of the measure d outgoing d incoming, times the
                 ///< incoming cosine
  float cos_difference;
  int cell;  ///< of the half vector
};

/// Pairs, rising by cell.
struct BrdfSamples {
  HalfVectorGrid grid;
  std::vector<BrdfPair> pairs;
  std::vector<size_t> begin;     ///< of the pairs of a cell; one more at the end
  std::vector<Vector3d> center;  ///< of a cell; of irregular data, of the half vectors in it
  bool isotropic = false;
  bool irregular = false;      ///< pairs are the data's own, their half vectors not those of cells
  double max_bandwidth = 1e8;  ///< of a lobe: a narrower one falls between the half vectors
};

/// The pairs to fit to or to measure at.
struct BrdfSamplePlan {
  int resolution = 256;
  double max_angle_rad = 0;
  int pairs = 1 << 19;  ///< about so many, before those beyond the greatest angle are dropped
  double shift = 0;     ///< 0..1: another one gives other pairs
};

/// Regular data: at each cell's centre as half vector, difference vectors of an even sequence over
/// its hemisphere. Irregular data: its samples. Pairs without a value are left out.
BrdfSamples sample_brdf(const MeasuredBrdf& measured, const BrdfSamplePlan& plan);

/// Divides all values by the greatest, which is returned: squares of float neither overflow nor
/// vanish. Throws Error if there are no pairs or no value above 0.
double normalize_values(BrdfSamples& samples, const BrdfFitOptions& options);

}  // namespace burnish
