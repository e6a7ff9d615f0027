#include "burnish/precompute/bake_journal.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "burnish/formats/error.h"
#include "fnv1a.h"

// A record is a header and a payload that is filled up to a multiple of 4 bytes, as the checksum
// wants it. Record 0 is the facts, one "name=value" a line.

namespace burnish {
namespace {

constexpr std::uint32_t kFactsKind = 0;
constexpr std::uint32_t kMagic = 0x314a4e42;  // "BNJ1"

struct Header {
  std::uint32_t magic = kMagic, kind = 0, index = 0, reserved = 0;
  std::uint64_t bytes = 0;     // of the payload without its filling
  std::uint64_t checksum = 0;  // of this header with a checksum of 0, and the filled payload
};
static_assert(sizeof(Header) == 32);

std::uint64_t checksum(Header header, std::span<const std::byte> filled) {
  header.checksum = 0;
  Fnv1a hash;
  hash.add(std::span<const Header>(&header, 1));
  std::vector<std::uint32_t> words(filled.size() / 4);
  if (!words.empty()) std::memcpy(words.data(), filled.data(), filled.size());
  hash.add(std::span<const std::uint32_t>(words));
  return hash.value();
}

std::uint64_t filled_size(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

std::string facts_text(const BakeJournal::Facts& facts) {
  std::string text;
  for (const auto& [name, value] : facts) text += fmt::format("{}={}\n", name, value);
  return text;
}

// The value of a fact in a journal's text; nothing when it has none of that name.
std::string find_fact(const std::string& text, const std::string& name) {
  const std::string lines = "\n" + text;
  const std::size_t at = lines.find("\n" + name + "=");
  if (at == std::string::npos) return "nothing";
  const std::size_t value = at + name.size() + 2;
  return lines.substr(value, lines.find('\n', value) - value);
}

// Reads all of `size` bytes from `offset` on, and moves it past them, unless the file ends.
bool read_all(int descriptor, std::uint64_t& offset, void* to, std::size_t size) {
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::pread(descriptor, bytes, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// Whether the open file is the one of that name: its owner may have removed it between our open()
// and our lock.
bool is_still_named(int descriptor, const std::string& path) {
  struct stat ours = {}, named = {};
  return ::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &named) == 0 &&
         ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
}

}  // namespace

BakeJournal::BakeJournal(std::string path) : path_(std::move(path)) {
  do {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("be opened", errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int number = errno;
      ::close(descriptor_);
      descriptor_ = -1;
      if (number == EWOULDBLOCK)
        throw Error(ErrorKind::output, path_, "is in use by another bake of the same output");
      fail("be locked", number);
    }
  } while (!is_still_named(descriptor_, path_));
  // Another file of that name is not ours to empty.
  std::uint32_t magic = kMagic;
  std::uint64_t offset = 0;
  if (read_all(descriptor_, offset, &magic, sizeof(magic)) && magic != kMagic) {
    ::close(descriptor_);
    descriptor_ = -1;
    throw Error(ErrorKind::input, path_,
                fmt::format("is not the journal of a bake: it begins with {:08x}, expected {:08x}",
                            magic, kMagic));
  }
  offset = 0;
  Record facts;
  holds_work_ = read_record(offset, facts) && facts.kind == kFactsKind;
}

BakeJournal::~BakeJournal() {
  if (descriptor_ < 0) return;
  if (!holds_work_) ::unlink(path_.c_str());  // nothing was begun
  ::close(descriptor_);
}

void BakeJournal::fail(const char* action, int error_number) const {
  throw Error(ErrorKind::output, path_,
              fmt::format("cannot {}: {}", action, std::strerror(error_number)));
}

// Moves `offset` past the record, if it is intact.
bool BakeJournal::read_record(std::uint64_t& offset, Record& record) const {
  Header header;
  struct stat status = {};
  std::uint64_t at = offset;
  if (!read_all(descriptor_, at, &header, sizeof(header)) || header.magic != kMagic) return false;
  // Before memory is taken for a length that may be garbage.
  if (::fstat(descriptor_, &status) != 0 ||
      header.bytes > static_cast<std::uint64_t>(status.st_size))
    return false;
  record.kind = header.kind;
  record.index = header.index;
  record.payload.resize(filled_size(header.bytes));
  if (!read_all(descriptor_, at, record.payload.data(), record.payload.size())) return false;
  if (checksum(header, record.payload) != header.checksum) return false;
  record.payload.resize(header.bytes);
  record.offset = offset;
  offset = at;
  return true;
}

void BakeJournal::start(const Facts& facts) {
  if (::ftruncate(descriptor_, 0) != 0) fail("be emptied", errno);
  ::lseek(descriptor_, 0, SEEK_SET);
  const std::string text = facts_text(facts);
  append(kFactsKind, 0, std::as_bytes(std::span(text)));
  holds_work_ = true;
}

void BakeJournal::resume(const Facts& facts, const std::function<void(Record&&)>& visit) {
  std::uint64_t offset = 0;
  Record record;
  if (!read_record(offset, record) || record.kind != kFactsKind)
    throw Error(ErrorKind::input, path_,
                "holds no facts in its first record, expected those of a bake");
  const std::string found(reinterpret_cast<const char*>(record.payload.data()),
                          record.payload.size());
  for (const auto& [name, value] : facts)
    if (const std::string old = find_fact(found, name); old != value)
      throw Error(
          ErrorKind::input, path_,
          fmt::format("was begun with another {}: found {}, expected {}", name, old, value));
  if (found != facts_text(facts))
    throw Error(ErrorKind::input, path_,
                "holds facts that this version of burnish does not know, expected its own");
  while (read_record(offset, record)) {
    visit(std::move(record));
    record = {};
  }
  const auto end = static_cast<off_t>(offset);
  if (::ftruncate(descriptor_, end) != 0) fail("be shortened", errno);
  ::lseek(descriptor_, end, SEEK_SET);
}

BakeJournal::Record BakeJournal::read(std::uint64_t offset) const {
  Record record;
  if (!read_record(offset, record))
    throw Error(ErrorKind::input, path_,
                fmt::format("holds no intact record at byte {} any more, expected the one that was "
                            "there",
                            offset));
  return record;
}

void BakeJournal::append(std::uint32_t kind, std::uint32_t index,
                         std::span<const std::byte> payload) {
  Header header;
  header.kind = kind;
  header.index = index;
  header.bytes = payload.size();
  std::vector<std::byte> bytes(sizeof(header) + filled_size(payload.size()));
  if (!payload.empty()) std::memcpy(bytes.data() + sizeof(header), payload.data(), payload.size());
  header.checksum = checksum(header, std::span(bytes).subspan(sizeof(header)));
  std::memcpy(bytes.data(), &header, sizeof(header));
  const std::lock_guard lock(mutex_);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      throw Error(ErrorKind::output, path_,
                  fmt::format("cannot be written: {}; what it holds is good, and a bake that "
                              "resumes goes on from there",
                              std::strerror(errno)));
    done += static_cast<std::size_t>(written);
  }
}

void BakeJournal::remove() {
  if (::unlink(path_.c_str()) != 0 && errno != ENOENT) fail("be removed", errno);
  ::close(descriptor_);
  descriptor_ = -1;
  holds_work_ = false;
}

}  // namespace burnish
