#include "tradeoff/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace burnish::tools {
namespace {

constexpr double kWidth = 760, kHeight = 470;
constexpr double kLeft = 66, kRight = 20, kTop = 38, kBottom = 52;
constexpr double kCharacterWidth = 6.1, kTextHeight = 12;  // of 11 px sans-serif, about

constexpr const char* kStyle = R"(<style>
.bp{--paper:#fff;--ink:#222;--soft:#666;--grid:#e4e4e4;--dot:#7b93b3;--front:#0b62c4;--preset:#0b62c4;--old:#8a5a00;--rival:#b3261e}
@media (prefers-color-scheme:dark){.bp{--paper:#16181c;--ink:#e8e8e8;--soft:#a0a4ab;--grid:#2c3036;--dot:#6f86a6;--front:#6fb1ff;--preset:#6fb1ff;--old:#e0b050;--rival:#ff8a80}}
.bp{font:11px sans-serif;background:var(--paper)}
.bp .paper{fill:var(--paper)}.bp text{fill:var(--ink)}.bp .soft{fill:var(--soft)}
.bp .title{font-size:14px;font-weight:bold}
.bp .grid{stroke:var(--grid)}.bp .axis{stroke:var(--soft);fill:none}
.bp .floor{stroke:var(--soft);stroke-dasharray:2 4}
.bp .front{stroke:var(--front);fill:none;stroke-width:1.6}
.bp .dot{fill:var(--dot)}.bp .best{fill:var(--front)}.bp .preset{fill:var(--preset);stroke:var(--ink)}
.bp .old{fill:var(--old)}.bp .rival{fill:var(--rival)}
.bp .t-old{fill:var(--old)}.bp .t-rival{fill:var(--rival)}.bp .t-preset{font-weight:bold}
</style>
)";

/// A logarithmic axis from data to pixels.
struct Axis {
  double low = 1, high = 10;   // of the data
  double first = 0, last = 1;  // pixels

  double place(double value) const {
    return first + (last - first) * std::log(value / low) / std::log(high / low);
  }
};

/// An axis around values, with a margin.
Axis axis_around(const std::vector<double>& values, double first, double last) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const double value : values) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high > 0)) low = high = 1;
  const double margin = std::max(std::pow(high / low, 0.06), 1.05);
  return {low / margin, high * margin, first, last};
}

/// 1, 2 and 5 times powers of ten, thinned where they would be many; at least two on any axis.
std::vector<double> ticks_of(const Axis& axis) {
  const double decades = std::log10(axis.high / axis.low);
  std::vector<double> steps = {1, 2, 5};
  if (decades > 3) steps = {1};
  if (decades < 0.7) steps = {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9};
  if (decades < 0.1) {
    steps.clear();
    for (int i = 0; i < 450; ++i) steps.push_back(1 + 0.02 * i);
  }
  std::vector<double> ticks;
  for (int power = static_cast<int>(std::floor(std::log10(axis.low)));
       power <= static_cast<int>(std::floor(std::log10(axis.high))); ++power)
    for (const double step : steps) {
      const double tick = step * std::pow(10.0, power);
      if (tick >= axis.low && tick <= axis.high) ticks.push_back(tick);
    }
  return ticks;
}

/// "200", "0.05", "12 M".
std::string tick_text(double value) {
  if (value >= 1e9 * 0.999) return fmt::format("{:g} G", value / 1e9);
  if (value >= 1e6 * 0.999) return fmt::format("{:g} M", value / 1e6);
  if (value >= 1e4 * 0.999) return fmt::format("{:g} k", value / 1e3);
  return fmt::format("{:.4g}", value);
}

struct Box {
  double left, top, right, bottom;
  double overlap(const Box& other) const {
    const double width = std::min(right, other.right) - std::max(left, other.left);
    const double height = std::min(bottom, other.bottom) - std::max(top, other.top);
    return width > 0 && height > 0 ? width * height : 0;
  }
};

/// Where labels and points are, so that the next label finds room.
class LabelPlaces {
 public:
  void block(const Box& box) { taken_.push_back(box); }

  /// The box of a label beside (x, y) that covers least; `covered` is how much.
  Box find(double x, double y, const std::string& label, double& covered) const {
    const double width = kCharacterWidth * static_cast<double>(label.size());
    constexpr std::array<std::array<double, 2>, 8> kSides = {
        {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, -1}, {1, 1}, {-1, 1}}};
    Box best{};
    covered = std::numeric_limits<double>::infinity();
    for (const double distance : {8.0, 16.0, 28.0})
      for (const auto& [dx, dy] : kSides) {
        const double cx = x + dx * (distance + width / 2);
        const double cy = y + dy * (distance + kTextHeight / 2);
        const Box box = {cx - width / 2, cy - kTextHeight / 2, cx + width / 2,
                         cy + kTextHeight / 2};
        if (box.left < kLeft || box.right > kWidth - 2 || box.top < kTop ||
            box.bottom > kHeight - kBottom)
          continue;
        double sum = 0.05 * distance;  // near is better
        for (const Box& other : taken_) sum += box.overlap(other);
        if (sum >= covered) continue;
        covered = sum;
        best = box;
      }
    return best;
  }

 private:
  std::vector<Box> taken_;
};

const char* text_class(PlotMark mark) {
  switch (mark) {
    case PlotMark::preset:
      return "t-preset";
    case PlotMark::paper:
      return "t-old";
    case PlotMark::rival:
      return "t-rival";
    case PlotMark::dot:
      break;
  }
  return "soft";
}

std::string mark_svg(const PlotPoint& point, double x, double y, bool on_front) {
  const std::string tip =
      fmt::format("<title>{}: {:.4g}, {:.4g}</title>", xml_escaped(point.label), point.x, point.y);
  switch (point.mark) {
    case PlotMark::preset:
      return fmt::format(
          "<circle class=\"preset\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5.5\">{}</circle>\n", x, y,
          tip);
    case PlotMark::paper:
      return fmt::format(
          "<rect class=\"old\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"9\" height=\"9\">{}</rect>\n",
          x - 4.5, y - 4.5, tip);
    case PlotMark::rival:
      return fmt::format(
          "<path class=\"rival\" d=\"M{:.1f} {:.1f}l5.5 5.5l-5.5 5.5l-5.5 -5.5z\">{}</path>\n", x,
          y - 5.5, tip);
    case PlotMark::dot:
      break;
  }
  return fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\">{}</circle>\n",
                     on_front ? "best" : "dot", x, y, on_front ? "3.5" : "2.8", tip);
}

std::string axes_svg(const Plot& plot, const Axis& across, const Axis& up) {
  std::string svg;
  for (const double tick : ticks_of(across)) {
    const double x = across.place(tick);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\"/>"
        "<text class=\"soft\" x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x, kTop, kHeight - kBottom, kHeight - kBottom + 16, tick_text(tick));
  }
  for (const double tick : ticks_of(up)) {
    const double y = up.place(tick);
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\"/>"
        "<text class=\"soft\" x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        y, kLeft, kWidth - kRight, kLeft - 6, y + 4, tick_text(tick));
  }
  if (plot.floor_y > up.low && plot.floor_y < up.high)
    svg +=
        fmt::format("<line class=\"floor\" x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\"/>\n",
                    up.place(plot.floor_y), kLeft, kWidth - kRight);
  svg += fmt::format("<path class=\"axis\" d=\"M{0} {1}V{2}H{3}\"/>\n", kLeft, kTop,
                     kHeight - kBottom, kWidth - kRight);
  svg += fmt::format("<text class=\"title\" x=\"{}\" y=\"22\">{}</text>\n", kLeft,
                     xml_escaped(plot.title));
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, kHeight - 14, xml_escaped(plot.x_label));
  svg += fmt::format(
      "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + kHeight - kBottom) / 2, xml_escaped(plot.y_label));
  return svg;
}

bool drawable(const PlotPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0 && point.y > 0;
}

std::string front_svg(const Plot& plot, const Axis& across, const Axis& up) {
  std::string path;
  for (const size_t i : plot.front) {
    const PlotPoint& point = plot.points[i];
    if (!drawable(point)) continue;
    const double x = across.place(point.x), y = up.place(point.y);
    // Until a dearer point errs less, the cheaper one is the best to have.
    path +=
        path.empty() ? fmt::format("M{:.1f} {:.1f}", x, y) : fmt::format("H{:.1f}V{:.1f}", x, y);
  }
  return path.empty() ? "" : fmt::format("<path class=\"front\" d=\"{}\"/>\n", path);
}

/// Labels: of what must have one, then of the front where there is room.
std::string labels_svg(const Plot& plot, const Axis& across, const Axis& up) {
  LabelPlaces places;
  for (const PlotPoint& point : plot.points) {
    if (!drawable(point)) continue;
    const double x = across.place(point.x), y = up.place(point.y);
    const double size = point.mark == PlotMark::dot ? 2 : 5;
    places.block({x - size, y - size, x + size, y + size});
  }
  std::string svg;
  const auto add = [&](const PlotPoint& point, double most_covered) {
    double covered = 0;
    const Box box = places.find(across.place(point.x), up.place(point.y), point.label, covered);
    if (!(covered <= most_covered) || point.label.empty()) return;
    places.block(box);
    svg +=
        fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                    text_class(point.mark), box.left, box.bottom - 2.5, xml_escaped(point.label));
  };
  for (const PlotPoint& point : plot.points)
    if (drawable(point) && point.mark != PlotMark::dot)
      add(point, std::numeric_limits<double>::max());
  for (const size_t i : plot.front)
    if (drawable(plot.points[i]) && plot.points[i].mark == PlotMark::dot) add(plot.points[i], 12);
  return svg;
}

}  // namespace

std::string xml_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
    }
  return escaped;
}

std::string plot_svg(const Plot& plot) {
  std::vector<double> xs, ys;
  for (const PlotPoint& point : plot.points) {
    if (!drawable(point)) continue;
    xs.push_back(point.x);
    ys.push_back(point.y);
  }
  const Axis across = axis_around(xs, kLeft, kWidth - kRight);
  const Axis up = axis_around(ys, kHeight - kBottom, kTop);
  std::string svg = fmt::format(
      "<svg class=\"bp\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" "
      "width=\"{0}\" height=\"{1}\" role=\"img\" aria-label=\"{2}\">\n",
      kWidth, kHeight, xml_escaped(plot.title));
  svg += kStyle;
  svg += fmt::format("<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n", kWidth, kHeight);
  svg += axes_svg(plot, across, up) + front_svg(plot, across, up);
  for (const bool large : {false, true})
    for (size_t i = 0; i < plot.points.size(); ++i) {
      const PlotPoint& point = plot.points[i];
      if (!drawable(point) || (point.mark != PlotMark::dot) != large) continue;
      const bool on_front = std::find(plot.front.begin(), plot.front.end(), i) != plot.front.end();
      svg += mark_svg(point, across.place(point.x), up.place(point.y), on_front);
    }
  return svg + labels_svg(plot, across, up) + "</svg>\n";
}

}  // namespace burnish::tools
