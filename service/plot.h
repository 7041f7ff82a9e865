// Plots in SVG, for people: lines over an axis, and bars in groups.
//
// Functions of their arguments alone. Axes start at 0, ticks are round numbers; values that are not
// finite are left out.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace forewalk::service {

struct PlotSeries {
  std::string name;                ///< for the legend
  std::string colour;              ///< "#2f5fb3"
  std::vector<glm::dvec2> points;  ///< in ascending x
  bool dashed = false;
  bool marked = true;           ///< a dot at every point
  std::vector<double> reach{};  ///< a bar of so much up and down at every point; may be empty
};

struct LinePlot {
  std::string title;
  std::string subtitle;
  std::string xName;  ///< with its unit: "horizon, m"
  std::string yName;
  std::vector<PlotSeries> series;
  std::vector<std::string> notes;  ///< lines of small text under the plot
};

/// At most a dozen series are told apart by eye; there is no limit.
std::string toSvg(const LinePlot& plot);

struct BarGroup {
  std::string name;
  std::vector<double> values;  ///< one per bar name, >= 0
};

struct BarPlot {
  std::string title;
  std::string subtitle;
  std::string yName;
  std::vector<std::string> barNames;  ///< for the legend
  std::vector<std::string> colours;   ///< one per bar name
  std::vector<BarGroup> groups;
  std::vector<std::string> notes;
};

std::string toSvg(const BarPlot& plot);

struct BoxGroup {
  std::string name;
  std::vector<std::vector<double>> samples;  ///< one per box name; an empty one leaves a gap
};

/// Boxes from the lower to the upper quartile with the median, whiskers to the last value
/// within 1.5 times that range (Tukey 1977), dots for what lies beyond, a diamond for the mean.
struct BoxPlot {
  std::string title;
  std::string subtitle;
  std::string yName;
  std::vector<std::string> boxNames;  ///< for the legend
  std::vector<std::string> colours;   ///< one per box name
  std::vector<BoxGroup> groups;
  std::vector<std::string> notes;
};

/// Quartiles lie between values where they have to (Hyndman and Fan 1996, type 7).
std::string toSvg(const BoxPlot& plot);

/// The colour of the i-th thing that is compared, told apart by most people who see colours
/// otherwise (after Okabe and Ito 2008); begins again after eight.
std::string_view seriesColour(std::size_t i);

}  // namespace forewalk::service
