#include "harness/rivals/sh_rival.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "burnish/precompute/visibility_sampler.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/visibility_ladder.h"
#include "harness/parallel_progress.h"
#include "harness/rivals/spherical_harmonics.h"
#include "harness/rivals/view_table.h"

namespace burnish {
namespace {

constexpr int kSliceSamples = 1024;  // of a view of a BRDF

/// A material's views: the harmonics of f cos, of one channel where all are alike.
struct Slices {
  ViewTable table;  // [channels][bands^2]
  Eigen::Index channels = 0;
};

bool is_grey(const Material& material) {
  const auto equal = [](const Rgb& color) { return (color == color.x()).all(); };
  const Fresnel& fresnel = material.fresnel;
  return material.model != SpecularModel::fitted && equal(material.specular) &&
         equal(fresnel.normal_reflectance) && equal(fresnel.eta) && equal(fresnel.k);
}

Slices slices_of(const Material& material, int bands) {
  Slices slices;
  if (!material.has_specular()) return slices;
  slices.channels = is_grey(material) ? 1 : 3;
  const Eigen::Index count = Eigen::Index{bands} * bands, channels = slices.channels;
  slices.table = ViewTable(
      static_cast<size_t>(channels * count),
      [&material, bands, count, channels](const Vector3f& outgoing, std::span<float> values) {
        Eigen::Map<Eigen::MatrixXf> sum(values.data(), count, channels);
        sum.setZero();
        Eigen::VectorXf harmonics(count);
        const auto add = [&](const Vector3f& incoming, const Rgb& weight) {
          eval_harmonics(bands, incoming, {harmonics.data(), harmonics.data() + count});
          sum += harmonics * weight.matrix().head(channels).transpose();
        };
        for_each_brdf_sample(material, outgoing, kSliceSamples, add);
        sum /= float(kSliceSamples);
      });
  return slices;
}

/// The texels of an octahedral map: their directions and harmonics.
struct Texels {
  DirectionTable directions;
  RowMatrix position;   // [3][texels]
  RowMatrix harmonics;  // [bands^2][texels]

  Texels(int resolution, int bands) : directions(resolution) {
    const Eigen::Index count = Eigen::Index{resolution} * resolution;
    position.resize(3, count);
    harmonics.resize(Eigen::Index{bands} * bands, count);
    tbb::parallel_for(0, resolution, [&](int y) {
      Eigen::VectorXf values(harmonics.rows());
      for (int x = 0; x < resolution; ++x) {
        const Eigen::Index i = Eigen::Index{y} * resolution + x;
        position.col(i) = directions.direction(x, y);
        eval_harmonics(bands, directions.direction(x, y),
                       {values.data(), values.data() + values.size()});
        harmonics.col(i) = values;
      }
    });
  }
};

/// [texels], `value` where visible.
Eigen::VectorXf visible_texels(const VisibilityMask& mask, float value) {
  Eigen::VectorXf visible(Eigen::Index{mask.resolution} * mask.resolution);
  for (Eigen::Index i = 0; i < visible.size(); ++i) {
    const auto x = static_cast<int>(i % mask.resolution), y = static_cast<int>(i / mask.resolution);
    visible[i] = mask.visible(x, y) ? value : 0;
  }
  return visible;
}

/// Below the horizon, where a BRDF is zero, any visibility will do: that above it, mirrored, has no
/// step there, which a few bands would smear over the highlights.
void mirror_at_horizon(const Texels& texels, const VisibilityMask& mask, const Vector3f& normal,
                       float value, Eigen::VectorXf& visible) {
  const int resolution = mask.resolution;
  for (Eigen::Index i = 0; i < visible.size(); ++i) {
    const Vector3f direction = texels.position.col(i);
    const float height = direction.dot(normal);
    if (height > 0) continue;
    const Vector2<float> uv =
        direction_to_octahedral(Vector3f(direction - 2 * height * normal).normalized().eval());
    const int x =
        std::min(static_cast<int>(uv.x() * static_cast<float>(resolution)), resolution - 1);
    const int y =
        std::min(static_cast<int>(uv.y() * static_cast<float>(resolution)), resolution - 1);
    // The texel that a mirrored direction falls in may have its middle below: it counts as open.
    const bool above = texels.directions.direction(x, y).dot(normal) > 0;
    visible[i] = !above || mask.visible(x, y) ? value : 0;
  }
}

class ShTransfer {
 public:
  ShTransfer(const RivalScene& scene, const ShOptions& options, const Progress& progress);

  void prepare_lights(const Eigen::Matrix3f& world_from_environment);
  void shade(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const;

  size_t bytes_per_vertex() const {
    const size_t matrix = static_cast<size_t>(count_ * count_ + 3 * count_);  // and what it lets in
    return kPlaceBytes + sizeof(float) * (static_cast<size_t>(count_) + (glossy_ ? matrix : 0));
  }
  size_t bytes_shared() const {
    size_t bytes = 0;
    for (const Slices& slices : slices_) bytes += slices.table.bytes();
    return bytes;
  }

 private:
  void bake(const ShOptions& options, const Progress& progress);
  Rgb glossy(const Slices& slices, const Vector3f& outgoing, size_t vertex) const;

  RivalScene scene_;
  int bands_;
  bool window_, glossy_ = false;
  Eigen::Index count_;           // of harmonics
  std::vector<Slices> slices_;   // of each material
  RgbHarmonics environment_;     // in its own frame
  RgbHarmonics light_;           // in the world
  RowMatrix vectors_;            // [#V][count], the diffuse transfer
  std::vector<float> matrices_;  // [#V][count][count], rows in the vertex's frame
  std::vector<float> arriving_;  // [#V][count][3], likewise
};

ShTransfer::ShTransfer(const RivalScene& scene, const ShOptions& options, const Progress& progress)
    : scene_(scene),
      bands_(options.order),
      window_(options.window),
      count_(Eigen::Index{options.order} * options.order) {
  for (const Material& material : scene.subject.materials) {
    slices_.push_back(options.glossy ? slices_of(material, bands_) : Slices{});
    glossy_ = glossy_ || !slices_.back().table.empty();
  }
  environment_ = project_environment(*scene.map, bands_);
  bake(options, progress);
}

void ShTransfer::bake(const ShOptions& options, const Progress& progress) {
  const Transfer& transfer = *scene_.subject.transfer;
  const RayScene& rays = scene_.rays->shadowing();
  const auto vertices = transfer.vertex_count(), size = static_cast<size_t>(count_);
  const int bands = glossy_ ? 2 * bands_ - 1 : bands_;
  const Texels texels(options.directions, bands);
  const VisibilitySampler sampler(
      rays, texels.directions, std::min(options.directions, VisibilitySampler::kDefaultCoarsest));
  const RowMatrix product = glossy_ ? harmonics_product(bands_) : RowMatrix();
  vectors_.resize(static_cast<Eigen::Index>(vertices), count_);
  if (glossy_) {
    matrices_.resize(vertices * size * size);
    arriving_.resize(vertices * size * 3);
  }
  const float solid_angle = 4 * kPi<float> / float(texels.position.cols());
  struct Scratch {
    VisibilityMask mask;
    VisibilitySampler::Scratch sampler;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  parallel_with_progress("harmonics", vertices, 16, progress, [&](size_t v) {
    Scratch& scratch = scratches.local();
    if (scratch.mask.resolution == 0) scratch.mask = VisibilityMask(options.directions);
    const Frame<float> frame = frame_from_normal_tangent(transfer.normals[v], transfer.tangents[v]);
    sampler.sample(transfer.positions[v] + rays.origin_offset() * frame.z, frame.z, scratch.mask,
                   scratch.sampler);
    Eigen::VectorXf visible = visible_texels(scratch.mask, solid_angle);
    const Eigen::VectorXf cosines = (frame.z.transpose() * texels.position).cwiseMax(0).transpose();
    vectors_.row(static_cast<Eigen::Index>(v)) =
        (texels.harmonics.topRows(count_) * visible.cwiseProduct(cosines)).transpose();
    if (!glossy_) return;
    mirror_at_horizon(texels, scratch.mask, frame.z, solid_angle, visible);
    const Eigen::VectorXf world = product * (texels.harmonics * visible);
    Eigen::Matrix3f local_from_world;
    local_from_world << frame.x.transpose(), frame.y.transpose(), frame.z.transpose();
    Eigen::Map<RowMatrix>(matrices_.data() + v * size * size, count_, count_) =
        harmonics_rotation(bands_, local_from_world) *
        Eigen::Map<const RowMatrix>(world.data(), count_, count_);
  });
}

void ShTransfer::prepare_lights(const Eigen::Matrix3f& world_from_environment) {
  light_ = harmonics_rotation(bands_, world_from_environment) * environment_;
  if (window_) apply_window(bands_, light_);
  if (!glossy_) return;
  const auto size = static_cast<size_t>(count_);
  tbb::parallel_for(size_t{0}, scene_.vertex_count(), [&](size_t v) {
    Eigen::Map<RgbHarmonics>(arriving_.data() + v * size * 3, count_, 3).noalias() =
        Eigen::Map<const RowMatrix>(matrices_.data() + v * size * size, count_, count_) * light_;
  });
}

Rgb ShTransfer::glossy(const Slices& slices, const Vector3f& outgoing, size_t vertex) const {
  float values[3 * 36];
  slices.table.eval(outgoing, values);
  const Eigen::Map<const Eigen::MatrixXf> slice(values, count_, slices.channels);
  const Eigen::Map<const RgbHarmonics> arriving(
      arriving_.data() + vertex * static_cast<size_t>(count_) * 3, count_, 3);
  Rgb sum;
  for (Eigen::Index c = 0; c < 3; ++c)
    sum[c] = slice.col(std::min(c, slices.channels - 1)).dot(arriving.col(c));
  return sum.max(0.0f);
}

void ShTransfer::shade(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const {
  const Subject& subject = scene_.subject;
  for (size_t i = 0; i < radiance.size(); ++i) {
    const size_t v = first + i, id = subject.material_of(v);
    const Eigen::RowVector3f irradiance = vectors_.row(static_cast<Eigen::Index>(v)) * light_;
    radiance[i] =
        subject.materials[id].diffuse / kPi<float> * irradiance.transpose().array().max(0.0f);
    if (slices_[id].table.empty()) continue;
    radiance[i] += glossy(slices_[id], view_vertex(*subject.transfer, v, eye).outgoing, v);
  }
}

}  // namespace

Rival sh_rival(const RivalScene& scene, const ShOptions& options, const Progress& progress) {
  require_complete(scene);
  if (options.order < 1 || options.order > 6)
    throw std::invalid_argument(
        fmt::format("spherical harmonics of order {}, expected 1..6", options.order));
  const LightRig& rig = scene.rig;
  if (!rig.spheres.empty() || !rig.rectangles.empty() || !rig.directionals.empty())
    throw std::invalid_argument("spherical harmonics have no local lights");
  const auto start = std::chrono::steady_clock::now();
  const auto transfer = std::make_shared<ShTransfer>(scene, options, progress);
  Rival rival;
  rival.bake_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rival.name = fmt::format("SH order {}{}", options.order, options.window ? ", windowed" : "");
  rival.bytes_per_vertex = transfer->bytes_per_vertex();
  rival.bytes_shared = transfer->bytes_shared();
  rival.prepare_lights = [transfer](const Eigen::Matrix3f& world_from_environment) {
    transfer->prepare_lights(world_from_environment);
  };
  rival.shade = [transfer](const Vector3f& eye, size_t first, std::span<Rgb> radiance) {
    transfer->shade(eye, first, radiance);
  };
  return rival;
}

}  // namespace burnish
