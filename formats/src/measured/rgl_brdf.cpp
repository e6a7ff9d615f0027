// Based on: the adaptive parameterisation of isotropic and anisotropic BRDFs (dupuy2018adaptive;
// the files' use is that of the authors' brdf-loader):
//   f(i, o) cos(o) = max(c(u, i), 0) D(m) / (4 sigma(i)),   m = (i + o) / |i + o|,
// with u the place of m in the square after the warp by the density of normals visible from i. A
// direction's place in the square: x = sqrt(2 theta / pi), y = (phi + pi) / (2 pi).
//
// The loader calls the right side f, but the tables hold the cosine, too, as pbrt and Mitsuba take
// them: exchanging i and o changes the blue paper's f by 6 % with the cosine divided out, by 48 %
// without. As in these renderers, i is the viewer's direction and o the light's; it is `outgoing`
// here and `incoming`.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "measured/measured_formats.h"
#include "measured/spectrum_rgb.h"
#include "measured/tensor_file.h"
#include "measured/warp_table.h"

namespace burnish::detail {
namespace {

struct RglBrdf {
  std::vector<float> azimuths_rad, angles_rad;  ///< of the outgoing direction
  bool isotropic = false, scaled_by_distribution = true;
  int symmetry = 1;  ///< 2, 4: measured for a half or a quarter of the azimuths
  SquareTable distribution, area;
  WarpTable visible_normals;
  std::array<SquareTable, 3> color;
};

Vector2<double> place_of(double angle, double azimuth) {
  const double turn = (azimuth + kPi<double>) / (2 * kPi<double>);
  return {std::sqrt(2 / kPi<double> * angle), turn - std::floor(turn)};
}

double angle_of(const Vector3d& v) { return std::atan2(std::hypot(v.x(), v.y()), v.z()); }

Rgb eval(const RglBrdf& brdf, Vector3d outgoing, Vector3d incoming) {
  if (outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
  if (brdf.symmetry > 1) {  // to the measured part of the azimuths, -pi..-pi / 2 or 0
    const double sign_y = outgoing.y() > 0 ? -1 : 1;
    const double sign_x = brdf.symmetry == 4 ? (outgoing.x() > 0 ? -1 : 1) : sign_y;
    const Vector3d flip(sign_x, sign_y, 1);
    incoming = incoming.cwiseProduct(flip);
    outgoing = outgoing.cwiseProduct(flip);
  }
  const Vector3d half = (outgoing + incoming).normalized();
  const double angle = angle_of(outgoing), azimuth = std::atan2(outgoing.y(), outgoing.x());
  const double half_azimuth = std::atan2(half.y(), half.x());
  const Vector2<double> place =
      place_of(angle_of(half), brdf.isotropic ? half_azimuth - azimuth : half_azimuth);
  const SliceWeights slices =
      weigh_slices(weigh_nodes(brdf.azimuths_rad, azimuth), weigh_nodes(brdf.angles_rad, angle),
                   brdf.angles_rad.size());
  const Vector2<double> sample = brdf.visible_normals.invert(slices, place);
  double scale = 1 / incoming.z();
  if (brdf.scaled_by_distribution) {
    SliceWeights only;
    only.count = 1;
    only.weight[0] = 1;
    const double area = brdf.area.eval(only, brdf.area.cell(place_of(angle, azimuth)));
    scale *= brdf.distribution.eval(only, brdf.distribution.cell(place)) / (4 * area);
  }
  Rgb value;
  for (int c = 0; c < 3; ++c) {
    const SquareTable& table = brdf.color[static_cast<std::size_t>(c)];
    value[c] = static_cast<float>(scale * std::max(table.eval(slices, table.cell(sample)), 0.0));
  }
  return value;
}

class RglReader {
 public:
  RglReader(std::string_view bytes, const std::string& subject) : file_(bytes, subject) {}

  RglBrdf read() {
    RglBrdf brdf;
    brdf.azimuths_rad = nodes("phi_i", -kPi<double>, kPi<double>);
    brdf.angles_rad = nodes("theta_i", 0, kPi<double> / 2);
    brdf.isotropic = brdf.azimuths_rad.size() <= 2;
    if (!brdf.isotropic) brdf.symmetry = symmetry(brdf.azimuths_rad);
    slices_ = {brdf.azimuths_rad.size(), brdf.angles_rad.size()};
    const std::string_view flag = file_.text("jacobian");
    brdf.scaled_by_distribution = flag[0] != 0;
    brdf.distribution = table("ndf", {}, 0);
    brdf.area = table("sigma", {}, 1e-20);
    brdf.visible_normals = WarpTable(table("vndf", slices_, 0));
    brdf.color = file_.has("rgb") ? split_rgb() : convert_spectra();
    return brdf;
  }

  std::string description() const {
    if (!file_.has("description")) return "";
    std::string text(file_.text("description"));
    for (char& c : text)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
  }

 private:
  using Shape = std::vector<std::uint64_t>;

  std::vector<float> nodes(const std::string& name, double low, double high) const {
    constexpr double kRounding = 1e-5;
    std::vector<float> values = file_.numbers(name, 1);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double least = i == 0 ? low - kRounding : double(values[i - 1]);
      if (!(values[i] >= least && (i == 0 || values[i] > least) && values[i] <= high + kRounding))
        file_.fail(name,
                   fmt::format("element {} is {}, expected rising angles within {:.5g}..{:.5g}", i,
                               values[i], low, high));
    }
    return values;
  }

  /// Over how many equal parts of the circle a measurement repeats.
  int symmetry(const std::vector<float>& azimuths) const {
    const double range = double(azimuths.back()) - double(azimuths.front());
    const double parts = 2 * kPi<double> / range;
    for (const int count : {1, 2, 4})
      if (std::abs(parts - count) < 0.05 * count) {
        constexpr double kRounding = 1e-3;
        if (std::abs(double(azimuths.front()) + kPi<double>) > kRounding)
          file_.fail("phi_i", fmt::format("the first azimuth is {:.4g} radians, expected -pi",
                                          azimuths.front()));
        return count;
      }
    file_.fail("phi_i", fmt::format("azimuths over {:.4g} radians, expected the circle, its half "
                                    "or its quarter",
                                    range));
  }

  /// Checks that a field's shape is `leading`, then two or more rows and columns, and its values.
  SquareTable table(const std::string& name, const Shape& leading, double least) const {
    SquareTable result;
    result.values = file_.numbers(name, leading.size() + 2);
    const Shape& shape = file_.shape(name);
    result.rows = shape[leading.size()];
    result.columns = shape[leading.size() + 1];
    if (!std::equal(leading.begin(), leading.end(), shape.begin()) || result.rows < 2 ||
        result.columns < 2)
      file_.fail(name,
                 fmt::format("shape {}, expected {}{}two or more x two or more", shape_text(shape),
                             fmt::join(leading, " x "), leading.empty() ? "" : " x "));
    for (std::size_t i = 0; i < result.values.size(); ++i)
      if (!(result.values[i] >= least))
        file_.fail(name, fmt::format("element {} is {}, expected {:g} or more", i, result.values[i],
                                     least));
    return result;
  }

  /// [slices x channels x rows x columns] as a table a weight: sums of channels.
  std::array<SquareTable, 3> mix(const std::string& name, const std::vector<Rgb>& weights) const {
    Shape leading = slices_;
    leading.push_back(weights.size());
    const SquareTable all = table(name, leading, -1e30);
    const std::size_t size = all.rows * all.columns, slices = slices_[0] * slices_[1];
    std::array<SquareTable, 3> color;
    for (int c = 0; c < 3; ++c) {
      SquareTable& out = color[static_cast<std::size_t>(c)];
      out = {all.rows, all.columns, std::vector<float>(slices * size)};
      for (std::size_t slice = 0; slice < slices; ++slice)
        for (std::size_t k = 0; k < weights.size(); ++k) {
          if (weights[k][c] == 0) continue;
          const float* from = all.values.data() + (slice * weights.size() + k) * size;
          float* to = out.values.data() + slice * size;
          for (std::size_t i = 0; i < size; ++i) to[i] += weights[k][c] * from[i];
        }
    }
    return color;
  }

  std::array<SquareTable, 3> split_rgb() const {
    return mix("rgb", {Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 1)});
  }

  std::array<SquareTable, 3> convert_spectra() const {
    if (!file_.has("spectra"))
      file_.fail("rgb", "is missing, expected it or 'spectra' in a measured BRDF");
    const std::vector<float> wavelengths = nodes("wavelengths", 100, 1e5);
    const std::vector<Rgb> weights = rgb_weights(wavelengths);
    if (std::all_of(weights.begin(), weights.end(), [](const Rgb& w) { return (w == 0).all(); }))
      file_.fail("wavelengths", fmt::format("{:g}..{:g} nm, expected to cover the visible part",
                                            wavelengths.front(), wavelengths.back()));
    return mix("spectra", weights);
  }

  TensorFile file_;
  Shape slices_;
};

TabulatedDistribution tabulated(const SquareTable& table) {
  return {static_cast<int>(table.rows), static_cast<int>(table.columns), table.values};
}

}  // namespace

MeasuredBrdf parse_rgl_brdf(std::string_view bytes, const std::string& subject) {
  RglReader reader(bytes, subject);
  const auto table = std::make_shared<const RglBrdf>(reader.read());
  MeasuredBrdf brdf;
  brdf.format = "RGL tensor";
  brdf.description = reader.description();
  brdf.isotropic = table->isotropic;
  // The last node, at the horizon, cannot be measured: it is extrapolated.
  const std::vector<float>& angles = table->angles_rad;
  const bool ends_at_horizon = angles.back() > kPi<float> / 2 - 1e-3f && angles.size() > 1;
  brdf.max_angle_rad = angles[angles.size() - (ends_at_horizon ? 2 : 1)];
  brdf.distribution = tabulated(table->distribution);
  brdf.eval = [table](const Vector3f& outgoing, const Vector3f& incoming) {
    return eval(*table, outgoing.cast<double>(), incoming.cast<double>());
  };
  return brdf;
}

}  // namespace burnish::detail
