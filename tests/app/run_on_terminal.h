#pragma once
/// \file Runs the oktett command on a terminal, as a user would.

#include <fcntl.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/app/run_command.h"

namespace oktett::test {

/// A pseudo terminal and what the command finds there.
struct TerminalSetting {
  unsigned short columns = 80, rows = 24;
  unsigned short cell_width = 8, cell_height = 16;  ///< in pixels; 0: the terminal does not tell
  bool out = true, err = true;                      ///< which streams are the terminal
  /// NAME=VALUE or NAME, which is unset.
  std::vector<std::string> environment;
};

struct TerminalResult {
  bool there = false;  ///< this system has terminals
  int status = 0;
  std::string text;   ///< what came to the terminal, byte by byte
  std::string other;  ///< what came to a stream that is not the terminal
};

inline TerminalResult run_on_terminal(const TempDir& directory, std::vector<std::string> arguments,
                                      const TerminalSetting& setting = {}) {
  TerminalResult result;
  int terminal = -1, side = -1;
  winsize size{setting.rows, setting.columns, 0, 0};
  size.ws_xpixel = static_cast<unsigned short>(setting.columns * setting.cell_width);
  size.ws_ypixel = static_cast<unsigned short>(setting.rows * setting.cell_height);
  if (openpty(&terminal, &side, nullptr, nullptr, &size) != 0) return result;
  result.there = true;
  termios raw{};
  tcgetattr(side, &raw);
  cfmakeraw(&raw);
  tcsetattr(side, TCSANOW, &raw);
  arguments.insert(arguments.begin(), OKTETT_COMMAND);
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  const TempDir output;
  const std::string other = output.file("other");
  const pid_t process = fork();
  if (process == 0) {
    const int file = open(other.c_str(), O_WRONLY | O_CREAT, 0600);
    if (chdir(directory.path().c_str()) != 0 || dup2(setting.out ? side : file, 1) < 0 ||
        dup2(setting.err ? side : file, 2) < 0)
      _exit(126);
    close(terminal), close(side);
    for (const std::string& entry : setting.environment) {
      const std::size_t sign = entry.find('=');
      unsetenv(entry.substr(0, sign).c_str());
      if (sign != std::string::npos) setenv(entry.substr(0, sign).c_str(), entry.c_str() + sign + 1, 1);
    }
    execv(words[0], words.data());
    _exit(127);
  }
  close(side);
  char bytes[4096];
  // Ends with an error when the last writer is gone.
  for (ssize_t n; (n = read(terminal, bytes, sizeof bytes)) > 0;)
    result.text.append(bytes, static_cast<std::size_t>(n));
  close(terminal);
  int status = 0;
  waitpid(process, &status, 0);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.other = file_content(other);
  return result;
}

}  // namespace oktett::test
