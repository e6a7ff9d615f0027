// MERL files, CSV tables, and how formats are told apart.
#include "burnish/formats/measured_brdf.h"

#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "files.h"
#include "measured_files.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 20030727;

std::string parse_error(std::string_view bytes) {
  const std::string name = "sample";
  return error_of(name, [&] { parse_measured_brdf(bytes, name); });
}

/// A MERL file whose value is value(channel, half, difference, azimuth bin).
template <class Value>
std::string merl_file(const Value& value) {
  std::string bytes;
  for (const std::int32_t edge : {90, 90, 180}) append_number(bytes, edge);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 90; ++i)
      for (int j = 0; j < 90; ++j)
        for (int k = 0; k < 180; ++k) append_number(bytes, double(value(c, i, j, k)));
  return bytes;
}

/// Directions from the angles of half and difference vectors, by rotations about y and z.
std::pair<Vector3f, Vector3f> pair_of(double half, double azimuth, double difference,
                                      double difference_azimuth) {
  const Vector3d d(std::sin(difference) * std::cos(difference_azimuth),
                   std::sin(difference) * std::sin(difference_azimuth), std::cos(difference));
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) * Eigen::AngleAxisd(half, Vector3d::UnitY()))
          .toRotationMatrix();
  const Vector3d incoming = turn * d, outgoing = turn * Vector3d(-d.x(), -d.y(), d.z());
  return {outgoing.cast<float>(), incoming.cast<float>()};
}

TEST(MerlBrdf, EveryBinIsFoundByItsAngles) {
  // Each bin holds its own number.
  const std::string bytes =
      merl_file([](int c, int i, int j, int k) { return (c + 1) * 1e7 + (i * 90 + j) * 180 + k; });
  const MeasuredBrdf brdf = parse_measured_brdf(bytes, "sample");
  EXPECT_EQ(brdf.format, "MERL");
  EXPECT_TRUE(brdf.isotropic);
  EXPECT_FALSE(brdf.distribution);
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::uniform_real_distribution<double> uniform;
  int seen = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const int i = int(random() % 60), j = int(random() % 80), k = int(random() % 180);
    // The middle of a bin: half angles are spaced by the square.
    const double half = kPi<double> / 2 * std::pow((i + 0.5) / 90, 2);
    const auto [outgoing, incoming] =
        pair_of(half, 2 * kPi<double> * uniform(random), kPi<double> / 180 * (j + 0.5),
                kPi<double> / 180 * (k + 0.5));
    if (outgoing.z() <= 0 || incoming.z() <= 0) continue;
    ++seen;
    const double scales[3] = {1 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
    const int bin = (i * 90 + j) * 180 + k;
    const Rgb forward = brdf.eval(outgoing, incoming), backward = brdf.eval(incoming, outgoing);
    for (int c = 0; c < 3; ++c) {
      const auto expected = float(scales[c] * ((c + 1) * 1e7 + bin));
      // Where the half angle is small, float directions leave its azimuth, and with it that of the
      // difference, uncertain: neighbouring bins differ by 1 of 1e7 there.
      EXPECT_NEAR(forward[c] / expected, 1, i < 3 ? 1e-5 : 1e-6) << i << " " << j << " " << k;
      EXPECT_NEAR(backward[c] / expected, 1, i < 3 ? 1e-5 : 1e-6) << i << " " << j << " " << k;
    }
  }
  EXPECT_GT(seen, 10000);
}

TEST(MerlBrdf, NegativeBinsAreMissing) {
  const std::string bytes =
      merl_file([](int c, int i, int, int) { return c == 1 && i == 0 ? -1.0 : 1500.0; });
  const MeasuredBrdf brdf = parse_measured_brdf(bytes, "sample");
  EXPECT_TRUE(brdf.eval({0, 0, 1}, {0, 0, 1}).isNaN().all());
  const auto [outgoing, incoming] = pair_of(0.5, 1, 0.5, 1);
  EXPECT_TRUE(brdf.eval(outgoing, incoming).isApprox(Rgb(1, 1.15f, 1.66f)));
}

TEST(MerlBrdf, BadFilesAreRefused) {
  std::string bytes = merl_file([](int, int, int, int) { return 1.0; });
  // Every eighth kilobyte, and near both ends: all of them would take minutes.
  for (std::size_t size = 0; size < bytes.size();
       size += size < 64 || size + 8192 > bytes.size() ? 1 : 8191)
    EXPECT_NE(parse_error(std::string_view(bytes).substr(0, size)), "") << size;
  EXPECT_NE(parse_error(bytes + "x").find("expected 34992012"), std::string::npos);
  EXPECT_NE(parse_error(merl_file([](int, int, int, int) { return -1.0; })).find("missing"),
            std::string::npos);
  const double infinite = std::numeric_limits<double>::infinity();
  std::memcpy(bytes.data() + 12 + 80, &infinite, 8);
  EXPECT_NE(parse_error(bytes).find("byte 92: found inf"), std::string::npos);
  bytes[0] = 91;
  EXPECT_NE(parse_error(bytes).find("90 x 90 x 180"), std::string::npos);
}

const std::string kHeader = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";

TEST(CsvBrdf, SamplesAreWhatTheFileSays) {
  const MeasuredBrdf brdf = parse_measured_brdf(
      "# brushed plate\n# second comment\n\n theta_i, phi_i,theta_o ,phi_o,r,g,b\r\n"
      "30,90, 60,180,1,2.5,3e-1\n# between\n0,0,45,-90,.5,.5,.5\n",
      "sample");
  EXPECT_EQ(brdf.format, "CSV");
  EXPECT_EQ(brdf.description, "brushed plate");
  EXPECT_FALSE(brdf.isotropic);
  EXPECT_NEAR(brdf.max_angle_rad, kPi<double> / 3, 1e-6);
  ASSERT_EQ(brdf.samples.size(), 2u);
  const BrdfSample& first = brdf.samples[0];
  EXPECT_TRUE(first.incoming.isApprox(Vector3f(0, 0.5f, std::sqrt(0.75f)), 1e-6f));
  EXPECT_TRUE(first.outgoing.isApprox(Vector3f(-std::sqrt(0.75f), 0, 0.5f), 1e-6f));
  EXPECT_TRUE((first.value == Rgb(1, 2.5f, 0.3f)).all());
  EXPECT_TRUE(brdf.samples[1].outgoing.isApprox(Vector3f(0, -1, 1).normalized(), 1e-6f));
}

/// A smooth BRDF and a table of it at random directions.
Rgb smooth_value(const Vector3f& outgoing, const Vector3f& incoming) {
  const Vector3f half = (outgoing + incoming).normalized();
  return Rgb(1, 2, 3) * std::exp(-2 * half.x() * half.x() - half.y() * half.y());
}

TEST(CsvBrdf, IsItsSamplesAndSmoothBetweenThem) {
  std::mt19937 random(kSeed + 1);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed + 1);
  std::uniform_real_distribution<float> angle(0, 75), azimuth(-180, 180);
  std::string text = kHeader;
  const auto direction = [](float theta, float phi) {
    const float degree = kPi<float> / 180;
    return Vector3f(std::sin(degree * theta) * std::cos(degree * phi),
                    std::sin(degree * theta) * std::sin(degree * phi), std::cos(degree * theta));
  };
  for (int i = 0; i < 20000; ++i) {
    const float a = angle(random), b = azimuth(random), c = angle(random), d = azimuth(random);
    const Rgb value = smooth_value(direction(c, d), direction(a, b));
    text += fmt::format("{},{},{},{},{},{},{}\n", a, b, c, d, value[0], value[1], value[2]);
  }
  const MeasuredBrdf brdf = parse_measured_brdf(text, "sample");
  ASSERT_EQ(brdf.samples.size(), 20000u);
  for (int i = 0; i < 200; ++i) {
    const BrdfSample& sample = brdf.samples[std::size_t(i)];
    EXPECT_TRUE(brdf.eval(sample.outgoing, sample.incoming).isApprox(sample.value, 1e-3f));
    EXPECT_TRUE(brdf.eval(sample.incoming, sample.outgoing).isApprox(sample.value, 1e-3f));
  }
  double squares = 0, total = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3f outgoing = direction(angle(random), azimuth(random)),
                   incoming = direction(angle(random), azimuth(random));
    const Rgb truth = smooth_value(outgoing, incoming);
    squares += (brdf.eval(outgoing, incoming) - truth).square().sum();
    total += truth.square().sum();
  }
  // 20,000 samples in four dimensions are 12 along an axis: an error of some per cent.
  EXPECT_LT(std::sqrt(squares / total), 0.05);
  EXPECT_TRUE(brdf.eval({0, 0, 1}, direction(80, 0)).isNaN().all());
  EXPECT_TRUE((brdf.eval({0, 0, 1}, {1, 0, 0}) == 0).all());
}

TEST(CsvBrdf, BadLinesAreNamedWithWhatIsExpected) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const std::string what = parse_error(text);
    EXPECT_NE(what.find(part), std::string::npos) << part << ": " << what;
    EXPECT_NE(what.find("expected"), std::string::npos) << what;
  };
  expect("", "is empty");
  expect("hello\n", "line 1: found 'hello'");
  expect("# only\n", "line 1: found '# only'");
  expect(kHeader, "found no samples");
  expect(kHeader + "1,2,3,4,5,6,7", "line 2: the file ends within a line");
  expect(kHeader + "1,2,3,4,5,6\n", "line 2: found 6 columns");
  expect(kHeader + "1,2,3,4,5,6,7,8\n", "line 2: found 8 columns");
  expect(kHeader + "#\n1,2,3,4,5,x,7\n", "line 3: column 6: found 'x'");
  expect(kHeader + "1,2,3,4,5,,7\n", "line 2: column 6: found ''");
  expect(kHeader + "1,2,3,4,nan,6,7\n", "line 2: column 5: found 'nan'");
  expect(kHeader + "91,2,3,4,5,6,7\n", "line 2: column 1: found 91");
  expect(kHeader + "1,2,-3,4,5,6,7\n", "line 2: column 3: found -3");
  expect(kHeader + "1,400,3,4,5,6,7\n", "line 2: column 2: found 400");
  expect(kHeader + "1,2,3,4,5,-6,7\n", "line 2: column 6: found -6");
  expect(std::string("\1\2\0\4", 4), "unknown format");
}

TEST(CsvBrdf, TruncationsWithinALineAreRefusedAndNoDamageCrashes) {
  const std::string text = kHeader + "10,20,30,40,0.5,0.25,0.125\n15,25,35,45,0.5,0.25,0.125\n";
  for (std::size_t size = 0; size < text.size(); ++size) {
    const bool whole_line = size > kHeader.size() && text[size - 1] == '\n';
    EXPECT_EQ(parse_error(text.substr(0, size)) == "", whole_line) << size;
  }
  std::mt19937 random(kSeed + 2);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed + 2);
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string damaged = text;
    damaged[random() % text.size()] = static_cast<char>(random());
    refused += parse_error(damaged) != "";
  }
  EXPECT_GT(refused, 2500);
}

TEST(MeasuredBrdf, FormatIsToldByContentNotByName) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.binary");
  write_bytes(path, kHeader + "10,20,30,40,0.5,0.25,0.125\n");
  EXPECT_EQ(read_measured_brdf(path).format, "CSV");
  const std::string missing = folder.file("gone.csv");
  EXPECT_NE(error_of(missing, [&] { read_measured_brdf(missing); }), "");
}

}  // namespace
}  // namespace burnish::test
