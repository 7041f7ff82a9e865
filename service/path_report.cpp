// Comparisons of paths for people and programs: text, CSV and JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "agents/evaluation/dtw.h"
#include "service/path_comparison.h"

namespace forewalk::service {
namespace {

using agents::FTest;
using agents::PairDifference;
using agents::Separation;
using Json = nlohmann::ordered_json;

constexpr std::size_t kModelsShown = 4;  // paths whose rows of pairs the text has

std::string number(double value, int digits) {
  if (std::isnan(value)) return "-";
  return fmt::format("{:.{}f}", value, digits);
}

std::string chance(double p) {
  if (std::isnan(p)) return "-";
  return p < 0.0005 ? "<.001" : fmt::format("{:.3f}", p);
}

std::string exactly(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

// Names come from outside: quoted, so that a comma in one moves no column.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

std::string count(std::size_t n, const char* one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

struct NamedTest {
  const char* key;
  const char* name;
  const FTest* test;
};

std::vector<NamedTest> namedTests(const OneWayTests& tests) {
  return {{"anova", "ANOVA", &tests.anova.test},
          {"welch", "Welch", &tests.welch},
          {"brown_forsythe", "Brown-Forsythe", &tests.brownForsythe},
          {"levene", "Levene, means", &tests.levene},
          {"levene_median", "Levene, medians", &tests.leveneMedian}};
}

std::string testLines(const OneWayTests& tests) {
  std::string text = fmt::format("  between groups: sum of squares {}, within: {}\n",
                                 number(tests.anova.between, 2), number(tests.anova.within, 2));
  for (const NamedTest& named : namedTests(tests)) {
    const bool ofSpread = named.key[0] == 'l';
    text += fmt::format("  {:<16} F({:g}, {}) = {}, p = {}{}\n", named.name, named.test->df1,
                        number(named.test->df2, 3), number(named.test->statistic, 3),
                        chance(named.test->p), ofSpread ? "   (equal variances)" : "");
  }
  return text;
}

// The pair of `a` and `b` in a list of all.
const PairDifference& pairOf(const std::vector<PairDifference>& pairs, std::size_t a,
                             std::size_t b) {
  return *std::find_if(pairs.begin(), pairs.end(), [&](const PairDifference& pair) {
    return pair.first == std::min(a, b) && pair.second == std::max(a, b);
  });
}

// Wide enough for every name.
template <typename Named>
std::size_t nameWidth(const std::vector<Named>& all, std::size_t least) {
  for (const Named& one : all) least = std::max(least, one.name.size());
  return least;
}

std::string columnRows(const PathComparison& comparison, const TableComparison& table,
                       const std::vector<std::size_t>& models) {
  const double alpha = 1.0 - comparison.confidence;
  const auto differ = [&](const std::vector<PairDifference>& pairs) {
    return std::count_if(pairs.begin(), pairs.end(),
                         [&](const PairDifference& pair) { return pair.p < alpha; });
  };
  std::string text = fmt::format(
      "  pairs that differ at {:g}: Tukey {} and Games-Howell {} of {}; Tukey's interval +-{}\n",
      alpha, differ(table.columns.tukey), differ(table.columns.gamesHowell),
      table.columns.tukey.size(), number(table.columns.tukey.front().halfWidth, 2));
  const std::size_t width = nameWidth(comparison.paths, 10);
  for (std::size_t m = 0; m < std::min(models.size(), kModelsShown); ++m) {
    text += fmt::format("  {:<{}} {:>12}  Tukey  Games-Howell\n",
                        comparison.paths[models[m]].name + " against", width + 2, "difference");
    for (std::size_t i = 0; i < comparison.paths.size(); ++i) {
      if (i == models[m]) continue;
      const PairDifference& tukey = pairOf(table.columns.tukey, models[m], i);
      const PairDifference& howell = pairOf(table.columns.gamesHowell, models[m], i);
      const double difference = models[m] < i ? tukey.difference : -tukey.difference;
      text += fmt::format("    {:<{}} {:>12}  {:>5}  {:>12}\n", comparison.paths[i].name, width,
                          number(difference, 2), chance(tukey.p), chance(howell.p));
    }
  }
  if (models.size() > kModelsShown) {
    text += fmt::format("  ({} more in the CSV)\n", models.size() - kModelsShown);
  }
  return text;
}

std::string separationLines(const PathComparison& comparison, const TableComparison& table) {
  const std::string& people = comparison.groups.front().name;
  std::string text;
  for (std::size_t s = 0; s < table.separations.size(); ++s) {
    const Separation& found = table.separations[s];
    const PathGroup& group = comparison.groups[s + 1];
    text += fmt::format(
        "Group {}: is it farther from {} than those are from each other?\n"
        "  chance that a distance across exceeds one within: {:.3f} (0.5: like one more of them)\n"
        "  labels permuted: p = {} ({} {}; {:.2g} is the least it can give)\n"
        "  distances taken for independent, which they are not: p = {} (Mann-Whitney)\n",
        group.name, people, found.superiority, chance(found.p), found.exact ? "all" : "a sample of",
        count(found.labellings, "labelling"), found.leastP, chance(found.pairsP));
  }
  return text;
}

std::string groupLines(const PathComparison& comparison, const TableComparison& table) {
  if (!table.groups) return "";
  std::string text = fmt::format("Groups by their mean distances to {}, a sample per group:\n{}",
                                 comparison.groups.front().name, testLines(*table.groups));
  for (std::size_t i = 0; i < table.groups->tukey.size(); ++i) {
    const PairDifference& tukey = table.groups->tukey[i];
    const PairDifference& howell = table.groups->gamesHowell[i];
    text += fmt::format("  {} - {}: {} +- {}, Tukey {}; +- {}, Games-Howell {}\n",
                        comparison.groups[table.tested[tukey.first]].name,
                        comparison.groups[table.tested[tukey.second]].name,
                        number(tukey.difference, 3), number(tukey.halfWidth, 3), chance(tukey.p),
                        number(howell.halfWidth, 3), chance(howell.p));
  }
  return text;
}

Json jsonOf(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json jsonOf(const FTest& test) {
  return {{"statistic", jsonOf(test.statistic)},
          {"df1", test.df1},
          {"df2", jsonOf(test.df2)},
          {"p", jsonOf(test.p)}};
}

Json jsonOf(const std::vector<PairDifference>& pairs, const std::vector<std::string>& names) {
  Json list = Json::array();
  for (const PairDifference& pair : pairs) {
    list.push_back({{"first", names[pair.first]},
                    {"second", names[pair.second]},
                    {"difference", jsonOf(pair.difference)},
                    {"df", jsonOf(pair.df)},
                    {"q", jsonOf(pair.q)},
                    {"p", jsonOf(pair.p)},
                    {"half_width", jsonOf(pair.halfWidth)}});
  }
  return list;
}

Json jsonOf(const OneWayTests& tests, const std::vector<std::string>& names) {
  Json json;
  json["sum_of_squares"] = {{"between", jsonOf(tests.anova.between)},
                            {"within", jsonOf(tests.anova.within)}};
  for (const NamedTest& named : namedTests(tests)) json[named.key] = jsonOf(*named.test);
  json["tukey"] = jsonOf(tests.tukey, names);
  json["games_howell"] = jsonOf(tests.gamesHowell, names);
  return json;
}

std::vector<std::string> pathNames(const PathComparison& comparison) {
  std::vector<std::string> names;
  for (const ComparedPath& path : comparison.paths) names.push_back(path.name);
  return names;
}

std::vector<std::string> testedNames(const PathComparison& comparison,
                                     const TableComparison& table) {
  std::vector<std::string> names;
  for (const std::size_t group : table.tested) names.push_back(comparison.groups[group].name);
  return names;
}

const PathGroup& groupOf(const PathComparison& comparison, std::size_t path) {
  return *std::find_if(comparison.groups.begin(), comparison.groups.end(), [&](const PathGroup& g) {
    return std::binary_search(g.paths.begin(), g.paths.end(), path);
  });
}

void appendRows(std::string& csv, const std::string& start, const OneWayTests& tests,
                const std::vector<std::string>& names) {
  for (const NamedTest& named : namedTests(tests)) {
    csv +=
        fmt::format("{},{},,,{},{},{},{},,,,\n", start, named.key, exactly(named.test->statistic),
                    exactly(named.test->df1), exactly(named.test->df2), exactly(named.test->p));
  }
  for (const auto& [key, pairs] :
       {std::pair("tukey", &tests.tukey), std::pair("games_howell", &tests.gamesHowell)}) {
    for (const PairDifference& pair : *pairs) {
      csv += fmt::format("{},{},{},{},{},,{},{},{},{},,\n", start, key, quoted(names[pair.first]),
                         quoted(names[pair.second]), exactly(pair.q), exactly(pair.df),
                         exactly(pair.p), exactly(pair.difference), exactly(pair.halfWidth));
    }
  }
}

}  // namespace

std::string toText(const PathComparison& comparison) {
  std::string text = fmt::format("{} paths:", comparison.paths.size());
  std::vector<std::size_t> models;
  for (const PathGroup& group : comparison.groups) {
    text += fmt::format("{} {} of {}", &group == &comparison.groups.front() ? "" : ",",
                        group.paths.size(), group.name);
    if (&group != &comparison.groups.front()) {
      models.insert(models.end(), group.paths.begin(), group.paths.end());
    }
  }
  text += '\n';
  for (const TableComparison& table : comparison.tables) {
    const std::string unit = table.unit.empty() ? "" : fmt::format(", {}", table.unit);
    text += fmt::format("\n== {}{} ==\n{}{}", table.name, unit, separationLines(comparison, table),
                        groupLines(comparison, table));
    text +=
        fmt::format("Columns of the table, a sample per path (as Ono 2011; not independent):\n{}{}",
                    testLines(table.columns), columnRows(comparison, table, models));
  }
  text += fmt::format("\nMean distance to {}, other than the path itself\n",
                      comparison.groups.front().name);
  const std::size_t width = nameWidth(comparison.paths, 4);
  const std::size_t groupWidth = nameWidth(comparison.groups, 5);
  text += fmt::format("{:<{}}  {:<{}}", "path", width, "group", groupWidth);
  const bool fromFiles = !comparison.paths.front().points.empty();
  if (fromFiles) text += fmt::format(" {:>8} {:>9}", "samples", "length, m");
  for (const TableComparison& table : comparison.tables) text += fmt::format(" {:>12}", table.name);
  text += '\n';
  for (std::size_t i = 0; i < comparison.paths.size(); ++i) {
    const ComparedPath& path = comparison.paths[i];
    text +=
        fmt::format("{:<{}}  {:<{}}", path.name, width, groupOf(comparison, i).name, groupWidth);
    if (fromFiles) {
      text += fmt::format(" {:>8} {:>9.2f}", path.points.size(), agents::pathLength(path.points));
    }
    for (const TableComparison& table : comparison.tables) {
      text += fmt::format(" {:>12}", number(table.meanToPeople[i], table.unit == "m" ? 3 : 2));
    }
    text += '\n';
  }
  return text;
}

std::string toCsv(const PathComparison& comparison) {
  std::string csv =
      "table,over,test,first,second,statistic,df1,df2,p,difference,half_width,labellings,least_p\n";
  const std::vector<std::string> names = pathNames(comparison);
  for (const TableComparison& table : comparison.tables) {
    const std::string start = quoted(table.name);
    for (std::size_t s = 0; s < table.separations.size(); ++s) {
      const Separation& found = table.separations[s];
      const std::string who =
          quoted(comparison.groups[s + 1].name) + "," + quoted(comparison.groups.front().name);
      csv += fmt::format("{},paths,permutation,{},{},,,{},,,{},{}\n", start, who,
                         exactly(found.superiority), exactly(found.p), found.labellings,
                         exactly(found.leastP));
      csv += fmt::format("{},paths,mann_whitney,{},{},,,{},,,,\n", start, who,
                         exactly(found.superiority), exactly(found.pairsP));
    }
    if (table.groups) {
      appendRows(csv, start + ",groups", *table.groups, testedNames(comparison, table));
    }
    appendRows(csv, start + ",columns", table.columns, names);
  }
  return csv;
}

std::string toDistancesCsv(const PathComparison& comparison) {
  std::string csv = "table,from,from_group,to,to_group,distance\n";
  for (const TableComparison& table : comparison.tables) {
    for (std::size_t i = 0; i < comparison.paths.size(); ++i) {
      for (std::size_t j = i + 1; j < comparison.paths.size(); ++j) {
        csv +=
            fmt::format("{},{},{},{},{},{}\n", quoted(table.name), quoted(comparison.paths[i].name),
                        quoted(groupOf(comparison, i).name), quoted(comparison.paths[j].name),
                        quoted(groupOf(comparison, j).name), exactly(table.table.at(i, j)));
      }
    }
  }
  return csv;
}

std::string toJson(const PathComparison& comparison) {
  Json json;
  json["format"] = "forewalk.paths/1";
  json["confidence"] = comparison.confidence;
  if (comparison.spacing > 0.0) json["spacing"] = comparison.spacing;
  const std::vector<std::string> names = pathNames(comparison);
  json["paths"] = names;
  Json groups = Json::array();
  for (const PathGroup& group : comparison.groups) {
    Json members = Json::array();
    for (const std::size_t path : group.paths) members.push_back(names[path]);
    groups.push_back({{"name", group.name}, {"paths", members}});
  }
  json["groups"] = groups;
  Json details = Json::array();
  for (const ComparedPath& path : comparison.paths) {
    if (path.points.empty()) continue;
    details.push_back({{"name", path.name},
                       {"file", path.file},
                       {"walker", path.walker},
                       {"samples", path.points.size()},
                       {"length", agents::pathLength(path.points)}});
  }
  if (!details.empty()) json["walks"] = details;
  Json analyses = Json::array();
  for (const TableComparison& table : comparison.tables) {
    Json one;
    one["table"] = table.name;
    one["unit"] = table.unit;
    Json means = Json::array();
    for (const double mean : table.meanToPeople) means.push_back(jsonOf(mean));
    one["mean_distance_to_people"] = means;
    Json separations = Json::array();
    for (std::size_t s = 0; s < table.separations.size(); ++s) {
      const Separation& found = table.separations[s];
      separations.push_back({{"group", comparison.groups[s + 1].name},
                             {"superiority", found.superiority},
                             {"p", found.p},
                             {"least_p", found.leastP},
                             {"labellings", found.labellings},
                             {"exact", found.exact},
                             {"mann_whitney_p", found.pairsP}});
    }
    one["separation"] = separations;
    if (table.groups) one["groups"] = jsonOf(*table.groups, testedNames(comparison, table));
    one["columns"] = jsonOf(table.columns, names);
    analyses.push_back(one);
  }
  json["analyses"] = analyses;
  for (const TableComparison& table : comparison.tables) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < comparison.paths.size(); ++i) {
      Json row = Json::array();
      for (std::size_t j = 0; j < comparison.paths.size(); ++j) row.push_back(table.table.at(i, j));
      rows.push_back(row);
    }
    json[table.name] = rows;
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace forewalk::service
