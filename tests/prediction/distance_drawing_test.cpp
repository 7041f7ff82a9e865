// Distances as colour: lines of equal distance lie where they say, none is missing, and what is
// painted at a place is the colour of its distance.
#include "prediction/distance_drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "navmesh/world.h"
#include "prediction/dump.h"
#include "prediction/predict.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/xml_fault.h"

namespace forewalk::prediction {
namespace {

using glm::dvec2;

/// A navmesh and distances from somewhere in it.
struct Measured {
  explicit Measured(const navmesh::PolygonMesh& mesh, std::uint64_t seed = 1, float horizon = 0.0f)
      : graph(std::move(*navmesh::makeNavGraph(mesh))),
        ends(makePortalEnds(graph)),
        field(graph, ends),
        source(testing::randomStarts(graph, 1, seed).front()) {
    if (horizon > 0.0f) field.run(source, horizon);
  }
  Measured(const Measured&) = delete;

  navmesh::NavGraph graph;
  PortalEnds ends;
  DistanceField field;
  navmesh::Location source;
};

navmesh::PolygonMesh meshOf(int seed) {
  testing::RandomMeshOptions options;
  options.holeShare = 0.05 * (seed % 7);
  options.splitShare = 0.15 * (seed % 5);
  if (seed % 3 == 0) options.jitter = 0.0;
  return testing::randomMesh(static_cast<std::uint64_t>(seed), 7, 6, options);
}

constexpr int kWorlds = 30;
constexpr float kHorizon = 5.3f;  // not a whole number of steps

TEST(IsoLine, IsEmptyWhereThereIsNothing) {
  const Measured never(testing::gridMesh(3, 3));
  EXPECT_TRUE(isoLine(never.graph, never.field, 1.0).empty());
  const Measured measured(testing::gridMesh(3, 3), 1, 2.0f);
  for (const double bad :
       {0.0, -1.0, 2.1, 1e9, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(isoLine(measured.graph, measured.field, bad).empty()) << bad;
  }
  EXPECT_FALSE(isoLine(measured.graph, measured.field, 0.5).empty());
}

TEST(IsoLine, IsAWholeCircleWhereNothingIsInTheWay) {
  Measured measured(testing::gridMesh(9, 9));
  measured.field.run({navmesh::PolygonId{40}, {4.4f, 4.6f}, 0.0f, false}, 3.0f);
  const std::vector<IsoArc> arcs = isoLine(measured.graph, measured.field, 2.5);
  double length = 0.0;
  for (const IsoArc& arc : arcs) length += arc.radius * (arc.to - arc.from);
  EXPECT_NEAR(length, 2.5 * 2.0 * 3.14159265358979, 1e-4);
  EXPECT_LE(arcs.size(), 2u);  // cut at most where angles begin
}

TEST(IsoLine, LiesAtItsDistance) {
  for (int seed = 0; seed < kWorlds; ++seed) {
    const Measured measured(meshOf(seed), 3, kHorizon);
    for (double distance = 0.4; distance < kHorizon; distance += 0.7) {
      for (const IsoArc& arc : isoLine(measured.graph, measured.field, distance)) {
        ASSERT_LT(arc.from, arc.to);
        for (const double share : {0.02, 0.3, 0.5, 0.8, 0.98}) {
          // The arc may pass through many polygons; its point is in one of them.
          const glm::vec2 point(arc.at(glm::mix(arc.from, arc.to, share)));
          double nearest = std::numeric_limits<double>::infinity();
          for (const PolygonId polygon : measured.field.polygons()) {
            if (!navmesh::contains(measured.graph, polygon, point, 1e-4f)) continue;
            nearest =
                std::min(nearest, static_cast<double>(measured.field.distanceAt(polygon, point)));
          }
          EXPECT_NEAR(nearest, distance, 2e-3) << "world " << seed << " at " << distance << " m";
        }
      }
    }
  }
}

// Distance grows by a metre per metre, so that lines a hair apart cover the area: their lengths sum
// to it (the coarea formula). A line that is missing or drawn twice shows.
TEST(IsoLine, LengthsSumToTheArea) {
  constexpr double kApart = 0.02;
  for (int seed = 0; seed < 10; ++seed) {
    const Measured measured(meshOf(seed), 5, kHorizon);
    double byLines = 0.0;
    for (double distance = 0.5 * kApart; distance < kHorizon; distance += kApart) {
      for (const IsoArc& arc : isoLine(measured.graph, measured.field, distance)) {
        byLines += kApart * arc.radius * (arc.to - arc.from);
      }
    }
    double byPlaces = 0.0;
    constexpr int kPlaces = 40;  // along an edge of each triangle
    for (const PolygonId polygon : measured.field.polygons()) {
      const auto ring = measured.graph.ringOf(polygon);
      for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        const dvec2 a(ring[0]), u = dvec2(ring[i]) - a, v = dvec2(ring[i + 1]) - a;
        const double piece = 0.5 * (u.x * v.y - u.y * v.x) / (kPlaces * kPlaces);
        for (int row = 0; row < kPlaces; ++row) {
          for (int column = 0; column < 2 * row + 1; ++column) {
            const double down = (row + (column % 2 ? 1.0 / 3 : 2.0 / 3)) / kPlaces;
            const double across = (column + 1.0) / (2.0 * row + 2.0);
            const glm::vec2 at(a + down * glm::mix(u, v, across));
            byPlaces += measured.field.distanceAt(polygon, at) <= kHorizon ? piece : 0.0;
          }
        }
      }
    }
    EXPECT_NEAR(byLines, byPlaces, 0.01 * byPlaces) << "world " << seed;
  }
}

double luminanceOf(const std::string& colour) {
  double sum = 0.0;
  const double weights[] = {0.2126, 0.7152, 0.0722};
  for (std::size_t i = 0; i < 3; ++i) {
    const long value = std::strtol(colour.substr(1 + 2 * i, 2).c_str(), nullptr, 16);
    sum += weights[i] * std::pow(static_cast<double>(value) / 255.0, 2.2);
  }
  return sum;
}

TEST(DistanceColour, DarkensWithEveryStepAndStaysInItsRange) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_GT(luminanceOf(distanceColour(i / 50.0)), luminanceOf(distanceColour((i + 1) / 50.0)));
  }
  EXPECT_EQ(distanceColour(-3.0), distanceColour(0.0));
  EXPECT_EQ(distanceColour(7.0), distanceColour(1.0));
  EXPECT_EQ(distanceColour(std::nan("")), distanceColour(1.0));
}

/// A filled path of a drawing, arcs cut into chords: tenths of pixels.
struct Painted {
  std::string fill;
  std::vector<std::vector<dvec2>> rings;
};

void addChords(std::vector<dvec2>& ring, dvec2 to, double radius, bool large) {
  const dvec2 from = ring.back(), half = 0.5 * (to - from);
  const double off = std::sqrt(std::max(0.0, radius * radius - glm::dot(half, half)));
  // Counter-clockwise as seen on a page whose y points down.
  const dvec2 side = glm::normalize(dvec2(half.y, -half.x));
  const dvec2 centre = from + half + (large ? -1.0 : 1.0) * off * side;
  const double begin = std::atan2(from.y - centre.y, from.x - centre.x);
  double turn = begin - std::atan2(to.y - centre.y, to.x - centre.x);
  if (turn < 0.0) turn += 2.0 * 3.14159265358979;
  for (int i = 1; i < 40; ++i) {
    const double angle = begin - turn * i / 40.0;
    ring.push_back(centre + radius * dvec2(std::cos(angle), std::sin(angle)));
  }
  ring.push_back(to);
}

std::vector<Painted> paintedIn(const std::string& svg) {
  std::vector<Painted> all;
  for (std::size_t at = svg.find("<path d=\""); at != std::string::npos;
       at = svg.find("<path d=\"", at + 1)) {
    const std::size_t begin = at + 9, end = svg.find('"', begin);
    const std::string rest = svg.substr(end, svg.find("/>", end) - end);
    const std::size_t fill = rest.find("fill=\"#");
    if (fill == std::string::npos || rest.find("stroke-width=\"6\"") == std::string::npos) continue;
    Painted& painted = all.emplace_back();
    painted.fill = rest.substr(fill + 6, 7);
    const char* text = svg.c_str() + begin;
    const char* stop = svg.c_str() + end;
    const auto number = [&] {
      char* after = nullptr;
      const double value = std::strtod(text, &after);
      text = after;
      return value;
    };
    while (text < stop) {
      const char command = *text++;
      if (command == 'M') {
        const double x = number(), y = number();
        painted.rings.push_back({{x, y}});
      } else if (command == 'l') {
        const double x = number(), y = number();
        painted.rings.back().push_back(painted.rings.back().back() + dvec2(x, y));
      } else if (command == 'a') {
        const double radius = number();
        number(), number();
        const bool large = number() != 0.0;
        EXPECT_EQ(number(), 0.0);
        const double x = number(), y = number();
        addChords(painted.rings.back(), painted.rings.back().back() + dvec2(x, y), radius, large);
      } else if (command != 'z') {
        ADD_FAILURE() << "unknown command " << command;
        return all;
      }
    }
  }
  return all;
}

bool covers(const Painted& painted, dvec2 at) {
  int winding = 0;
  for (const auto& ring : painted.rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
      if ((a.y <= at.y) == (b.y <= at.y)) continue;
      const double side = (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
      if (b.y > a.y && side > 0.0) ++winding;
      if (b.y <= a.y && side < 0.0) --winding;
    }
  }
  return winding != 0;
}

TEST(Distances, ArePaintedInTheColourOfTheirBand) {
  int looked = 0;
  for (int seed = 0; seed < kWorlds; ++seed) {
    const Measured measured(meshOf(seed), 9, kHorizon);
    const PlanPage page(boundsOf(measured.graph));
    SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#ffffff");
    drawDistances(drawing, page, measured.graph, measured.field, {});
    const std::vector<Painted> painted = paintedIn(drawing.finish());
    ASSERT_FALSE(painted.empty());
    const double step = isoStep(kHorizon);
    const double bands = std::ceil(kHorizon / step);
    for (const navmesh::Location& place : testing::randomStarts(measured.graph, 60, 77)) {
      const auto distance =
          static_cast<double>(measured.field.distanceAt(place.polygon, place.plan));
      // Where bands meet, a pixel decides.
      if (std::abs(std::remainder(distance, step)) < 0.02 || distance > kHorizon - 0.02) continue;
      ++looked;
      std::string seen = "nothing";
      for (const Painted& path : painted) {
        if (covers(path, 10.0 * page.at(place.plan))) seen = path.fill;
      }
      EXPECT_EQ(seen, distanceColour((std::floor(distance / step) + 0.5) / bands))
          << "world " << seed << ", " << distance << " m";
    }
  }
  EXPECT_GT(looked, 500);
}

TEST(Distances, PaintNothingThatIsNotShown) {
  const Measured measured(testing::gridMesh(4, 4), 1, 3.0f);
  const PlanPage page(boundsOf(measured.graph));
  const std::vector<char> none(measured.graph.polygonCount(), 0);
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#ffffff");
  drawDistances(drawing, page, measured.graph, measured.field, none);
  EXPECT_EQ(drawing.finish().find("<path"), std::string::npos);
}

TEST(Distances, LieBelowTheWaysInAPlan) {
  const Measured measured(meshOf(4), 2, kHorizon);
  const navmesh::World world = navmesh::makeWorld(measured.graph);
  Scratch scratch(world.graph);
  const PredictionGraph& ways = predict(world.graph, measured.source, kHorizon, scratch);
  PlanText text{"Distances", 0.3f};
  text.distances = &measured.field;
  const std::string plan = toSvg(world.graph, ways, text);
  EXPECT_EQ(testing::faultOf(plan), "");
  EXPECT_EQ(plan, toSvg(world.graph, ways, text));
  EXPECT_NE(plan.find("walking distance"), std::string::npos);
  EXPECT_EQ(toSvg(world.graph, ways).find("walking distance"), std::string::npos);
  EXPECT_LT(plan.rfind("stroke-width=\"6\""), plan.rfind("<g fill=\"none\" stroke=\"#16273d\""));
}

}  // namespace
}  // namespace forewalk::prediction
