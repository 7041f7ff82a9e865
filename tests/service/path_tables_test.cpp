#include "service/path_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>

namespace forewalk::service {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

tl::expected<PathTables, Error> parse(const std::string& text) {
  return parsePathTables(std::as_bytes(std::span(text)), "t.json");
}

std::string refusal(const std::string& text) {
  const auto tables = parse(text);
  return tables ? "accepted" : tables.error().message;
}

TEST(ParsePathTables, ReadsEveryTableAndLeavesTheRestAlone) {
  const auto tables = parse(
      R"({"paths": ["a", "b"], "second": [[0, 2.5], [2.5, 0]], "first": [[0, 1], [1, 0]],
          "source": "a person", "list": [1, 2], "none": [], "deep": {"x": [[1]]}})");
  ASSERT_TRUE(tables) << tables.error().message;
  EXPECT_EQ(tables->paths, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(tables->tables.size(), 2u);
  EXPECT_EQ(tables->tables[0].name, "first");
  EXPECT_EQ(tables->tables[1].table.at(1, 0), 2.5);
  EXPECT_EQ(tables->tables[1].table.at(1, 1), 0.0);
}

TEST(ParsePathTables, SaysWhereAndWhat) {
  EXPECT_THAT(refusal("{"), StartsWith("t.json:1: not valid JSON"));
  EXPECT_THAT(refusal(""), StartsWith("t.json"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("no JSON object"));
  EXPECT_THAT(refusal(R"({"t": [[0]]})"), HasSubstr("no list \"paths\""));
  EXPECT_THAT(refusal(R"({"paths": ["a"], "t": [[0]]})"),
              HasSubstr("names 1 path; two are needed"));
  EXPECT_THAT(refusal(R"({"paths": ["a", 3], "t": []})"), HasSubstr("paths[1] is no name"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "a"]})"), HasSubstr("two paths are named \"a\""));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": 7})"), HasSubstr("holds no table"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, 1]]})"),
              AllOf(HasSubstr("table \"t\""), HasSubstr("1 rows for 2 paths")));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, 1], [1]]})"),
              HasSubstr("row 2 has 1 distances for 2 paths"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, 1], 5]})"), HasSubstr("row 2 has 0"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, -1], [-1, 0]]})"),
              HasSubstr("row 1, column 2 is -1, not a distance"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, null], [1, 0]]})"),
              HasSubstr("no number"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, 1], [1, 0.5]]})"),
              HasSubstr("row 2, column 2 is 0.5; a path is 0 from itself"));
  EXPECT_THAT(refusal(R"({"paths": ["a", "b"], "t": [[0, 1], [1.1, 0]]})"),
              HasSubstr("row 2, column 1 is 1.1, but row 1, column 2 is 1"));
  std::string many = R"({"paths": ["0")";
  for (int i = 1; i <= 1000; ++i) many += ", \"" + std::to_string(i) + "\"";
  EXPECT_THAT(refusal(many + "]}"), HasSubstr("names 1001 paths, 1000 at most"));
}

}  // namespace
}  // namespace forewalk::service
