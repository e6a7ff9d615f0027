#include "burnish/formats/error.h"

namespace burnish {

Error::Error(ErrorKind kind, const std::string& subject, const std::string& message)
    : std::runtime_error(subject + ": " + message), kind_(kind) {}

}  // namespace burnish
