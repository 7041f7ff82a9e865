// The example of agents/evaluation/README.md, compiled and run; the last test sees that the two
// stay equal.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/support/readme.h"

// clang-format off
#include "agents/evaluation/dtw.h"
#include "agents/evaluation/separation.h"

using namespace forewalk;

// How often the last of these paths is farther from the others than they are from each other: about 0.5
// for one more person, 1 for a stranger.
double strangenessOfTheLast(const std::vector<std::vector<glm::dvec2>>& paths) {
  agents::DistanceTable table = agents::makeDistanceTable(paths.size());
  std::vector<std::size_t> people;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      table.at(i, j) = table.at(j, i) = agents::normalisedDtw(paths[i], paths[j], 0.1);
    }
    if (i + 1 < paths.size()) people.push_back(i);
  }
  const std::size_t last[] = {paths.size() - 1};
  return agents::separation(table, people, last).superiority;
}
// clang-format on

namespace {

TEST(EvaluationReadme, TellsAStrangerFromOneMore) {
  const auto walk = [](double aside) {
    return std::vector<glm::dvec2>{{0.0, 0.0}, {2.0, aside}, {4.0, 0.0}};
  };
  EXPECT_EQ(strangenessOfTheLast({walk(0.1), walk(0.2), walk(0.35), walk(-3.0)}), 1.0);
  EXPECT_LT(strangenessOfTheLast({walk(0.1), walk(0.2), walk(0.35), walk(0.18)}), 0.5);
}

TEST(EvaluationReadme, ShowsTheExampleThatIsCompiledHere) {
  using forewalk::testing::contentsOf;
  EXPECT_THAT(contentsOf(FOREWALK_SOURCE "/tests/agents/evaluation/evaluation_readme_test.cpp"),
              ::testing::HasSubstr(forewalk::testing::firstExampleIn(
                  FOREWALK_SOURCE "/agents/evaluation/README.md")));
}

}  // namespace
