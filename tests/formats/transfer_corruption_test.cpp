#include <random>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "burnish/formats/transfer_file.h"
#include "files.h"
#include "transfer_damage.h"
#include "transfer_examples.h"

namespace burnish::test {
namespace {

TEST(CorruptTransfer, RejectsADatasetFarLargerThanItsFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("bomb.h5");
  write_transfer(random_transfer(1), path);
  {
    // 2^31 rows of which one chunk has data: reading them all would take 24 GB.
    OpenedFile file(path);
    file.remove("/mesh/positions");
    const hsize_t shape[] = {hsize_t{1} << 31, 3}, chunk[] = {hsize_t{1} << 20, 3};
    const hid_t space = H5Screate_simple(2, shape, nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 2, chunk);
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, 9);
    H5Pset_fletcher32(properties);
    const hid_t set = H5Dcreate2(file.id, "/mesh/positions", H5T_IEEE_F32LE, space, H5P_DEFAULT,
                                 properties, H5P_DEFAULT);
    const hsize_t start[] = {0, 0}, count[] = {1, 3};
    const hid_t memory = H5Screate_simple(2, count, nullptr);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
    const float row[3] = {1, 2, 3};
    EXPECT_GE(H5Dwrite(set, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, row), 0);
    H5Sclose(memory);
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
  }
  const std::string error = read_error(path);
  EXPECT_NE(error.find("/mesh/positions: 1 of 2048 chunks are there"), std::string::npos) << error;
}

TEST(CorruptTransfer, RejectsANewerFormatVersion) {
  const TemporaryFolder folder;
  const std::string path = folder.file("new.h5");
  write_transfer(random_transfer(1), path);
  OpenedFile(path).set_int("/", "format_version", 3);
  EXPECT_EQ(error_of(
                path, [&] { read_transfer(path); }, ErrorKind::unsupported),
            path + ": transfer format version 3, this build reads up to 2");
}

TEST(CorruptTransfer, RejectsWhatIsNoTransferFile) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("missing.h5"), text = folder.file("text.h5");
  EXPECT_NE(read_error(missing).find("No such file"), std::string::npos);
  EXPECT_FALSE(is_hdf5_file(missing));
  write_bytes(text, "v 0 0 0\n");
  EXPECT_NE(read_error(text).find("is not an HDF5 file"), std::string::npos);
  EXPECT_FALSE(is_hdf5_file(text));
  const std::string parent = std::filesystem::path(text).parent_path().string();
  EXPECT_NE(read_error(parent).find("is a folder"), std::string::npos);
  const std::string old = folder.file("old.h5");  // a file of HDF5 1.6 structures, not ours
  const hid_t id = H5Fcreate(old.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(id);
  EXPECT_NE(read_error(old).find("superblock version 0"), std::string::npos);
}

/// The kinds of file: with everything, as integers and as floats, and with nothing that occludes.
void write_example(int kind, const std::string& path) {
  if (kind == 0) write_transfer(random_transfer_2(1), path);
  if (kind == 1) write_transfer(random_transfer_2(1), path, {CoefficientType::float32});
  if (kind == 2) write_transfer(random_transfer(1, {.bases = 0, .parts = 2}), path);
}

TEST(CorruptTransfer, EveryTruncationIsRejected) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const int kind : {0, 2}) {
    write_example(kind, path);
    const std::string bytes = read_bytes(path);
    ASSERT_EQ(read_error(path), "");
    const size_t step = 1 + bytes.size() / 500;  // at most 500 reads
    for (size_t size = 0; size < bytes.size(); size += step) {
      write_bytes(path, bytes.substr(0, size));
      EXPECT_NE(read_error(path), "") << size << " of " << bytes.size() << " bytes";
    }
    write_bytes(path, bytes.substr(0, bytes.size() - 1));
    EXPECT_NE(read_error(path), "");
  }
}

TEST(CorruptTransfer, ASingleChangedByteIsRejectedOrHarmless) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const int kind : {0, 1, 2}) {
    write_example(kind, path);
    const std::string bytes = read_bytes(path);
    const Transfer transfer = read_transfer(path);
    constexpr unsigned kSeed = 20;
    std::mt19937 random(kSeed);
    constexpr int kChanges = 500;
    int rejected = 0;
    for (int i = 0; i < kChanges; ++i) {
      std::string damaged = bytes;
      const size_t place = random() % bytes.size();
      const auto change = static_cast<char>(1 + random() % 255);
      damaged[place] = static_cast<char>(damaged[place] ^ change);
      write_bytes(path, damaged);
      try {
        EXPECT_EQ(first_difference(read_transfer(path), transfer), "")
            << "kind " << kind << ", seed " << kSeed << ", byte " << place << " ^ " << int{change};
      } catch (const Error&) {
        ++rejected;
      }
    }
    // Everything but unused space is under a checksum; most of these small files is used.
    EXPECT_GT(rejected, kChanges / 4) << kind;
  }
}

}  // namespace
}  // namespace burnish::test
