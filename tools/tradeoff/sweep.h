#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tradeoff/settings.h"
#include "tradeoff/trial.h"

/// A sweep: rows of measurements that are kept as they come, so that one that was interrupted goes
/// on where it stopped.
namespace burnish::tools {

/// To be raised when what a row says, or how it is measured, changes: older rows are then measured
/// again.
inline constexpr int kSweepVersion = 2;

/// Who made a row.
enum class RowKind {
  grid,    ///< our runtime by settings of the grid
  preset,  ///< by a quality of the command line, as it is
  paper,   ///< by the papers' choices
  rival,   ///< another way to shade
};
std::string name_of(RowKind kind);

/// A measurement. Figures that do not apply are 0.
struct SweepRow {
  std::string key;   ///< hash of all it depends on
  std::string name;  ///< unique in a sweep
  RowKind kind = RowKind::grid;
  nlohmann::ordered_json settings;  ///< settings_json, of a rival those it was built on
  double frame_ms = 0;              ///< all vertices, all threads, lights included
  double frame_cpu_ms = 0;          ///< the same as processor time, summed over threads
  double prepare_ms = 0;
  double bake_s = 0;
  double memory_bytes = 0;  ///< of what shading keeps of the mesh
  double bytes_per_vertex = 0;
  double file_bytes = 0;
  double relative_l2 = 0;  ///< without the truth's noise
  double truth_noise = 0;
  bool below_noise = false;  ///< the truth cannot tell how large the error is
  double absolute_mean = 0;  ///< of the mean radiance, as the percentiles
  double absolute_95 = 0;
  double absolute_999 = 0;
};

/// The figures of an outcome.
SweepRow sweep_row(const TrialOutcome& outcome, size_t vertices);

/// The hash of a row that depends on `parts`, and on kSweepVersion.
std::string sweep_key(const std::vector<std::string>& parts);

/// Something to measure: a row's key, name, kind and settings, and what finds its figures. Without
/// the latter a row is kept where it is known, and else left out.
struct SweepEntry {
  SweepRow row;
  std::function<SweepRow()> measure;
};

/// Rows of all entries, in their order: those of `known` with the same key are taken as they are,
/// under the entry's name; the rest are measured. Entries of one key are one row, the first. Calls
/// `save` after each row that was measured with all rows so far, known ones of later entries
/// included. What `measure` throws ends it.
std::vector<SweepRow> run_sweep(const std::vector<SweepEntry>& entries,
                                const std::vector<SweepRow>& known,
                                const std::function<void(const std::vector<SweepRow>&)>& save);

/// A sweep as it is stored, and what it was made on.
struct Sweep {
  std::string scene;        ///< name, for people
  std::string environment;  ///< name, for people
  std::string scene_key;    ///< of Trial::key
  size_t vertices = 0;
  nlohmann::ordered_json machine;   ///< machine_record
  nlohmann::ordered_json pictures;  ///< [{"file", "caption", ...}], or null
  std::vector<SweepRow> rows;
};

/// {"format": "burnish tradeoff", "format_version": 1, ...}.
nlohmann::ordered_json sweep_json(const Sweep& sweep);

/// Reads what sweep_json wrote. Throws Error(ErrorKind::input) that names the file, the field, what
/// was found and what is expected.
Sweep read_sweep(const std::string& path);

/// A row with its settings side by side, one column a dial: {"name", ..., "bake.terms": 48, ...}.
nlohmann::ordered_json flat_row(const SweepRow& row);

}  // namespace burnish::tools
