// A program run beside the test, which ends with it.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

extern char** environ;

namespace forewalk::testing {

class Child {
 public:
  /// `arguments[0]` is the program. What it says on stdout is read with line(); stderr is the
  /// test's, or nothing where `quiet`.
  explicit Child(std::vector<std::string> arguments, bool quiet = true) {
    int pipe[2];
    if (::pipe2(pipe, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe[1], 1);
    if (quiet) posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (::posix_spawnp(&process_, argv[0], &actions, nullptr, argv.data(), environ) != 0) {
      process_ = -1;
    }
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[1]);
    out_ = ::fdopen(pipe[0], "r");
  }
  Child(Child&& other) noexcept
      : process_(std::exchange(other.process_, -1)), out_(std::exchange(other.out_, nullptr)) {}
  Child& operator=(Child&&) = delete;
  ~Child() {
    if (process_ > 0) {
      signal(SIGKILL);
      wait();
    }
    if (out_ != nullptr) std::fclose(out_);
  }

  bool running() const { return process_ > 0; }
  void signal(int number) const { ::kill(process_, number); }

  /// Waits for its end: its exit status, or minus the signal that ended it.
  int wait() {
    int status = 0;
    if (process_ <= 0 || ::waitpid(std::exchange(process_, -1), &status, 0) < 0) return -1000;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  /// The next line of its stdout, without its end; "" where there is none.
  std::string line() {
    std::array<char, 4096> text{};
    if (out_ == nullptr || std::fgets(text.data(), static_cast<int>(text.size()), out_) == nullptr)
      return "";
    std::string line = text.data();
    if (!line.empty() && line.back() == '\n') line.pop_back();
    return line;
  }

 private:
  pid_t process_ = -1;
  std::FILE* out_ = nullptr;
};

}  // namespace forewalk::testing
