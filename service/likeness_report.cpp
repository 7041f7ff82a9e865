// How like people models walk, for people and programs: text, CSV, JSON and plans.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "agents/evaluation/dtw.h"
#include "service/likeness.h"

namespace forewalk::service {
namespace {

using Json = nlohmann::ordered_json;

std::string chance(double p) { return p < 0.0005 ? "<.001" : fmt::format("{:.3f}", p); }

std::string count(std::size_t n, const char* one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

// As an id in a file of walks, which knows no quotes.
std::string withoutCommas(std::string_view name) {
  std::string plain(name);
  std::erase(plain, ',');
  return plain;
}

std::string ruleLine(const Likeness& likeness) {
  const LegRule& rule = likeness.rule;
  return fmt::format(
      "Legs: from one place where {} people or more rested ({:g} s within {:g} m, places {:g} m in "
      "radius) to another,\n{:g} m or more, at most {:g} times the shortest way; sets of {} people "
      "or more, no stretch twice.\n",
      rule.restingWalkers, rule.restSeconds, rule.restRadius, rule.regionRadius, rule.shortest,
      rule.detour, rule.walkers);
}

std::size_t nameWidth(const Likeness& likeness) {
  std::size_t width = 10;
  for (const ComparedSet& set : likeness.sets) width = std::max(width, set.name.size());
  for (const WalkerSummary& walker : likeness.walkers) width = std::max(width, walker.name.size());
  return width;
}

std::string setRows(const Likeness& likeness, std::size_t table) {
  const std::size_t width = nameWidth(likeness);
  std::string text =
      fmt::format("{:<{}} {:>4} {:>6} {:>8}", "set", width, "legs", "way, m", "people");
  for (const WalkerSummary& walker : likeness.walkers) text += fmt::format(" {:>13}", walker.name);
  text += '\n';
  for (const ComparedSet& set : likeness.sets) {
    text += fmt::format("{:<{}} {:>4} {:>6.1f} {:>8.3f}", set.name, width, set.legs.legs.size(),
                        set.shortestWay, set.peopleApart[table]);
    for (const SetLikeness& walker : set.walkers[table]) {
      text += fmt::format(" {:>7.3f} {:>5}", walker.toPeople, chance(walker.holm));
    }
    text += '\n';
  }
  return text;
}

std::string overallRows(const Likeness& likeness, std::size_t table) {
  const std::size_t width = nameWidth(likeness);
  std::string text =
      fmt::format("{:<{}} {:>6} {:>11} {:>9} {:>9} {:>10} {:>8} {:>8}\n", "walker", width, "ratio",
                  "superiority", "farther", "apart", "sets apart", "detour", "arrived");
  text += fmt::format("{:<{}} {:>6} {:>11} {:>9} {:>9} {:>10} {:>8.3f}\n", "people", width, "1",
                      "0.5", "", "", "", likeness.peopleDetour);
  for (const WalkerSummary& walker : likeness.walkers) {
    const OverallLikeness& overall = walker.overall[table];
    text += fmt::format("{:<{}} {:>6.2f} {:>11.3f} {:>9} {:>9} {:>7}/{:<2} {:>8.3f} {:>5}/{}\n",
                        walker.name, width, overall.ratio, overall.matched.superiority,
                        chance(overall.farther), chance(overall.apart), overall.toldApart,
                        likeness.sets.size(), walker.detour, walker.arrived, walker.legs);
  }
  return text;
}

std::string sceneText(const SceneLikeness& scene) {
  std::string text = fmt::format("\n{}: no people were recorded in it; models from each other, m\n",
                                 scene.scene->name);
  text += fmt::format("{:<14} {:>9} {:>8}", "walker", "length, m", "s");
  for (const std::string& walker : scene.walkers) text += fmt::format(" {:>13}", walker);
  text += '\n';
  for (std::size_t i = 0; i < scene.walkers.size(); ++i) {
    text += fmt::format("{:<14} {:>9.1f} {:>8.1f}", scene.walkers[i],
                        agents::pathLength(scene.walked[i].points), scene.walked[i].seconds);
    for (std::size_t j = 0; j < scene.walkers.size(); ++j) {
      text += fmt::format(" {:>13.3f}", scene.normalised.at(i, j));
    }
    text += scene.walked[i].arrived ? "\n" : "   (did not arrive)\n";
  }
  return text;
}

PathComparison asGroups(std::vector<ComparedPath> paths, std::vector<PathGroup> groups) {
  PathComparison comparison;
  comparison.paths = std::move(paths);
  comparison.groups = std::move(groups);
  return comparison;
}

std::vector<glm::dvec2> discOutline(glm::dvec2 centre, double radius) {
  constexpr int kCorners = 32;
  std::vector<glm::dvec2> outline;
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2.0 * 3.14159265358979323846 * k / kCorners;
    outline.push_back(centre + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

std::vector<glm::dvec2> boxOutline(const agents::AvatarObject& box) {
  const double c = std::cos(static_cast<double>(box.heading));
  const double s = std::sin(static_cast<double>(box.heading));
  std::vector<glm::dvec2> outline;
  for (const glm::dvec2 corner : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    const glm::dvec2 at = corner * glm::dvec2(box.halfSize);
    outline.push_back(glm::dvec2(box.centre) +
                      glm::dvec2(c * at.x - s * at.y, s * at.x + c * at.y));
  }
  return outline;
}

}  // namespace

std::string toText(const Likeness& likeness) {
  std::string text = ruleLine(likeness);
  std::size_t legs = 0;
  for (const BuildingSummary& building : likeness.buildings) {
    const auto [slowest, fastest] =
        std::minmax_element(building.speeds.begin(), building.speeds.end());
    text +=
        fmt::format("{}: {}, {}, {}, {}, {}; comfort speeds {:.2f} to {:.2f} m/s\n", building.name,
                    count(building.people, "walk"), count(building.rests, "rest"),
                    count(building.regions.size(), "region"), count(building.sets, "set"),
                    count(building.legs, "leg"), *slowest, *fastest);
    legs += building.legs;
  }
  const auto& tables = likeness.sets.front().tables;
  for (std::size_t t = tables.size(); t-- > 0;) {
    const std::size_t labellings = likeness.walkers.front().overall[t].matched.labellings;
    text += fmt::format(
        "\n== {} distances{} ==\n"
        "Mean distance from person to person, and from people to each walker in another's place,\n"
        "with p that it is no farther (labels permuted in the set, Holm over {} sets)\n{}"
        "\nOver {} and {}: ratio of the distances (median); chance that a person is farther from\n"
        "another's model than from the other (0.5: like one more person); p that it is no\n"
        "farther, and that it cannot be told apart at all (energy distance)\n"
        "(labels flipped person by person, {}{}, Holm over walkers); sets told apart\n"
        "at 0.05; path over shortest way\n{}",
        tables[t].name, tables[t].name == "normalised" ? ", m" : ", m x samples",
        likeness.sets.size(), setRows(likeness, t), count(likeness.sets.size(), "set"),
        count(legs, "leg"), likeness.walkers.front().overall[t].matched.exact ? "all " : "",
        count(labellings, "labelling"), overallRows(likeness, t));
  }
  for (const SceneLikeness& scene : likeness.scenes) text += sceneText(scene);
  return text;
}

std::string toCsv(const Likeness& likeness) {
  std::string csv =
      "set,walker,table,legs,shortest_way_m,people_apart,to_people,ratio,superiority,p_farther,"
      "p_farther_holm,p_apart,p_apart_holm,labellings,detour,arrived\n";
  std::size_t legs = 0;
  for (const ComparedSet& set : likeness.sets) {
    legs += set.legs.legs.size();
    for (std::size_t t = 0; t < set.tables.size(); ++t) {
      for (std::size_t w = 0; w < likeness.walkers.size(); ++w) {
        const SetLikeness& one = set.walkers[t][w];
        csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},,,{},,\n", quoted(set.name),
                           quoted(likeness.walkers[w].name), set.tables[t].name,
                           set.legs.legs.size(), set.shortestWay, set.peopleApart[t], one.toPeople,
                           one.toPeople / set.peopleApart[t], one.superiority, one.separation.p,
                           one.holm, one.separation.labellings);
      }
    }
  }
  const auto& tables = likeness.sets.front().tables;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    for (const WalkerSummary& walker : likeness.walkers) {
      const OverallLikeness& all = walker.overall[t];
      csv += fmt::format("all,{},{},{},,,,{},{},{},{},{},{},{},{},{}\n", quoted(walker.name),
                         tables[t].name, legs, all.ratio, all.matched.superiority,
                         all.matched.farther, all.farther, all.matched.apart, all.apart,
                         all.matched.labellings, walker.detour, walker.arrived);
    }
  }
  return csv;
}

std::string toJson(const Likeness& likeness) {
  Json json;
  json["format"] = "forewalk.likeness/1";
  const LegRule& rule = likeness.rule;
  json["rule"] = {{"rest_s", rule.restSeconds},
                  {"rest_radius_m", rule.restRadius},
                  {"region_radius_m", rule.regionRadius},
                  {"resting_walkers", rule.restingWalkers},
                  {"shortest_m", rule.shortest},
                  {"detour", rule.detour},
                  {"walkers", rule.walkers}};
  json["buildings"] = Json::array();
  for (const BuildingSummary& building : likeness.buildings) {
    Json regions = Json::array();
    for (const glm::dvec2 region : building.regions) regions.push_back({region.x, -region.y});
    json["buildings"].push_back({{"name", building.name},
                                 {"walks", building.people},
                                 {"rests", building.rests},
                                 {"regions", regions},
                                 {"sets", building.sets},
                                 {"legs", building.legs},
                                 {"comfort_speeds_m_per_s", building.speeds}});
  }
  json["sets"] = Json::array();
  for (const ComparedSet& set : likeness.sets) {
    Json one{{"name", set.name},
             {"building", likeness.buildings[set.building].name},
             {"from", set.legs.from},
             {"to", set.legs.to},
             {"legs", set.legs.legs.size()},
             {"shortest_way_m", set.shortestWay}};
    for (std::size_t t = 0; t < set.tables.size(); ++t) {
      Json walkers = Json::array();
      for (std::size_t w = 0; w < likeness.walkers.size(); ++w) {
        const SetLikeness& walker = set.walkers[t][w];
        walkers.push_back({{"name", likeness.walkers[w].name},
                           {"to_people", walker.toPeople},
                           {"superiority", walker.superiority},
                           {"p", walker.separation.p},
                           {"least_p", walker.separation.leastP},
                           {"holm", walker.holm}});
      }
      one[set.tables[t].name] = {{"people_apart", set.peopleApart[t]}, {"walkers", walkers}};
    }
    json["sets"].push_back(one);
  }
  json["people_detour"] = likeness.peopleDetour;
  json["walkers"] = Json::array();
  for (const WalkerSummary& walker : likeness.walkers) {
    Json one{{"name", walker.name},
             {"legs", walker.legs},
             {"arrived", walker.arrived},
             {"detour", walker.detour}};
    for (std::size_t t = 0; t < walker.overall.size(); ++t) {
      const OverallLikeness& all = walker.overall[t];
      one[likeness.sets.front().tables[t].name] = {{"ratio", all.ratio},
                                                   {"superiority", all.matched.superiority},
                                                   {"p_farther", all.matched.farther},
                                                   {"p_farther_holm", all.farther},
                                                   {"energy", all.matched.energy},
                                                   {"p_apart", all.matched.apart},
                                                   {"p_apart_holm", all.apart},
                                                   {"labellings", all.matched.labellings},
                                                   {"sets_told_apart", all.toldApart}};
    }
    json["walkers"].push_back(one);
  }
  json["scenes"] = Json::array();
  for (const SceneLikeness& scene : likeness.scenes) {
    Json walkers = Json::array(), rows = Json::array();
    for (std::size_t i = 0; i < scene.walkers.size(); ++i) {
      walkers.push_back({{"name", scene.walkers[i]},
                         {"length", agents::pathLength(scene.walked[i].points)},
                         {"seconds", scene.walked[i].seconds},
                         {"arrived", scene.walked[i].arrived}});
      Json row = Json::array();
      for (std::size_t j = 0; j < scene.walkers.size(); ++j) {
        row.push_back(scene.normalised.at(i, j));
      }
      rows.push_back(row);
    }
    json["scenes"].push_back(
        {{"name", std::string(scene.scene->name)}, {"walkers", walkers}, {"normalised", rows}});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string toPathsCsv(const Likeness& likeness) {
  std::string csv = "walker_id,x,z\n";
  const auto append = [&](const std::string& name, const std::vector<glm::dvec2>& points) {
    for (const glm::dvec2 point : points) {
      csv += fmt::format("{},{:.4f},{:.4f}\n", name, point.x, -point.y);
    }
  };
  for (const ComparedSet& set : likeness.sets) {
    for (const ComparedPath& path : set.paths) append(path.name, path.points);
  }
  for (const SceneLikeness& scene : likeness.scenes) {
    for (std::size_t i = 0; i < scene.walkers.size(); ++i) {
      append(withoutCommas(scene.scene->name) + " " + scene.walkers[i], scene.walked[i].points);
    }
  }
  return csv;
}

std::string likenessPlan(const Likeness& likeness, std::size_t building,
                         const navmesh::NavGraph& floor) {
  std::vector<ComparedPath> paths;
  std::vector<PathGroup> groups{{"people", {}}};
  for (const WalkerSummary& walker : likeness.walkers) groups.push_back({walker.name, {}});
  for (const ComparedSet& set : likeness.sets) {
    if (set.building != building) continue;
    const std::size_t n = set.legs.legs.size();
    for (std::size_t i = 0; i < set.paths.size(); ++i) {
      groups[i / n].paths.push_back(paths.size());
      paths.push_back(set.paths[i]);
    }
  }
  const BuildingSummary& summary = likeness.buildings[building];
  PathPlanFrame frame;
  frame.title = summary.name;
  frame.subtitle =
      fmt::format("{} of people, and everybody in their place", count(summary.legs, "leg"));
  frame.floor = &floor;
  for (const glm::dvec2 region : summary.regions) {
    frame.outlines.push_back(discOutline(region, likeness.rule.regionRadius));
  }
  return pathPlan(asGroups(std::move(paths), std::move(groups)), frame);
}

std::string scenePlan(const SceneLikeness& scene) {
  std::vector<ComparedPath> paths;
  std::vector<PathGroup> groups;
  for (std::size_t i = 0; i < scene.walkers.size(); ++i) {
    // The thesis's own walker first, drawn as people are: what the others are compared with.
    const std::size_t walker = (i + scene.walkers.size() - 1) % scene.walkers.size();
    groups.push_back({scene.walkers[walker], {paths.size()}});
    paths.push_back({scene.walkers[walker], {}, {}, {}, scene.walked[walker].points});
  }
  PathPlanFrame frame;
  frame.title = std::string(scene.scene->name);
  for (const agents::AvatarObject& box : scene.scene->objects) {
    frame.outlines.push_back(boxOutline(box));
  }
  return pathPlan(asGroups(std::move(paths), std::move(groups)), frame);
}

}  // namespace forewalk::service
