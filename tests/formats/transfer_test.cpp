#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "burnish/formats/transfer_file.h"
#include "files.h"
#include "transfer_examples.h"

namespace burnish::test {
namespace {

constexpr CoefficientType kTypes[] = {CoefficientType::float32, CoefficientType::float16,
                                      CoefficientType::int16};

Transfer write_and_read(const Transfer& transfer, const WriteTransferOptions& options) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  write_transfer(transfer, path, options);
  EXPECT_TRUE(is_hdf5_file(path));
  return read_transfer(path);
}

TEST(TransferFile, ReadsBackWhatWasWritten) {
  const TransferSize sizes[] = {
      {},
      {.vertices = 1,
       .triangles = 0,
       .occluder_vertices = 0,
       .occluder_triangles = 0,
       .bases = 1,
       .resolution = 2,
       .terms = 1,
       .ladder_bases = 1,
       .ladder_bands = 1,
       .ladder_terms = 1,
       .parts = 1},
      {.amplitude_rad = 1.5f, .ladder_bases = 2, .ladder_bands = 16, .parts = 5},
      {.bases = 3, .ladder_bases = 1},
      {.bases = 0, .parts = 2, .texcoords = true},
      // More than one chunk (of 1 MiB) of all that has many values.
      {.vertices = 90000,
       .triangles = 100000,
       .bases = 2,
       .resolution = 128,
       .terms = 20,
       .ladder_bases = 2,
       .ladder_bands = 16,
       .ladder_terms = 20,
       .parts = 2,
       .texcoords = true}};
  for (const TransferSize& size : sizes) {
    for (const int level : {0, 4, 9}) {
      if (size.vertices > 1000 && level == 9) continue;  // slow, and nothing new
      const Transfer transfer = random_transfer(7, size);
      const Transfer found = write_and_read(
          transfer, {.coefficient_type = CoefficientType::float32, .compression_level = level});
      EXPECT_EQ(first_difference(found, transfer), "") << size.vertices;
    }
  }
  EXPECT_EQ(first_difference(write_and_read(random_transfer_2(5), {CoefficientType::float32}),
                             random_transfer_2(5)),
            "");
}

/// `found` is `exact` rounded to nearest: within half a unit of the 11th bit, or of 2^-24 where
/// float16 is subnormal.
void expect_float16(const std::vector<float>& found, const std::vector<float>& exact) {
  ASSERT_EQ(found.size(), exact.size());
  for (size_t i = 0; i < exact.size(); ++i)
    ASSERT_LE(std::abs(found[i] - exact[i]),
              std::max(std::ldexp(std::abs(exact[i]), -11), std::ldexp(1.0f, -25)))
        << i;
}

/// `found` is `exact` rounded to the nearest multiple of `step`, by double arithmetic.
void expect_multiples(const std::vector<float>& found, const std::vector<float>& exact,
                      double step) {
  ASSERT_EQ(found.size(), exact.size());
  for (size_t i = 0; i < exact.size(); ++i)
    ASSERT_EQ(double{found[i]}, std::nearbyint(exact[i] / step) * step) << i;
}

TEST(TransferFile, RoundsCoefficientsToNearestFloat16) {
  const TemporaryFolder folder;
  Transfer transfer = random_transfer_2(11);
  const WriteTransferOptions options{.coefficient_type = CoefficientType::float16};
  // A tie goes to even, the smallest subnormal and the largest finite value are kept.
  transfer.coefficients[0] = 1 + std::ldexp(1.0f, -11);
  transfer.coefficients[1] = 1 + 3 * std::ldexp(1.0f, -11);
  transfer.coefficients[2] = std::ldexp(1.0f, -24);
  transfer.coefficients[3] = -65504;
  Transfer found = write_and_read(transfer, options);
  EXPECT_EQ(found.coefficients[0], 1);
  EXPECT_EQ(found.coefficients[1], 1 + std::ldexp(1.0f, -9));
  EXPECT_EQ(found.coefficients[2], std::ldexp(1.0f, -24));
  EXPECT_EQ(found.coefficients[3], -65504);
  expect_float16(found.coefficients, transfer.coefficients);
  expect_float16(found.ladder_coefficients, transfer.ladder_coefficients);
  for (size_t b = 0; b < 2; ++b) {
    expect_float16(found.bases[b].eigen, transfer.bases[b].eigen);
    found.bases[b].eigen = transfer.bases[b].eigen;
  }
  found.coefficients = transfer.coefficients;
  found.ladder_coefficients = transfer.ladder_coefficients;
  EXPECT_EQ(first_difference(found, transfer), "");

  const std::string path = folder.file("half.h5");
  transfer.coefficients[5] = 65520;  // rounds to infinity
  std::string error = error_of(
      path, [&] { write_transfer(transfer, path, options); }, ErrorKind::output);
  EXPECT_NE(error.find("/visibility/ssdf/coefficients, value 5"), std::string::npos) << error;
  transfer.bases[1].eigen[7] = -65520;
  error = error_of(
      path, [&] { write_transfer(transfer, path, {.coefficient_type = CoefficientType::int16}); },
      ErrorKind::output);
  EXPECT_NE(error.find("/visibility/ssdf/basis/eigen, value 391"), std::string::npos) << error;
}

TEST(TransferFile, RoundsCoefficientsToMultiplesOfOneStep) {
  // Of more than one chunk; the largest magnitude by which the step is found comes late.
  Transfer transfer =
      random_transfer(12, {.vertices = 40000, .terms = 20, .ladder_bases = 1, .ladder_terms = 30});
  transfer.coefficients[40000 * 20 - 3] = -20.5f;
  transfer.ladder_coefficients[40000 * 30 - 1] = 32767.5f * std::ldexp(1.0f, -13);
  const Transfer found = write_and_read(transfer, {});
  // The least 2^n with 32767 * 2^n of at least 20.5, and of just over 32767 * 2^-13.
  expect_multiples(found.coefficients, transfer.coefficients, std::ldexp(1.0, -10));
  expect_multiples(found.ladder_coefficients, transfer.ladder_coefficients, std::ldexp(1.0, -12));
  for (size_t b = 0; b < 2; ++b) expect_float16(found.bases[b].eigen, transfer.bases[b].eigen);
  EXPECT_EQ(found.ladder_bases[0].eigen, transfer.ladder_bases[0].eigen);
}

TEST(TransferFile, StepsOfExtremeCoefficients) {
  Transfer transfer = random_transfer(13);
  const auto read_back = [&](float first, float others) {
    transfer.coefficients.assign(transfer.coefficients.size(), others);
    transfer.coefficients[0] = first;
    return write_and_read(transfer, {}).coefficients;
  };
  const float huge = std::numeric_limits<float>::max();
  for (const float scale : {1.0f, std::ldexp(1.0f, -126), std::ldexp(1.0f, 112)}) {
    const std::vector<float> found = read_back(-32767 * scale, scale);  // both exact
    EXPECT_EQ(found[0], -32767 * scale);
    EXPECT_EQ(found[1], scale);
  }
  EXPECT_EQ(read_back(0, 0), std::vector<float>(240, 0.0f));
  EXPECT_EQ(read_back(std::ldexp(1.0f, -140), 0)[0], 0);  // below the least step, 2^-126
  // 2^128 (1 - 2^-24): the most steps of 2^113 that are a float.
  EXPECT_EQ(read_back(huge, 0)[0], 32767 * std::ldexp(1.0f, 113));
}

TEST(TransferFile, WhatWasReadIsWrittenAgainWithoutAChange) {
  const TemporaryFolder folder;
  for (const CoefficientType type : kTypes) {
    write_transfer(random_transfer_2(2), folder.file("a.h5"), {.coefficient_type = type});
    const Transfer first = read_transfer(folder.file("a.h5"));
    write_transfer(first, folder.file("b.h5"), {.coefficient_type = type});
    EXPECT_EQ(first_difference(read_transfer(folder.file("b.h5")), first), "");
  }
}

TEST(TransferFile, NothingOccludesWithoutBases) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const Transfer open = random_transfer(1, {.bases = 0});
  write_transfer(open, path);
  EXPECT_EQ(first_difference(read_transfer(path), open), "");
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_EQ(H5Lexists(file, "/visibility/ssdf", H5P_DEFAULT), 0);
  EXPECT_EQ(H5Lexists(file, "/visibility/ladder", H5P_DEFAULT), 0);
  H5Fclose(file);
}

TEST(TransferFile, EqualTransfersGiveEqualBytes) {
  const TemporaryFolder folder;
  for (const CoefficientType type : kTypes) {
    write_transfer(random_transfer_2(3), folder.file("a.h5"), {.coefficient_type = type});
    write_transfer(random_transfer_2(4), folder.file("b.h5"), {.coefficient_type = type});
    // Heap garbage of another kind than at the first write.
    std::vector<std::string> garbage(100, std::string(5000, 'x'));
    garbage.clear();
    write_transfer(random_transfer_2(3), folder.file("c.h5"), {.coefficient_type = type});
    EXPECT_EQ(read_bytes(folder.file("a.h5")), read_bytes(folder.file("c.h5")));
    EXPECT_NE(read_bytes(folder.file("a.h5")), read_bytes(folder.file("b.h5")));
  }
}

TEST(TransferFile, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure(
      "a.h5", [](const std::string& path) { write_transfer(random_transfer(1), path); });
}

std::string golden_file(const std::string& name) {
  return std::string(BURNISH_TEST_DATA) + "/transfer/" + name + ".h5";
}

TEST(TransferFile, FormatVersion1ReadsToKnownValues) {
  // Made by write_transfer(random_transfer(1), path) when the format was at version 1.
  const Transfer transfer = read_transfer(golden_file("format-1"));
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
  // What version 1 did not have.
  EXPECT_TRUE(transfer.parts.empty());
  EXPECT_EQ(transfer.bases[0].amplitude_rad, 0);
  EXPECT_TRUE(transfer.ladder_bases.empty());
  EXPECT_EQ(transfer.ladder_crossover, 0);
  EXPECT_EQ(transfer.provenance.coarsest, 0);
  EXPECT_EQ(transfer.provenance.residual_vertices, 0);
  EXPECT_FALSE(transfer.provenance.residual_held_out);
  EXPECT_TRUE(transfer.provenance.ssdf_errors.empty());
}

TEST(TransferFile, FormatVersion2ReadsToKnownValues) {
  if (std::getenv("BURNISH_UPDATE_GOLDEN")) {  // made by this very line, at format version 2
    write_transfer(random_transfer_2(1), golden_file("format-2"));
    write_transfer(random_transfer(1, {.bases = 0}), golden_file("format-2-open"));
  }
  const Transfer transfer = read_transfer(golden_file("format-2"));
  ASSERT_EQ(transfer.parts.size(), 3u);
  EXPECT_EQ(transfer.parts[0].name, "\xc3\xa4\xe2\x82\xac #1.obj");
  EXPECT_EQ(transfer.parts[1].name, "");
  EXPECT_EQ(transfer.parts[2].name, "p");
  EXPECT_EQ(transfer.parts[2].first_vertex, 13u);
  EXPECT_EQ(transfer.parts[2].vertices, 27u);
  EXPECT_EQ(transfer.parts[2].first_triangle, 10u);
  EXPECT_EQ(transfer.parts[2].triangles, 20u);
  EXPECT_EQ(transfer.triangles[29], (Triangle{33, 39, 28}));
  EXPECT_EQ(transfer.provenance.coarsest, 64);
  EXPECT_EQ(transfer.provenance.origin_offset, 1.25e-7);
  EXPECT_EQ(transfer.provenance.residual_vertices, 8);
  EXPECT_TRUE(transfer.provenance.residual_held_out);
  ASSERT_EQ(transfer.provenance.ssdf_errors.size(), 2u);
  EXPECT_EQ(transfer.provenance.ssdf_errors[1].bandwidth, 128);
  EXPECT_EQ(transfer.provenance.ssdf_errors[1].relative_rms, 0.125);
  ASSERT_EQ(transfer.provenance.ladder_errors.size(), 3u);
  EXPECT_EQ(transfer.provenance.ladder_errors[0].relative_rms, 0.005);
  ASSERT_EQ(transfer.bases.size(), 2u);
  EXPECT_EQ(transfer.bases[1].amplitude_rad, 1.5f);
  ASSERT_EQ(transfer.ladder_bases.size(), 2u);
  EXPECT_EQ(transfer.ladder_bases[1].bands, 4);
  EXPECT_EQ(transfer.ladder_terms(), 5);
  EXPECT_EQ(transfer.ladder_crossover, 16);
  // Values in memory as written down once, rounded by hand.
  EXPECT_EQ(transfer.bases[1].mean[63], 0.800545931f);
  EXPECT_EQ(transfer.bases[0].eigen[1], 1995 / 2048.0f);    // 0.973885655
  EXPECT_EQ(transfer.bases[1].eigen[383], 1419 / 2048.0f);  // 0.692992687
  EXPECT_EQ(transfer.coefficients[0], 14112 / 1024.0f);     // 13.7810783
  EXPECT_EQ(transfer.coefficients[239], 20390 / 1024.0f);   // 19.9120674
  EXPECT_EQ(transfer.ladder_bases[1].mean[15], -0.658100367f);
  EXPECT_EQ(transfer.ladder_bases[1].eigen[79], -0.206556857f);
  EXPECT_EQ(transfer.ladder_coefficients[0], 1340 / 8192.0f);    // 0.163604736
  EXPECT_EQ(transfer.ladder_coefficients[199], 2291 / 8192.0f);  // 0.279720068

  const Transfer open = read_transfer(golden_file("format-2-open"));
  EXPECT_EQ(open.vertex_count(), 40u);
  EXPECT_EQ(open.positions[0], Vector3f(-20.454668f, -80.62886f, -42.873764f));
  EXPECT_TRUE(open.bases.empty());
  EXPECT_TRUE(open.basis_id.empty());
  EXPECT_TRUE(open.coefficients.empty());
  EXPECT_EQ(open.provenance.rays, 123456789012345u);
}

TEST(TransferFile, WriterRejectsAnInvalidTransfer) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const auto write_error = [&](const std::function<void(Transfer&)>& spoil) {
    Transfer transfer = random_transfer_2(1);
    spoil(transfer);
    return error_of(
        path, [&] { write_transfer(transfer, path); }, ErrorKind::output);
  };
  const auto rejects = [&](const char* place, const std::function<void(Transfer&)>& spoil) {
    const std::string error = write_error(spoil);
    EXPECT_EQ(error.rfind(path + ": " + place, 0), 0u) << place << ": " << error;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  rejects("/mesh/positions", [](Transfer& t) { t = {}; });
  rejects("/mesh/normals[3]", [](Transfer& t) { t.normals[3] *= 1.01f; });
  rejects("/mesh/texcoords", [](Transfer& t) { t.texcoords.resize(39, {0, 0}); });
  rejects("/mesh/texcoords[2]", [=](Transfer& t) {
    t.texcoords.resize(40, {0, 0});
    t.texcoords[2].y() = nan;
  });
  rejects("/mesh/parts/ranges[2]", [](Transfer& t) { t.parts[1].vertices = 1; });
  rejects("/mesh/parts/names[2]", [](Transfer& t) { t.parts[2].name.push_back('\0'); });
  rejects("/mesh/parts/names[0]", [](Transfer& t) { t.parts[0].name.assign(4097, 'x'); });
  rejects("/visibility/ssdf/basis_id", [](Transfer& t) {
    t.bases.clear();
    t.ladder_bases.clear();
  });
  rejects("/visibility/ssdf/basis/mean", [](Transfer& t) { t.bases.resize(257, t.bases[0]); });
  rejects("/visibility/ssdf/basis/eigen", [](Transfer& t) { t.bases[1].terms = 5; });
  rejects("/visibility/ssdf/basis/eigen", [](Transfer& t) { t.bases[1].amplitude_rad = 2; });
  rejects("/visibility/ssdf/basis/mean", [](Transfer& t) { t.bases[0].resolution = 12; });
  rejects("/visibility/ssdf/coefficients", [](Transfer& t) { t.coefficients.pop_back(); });
  rejects("/visibility/ssdf/basis_id[0]", [](Transfer& t) { t.basis_id[0] = 7; });
  rejects("/visibility/ladder/basis/mean", [](Transfer& t) { t.bases.push_back(t.bases[0]); });
  rejects("/visibility/ladder/basis/eigen", [](Transfer& t) { t.ladder_bases[1].terms = 4; });
  rejects("/visibility/ladder/basis/eigen",
          [](Transfer& t) { t.ladder_bases[1].eigen.pop_back(); });
  rejects("/visibility/ladder/basis/mean, value 0",
          [](Transfer& t) { t.ladder_bases[0].mean[0] = -3.6f; });
  rejects("/visibility/ladder/coefficients", [](Transfer& t) { t.ladder_coefficients.pop_back(); });
  rejects("/visibility/ladder/coefficients, value 1",
          [=](Transfer& t) { t.ladder_coefficients[1] = nan; });
  rejects("/visibility/ladder/coefficients", [](Transfer& t) { t.ladder_bases.clear(); });
  rejects("/visibility/ladder, attribute crossover", [](Transfer& t) {
    t.ladder_bases.clear();
    t.ladder_coefficients.clear();
  });
  rejects("/provenance, attribute mesh_name",
          [](Transfer& t) { t.provenance.mesh_name.push_back('\0'); });
  rejects("/provenance/ladder_errors[1]",
          [](Transfer& t) { t.provenance.ladder_errors[1].relative_rms = -1; });
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace burnish::test
