#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "app/command.h"
#include "core/error.h"

namespace oktett {

std::string program_version() { return "oktett " OKTETT_VERSION; }

namespace {

constexpr int kExitIo = 1;
constexpr int kExitBadInput = 2;
constexpr int kExitInternal = 3;

std::string joined(int argc, char** argv) {
  std::string line = "oktett";
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

/// The verb that was being parsed, or the program itself.
const CLI::App* current(const CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? &app : verbs.front();
}

/// The long option of `app` that is nearest to the mistyped word `typed`; empty if none is near.
std::string nearest_option(const CLI::App& app, const std::string& typed) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  std::vector<const char*> known;
  for (const std::string& name : names) known.push_back(name.c_str());
  return nearest_name(typed.substr(0, typed.find('=')), known.data(), known.size());
}

std::string nearest_verb(const CLI::App& app, const std::string& typed) {
  std::vector<const char*> known;
  const std::vector<const CLI::App*> verbs = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* verb : verbs) known.push_back(verb->get_name().c_str());
  return nearest_name(typed, known.data(), known.size());
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& verb = *current(app);
  const std::vector<std::string> extra = verb.remaining(true);
  if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError) || extra.empty()) {
    if (&verb != &app || app.remaining(true).empty()) return error.what();
  }
  const std::string typed = extra.empty() ? app.remaining(true).front() : extra.front();
  const bool option = typed.starts_with('-') && typed != "-";
  const std::string near = option          ? nearest_option(verb, typed)
                           : &verb == &app ? nearest_verb(app, typed)
                                           : "";
  const char* what = option ? "unknown option" : &verb == &app ? "unknown command" : "unexpected argument";
  return fmt::format("{} '{}'{}", what, typed, near.empty() ? "" : fmt::format("; did you mean '{}'?", near));
}

int usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* verb = current(app);
  const std::string help = verb == &app ? "oktett --help" : "oktett " + verb->get_name() + " --help";
  fmt::print(stderr, "oktett: {}\nRun '{}' for a list of what there is.\n", explain(app, error), help);
  return kExitBadInput;
}

/// An error with a location begins with it, so that editors can jump there.
void print_error(const Error& error) {
  const char* prefix = error.where().file.empty() ? "oktett: " : "";
  fmt::print(stderr, "{}{}\n", prefix, error.what());
}

int run(int argc, char** argv) {
  Command command;
  command.line = joined(argc, argv);
  CLI::App app("A data-oriented SIMD packet ray tracer for CPUs.", "oktett");
  app.set_version_flag("--version", program_version(), "Print the version and exit");
  app.require_subcommand(1);
  add_render_command(app, command);
  add_info_command(app, command);
  add_verify_command(app, command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
    return asked ? app.exit(error) : usage_error(app, error);
  }
  try {
    return command.run();
  } catch (const Error& error) {
    print_error(error);
    return error.kind() == ErrorKind::io ? kExitIo : kExitBadInput;
  }
}

}  // namespace
}  // namespace oktett

int main(int argc, char** argv) {
  try {
    return oktett::run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("oktett: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "oktett: internal error: %s\n", error.what());
  }
  return oktett::kExitInternal;
}
