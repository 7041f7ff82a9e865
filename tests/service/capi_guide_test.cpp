// service/capi/guide: every page's program is C99, and prints what the page says.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// What stands between ```LANGUAGE and ```; nothing where there is no such block.
std::optional<std::string> blockOf(const std::string& page, const std::string& language) {
  const std::string opening = "```" + language + "\n";
  const std::size_t begin = page.find(opening);
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t end = page.find("```", begin + opening.size());
  if (end == std::string::npos) return std::nullopt;
  return page.substr(begin + opening.size(), end - begin - opening.size());
}

struct Output {
  std::string text;
  int status = -1;
};

Output outputOf(const std::string& command) {
  Output output;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  char chunk[4096];
  while (const std::size_t got = std::fread(chunk, 1, sizeof chunk, pipe)) {
    output.text.append(chunk, got);
  }
  output.status = pclose(pipe);
  return output;
}

class CapiGuide : public ::testing::TestWithParam<const char*> {};

TEST_P(CapiGuide, SaysWhatItsProgramPrints) {
  const std::string name = GetParam();
  const std::string page =
      contentOf(fs::path(FOREWALK_SOURCE) / "service/capi/guide" / (name + ".md"));
  const auto program = blockOf(page, "c"), printed = blockOf(page, "text");
  ASSERT_TRUE(program && printed);
  // Where the program finds the scenes as from the project's root, and what it writes does no harm.
  const fs::path folder = fs::path(FOREWALK_WORK) / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::create_directory_symlink(fs::path(FOREWALK_SOURCE) / "assets", folder / "assets");
  std::ofstream(folder / "page.c", std::ios::binary) << *program;
  const Output built =
      outputOf(std::string(FOREWALK_C_COMPILER) +
               " -std=c99 -pedantic -Wall -Wextra -Werror -ffp-contract=off " + FOREWALK_C_FLAGS +
               " -I '" + FOREWALK_SOURCE + "/service/capi' '" + (folder / "page.c").string() +
               "' -o '" + (folder / "page").string() + "' '" + FOREWALK_LIBRARY + "' -Wl,-rpath,'" +
               fs::path(FOREWALK_LIBRARY).parent_path().string() + "' -lm");
  ASSERT_EQ(built.status, 0) << built.text;
  const Output ran = outputOf("cd '" + folder.string() + "' && ./page");
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.text, *printed) << "service/capi/guide/" << name << ".md";
}

INSTANTIATE_TEST_SUITE_P(Pages, CapiGuide,
                         ::testing::Values("navmesh", "session", "resets", "graph", "worlds",
                                           "spaces", "recording"),
                         [](const auto& page) { return std::string(page.param); });

}  // namespace
