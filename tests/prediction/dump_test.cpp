// Dumps of prediction graphs: well-formed whatever the graph, and true to it.
#include "prediction/dump.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/predict.h"
#include "prediction/svg.h"
#include "tests/support/xml_fault.h"

namespace forewalk::prediction {
namespace {

using nlohmann::json;

// A grid of square rooms, some missing: loops, dead ends, and a ramp up to the right.
navmesh::World rooms(int columns, int rows, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  navmesh::PolygonMesh mesh;
  for (int z = 0; z <= rows; ++z) {
    for (int x = 0; x <= columns; ++x) {
      mesh.vertices.push_back({2.0f * static_cast<float>(x), 0.1f * static_cast<float>(x),
                               -2.0f * static_cast<float>(z)});
    }
  }
  for (int z = 0; z < rows; ++z) {
    for (int x = 0; x < columns; ++x) {
      if (x != 0 && z != 0 && navmesh::uniform(rng) < 0.25) continue;
      const auto corner = static_cast<std::uint32_t>(z * (columns + 1) + x);
      const auto across = static_cast<std::uint32_t>(columns + 1);
      for (const std::uint32_t vertex :
           {corner, corner + 1, corner + 1 + across, corner + across}) {
        mesh.ring.push_back(vertex);
      }
      mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
    }
  }
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph.has_value());
  return navmesh::makeWorld(std::move(*graph));
}

struct Predicted {
  navmesh::World world;
  PredictionGraph graph;
};

Predicted predicted(int columns, int rows, float horizon, std::uint64_t seed = 1) {
  Predicted result{rooms(columns, rows, seed), {}};
  Scratch scratch(result.world.graph);
  const auto at = navmesh::locate(result.world.graph, result.world.locations, {0.9f, 0.2f, -1.1f});
  EXPECT_TRUE(at.has_value());
  result.graph = predict(result.world.graph, *at, horizon, scratch);
  return result;
}

PredictionGraph offTheMesh(const navmesh::World& world) {
  Scratch scratch(world.graph);
  return predict(world.graph, {}, 10.0f, scratch);
}

using testing::faultOf;

TEST(XmlCheckOfTheseTests, SeesWhatIsWrong) {
  EXPECT_EQ(faultOf("<a x=\"1\"><b/>t &amp; t</a>\n"), "");
  for (const char* bad : {"", "<a>", "<a></b>", "<a/><b/>", "<a x=\"1\" x=\"2\"/>", "<a>&</a>",
                          "<a b/>", "<a>< </a>", "t<a/>", "<a b=\"<\"/>"}) {
    EXPECT_NE(faultOf(bad), "") << bad;
  }
}

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(Dumps, AreWellFormedForTheSourceAlone) {
  const navmesh::World world = rooms(3, 3, 1);
  const PredictionGraph graph = offTheMesh(world);
  ASSERT_EQ(graph.nodes.size(), 1u);
  const json dump = json::parse(toJson(world.graph, graph, 1.0));
  EXPECT_TRUE(dump["source"]["polygon"].is_null());
  EXPECT_EQ(dump["nodes"].size(), 1u);
  EXPECT_TRUE(dump["edges"].empty());
  EXPECT_EQ(faultOf(toGraphml(graph)), "");
  EXPECT_EQ(faultOf(toSvg(world.graph, graph)), "");
  EXPECT_EQ(toDot(graph).substr(0, 5), "graph");
}

TEST(Dumps, AreWellFormedForNumbersThatAreNone) {
  Predicted p = predicted(4, 4, 6.0f);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    PredictionGraph graph = p.graph;
    graph.nodes.back().distance = bad;
    graph.nodes.back().height = bad;
    graph.edges.back().length = bad;
    const json dump = json::parse(toJson(p.world.graph, graph, std::nan("")));
    EXPECT_TRUE(dump["nodes"].back()["distance"].is_null());
    EXPECT_TRUE(dump["stats"]["microseconds"].is_null());
    EXPECT_EQ(faultOf(toGraphml(graph)), "");
    EXPECT_EQ(faultOf(toSvg(p.world.graph, graph)), "");
    EXPECT_EQ(toDot(graph).find("nan"), std::string::npos);
    EXPECT_EQ(toDot(graph).find("inf,"), std::string::npos);
  }
}

TEST(Dumps, AreTheSameBytesForTheSameGraph) {
  const Predicted a = predicted(6, 5, 9.0f), b = predicted(6, 5, 9.0f);
  EXPECT_EQ(toJson(a.world.graph, a.graph, 2.5), toJson(b.world.graph, b.graph, 2.5));
  EXPECT_EQ(toGraphml(a.graph), toGraphml(b.graph));
  EXPECT_EQ(toDot(a.graph), toDot(b.graph));
  EXPECT_EQ(toSvg(a.world.graph, a.graph), toSvg(b.world.graph, b.graph));
}

TEST(Json, FollowsTheSchema) {
  const Predicted p = predicted(6, 6, 8.0f);
  const json dump = json::parse(toJson(p.world.graph, p.graph, 8.4));
  EXPECT_EQ(dump["format"], "forewalk.prediction/1");
  EXPECT_EQ(dump["horizon"].get<float>(), 8.0f);
  EXPECT_EQ(dump["stats"]["settled"].get<std::uint32_t>(), p.graph.stats.settled);
  EXPECT_EQ(dump["stats"]["relaxed"].get<std::uint32_t>(), p.graph.stats.relaxed);
  EXPECT_EQ(dump["stats"]["microseconds"].get<float>(), 8.4f);
  EXPECT_EQ(dump["source"]["position"].size(), 3u);
  ASSERT_EQ(dump["nodes"].size(), p.graph.nodes.size());
  ASSERT_EQ(dump["edges"].size(), p.graph.edges.size());
  for (std::size_t i = 0; i < p.graph.nodes.size(); ++i) {
    const json& node = dump["nodes"][i];
    EXPECT_EQ(node["id"], i);
    const std::string kind = node["kind"];
    EXPECT_EQ(kind, i == 0                                       ? "source"
                    : p.graph.nodes[i].kind == NodeKind::kBranch ? "branch"
                                                                 : "terminal");
    EXPECT_EQ(node["prev"].is_null(), i == 0);
    if (i > 0) {
      EXPECT_LT(node["prev"].get<std::size_t>(), i) << "parents come first";
    }
    EXPECT_EQ(node.contains("reason"), kind == "terminal");
    if (kind == "terminal") {
      EXPECT_TRUE(node["reason"] == "horizon" || node["reason"] == "dead_end");
      EXPECT_EQ(node.contains("branch"), p.graph.nodes[i].branch);
    }
    EXPECT_EQ(node["distance"].get<float>(), p.graph.nodes[i].distance) << "reads back exactly";
    EXPECT_EQ(node["position"][1].get<float>(), p.graph.nodes[i].height);
  }
}

TEST(Json, HasPathsAsLongOnThePlanAsTheirEdges) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Predicted p = predicted(7, 7, 11.0f, seed);
    const json dump = json::parse(toJson(p.world.graph, p.graph, 0.0));
    for (const json& edge : dump["edges"]) {
      ASSERT_FALSE(edge["path"].empty());
      double length = 0.0;
      glm::dvec3 last(0.0);
      for (std::size_t i = 0; i < edge["path"].size(); ++i) {
        const json& point = edge["path"][i];
        const glm::dvec3 here(point[0].get<double>(), point[1].get<double>(),
                              point[2].get<double>());
        if (i > 0) length += std::hypot(here.x - last.x, here.z - last.z);
        EXPECT_NEAR(here.y, 0.05 * here.x, 0.021) << "lies on the ramp";
        last = here;
      }
      EXPECT_NEAR(length, edge["length"].get<double>(), 1e-4);
      const json& from = dump["nodes"][edge["from"].get<std::size_t>()]["position"];
      const json& to = dump["nodes"][edge["to"].get<std::size_t>()]["position"];
      EXPECT_NEAR(edge["path"].front()[0].get<float>(), from[0].get<float>(), 1e-4f);
      EXPECT_NEAR(edge["path"].back()[2].get<float>(), to[2].get<float>(), 1e-4f);
      EXPECT_EQ(edge["polygons"].front(),
                dump["nodes"][edge["from"].get<std::size_t>()]["polygon"]);
    }
  }
}

TEST(Json, WritesNumbersShort) {
  const Predicted p = predicted(3, 3, 0.1f);
  EXPECT_NE(toJson(p.world.graph, p.graph, 8.4).find("\"horizon\": 0.1,"), std::string::npos);
}

TEST(Graphml, HasEveryNodeAndEdgeAndOnlyDeclaredKeys) {
  const Predicted p = predicted(6, 6, 9.0f);
  const std::string text = toGraphml(p.graph);
  EXPECT_EQ(faultOf(text), "");
  EXPECT_EQ(count(text, "<node id="), p.graph.nodes.size());
  EXPECT_EQ(count(text, "<edge id="), p.graph.edges.size());
  for (std::size_t at = text.find("<data key=\""); at != text.npos;
       at = text.find("<data key=\"", at + 1)) {
    const std::size_t begin = at + 11;
    const std::string key = text.substr(begin, text.find('"', begin) - begin);
    EXPECT_NE(text.find("<key id=\"" + key + "\""), text.npos) << key;
  }
}

TEST(Dot, HasEveryNodeAtItsPlaceAndEveryEdge) {
  const Predicted p = predicted(6, 6, 9.0f);
  const std::string text = toDot(p.graph);
  EXPECT_EQ(count(text, "pos=\""), p.graph.nodes.size());
  EXPECT_EQ(count(text, " -- "), p.graph.edges.size());
  EXPECT_EQ(count(text, "{"), count(text, "}"));
  EXPECT_EQ(count(text, "\"") % 2, 0u);
  EXPECT_EQ(text.substr(text.size() - 2), "}\n");
}

TEST(Svg, HasAMarkForEveryNode) {
  const Predicted p = predicted(6, 6, 9.0f);
  std::size_t branches = 0, horizon = 0, deadEnds = 0;
  for (const Node& node : p.graph.nodes) {
    branches += node.kind == NodeKind::kBranch;
    horizon += node.reason == TerminalReason::kHorizon;
    deadEnds += node.reason == TerminalReason::kDeadEnd;
  }
  ASSERT_GT(branches, 0u);
  ASSERT_GT(horizon, 0u);
  const std::string text =
      toSvg(p.world.graph, p.graph, {"A title with <angles> & \"quotes\"", 0.5f});
  EXPECT_EQ(faultOf(text), "");
  // One more of each in the legend.
  EXPECT_EQ(count(text, "fill=\"#d6353a\""), branches + 1);
  EXPECT_EQ(count(text, "fill=\"#1f9d55\""), horizon + 1);
  EXPECT_EQ(count(text, "stroke=\"#1f9d55\""), deadEnds + 1);
}

TEST(Svg, CountsTheMeetingsAmongTheTerminals) {
  Predicted p = predicted(6, 6, 9.0f);
  ASSERT_FALSE(p.graph.terminals.empty());
  EXPECT_EQ(toSvg(p.world.graph, p.graph).find("in a meeting"), std::string::npos);
  for (const NodeId id : {p.graph.terminals.front(), p.graph.terminals.back()}) {
    p.graph.nodes[index(id)].reason = TerminalReason::kMeeting;
  }
  EXPECT_NE(toSvg(p.world.graph, p.graph).find(", 2 in a meeting)"), std::string::npos);
}

TEST(Svg, StaysWithinItsPage) {
  const Predicted p = predicted(40, 4, 5.0f);
  const std::string text = toSvg(p.world.graph, p.graph);
  const auto number = [&](std::string_view name) {
    return std::stod(text.substr(text.find(name) + name.size()));
  };
  EXPECT_LT(number("width=\""), 1300);
  EXPECT_LT(number("height=\""), 1100);
}

TEST(SvgText, IsEscapedAndFreeOfControlCharacters) {
  EXPECT_EQ(escapeXml("a<b>&\"c'\x01"), "a&lt;b&gt;&amp;&quot;c&apos;");
  EXPECT_EQ(svgNumber(1.0 / 3), "0.33");
  EXPECT_EQ(svgNumber(-0.001), "0");
  EXPECT_EQ(svgNumber(120), "120");
  EXPECT_EQ(svgNumber(std::nan("")), "0");
}

}  // namespace
}  // namespace forewalk::prediction
