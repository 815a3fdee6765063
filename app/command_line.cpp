#include "app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include "app/text.h"
#include "core/error.h"

namespace oktett {

std::string program_version() { return "oktett " OKTETT_VERSION; }

namespace {

/// The verb that was being parsed, or the program itself.
const CLI::App* current(const CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? &app : verbs.front();
}

/// The hint for the mistyped word `typed` to the long option of `app` that is nearest.
std::string suggest_option(const CLI::App& app, const std::string& typed) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return did_you_mean(typed.substr(0, typed.find('=')), names);
}

std::string suggest_verb(const CLI::App& app, const std::string& typed) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return did_you_mean(typed, names);
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& verb = *current(app);
  const std::vector<std::string> extra = verb.remaining(true);
  if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError) || extra.empty()) {
    if (&verb != &app || app.remaining(true).empty()) return error.what();
  }
  const std::string typed = extra.empty() ? app.remaining(true).front() : extra.front();
  const bool option = typed.starts_with('-') && typed != "-";
  const std::string hint = option          ? suggest_option(verb, typed)
                           : &verb == &app ? suggest_verb(app, typed)
                                           : "";
  const char* what = option ? "unknown option" : &verb == &app ? "unknown command" : "unexpected argument";
  return fmt::format("{} '{}'{}", what, typed, hint);
}

int usage_error(const CLI::App& app, const std::string& explanation) {
  const CLI::App* verb = current(app);
  const std::string help = verb == &app ? "oktett --help" : "oktett " + verb->get_name() + " --help";
  say("oktett: {}\nRun '{}' for a list of what there is.\n", explanation, help);
  return kExitBadInput;
}

/// For options that take a word. An empty one would count as if the option were not there.
std::string is_not_empty(const std::string& value) {
  return value.empty() ? "expected a value, found nothing" : "";
}

/// For options that take a whole number. The library takes a leading 0 for the sign of octal, so that frame
/// 0010 would be frame 8, and its complaint does not say what it expected.
template <class T>
CLI::Validator whole_number() {
  return {[](std::string& value) -> std::string {
            T number{};
            const char* const end = value.data() + value.size();
            const auto [stop, error] = std::from_chars(value.data(), end, number);
            if (error != std::errc() || stop != end)
              return fmt::format("expected a whole number from 0 to {}, found '{}'",
                                 std::numeric_limits<T>::max(), value);
            value = std::to_string(number);
            return {};
          },
          ""};
}

/// Where the choices of an option are kept.
std::string choices_key(const CLI::App& verb, const CLI::Option& option) {
  return verb.get_name() + " " + option.get_name(false, true);
}

OptionText describe(const CLI::App& verb, const CLI::Option& option, const OptionChoices& choices) {
  OptionText text;
  text.positional = option.get_positional();
  if (text.positional) {
    text.names = {option.get_name(true, false)};
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  // Flags may have a type too, but take no words.
  if (option.get_items_expected_max() > 0) text.value = option.get_type_name();
  text.help = option.get_description();
  text.required = option.get_required();
  text.repeated = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll ||
                  option.get_items_expected_max() > 1;
  const auto known = choices.find(choices_key(verb, option));
  if (known != choices.end()) text.choices = known->second;
  return text;
}

}  // namespace

void Verb::option(const char* names, OptionTarget target, const char* value, const char* help) {
  std::visit(
      [&](auto* variable) {
        CLI::Option* option = app_->add_option(names, *variable, help)->type_name(value);
        if constexpr (std::is_same_v<decltype(variable), std::string*>) option->check(is_not_empty);
        if constexpr (std::is_same_v<decltype(variable), unsigned*>)
          option->transform(whole_number<unsigned>());
        if constexpr (std::is_same_v<decltype(variable), std::uint64_t*>)
          option->transform(whole_number<std::uint64_t>());
        if constexpr (std::is_same_v<decltype(variable), std::optional<std::uint32_t>*>)
          option->transform(whole_number<std::uint32_t>());
        if constexpr (std::is_same_v<decltype(variable), std::vector<std::string>*>)
          option->allow_extra_args(false);
      },
      target);
}

void Verb::number(const char* names, std::string& target, const char* value, const char* help) {
  app_->add_option(names, target, help)->type_name(value)->transform(whole_number<std::uint32_t>());
}

void Verb::choice(const char* names, std::string& target, const char* value, const char* help,
                  std::vector<std::string> choices) {
  const std::string text = fmt::format("{}: {}", help, or_list(choices));
  option(names, &target, value, text.c_str());
  (*choices_)[choices_key(*app_, *app_->get_options().back())] = std::move(choices);
}

void Verb::positional(const char* name, std::string& target, const char* value, const char* help) {
  app_->add_option(name, target, help)->required()->type_name(value);
}

void Verb::optional_positional(const char* name, std::string& target, const char* value, const char* help) {
  app_->add_option(name, target, help)->type_name(value);
}

void Verb::positionals(const char* name, std::vector<std::string>& targets, const char* value,
                       const char* help) {
  app_->add_option(name, targets, help)->required()->type_name(value);
}

void Verb::optional_positionals(const char* name, std::vector<std::string>& targets, const char* value,
                                const char* help) {
  app_->add_option(name, targets, help)->type_name(value);
}

void Verb::flag(const char* names, bool& target, const char* help) { app_->add_flag(names, target, help); }

void Verb::flag(const char* names, std::string& target, const char* help) {
  app_->add_flag(names, target, help);
}

void Verb::notice(const char* names, std::function<std::string()> text, const char* help) {
  const auto print = [text = std::move(text)](std::int64_t) {
    fmt::print("{}", text());
    throw CLI::Success();
  };
  app_->add_flag_function(names, print, help)->trigger_on_parse();
}

void Verb::footer(const char* text) { app_->footer(text); }

CommandLine::CommandLine(int argc, char** argv)
    : CommandLine(std::vector<std::string>(argv + std::min(argc, 1), argv + argc)) {}

CommandLine::CommandLine(std::vector<std::string> words)
    : words_(std::move(words)),
      app_(std::make_unique<CLI::App>("A data-oriented SIMD packet ray tracer for CPUs.", "oktett")) {
  app_->set_version_flag("--version", program_version(), "Print the version and exit");
  app_->require_subcommand(1);
  app_->footer(
      "Examples:\n"
      "  oktett render mesh.obj                      a mesh alone, in a studio, to mesh.png\n"
      "  oktett render scene.yaml -o scene.exr       a scene, with all layers\n"
      "  oktett render scene.yaml --size 320x180 --spp 1\n"
      "  oktett examples whitted                     copies an example here\n"
      "  oktett info scene.yaml                      what is in it\n"
      "Each command has its own help: oktett render --help.");
}

CommandLine::~CommandLine() = default;

Verb CommandLine::add_verb(const char* name, const char* help, std::function<int()> run) {
  CLI::App* verb = app_->add_subcommand(name, help);
  verb->footer("");
  verb->set_version_flag("--version", program_version(), "Print the version and exit");
  verb->callback([this, run = std::move(run)] { run_ = run; });
  return Verb(*verb, choices_);
}

std::optional<int> CommandLine::parse() {
  try {
    // The library takes words from the back.
    app_->parse(std::vector<std::string>(words_.rbegin(), words_.rend()));
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
    return asked ? app_->exit(error) : usage_error(*app_, explain(*app_, error));
  }
}

bool CommandLine::read() {
  try {
    app_->parse(std::vector<std::string>(words_.rbegin(), words_.rend()));
    return true;
  } catch (const CLI::ParseError&) {
    return false;
  }
}

int CommandLine::missing(const char* name) const {
  return usage_error(*app_, fmt::format("{} is required", name));
}

std::string CommandLine::text() const {
  std::string line = "oktett";
  for (const std::string& word : words_) line += " " + word;
  return line;
}

std::vector<VerbText> CommandLine::verbs() const {
  std::vector<VerbText> verbs;
  const CLI::App& app = *app_;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    VerbText text{verb->get_name(), verb->get_description(), verb->get_footer(), {}};
    for (const CLI::Option* option : verb->get_options())
      text.options.push_back(describe(*verb, *option, choices_));
    verbs.push_back(std::move(text));
  }
  return verbs;
}

}  // namespace oktett
