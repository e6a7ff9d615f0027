#pragma once

#include <span>
#include <string>
#include <string_view>

namespace burnish {

/// A file that appears whole or not at all. It is written under a temporary name in the folder of
/// its target and takes the target's name in commit(); until then an older file of that name stays
/// as it is. Without commit() the destructor removes the temporary.
///
///     OutputFile file("dish.h5");
///     file.write(bytes);
///     file.commit();
///
/// - A target that is a symbolic link is followed: the file it points to is replaced.
/// - An existing target keeps its permissions; a new one gets those of the umask.
/// - All errors are Error(ErrorKind::output) about the target.
class OutputFile {
 public:
  /// Creates the temporary. Throws when the folder is missing or cannot be written, or when the
  /// target exists and is not a regular file (a folder, a device, a pipe).
  explicit OutputFile(const std::string& target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// For a library that opens its output by name. It ends in the target's extension.
  const std::string& temporary_path() const { return temporary_; }

  /// Appends bytes. Throws when not all of them could be written (a full disk, a size limit).
  void write(std::string_view bytes);
  void write(std::span<const unsigned char> bytes);

  /// Brings the data to the disk and renames. Call it once, last. It cannot know of writes that a
  /// library made through temporary_path() and lost: check that library's own errors first.
  void commit();

 private:
  [[noreturn]] void fail(const char* action, int error_number) const;

  std::string target_;     ///< as given: the subject of errors
  std::string resolved_;   ///< with symbolic links followed
  std::string temporary_;  ///< beside resolved_; empty once renamed
  int descriptor_ = -1;
};

}  // namespace burnish
