// Plots in SVG, for people: lines over an axis, and bars in groups.
//
// Functions of their arguments alone. Axes start at 0, ticks are round numbers; values that are not
// finite are left out.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace forewalk::service {

struct PlotSeries {
  std::string name;                ///< for the legend
  std::string colour;              ///< "#2f5fb3"
  std::vector<glm::dvec2> points;  ///< in ascending x
  bool dashed = false;
  bool marked = true;  ///< a dot at every point
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

}  // namespace forewalk::service
