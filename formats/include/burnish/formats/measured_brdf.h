#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/direction.h"

namespace burnish {

/// Half vectors' distribution D(h) as a file tabulates it: bilinear over angle and azimuth.
struct TabulatedDistribution {
  int azimuths = 0;           ///< rows, >= 2; row j is the azimuth pi (2 j / (azimuths - 1) - 1)
  int angles = 0;             ///< columns, >= 2; column k is pi / 2 (k / (angles - 1))^2 from the z
  std::vector<float> values;  ///< [azimuths x angles], row by row, >= 0
};

/// D(h), of a unit half vector with h.z >= 0.
double eval_tabulated_distribution(const TabulatedDistribution& distribution, const Vector3d& half);

/// One measurement, directions in the local frame (z the normal), unit.
struct BrdfSample {
  Vector3f outgoing, incoming;
  Rgb value;  ///< sr^-1, >= 0
};

/// A BRDF as it was measured. A plain value; copies share their tables.
struct MeasuredBrdf {
  std::string format;                    ///< "RGL tensor", "MERL", "CSV"
  std::string description;               ///< for people, as the file has it; may be empty
  bool isotropic = false;                ///< unchanged when both directions turn about the normal
  float max_angle_rad = kPi<float> / 2;  ///< from the normal, of either direction: no data beyond
  /// Value for directions of the local frame (z the normal, unit), sr^-1, without the cosine; >= 0,
  /// or NaN in all channels where nothing was measured. 0 below the horizon. Safe to call from many
  /// threads.
  std::function<Rgb(const Vector3f& outgoing, const Vector3f& incoming)> eval;
  std::optional<TabulatedDistribution> distribution;  ///< where the file has one
  std::vector<BrdfSample> samples;                    ///< of irregular data, else empty
};

/// Reads a measured BRDF; the format is told by the file's first bytes, not by its name:
/// - RGL tensor files (dupuy2018adaptive), isotropic and anisotropic, of RGB or of spectra. A
///   spectrum becomes RGB such that a flat one is white.
/// - MERL (matusik2003data), nearest bin, as its own reader does.
/// - CSV of irregular samples (formats/FORMAT.md); between them: inverse squared distances to the
///   eight nearest, over half and difference vectors.
/// Throws Error for a file that is missing, truncated, broken, or of another kind; sizes are
/// checked against the file's before anything is allocated.
MeasuredBrdf read_measured_brdf(const std::string& path);

/// The same without a file: `subject` stands for the file's name in errors.
MeasuredBrdf parse_measured_brdf(std::string_view bytes, const std::string& subject);

}  // namespace burnish
