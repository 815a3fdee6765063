#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "app/limits.h"
#include "app/render_options.h"
#include "app/text.h"
#include "io/scene/check.h"

namespace oktett {
namespace {

struct CheckArguments {
  std::vector<std::string> files;
  LimitArguments limits;
  std::vector<std::string> definitions;
  std::string pov_files;
  bool strict = false;
};

/// Most findings that are printed for one file.
constexpr std::size_t kMostShown = 100;

std::string counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// Prints a finding. What follows its last semicolon, such as a list of all keys that are known, is left out
/// if it contains commas and `told` has it already: many findings of one file end with the same list.
void print_finding(const std::string& text, std::set<std::string>& told) {
  const std::size_t end = text.rfind("; ");
  const bool again = end != std::string::npos && text.find(", ", end) != std::string::npos &&
                     !told.insert(text.substr(end)).second;
  fmt::print("{}\n", printable(again ? text.substr(0, end) : text));
}

/// Prints what is wrong in a file. Returns the exit status for it.
int check(const std::string& path, const CheckArguments& arguments) {
  const Findings findings =
      check_file(path, parse_definitions(arguments.definitions), {kPovFilm, arguments.pov_files, say_as_is});
  const std::vector<SceneFinding>& list = findings.list;
  const std::size_t shown = std::min(list.size(), kMostShown);
  std::set<std::string> told;
  for (std::size_t i = 0; i < shown; ++i) print_finding(list[i].text, told);
  if (findings.has_more)
    fmt::print("... and more\n");
  else if (list.size() > shown)
    fmt::print("... and {} more\n", list.size() - shown);
  const auto count = [&](SceneFinding::Kind kind) {
    return static_cast<std::size_t>(std::ranges::count(list, kind, &SceneFinding::kind));
  };
  const std::size_t warnings = count(SceneFinding::Kind::warning), errors = list.size() - warnings;
  if (!list.empty())
    say("oktett: {}: {}{}, {}\n", path, findings.has_more ? "more than " : "", counted(errors, "error"),
        counted(warnings, "warning"));
  if (count(SceneFinding::Kind::io) > 0) return kExitIo;
  return errors > 0 || (arguments.strict && warnings > 0) ? kExitBadInput : 0;
}

int run_check(const CheckArguments& arguments) {
  apply_limits(arguments.limits);
  int status = 0;
  for (const std::string& path : arguments.files) {
    const int found = check(path, arguments);
    // A file that cannot be read counts more than one that is wrong.
    if (status != kExitIo && found != 0) status = found;
  }
  return status;
}

}  // namespace

void add_check_command(CommandLine& line) {
  const auto arguments = std::make_shared<CheckArguments>();
  Verb verb = line.add_verb("check", "Print all that is wrong in scene files, meshes and MTL files",
                            [arguments] { return run_check(*arguments); });
  verb.positionals("files", arguments->files, "FILE...", "Scene files (.yaml, .pov), meshes or .mtl files");
  verb.option("-D", &arguments->definitions, "k=v", "Define ${k} of the scene files; may be repeated");
  add_pov_files_option(verb, arguments->pov_files);
  verb.flag("--strict", arguments->strict, "Exit with 2 for warnings, too");
  add_limit_options(verb, arguments->limits);
}

}  // namespace oktett
