#pragma once

#include <functional>
#include <span>
#include <vector>

#include "burnish/material/material.h"
#include "burnish/sphere/direction.h"

/// What depends on the view of a material, as a table: albedos, coefficients of a BRDF's slice.
namespace burnish {

/// Numbers by a view above the horizon, on a grid of heights and azimuths, linear in between.
class ViewTable {
 public:
  static constexpr int kHeights = 48;  ///< steps of the angle from the normal
  static constexpr int kAzimuths = 128;

  ViewTable() = default;
  /// `fill(outgoing, values)` writes the `size` numbers of a view; called in parallel.
  ViewTable(size_t size,
            const std::function<void(const Vector3f& outgoing, std::span<float> values)>& fill);

  size_t size() const { return size_; }
  size_t bytes() const { return values_.size() * sizeof(float); }
  bool empty() const { return values_.empty(); }

  /// `values` [size()] of a unit view, which counts as just above the horizon if it is below.
  void eval(const Vector3f& outgoing, std::span<float> values) const;

 private:
  const float* node(int height, int azimuth) const {
    return values_.data() + static_cast<size_t>(height * kAzimuths + azimuth % kAzimuths) * size_;
  }
  size_t size_ = 0;
  std::vector<float> values_;  // [kHeights + 1][kAzimuths][size]
};

/// The integral of the specular BRDF times the cosine times functions of the incoming direction,
/// from `samples` importance samples: calls add(incoming, weight), local, the mean of weight *
/// function(incoming) being the integral. `outgoing` is above the horizon.
void for_each_brdf_sample(
    const Material& material, const Vector3f& outgoing, int samples,
    const std::function<void(const Vector3f& incoming, const Rgb& weight)>& add);

/// The specular part's directional albedo, [3], by view.
ViewTable albedo_table(const Material& material);

}  // namespace burnish
