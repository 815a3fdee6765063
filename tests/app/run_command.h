#pragma once
/// \file Runs the oktett command as a user would.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temp_dir.h"

namespace oktett::test {

/// A scene file: a sphere of radius 1 before the camera, 16x12 pixels, one sample each.
inline constexpr const char* kBall =
    "oktett: 1\n"
    "film: {width: 16, height: 12}\n"
    "integrator: {samples: 1}\n"
    "camera: {from: [0, 0, 5], at: [0, 0, 0]}\n"
    "objects:\n"
    "  - sphere: {radius: 1}\n";

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A running command whose output goes to files in a directory of its own.
class CommandProcess {
 public:
  /// Starts `program ARGUMENTS...` in `directory`.
  CommandProcess(const TempDir& directory, std::vector<std::string> arguments,
                 const std::string& program = OKTETT_COMMAND) {
    std::vector<char*> words;
    arguments.insert(arguments.begin(), program);
    for (std::string& word : arguments) words.push_back(word.data());
    words.push_back(nullptr);
    const std::string out = output_.file("out"), err = output_.file("err");
    process_ = fork();
    if (process_ != 0) return;
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT, 0600),
              err_file = open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    if (chdir(directory.path().c_str()) != 0 || dup2(out_file, 1) < 0 || dup2(err_file, 2) < 0) _exit(126);
    execv(words[0], words.data());
    _exit(127);
  }
  ~CommandProcess() {
    if (process_ > 0 && !waited_) {
      kill(process_, SIGKILL);
      wait();
    }
  }
  CommandProcess(const CommandProcess&) = delete;
  CommandProcess& operator=(const CommandProcess&) = delete;

  void send(int signal) const { kill(process_, signal); }
  std::string out() const { return file_content(output_.file("out")); }
  std::string err() const { return file_content(output_.file("err")); }

  /// Waits until `text` is on stderr; false after `seconds`.
  bool wait_for_err(const std::string& text, double seconds) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      if (err().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  /// Waits for the end. The exit status, or minus the signal that ended it.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    waited_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  TempDir output_;
  pid_t process_ = -1;
  bool waited_ = false;
};

struct CommandResult {
  int status = 0;
  std::string out, err;
};

inline CommandResult run_command(const TempDir& directory, const std::vector<std::string>& arguments,
                                 const std::string& program = OKTETT_COMMAND) {
  CommandProcess process(directory, arguments, program);
  CommandResult result;
  result.status = process.wait();
  result.out = process.out();
  result.err = process.err();
  return result;
}

}  // namespace oktett::test
