#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "burnish/light/prefiltered_environment.h"
#include "light/cube_faces.h"

// Each level is a sum over the samples of a finer one (the finest over the map's pixels) with
// Gaussian weights: blurs of blurs, since the variances of Gaussians add.
namespace burnish {
namespace {

using Texel = Eigen::Array4f;

/// Texels along a face's edge: a lobe's deviation is 1.2 of them in the middle of a face, where
/// they are widest, and more where the lobes are wide and texels cost little.
int texels_across(double bandwidth) {
  return std::max(12, 6 + static_cast<int>(std::ceil(2.8 * std::sqrt(bandwidth))));
}

/// Samples that a face has beyond its edges: one that is stored, and one for each sharpening. Few
/// texels leave no room for two within reach of the stretch, and need but one.
int sharpenings(int resolution) { return resolution < 16 ? 1 : 2; }
int border(int resolution) { return 1 + sharpenings(resolution); }

/// The lobe that makes one of bandwidth `fine` one of bandwidth `coarse`: 1 / bandwidths add, as
/// the variances of planes do. (Mean cosines would rather multiply, but the cores then differ
/// more.)
double incremental_bandwidth(double coarse, double fine) {
  return 1 / (1 / std::max(coarse, 1e-3) - 1 / fine);
}

/// A lobe that is cut off where it is out of sight.
struct Kernel {
  float bandwidth;
  float sin_reach;
  float squared_reach;  ///< a chord's

  /// A lobe that is one of a chain of blurs may be cut earlier, but is made wider by the variance
  /// that this takes off: the chain adds up what is missing.
  Kernel(double wanted, bool of_chain) {
    const double cut = of_chain ? 3.2 : 3.6, exponent = cut * cut / 2;
    const double kept =
        of_chain ? 1 - exponent * std::exp(-exponent) / (1 - std::exp(-exponent)) : 1;
    const double sine = cut * std::sqrt(0.5 / (wanted * kept));
    const bool whole = sine >= 1;
    bandwidth = static_cast<float>(whole ? wanted : wanted * kept);
    sin_reach = static_cast<float>(whole ? 1 : sine);
    squared_reach = static_cast<float>(whole ? 2 : 2 * (1 - std::sqrt(1 - sine * sine)));
  }
};

/// A weighted mean, as what is added to a reference near the result: of equal values it is exactly
/// that value.
struct WeightedMean {
  Texel reference;
  Texel sum = Texel::Zero();
  Eigen::Array4f weight = Eigen::Array4f::Zero();

  void add(const Texel& value, float w) {
    sum += w * (value - reference);
    weight[0] += w;
  }
  /// Four values side by side, of which the first `count` (at least one) count.
  void add_four(const Texel* values, Eigen::Array4f weights, int count) {
    static const Eigen::Array4f kMasks[4] = {
        {1, 1, 1, 1}, {1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 0}};
    if (count < 4) weights *= kMasks[count];
    sum += (weights[0] * (values[0] - reference) + weights[1] * (values[1] - reference)) +
           (weights[2] * (values[2] - reference) + weights[3] * (values[3] - reference));
    weight += weights;
  }
  Texel value() const {
    const float total = weight.sum();
    return total > 0 ? Texel(reference + sum / total) : reference;
  }
};

Eigen::Map<const Eigen::Array4f> four(const float* values) {
  return Eigen::Map<const Eigen::Array4f>(values);
}

/// exp(x), x in [-80, 0], to 4e-6.
Eigen::Array4f exp_negative(const Eigen::Array4f& x) {
  const Eigen::Array4f scaled = x * 1.44269504f;
  const Eigen::Array4i whole = (scaled - 0.5f).cast<int>();  // the nearest, as scaled <= 0
  const Eigen::Array4f f = scaled - whole.cast<float>();
  const Eigen::Array4f mantissa =
      1 + f * (0.69314718f +
               f * (0.24022651f + f * (0.05550411f + f * (0.00961813f + f * 0.00133336f))));
  Eigen::Array4i bits;
  std::memcpy(bits.data(), mantissa.data(), sizeof bits);
  bits += whole.shiftLeft<23>();
  Eigen::Array4f result;
  std::memcpy(result.data(), bits.data(), sizeof bits);
  return result;
}

/// How much of what is seen at this chord a lobe of this exponent (positive) lets through: nothing
/// beyond its reach.
Eigen::Array4f lobe_weight(const Eigen::Array4f& chord2, const Eigen::Array4f& exponent,
                           float squared_reach) {
  const Eigen::Array4f seen = (1 - 0.5f * chord2).max(0.0f);
  // 1 within and 0 beyond, without a branch
  const Eigen::Array4f within = ((squared_reach - chord2) * 1e30f).max(0.0f).min(1.0f);
  const Eigen::Array4f weight =
      seen * exp_negative((-exponent * (1 - 0.25f * chord2)).max(-80.0f).min(0.0f));
  return weight * within;
}

/// Where the samples of a face are, for all faces of a resolution.
struct FaceGrid {
  int resolution;
  int border;
  int across;  ///< resolution + 2 border
  /// [across^2], and three more: local directions and solid angles.
  std::vector<float> x, y, z, area;

  FaceGrid(int n, int border_width) : resolution(n), border(border_width), across(n + 2 * border) {
    const auto size = static_cast<size_t>(across) * across;
    for (auto* values : {&x, &y, &z, &area}) values->resize(size + 3);
    for (size_t i = 0; i < size; ++i) {
      const double cx = (2 * (static_cast<int>(i % across) - border) + 1.0) / n - 1;
      const double cy = (2 * (static_cast<int>(i / across) - border) + 1.0) / n - 1;
      const Vector3d d = face_direction(cx, cy);
      x[i] = static_cast<float>(d.x());
      y[i] = static_cast<float>(d.y());
      z[i] = static_cast<float>(d.z());
      area[i] = static_cast<float>(face_density(cx, cy) * 4 / (double(n) * n));
    }
  }
  size_t index(int column, int row) const {
    return static_cast<size_t>(row + border) * across + (column + border);
  }
  size_t face_size() const { return static_cast<size_t>(across) * across; }
  Vector3f direction(size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Samples of the environment under a lobe: [6][grid.face_size()], and three more.
struct FilteredFaces {
  double bandwidth;
  FaceGrid grid;
  std::vector<Texel> samples;
};

struct Range {
  int begin, end;
};

/// The samples of a row of a face that a cone reaches, from the cone's axis in the plane of the row
/// and the face's outward axis.
Range reached_samples(float along, float outward, float sin_reach, int n) {
  const float length2 = along * along + outward * outward;
  const float room = length2 - sin_reach * sin_reach;
  if (room <= 0) return {0, n};
  const float tangent = sin_reach / std::sqrt(room);
  // Both ends as vectors of that plane, for an axis on the positive side.
  const float s = std::abs(along);
  const float low_s = s - tangent * outward, low_m = outward + tangent * s;
  const float high_s = s + tangent * outward, high_m = outward - tangent * s;
  if (low_s > 0 && low_s > low_m) return {0, 0};
  float low = low_m > 0 && low_s >= -low_m ? stretch_tangent(low_s / low_m) : -1;
  float high = high_s >= 0 && high_m > 0 && high_s <= high_m ? stretch_tangent(high_s / high_m) : 1;
  if (along < 0) {
    std::swap(low, high);
    low = -low;
    high = -high;
  }
  const auto half = 0.5f * static_cast<float>(n);
  return {std::clamp(static_cast<int>((low + 1) * half - 0.5f), 0, n),
          std::clamp(static_cast<int>((high + 1) * half - 0.5f) + 1, 0, n)};
}

Texel mean_of_faces(const FilteredFaces& source, const Kernel& kernel, const Vector3f& direction) {
  const FaceGrid& grid = source.grid;
  const int n = grid.resolution;
  const CubePoint point = cube_from_direction(direction);
  const auto nearest = [n](float c) {
    return std::clamp(static_cast<int>((c + 1) * 0.5f * static_cast<float>(n)), 0, n - 1);
  };
  WeightedMean mean;
  mean.reference =
      source
          .samples[point.face * grid.face_size() + grid.index(nearest(point.x), nearest(point.y))];
  const float cos_reach = std::sqrt(1 - kernel.sin_reach * kernel.sin_reach);
  const Vector3f own = world_to_face(point.face, direction);
  const bool inside =
      own.z() - std::max(std::abs(own.x()), std::abs(own.y())) > 1.4143f * kernel.sin_reach;
  for (int face = inside ? point.face : 0; face < (inside ? point.face + 1 : 6); ++face) {
    const Vector3f axis = world_to_face(face, direction);
    const float across = std::sqrt(std::max(1 - axis.z() * axis.z(), 0.0f));
    // No direction of a face is further than acos(1 / sqrt(3)) from the face's axis.
    if (axis.z() < cos_reach && axis.z() * cos_reach + across * kernel.sin_reach < 0.577f) continue;
    const Range xs = reached_samples(axis.x(), axis.z(), kernel.sin_reach, n);
    const Range ys = reached_samples(axis.y(), axis.z(), kernel.sin_reach, n);
    const Texel* samples = source.samples.data() + face * grid.face_size();
    for (int row = ys.begin; row < ys.end; ++row) {
      const size_t begin = grid.index(xs.begin, row), end = grid.index(xs.end, row);
      for (size_t i = begin; i < end; i += 4) {
        const Eigen::Array4f chord2 = (four(&grid.x[i]) - axis.x()).square() +
                                      (four(&grid.y[i]) - axis.y()).square() +
                                      (four(&grid.z[i]) - axis.z()).square();
        mean.add_four(samples + i,
                      four(&grid.area[i]) *
                          lobe_weight(chord2, kernel.bandwidth * chord2, kernel.squared_reach),
                      static_cast<int>(std::min<size_t>(end - i, 4)));
      }
    }
  }
  return mean.value();
}

/// A lat-long map as sums run over it, with tables.
struct LatLongSource {
  int width, height;
  double width_exact, height_exact;  ///< where the last column or row is narrower
  std::vector<Texel> pixels;         ///< [height][2 width], each row twice, and three more
  /// [2 width + 3], repeated so that every arc of longitudes is one run: sine, cosine, and the
  /// share of a whole column, which is less for the last.
  std::vector<float> column_sine, column_cosine, column_share;
  struct Row {
    float sine, cosine;  ///< of the angle from +y
    float solid_angle;
    float variance_along, variance_across;  ///< of a pixel, along the meridian and across it
  };
  std::vector<Row> rows;

  /// Joins squares of pixels of a map, `get(x, y)`, of `full_width` by `full_height`. The last row
  /// and column may be narrower.
  template <class Get>
  LatLongSource(int full_width, int full_height, int join_edge, const Get& get)
      : width((full_width + join_edge - 1) / join_edge),
        height((full_height + join_edge - 1) / join_edge),
        width_exact(double(full_width) / join_edge),
        height_exact(double(full_height) / join_edge) {
    const int join = join_edge;
    const double step_x = 2 * kPi<double> / full_width, step_y = kPi<double> / full_height;
    const auto end_x = [&](int x) { return std::min((x + 1) * join, full_width); };
    const auto end_y = [&](int y) { return std::min((y + 1) * join, full_height); };
    for (int x = 0; x < 2 * width + 3; ++x) {
      const int i = x % width;
      const double longitude = kPi<double> - (i * join + end_x(i)) * step_x / 2;
      column_sine.push_back(static_cast<float>(std::sin(longitude)));
      column_cosine.push_back(static_cast<float>(std::cos(longitude)));
      column_share.push_back(float(end_x(i) - i * join) / float(join));
    }
    rows.reserve(height);
    for (int y = 0; y < height; ++y) {
      const double middle = (y * join + end_y(y)) * step_y / 2, sine = std::sin(middle);
      const double along = (end_y(y) - y * join) * step_y, across = join * step_x * sine;
      rows.push_back({float(sine), float(std::cos(middle)),
                      float(2 * join * step_x * std::sin(along / 2) * sine),
                      float(along * along / 12), float(across * across / 12)});
    }
    pixels.reserve(size_t{2} * width * height + 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        WeightedMean mean{get(x * join, y * join)};
        for (int j = y * join; join > 1 && j < end_y(y); ++j) {
          const auto weight = static_cast<float>(std::sin((j + 0.5) * step_y));
          for (int i = x * join; i < end_x(x); ++i) mean.add(get(i, j), weight);
        }
        pixels.push_back(mean.value());
      }
      for (int x = 0; x < width; ++x) pixels.push_back(*(pixels.end() - width));
    }
    pixels.resize(pixels.size() + 3, Texel::Zero());
  }
};

/// Sums over the pixels of a lat-long map, whose own variance, which a sum over their middles
/// leaves out, is taken off the lobe's.
class PixelSum {
 public:
  PixelSum(const LatLongSource& source, const Kernel& kernel) : source_(source), kernel_(kernel) {
    const float variance = 0.5f / std::max(kernel.bandwidth, 1e-6f);
    const auto left = [variance](float own) {
      return 0.5f / std::max(variance - own, 0.5f * variance);
    };
    for (const LatLongSource::Row& row : source.rows)
      exponents_.push_back({left(row.variance_along), left(row.variance_across)});
    const float reach = kernel.sin_reach >= 1 ? kPi<float> / 2 : std::asin(kernel.sin_reach);
    reach_rows_ =
        static_cast<int>(reach / kPi<float> * static_cast<float>(source.height_exact)) + 1;
  }

  Texel operator()(const Vector3f& direction) const {
    const Vector2<double> uv = latlong_from_direction(direction.cast<double>());
    const int column = static_cast<int>(uv.x() * source_.width_exact);
    const int row = static_cast<int>(uv.y() * source_.height_exact);
    WeightedMean mean{source_.pixels[size_t{2} * row * source_.width + column]};
    const int last = std::min(row + reach_rows_, source_.height - 1);
    for (int y = std::max(row - reach_rows_, 0); y <= last; ++y)
      add_row(direction, y, column, mean);
    return mean.value();
  }

 private:
  void add_row(const Vector3f& direction, int y, int column, WeightedMean& mean) const {
    const LatLongSource::Row& row = source_.rows[y];
    const float sine = std::sqrt(direction.x() * direction.x() + direction.z() * direction.z());
    const float row_chord2 = square(row.sine - sine) + square(row.cosine - direction.y());
    const float left = kernel_.squared_reach - row_chord2;
    if (left <= 0) return;
    const float ring = row.sine * sine;
    const float toward_sine = sine > 0 ? direction.x() / sine : 0.0f;
    const float toward_cosine = sine > 0 ? direction.z() / sine : 1.0f;
    // All longitudes whose chord is in reach: an arc is at most pi / 2 of its chord.
    const float chord = std::sqrt(left / std::max(ring, 1e-12f));
    const float arc = chord < 1 ? 1.05f * chord : std::min(kPi<float> / 2 * chord, kPi<float>);
    const int width = source_.width;
    const int reach =
        static_cast<int>(arc / (2 * kPi<float>)*static_cast<float>(source_.width_exact)) + 1;
    const int count = std::min(2 * reach + 1, width);
    const int begin = count == width ? 0 : (column - reach + width) % width;
    const Texel* pixels = source_.pixels.data() + size_t{2} * y * width;
    const Exponents& exponents = exponents_[y];
    for (int x = begin; x < begin + count; x += 4) {
      const Eigen::Array4f ring_chord2 =
          ring * ((four(&source_.column_sine[x]) - toward_sine).square() +
                  (four(&source_.column_cosine[x]) - toward_cosine).square());
      const Eigen::Array4f exponent = exponents.along * row_chord2 + exponents.across * ring_chord2;
      mean.add_four(pixels + x,
                    row.solid_angle * four(&source_.column_share[x]) *
                        lobe_weight(row_chord2 + ring_chord2, exponent, kernel_.squared_reach),
                    std::min(begin + count - x, 4));
    }
  }

  static float square(float x) { return x * x; }

  struct Exponents {
    float along, across;
  };
  const LatLongSource& source_;
  Kernel kernel_;
  std::vector<Exponents> exponents_;  ///< a row's
  int reach_rows_;
};

/// Moves the values of a face toward the coefficients of the quadratic B-spline that passes through
/// them, along x or along y: x += value - spline(x), from x = value.
void sharpen(std::vector<Texel>& face, int across, int passes, bool along_x) {
  const std::vector<Texel> values = face;
  const int step = along_x ? 1 : across;
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<Texel> last = face;
    for (int y = along_x ? 0 : 1; y < across - (along_x ? 0 : 1); ++y) {
      for (int x = along_x ? 1 : 0; x < across - (along_x ? 1 : 0); ++x) {
        const size_t i = static_cast<size_t>(y) * across + x;
        face[i] = values[i] - (last[i - step] - 2 * last[i] + last[i + step]) / 8;
      }
    }
  }
}

/// Writes a face's coefficients. They are kept above an eighth of the samples, so that the tails
/// about a sun do not swing below zero.
void store_coefficients(const FilteredFaces& faces, int face, std::vector<Texel>& coefficients) {
  const FaceGrid& grid = faces.grid;
  const Texel* samples = faces.samples.data() + face * grid.face_size();
  std::vector<Texel> sharp(samples, samples + grid.face_size());
  sharpen(sharp, grid.across, sharpenings(grid.resolution), true);
  sharpen(sharp, grid.across, sharpenings(grid.resolution), false);
  const int stored = grid.resolution + 2;
  Texel* out = coefficients.data() + static_cast<size_t>(face) * stored * stored;
  for (int y = -1; y <= grid.resolution; ++y)
    for (int x = -1; x <= grid.resolution; ++x)
      *out++ = sharp[grid.index(x, y)].max(samples[grid.index(x, y)] / 8);
}

/// Bandwidth of the finest lobe whose sum over the middles of a map's pixels is its integral: 1.07
/// pixels of deviation.
double finest_bandwidth(int height) { return 0.44 * height * height / (kPi<double> * kPi<double>); }

LatLongSource make_source(const Image& map, double max_bandwidth) {
  // Small maps are refined, since their pixels have edges; to 512 rows at most, or twice.
  constexpr int kLeastRows = 32, kRefinedRows = 512;
  const auto ceil_ratio = [](int a, int b) { return (a + b - 1) / b; };
  const int wanted = std::clamp(2 * map.height, kLeastRows, kRefinedRows);
  const int split_y = std::max(wanted / map.height, 1);
  const int split_x = std::max(ceil_ratio(2 * map.height * split_y, map.width), 1);
  // Large maps are reduced, to the last level's need.
  int join = 1;
  if (split_y == 1 && split_x == 1)
    while (finest_bandwidth(map.height / (join + 1)) >= max_bandwidth) ++join;
  return {map.width * split_x, map.height * split_y, join, [&](int x, int y) {
            const Rgb& color = map.at(x / split_x, y / split_y);
            return Texel(color.x(), color.y(), color.z(), 0);
          }};
}

std::vector<double> ladder(double last) {
  std::vector<double> bandwidths{0, 1};
  for (int step = 2; std::exp2(0.5 * step) <= last; ++step)
    bandwidths.push_back(std::exp2(0.5 * step));
  return bandwidths;
}

/// Mean square of a sine in one direction: of a Gaussian of this bandwidth cut off by the disc.
double disc_variance(double bandwidth) {
  if (bandwidth < 1e-3) return 0.25 - bandwidth / 24;
  return (1 - bandwidth / std::expm1(bandwidth)) / (2 * bandwidth);
}

/// The widest of the levels so far that is fine enough to make a lobe of this bandwidth of; null:
/// none. A narrow lobe can follow the next finer one. The blur of a blur is not a lobe of the same
/// form, by a share of about 0.3 / (bandwidth of the finer): wide lobes take it from far away.
const FilteredFaces* source_for(double bandwidth, const std::vector<FilteredFaces>& finer) {
  const double least = bandwidth > 130   ? 1.41 * bandwidth
                       : bandwidth > 32  ? 4 * bandwidth
                       : bandwidth > 4.1 ? 128
                                         : 64;
  const FilteredFaces* source = nullptr;
  for (const FilteredFaces& faces : finer)
    if (faces.bandwidth >= 0.999 * least) source = &faces;
  return source;
}

}  // namespace

PrefilteredEnvironment prefilter_environment(const Image& environment,
                                             const PrefilterOptions& options) {
  if (environment.width < 1 || environment.height < 1)
    throw std::invalid_argument("an environment without pixels cannot be filtered");
  const auto for_each = [&options](int count, const std::function<void(int)>& body) {
    if (options.parallel_for) return options.parallel_for(count, body);
    for (int i = 0; i < count; ++i) body(i);
  };
  const LatLongSource pixels = make_source(environment, options.max_bandwidth);
  const std::vector<double> bandwidths =
      ladder(std::min<double>(finest_bandwidth(pixels.height), options.max_bandwidth));

  PrefilteredEnvironment result;
  result.map = environment;
  result.levels.resize(bandwidths.size());
  std::vector<FilteredFaces> finer;  // by falling bandwidth
  finer.reserve(bandwidths.size());
  for (size_t i = bandwidths.size(); i-- > 0;) {
    const double bandwidth = bandwidths[i];
    const int n = texels_across(bandwidth);
    FilteredFaces faces{bandwidth, FaceGrid(n, border(n)), {}};
    const size_t size = faces.grid.face_size();
    faces.samples.resize(6 * size + 3, Texel::Zero());
    const int across = faces.grid.across;
    const auto sample = [&](const auto& mean) {
      for_each(6 * across, [&](int row) {
        const int face = row / across;
        const size_t first = static_cast<size_t>(row % across) * across;
        for (size_t k = first; k < first + across; ++k)
          faces.samples[face * size + k] = mean(face_to_world(face, faces.grid.direction(k)));
      });
    };
    if (const FilteredFaces* source = source_for(bandwidth, finer)) {
      const Kernel kernel(incremental_bandwidth(bandwidth, source->bandwidth),
                          source->bandwidth < 2 * bandwidth);
      sample([&](const Vector3f& direction) { return mean_of_faces(*source, kernel, direction); });
    } else {
      // The last level is the first of the chain.
      sample(PixelSum(pixels, Kernel(bandwidth, i + 1 == bandwidths.size())));
    }
    PrefilteredEnvironment::Level& level = result.levels[i];
    level.bandwidth = static_cast<float>(bandwidth);
    level.variance = static_cast<float>(disc_variance(bandwidth));
    level.resolution = n;
    level.coefficients.resize(size_t{6} * (n + 2) * (n + 2));
    for_each(6, [&](int face) { store_coefficients(faces, face, level.coefficients); });
    finer.push_back(std::move(faces));
  }
  return result;
}

}  // namespace burnish
