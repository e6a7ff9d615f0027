#include "burnish/precompute/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "point_tree.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace burnish {
namespace {

// The differences between Embree 3 and 4: how a query is told that its rays are coherent.
#if RTC_VERSION_MAJOR >= 4
void query_intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray); }
void query_occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray); }
void query_occluded16(const int* valid, RTCScene scene, RTCRay16& rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &rays, &arguments);
}
#else
void query_intersect(RTCScene scene, RTCRayHit& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
}
void query_occluded(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
void query_occluded16(const int* valid, RTCScene scene, RTCRay16& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &context, &rays);
}
#endif

constexpr const char* kSubject = "ray scene";
constexpr float kLargestCoordinate = 1e30f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool is_usable(const Vector3f& p) {
  return std::abs(p.x()) <= kLargestCoordinate && std::abs(p.y()) <= kLargestCoordinate &&
         std::abs(p.z()) <= kLargestCoordinate;  // false for NaN
}

bool is_usable(const Triangle& triangle, const Vector3f* positions) {
  return std::all_of(triangle.begin(), triangle.end(),
                     [&](std::uint32_t v) { return is_usable(positions[v]); });
}

struct Device {
  RTCDevice handle = nullptr;
  std::mutex mutex;
  std::string error;  // the first one reported

  // Embree calls this from any of its threads.
  static void report(void* self, RTCError, const char* text) {
    auto* device = static_cast<Device*>(self);
    const std::lock_guard lock(device->mutex);
    if (device->error.empty()) device->error = text ? text : "unknown error";
  }

  Device() {
    handle = rtcNewDevice(nullptr);
    if (!handle)
      throw Error(ErrorKind::unsupported, kSubject,
                  fmt::format("Embree could not be started (error {})",
                              static_cast<int>(rtcGetDeviceError(nullptr))));
    rtcSetDeviceErrorFunction(handle, &Device::report, this);
  }
  ~Device() { rtcReleaseDevice(handle); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void check(const char* doing) {
    const std::lock_guard lock(mutex);
    if (!error.empty())
      throw Error(ErrorKind::input, kSubject, fmt::format("Embree failed {}: {}", doing, error));
  }
};

// Bounds of the corners of all triangles that can be hit.
struct Bounds {
  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;

  void include(const Vector3f& p) {
    lower = lower.cwiseMin(p.cast<double>());
    upper = upper.cwiseMax(p.cast<double>());
  }
  bool empty() const { return !(lower.x() <= upper.x()); }
};

}  // namespace

struct RayScene::Impl {
  Device device;
  RTCScene scene = nullptr;
  // A mesh's geometry, with world coordinates, from add_mesh() to commit().
  struct PendingMesh {
    RTCGeometry geometry = nullptr;  // none without triangles
    std::size_t vertices = 0, triangles = 0;
  };
  std::vector<PendingMesh> pending;
  Bounds bounds;
  PointTree corners;  // of all triangles that can be hit, inside
  bool committed = false;

  // inside = (world - center) * scale, in double, rounded once; scale is a power of two, so that
  // only the move can round.
  Vector3d center = Vector3d::Zero();
  double scale = 1;
  float offset = 0;

  Impl() {
    scene = rtcNewScene(device.handle);
    // Robust: no ray slips through the edge between two triangles, however the tree was built.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    device.check("making a scene");
  }
  ~Impl() {
    for (const PendingMesh& mesh : pending)
      if (mesh.geometry) rtcReleaseGeometry(mesh.geometry);
    rtcReleaseScene(scene);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Vector3f to_inside(const Vector3f& p) const {
    return ((p.cast<double>() - center) * scale).cast<float>();
  }

  void choose_scale() {
    if (bounds.empty()) return;
    center = (bounds.lower + bounds.upper) / 2;
    const double size = (bounds.upper - bounds.lower).maxCoeff();
    int exponent = 0;
    std::frexp(size, &exponent);  // size in [2^(exponent-1), 2^exponent), or 0
    if (size > 0) scale = std::ldexp(1.0, -exponent);
    const double largest =
        std::max(bounds.lower.cwiseAbs().maxCoeff(), bounds.upper.cwiseAbs().maxCoeff());
    // Four steps of float at the largest coordinate: far from the origin of the axes a smaller
    // offset would be rounded away when it is added to a position.
    offset = static_cast<float>(std::max(
        std::ldexp(size, -16), 4 * largest * double(std::numeric_limits<float>::epsilon())));
  }

  void add(std::span<const Vector3f> positions, std::span<const Triangle> triangles) {
    pending.emplace_back();
    if (triangles.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device.handle, RTC_GEOMETRY_TYPE_TRIANGLE);
    pending.back() = {geometry, positions.size(), triangles.size()};
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(Vector3f), positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(Triangle), triangles.size());
    device.check("copying a mesh");
    std::memcpy(vertices, positions.data(), positions.size_bytes());
    std::memcpy(indices, triangles.data(), triangles.size_bytes());
    for (const Triangle& triangle : triangles)
      if (is_usable(triangle, positions.data()))
        for (const std::uint32_t v : triangle) bounds.include(positions[v]);
  }

  // Moves the vertices of a mesh inside, where they are, and adds those of triangles that can be
  // hit to `points`.
  void build(unsigned id, std::vector<Vector3f>& points) {
    const auto [geometry, vertex_count, triangle_count] = std::exchange(pending[id], {});
    if (!geometry) return;
    auto* vertices =
        static_cast<Vector3f*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    const auto* indices =
        static_cast<const Triangle*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0));
    std::vector<bool> used(vertex_count);
    for (std::size_t i = 0; i < triangle_count; ++i)
      if (is_usable(indices[i], vertices))
        for (const std::uint32_t v : indices[i]) used[v] = true;
    // Embree leaves out a triangle with a NaN corner.
    const Vector3f unusable = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < used.size(); ++i) {
      vertices[i] = is_usable(vertices[i]) ? to_inside(vertices[i]) : unusable;
      if (used[i]) points.push_back(vertices[i]);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
    device.check("adding a mesh");
  }
};

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

void RayScene::add_mesh(std::span<const Vector3f> positions, std::span<const Triangle> triangles) {
  if (impl_->committed)
    throw Error(ErrorKind::input, kSubject, "a mesh was added after the scene was committed");
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t v : triangles[i])
      if (v >= positions.size())
        throw Error(ErrorKind::input, kSubject,
                    fmt::format("triangle {} of mesh {} uses vertex {}, expected below {}", i,
                                impl_->pending.size(), v, positions.size()));
  impl_->add(positions, triangles);
}

void RayScene::commit() {
  if (impl_->committed) throw Error(ErrorKind::input, kSubject, "committed twice");
  impl_->choose_scale();
  std::vector<Vector3f> corners;
  for (std::size_t i = 0; i < impl_->pending.size(); ++i)
    impl_->build(static_cast<unsigned>(i), corners);
  rtcCommitScene(impl_->scene);
  impl_->corners = PointTree(std::move(corners));
  impl_->device.check("building the scene");
  impl_->pending = {};
  impl_->committed = true;
}

float RayScene::origin_offset() const { return impl_->offset; }

namespace {

void set_ray(RTCRay& ray, const Vector3f& origin, const Vector3f& direction, float far) {
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.tnear = 0;
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.time = 0;
  ray.tfar = far;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
}

}  // namespace

bool RayScene::intersect(const Vector3f& origin, const Vector3f& direction, RayHit& hit) const {
  const Vector3f inside = impl_->to_inside(origin);
  if (!impl_->committed || !inside.allFinite() || !direction.allFinite()) return false;
  RTCRayHit ray;
  set_ray(ray.ray, inside, direction, kInfinity);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  query_intersect(impl_->scene, ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.mesh = ray.hit.geomID;
  hit.triangle = ray.hit.primID;
  hit.u = ray.hit.u;
  hit.v = ray.hit.v;
  hit.distance = static_cast<float>(ray.ray.tfar / impl_->scale);
  return true;
}

bool RayScene::occluded(const Vector3f& origin, const Vector3f& direction,
                        float max_distance) const {
  const Vector3f inside = impl_->to_inside(origin);
  if (!impl_->committed || !inside.allFinite() || !direction.allFinite()) return false;
  RTCRay ray;
  const double far = double(max_distance) * impl_->scale;
  set_ray(ray, inside, direction, far < kLargestCoordinate ? static_cast<float>(far) : kInfinity);
  query_occluded(impl_->scene, ray);
  return ray.tfar < 0;  // Embree's mark of a hit: -infinity
}

std::uint32_t RayScene::occluded16(const Vector3f& origin, const float* x, const float* y,
                                   const float* z, std::uint32_t active) const {
  const Vector3f inside = impl_->to_inside(origin);
  if (!impl_->committed || !inside.allFinite()) return 0;
  constexpr int kWidth = 16;
  alignas(64) int valid[kWidth];
  RTCRay16 rays;
  for (int i = 0; i < kWidth; ++i) {
    valid[i] = -static_cast<int>(active >> i & 1u);
    rays.org_x[i] = inside.x();
    rays.org_y[i] = inside.y();
    rays.org_z[i] = inside.z();
    rays.tnear[i] = 0;
    rays.time[i] = 0;
    rays.tfar[i] = kInfinity;
    rays.mask[i] = ~0u;
    rays.id[i] = 0;
    rays.flags[i] = 0;
  }
  std::copy_n(x, kWidth, rays.dir_x);
  std::copy_n(y, kWidth, rays.dir_y);
  std::copy_n(z, kWidth, rays.dir_z);
  query_occluded16(valid, impl_->scene, rays);
  std::uint32_t occluded = 0;
  for (int i = 0; i < kWidth; ++i) occluded |= static_cast<std::uint32_t>(rays.tfar[i] < 0) << i;
  return occluded & active;
}

bool RayScene::hemisphere_is_empty(const Vector3f& origin, const Vector3f& normal) const {
  const Vector3f inside = impl_->to_inside(origin);
  if (!impl_->committed || !inside.allFinite()) return true;
  // The scene is at most 1 wide. The margin covers the rounding of directions, of their cosines and
  // of the planes' heights, all a few parts in 10^7, and is a tenth of origin_offset().
  const float margin = 1e-6f * (1 + inside.norm());
  return !impl_->corners.any_above(normal, normal.dot(inside) - margin);
}

}  // namespace burnish
