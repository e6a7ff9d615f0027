#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace burnish {

/// What a bake has finished so far, in a file beside its output: records that are appended as they
/// come and outlive a crash, a kill or a full disk. Each record carries a checksum; one that was
/// cut short, and all after it, count as not written.
///
/// While it is open the file is locked: a second bake of the same output is refused.
class BakeJournal {
 public:
  /// Named values that a bake's result depends on: what resume() compares.
  using Facts = std::vector<std::pair<std::string, std::string>>;

  struct Record {
    std::uint32_t kind = 0, index = 0;  ///< the bake's own; kind > 0
    std::vector<std::byte> payload;
    std::uint64_t offset = 0;  ///< in the file, for read()
  };

  /// Throws Error(ErrorKind::output) when the file cannot be opened or another process has it.
  explicit BakeJournal(std::string path);
  ~BakeJournal();
  BakeJournal(const BakeJournal&) = delete;
  BakeJournal& operator=(const BakeJournal&) = delete;

  const std::string& path() const { return path_; }

  /// Whether the file holds a bake that was begun.
  bool holds_work() const { return holds_work_; }

  /// Empties the file and notes what is about to be baked.
  void start(const Facts& facts);

  /// Hands every intact record to `visit`, in the order of writing, and cuts off what follows them.
  /// Throws Error(ErrorKind::input) that names the first of the facts that differs from those the
  /// journal was started with.
  void resume(const Facts& facts, const std::function<void(Record&&)>& visit);

  /// One of the records that resume() has handed out, again. Thread-safe. Throws
  /// Error(ErrorKind::input) when it is no longer there.
  Record read(std::uint64_t offset) const;

  /// Thread-safe; call after start() or resume(). Throws Error(ErrorKind::output), for a full disk
  /// above all; the records before it stay good.
  void append(std::uint32_t kind, std::uint32_t index, std::span<const std::byte> payload);

  /// Deletes the file, once the result is safe.
  void remove();

 private:
  bool read_record(std::uint64_t& offset, Record& record) const;
  [[noreturn]] void fail(const char* action, int error_number) const;

  std::string path_;
  int descriptor_ = -1;
  bool holds_work_ = false;
  std::mutex mutex_;
};

}  // namespace burnish
