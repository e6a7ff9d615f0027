#include "burnish/precompute/bake.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "bake_input.h"
#include "bake_model.h"
#include "bake_station.h"
#include "burnish/formats/error.h"
#include "byte_stream.h"
#include "mask_code.h"
#include "progress_monitor.h"

namespace burnish {
namespace {

// Vertices that are traced, projected and noted in the journal together. Fixed, so that a block's
// result does not depend on who computes it.
constexpr std::size_t kBlock = 96;

// Kinds of journal records; the index is the block's. What was trained is not noted: from the
// training set's masks it comes out the same again.
constexpr std::uint32_t kTrainingRecord = 1;  // BlockState and masks
constexpr std::uint32_t kResultRecord = 2;    // the bases' fingerprint, BlockState, coefficients

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What is known of a block of vertices.
struct BlockState {
  std::uint64_t rays = 0;
  std::uint64_t occluded = 0;  // vertices found to see less than their horizon leaves open
};

// Vertices in blocks.
class Blocks {
 public:
  explicit Blocks(const std::vector<std::uint32_t>& vertices) : vertices_(vertices) {}
  std::size_t size() const { return (vertices_.size() + kBlock - 1) / kBlock; }
  std::span<const std::uint32_t> operator[](std::size_t block) const {
    const std::size_t first = block * kBlock;
    return std::span(vertices_).subspan(first, std::min(kBlock, vertices_.size() - first));
  }

 private:
  const std::vector<std::uint32_t>& vertices_;
};

// One bake, stage by stage. Blocks of the training set come first in all that is kept by block.
class Bake {
 public:
  Bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
       const BakeOptions& options, const BakeRun& run, const BakeStation& station)
      : receiver_(receiver),
        occluders_(occluders),
        options_(options),
        run_(run),
        station_(station),
        roles_(assign_roles(station.normals(), options)),
        training_(roles_.training),
        others_(roles_.others),
        states_(training_.size() + others_.size()),
        recalled_masks_(training_.size()),
        recalled_results_(states_.size()) {
    if (roles_.training.empty())
      throw Error(ErrorKind::input, receiver_name(receiver),
                  "has no vertex with a finite position and a normal, expected at least one");
  }

  Transfer bake();
  BakeTimings timings() const;

 private:
  bool nothing_occludes() const;
  void open_journal();
  void trace_training();
  void trace_training_block(std::size_t block, BakeWorker& worker);
  bool recall_training_block(std::size_t block, BakeWorker& worker);
  bool finds_occlusion(std::uint32_t vertex, const VisibilityMask& mask);
  void trace_measured();
  void train();
  void measure();
  void project_all();
  void project_block(std::size_t block, BakeWorker& worker);
  bool recall_result(std::size_t block);
  void copy_to_transfer(std::span<const std::uint32_t> vertices, const BlockCoefficients& result);
  std::span<const std::uint32_t> vertices_of(std::size_t block) const;
  void copy_meshes();
  void describe();

  const TriangleMesh& receiver_;
  std::span<const TriangleMesh> occluders_;
  const BakeOptions& options_;
  const BakeRun& run_;
  const BakeStation& station_;
  const VertexRoles roles_;
  const Blocks training_, others_;

  std::vector<BlockState> states_;
  // Where the journal has blocks' records; 0: nowhere, as its facts are there.
  std::vector<std::uint64_t> recalled_masks_, recalled_results_;
  std::atomic<bool> occlusion_found_ = false;
  std::atomic<std::uint64_t> resumed_ = 0;  // vertices
  VisibilityRows training_rows_, measured_rows_;
  std::vector<VisibilityMask> measured_masks_;
  std::optional<BakeModel> model_;
  BakeWorkers workers_;
  Transfer transfer_;
  BakeTimings timings_;
};

Transfer Bake::bake() {
  copy_meshes();
  describe();
  open_journal();
  if (nothing_occludes()) return std::move(transfer_);
  transfer_.provenance.training_vertices = static_cast<int>(roles_.training.size());
  trace_training();
  trace_measured();
  train();
  measure();
  project_all();
  std::uint64_t occluded = 0;
  for (const BlockState& state : states_) {
    transfer_.provenance.rays += state.rays;
    occluded += state.occluded;
  }
  if (occluded > 0) {
    model_->write_bases(transfer_);
  } else {
    transfer_.basis_id.clear();
    transfer_.coefficients.clear();
    transfer_.ladder_coefficients.clear();
    Provenance& provenance = transfer_.provenance;
    provenance.training_vertices = provenance.residual_vertices = 0;
    provenance.residual_rms_rad = provenance.wrong_sign_fraction = 0;
    provenance.ssdf_errors.clear();
    provenance.ladder_errors.clear();
  }
  return std::move(transfer_);
}

BakeTimings Bake::timings() const {
  BakeTimings sum = timings_;
  sum.vertices_resumed = resumed_;
  for (const BakeWorker& worker : workers_) {
    sum.rays_cast += worker.rays;
    sum.rays_s += worker.rays_s;
    sum.distance_s += worker.distance_s;
    sum.project_s += worker.project_s;
  }
  return sum;
}

bool Bake::nothing_occludes() const {
  std::atomic<bool> open = true;
  ProgressMonitor monitor(run_.progress, "horizon", training_.size() + others_.size());
  tbb::parallel_for(std::size_t{0}, states_.size(), [&](std::size_t block) {
    if (!open) return;
    for (const std::uint32_t vertex : vertices_of(block))
      if (!station_.sees_all(vertex)) {
        open = false;
        return;
      }
    monitor.advance(1);
  });
  return open;
}

void Bake::open_journal() {
  if (!run_.journal) return;
  const BakeJournal::Facts facts = bake_facts(receiver_, occluders_, options_);
  if (!run_.resume) return run_.journal->start(facts);
  run_.journal->resume(facts, [&](BakeJournal::Record&& record) {
    auto* const kept = record.kind == kTrainingRecord ? &recalled_masks_
                       : record.kind == kResultRecord ? &recalled_results_
                                                      : nullptr;
    if (kept && record.index < kept->size()) (*kept)[record.index] = record.offset;
  });
}

void Bake::trace_training() {
  training_rows_.resize(roles_.training.size(), options_);
  ProgressMonitor monitor(run_.progress, "train", roles_.training.size());
  tbb::parallel_for(std::size_t{0}, training_.size(), [&](std::size_t block) {
    BakeWorker& worker = workers_.local();
    if (!recall_training_block(block, worker)) trace_training_block(block, worker);
    monitor.advance(training_[block].size());
  });
}

void Bake::trace_training_block(std::size_t block, BakeWorker& worker) {
  ByteWriter masks;
  BlockState state;
  for (std::size_t i = 0; i < training_[block].size(); ++i) {
    const std::uint32_t vertex = training_[block][i];
    state.rays += station_.trace(vertex, worker);
    state.occluded += finds_occlusion(vertex, worker.mask);
    if (run_.journal) encode_mask(worker.mask, masks);
    station_.derive_encoded(worker.mask, block * kBlock + i, training_rows_, worker);
  }
  states_[block] = state;
  if (!run_.journal) return;
  ByteWriter record;
  record.put(state);
  record.put(masks.bytes());
  run_.journal->append(kTrainingRecord, static_cast<std::uint32_t>(block), record.bytes());
}

bool Bake::recall_training_block(std::size_t block, BakeWorker& worker) {
  if (recalled_masks_[block] == 0) return false;
  const BakeJournal::Record found = run_.journal->read(recalled_masks_[block]);
  ByteReader record(found.payload);
  VisibilityMask mask(options_.directions);
  states_[block] = record.get<BlockState>();
  for (std::size_t i = 0; i < training_[block].size(); ++i) {
    decode_mask(record, mask);
    station_.derive_encoded(mask, block * kBlock + i, training_rows_, worker);
  }
  return record.complete();
}

// One vertex is enough: after that nobody looks.
bool Bake::finds_occlusion(std::uint32_t vertex, const VisibilityMask& mask) {
  if (occlusion_found_ || !station_.is_occluded(vertex, mask)) return false;
  occlusion_found_ = true;
  return true;
}

void Bake::trace_measured() {
  const Clock::time_point start = Clock::now();
  measured_masks_.resize(roles_.measured.size());
  measured_rows_.resize(roles_.measured.size(), options_);
  ProgressMonitor monitor(run_.progress, "measure", measured_masks_.size());
  tbb::parallel_for(std::size_t{0}, measured_masks_.size(), [&](std::size_t i) {
    BakeWorker& worker = workers_.local();
    station_.trace(roles_.measured[i], worker);
    measured_masks_[i] = worker.mask;
    station_.derive(worker.mask, i, measured_rows_, worker);
    monitor.advance(1);
  });
  timings_.measure_s += seconds_since(start);
}

void Bake::train() {
  const auto step = [&](std::uint64_t done, std::uint64_t total) {
    if (run_.progress && !run_.progress("basis", done, total)) throw Cancelled();
  };
  model_.emplace(training_rows_, measured_rows_, options_, step, timings_);
}

void Bake::measure() {
  const Clock::time_point start = Clock::now();
  model_->measure(measured_rows_, measured_masks_, transfer_.provenance);
  transfer_.provenance.residual_vertices = static_cast<int>(measured_masks_.size());
  transfer_.provenance.residual_held_out = roles_.held_out;
  measured_masks_ = {};
  measured_rows_ = {};
  timings_.measure_s += seconds_since(start);
}

std::span<const std::uint32_t> Bake::vertices_of(std::size_t block) const {
  return block < training_.size() ? training_[block] : others_[block - training_.size()];
}

void Bake::project_all() {
  const std::size_t vertices = receiver_.positions.size();
  transfer_.basis_id.assign(vertices, 0);
  transfer_.coefficients.assign(vertices * model_->terms(), 0.0f);
  transfer_.ladder_coefficients.assign(vertices * model_->ladder_terms(), 0.0f);
  ProgressMonitor monitor(run_.progress, "bake", roles_.training.size() + roles_.others.size());
  tbb::parallel_for(std::size_t{0}, states_.size(), [&](std::size_t block) {
    if (!recall_result(block)) project_block(block, workers_.local());
    monitor.advance(vertices_of(block).size());
  });
}

void Bake::project_block(std::size_t block, BakeWorker& worker) {
  const std::span<const std::uint32_t> vertices = vertices_of(block);
  const bool is_training = block < training_.size();
  if (!is_training) {
    worker.rows.resize(vertices.size(), options_);
    BlockState state;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      state.rays += station_.trace(vertices[i], worker);
      state.occluded += finds_occlusion(vertices[i], worker.mask);
      station_.derive_encoded(worker.mask, i, worker.rows, worker);
    }
    states_[block] = state;
  }
  const Clock::time_point start = Clock::now();
  BlockCoefficients result(vertices.size(), *model_);
  model_->project(is_training ? training_rows_ : worker.rows, is_training ? block * kBlock : 0,
                  result, worker.projection);
  worker.project_s += seconds_since(start);
  copy_to_transfer(vertices, result);
  if (!run_.journal) return;
  ByteWriter record;
  record.put(model_->fingerprint());
  record.put(states_[block]);
  result.write(record);
  run_.journal->append(kResultRecord, static_cast<std::uint32_t>(block), record.bytes());
}

bool Bake::recall_result(std::size_t block) {
  if (recalled_results_[block] == 0) return false;
  const BakeJournal::Record found = run_.journal->read(recalled_results_[block]);
  ByteReader record(found.payload);
  // Coefficients of other bases (another processor's or library's rounding) would mean nothing.
  if (record.get<std::uint64_t>() != model_->fingerprint()) return false;
  BlockCoefficients result(vertices_of(block).size(), *model_);
  const auto state = record.get<BlockState>();
  result.read(record);
  if (!record.complete()) return false;
  states_[block] = state;
  copy_to_transfer(vertices_of(block), result);
  resumed_ += vertices_of(block).size();
  return true;
}

void Bake::copy_to_transfer(std::span<const std::uint32_t> vertices,
                            const BlockCoefficients& result) {
  const auto copy_rows = [&](const std::vector<float>& from, std::vector<float>& to,
                             std::size_t terms) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      std::copy_n(from.data() + i * terms, terms, to.data() + vertices[i] * terms);
  };
  copy_rows(result.ssdf, transfer_.coefficients, model_->terms());
  copy_rows(result.ladder, transfer_.ladder_coefficients, model_->ladder_terms());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    transfer_.basis_id[vertices[i]] = result.basis_id[i];
}

void Bake::copy_meshes() {
  transfer_.positions = receiver_.positions;
  transfer_.normals = receiver_.normals;
  transfer_.tangents = receiver_.tangents;
  transfer_.file_vertex = receiver_.file_vertex;
  transfer_.triangles = receiver_.triangles;
  transfer_.texcoords = receiver_.uvs;
  make_storable(transfer_);
  transfer_.parts = receiver_.parts;
  if (transfer_.parts.empty())
    transfer_.parts.push_back({receiver_.name, 0,
                               static_cast<std::uint32_t>(receiver_.positions.size()), 0,
                               static_cast<std::uint32_t>(receiver_.triangles.size())});
  for (const TriangleMesh& occluder : occluders_) {
    const std::size_t first = transfer_.occluder_positions.size();
    if (first + occluder.positions.size() > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorKind::input, "bake",
                  fmt::format("the occluders have {} or more vertices together, expected at most "
                              "2^32 - 1",
                              first + occluder.positions.size()));
    transfer_.occluder_positions.insert(transfer_.occluder_positions.end(),
                                        occluder.positions.begin(), occluder.positions.end());
    for (Triangle triangle : occluder.triangles) {
      for (std::uint32_t& v : triangle) v += static_cast<std::uint32_t>(first);
      transfer_.occluder_triangles.push_back(triangle);
    }
  }
}

// All that does not have to be measured.
void Bake::describe() {
  Provenance& provenance = transfer_.provenance;
  provenance.version = BURNISH_VERSION;
  provenance.mesh_name = receiver_.name;
  provenance.mesh_hash = hash_of(receiver_);
  provenance.occluder_hash = hash_of(occluders_);
  provenance.directions = options_.directions;
  provenance.coarsest = std::min(options_.coarsest, options_.directions);
  provenance.origin_offset = station_.origin_offset();
}

// The scene of the run, or one that is made for it.
class RunScene {
 public:
  RunScene(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
           const BakeRun& run) {
    const Clock::time_point start = Clock::now();
    if (!run.scene) made_.emplace(make_ray_scene(receiver, occluders));
    scene_ = run.scene ? run.scene : &*made_;
    seconds_ = seconds_since(start);
  }
  const RayScene& get() const { return *scene_; }
  double seconds() const { return seconds_; }

 private:
  std::optional<RayScene> made_;
  const RayScene* scene_;
  double seconds_ = 0;
};

}  // namespace

RayScene make_ray_scene(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders) {
  RayScene scene;
  scene.add_mesh(receiver.positions, receiver.triangles);
  for (const TriangleMesh& occluder : occluders)
    scene.add_mesh(occluder.positions, occluder.triangles);
  scene.commit();
  return scene;
}

Transfer bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
              const BakeOptions& options, const BakeRun& run) {
  const Clock::time_point start = Clock::now();
  check_bake_options(options);
  check_receiver(receiver);
  const RunScene scene(receiver, occluders, run);
  const BakeStation station(receiver, scene.get(), options);
  Bake work(receiver, occluders, options, run, station);
  Transfer transfer = work.bake();
  if (run.timings) {
    *run.timings = work.timings();
    run.timings->scene_s = scene.seconds();
    run.timings->total_s = seconds_since(start);
  }
  return transfer;
}

VisibilityVerification verify_visibility(const TriangleMesh& receiver,
                                         std::span<const TriangleMesh> occluders,
                                         const BakeOptions& options, int count, std::uint64_t seed,
                                         const BakeRun& run) {
  check_bake_options(options);
  check_receiver(receiver);
  const RunScene scene(receiver, occluders, run);
  const BakeStation station(receiver, scene.get(), options);
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < receiver.positions.size(); ++v)
    if (!station.normals()[v].isZero(0)) vertices.push_back(v);
  // The first of a random order: std::shuffle differs between standard libraries.
  std::mt19937_64 random(seed);
  const std::size_t wanted = std::min(vertices.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < wanted; ++i)
    std::swap(vertices[i], vertices[i + random() % (vertices.size() - i)]);
  vertices.resize(wanted);

  BakeWorkers workers;
  std::vector<VertexVerification> found(wanted);
  ProgressMonitor monitor(run.progress, "verify", wanted);
  tbb::parallel_for(std::size_t{0}, wanted, [&](std::size_t i) {
    found[i] = station.verify(vertices[i], workers.local());
    monitor.advance(1);
  });
  VisibilityVerification sum;
  sum.vertices = wanted;
  for (std::size_t i = 0; i < wanted; ++i) {
    sum.directions += found[i].directions;
    sum.differing += found[i].differing;
    if (found[i].worst_ssdf_error_rad > sum.worst_ssdf_error_rad) {
      sum.worst_ssdf_error_rad = found[i].worst_ssdf_error_rad;
      sum.worst_vertex = vertices[i];
    }
  }
  return sum;
}

}  // namespace burnish
