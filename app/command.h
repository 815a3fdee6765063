#pragma once
/// \file The verbs of the command line. Each lives in a file of its own and adds itself to the parser.

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace oktett {

/// What the user asked for. A verb's parser sets `run`; that does the work and returns the exit status, or
/// throws.
struct Command {
  std::string line;  ///< as typed
  std::function<int()> run;
};

/// "oktett 1.2.3".
std::string program_version();

void add_render_command(CLI::App& app, Command& command);
void add_info_command(CLI::App& app, Command& command);
void add_verify_command(CLI::App& app, Command& command);

}  // namespace oktett
