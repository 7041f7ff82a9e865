// The forewalk program as a person or a script meets it: run in a folder of its own, with what it
// printed, left behind and gave as its exit status.
//
// For tests whose target knows the program as FOREWALK_PROGRAM (forewalk_program_test() in
// tests/service/tests.cmake).
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace forewalk::testing {

/// What one run of the program gave.
struct Outcome {
  int status;  ///< of its exit; -1 where a signal ended it
  std::string out, err;
};

/// All bytes of `file`; none where it cannot be read.
inline std::string contentsOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void writeTo(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// A refusal: the status, and one line that starts with the program's name and says `saying`.
inline void expectRefusal(const Outcome& outcome, int status, const std::string& saying) {
  EXPECT_EQ(outcome.status, status) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::StartsWith("forewalk: "));
  EXPECT_THAT(outcome.err, ::testing::HasSubstr(saying));
}

/// A folder for the test alone, made before and removed after it, in which the program runs.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("forewalk_" + std::string(test.test_suite_name()) + "_" + test.name() + "_" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  /// Runs the program to its end, without input; `arguments` as in a shell.
  Outcome run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" FOREWALK_PROGRAM "' " +
                                arguments + " >stdout.txt 2>stderr.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents("stdout.txt"),
            contents("stderr.txt")};
  }
  void refuses(const std::string& arguments, int status, const std::string& saying) const {
    SCOPED_TRACE(arguments);
    expectRefusal(run(arguments), status, saying);
  }

  // Files of the folder.
  std::string contents(const std::string& name) const { return contentsOf(folder_ / name); }
  void write(const std::string& name, const std::string& text) const {
    writeTo(folder_ / name, text);
  }

  std::filesystem::path folder_;
};

}  // namespace forewalk::testing
