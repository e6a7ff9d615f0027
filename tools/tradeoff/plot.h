#pragma once

#include <string>
#include <vector>

namespace burnish::tools {

/// How a point of a plot is drawn.
enum class PlotMark {
  dot,     ///< small: one of many
  preset,  ///< a large disc, always labelled
  paper,   ///< a square, always labelled
  rival,   ///< a diamond, always labelled
};

/// A point in the plot's own units, both above 0.
struct PlotPoint {
  double x = 1;
  double y = 1;
  std::string label;  ///< beside the point where there is room, and as its tool tip
  PlotMark mark = PlotMark::dot;
};

/// A scatter plot with a front through some of its points.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotPoint> points;
  std::vector<size_t>
      front;           ///< indices by rising x, joined by steps and labelled where there is room
  double floor_y = 0;  ///< a line below which y means nothing (a noise); 0: none
};

/// The plot as an SVG document on logarithmic axes, light or dark as the reader's system prefers.
/// It starts with <svg, so that it can stand in HTML as it is. Points that are not above 0 in both
/// are left out; labels are moved about so that they cover little of each other.
std::string plot_svg(const Plot& plot);

/// Text with &, <, > and quotes escaped, and control characters as blanks, for XML and HTML.
std::string xml_escaped(const std::string& text);

}  // namespace burnish::tools
