// The Unity package: its laws under Mono, its structs against C's, its files and its page.
//
// The laws are in tests/service/unity, in C#, compiled with the package by Debian's mcs; `run`
// starts them. UnityEngine is a stand-in there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program_test.h"

namespace forewalk {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kPackage = FOREWALK_SOURCE "/service/unity";
const std::string kHeader = FOREWALK_SOURCE "/service/capi/forewalk.h";

struct UnityLaws : testing::ProgramTest {
  /// The law holds; what it printed is printed.
  void holds(const std::string& law) const {
    const testing::Outcome outcome = run(law);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::printf("%s", outcome.out.c_str());
  }
};

struct UnityRig : UnityLaws {};
struct UnitySample : UnityLaws {};

TEST_F(UnityLaws, HasDefaultsOfTheLibrary) { holds("defaults"); }
TEST_F(UnityLaws, EndsEachHandleOnce) { holds("handles"); }
TEST_F(UnityLaws, ReadsGraphsInPlaceUntilTheirFrameEnds) { holds("graph"); }
TEST_F(UnityLaws, ShowsPolygonsOnTheFloor) { holds("polygons"); }
TEST_F(UnityLaws, ThrowsTheSentencesOfTheLibrary) { holds("errors ."); }
TEST_F(UnityLaws, PassesOnWhatSessionsAreTold) { holds("calls"); }
TEST_F(UnityLaws, SharesRooms) { holds("spaces"); }
TEST_F(UnityLaws, WalksInWorldsThatMove) { holds("worlds"); }
TEST_F(UnityLaws, Records) { holds("record ."); }
TEST_F(UnityLaws, ListensToTheLog) { holds("log"); }
TEST_F(UnityLaws, LeavesNoGarbage) { holds("garbage"); }
TEST_F(UnityRig, PutsTheCameraAtTheVirtualPose) { holds("rig"); }
TEST_F(UnityRig, WaitsWhileTrackingIsLost) { holds("rig-lost"); }
TEST_F(UnityRig, BeginsAndEnds) { holds("rig-life"); }
TEST_F(UnityRig, BuildsFromTheMeshesOfTheScene) { holds("rig-scene ."); }
TEST_F(UnityRig, ShowsTheDefaultsOfTheLibrary) { holds("rig-defaults"); }
TEST_F(UnitySample, StaysInItsRoom) { holds("sample"); }

/// "name value" lines.
std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// A C program that prints what each name of the lines is in C.
std::string programFor(const std::vector<std::string>& lines) {
  std::string code =
      "#include <stddef.h>\n#include <stdio.h>\n#include \"forewalk.h\"\nint main(void) {\n";
  for (const std::string& line : lines) {
    const std::string name = line.substr(0, line.find(' '));
    const std::size_t dot = name.find('.');
    std::string value = name;
    if (dot != std::string::npos) {
      value = "offsetof(" + name.substr(0, dot) + ", " + name.substr(dot + 1) + ")";
    } else if (std::islower(static_cast<unsigned char>(name[0])) != 0) {
      value = "sizeof(" + name + ")";
    }
    code += "  printf(\"" + name + " %ld\\n\", (long)(" + value + "));\n";
  }
  return code + "  return 0;\n}\n";
}

// Every struct, field and constant of the header, which the C# program reads, so that what is added
// there is missed here.
TEST_F(UnityLaws, HasTheLayoutOfC) {
  const testing::Outcome ours = run("layout '" + kHeader + "'");
  ASSERT_EQ(ours.status, 0) << ours.err;
  EXPECT_THAT(ours.out, ::testing::Not(HasSubstr("missing")));
  const std::vector<std::string> lines = linesOf(ours.out);
  write("layout.c", programFor(lines));
  const std::string command = "cd '" + folder_.string() +
                              "' && " FOREWALK_CC " -I '" FOREWALK_SOURCE
                              "/service/capi' -o layout layout.c && ./layout >c.txt";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(ours.out, contents("c.txt"));
  const auto some = [&](const std::string& name) {
    return std::count_if(lines.begin(), lines.end(),
                         [&](const std::string& line) { return line.starts_with(name); });
  };
  std::printf("%td structs and fields, %td constants\n", some("forewalk_"), some("FOREWALK_"));
  EXPECT_GT(some("forewalk_"), 150);
  EXPECT_GT(some("FOREWALK_"), 90);
}

/// What Unity imports of a package: all files and folders but those it does not look into.
std::vector<fs::path> importedPaths(const fs::path& package) {
  std::vector<fs::path> paths;
  for (auto it = fs::recursive_directory_iterator(package); it != fs::end(it); ++it) {
    const std::string name = it->path().filename().string();
    if (name.ends_with("~")) {
      it.disable_recursion_pending();
    } else if (!name.ends_with(".meta")) {
      paths.push_back(it->path());
    }
  }
  return paths;
}

// Unity ignores what has no .meta in a package from git, and mixes up what shares a guid.
void expectMetaFiles(const fs::path& package) {
  std::set<std::string> guids;
  const std::regex guid("\nguid: ([0-9a-f]{32})\n");
  for (const fs::path& path : importedPaths(package)) {
    const std::string meta = testing::contentsOf(path.string() + ".meta");
    std::smatch match;
    ASSERT_TRUE(std::regex_search(meta, match, guid)) << path << " has no .meta with a guid";
    EXPECT_TRUE(guids.insert(match[1]).second) << path << " shares its guid";
    EXPECT_EQ(meta.find("folderAsset: yes") != std::string::npos, fs::is_directory(path)) << path;
  }
  EXPECT_GT(guids.size(), 20u);
  for (const auto& entry : fs::recursive_directory_iterator(package)) {
    if (entry.path().extension() != ".meta") continue;
    fs::path of = entry.path();
    EXPECT_TRUE(fs::exists(of.replace_extension(""))) << entry.path() << " is nobody's";
  }
}

TEST(UnityPackage, NamesEachOfItsFilesOnce) { expectMetaFiles(kPackage); }

// A stand-in for a library of another release.
TEST_F(UnityLaws, RefusesALibraryOfAnotherMajorVersion) {
  write("fake.c", "unsigned forewalk_version(void) { return 1 << 16 | 2 << 8 | 3; }\n");
  const std::string command =
      "cd '" + folder_.string() + "' && " FOREWALK_CC " -shared -fPIC -o libforewalk.so fake.c";
  ASSERT_EQ(std::system(command.c_str()), 0);
  setenv("UNITY_PLUGINS", folder_.c_str(), 1);
  const testing::Outcome outcome = run("defaults");
  unsetenv("UNITY_PLUGINS");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("version 1.2.3, this package speaks 0.1"));
}

// What the target unity_package does.
struct UnityTarball : UnityLaws {};

TEST_F(UnityTarball, BringsTheLibrary) {
  const std::string pack =
      FOREWALK_CMAKE " -DPACKAGE='" + kPackage +
      "' -DLIBRARY='" FOREWALK_LIBRARY "' -DLICENCE='" FOREWALK_SOURCE "/LICENSE' -DWORK='" +
      folder_.string() + "' -DVERSION=1.2.3 -P '" FOREWALK_SOURCE "/cmake/unity_package.cmake'";
  const std::string unpack = "mkdir '" + folder_.string() + "/got' && cd '" + folder_.string() +
                             "/got' && " FOREWALK_CMAKE
                             " -E tar xzf ../io.forewalk.unity-1.2.3.tgz";
  ASSERT_EQ(std::system((pack + " >/dev/null && " + unpack).c_str()), 0);
  const fs::path got = folder_ / "got" / "package";
  expectMetaFiles(got);
  EXPECT_TRUE(fs::exists(got / "Documentation~" / "forewalk.md"));
  EXPECT_TRUE(fs::exists(got / "LICENSE.md"));
  const fs::path library = got / "Runtime" / "Plugins" / "x86_64" / "libforewalk.so";
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(library)));
  setenv("UNITY_PLUGINS", library.parent_path().c_str(), 1);
  holds("defaults");
  // And only it: the law does not find another one.
  fs::remove(library);
  EXPECT_NE(run("defaults").status, 0);
  unsetenv("UNITY_PLUGINS");
}

TEST(UnityPackage, SaysWhatItIs) {
  const auto package = nlohmann::json::parse(testing::contentsOf(kPackage + "/package.json"));
  EXPECT_EQ(package.at("version"), FOREWALK_PROJECT_VERSION);
  EXPECT_EQ(package.at("name"), "io.forewalk.unity");
  for (const auto& sample : package.at("samples")) {
    EXPECT_TRUE(fs::is_directory(kPackage + "/" + sample.at("path").get<std::string>())) << sample;
  }
  // Assemblies by name, and what they refer to.
  std::set<std::string> names;
  std::vector<nlohmann::json> assemblies;
  for (const auto& entry : fs::recursive_directory_iterator(kPackage)) {
    if (entry.path().extension() != ".asmdef") continue;
    assemblies.push_back(nlohmann::json::parse(testing::contentsOf(entry.path())));
    EXPECT_EQ(assemblies.back().at("name"), entry.path().stem().string());
    EXPECT_TRUE(names.insert(assemblies.back().at("name")).second);
  }
  EXPECT_GE(names.size(), 3u);
  for (const auto& assembly : assemblies) {
    for (const auto& reference : assembly.value("references", nlohmann::json::array())) {
      EXPECT_TRUE(names.contains(reference)) << reference;
    }
  }
}

/// The blocks of C# on a page.
std::vector<std::string> examplesIn(const std::string& page) {
  std::vector<std::string> examples;
  const std::string text = testing::contentsOf(page), fence = "```csharp\n";
  for (std::size_t at = text.find(fence); at != std::string::npos; at = text.find(fence, at)) {
    at += fence.size();
    examples.push_back(text.substr(at, text.find("```", at) - at));
  }
  return examples;
}

// The page's scripts are whole files: they compile as they stand, and do what it says.
TEST_F(UnityLaws, HasAPageWhoseScriptsWork) {
  const std::vector<std::string> examples = examplesIn(kPackage + "/Documentation~/forewalk.md");
  EXPECT_EQ(examples.size(), 3u);
  std::string command = "cd '" + folder_.string() +
                        "' && " FOREWALK_MCS
                        " -langversion:7.2 -warnaserror -target:library -out:page.dll";
  for (const char* assembly : {"Forewalk", "Forewalk.Unity", "UnityEngine"}) {
    command += std::string(" -r:" FOREWALK_UNITY "/") + assembly + ".dll";
  }
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const std::string name = "Example" + std::to_string(i) + ".cs";
    write(name, examples[i]);
    command += " " + name;
  }
  ASSERT_EQ(std::system((command + " >said.txt 2>&1").c_str()), 0) << contents("said.txt");
  holds("page page.dll");
}

}  // namespace
}  // namespace forewalk
