#pragma once
/// \file The words after `oktett`: verbs, their options, help texts and complaints. Only command_line.cpp
/// knows the library that parses them.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/error.h"

namespace CLI {
class App;
}

namespace oktett {

/// An option or word of a verb, for help in other forms than --help.
struct OptionText {
  std::vector<std::string>
      names;          ///< "-o", "--outfile"; of a word without a name only what it is called, "scene"
  std::string value;  ///< "FILE"; empty for flags
  std::string help;
  std::vector<std::string> choices;  ///< all that the value may be; empty if there are others
  bool positional = false;
  bool required = false;
  bool repeated = false;

  bool takes_value() const { return !positional && !value.empty(); }
};

struct VerbText {
  std::string name, help, footer;
  std::vector<OptionText> options;
};

/// The choices of options, by verb and names.
using OptionChoices = std::map<std::string, std::vector<std::string>>;

/// The variable that an option's value goes to. An option for a vector may be repeated.
using OptionTarget = std::variant<std::string*, unsigned*, std::uint64_t*, std::optional<std::uint32_t>*,
                                  std::vector<std::string>*>;

/// A verb, while its options are added. `names` are separated by commas, as in "-o,--outfile"; `value` is the
/// word for the option's value in the help text. Targets must live as long as the CommandLine.
class Verb {
 public:
  Verb(CLI::App& app, OptionChoices& choices) : app_(&app), choices_(&choices) {}

  void option(const char* names, OptionTarget target, const char* value, const char* help);
  /// An option for a whole number of 32 bits, of which the word is kept.
  void number(const char* names, std::string& target, const char* value, const char* help);
  /// An option for one of several words, which the help text lists after `help`.
  void choice(const char* names, std::string& target, const char* value, const char* help,
              std::vector<std::string> choices);
  /// A word that must be given and that no option's name precedes.
  void positional(const char* name, std::string& target, const char* value, const char* help);
  /// Such a word that may be missing.
  void optional_positional(const char* name, std::string& target, const char* value, const char* help);
  /// One or more such words.
  void positionals(const char* name, std::vector<std::string>& targets, const char* value, const char* help);
  /// Any number of such words, also none.
  void optional_positionals(const char* name, std::vector<std::string>& targets, const char* value,
                            const char* help);
  void flag(const char* names, bool& target, const char* help);
  /// A flag that may have a value, as in --stats=json. `names` ends with the value that the flag alone stands
  /// for, as in "--stats{text}".
  void flag(const char* names, std::string& target, const char* help);
  /// A flag that prints `text()` and ends the program, as --version does.
  void notice(const char* names, std::function<std::string()> text, const char* help);
  /// Text below the options in the verb's help.
  void footer(const char* text);

 private:
  CLI::App* app_;
  OptionChoices* choices_;
};

/// The names of all choices.
template <class T>
std::vector<std::string> names_of(std::span<const Choice<T>> choices) {
  std::vector<std::string> names;
  for (const Choice<T>& c : choices) names.push_back(c.name);
  return names;
}

/// The choice that `word`, the value of `option`, names. Throws Error if there is none.
template <class T>
T choice_of(const char* option, const std::string& word, std::span<const Choice<T>> choices) {
  for (const Choice<T>& c : choices)
    if (word == c.name) return c.value;
  const std::vector<std::string> names = names_of(choices);
  throw Error(std::string(option) + ": unknown kind '" + word + "'" +
              did_you_mean(word, names, "expected " + or_list(names)));
}

class CommandLine {
 public:
  CommandLine(int argc, char** argv);
  /// The words after `oktett`.
  explicit CommandLine(std::vector<std::string> words);
  ~CommandLine();

  /// `run` does the verb's work after the options are set, and returns the program's exit status.
  Verb add_verb(const char* name, const char* help, std::function<int()> run);
  /// Reads the words. Returns nothing if run() is to follow. Otherwise the program ends with the status
  /// returned: help or the version was asked for and has been printed, or a complaint has been.
  std::optional<int> parse();
  /// Reads the words without printing anything; false if that cannot be done.
  bool read();
  /// Complains that the word `name` of the verb is missing; the exit status.
  int missing(const char* name) const;
  int run() const { return run_(); }

  /// All words as they were typed.
  std::string text() const;
  /// All verbs in the order in which they were added.
  std::vector<VerbText> verbs() const;
  /// The same without the name of the program.
  const std::vector<std::string>& words() const { return words_; }

 private:
  std::vector<std::string> words_;
  std::unique_ptr<CLI::App> app_;
  OptionChoices choices_;
  std::function<int()> run_;
};

/// "oktett 1.2.3".
std::string program_version();

// The verbs, each in a file of its own.
void add_render_command(CommandLine& line);
void add_view_command(CommandLine& line);
void add_info_command(CommandLine& line);
void add_check_command(CommandLine& line);
void add_convert_command(CommandLine& line);
void add_merge_command(CommandLine& line);
void add_verify_command(CommandLine& line);
void add_examples_command(CommandLine& line);
void add_embree_command(CommandLine& line);
/// `completion` and `manual`, which describe the verbs that `line` has.
void add_description_commands(CommandLine& line);

/// Exit status for files that cannot be read or written, and for what the system refuses: memory, threads.
inline constexpr int kExitIo = 1;
/// Exit status for wrong words and for files that say something wrong.
inline constexpr int kExitBadInput = 2;
/// Exit status for errors of the program itself, and for what `verify` finds.
inline constexpr int kExitInternal = 3;

}  // namespace oktett
