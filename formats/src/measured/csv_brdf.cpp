#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "measured/measured_formats.h"
#include "measured/sample_tree.h"
#include "mesh/mesh_text.h"

namespace burnish::detail {
namespace {

constexpr std::string_view kHeader = "theta_i,phi_i,theta_o,phi_o,r,g,b";
constexpr std::size_t kColumns = 7;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& subject)
      : text_(text), lines_(text), subject_(subject) {}

  MeasuredBrdf read() {
    // Without it, a file cut within its last number would read as another number.
    if (!text_.ends_with('\n')) {
      fail(line_at(text_, text_.size()), "the file ends within a line, expected a line end");
    }
    expect_header();
    MeasuredBrdf brdf;
    for (std::string_view line; next_line(line);) brdf.samples.push_back(parse_sample(line));
    if (brdf.samples.empty()) fail(lines_.number(), "found no samples, expected one or more");
    brdf.format = "CSV";
    brdf.description = description_;
    brdf.max_angle_rad = static_cast<float>(max_angle_rad_);
    return brdf;
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& message) const {
    throw Error(ErrorKind::input, subject_, fmt::format("line {}: {}", line, message));
  }

  /// The next line that is neither empty nor a comment; the first comment is the description.
  bool next_line(std::string_view& line) {
    while (lines_.next(line)) {
      line = trimmed(line);
      if (line.empty()) continue;
      if (line.front() != '#') return true;
      if (description_.empty()) {
        description_ = trimmed(line.substr(1));
        for (char& c : description_)
          if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
      }
    }
    return false;
  }

  void expect_header() {
    std::string_view line;
    std::string found;
    if (next_line(line))
      for (const char c : line)
        if (c != ' ' && c != '\t') found += c;
    if (found != kHeader)
      fail(lines_.number(),
           fmt::format("found {}, expected the columns '{}'", quoted(line), kHeader));
  }

  std::array<double, kColumns> parse_numbers(std::string_view line) const {
    std::array<double, kColumns> numbers = {};
    for (std::size_t column = 0; column < kColumns; ++column) {
      const std::size_t comma = line.find(',');
      if ((comma == std::string_view::npos) != (column + 1 == kColumns))
        fail(lines_.number(),
             fmt::format("found {} columns, expected {}",
                         column + 1 + size_t(std::count(line.begin(), line.end(), ',')), kColumns));
      const std::string_view word = trimmed(line.substr(0, comma));
      if (!parse_double(word, numbers[column]) || !std::isfinite(numbers[column]))
        fail(lines_.number(), fmt::format("column {}: found {}, expected a finite number",
                                          column + 1, quoted(word)));
      line.remove_prefix(
          std::min(line.size(), comma == std::string_view::npos ? line.size() : comma + 1));
    }
    return numbers;
  }

  double in_range(double value, double low, double high, int column) const {
    if (!(value >= low && value <= high))
      fail(lines_.number(),
           fmt::format("column {}: found {}, expected {}..{}", column, value, low, high));
    return value;
  }

  Vector3f direction(const std::array<double, kColumns>& numbers, std::size_t column) {
    constexpr double kDegree = kPi<double> / 180;
    const int place = static_cast<int>(column) + 1;
    const double angle = kDegree * in_range(numbers[column], 0, 90, place);
    const double azimuth = kDegree * in_range(numbers[column + 1], -360, 360, place + 1);
    max_angle_rad_ = std::max(max_angle_rad_, angle);
    return Vector3d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                    std::cos(angle))
        .cast<float>();
  }

  BrdfSample parse_sample(std::string_view line) {
    const std::array<double, kColumns> numbers = parse_numbers(line);
    BrdfSample sample;
    sample.incoming = direction(numbers, 0);
    sample.outgoing = direction(numbers, 2);
    for (int c = 0; c < 3; ++c)
      sample.value[c] =
          static_cast<float>(in_range(numbers[static_cast<std::size_t>(4 + c)], 0, 1e30, 5 + c));
    return sample;
  }

  std::string_view text_;
  LineReader lines_;
  const std::string& subject_;
  std::string description_;
  double max_angle_rad_ = 0;
};

}  // namespace

MeasuredBrdf parse_csv_brdf(std::string_view bytes, const std::string& subject) {
  const std::string text = decode_text(std::string(bytes));
  MeasuredBrdf brdf = CsvReader(text, subject).read();
  const auto tree = std::make_shared<const SampleTree>(brdf.samples);
  const float least_cosine = std::cos(std::min(brdf.max_angle_rad + 1e-4f, kPi<float> / 2));
  brdf.eval = [tree, least_cosine](const Vector3f& outgoing, const Vector3f& incoming) -> Rgb {
    const float cosine = std::min(outgoing.z(), incoming.z());
    if (cosine <= 0) return Rgb::Zero();
    if (cosine < least_cosine) return Rgb::Constant(std::numeric_limits<float>::quiet_NaN());
    return tree->eval(outgoing.cast<double>(), incoming.cast<double>());
  };
  return brdf;
}

}  // namespace burnish::detail
