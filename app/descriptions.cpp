/// \file The verbs that describe the others: completion and manual.

#include <fmt/format.h>

#include <memory>
#include <string>

#include "app/command_line.h"
#include "app/completion.h"
#include "app/manual.h"

namespace oktett {

void add_description_commands(CommandLine& line) {
  const auto shell = std::make_shared<std::string>();
  Verb completion =
      line.add_verb("completion", "Print a script that completes words for a shell", [&line, shell] {
        fmt::print("{}", completion_script(line.verbs(), *shell));
        return 0;
      });
  completion.positional("shell", *shell, "SHELL", "bash, zsh or fish");
  completion.footer("Use it at once: source <(oktett completion bash)");

  const auto verb = std::make_shared<std::string>();
  Verb manual = line.add_verb("manual", "Print a manual page as troff", [&line, verb] {
    fmt::print("{}", manual_page(line.verbs(), *verb));
    return 0;
  });
  manual.optional_positional("command", *verb, "COMMAND", "Whose page; without it that of oktett itself");
  manual.footer("Read it: oktett manual render | man -l -");
}

}  // namespace oktett
