#include "tradeoff/plot.h"

#include <limits>
#include <random>
#include <regex>

#include <gtest/gtest.h>

#include "tradeoff/well_formed.h"

namespace burnish::tools {
namespace {

/// The numbers that a pattern with one group finds.
std::vector<double> numbers(const std::string& text, const std::string& pattern) {
  std::vector<double> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator i(text.begin(), text.end(), expression), end; i != end; ++i)
    found.push_back(std::stod((*i)[1]));
  return found;
}

Plot some_plot() {
  Plot plot;
  plot.title = "dish & <balls>";
  plot.x_label = "frame time, ms";
  plot.y_label = "error, %";
  plot.points = {{.5, 30, "terms 4", PlotMark::dot},
                 {1, 12, "balanced", PlotMark::preset},
                 {2, 5, "\"best\"", PlotMark::dot},
                 {.8, 40, "paper's", PlotMark::paper},
                 {200, 9, "SH, order 5", PlotMark::rival}};
  plot.front = {0, 1, 2};
  return plot;
}

TEST(XmlFault, FindsWhatIsNotWellFormed) {
  EXPECT_EQ(test::xml_fault("<a b=\"1\"><c/>x &amp; y</a>"), "");
  for (const char* bad :
       {"", "<a>", "<a></b>", "<a b=1/>", "<a>&</a>", "<a/><b/>", "<a b=\"<\"/>", "<a>&nbsp;</a>"})
    EXPECT_NE(test::xml_fault(bad), "") << bad;
}

TEST(PlotSvg, IsWellFormedWhateverTheNames) {
  EXPECT_EQ(test::xml_fault(plot_svg(some_plot())), "");
}

TEST(PlotSvg, DrawsEveryPointBetweenItsAxes) {
  const unsigned seed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::lognormal_distribution<double> spread(0, 4);  // twelve decades and more
  Plot plot;
  for (int i = 0; i < 200; ++i) plot.points.push_back({spread(random), spread(random), "p"});
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(test::xml_fault(svg), "");
  // The axes' corner, and how far they go: "M66 38V418H740".
  const double left = numbers(svg, "class=\"axis\" d=\"M([0-9.]+) ").at(0);
  const double top = numbers(svg, "class=\"axis\" d=\"M[0-9.]+ ([0-9.]+)V").at(0);
  const double bottom = numbers(svg, "class=\"axis\" d=\"M[^V]*V([0-9.]+)H").at(0);
  const double right = numbers(svg, "class=\"axis\" d=\"M[^H]*H([0-9.]+)\"").at(0);
  const std::vector<double> xs = numbers(svg, "cx=\"(-?[0-9.]+)\"");
  const std::vector<double> ys = numbers(svg, "cy=\"(-?[0-9.]+)\"");
  ASSERT_EQ(xs.size(), plot.points.size());
  ASSERT_EQ(ys.size(), plot.points.size());
  for (size_t i = 0; i < xs.size(); ++i) {
    EXPECT_GT(xs[i], left);
    EXPECT_LT(xs[i], right);
    EXPECT_GT(ys[i], top);
    EXPECT_LT(ys[i], bottom);
  }
}

TEST(PlotSvg, PlacesPointsByTheirLogarithms) {
  Plot plot;
  plot.points = {{1, 1, "a"}, {10, 10, "b"}, {100, 1000, "c"}};
  const std::string svg = plot_svg(plot);
  const std::vector<double> xs = numbers(svg, "cx=\"([0-9.]+)\"");
  const std::vector<double> ys = numbers(svg, "cy=\"([0-9.]+)\"");
  ASSERT_EQ(xs.size(), 3u);
  // Within the tenth of a pixel that is written.
  EXPECT_NEAR(xs[1] - xs[0], xs[2] - xs[1], 0.15);
  EXPECT_NEAR(2 * (ys[0] - ys[1]), ys[1] - ys[2], 0.25);
  EXPECT_GT(ys[0], ys[1]);  // more is up
}

TEST(PlotSvg, LeavesOutWhatALogarithmicAxisCannotShow) {
  Plot plot = some_plot();
  plot.points.push_back({0, 1, "none", PlotMark::rival});
  plot.points.push_back({1, std::numeric_limits<double>::infinity(), "endless", PlotMark::rival});
  plot.front.push_back(5);
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(test::xml_fault(svg), "");
  EXPECT_EQ(svg.find("none:"), std::string::npos);
  EXPECT_EQ(svg.find("endless"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(test::xml_fault(plot_svg({})), "");
}

TEST(PlotSvg, NamesPresetsRivalsAndTheFront) {
  const std::string svg = plot_svg(some_plot());
  for (const char* label : {">balanced<", ">paper&#39;s<", ">SH, order 5<", ">terms 4<",
                            ">&quot;best&quot;<", ">frame time, ms<", "dish &amp; &lt;balls&gt;"})
    EXPECT_NE(svg.find(label), std::string::npos) << label;
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
}

}  // namespace
}  // namespace burnish::tools
