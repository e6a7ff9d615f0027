#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "burnish/formats/transfer_file.h"
#include "files.h"
#include "transfer_examples.h"

namespace burnish::test {
namespace {

const std::string kGoldenFile = std::string(BURNISH_TEST_DATA) + "/transfer/format-1.h5";

std::string read_error(const std::string& path) {
  return error_of(path, [&] { read_transfer(path); });
}

TEST(TransferFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const TransferSize sizes[] = {
      {},
      {.vertices = 1,
       .triangles = 0,
       .occluder_vertices = 0,
       .occluder_triangles = 0,
       .bases = 1,
       .resolution = 2,
       .terms = 1},
      // More than one chunk (of 1 MiB) of positions, coefficients and eigen-SSDFs.
      {.vertices = 90000, .triangles = 100000, .bases = 3, .resolution = 64, .terms = 48}};
  for (const TransferSize& size : sizes) {
    for (const int level : {0, 4, 9}) {
      if (size.vertices > 1000 && level == 9) continue;  // slow, and nothing new
      const Transfer transfer = random_transfer(7, size);
      const std::string path = folder.file("a.h5");
      write_transfer(transfer, path, {.compression_level = level});
      EXPECT_EQ(first_difference(read_transfer(path), transfer), "") << size.vertices;
      EXPECT_TRUE(is_hdf5_file(path));
    }
  }
}

TEST(TransferFile, RoundsCoefficientsToNearestFloat16) {
  const TemporaryFolder folder;
  Transfer transfer = random_transfer(11);
  const WriteTransferOptions options{.coefficient_type = CoefficientType::float16};
  // A tie goes to even, the smallest subnormal and the largest finite value are kept.
  transfer.coefficients[0] = 1 + std::ldexp(1.0f, -11);
  transfer.coefficients[1] = 1 + 3 * std::ldexp(1.0f, -11);
  transfer.coefficients[2] = std::ldexp(1.0f, -24);
  transfer.coefficients[3] = -65504;
  const std::string path = folder.file("half.h5");
  write_transfer(transfer, path, options);
  Transfer found = read_transfer(path);
  EXPECT_EQ(found.coefficients[0], 1);
  EXPECT_EQ(found.coefficients[1], 1 + std::ldexp(1.0f, -9));
  EXPECT_EQ(found.coefficients[2], std::ldexp(1.0f, -24));
  EXPECT_EQ(found.coefficients[3], -65504);
  for (size_t i = 4; i < transfer.coefficients.size(); ++i) {
    const float exact = transfer.coefficients[i];  // rounding: half a unit of the 11th bit
    EXPECT_LE(std::abs(found.coefficients[i] - exact), std::ldexp(std::abs(exact), -11)) << i;
  }
  found.coefficients = transfer.coefficients;
  EXPECT_EQ(first_difference(found, transfer), "");

  transfer.coefficients[5] = 65520;  // rounds to infinity
  const std::string error = error_of(
      path, [&] { write_transfer(transfer, path, options); }, ErrorKind::output);
  EXPECT_NE(error.find("/visibility/ssdf/coefficients, value 5"), std::string::npos) << error;
}

TEST(TransferFile, EqualTransfersGiveEqualBytes) {
  const TemporaryFolder folder;
  for (const CoefficientType type : {CoefficientType::float32, CoefficientType::float16}) {
    write_transfer(random_transfer(3), folder.file("a.h5"), {.coefficient_type = type});
    write_transfer(random_transfer(4), folder.file("b.h5"), {.coefficient_type = type});
    // Heap garbage of another kind than at the first write.
    std::vector<std::string> garbage(100, std::string(5000, 'x'));
    garbage.clear();
    write_transfer(random_transfer(3), folder.file("c.h5"), {.coefficient_type = type});
    EXPECT_EQ(read_bytes(folder.file("a.h5")), read_bytes(folder.file("c.h5")));
    EXPECT_NE(read_bytes(folder.file("a.h5")), read_bytes(folder.file("b.h5")));
  }
}

TEST(TransferFile, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure(
      "a.h5", [](const std::string& path) { write_transfer(random_transfer(1), path); });
}

TEST(TransferFile, FormatVersion1ReadsToKnownValues) {
  if (std::getenv("BURNISH_UPDATE_GOLDEN"))  // made by this very line, at format version 1
    write_transfer(random_transfer(1), kGoldenFile);
  const Transfer transfer = read_transfer(kGoldenFile);
  ASSERT_EQ(transfer.vertex_count(), 40u);
  ASSERT_EQ(transfer.triangles.size(), 30u);
  ASSERT_EQ(transfer.bases.size(), 2u);
  EXPECT_EQ(transfer.bases[1].resolution, 8);
  EXPECT_EQ(transfer.terms(), 6);
  EXPECT_EQ(transfer.provenance.mesh_name, "b\xc3\xbcste.obj");
  EXPECT_EQ(transfer.provenance.rays, 123456789012345u);
  EXPECT_EQ(transfer.provenance.residual_rms_rad, 0.026);
  // Written down once from the transfer in memory; exact, since a file stores floats as they are.
  EXPECT_EQ(transfer.positions[0], Vector3f(-20.454668f, -80.62886f, -42.873764f));
  EXPECT_EQ(transfer.normals[39], Vector3f(0.3365089f, 0.8779273f, -0.34059563f));
  EXPECT_EQ(transfer.tangents[39], Vector3f(-0.78341633f, 0.46169207f, 0.416052f));
  EXPECT_EQ(transfer.file_vertex[7], 598187340u);
  EXPECT_EQ(transfer.triangles[29], (Triangle{20, 26, 15}));
  EXPECT_EQ(transfer.bases[1].mean[63], 2.5149891f);
  EXPECT_EQ(transfer.bases[0].eigen[1], 0.97388566f);
  EXPECT_EQ(transfer.bases[1].eigen[383], 0.6929927f);
  EXPECT_EQ(transfer.basis_id[0], 0);
  EXPECT_EQ(transfer.basis_id[39], 1);
  EXPECT_EQ(transfer.coefficients[0], 13.781078f);
  EXPECT_EQ(transfer.coefficients[239], 19.912067f);
  EXPECT_EQ(transfer.occluder_positions[4].z(), -85.47261f);
  EXPECT_EQ(transfer.occluder_triangles[3], (Triangle{1, 2, 0}));
}

/// A transfer file opened with HDF5's own functions, to be damaged on purpose.
class OpenedFile {
 public:
  explicit OpenedFile(const std::string& path)
      : id(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)) {
    EXPECT_GE(id, 0);
  }
  ~OpenedFile() { EXPECT_GE(H5Fclose(id), 0); }

  void remove(const char* name) { EXPECT_GE(H5Ldelete(id, name, H5P_DEFAULT), 0); }

  /// Replaces a dataset by one as the format asks, of another type, shape or contents.
  template <class T>
  void replace(const char* name, hid_t file_type, hid_t memory_type,
               const std::vector<hsize_t>& shape, const std::vector<T>& values,
               bool with_filters = true) {
    remove(name);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    if (with_filters) {
      H5Pset_chunk(properties, static_cast<int>(shape.size()), shape.data());
      H5Pset_shuffle(properties);
      H5Pset_deflate(properties, 4);
      H5Pset_fletcher32(properties);
    }
    const hid_t set = H5Dcreate2(id, name, file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (!values.empty()) {
      EXPECT_GE(H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    }
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
  }
  void replace(const char* name, const std::vector<hsize_t>& shape,
               const std::vector<float>& values) {
    replace(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, shape, values);
  }
  void replace(const char* name, const std::vector<hsize_t>& shape,
               const std::vector<std::uint32_t>& values) {
    replace(name, H5T_STD_U32LE, H5T_NATIVE_UINT32, shape, values);
  }
  // Deleted and made anew: HDF5 1.10.8 cannot rewrite an attribute that another handle wrote.
  void set_attribute(const char* object, const char* name, hid_t file_type, hid_t memory_type,
                     const void* value) {
    EXPECT_GE(H5Adelete_by_name(id, object, name, H5P_DEFAULT), 0);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate_by_name(id, object, name, file_type, space, H5P_DEFAULT,
                                              H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Awrite(attribute, memory_type, value), 0);
    H5Aclose(attribute);
    H5Sclose(space);
  }
  void set_int(const char* object, const char* name, std::int32_t value) {
    set_attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32, &value);
  }
  void set_double(const char* object, const char* name, double value) {
    set_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
  }
  void set_text(const char* object, const char* name, const std::string& text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text.size() + 1);
    set_attribute(object, name, type, type, text.c_str());
    H5Tclose(type);
  }

  hid_t id;
};

TEST(TransferFile, RejectsWhatIsMissing) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const char* name :
       {"/mesh", "/mesh/positions", "/mesh/normals", "/mesh/tangents", "/mesh/file_vertex",
        "/mesh/triangles", "/visibility", "/visibility/ssdf", "/visibility/ssdf/basis",
        "/visibility/ssdf/basis/mean", "/visibility/ssdf/basis/eigen",
        "/visibility/ssdf/coefficients", "/visibility/ssdf/basis_id", "/occluders",
        "/occluders/positions", "/occluders/triangles", "/provenance"}) {
    write_transfer(random_transfer(1), path);
    OpenedFile(path).remove(name);
    EXPECT_EQ(read_error(path), path + ": " + name + ": is missing");
  }
  for (const char* name :
       {"version", "mesh_name", "mesh_hash", "occluder_hash", "directions", "training_vertices",
        "rays", "residual_rms_rad", "wrong_sign_fraction"}) {
    write_transfer(random_transfer(1), path);
    H5Adelete_by_name(OpenedFile(path).id, "/provenance", name, H5P_DEFAULT);
    EXPECT_EQ(read_error(path), path + ": /provenance, attribute " + name + ": is missing");
  }
}

struct Damage {
  const char* place;  ///< that the error names
  const char* cause;  ///< that the error says
  std::function<void(OpenedFile&)> apply;
};

std::vector<Damage> damages() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  return {
      {"/mesh/positions", "has 1 dimensions, expected 2",
       [](OpenedFile& f) { f.replace("/mesh/positions", {120}, std::vector<float>(120)); }},
      {"/mesh/positions", "expected 3",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", {30, 4}, std::vector<float>(120));
       }},
      {"/mesh/positions", "another type",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", {40, 3}, std::vector<std::uint32_t>(120));
       }},
      {"/mesh/positions", "another type",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", H5T_IEEE_F32BE, H5T_NATIVE_FLOAT, {40, 3},
                   std::vector<float>(120));
       }},
      {"/mesh/positions", "storage layout",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {40, 3},
                   std::vector<float>(120), false);
       }},
      {"/mesh/positions", "0 of 1 chunks",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", {40, 3}, std::vector<float>());
       }},
      {"/mesh/positions", "chunks of more than",
       [](OpenedFile& f) {
         f.replace("/mesh/positions", {hsize_t{1} << 26, 3}, std::vector<float>());
       }},
      {"/mesh/positions[0]", "not finite",
       [=](OpenedFile& f) {
         f.replace("/mesh/positions", {40, 3}, std::vector<float>(120, nan));
       }},
      {"/mesh/normals", "is a link",
       [](OpenedFile& f) {
         f.remove("/mesh/normals");
         H5Lcreate_soft("/mesh/tangents", f.id, "/mesh/normals", H5P_DEFAULT, H5P_DEFAULT);
       }},
      {"/mesh/normals", "expected 40",
       [](OpenedFile& f) {
         f.replace("/mesh/normals", {39, 3}, std::vector<float>(117));
       }},
      {"/mesh/normals[0]", "expected 1 within",
       [](OpenedFile& f) {
         f.replace("/mesh/normals", {40, 3}, std::vector<float>(120, 0.6f));
       }},
      {"/mesh/tangents[0]", "expected 1 within",
       [=](OpenedFile& f) {
         f.replace("/mesh/tangents", {40, 3}, std::vector<float>(120, nan));
       }},
      {"/mesh/tangents", "with the normal",
       [](OpenedFile& f) {
         f.replace("/mesh/tangents", {40, 3}, std::vector<float>(120, std::sqrt(1 / 3.0f)));
       }},
      {"/mesh/file_vertex", "expected 40",
       [](OpenedFile& f) { f.replace("/mesh/file_vertex", {41}, std::vector<std::uint32_t>(41)); }},
      {"/mesh/triangles[0]", "vertex 40, expected below 40",
       [](OpenedFile& f) {
         f.replace("/mesh/triangles", {1, 3}, std::vector<std::uint32_t>{39, 40, 0});
       }},
      {"/visibility/ssdf/basis/mean", "expected a square",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/mean", {2, 65}, std::vector<float>(130));
       }},
      {"/visibility/ssdf/basis/mean", "power of two",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/mean", {2, 9}, std::vector<float>(18));
         f.replace("/visibility/ssdf/basis/eigen", {2, 9, 6}, std::vector<float>(108));
       }},
      {"/visibility/ssdf/basis/mean", "expected 1..256",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/mean", {257, 4}, std::vector<float>(257 * 4));
       }},
      {"/visibility/ssdf/basis/mean", "expected -pi..pi",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/mean", {2, 64}, std::vector<float>(128, 3.2f));
       }},
      {"/visibility/ssdf/basis/eigen", "expected 2",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/eigen", {1, 64, 6}, std::vector<float>(384));
       }},
      {"/visibility/ssdf/basis/eigen", "expected 1..1024",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/eigen", {2, 64, 1025},
                   std::vector<float>(2 * 64 * 1025));
       }},
      {"/visibility/ssdf/basis/eigen, value 0", "finite",
       [=](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/eigen", {2, 64, 6}, std::vector<float>(768, infinity));
       }},
      {"/visibility/ssdf/coefficients", "expected 6",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", {40, 5}, std::vector<float>(200));
       }},
      {"/visibility/ssdf/coefficients, value 0", "finite",
       [=](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", {40, 6}, std::vector<float>(240, nan));
       }},
      {"/visibility/ssdf/basis_id[0]", "basis 2, expected below 2",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis_id", H5T_STD_U8LE, H5T_NATIVE_UINT8, {40},
                   std::vector<std::uint8_t>(40, 2));
       }},
      {"/occluders/triangles[0]", "vertex 5",
       [](OpenedFile& f) {
         f.replace("/occluders/triangles", {1, 3}, std::vector<std::uint32_t>{5, 0, 1});
       }},
      {"/provenance, attribute directions", "expected 0",
       [](OpenedFile& f) { f.set_int("/provenance", "directions", -1); }},
      {"/provenance, attribute wrong_sign_fraction", "expected 0",
       [=](OpenedFile& f) { f.set_double("/provenance", "wrong_sign_fraction", nan); }},
      {"/provenance, attribute mesh_hash", "hex",
       [](OpenedFile& f) { f.set_text("/provenance", "mesh_hash", "0123456789ABCDEF"); }},
      {"/provenance, attribute mesh_name", "bytes",
       [](OpenedFile& f) { f.set_text("/provenance", "mesh_name", std::string(5000, 'x')); }},
      {"/, attribute format", "burnish transfer",
       [](OpenedFile& f) { f.set_text("/", "format", "some other"); }},
      {"/, attribute format_version", "1 or more",
       [](OpenedFile& f) { f.set_int("/", "format_version", 0); }},
  };
}

TEST(TransferFile, RejectsDamageByDatasetAndCause) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const Damage& damage : damages()) {
    write_transfer(random_transfer(1), path);
    {
      OpenedFile file(path);
      damage.apply(file);
    }
    const std::string error = read_error(path);
    EXPECT_NE(error.find(": " + std::string(damage.place)), std::string::npos)
        << damage.place << " / " << damage.cause << ": " << error;
    EXPECT_NE(error.find(damage.cause), std::string::npos)
        << damage.place << " / " << damage.cause << ": " << error;
  }
}

TEST(TransferFile, RejectsADatasetFarLargerThanItsFile) {
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

TEST(TransferFile, RejectsANewerFormatVersion) {
  const TemporaryFolder folder;
  const std::string path = folder.file("new.h5");
  write_transfer(random_transfer(1), path);
  OpenedFile(path).set_int("/", "format_version", 2);
  EXPECT_EQ(error_of(
                path, [&] { read_transfer(path); }, ErrorKind::unsupported),
            path + ": transfer format version 2, this build reads up to 1");
}

TEST(TransferFile, RejectsWhatIsNoTransferFile) {
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

TEST(TransferFile, WriterRejectsAnInvalidTransfer) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const auto write_error = [&](const std::function<void(Transfer&)>& spoil) {
    Transfer transfer = random_transfer(1);
    spoil(transfer);
    return error_of(
        path, [&] { write_transfer(transfer, path); }, ErrorKind::output);
  };
  EXPECT_NE(write_error([](Transfer& t) { t = {}; }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.normals[3] *= 1.01f; }).find("/mesh/normals[3]"),
            std::string::npos);
  EXPECT_NE(write_error([](Transfer& t) { t.bases.clear(); }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.bases[1].terms = 5; }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.bases[0].resolution = 12; }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.coefficients.pop_back(); }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.basis_id[0] = 7; }), "");
  EXPECT_NE(write_error([](Transfer& t) { t.provenance.mesh_name.push_back('\0'); }), "");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(TransferFile, EveryTruncationIsRejected) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  write_transfer(
      random_transfer(1, {.vertices = 3, .triangles = 1, .bases = 1, .resolution = 2, .terms = 1}),
      path);
  const std::string bytes = read_bytes(path);
  ASSERT_EQ(read_error(path), "");
  const size_t step = 1 + bytes.size() / 1000;  // at most 1000 reads
  for (size_t size = 0; size < bytes.size(); size += step) {
    write_bytes(path, bytes.substr(0, size));
    EXPECT_NE(read_error(path), "") << size << " of " << bytes.size() << " bytes";
  }
  write_bytes(path, bytes.substr(0, bytes.size() - 1));
  EXPECT_NE(read_error(path), "");
}

TEST(TransferFile, ASingleChangedByteIsRejectedOrHarmless) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const Transfer transfer = random_transfer(1);
  write_transfer(transfer, path);
  const std::string bytes = read_bytes(path);
  constexpr unsigned kSeed = 20;
  std::mt19937 random(kSeed);
  constexpr int kChanges = 1000;
  int rejected = 0;
  for (int i = 0; i < kChanges; ++i) {
    std::string damaged = bytes;
    const size_t place = random() % bytes.size();
    const auto change = static_cast<char>(1 + random() % 255);
    damaged[place] = static_cast<char>(damaged[place] ^ change);
    write_bytes(path, damaged);
    try {
      EXPECT_EQ(first_difference(read_transfer(path), transfer), "")
          << "seed " << kSeed << ", byte " << place << " ^ " << int{change};
    } catch (const Error&) {
      ++rejected;
    }
  }
  // Everything but unused space is under a checksum; most of this small file is used.
  EXPECT_GT(rejected, kChanges / 4);
}

}  // namespace
}  // namespace burnish::test
