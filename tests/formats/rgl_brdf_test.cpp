// RGL tensor files: made here of tables whose interpolation has a closed form.
#include <cmath>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "burnish/formats/measured_brdf.h"
#include "files.h"
#include "measured_files.h"

namespace burnish::test {
namespace {

const std::string kName = "metal.bsdf";
constexpr unsigned kSeed = 20181204;
constexpr double kTau = 2 * kPi<double>;

/// What the tables of make_file() hold, all linear along each axis so that bilinear interpolation
/// is exact: the truth of the tests.
struct Truth {
  int azimuths = 1;     ///< of the incoming direction; 1: isotropic
  double range = kTau;  ///< of the azimuths, from -pi on
  bool visible = true;  ///< whether the density of visible normals varies over the square
  bool jacobian = true;

  static double distribution(double x, double y) { return (3 - 2 * x) * (1 + y); }
  static double area(double x, double y) { return (1 - 0.5 * x) * (2 + y); }
  /// Density (1 + 3 x) (2 - y), of which the integrals are
  static double warped_x(double x) { return (x + 1.5 * x * x) / 2.5; }
  static double warped_y(double y) { return (2 * y - 0.5 * y * y) / 1.5; }
  static double color(int c, double x, double y, double angle, double azimuth) {
    return (1 + c + x) * (2 - y) * (1 + angle) * (4 + azimuth);
  }

  Vector3d eval(const Vector3d& outgoing, const Vector3d& incoming) const {
    const Vector3d half = (outgoing + incoming).normalized();
    const double angle = std::acos(outgoing.z()), azimuth = std::atan2(outgoing.y(), outgoing.x());
    const double turn = std::atan2(half.y(), half.x()) - (azimuths == 1 ? azimuth : 0);
    const double x = std::sqrt(std::acos(half.z()) / (kPi<double> / 2));
    double y = turn / kTau + 0.5;
    y -= std::floor(y);
    const double u = visible ? warped_x(x) : x, v = visible ? warped_y(y) : y;
    const double scale =
        jacobian ? distribution(x, y) /
                       (4 * area(std::sqrt(2 * angle / kPi<double>), azimuth / kTau + 0.5))
                 : 1;
    Vector3d value;
    for (int c = 0; c < 3; ++c)
      value[c] = scale * color(c, u, v, angle, azimuths == 1 ? 0 : azimuth) / incoming.z();
    return value;
  }
};

constexpr std::uint64_t kEdge = 5, kAngles = 4;

std::vector<TensorField> make_fields(const Truth& truth) {
  const auto n = static_cast<std::uint64_t>(truth.azimuths);
  const auto azimuth = [=](std::uint64_t j) {
    return n == 1 ? 0.0 : -kPi<double> + truth.range * double(j) / double(n - 1);
  };
  const auto angle = [](std::uint64_t k) { return kPi<double> / 2 * double(k) / (kAngles - 1); };
  const auto x = [](std::uint64_t i) { return double(i % kEdge) / (kEdge - 1); };
  const auto y = [](std::uint64_t i) { return double(i / kEdge % kEdge) / (kEdge - 1); };
  std::vector<TensorField> fields;
  fields.push_back({"description", kTensorUint8, {8}, "a metal\n"});
  fields.push_back(float_field("phi_i", {n}, azimuth));
  fields.push_back(float_field("theta_i", {kAngles}, angle));
  fields.push_back(float_field("sigma", {kEdge, kEdge},
                               [&](std::uint64_t i) { return Truth::area(x(i), y(i)); }));
  fields.push_back(float_field("ndf", {kEdge, kEdge},
                               [&](std::uint64_t i) { return Truth::distribution(x(i), y(i)); }));
  fields.push_back(float_field("vndf", {n, kAngles, kEdge, kEdge}, [&](std::uint64_t i) {
    return truth.visible ? 7 * (1 + 3 * x(i)) * (2 - y(i)) : 3.0;
  }));
  fields.push_back(float_field("rgb", {n, kAngles, 3, kEdge, kEdge}, [&](std::uint64_t i) {
    const std::uint64_t slice = i / (kEdge * kEdge);
    return Truth::color(int(slice % 3), x(i), y(i), angle(slice / 3 % kAngles),
                        azimuth(slice / 3 / kAngles));
  }));
  fields.push_back({"jacobian", kTensorUint8, {1}, std::string(1, truth.jacobian ? '\1' : '\0')});
  return fields;
}

Vector3f random_direction(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform;
  const float z = 0.02f + 0.98f * uniform(random), phi = 2 * kPi<float> * uniform(random);
  const float r = std::sqrt(1 - z * z);
  return Vector3f(r * std::cos(phi), r * std::sin(phi), z).normalized();
}

void expect_truth(const Truth& truth) {
  const MeasuredBrdf brdf = parse_measured_brdf(tensor_file(make_fields(truth)), kName);
  EXPECT_EQ(brdf.format, "RGL tensor");
  EXPECT_EQ(brdf.description, "a metal ");
  EXPECT_EQ(brdf.isotropic, truth.azimuths == 1);
  EXPECT_NEAR(brdf.max_angle_rad, kPi<double> / 3, 1e-6);  // the node before the horizon
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (int i = 0; i < 500; ++i) {
    const Vector3f outgoing = random_direction(random);
    Vector3f incoming = random_direction(random);
    const Vector3d expected = truth.eval(outgoing.cast<double>(), incoming.cast<double>());
    // The tables and the running integrals are float: some 1e-6 of a value.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(brdf.eval(outgoing, incoming)[c], expected[c], 1e-5 * expected[c] + 1e-5) << i;
  }
  EXPECT_TRUE((brdf.eval({0, 0, 1}, Vector3f(0.8f, 0, -0.6f)) == 0).all());
}

TEST(RglBrdf, IsotropicFileFollowsItsFormula) { expect_truth({}); }
TEST(RglBrdf, FlatVisibleNormalsLeaveTheSquareAsItIs) { expect_truth({1, kTau, false, true}); }
TEST(RglBrdf, AnisotropicFileFollowsItsFormula) { expect_truth({9, kTau, true, true}); }
TEST(RglBrdf, WithoutJacobianTheTableIsTheValue) { expect_truth({9, kTau, true, false}); }

TEST(RglBrdf, HalfAndQuarterOfTheAzimuthsStandForAll) {
  for (const int parts : {2, 4}) {
    Truth truth{5, kTau / parts, true, true};
    const MeasuredBrdf brdf = parse_measured_brdf(tensor_file(make_fields(truth)), kName);
    std::mt19937 random(kSeed + 1);
    SCOPED_TRACE(testing::Message() << parts << " parts, seed " << kSeed + 1);
    for (int i = 0; i < 200; ++i) {
      Vector3f outgoing = random_direction(random), incoming = random_direction(random);
      outgoing = Vector3f(parts == 4 ? -std::abs(outgoing.x()) : outgoing.x(),
                          -std::abs(outgoing.y()), outgoing.z());
      const Rgb measured = brdf.eval(outgoing, incoming);
      const Vector3d expected = truth.eval(outgoing.cast<double>(), incoming.cast<double>());
      EXPECT_NEAR(measured[0], expected[0], 1e-5 * expected[0] + 1e-5);
      const auto turned = [](const Vector3f& v, float x, float y) {
        return Vector3f(x * v.x(), y * v.y(), v.z());
      };
      EXPECT_TRUE(
          measured.isApprox(brdf.eval(turned(outgoing, -1, -1), turned(incoming, -1, -1)), 1e-4f));
      if (parts == 4) {
        EXPECT_TRUE(
            measured.isApprox(brdf.eval(turned(outgoing, -1, 1), turned(incoming, -1, 1)), 1e-4f));
      }
    }
  }
}

TEST(RglBrdf, TabulatedDistributionIsThatOfTheFile) {
  const MeasuredBrdf brdf = parse_measured_brdf(tensor_file(make_fields({})), kName);
  ASSERT_TRUE(brdf.distribution);
  std::mt19937 random(kSeed + 2);
  for (int i = 0; i < 200; ++i) {
    const Vector3d half = random_direction(random).cast<double>();
    const double x = std::sqrt(2 * std::acos(half.z()) / kPi<double>);
    const double y = std::atan2(half.y(), half.x()) / kTau + 0.5;
    EXPECT_NEAR(eval_tabulated_distribution(*brdf.distribution, half), Truth::distribution(x, y),
                1e-5);
  }
}

TEST(RglBrdf, ReadsNumbersOfAllFloatingPointTypes) {
  std::vector<TensorField> fields = make_fields({});
  const MeasuredBrdf single = parse_measured_brdf(tensor_file(fields), kName);
  TensorField& area = fields[3];
  TensorField wide{"sigma", kTensorFloat64, area.shape, ""};
  for (std::size_t i = 0; i < area.bytes.size(); i += 4) {
    float value;
    std::memcpy(&value, area.bytes.data() + i, 4);
    append_number(wide.bytes, double(value));
  }
  fields[3] = wide;
  fields[4] = {"ndf", kTensorFloat16, {2, 2}, ""};
  for (int i = 0; i < 4; ++i) append_number(fields[4].bytes, std::uint16_t{0x4000});  // 2.0
  const MeasuredBrdf other = parse_measured_brdf(tensor_file(fields), kName);
  const Vector3f o(0, 0, 1), i = Vector3f(0.3f, 0.1f, 0.8f).normalized();
  const double ratio =
      2 / eval_tabulated_distribution(*single.distribution, (o + i).normalized().cast<double>());
  EXPECT_TRUE(other.eval(o, i).isApprox(float(ratio) * single.eval(o, i), 1e-5f));
}

/// The file with spectra of one shape in place of RGB: a * (1 + slope (wavelength - 555) / 555).
Rgb spectral_value(double slope) {
  std::vector<TensorField> fields = make_fields({1, kTau, false, false});
  constexpr std::uint64_t kBands = 33;
  const auto nm = [](std::uint64_t k) { return 380 + 20.0 * double(k); };
  fields[6] = float_field("spectra", {1, kAngles, kBands, kEdge, kEdge}, [&](std::uint64_t i) {
    return 0.5 * (1 + slope * (nm(i / (kEdge * kEdge) % kBands) - 555) / 555);
  });
  fields.push_back(float_field("wavelengths", {kBands}, nm));
  return parse_measured_brdf(tensor_file(fields), kName).eval({0, 0, 1}, {0, 0, 1});
}

TEST(RglBrdf, FlatSpectrumIsGreyAndALongWaveOneReddish) {
  EXPECT_TRUE(spectral_value(0).isApprox(Rgb::Constant(0.5f), 1e-5f));
  const Rgb red = spectral_value(1);
  EXPECT_GT(red[0], 1.05f * red[1]);
  EXPECT_GT(red[1], 1.05f * red[2]);
}

std::string error_with(std::vector<TensorField> fields, std::size_t index,
                       const TensorField& replacement) {
  fields[index] = replacement;
  return error_of(kName, [&] { parse_measured_brdf(tensor_file(fields), kName); });
}

TEST(RglBrdf, BadFieldsAreNamedWithWhatIsExpected) {
  const std::vector<TensorField> good = make_fields({3, kTau, true, true});
  const auto expect = [&](std::size_t index, const TensorField& field, const char* part) {
    const std::string what = error_with(good, index, field);
    EXPECT_NE(what.find(part), std::string::npos) << part << ": " << what;
    EXPECT_NE(what.find("expected"), std::string::npos) << what;
  };
  const auto one = [](std::uint64_t) { return 1.0; };
  expect(1, float_field("phi_i", {3}, one), "'phi_i': element 1 is 1");
  expect(1, float_field("phi_i", {3}, [](std::uint64_t i) { return double(i) / 4; }),
         "'phi_i': azimuths over 0.5");
  // A half of the circle, but not the half that is read.
  expect(1, float_field("phi_i", {3}, [](std::uint64_t i) { return double(i) / 2 * kPi<double>; }),
         "'phi_i': the first azimuth is 0");
  expect(2, float_field("theta_i", {kAngles}, [](std::uint64_t i) { return double(i); }),
         "'theta_i': element 2");
  expect(2, float_field("theta", {kAngles}, one), "'theta_i': is missing");
  expect(3, float_field("sigma", {kEdge}, one), "'sigma': shape 5");
  expect(3, float_field("sigma", {kEdge, 1}, one), "'sigma': shape 5 x 1");
  expect(3, float_field("sigma", {2, 2}, [](std::uint64_t) { return 0.0; }), "'sigma': element 0");
  expect(4, float_field("ndf", {2, 2}, [](std::uint64_t) { return -1.0; }),
         "'ndf': element 0 is -1");
  expect(4, float_field("ndf", {2, 2}, [](std::uint64_t) { return NAN; }), "'ndf': element 0");
  expect(4, {"ndf", kTensorUint8, {2, 2}, "abcd"}, "'ndf': type uint8");
  expect(5, float_field("vndf", {2, kAngles, 2, 2}, one), "'vndf': shape 2 x 4 x 2 x 2");
  expect(6, float_field("rgb", {3, kAngles, 4, 2, 2}, one), "'rgb': shape");
  expect(6, float_field("colour", {3, kAngles, 3, 2, 2}, one), "'rgb': is missing");
  expect(7, float_field("jacobian", {1}, one), "'jacobian': type float32");
  expect(7, {"ndf", kTensorUint8, {1}, "\1"}, "'ndf' for the second time");
}

TEST(RglBrdf, ForgedSizesAreRefusedBeforeAnythingIsAllocated) {
  const std::vector<TensorField> good = make_fields({});
  for (const std::uint64_t edge : {std::uint64_t{1} << 20, std::uint64_t{1} << 33,
                                   std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
    std::vector<TensorField> fields = good;
    fields[6].shape[3] = edge;
    const std::string what =
        error_of(kName, [&] { parse_measured_brdf(tensor_file(fields), kName); });
    EXPECT_NE(what.find("field 'rgb' of shape"), std::string::npos) << what;
  }
  std::string bytes = tensor_file(good);
  bytes[12] = 2;
  EXPECT_NE(error_of(kName, [&] { parse_measured_brdf(bytes, kName); }).find("version 2.0"),
            std::string::npos);
}

TEST(RglBrdf, EveryTruncationIsRefusedAndNoDamageCrashes) {
  const std::string bytes = tensor_file(make_fields({3, kTau, true, true}));
  // The last field is one byte long and its last.
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(error_of(kName, [&] { parse_measured_brdf(bytes.substr(0, size), kName); }), "")
        << size;
  std::mt19937 random(kSeed + 3);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed + 3);
  int refused = 0;
  constexpr int kTrials = 3000;
  for (int i = 0; i < kTrials; ++i) {
    std::string damaged = bytes;
    // The head is a tenth of the file; half of the changes are there.
    const std::size_t range = i % 2 ? bytes.size() : std::size_t{300};
    damaged[random() % range] = static_cast<char>(random());
    refused += error_of(kName, [&] {
                 const Vector3f up(0, 0, 1), side(0.6f, 0, 0.8f);
                 const Rgb value = parse_measured_brdf(damaged, kName).eval(up, side);
                 EXPECT_TRUE((value >= 0).all());
               }) != "";
  }
  EXPECT_GT(refused, kTrials / 4);  // most of the head's bytes are names, sizes and offsets
}

// The tables hold the incoming cosine; a reader that forgets it is off by half here.
TEST(RglBrdf, SharedPaperIsReciprocal) {
  const std::filesystem::path path = shared_data() / "brdf" / "paper_blue_rgb.bsdf";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no file " << path << " (set BURNISH_SHARED_DATA)";
  const MeasuredBrdf brdf = read_measured_brdf(path.string());
  std::mt19937 random(kSeed + 4);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed + 4);
  double difference = 0, sum = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3f a = random_direction(random), b = random_direction(random);
    if (std::min(a.z(), b.z()) < 0.5f) continue;  // to 60 degrees: measured well
    const Rgb forward = brdf.eval(a, b), backward = brdf.eval(b, a);
    difference += double((forward - backward).square().sum());
    sum += double((forward + backward).square().sum()) / 4;
  }
  // As measured: 3 %.
  EXPECT_LT(std::sqrt(difference / sum), 0.06);
}

TEST(RglBrdf, SharedFilesHaveNormalisedDistributionsAndAlbedosBelowOne) {
  const std::filesystem::path folder = shared_data() / "brdf";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no folder " << folder << " (set BURNISH_SHARED_DATA)";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bsdf") continue;
    SCOPED_TRACE(entry.path().filename().string());
    ++files;
    const MeasuredBrdf brdf = read_measured_brdf(entry.path().string());
    EXPECT_TRUE(brdf.isotropic);
    EXPECT_FALSE(brdf.description.empty());
    // Angles as their square root, where narrow distributions have room.
    double area = 0;
    Vector3d albedo = Vector3d::Zero();
    constexpr int kSteps = 400, kTurns = 16;
    for (int k = 0; k < kSteps; ++k) {
      const double u = (k + 0.5) / kSteps, angle = kPi<double> / 2 * u * u;
      const double step = kPi<double> * u / kSteps * kTau * std::sin(angle);
      for (int j = 0; j < kTurns; ++j) {
        const double turn = kTau * (j + 0.5) / kTurns;
        const Vector3d half(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                            std::cos(angle));
        area += step / kTurns * half.z() * eval_tabulated_distribution(*brdf.distribution, half);
        const Vector3d incoming = 2 * half.z() * half - Vector3d::UnitZ();
        if (incoming.z() <= 0) continue;
        const Rgb value = brdf.eval({0, 0, 1}, incoming.cast<float>());
        albedo += step / kTurns * 4 * half.z() * incoming.z() * value.cast<double>().matrix();
      }
    }
    // A distribution of microfacet normals: of 128 nodes, off by up to 2.4 % in the narrowest one.
    EXPECT_NEAR(area, 1, 0.03);
    EXPECT_GT(albedo.minCoeff(), 0.0);
    EXPECT_LT(albedo.maxCoeff(), 1.0);
  }
  EXPECT_GE(files, 1);
}

}  // namespace
}  // namespace burnish::test
