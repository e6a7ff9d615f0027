#pragma once

#include <stdexcept>
#include <string>

namespace burnish {

/// What went wrong, so that a program can choose its exit code.
enum class ErrorKind {
  input,        ///< a file or its contents cannot be used
  unsupported,  ///< a known format or feature that this build does not have
  output,       ///< a result could not be written
};

/// The one exception of formats and precompute: one line that names the file, the place in it, what
/// was found and what is accepted.
class Error : public std::runtime_error {
 public:
  /// `subject` is the file (or other input) the message is about; what() is "subject: message".
  Error(ErrorKind kind, const std::string& subject, const std::string& message);
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace burnish
