#include "harness/truth_cache.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "harness/content_hash.h"

namespace burnish {
namespace {

// A file: kMagic, Header, the key, radiance, variance, hit, and the hash of all that as 8 bytes, as
// the machine stores them: a cache does not travel.
constexpr std::string_view kMagic = "burnish truth 1\n";

struct Header {
  std::uint64_t values = 0;
  std::uint32_t samples = 0;
  std::uint32_t picture = 0;  // 1: with `hit`
};

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string hash_bytes(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  const std::uint64_t value = hash.value();
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

void warn(const TruthCache& cache, const std::string& text) {
  if (cache.warn) cache.warn(text);
}

size_t file_size(const std::string& key, size_t values, bool picture) {
  return kMagic.size() + sizeof(Header) + key.size() +
         values * (2 * sizeof(Rgb) + (picture ? 1 : 0)) + sizeof(std::uint64_t);
}

/// The file's bytes, if it has `size` of them; what is wrong, otherwise.
std::optional<std::string> read_exactly(const std::string& path, size_t size, std::string& wrong) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!in || in.get() != std::ifstream::traits_type::eof()) {
    wrong = fmt::format("not readable or not {} bytes long", size);
    return std::nullopt;
  }
  return bytes;
}

/// Takes values off the front of `bytes`, which has enough.
template <class T>
void take(std::string_view& bytes, std::vector<T>& values, size_t count) {
  values.resize(count);
  std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
}

std::optional<StoredTruth> parse(std::string_view bytes, const std::string& key, size_t values,
                                 bool picture, std::string& wrong) {
  const size_t hash_at = bytes.size() - sizeof(std::uint64_t);
  Header header;
  std::memcpy(&header, bytes.data() + kMagic.size(), sizeof(header));
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    wrong = "not a truth of this version";
  } else if (hash_bytes(bytes.substr(0, hash_at)) != bytes.substr(hash_at)) {
    wrong = "its checksum differs";
  } else if (bytes.substr(kMagic.size() + sizeof(Header), key.size()) != key ||
             header.values != values || header.picture != (picture ? 1u : 0u)) {
    wrong = "the truth of something else";
  }
  if (!wrong.empty()) return std::nullopt;
  bytes.remove_prefix(kMagic.size() + sizeof(Header) + key.size());
  StoredTruth truth;
  truth.samples = header.samples;
  take(bytes, truth.radiance, values);
  take(bytes, truth.variance, values);
  if (picture) take(bytes, truth.hit, values);
  return truth;
}

}  // namespace

std::string default_truth_folder() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (const std::string own = variable("BURNISH_CACHE"); !own.empty()) return own;
  if (const std::string xdg = variable("XDG_CACHE_HOME"); xdg.starts_with('/'))
    return xdg + "/burnish";
  const std::string home = variable("HOME");
  return home.empty() ? "" : home + "/.cache/burnish";
}

std::string truth_path(const TruthCache& cache, const std::string& key) {
  return cache.folder + "/" + key + ".truth";
}

std::optional<StoredTruth> load_truth(const TruthCache& cache, const std::string& key,
                                      size_t values, bool picture) {
  if (cache.folder.empty()) return std::nullopt;
  const std::string path = truth_path(cache, key);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  std::string wrong;
  std::optional<StoredTruth> truth;
  if (const auto bytes = read_exactly(path, file_size(key, values, picture), wrong))
    truth = parse(*bytes, key, values, picture, wrong);
  if (!truth) warn(cache, fmt::format("{}: {}; the truth is computed again", path, wrong));
  return truth;
}

void store_truth(const TruthCache& cache, const std::string& key, const StoredTruth& truth) {
  if (cache.folder.empty()) return;
  const bool picture = !truth.hit.empty();
  const Header header = {truth.radiance.size(), truth.samples, picture ? 1u : 0u};
  std::string bytes;
  bytes.reserve(file_size(key, truth.radiance.size(), picture));
  bytes += kMagic;
  bytes.append(reinterpret_cast<const char*>(&header), sizeof(header));
  bytes += key;
  bytes += bytes_of(truth.radiance);
  bytes += bytes_of(truth.variance);
  bytes += bytes_of(truth.hit);
  bytes += hash_bytes(bytes);
  try {
    std::error_code error;
    std::filesystem::create_directories(cache.folder, error);
    OutputFile file(truth_path(cache, key));
    file.write(bytes);
    file.commit();
  } catch (const Error& error) {
    warn(cache, fmt::format("{}; the truth is not kept", error.what()));
  }
}

}  // namespace burnish
