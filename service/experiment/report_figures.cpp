// Figures of a report: boxes, lines, heat maps and walks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>

#include "prediction/svg.h"
#include "rdw/tracked_space.h"
#include "service/experiment/report.h"
#include "service/files.h"
#include "service/plot.h"

namespace forewalk::service {
namespace {

using prediction::Anchor;
using prediction::SvgDrawing;

const std::vector<Choice>& listOf(const Results& results, Axis axis) {
  return results.plan.choices[static_cast<std::size_t>(axis)];
}

Selection cellOf(const Block& block, std::size_t room, std::size_t controller) {
  return block.selection.with(Axis::kRoom, room).with(Axis::kController, controller);
}

std::string subtitleOf(const Results& results, const Block& block) {
  std::string words = results.plan.name;
  if (!block.title.empty()) words += words.empty() ? block.title : ": " + block.title;
  return words;
}

std::vector<std::string> namesOf(const std::vector<Choice>& choices) {
  std::vector<std::string> names;
  for (const Choice& choice : choices) names.push_back(choice.name);
  return names;
}

std::vector<std::string> coloursOf(const std::vector<Choice>& choices) {
  std::vector<std::string> colours;
  for (std::size_t i = 0; i < choices.size(); ++i) colours.emplace_back(seriesColour(i));
  return colours;
}

/// "0.123" or an empty cell.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    out += c;
    if (c == '"') out += c;
  }
  return out + '"';
}

Figure boxFigure(const Results& results, const Block& block, std::size_t number) {
  const auto& rooms = listOf(results, Axis::kRoom);
  const auto& controllers = listOf(results, Axis::kController);
  BoxPlot plot;
  plot.title = "Resets";
  plot.subtitle = subtitleOf(results, block);
  plot.yName = "resets per 100 m";
  plot.boxNames = namesOf(controllers);
  plot.colours = coloursOf(controllers);
  Figure figure;
  figure.csv = "room,controller,resets_per_100_m\n";
  for (std::size_t r = 0; r < rooms.size(); ++r) {
    BoxGroup& group = plot.groups.emplace_back(BoxGroup{rooms[r].name, {}});
    for (std::size_t c = 0; c < controllers.size(); ++c) {
      group.samples.push_back(valuesOf(results, cellOf(block, r, c), Metric::kResetsPer100Metres));
      for (const double value : group.samples.back()) {
        figure.csv += fmt::format("{},{},{}\n", quoted(rooms[r].name), quoted(controllers[c].name),
                                  cell(value));
      }
    }
  }
  figure.file = fmt::format("resets_{}", number);
  figure.caption =
      "Resets per 100 m of virtual way. Boxes hold the middle half of the walks, "
      "diamonds are means.";
  figure.svg = toSvg(plot);
  return figure;
}

/// Resets against the size of the room; nothing where all rooms are of one size.
std::vector<Figure> sizeFigure(const Results& results, const Block& block, std::size_t number) {
  const auto& rooms = listOf(results, Axis::kRoom);
  const auto& controllers = listOf(results, Axis::kController);
  std::map<double, std::vector<std::size_t>> bySide;
  for (std::size_t r = 0; r < rooms.size(); ++r) {
    const auto areas = valuesOf(results, block.selection.with(Axis::kRoom, r), Metric::kRoomArea);
    if (!areas.empty()) bySide[std::sqrt(areas.front())].push_back(r);
  }
  if (bySide.size() < 2) return {};
  LinePlot plot;
  plot.title = "Resets against the size of the room";
  plot.subtitle = subtitleOf(results, block);
  plot.xName = "side of a square of the room's area, m";
  plot.yName = "resets per 100 m, mean and 95 % interval";
  Figure figure;
  figure.csv = "side_m,controller,mean,low,high,walks\n";
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    PlotSeries series{controllers[c].name, std::string(seriesColour(c)), {}, {}};
    for (const auto& [side, some] : bySide) {
      std::vector<double> values;
      for (const std::size_t r : some) {
        const auto more = valuesOf(results, cellOf(block, r, c), Metric::kResetsPer100Metres);
        values.insert(values.end(), more.begin(), more.end());
      }
      const Estimate e = estimate(values);
      if (e.count == 0) continue;
      series.points.push_back({side, e.mean});
      series.reach.push_back(e.high - e.mean);
      figure.csv += fmt::format("{},{},{},{},{},{}\n", side, quoted(controllers[c].name),
                                cell(e.mean), cell(e.low), cell(e.high), e.count);
    }
    plot.series.push_back(std::move(series));
  }
  figure.file = fmt::format("room_size_{}", number);
  figure.caption =
      "Resets per 100 m against the size of the room; bars are 95 % intervals of the "
      "mean. Rooms of one area are taken together.";
  figure.svg = toSvg(plot);
  return {std::move(figure)};
}

/// A room of the plan; nothing where its outline was not kept.
std::optional<rdw::TrackedSpace> roomOf(const Results& results, std::size_t room) {
  if (room >= results.manifest.rooms.size()) return std::nullopt;
  const auto& rings = results.manifest.rooms[room].rings;
  if (rings.empty()) return std::nullopt;
  auto space = rdw::TrackedSpace::polygon(rings.front(), std::span(rings).subspan(1));
  if (!space) return std::nullopt;
  return std::move(*space);
}

// From paper over orange to a dark violet: lightness falls all the way.
std::string heatColour(double share) {
  constexpr glm::dvec3 kStops[] = {
      {253, 250, 242}, {250, 208, 137}, {226, 116, 84}, {112, 31, 87}, {38, 12, 59}};
  const double place = std::clamp(share, 0.0, 1.0) * 4.0;
  const int stop = std::min(3, static_cast<int>(place));
  const glm::dvec3 colour = glm::mix(kStops[stop], kStops[stop + 1], place - stop);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(colour.x), static_cast<int>(colour.y),
                     static_cast<int>(colour.z));
}

}  // namespace

std::vector<Figure> resetFigures(const Results& results, const Block& block, std::size_t number) {
  std::vector<Figure> figures{boxFigure(results, block, number)};
  for (Figure& figure : sizeFigure(results, block, number)) figures.push_back(std::move(figure));
  return figures;
}

Figure heatFigure(const Results& results, const Block& block, std::size_t number) {
  const auto& rooms = listOf(results, Axis::kRoom);
  const auto& controllers = listOf(results, Axis::kController);
  constexpr double kTile = 128, kGap = 14, kNames = 130, kTop = 96;
  const double width =
      std::max(860.0, kNames + static_cast<double>(controllers.size()) * (kTile + kGap) + 30);
  const double height = kTop + static_cast<double>(rooms.size()) * (kTile + kGap) + 54;
  SvgDrawing drawing(width, height, "#fdfcfa");
  drawing.title("Where the body was");
  drawing.text({kGap, 38}, "Where the body was", 22, Anchor::kStart,
               "fill=\"#1d2733\" font-weight=\"bold\"");
  drawing.text({kGap, 60}, subtitleOf(results, block), 13, Anchor::kStart, "fill=\"#5a6675\"");
  Figure figure;
  figure.csv = "room,controller,column,row,share\n";
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    drawing.text({kNames + (static_cast<double>(c) + 0.5) * (kTile + kGap) - 0.5 * kGap, kTop - 10},
                 controllers[c].name, 12, Anchor::kMiddle);
  }
  for (std::size_t r = 0; r < rooms.size(); ++r) {
    const double top = kTop + static_cast<double>(r) * (kTile + kGap);
    drawing.text({kNames - 10, top + 0.5 * kTile}, rooms[r].name, 12, Anchor::kEnd);
    const auto space = roomOf(results, r);
    glm::dvec2 size(1.0);
    if (space) size = space->upperBound() - space->lowerBound();
    const glm::dvec2 tile = kTile * size / std::max(size.x, size.y);
    for (std::size_t c = 0; c < controllers.size(); ++c) {
      std::array<double, kHeatSide * kHeatSide> share{};
      double all = 0.0;
      for (const Row& row : results.rows) {
        if (row.failed() || !isIn(results.plan, row, cellOf(block, r, c))) continue;
        for (std::size_t i = 0; i < share.size(); ++i) {
          share[i] += static_cast<double>(row.heat[i]);
          all += static_cast<double>(row.heat[i]);
        }
      }
      if (all == 0.0) continue;
      const glm::dvec2 corner(kNames + static_cast<double>(c) * (kTile + kGap), top);
      const glm::dvec2 cellSize = tile / static_cast<double>(kHeatSide);
      for (std::size_t i = 0; i < share.size(); ++i) {
        share[i] /= all;
        const auto column = static_cast<double>(i % kHeatSide);
        const auto line =
            static_cast<double>(kHeatSide - 1 - i / kHeatSide);  // y is up on the plan
        // Four times what an even spread would give is dark.
        drawing.rectangle(
            corner + glm::dvec2(column, line) * cellSize, cellSize + 0.4,
            fmt::format("fill=\"{}\"",
                        heatColour(share[i] * static_cast<double>(share.size()) / 4.0)));
        figure.csv +=
            fmt::format("{},{},{},{},{}\n", quoted(rooms[r].name), quoted(controllers[c].name),
                        i % kHeatSide, i / kHeatSide, cell(share[i]));
      }
      if (space) {
        std::string outline;
        for (std::size_t ring = 0; ring < space->ringCount(); ++ring) {
          bool first = true;
          for (const glm::dvec2 point : space->ring(ring)) {
            const glm::dvec2 place = (point - space->lowerBound()) / size * tile;
            (first ? prediction::moveTo : prediction::lineTo)(
                outline, corner + glm::dvec2(place.x, tile.y - place.y));
            first = false;
          }
          outline += 'Z';
        }
        drawing.path(outline, "fill=\"none\" stroke=\"#3f4e5e\" stroke-width=\"1.6\"");
      } else {
        drawing.rectangle(corner, tile, "fill=\"none\" stroke=\"#3f4e5e\" stroke-width=\"1.6\"");
      }
    }
  }
  const double y = height - 30;
  for (int i = 0; i < 40; ++i) {
    drawing.rectangle({kNames + 4.0 * i, y}, {4.4, 10},
                      fmt::format("fill=\"{}\"", heatColour((i + 0.5) / 40)));
  }
  drawing.text({kNames, y + 24}, "never", 11, Anchor::kStart, "fill=\"#5a6675\"");
  drawing.text({kNames + 160, y + 24}, "4 times an even spread", 11, Anchor::kMiddle,
               "fill=\"#5a6675\"");
  figure.file = fmt::format("places_{}", number);
  figure.caption =
      "Share of the time that the body spent in each part of the room, all walks together.";
  figure.svg = drawing.finish();
  return figure;
}

std::vector<Figure> walkFigures(const Results& results, const std::filesystem::path& folder,
                                const Block& block, std::size_t number) {
  constexpr std::size_t kMost = 8;  // more is a wall of pictures
  const auto textOf = [&](const std::filesystem::path& file) -> std::string {
    if (!std::filesystem::exists(file)) return "";
    const auto bytes = readFile(file);
    if (!bytes) return "";
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
  };
  std::vector<Figure> figures;
  const std::size_t room = listOf(results, Axis::kRoom).size() / 2;
  for (const Row& row : results.rows) {
    if (row.failed() || !results.plan.isFirstSeed(row.run) ||
        !isIn(results.plan, row, block.selection.with(Axis::kRoom, room))) {
      continue;
    }
    const std::string stem = traceStem(results.plan, row.run);
    std::string svg = textOf(folder / "traces" / (stem + "-room.svg"));
    if (svg.empty()) continue;
    std::string csv = textOf(folder / "traces" / (stem + ".csv"));
    if (figures.empty()) {
      if (std::string building = textOf(folder / "traces" / (stem + "-building.svg"));
          !building.empty()) {
        figures.push_back(
            {fmt::format("building_{}", number),
             "The first walk in the building, coloured from start to end; resets are red.",
             std::move(building), csv});
      }
    }
    if (figures.size() >= kMost) break;
    figures.push_back({fmt::format("walk_{}_{}", number, stem), "The same goals, in the room.",
                       std::move(svg), std::move(csv)});
  }
  return figures;
}

}  // namespace forewalk::service
