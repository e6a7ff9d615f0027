#include <cstdint>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "transfer_damage.h"

namespace burnish::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(DamagedTransfer, RejectsSsdfs) {
  expect_rejected({
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
         f.set_int("/", "format_version", 1);
         f.replace("/visibility/ssdf/basis/mean", {257, 4}, std::vector<float>(257 * 4));
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
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/eigen", {2, 64, 6}, std::vector<float>(768, kInfinity));
       }},
      {"/visibility/ssdf/coefficients", "expected 6",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", {40, 5}, std::vector<float>(200));
       }},
      {"/visibility/ssdf/coefficients, value 0", "finite",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", {40, 6}, std::vector<float>(240, kNan));
       }},
      {"/visibility/ssdf/basis_id[0]", "basis 2, expected below 2",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis_id", H5T_STD_U8LE, H5T_NATIVE_UINT8, {40},
                   std::vector<std::uint8_t>(40, 2));
       }},
      {"/visibility/ssdf/basis/mean, value 0", "3.2, expected -3.14",
       [](OpenedFile& f) {
         f.set_float("/visibility/ssdf", "amplitude_rad", 0);
         f.replace("/visibility/ssdf/basis/mean", {2, 64}, std::vector<float>(128, 3.2f));
       }},
      {"/visibility/ssdf/basis/mean, value 0", "1.1, expected -1",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/basis/mean", {2, 64}, std::vector<float>(128, 1.1f));
       }},
      {"/visibility/ssdf, attribute amplitude_rad", "expected 0 or more",
       [](OpenedFile& f) { f.set_float("/visibility/ssdf", "amplitude_rad", -1); }},
      {"/visibility/ssdf, attribute amplitude_rad", "nan",
       [](OpenedFile& f) { f.set_float("/visibility/ssdf", "amplitude_rad", kNan); }},
      {"/visibility, attribute bases", "-1, expected 0..256",
       [](OpenedFile& f) { f.set_int("/visibility", "bases", -1); }},
      {"/visibility, attribute bases", "257, expected 0..256",
       [](OpenedFile& f) { f.set_int("/visibility", "bases", 257); }},
      {"/visibility/ssdf/basis/mean", "expected 1 along dimension 0",
       [](OpenedFile& f) { f.set_int("/visibility", "bases", 1); }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "expected a positive number",
       [](OpenedFile& f) { f.set_float("/visibility/ssdf/coefficients", "scale_factor", 0); }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "expected a positive number",
       [](OpenedFile& f) { f.set_float("/visibility/ssdf/coefficients", "scale_factor", kNan); }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "expected a positive number",
       [](OpenedFile& f) {
         f.set_float("/visibility/ssdf/coefficients", "scale_factor", kInfinity);
       }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "expected a positive number",
       [](OpenedFile& f) { f.set_float("/visibility/ssdf/coefficients", "scale_factor", -1); }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "expected type",
       [](OpenedFile& f) { f.set_double("/visibility/ssdf/coefficients", "scale_factor", 1); }},
      {"/visibility/ssdf/coefficients, attribute scale_factor", "is missing",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", H5T_STD_I16LE, H5T_NATIVE_INT16, {40, 6},
                   std::vector<std::int16_t>(240));
       }},
      {"/visibility/ssdf/coefficients, value", "finite",  // 32767 steps are beyond a float
       [](OpenedFile& f) {
         f.set_float("/visibility/ssdf/coefficients", "scale_factor",
                     std::numeric_limits<float>::max());
       }},
      {"/visibility/ssdf/coefficients", "expected float32 or float16 or int16",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", H5T_STD_I8LE, H5T_NATIVE_INT8, {40, 6},
                   std::vector<std::int8_t>(240));
       }},
      {"/visibility/ssdf/coefficients", "expected float32 or float16 or int16",
       [](OpenedFile& f) {
         f.replace("/visibility/ssdf/coefficients", H5T_STD_U16LE, H5T_NATIVE_UINT16, {40, 6},
                   std::vector<std::uint16_t>(240));
       }},
      {"/visibility/ssdf/basis/eigen", "expected float32, little",  // unknown to version 1
       [](OpenedFile& f) { f.set_int("/", "format_version", 1); }},
      {"/visibility/ssdf/coefficients", "expected float32 or float16, little",
       [](OpenedFile& f) {
         f.set_int("/", "format_version", 1);
         f.replace("/visibility/ssdf/basis/eigen", {2, 64, 6}, std::vector<float>(768));
       }},
  });
}

TEST(DamagedTransfer, RejectsLadders) {
  expect_rejected({
      {"/visibility, attribute ladder_bases", "expected 0..256",
       [](OpenedFile& f) { f.set_int("/visibility", "ladder_bases", -1); }},
      {"/visibility/ladder/basis/mean", "expected 1 along dimension 0",
       [](OpenedFile& f) { f.set_int("/visibility", "ladder_bases", 1); }},
      {"/visibility/ladder/basis/mean", "expected none where the SSDF has no basis",
       [](OpenedFile& f) { f.set_int("/visibility", "bases", 0); }},
      {"/visibility/ladder/basis/mean", "3 bases, expected none, one, or one for each",
       [](OpenedFile& f) {
         f.set_int("/visibility", "ladder_bases", 3);
         f.replace("/visibility/ladder/basis/mean", {3, 16}, std::vector<float>(48));
         f.replace("/visibility/ladder/basis/eigen", {3, 16, 5}, std::vector<float>(240));
       }},
      {"/visibility/ladder/basis/mean", "15 harmonics, expected a square up to 16^2",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/mean", {2, 15}, std::vector<float>(30));
       }},
      {"/visibility/ladder/basis/mean", "289 harmonics, expected a square up to 16^2",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/mean", {2, 289}, std::vector<float>(578));
       }},
      {"/visibility/ladder/basis/mean", "0 bands",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/mean", H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {2, 0},
                   std::vector<float>(), false);
         f.replace("/visibility/ladder/basis/eigen", H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {2, 0, 5},
                   std::vector<float>(), false);
       }},
      {"/visibility/ladder/basis/mean, value 0", "3.6, expected -3.5",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/mean", {2, 16}, std::vector<float>(32, 3.6f));
       }},
      {"/visibility/ladder/basis/mean, value 0", "finite",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/mean", {2, 16}, std::vector<float>(32, kNan));
       }},
      {"/visibility/ladder/basis/eigen", "has 2 dimensions",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/eigen", {32, 5}, std::vector<float>(160));
       }},
      {"/visibility/ladder/basis/eigen", "expected 16 along dimension 1",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/eigen", {2, 4, 5}, std::vector<float>(40));
       }},
      {"/visibility/ladder/basis/eigen", "1025 terms",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/eigen", {2, 16, 1025},
                   std::vector<float>(2 * 16 * 1025));
       }},
      {"/visibility/ladder/basis/eigen, value 0", "finite",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/eigen", {2, 16, 5},
                   std::vector<float>(160, kInfinity));
       }},
      {"/visibility/ladder/basis/eigen", "expected float32, little",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/basis/eigen", {2, 16, 5}, std::vector<double>(160));
       }},
      {"/visibility/ladder/coefficients", "expected 5",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/coefficients", {40, 6}, std::vector<float>(240));
       }},
      {"/visibility/ladder/coefficients, value 0", "finite",
       [](OpenedFile& f) {
         f.replace("/visibility/ladder/coefficients", {40, 5}, std::vector<float>(200, kNan));
       }},
      {"/visibility/ladder/coefficients, attribute scale_factor", "expected a positive number",
       [](OpenedFile& f) { f.set_float("/visibility/ladder/coefficients", "scale_factor", 0); }},
      {"/visibility/ladder, attribute crossover", "expected 0 or more",
       [](OpenedFile& f) { f.set_float("/visibility/ladder", "crossover", -1); }},
      {"/visibility/ladder, attribute crossover", "nan",
       [](OpenedFile& f) { f.set_float("/visibility/ladder", "crossover", kNan); }},
  });
}

}  // namespace
}  // namespace burnish::test
