#pragma once

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"

namespace burnish::test {

/// Every truncation of a JSON text that ends in "}\n" is refused with an Error, and 5000 changes of
/// a byte each are read or refused.
template <class Parse>
void expect_damage_is_refused_or_read(const std::string& json, unsigned seed, const Parse& parse) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const auto is_refused = [&](const std::string& text) {
    try {
      parse(text);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  for (std::size_t size = 0; size + 2 < json.size(); ++size)  // without "}\n" it is still cut
    EXPECT_TRUE(is_refused(json.substr(0, size))) << "cut at byte " << size;
  std::mt19937 random(seed);
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string damaged = json;
    damaged[random() % json.size()] = static_cast<char>(random());
    refused += is_refused(damaged);
  }
  EXPECT_GT(refused, 1000);  // most characters are of the structure or of a field's name
}

}  // namespace burnish::test
