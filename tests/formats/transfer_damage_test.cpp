#include "transfer_damage.h"

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

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(DamagedTransfer, RejectsWhatIsMissing) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const char* name : {"/mesh",
                           "/mesh/positions",
                           "/mesh/normals",
                           "/mesh/tangents",
                           "/mesh/file_vertex",
                           "/mesh/triangles",
                           "/mesh/parts",
                           "/mesh/parts/names",
                           "/mesh/parts/ranges",
                           "/visibility",
                           "/visibility/ssdf",
                           "/visibility/ssdf/basis",
                           "/visibility/ssdf/basis/mean",
                           "/visibility/ssdf/basis/eigen",
                           "/visibility/ssdf/coefficients",
                           "/visibility/ssdf/basis_id",
                           "/visibility/ladder",
                           "/visibility/ladder/basis",

                           "/visibility/ladder/basis/mean",
                           "/visibility/ladder/basis/eigen",
                           "/visibility/ladder/coefficients",
                           "/occluders",
                           "/occluders/positions",
                           "/occluders/triangles",
                           "/provenance",
                           "/provenance/ssdf_errors",
                           "/provenance/ladder_errors"}) {
    write_transfer(random_transfer_2(1), path);
    OpenedFile(path).remove(name);
    EXPECT_EQ(read_error(path), path + ": " + name + ": is missing");
  }
  const std::pair<const char*, const char*> attributes[] = {
      {"/", "format"},
      {"/", "format_version"},
      {"/visibility", "bases"},
      {"/visibility", "ladder_bases"},
      {"/visibility/ssdf", "amplitude_rad"},
      {"/visibility/ssdf/coefficients", "scale_factor"},
      {"/visibility/ladder", "crossover"},
      {"/visibility/ladder/coefficients", "scale_factor"},
      {"/provenance", "version"},
      {"/provenance", "mesh_name"},
      {"/provenance", "mesh_hash"},
      {"/provenance", "occluder_hash"},
      {"/provenance", "directions"},
      {"/provenance", "coarsest"},
      {"/provenance", "origin_offset"},
      {"/provenance", "training_vertices"},
      {"/provenance", "rays"},
      {"/provenance", "residual_vertices"},
      {"/provenance", "residual_held_out"},
      {"/provenance", "residual_rms_rad"},
      {"/provenance", "wrong_sign_fraction"}};
  for (const auto& [object, name] : attributes) {
    write_transfer(random_transfer_2(1), path);
    OpenedFile(path).remove_attribute(object, name);
    EXPECT_EQ(read_error(path), path + ": " + object + ", attribute " + name + ": is missing");
  }
}

/// Of the example's parts, of 13, 0 and 27 vertices and 10, 0 and 20 triangles.
std::function<void(OpenedFile&)> ranges(const std::vector<std::uint32_t>& values) {
  return [=](OpenedFile& f) { f.replace("/mesh/parts/ranges", {3, 4}, values); };
}

/// Texture coordinates may be missing, but not be wrong.
TEST(DamagedTransfer, RejectsTextureCoordinates) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const auto write = [&] { write_transfer(random_transfer(1, {.texcoords = true}), path); };
  write();
  EXPECT_EQ(read_transfer(path).texcoords.size(), 40u);
  OpenedFile(path).remove("/mesh/texcoords");
  EXPECT_TRUE(read_transfer(path).texcoords.empty());
  const auto rejects = [&](const std::vector<hsize_t>& shape, const auto& values,
                           const char* cause) {
    write();
    OpenedFile(path).replace("/mesh/texcoords", shape, values);
    const std::string error = read_error(path);
    EXPECT_EQ(error.rfind(path + ": /mesh/texcoords", 0), 0u) << error;
    EXPECT_NE(error.find(cause), std::string::npos) << error;
  };
  rejects({39, 2}, std::vector<float>(78), "expected 40");
  rejects({40, 3}, std::vector<float>(120), "expected 2");
  rejects({40, 2}, std::vector<std::uint32_t>(80), "another type");
  rejects({40, 2}, std::vector<float>(80, kNan), "not finite");
  write();
  {
    OpenedFile file(path);
    file.remove("/mesh/texcoords");
    H5Lcreate_soft("/mesh/normals", file.id, "/mesh/texcoords", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_NE(read_error(path).find("is a link"), std::string::npos);
}

TEST(DamagedTransfer, RejectsMeshes) {
  expect_rejected({
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
       [](OpenedFile& f) {
         f.replace("/mesh/positions", {40, 3}, std::vector<float>(120, kNan));
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
       [](OpenedFile& f) {
         f.replace("/mesh/tangents", {40, 3}, std::vector<float>(120, kNan));
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
      {"/mesh/triangles[10]", "vertex 0, expected one of its part: 13 or more, below 40",
       [](OpenedFile& f) {
         f.replace("/mesh/triangles", {30, 3}, std::vector<std::uint32_t>(90, 0));
       }},
      {"/mesh/parts/ranges[2]", "vertices 12..40, expected them from 13 to 40",
       ranges({0, 13, 0, 10, 13, 0, 10, 0, 12, 28, 10, 20})},
      {"/mesh/parts/ranges[1]", "vertices 14..14, expected them from 13",
       ranges({0, 13, 0, 10, 14, 0, 10, 0, 14, 26, 10, 20})},
      {"/mesh/parts/ranges[2]", "vertices 13..39, expected them from 13 to 40",
       ranges({0, 13, 0, 10, 13, 0, 10, 0, 13, 26, 10, 20})},
      {"/mesh/parts/ranges[0]", "vertices 0..41",
       ranges({0, 41, 0, 10, 41, 0, 10, 0, 41, 0, 10, 20})},
      {"/mesh/parts/ranges[1]", "vertices 13..4294967308",
       ranges({0, 13, 0, 10, 13, 4294967295, 10, 0, 12, 28, 10, 20})},
      {"/mesh/parts/ranges[2]", "triangles 11..31, expected them from 10 to 30",
       ranges({0, 13, 0, 10, 13, 0, 10, 0, 13, 27, 11, 20})},
      {"/mesh/parts/ranges", "expected 4",
       [](OpenedFile& f) {
         f.replace("/mesh/parts/ranges", {3, 3}, std::vector<std::uint32_t>(9));
       }},
      {"/mesh/parts/names", "expected 1 along",
       [](OpenedFile& f) {
         f.replace("/mesh/parts/ranges", {1, 4}, std::vector<std::uint32_t>{0, 40, 0, 30});
       }},
      {"/mesh/parts/names", "expected strings",
       [](OpenedFile& f) { f.replace("/mesh/parts/names", {3}, std::vector<float>(3)); }},
      {"/mesh/parts/names", "up to 4096 bytes",
       [](OpenedFile& f) {
         const hid_t type = H5Tcopy(H5T_C_S1);
         H5Tset_size(type, 4098);
         f.replace("/mesh/parts/names", type, type, {3}, std::vector<char>(3 * 4098));
         H5Tclose(type);
       }},
  });
}

TEST(DamagedTransfer, RejectsProvenance) {
  expect_rejected({
      {"/occluders/triangles[0]", "vertex 5",
       [](OpenedFile& f) {
         f.replace("/occluders/triangles", {1, 3}, std::vector<std::uint32_t>{5, 0, 1});
       }},
      {"/provenance, attribute directions", "expected 0",
       [](OpenedFile& f) { f.set_int("/provenance", "directions", -1); }},
      {"/provenance, attribute wrong_sign_fraction", "expected 0",
       [](OpenedFile& f) { f.set_double("/provenance", "wrong_sign_fraction", kNan); }},
      {"/provenance, attribute mesh_hash", "hex",
       [](OpenedFile& f) { f.set_text("/provenance", "mesh_hash", "0123456789ABCDEF"); }},
      {"/provenance, attribute mesh_name", "bytes",
       [](OpenedFile& f) { f.set_text("/provenance", "mesh_name", std::string(5000, 'x')); }},
      {"/, attribute format", "burnish transfer",
       [](OpenedFile& f) { f.set_text("/", "format", "some other"); }},
      {"/, attribute format_version", "1 or more",
       [](OpenedFile& f) { f.set_int("/", "format_version", 0); }},
      {"/provenance, attribute coarsest", "expected 0..512",
       [](OpenedFile& f) { f.set_int("/provenance", "coarsest", 513); }},
      {"/provenance, attribute origin_offset", "expected 0",
       [](OpenedFile& f) { f.set_double("/provenance", "origin_offset", -1e-9); }},
      {"/provenance, attribute residual_vertices", "expected 0",
       [](OpenedFile& f) { f.set_int("/provenance", "residual_vertices", -1); }},
      {"/provenance, attribute residual_held_out", "2, expected 0 or 1",
       [](OpenedFile& f) { f.set_byte("/provenance", "residual_held_out", 2); }},
      {"/provenance/ssdf_errors", "expected 2",
       [](OpenedFile& f) {
         f.replace("/provenance/ssdf_errors", {2, 3}, std::vector<double>(6, 1));
       }},
      {"/provenance/ssdf_errors[1]", "error nan",
       [](OpenedFile& f) {
         f.replace("/provenance/ssdf_errors", {2, 2}, std::vector<double>{1, 0, 2, std::nan("")});
       }},
      {"/provenance/ladder_errors[0]", "at bandwidth 0",
       [](OpenedFile& f) {
         f.replace("/provenance/ladder_errors", {1, 2}, std::vector<double>{0, 1});
       }},
  });
}

}  // namespace
}  // namespace burnish::test
