#pragma once

#include <vector>

#include "burnish/light/environment_map.h"
#include "harness/sample_sequence.h"

namespace burnish {

/// Draws directions of a lat-long environment, in its own frame, with a density proportional to the
/// luminance that eval_environment has there: a pixel by luminance times exact solid angle, then a
/// point of it evenly by solid angle. Keeps a reference to the map.
class EnvironmentSampler {
 public:
  /// `environment` is finite and >= 0 and outlives the sampler.
  explicit EnvironmentSampler(const Image& environment);

  /// True where the map is black: then there is nothing to draw.
  bool empty() const { return !(total_ > 0); }

  struct Sample {
    Vector3d direction;
    Rgb radiance;
    double pdf;  ///< per sr, > 0
  };
  /// Requires !empty().
  Sample sample(const Uniform2& uniform) const;

  /// Density of sample() at a direction, per sr.
  double pdf(const Vector3d& direction) const;
  /// The same where its radiance is at hand.
  double pdf_of_radiance(const Rgb& radiance) const;

 private:
  const Image& environment_;
  std::vector<double> row_end_;    // cumulative weight up to and with each row
  std::vector<double> pixel_end_;  // the same within each row
  double total_ = 0;
};

}  // namespace burnish
