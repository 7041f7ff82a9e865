#include "service/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::service {
namespace {

using prediction::Anchor;
using prediction::SvgDrawing;
using prediction::svgNumber;

constexpr double kWidth = 860, kLeft = 78, kRight = 36, kTop = 118, kPlotHeight = 360;
constexpr std::string_view kGrid = "stroke=\"#e3e6e9\" stroke-width=\"1\"";
constexpr std::string_view kAxis = "stroke=\"#5a6675\" stroke-width=\"1.2\"";
constexpr std::string_view kSmall = "fill=\"#5a6675\"";

// From values to the page. Both axes start at 0 and end at a tick.
struct Axes {
  double xEnd, yEnd, xStep, yStep;

  glm::dvec2 at(glm::dvec2 value) const {
    return {kLeft + value.x / xEnd * (kWidth - kLeft - kRight),
            kTop + kPlotHeight * (1.0 - value.y / yEnd)};
  }
};

double endOf(double largest, double step) {
  return std::max(step, std::ceil(largest / step - 1e-9) * step);
}

Axes axesFor(double largestX, double largestY) {
  const auto sound = [](double value) { return std::isfinite(value) && value > 0 ? value : 1.0; };
  const double xStep = prediction::roundStep(sound(largestX) / 10);
  const double yStep = prediction::roundStep(sound(largestY) / 7);
  return {endOf(sound(largestX), xStep), endOf(sound(largestY) * 1.03, yStep), xStep, yStep};
}

double pageHeight(std::size_t notes) {
  return kTop + kPlotHeight + 62 + 18 * static_cast<double>(notes);
}

void drawFrame(SvgDrawing& drawing, const Axes& axes, const std::string& title,
               const std::string& subtitle, const std::string& yName,
               const std::vector<std::string>& notes) {
  drawing.title(title);
  drawing.text({kLeft, 38}, title, 22, Anchor::kStart, "fill=\"#1d2733\" font-weight=\"bold\"");
  drawing.text({kLeft, 60}, subtitle, 13, Anchor::kStart, kSmall);
  drawing.text({kLeft, kTop - 12}, yName, 12, Anchor::kStart, kSmall);
  for (double y = 0; y <= axes.yEnd * (1 + 1e-9); y += axes.yStep) {
    const glm::dvec2 at = axes.at({0, y});
    drawing.line(at, {kWidth - kRight, at.y}, y == 0 ? kAxis : kGrid);
    drawing.text(at + glm::dvec2(-8, 4), svgNumber(y), 12, Anchor::kEnd, kSmall);
  }
  double line = kTop + kPlotHeight + 66;
  for (const std::string& note : notes) {
    drawing.text({kLeft, line}, note, 12, Anchor::kStart, kSmall);
    line += 18;
  }
}

// A row of signs and names above the plot.
template <typename Sign>
void drawLegend(SvgDrawing& drawing, const std::vector<std::string>& names, Sign&& sign) {
  double x = kLeft;
  double y = 82;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double width = 32 + prediction::textWidth(names[i]) * 12.5;
    if (x > kLeft && x + width > kWidth - kRight) {  // a second line, as small as it has to be
      x = kLeft;
      y += 16;
    }
    sign(i, glm::dvec2(x, y));
    drawing.text({x + 32, y + 4}, names[i], 12.5, Anchor::kStart);
    x += width + 22;
  }
}

}  // namespace

std::string toSvg(const LinePlot& plot) {
  glm::dvec2 largest{0};
  for (const PlotSeries& series : plot.series) {
    for (const glm::dvec2 point : series.points) {
      if (std::isfinite(point.x) && std::isfinite(point.y)) largest = glm::max(largest, point);
    }
    for (std::size_t i = 0; i < std::min(series.reach.size(), series.points.size()); ++i) {
      const double top = series.points[i].y + series.reach[i];
      if (std::isfinite(top)) largest.y = std::max(largest.y, top);
    }
  }
  const Axes axes = axesFor(largest.x, largest.y);
  SvgDrawing drawing(kWidth, pageHeight(plot.notes.size()), "#fdfcfa");
  drawFrame(drawing, axes, plot.title, plot.subtitle, plot.yName, plot.notes);
  for (double x = 0; x <= axes.xEnd * (1 + 1e-9); x += axes.xStep) {
    const glm::dvec2 at = axes.at({x, 0});
    drawing.line(at, at + glm::dvec2(0, 5), kAxis);
    drawing.text(at + glm::dvec2(0, 20), svgNumber(x), 12, Anchor::kMiddle, kSmall);
  }
  drawing.text({0.5 * (kLeft + kWidth - kRight), kTop + kPlotHeight + 40}, plot.xName, 12.5,
               Anchor::kMiddle, kSmall);

  const auto strokeOf = [](const PlotSeries& series) {
    return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2.2\"{}",
                       prediction::escapeXml(series.colour),
                       series.dashed ? " stroke-dasharray=\"3 6\"" : "");
  };
  const auto dotOf = [](const PlotSeries& series) {
    return fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.2\"",
                       prediction::escapeXml(series.colour));
  };
  std::vector<std::string> names;
  for (const PlotSeries& series : plot.series) {
    std::vector<glm::dvec2> points;
    for (const glm::dvec2 point : series.points) {
      if (std::isfinite(point.x) && std::isfinite(point.y)) points.push_back(axes.at(point));
    }
    drawing.polyline(points, false, strokeOf(series));
    for (std::size_t i = 0; i < std::min(series.reach.size(), series.points.size()); ++i) {
      const glm::dvec2 point = series.points[i];
      const double reach = series.reach[i];
      if (!std::isfinite(point.x + point.y + reach)) continue;
      drawing.line(axes.at({point.x, std::max(0.0, point.y - reach)}),
                   axes.at({point.x, point.y + reach}), strokeOf(series));
    }
    if (series.marked) {
      for (const glm::dvec2 point : points) drawing.circle(point, 4, dotOf(series));
    }
    names.push_back(series.name);
  }
  drawLegend(drawing, names, [&](std::size_t i, glm::dvec2 at) {
    const PlotSeries& series = plot.series[i];
    drawing.line(at, at + glm::dvec2(24, 0), strokeOf(series));
    if (series.marked) drawing.circle(at + glm::dvec2(12, 0), 4, dotOf(series));
  });
  return drawing.finish();
}

std::string toSvg(const BarPlot& plot) {
  double largest = 0;
  for (const BarGroup& group : plot.groups) {
    for (const double value : group.values) {
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  const Axes axes = axesFor(1.0, largest);
  SvgDrawing drawing(kWidth, pageHeight(plot.notes.size()) - 16, "#fdfcfa");
  drawFrame(drawing, axes, plot.title, plot.subtitle, plot.yName, plot.notes);
  const auto styleOf = [&](std::size_t bar) {
    return fmt::format("fill=\"{}\"", bar < plot.colours.size()
                                          ? prediction::escapeXml(plot.colours[bar])
                                          : "#5a6675");
  };
  const double groupWidth =
      (kWidth - kLeft - kRight) / std::max<double>(1.0, static_cast<double>(plot.groups.size()));
  const double barWidth = std::min(
      70.0, 0.8 * groupWidth / std::max<double>(1.0, static_cast<double>(plot.barNames.size())));
  const double bottom = axes.at({0, 0}).y;
  for (std::size_t g = 0; g < plot.groups.size(); ++g) {
    const BarGroup& group = plot.groups[g];
    const double middle = kLeft + (static_cast<double>(g) + 0.5) * groupWidth;
    const double left = middle - 0.5 * barWidth * static_cast<double>(group.values.size());
    for (std::size_t bar = 0; bar < group.values.size(); ++bar) {
      const double value = group.values[bar];
      if (!std::isfinite(value)) continue;
      const double top = axes.at({0, std::max(value, 0.0)}).y;
      const double x = left + static_cast<double>(bar) * barWidth;
      drawing.rectangle({x + 2, top}, {barWidth - 4, bottom - top}, styleOf(bar));
      drawing.text({x + 0.5 * barWidth, top - 5}, fmt::format("{:.3g}", value), 11.5,
                   Anchor::kMiddle, kSmall);
    }
    drawing.text({middle, bottom + 20}, group.name, 13, Anchor::kMiddle);
  }
  drawLegend(drawing, plot.barNames, [&](std::size_t i, glm::dvec2 at) {
    drawing.rectangle(at + glm::dvec2(8, -6), {14, 12}, styleOf(i));
  });
  return drawing.finish();
}

std::string toSvg(const BoxPlot& plot) {
  double largest = 0;
  std::size_t boxes = 1;
  for (const BoxGroup& group : plot.groups) {
    boxes = std::max(boxes, group.samples.size());
    for (const auto& sample : group.samples) {
      for (const double value : sample) {
        if (std::isfinite(value)) largest = std::max(largest, value);
      }
    }
  }
  const Axes axes = axesFor(1.0, largest);
  SvgDrawing drawing(kWidth, pageHeight(plot.notes.size()) - 16, "#fdfcfa");
  drawFrame(drawing, axes, plot.title, plot.subtitle, plot.yName, plot.notes);
  const double groupWidth =
      (kWidth - kLeft - kRight) / std::max<double>(1.0, static_cast<double>(plot.groups.size()));
  const double slot = std::min(60.0, 0.86 * groupWidth / static_cast<double>(boxes));
  const double half = std::min(16.0, 0.36 * slot);
  const double bottom = axes.at({0, 0}).y;
  const auto colourOf = [&](std::size_t box) {
    return box < plot.colours.size() ? prediction::escapeXml(plot.colours[box])
                                     : std::string("#5a6675");
  };
  const auto drawBox = [&](double x, std::size_t box, std::vector<double> values) {
    values.erase(std::remove_if(values.begin(), values.end(),
                                [](double value) { return !std::isfinite(value); }),
                 values.end());
    if (values.empty()) return;
    std::sort(values.begin(), values.end());
    const auto quartile = [&](double share) {
      const double place = share * static_cast<double>(values.size() - 1);
      const auto below = static_cast<std::size_t>(place);
      const std::size_t above = std::min(below + 1, values.size() - 1);
      return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
    };
    const double low = quartile(0.25), high = quartile(0.75), reach = 1.5 * (high - low);
    const double first = *std::lower_bound(values.begin(), values.end(), low - reach);
    const double last = *(std::upper_bound(values.begin(), values.end(), high + reach) - 1);
    double sum = 0.0;
    for (const double value : values) sum += value;
    const std::string stroke = fmt::format("stroke=\"{}\" stroke-width=\"1.6\"", colourOf(box));
    const auto y = [&](double value) { return axes.at({0, value}).y; };
    drawing.line({x, y(first)}, {x, y(last)}, stroke);
    drawing.rectangle({x - half, y(high)}, {2 * half, std::max(1.0, y(low) - y(high))},
                      fmt::format("fill=\"#ffffff\" {}", stroke));
    drawing.rectangle({x - half, y(high)}, {2 * half, std::max(1.0, y(low) - y(high))},
                      fmt::format("fill=\"{}\" fill-opacity=\"0.28\" {}", colourOf(box), stroke));
    drawing.line({x - half, y(quartile(0.5))}, {x + half, y(quartile(0.5))},
                 fmt::format("stroke=\"{}\" stroke-width=\"3\"", colourOf(box)));
    for (const double value : values) {
      if (value < first || value > last) {
        drawing.circle({x, y(value)}, 2.2, fmt::format("fill=\"none\" {}", stroke));
      }
    }
    const glm::dvec2 mean(x, y(sum / static_cast<double>(values.size())));
    const glm::dvec2 diamond[] = {mean + glm::dvec2(0, -4), mean + glm::dvec2(4, 0),
                                  mean + glm::dvec2(0, 4), mean + glm::dvec2(-4, 0)};
    drawing.polyline(diamond, true, "fill=\"#ffffff\" stroke=\"#1d2733\" stroke-width=\"1.2\"");
  };
  for (std::size_t g = 0; g < plot.groups.size(); ++g) {
    const BoxGroup& group = plot.groups[g];
    const double middle = kLeft + (static_cast<double>(g) + 0.5) * groupWidth;
    const double left = middle - 0.5 * slot * static_cast<double>(group.samples.size());
    for (std::size_t box = 0; box < group.samples.size(); ++box) {
      drawBox(left + (static_cast<double>(box) + 0.5) * slot, box, group.samples[box]);
    }
    drawing.text({middle, bottom + 20}, group.name, 13, Anchor::kMiddle);
  }
  drawLegend(drawing, plot.boxNames, [&](std::size_t i, glm::dvec2 at) {
    drawing.rectangle(
        at + glm::dvec2(8, -6), {14, 12},
        fmt::format("fill=\"{0}\" fill-opacity=\"0.28\" stroke=\"{0}\"", colourOf(i)));
  });
  return drawing.finish();
}

std::string_view seriesColour(std::size_t i) {
  constexpr std::string_view kColours[] = {"#5a6675", "#2f5fb3", "#d9742b", "#1f9c74",
                                           "#b0478f", "#b8960c", "#4aa8d8", "#c23b3b"};
  return kColours[i % std::size(kColours)];
}

}  // namespace forewalk::service
