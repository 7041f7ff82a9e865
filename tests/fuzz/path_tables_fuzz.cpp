// The reader of distance tables on any bytes; what it accepts has to survive the tests made of it.
#include <cmath>
#include <span>
#include <string>

#include "service/path_comparison.h"
#include "service/path_tables.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

namespace {

using namespace forewalk;

void checkTable(const service::NamedTable& named, std::size_t paths) {
  require(named.table.paths == paths && named.table.distances.size() == paths * paths,
          "a table has a row per path");
  for (std::size_t i = 0; i < paths; ++i) {
    require(named.table.at(i, i) == 0.0, "the diagonal is 0");
    for (std::size_t j = 0; j < paths; ++j) {
      require(std::isfinite(named.table.at(i, j)) && named.table.at(i, j) >= 0.0,
              "distances are finite and 0 or more");
    }
  }
}

bool isChance(double p) { return std::isnan(p) || (p >= 0.0 && p <= 1.0); }

void checkTests(service::PathTables tables) {
  std::vector<service::ComparedPath> rows;
  for (std::string& name : tables.paths) rows.push_back({std::move(name), {}, {}, {}, {}});
  auto groups = service::groupPaths(rows, {});
  if (!groups) return;  // two paths, and one is called "model"
  service::ComparisonSettings settings;
  settings.separation.draws = 100;
  const service::PathComparison comparison = service::comparePaths(
      std::move(rows), std::move(*groups), std::move(tables.tables), settings);
  for (const service::TableComparison& table : comparison.tables) {
    for (const agents::Separation& found : table.separations) {
      require(found.p > 0.0 && found.p <= 1.0 && found.superiority >= 0.0 &&
                  found.superiority <= 1.0 && isChance(found.pairsP),
              "chances are in [0, 1]");
    }
    require(isChance(table.columns.anova.test.p) && isChance(table.columns.welch.p) &&
                isChance(table.columns.brownForsythe.p) && isChance(table.columns.levene.p),
            "p is in [0, 1] or NaN");
    for (const auto* pairs : {&table.columns.tukey, &table.columns.gamesHowell}) {
      for (const agents::PairDifference& pair : *pairs) {
        require(isChance(pair.p), "p of a pair is in [0, 1] or NaN");
      }
    }
  }
  require(!service::toText(comparison).empty() && !service::toCsv(comparison).empty() &&
              !service::toJson(comparison).empty(),
          "there is something to say");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto tables =
      service::parsePathTables(std::as_bytes(std::span<const std::uint8_t>(data, size)), "fuzz");
  if (tables) {
    require(tables->paths.size() >= 2 && !tables->tables.empty(), "there is something to compare");
    for (const service::NamedTable& named : tables->tables) checkTable(named, tables->paths.size());
    if (tables->paths.size() <= 8) checkTests(std::move(*tables));
  } else {
    requireSentence(tables.error().message, "fuzz");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf(
      {R"({"paths": ["H1", "H2", "Model"], "test1": [[0, 2.5, 9], [2.5, 0, 1e3], [9, 1e3, 0]]})",
       R"({"paths": ["a", "b", "c", "d"], "source": "x", "t": [[0,1,2,3],[1,0,1,2],[2,1,0,1],[3,2,1,0]],
            "same": [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]})",
       R"({"paths": ["a", "b"], "t": [[0, 1e308], [1e308, 0]], "u": [[0, 1e-320], [1e-320, 0]]})"});
}
