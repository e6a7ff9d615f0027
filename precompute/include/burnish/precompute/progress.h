#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace burnish {

/// Called now and then, from one thread at a time, by work that takes long: the stage's name, how
/// much of it is done and how much there is. Returning false asks the work to stop, which ends in
/// Cancelled.
using Progress =
    std::function<bool(std::string_view stage, std::uint64_t done, std::uint64_t total)>;

/// Thrown by work that its Progress asked to stop.
class Cancelled : public std::runtime_error {
 public:
  /// `what`: for a person, with how to go on if there is a way.
  explicit Cancelled(const std::string& what = "interrupted") : std::runtime_error(what) {}
};

}  // namespace burnish
