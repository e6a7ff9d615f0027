#include "harness/transfer_picture.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/ssdf.h"
#include "burnish/visibility/visibility_ladder.h"

namespace burnish {
namespace {

constexpr int kLeastEdge = 128;

// The inverse of srgb_from_linear(), for what is not near black.
Rgb linear_from_srgb(const Rgb& srgb) { return ((srgb + 0.055f) / 1.055f).pow(2.4f); }

Rgb gutter_color() { return linear_from_srgb(Rgb::Constant(0.25f)); }

// Angles about the boundary get most of the colours.
float shade_of_distance(float distance) {
  const float share = std::min(std::abs(distance) / (kPi<float> / 2), 1.0f);
  return std::copysign(std::sqrt(share), distance);
}

// Value at a map's texel.
using Texels = std::function<float(std::size_t texel)>;
// Value in a direction.
using Directions = std::function<float(const Vector3f& direction)>;

// Maps are added from left to right, row by row.
class Sheet {
 public:
  Sheet(int edge, int rows)
      : edge_(edge),
        image_(kPictureColumns * (edge + kPictureGutter) + kPictureGutter,
               rows * (edge + kPictureGutter) + kPictureGutter, gutter_color()) {}

  void add(int resolution, const Texels& value) {
    const int scale = edge_ / resolution;
    draw([&](int x, int y) {
      return value(static_cast<std::size_t>(y / scale * resolution + x / scale));
    });
  }

  void add(const Directions& value) {
    draw([&](int x, int y) { return value(octahedral_texel_direction<float>(x, y, edge_)); });
  }

  void next_row() {
    column_ = 0;
    ++row_;
  }

  Image take() { return std::move(image_); }

 private:
  void draw(const std::function<float(int x, int y)>& value) {
    const int step = edge_ + kPictureGutter;
    for (int y = 0; y < edge_; ++y)
      for (int x = 0; x < edge_; ++x)
        image_.at(kPictureGutter + column_ * step + x, kPictureGutter + row_ * step + y) =
            diverging_color(value(x, y));
    ++column_;
  }

  int edge_;
  Image image_;
  int column_ = 0, row_ = 0;
};

// The middle of each of as many stretches of vertices as there are columns.
std::vector<std::size_t> sample_vertices(const Transfer& transfer) {
  const std::size_t all = transfer.vertex_count();
  const std::size_t count = std::min<std::size_t>(all, kPictureColumns);
  std::vector<std::size_t> vertices;
  for (std::size_t i = 0; i < count; ++i) vertices.push_back((2 * i + 1) * all / (2 * count));
  return vertices;
}

void draw_vertices(const Transfer& transfer, Sheet& sheet) {
  for (const std::size_t vertex : sample_vertices(transfer)) {
    if (transfer.bases.empty()) {
      sheet.add([&](const Vector3f& direction) {
        const float cosine = transfer.normals[vertex].dot(direction);
        return shade_of_distance(std::asin(std::clamp(cosine, -1.0f, 1.0f)));
      });
      continue;
    }
    const SsdfBasis& basis = transfer.bases[transfer.basis_id[vertex]];
    const auto terms = static_cast<std::size_t>(basis.terms);
    sheet.add(basis.resolution, [&](std::size_t texel) {
      float value = basis.mean[texel];
      for (std::size_t k = 0; k < terms; ++k)
        value += basis.eigen[texel * terms + k] * transfer.vertex_coefficients(vertex)[k];
      return shade_of_distance(decode_ssdf(value, basis.amplitude_rad));
    });
  }
}

void draw_basis(const SsdfBasis& basis, Sheet& sheet) {
  sheet.add(basis.resolution, [&](std::size_t texel) {
    return shade_of_distance(decode_ssdf(basis.mean[texel], basis.amplitude_rad));
  });
  const auto terms = static_cast<std::size_t>(basis.terms);
  for (std::size_t k = 0; k < std::min<std::size_t>(terms, kPictureColumns - 1); ++k) {
    float largest = 1e-30f;  // of an eigen-SSDF that is zero everywhere
    for (std::size_t texel = 0; texel < basis.mean.size(); ++texel)
      largest = std::max(largest, std::abs(basis.eigen[texel * terms + k]));
    sheet.add(basis.resolution,
              [&](std::size_t texel) { return basis.eigen[texel * terms + k] / largest; });
  }
}

// Mean and standard deviation of each coefficient over the vertices that use a ladder.
struct LadderSpread {
  std::vector<float> mean;
  float leading_deviation = 0;
};

LadderSpread spread_of(const Transfer& transfer, const LadderBasis& ladder) {
  const auto terms = static_cast<std::size_t>(ladder.terms);
  std::vector<double> sum(terms, 0.0);
  double squares = 0, count = 0;
  for (std::size_t vertex = 0; vertex < transfer.vertex_count(); ++vertex) {
    if (transfer.vertex_ladder_basis(vertex) != &ladder) continue;
    const float* coefficients = transfer.vertex_ladder_coefficients(vertex);
    for (std::size_t k = 0; k < terms; ++k) sum[k] += coefficients[k];
    squares += double{coefficients[0]} * coefficients[0];
    ++count;
  }
  LadderSpread spread{std::vector<float>(terms, 0.0f), 0};
  if (count == 0) return spread;
  for (std::size_t k = 0; k < terms; ++k) spread.mean[k] = static_cast<float>(sum[k] / count);
  const double mean = sum[0] / count;
  spread.leading_deviation =
      static_cast<float>(std::sqrt(std::max(squares / count - mean * mean, 0.0)));
  return spread;
}

VisibilityHarmonics along_leading(const LadderBasis& ladder, const LadderSpread& spread,
                                  float deviations) {
  std::vector<float> coefficients = spread.mean;
  coefficients[0] += deviations * spread.leading_deviation;
  return reconstruct_harmonics(ladder, coefficients.data());
}

void draw_ladder(const Transfer& transfer, const LadderBasis& ladder, Sheet& sheet) {
  const LadderSpread spread = spread_of(transfer, ladder);
  const VisibilityHarmonics mean = along_leading(ladder, spread, 0);
  const VisibilityHarmonics above = along_leading(ladder, spread, 1);
  const VisibilityHarmonics below = along_leading(ladder, spread, -1);
  for (int column = 0; column < kPictureColumns; ++column) {
    const LobeBands lobe = lobe_bands(std::exp2(static_cast<float>(column)));
    sheet.add([&](const Vector3f& d) { return 2 * visible_fraction(mean, d, lobe) - 1; });
  }
  sheet.next_row();
  for (int column = 0; column < kPictureColumns; ++column) {
    const LobeBands lobe = lobe_bands(std::exp2(static_cast<float>(column)));
    sheet.add([&](const Vector3f& d) {
      return visible_fraction(above, d, lobe) - visible_fraction(below, d, lobe);
    });
  }
  sheet.next_row();
}

std::size_t drawn(std::size_t bases) { return std::min<std::size_t>(bases, kPictureBases); }

}  // namespace

int picture_map_edge(const Transfer& transfer) {
  return transfer.bases.empty() ? kLeastEdge
                                : std::max(kLeastEdge, transfer.bases.front().resolution);
}

Rgb diverging_color(float value) {
  // ColorBrewer's RdBu, its ends and the middle between each and white, in sRGB.
  static const Rgb kRed[] = {Rgb(0.957f, 0.647f, 0.510f), Rgb(0.698f, 0.094f, 0.169f)};
  static const Rgb kBlue[] = {Rgb(0.573f, 0.773f, 0.871f), Rgb(0.129f, 0.400f, 0.675f)};
  const auto& ends = value < 0 ? kRed : kBlue;
  const float size = std::abs(value) < 1 ? 2 * std::abs(value) : std::isnan(value) ? 0 : 2;
  const Rgb srgb = size < 1 ? Rgb(Rgb::Ones() + size * (ends[0] - 1))
                            : Rgb(ends[0] + (size - 1) * (ends[1] - ends[0]));
  return linear_from_srgb(srgb);
}

Image draw_transfer(const Transfer& transfer) {
  const std::size_t bases = drawn(transfer.bases.size());
  const std::size_t ladders = drawn(transfer.ladder_bases.size());
  Sheet sheet(picture_map_edge(transfer), static_cast<int>(1 + bases + 2 * ladders));
  draw_vertices(transfer, sheet);
  sheet.next_row();
  for (std::size_t i = 0; i < bases; ++i) {
    draw_basis(transfer.bases[i], sheet);
    sheet.next_row();
  }
  for (std::size_t i = 0; i < ladders; ++i) draw_ladder(transfer, transfer.ladder_bases[i], sheet);
  return sheet.take();
}

}  // namespace burnish
