#include "harness/rivals/view_table.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "burnish/shading/shade.h"
#include "harness/sample_sequence.h"

namespace burnish {
namespace {

constexpr float kRightAngle = kPi<float> / 2;
constexpr int kAlbedoSamples = 1024;  // a view

/// The last row of heights is of views that shading lifts to there.
float angle_of(int height) {
  const float lowest = std::acos(kMinViewCosine);
  return std::min(static_cast<float>(height) * kRightAngle / ViewTable::kHeights, lowest);
}

}  // namespace

ViewTable::ViewTable(
    size_t size, const std::function<void(const Vector3f& outgoing, std::span<float> values)>& fill)
    : size_(size), values_(static_cast<size_t>((kHeights + 1) * kAzimuths) * size) {
  tbb::parallel_for(0, (kHeights + 1) * kAzimuths, [&](int i) {
    const float angle = angle_of(i / kAzimuths);
    const float azimuth = 2 * kPi<float> * static_cast<float>(i % kAzimuths) / kAzimuths;
    const Vector3f outgoing(std::sin(angle) * std::cos(azimuth),
                            std::sin(angle) * std::sin(azimuth), std::cos(angle));
    fill(outgoing, std::span(values_).subspan(static_cast<size_t>(i) * size_, size_));
  });
}

void ViewTable::eval(const Vector3f& outgoing, std::span<float> values) const {
  const float angle = std::acos(std::clamp(outgoing.z(), kMinViewCosine, 1.0f));
  const float turn = std::atan2(outgoing.y(), outgoing.x()) / (2 * kPi<float>);
  const float y = angle / kRightAngle * kHeights;
  const float x = (turn < 0 ? turn + 1 : turn) * kAzimuths;
  const int row = std::min(static_cast<int>(y), kHeights - 1), column = static_cast<int>(x);
  const float low = angle_of(row), high = angle_of(row + 1);
  const float fy = std::min((angle - low) / (high - low), 1.0f);
  const float fx = x - static_cast<float>(column);
  const float weight[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  const float* corner[4] = {node(row, column), node(row, column + 1), node(row + 1, column),
                            node(row + 1, column + 1)};
  for (size_t k = 0; k < size_; ++k)
    values[k] = weight[0] * corner[0][k] + weight[1] * corner[1][k] + weight[2] * corner[2][k] +
                weight[3] * corner[3][k];
}

void for_each_brdf_sample(
    const Material& material, const Vector3f& outgoing, int samples,
    const std::function<void(const Vector3f& incoming, const Rgb& weight)>& add) {
  const SampleSequence sequence(1);
  for (int i = 0; i < samples; ++i) {
    const Uniform2 uniform = sequence(static_cast<std::uint32_t>(i), 0);
    const Vector3f incoming = sample_specular_brdf(
        material, outgoing, std::min(static_cast<float>(uniform.u), 0.9999999f),
        std::min(static_cast<float>(uniform.v), 0.9999999f));
    const float pdf = pdf_specular_brdf(material, outgoing, incoming);
    if (incoming.z() <= 0 || !(pdf > 0)) continue;
    add(incoming, eval_specular_brdf(material, outgoing, incoming) * (incoming.z() / pdf));
  }
}

ViewTable albedo_table(const Material& material) {
  return ViewTable(3, [&](const Vector3f& outgoing, std::span<float> values) {
    Rgb sum = Rgb::Zero();
    for_each_brdf_sample(material, outgoing, kAlbedoSamples,
                         [&](const Vector3f&, const Rgb& weight) { sum += weight; });
    Eigen::Map<Rgb>(values.data()) = sum / float(kAlbedoSamples);
  });
}

}  // namespace burnish
