// The readers of experiments on any bytes: plans, rows of results, manifests. What they accept
// keeps the promises of their ranges, and rows and manifests come back as they were.
#include "service/experiment/plan.h"
#include "service/experiment/results.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forewalk::service;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto plan =
      parseExperiment(std::as_bytes(std::span<const std::uint8_t>(data, size)), "fuzz");
  if (plan) {
    require(plan->runCount() >= 1 && plan->runCount() <= kMostRuns, "there are runs, not too many");
    for (const std::size_t run : {std::size_t{0}, plan->runCount() - 1}) {
      const auto chosen = plan->choicesOf(run);
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        require(chosen[axis] < plan->choices[axis].size(), "a run takes an entry of each list");
      }
      require(plan->simulationOf(chosen).is_object(), "a run is a simulation");
    }
  } else {
    requireSentence(plan.error().message, "fuzz");
  }
  if (const auto row = parseRow(text, "fuzz")) {
    const auto again = parseRow(lineOf(*row), "fuzz");
    require(again.has_value() && again->sameAs(*row), "a row comes back");
  } else {
    requireSentence(row.error().message, "fuzz");
  }
  if (const auto manifest = parseManifest(text, "fuzz")) {
    const auto again = parseManifest(manifestJson(*manifest), "fuzz");
    require(again.has_value() && *again == *manifest, "a manifest comes back");
  } else {
    requireSentence(manifest.error().message, "fuzz");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  using namespace forewalk::service;
  Row row;
  row.run = 3;
  row.users.resize(2);
  for (UserRow& user : row.users) {
    user.end = "metres";
    user.values[0] = 2.5;
    user.values[kMetrics - 1] = kNotMeasured;
  }
  together(row);
  Row failed;
  failed.end = "failed";
  failed.reason = "why";
  const Manifest manifest{
      "0.1.0", "{}", {{"office.obj", 17}}, {{"room", {{{0, 0}, {1, 0}, {0, 1}}}}}, 6, 2, 3};
  return seedsOf(
      {R"({"format": "forewalk.experiment/1", "name": "n", "walk": {"stop": {"seconds": 1}},
           "scenes": ["plane", {"name": "a", "scene": "a.obj"}], "seeds": [3, 5], "traces": "all",
           "rooms": ["b.txt", {"name": "c", "rectangle": [4, 4]}], "limits": ["toolkit"],
           "users": [{"name": "u", "kind": "legs", "count": 2, "share": "world"}], "controllers": ["none", "s2c"],
           "resets": ["r2g", {"name": "soft", "warning_s": 2}],
           "variants": [{"name": "v", "horizon_m": 5}]})",
       R"({"format": "forewalk.experiment/1", "seeds": 7})", lineOf(row), lineOf(failed),
       manifestJson(manifest)});
}
