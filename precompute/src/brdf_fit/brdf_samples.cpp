#include "brdf_fit/brdf_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

// Of a distribution below which the grid stays as it is: a tenth of a degree's hundredth.
constexpr double kLeastWidth = 2e-5, kGreatestWidth = 0.5;

Vector3d polar(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
          std::cos(angle)};
}

double retro_value(const MeasuredBrdf& measured, const Vector3d& half) {
  const Vector3f direction = half.cast<float>();
  const double value = luminance(measured.eval(direction, direction));
  return std::isfinite(value) ? value : 0;
}

// The angle from the normal at which the BRDF toward its own light, which is D(h) but for a smooth
// factor, has fallen to half its greatest value along an azimuth; the least of several.
double distribution_width(const MeasuredBrdf& measured) {
  constexpr int kAzimuths = 16, kSteps = 400;
  double width = kGreatestWidth;
  for (int j = 0; j < (measured.isotropic ? 1 : kAzimuths); ++j) {
    const double azimuth = 2 * kPi<double> * j / kAzimuths;
    double peak = retro_value(measured, Vector3d::UnitZ());
    double angle = kLeastWidth;
    const double factor = std::pow(kGreatestWidth / kLeastWidth, 1.0 / kSteps);
    for (; angle < width; angle *= factor) {
      const double value = retro_value(measured, polar(angle, azimuth));
      peak = std::max(peak, value);
      if (value < 0.5 * peak) break;
    }
    width = std::min(width, angle);
  }
  return std::max(width, kLeastWidth);
}

// Irregular data: half of the samples' half vectors, at most, get the fine cells.
double sample_width(const MeasuredBrdf& measured) {
  std::vector<double> angles;
  for (const BrdfSample& sample : measured.samples) {
    const Vector3d half = (sample.outgoing + sample.incoming).cast<double>().normalized();
    angles.push_back(std::atan2(std::hypot(half.x(), half.y()), half.z()));
  }
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  return std::clamp(*middle, 1e-3, kGreatestWidth);
}

double fraction(double x) { return x - std::floor(x); }

bool has_value(const BrdfPair& pair) { return pair.value.isFinite().all() && pair.weight > 0; }

// The pairs of one cell; the measure of a pair of directions is 4 (h.o) dh dd.
void append_cell(const MeasuredBrdf& measured, const BrdfSamplePlan& plan,
                 const HalfVectorGrid& grid, int cell, int count, std::vector<BrdfPair>& pairs) {
  constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;  // of the R2 sequence
  const Vector3d half = grid.center(cell);
  const Frame<double> frame = frame_from_axis(half);
  const double least_cosine =
      std::cos(std::min(plan.max_angle_rad, double(measured.max_angle_rad)));
  const double measure = 4 * grid.solid_angle(cell) * 2 * kPi<double> / count;
  for (int k = 0; k < count; ++k) {
    const double index = double(cell) * count + k + 1;
    const double cosine = fraction(0.5 + plan.shift + kStepU * index);
    const double turn = 2 * kPi<double> * fraction(0.5 + plan.shift + kStepV * index);
    const Vector3d difference = frame.to_world(polar(std::acos(cosine), turn));
    BrdfPair pair;
    pair.incoming = difference.cast<float>();
    pair.outgoing = (2 * cosine * half - difference).cast<float>();
    if (double(std::min(pair.incoming.z(), pair.outgoing.z())) < std::max(least_cosine, 1e-4))
      continue;
    pair.value = measured.eval(pair.outgoing, pair.incoming);
    pair.weight = static_cast<float>(std::sqrt(measure * cosine)) * pair.incoming.z();
    pair.cos_difference = static_cast<float>(cosine);
    pair.cell = cell;
    if (has_value(pair)) pairs.push_back(pair);
  }
}

std::vector<BrdfPair> irregular_pairs(const MeasuredBrdf& measured, const BrdfSamplePlan& plan,
                                      const HalfVectorGrid& grid) {
  std::vector<BrdfPair> pairs;
  const float least_cosine = static_cast<float>(std::cos(plan.max_angle_rad));
  for (const BrdfSample& sample : measured.samples) {
    if (std::min(sample.outgoing.z(), sample.incoming.z()) < std::max(least_cosine, 1e-4f))
      continue;
    const Vector3d half = (sample.outgoing + sample.incoming).cast<double>().normalized();
    pairs.push_back({sample.outgoing, sample.incoming, sample.value, sample.incoming.z(),
                     static_cast<float>(half.dot(sample.incoming.cast<double>())),
                     grid.cell_of(half)});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const BrdfPair& a, const BrdfPair& b) { return a.cell < b.cell; });
  return pairs;
}

Vector3d half_of(const BrdfPair& pair) {
  return (pair.outgoing + pair.incoming).cast<double>().normalized();
}

void center_on_samples(BrdfSamples& samples) {
  for (size_t cell = 0; cell < samples.center.size(); ++cell) {
    Vector3d sum = Vector3d::Zero();
    for (size_t i = samples.begin[cell]; i < samples.begin[cell + 1]; ++i)
      sum += half_of(samples.pairs[i]);
    if (sum.norm() > 0) samples.center[cell] = sum.normalized();
  }
}

// A lobe that falls to 1 / e at half the distance of a fourth neighbour holds a sample or two. That
// distance where samples are dense, by the least tenth of some of them.
double sample_bandwidth(const std::vector<BrdfPair>& pairs) {
  constexpr size_t kProbes = 512, kNearest = 5;  // the first is the sample itself
  std::vector<Vector3d> half;
  for (const BrdfPair& pair : pairs) half.push_back(half_of(pair));
  const size_t probes = std::min(kProbes, half.size());
  std::vector<double> distance2(probes);
  tbb::parallel_for(size_t(0), probes, [&](size_t probe) {
    const Vector3d& at = half[probe * half.size() / probes];
    std::array<double, kNearest> nearest;
    nearest.fill(std::numeric_limits<double>::infinity());
    for (const Vector3d& other : half) {
      const double d2 = (other - at).squaredNorm();
      if (d2 >= nearest.back()) continue;
      nearest.back() = d2;
      for (size_t i = kNearest - 1; i > 0 && nearest[i] < nearest[i - 1]; --i)
        std::swap(nearest[i], nearest[i - 1]);
    }
    distance2[probe] = nearest.back();
  });
  if (probes == 0) return 1;
  const auto tenth = distance2.begin() + static_cast<std::ptrdiff_t>(probes / 10);
  std::nth_element(distance2.begin(), tenth, distance2.end());
  return std::clamp(4 / *tenth, 1.0, 1e8);
}

}  // namespace

double HalfVectorGrid::angle(double u) const {
  return width * std::sinh(u * std::asinh(kPi<double> / 2 / width));
}

int HalfVectorGrid::cell_of(const Vector3d& half) const {
  const double from_normal = std::atan2(std::hypot(half.x(), half.y()), half.z());
  const double u = std::asinh(from_normal / width) / std::asinh(kPi<double> / 2 / width);
  const double turn = fraction(std::atan2(half.y(), half.x()) / (2 * kPi<double>));
  const int row = std::clamp(static_cast<int>(u * angles), 0, angles - 1);
  return row * azimuths + std::min(static_cast<int>(turn * azimuths), azimuths - 1);
}

Vector3d HalfVectorGrid::center(int cell) const {
  const double u = (cell / azimuths + 0.5) / angles;
  return polar(angle(u), 2 * kPi<double> * (cell % azimuths + 0.5) / azimuths);
}

double HalfVectorGrid::solid_angle(int cell) const {
  const int row = cell / azimuths;
  const double low = angle(double(row) / angles), high = angle((row + 1.0) / angles);
  return 4 * kPi<double> / azimuths * std::sin((low + high) / 2) * std::sin((high - low) / 2);
}

BrdfSamples sample_brdf(const MeasuredBrdf& measured, const BrdfSamplePlan& plan) {
  BrdfSamples samples;
  samples.isotropic = measured.isotropic;
  samples.irregular = !measured.samples.empty();
  samples.grid.angles = plan.resolution;
  samples.grid.azimuths = measured.isotropic ? 1 : plan.resolution;
  samples.grid.width = samples.irregular ? sample_width(measured) : distribution_width(measured);
  const HalfVectorGrid& grid = samples.grid;
  if (samples.irregular) {
    samples.pairs = irregular_pairs(measured, plan, grid);
  } else {
    const int count = std::max(plan.pairs / grid.cells(), 4);
    std::vector<std::vector<BrdfPair>> rows(static_cast<size_t>(grid.angles));
    tbb::parallel_for(0, grid.angles, [&](int row) {
      for (int j = 0; j < grid.azimuths; ++j)
        append_cell(measured, plan, grid, row * grid.azimuths + j, count, rows[size_t(row)]);
    });
    for (const auto& row : rows) samples.pairs.insert(samples.pairs.end(), row.begin(), row.end());
  }
  for (int cell = 0; cell < grid.cells(); ++cell) samples.center.push_back(grid.center(cell));
  samples.begin.assign(static_cast<size_t>(grid.cells()) + 1, 0);
  for (const BrdfPair& pair : samples.pairs) ++samples.begin[static_cast<size_t>(pair.cell) + 1];
  for (size_t i = 1; i < samples.begin.size(); ++i) samples.begin[i] += samples.begin[i - 1];
  if (samples.irregular) {
    center_on_samples(samples);
    samples.max_bandwidth = sample_bandwidth(samples.pairs);
  }
  return samples;
}

double normalize_values(BrdfSamples& samples, const BrdfFitOptions& options) {
  if (samples.pairs.empty())
    throw Error(ErrorKind::input, options.subject,
                fmt::format("no samples within {:.4g} degrees of the normal; see --max-angle",
                            options.max_angle_rad * 180 / kPi<double>));
  float greatest = 0;
  for (const BrdfPair& pair : samples.pairs) greatest = std::max(greatest, pair.value.maxCoeff());
  if (!(greatest >= std::numeric_limits<float>::min()))
    throw Error(ErrorKind::input, options.subject, "is black, expected values above 0");
  for (BrdfPair& pair : samples.pairs) pair.value /= greatest;
  return double(greatest);
}

}  // namespace burnish
