#include "burnish/precompute/bake.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/pca.h"
#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/precompute/visibility_mask.h"
#include "fnv1a.h"
#include "progress_monitor.h"

namespace burnish {
namespace {

// Vertices that are projected together. Fixed, so that a block's result does not depend on who
// computes it.
constexpr std::size_t kBlock = 32;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void check_range(const char* name, int value, int lowest, int highest, bool power_of_two) {
  if (value < lowest || value > highest ||
      (power_of_two && !std::has_single_bit(static_cast<unsigned>(value))))
    throw Error(ErrorKind::input, "bake",
                fmt::format("{} is {}, expected {}{}..{}", name, value,
                            power_of_two ? "a power of two in " : "", lowest, highest));
}

void check_options(const BakeOptions& options) {
  check_range("directions", options.directions, 64, 1024, true);
  check_range("resolution", options.resolution, 16, options.directions, true);
  check_range("terms", options.terms, 1, options.resolution * options.resolution, false);
  check_range("training_vertices", options.training_vertices, 0, std::numeric_limits<int>::max(),
              false);
}

void check_receiver(const TriangleMesh& mesh) {
  const std::string name = mesh.name.empty() ? "receiver" : mesh.name;
  if (mesh.triangles.empty())
    throw Error(ErrorKind::input, name, "has no triangles, expected at least one");
  const std::size_t vertices = mesh.positions.size();
  const auto check = [&](const char* what, std::size_t size) {
    if (size != vertices)
      throw Error(ErrorKind::input, name,
                  fmt::format("has {} {}, expected one a vertex ({})", size, what, vertices));
  };
  check("normals", mesh.normals.size());
  check("tangents", mesh.tangents.size());
  check("file vertex numbers", mesh.file_vertex.size());
}

// Unit normals; zero where a vertex cannot be baked.
std::vector<Vector3f> usable_normals(const TriangleMesh& mesh) {
  std::vector<Vector3f> normals(mesh.normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vector3d normal = mesh.normals[i].cast<double>();
    const double length = normal.norm();
    const bool usable = mesh.positions[i].allFinite() && std::isfinite(length) && length > 0;
    normals[i] = usable ? Vector3f((normal / length).cast<float>()) : Vector3f::Zero();
  }
  return normals;
}

// The vertices to train on and the others, both in rising order.
struct Selection {
  std::vector<std::uint32_t> training, others;
};

Selection select_training(const std::vector<Vector3f>& normals, int wanted) {
  std::vector<std::uint32_t> usable;
  for (std::uint32_t i = 0; i < normals.size(); ++i)
    if (!normals[i].isZero(0)) usable.push_back(i);
  const std::uint64_t all = usable.size();
  const std::uint64_t count =
      wanted == 0 ? all : std::min<std::uint64_t>(static_cast<std::uint64_t>(wanted), all);
  Selection selection;
  std::uint64_t chosen = 0;
  for (std::uint64_t i = 0; i < all; ++i) {
    // The middle of each of `count` equal stretches.
    const bool train = chosen < count && i == (2 * chosen + 1) * all / (2 * count);
    chosen += train;
    (train ? selection.training : selection.others).push_back(usable[i]);
  }
  return selection;
}

// What one thread needs, and what it has counted.
struct Worker {
  VisibilityMask mask;
  SphericalDistanceTransform::Scratch scratch;
  RowMatrixf block;
  std::uint64_t rays = 0;
  double rays_s = 0, distance_s = 0, project_s = 0;
};
using Workers = tbb::enumerable_thread_specific<Worker>;

// Everything that is the same for every vertex.
struct Station {
  const TriangleMesh& mesh;
  std::vector<Vector3f> normals;
  RayScene scene;
  DirectionTable directions;
  SphericalDistanceTransform transform;

  Station(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
          const BakeOptions& options)
      : mesh(receiver),
        normals(usable_normals(receiver)),
        directions(options.directions),
        transform(directions, options.resolution) {
    scene.add_mesh(receiver.positions, receiver.triangles);
    for (const TriangleMesh& occluder : occluders)
      scene.add_mesh(occluder.positions, occluder.triangles);
    scene.commit();
  }

  Eigen::Index texels() const {
    return Eigen::Index{transform.resolution()} * transform.resolution();
  }

  void compute_ssdf(std::uint32_t vertex, std::span<float> ssdf, Worker& worker) const {
    if (worker.mask.resolution == 0) worker.mask = VisibilityMask(directions.resolution());
    const Clock::time_point start = Clock::now();
    worker.rays +=
        sample_visibility(scene, directions, mesh.positions[vertex], normals[vertex], worker.mask);
    const Clock::time_point middle = Clock::now();
    transform.transform(worker.mask, ssdf, worker.scratch);
    worker.rays_s += std::chrono::duration<double>(middle - start).count();
    worker.distance_s += seconds_since(middle);
  }
};

std::span<float> row_of(RowMatrixf& matrix, Eigen::Index row) {
  return {matrix.row(row).data(), static_cast<std::size_t>(matrix.cols())};
}

RowMatrixf compute_training(const Station& station, const std::vector<std::uint32_t>& training,
                            const Progress& progress, Workers& workers) {
  RowMatrixf ssdfs(static_cast<Eigen::Index>(training.size()), station.texels());
  ProgressMonitor monitor(progress, "train", training.size());
  tbb::parallel_for(std::size_t{0}, training.size(), [&](std::size_t i) {
    station.compute_ssdf(training[i], row_of(ssdfs, static_cast<Eigen::Index>(i)), workers.local());
    monitor.advance(1);
  });
  return ssdfs;
}

// Writes coefficients where the transfer keeps them, block by block; each block's residual is kept
// apart so that the sum's order is fixed.
class Projector {
 public:
  Projector(const PcaBasis& basis, Transfer& transfer) : basis_(basis), transfer_(transfer) {}

  PcaResidual project(const Eigen::Ref<const RowMatrixf>& centred,
                      std::span<const std::uint32_t> vertices, Worker& worker) const {
    const Clock::time_point start = Clock::now();
    const auto terms = static_cast<std::size_t>(basis_.terms());
    std::vector<float> coefficients(vertices.size() * terms);
    const PcaResidual residual = project_pca(basis_, centred, coefficients);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      std::copy_n(coefficients.data() + i * terms, terms,
                  transfer_.coefficients.data() + vertices[i] * terms);
    worker.project_s += seconds_since(start);
    return residual;
  }

 private:
  const PcaBasis& basis_;
  Transfer& transfer_;
};

template <class Body>
PcaResidual for_vertex_blocks(const std::vector<std::uint32_t>& vertices, const Body& body) {
  std::vector<PcaResidual> residuals((vertices.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t{0}, residuals.size(), [&](std::size_t i) {
    const std::size_t first = i * kBlock;
    residuals[i] =
        body(first, std::span(vertices).subspan(first, std::min(kBlock, vertices.size() - first)));
  });
  PcaResidual sum;
  for (const PcaResidual& residual : residuals) sum += residual;
  return sum;
}

PcaResidual project_training(const Selection& selection, const RowMatrixf& centred,
                             const Projector& projector, Workers& workers) {
  return for_vertex_blocks(
      selection.training, [&](std::size_t first, std::span<const std::uint32_t> vertices) {
        return projector.project(centred.middleRows(static_cast<Eigen::Index>(first),
                                                    static_cast<Eigen::Index>(vertices.size())),
                                 vertices, workers.local());
      });
}

PcaResidual project_others(const Station& station, const Selection& selection,
                           const PcaBasis& basis, const Projector& projector,
                           const Progress& progress, Workers& workers) {
  ProgressMonitor monitor(progress, "bake", selection.others.size());
  return for_vertex_blocks(
      selection.others, [&](std::size_t, std::span<const std::uint32_t> vertices) {
        Worker& worker = workers.local();
        worker.block.resize(static_cast<Eigen::Index>(vertices.size()), station.texels());
        for (std::size_t i = 0; i < vertices.size(); ++i) {
          const auto row = static_cast<Eigen::Index>(i);
          station.compute_ssdf(vertices[i], row_of(worker.block, row), worker);
          worker.block.row(row) -= basis.mean;
          monitor.advance(1);
        }
        return projector.project(worker.block, vertices, worker);
      });
}

void add_mesh_to(const TriangleMesh& mesh, Fnv1a& hash) {
  hash.add(std::span(mesh.positions));
  hash.add(std::span(mesh.normals));
  hash.add(std::span(mesh.tangents));
  hash.add(std::span(mesh.triangles));
}

void copy_meshes(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
                 Transfer& transfer) {
  transfer.positions = receiver.positions;
  transfer.normals = receiver.normals;
  transfer.tangents = receiver.tangents;
  transfer.file_vertex = receiver.file_vertex;
  transfer.triangles = receiver.triangles;
  for (const TriangleMesh& occluder : occluders) {
    const std::size_t first = transfer.occluder_positions.size();
    if (first + occluder.positions.size() > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorKind::input, "bake", "the occluders have more than 2^32 vertices together");
    transfer.occluder_positions.insert(transfer.occluder_positions.end(),
                                       occluder.positions.begin(), occluder.positions.end());
    for (Triangle triangle : occluder.triangles) {
      for (std::uint32_t& v : triangle) v += static_cast<std::uint32_t>(first);
      transfer.occluder_triangles.push_back(triangle);
    }
  }
}

SsdfBasis to_ssdf_basis(const PcaBasis& basis, int resolution) {
  SsdfBasis result;
  result.resolution = resolution;
  result.terms = static_cast<int>(basis.terms());
  result.mean.assign(basis.mean.data(), basis.mean.data() + basis.mean.size());
  result.eigen.assign(basis.components.data(), basis.components.data() + basis.components.size());
  return result;
}

// All but the number of rays.
Provenance describe(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
                    const BakeOptions& options, const Selection& selection,
                    Eigen::Index texels_each, const PcaResidual& residual) {
  Provenance provenance;
  provenance.version = BURNISH_VERSION;
  provenance.mesh_name = receiver.name;
  Fnv1a mesh_hash, occluder_hash;
  add_mesh_to(receiver, mesh_hash);
  for (const TriangleMesh& occluder : occluders) add_mesh_to(occluder, occluder_hash);
  provenance.mesh_hash = mesh_hash.hex();
  if (!occluders.empty()) provenance.occluder_hash = occluder_hash.hex();
  provenance.directions = options.directions;
  provenance.training_vertices = static_cast<int>(selection.training.size());
  const double texels = static_cast<double>(texels_each) *
                        static_cast<double>(selection.training.size() + selection.others.size());
  provenance.residual_rms_rad = std::sqrt(residual.squared / texels);
  provenance.wrong_sign_fraction = static_cast<double>(residual.wrong_signs) / texels;
  return provenance;
}

}  // namespace

Transfer bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
              const BakeOptions& options, const Progress& progress, BakeTimings* timings) {
  const Clock::time_point start = Clock::now();
  check_options(options);
  check_receiver(receiver);
  const Station station(receiver, occluders, options);
  const Selection selection = select_training(station.normals, options.training_vertices);
  if (selection.training.empty())
    throw Error(ErrorKind::input, receiver.name.empty() ? "receiver" : receiver.name,
                "has no vertex with a finite position and a normal, expected at least one");

  Workers workers;
  RowMatrixf training = compute_training(station, selection.training, progress, workers);

  // The passes of the decomposition, and one more for the coefficients of what it was trained on.
  std::uint64_t passes = 0;
  const auto report = [&](std::uint64_t done) {
    if (progress && !progress("basis", done, passes + 1)) throw Cancelled();
  };
  const Clock::time_point pca_start = Clock::now();
  const PcaBasis basis = train_pca(training, {.terms = options.terms}, [&](int done, int total) {
    passes = static_cast<std::uint64_t>(total);
    report(static_cast<std::uint64_t>(done));
  });
  const double pca_s = seconds_since(pca_start);

  Transfer transfer;
  copy_meshes(receiver, occluders, transfer);
  transfer.bases.push_back(to_ssdf_basis(basis, options.resolution));
  transfer.basis_id.assign(receiver.positions.size(), 0);
  transfer.coefficients.assign(receiver.positions.size() * static_cast<std::size_t>(basis.terms()),
                               0.0f);
  const Projector projector(basis, transfer);
  PcaResidual residual = project_training(selection, training, projector, workers);
  training.resize(0, 0);
  report(passes + 1);
  residual += project_others(station, selection, basis, projector, progress, workers);

  transfer.provenance =
      describe(receiver, occluders, options, selection, station.texels(), residual);
  BakeTimings spent;
  for (const Worker& worker : workers) {
    transfer.provenance.rays += worker.rays;
    spent.rays_s += worker.rays_s;
    spent.distance_s += worker.distance_s;
    spent.project_s += worker.project_s;
  }
  spent.pca_s = pca_s;
  spent.total_s = seconds_since(start);
  if (timings) *timings = spent;
  return transfer;
}

}  // namespace burnish
