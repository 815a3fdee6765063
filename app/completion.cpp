#include "app/completion.h"

#include <fmt/format.h>

#include "core/error.h"

namespace oktett {
namespace {

/// What a shell offers for the value of an option or for a word.
enum class Offer { nothing, choices, files, folders };

Offer offer_of(const OptionText& option) {
  if (!option.choices.empty()) return Offer::choices;
  for (const char* files : {"FILE", "SCENE|MESH", "FILM"})
    if (option.value.starts_with(files)) return Offer::files;
  return option.value == "DIR" ? Offer::folders : Offer::nothing;
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string verb_names(const std::vector<VerbText>& verbs) {
  std::vector<std::string> names;
  for (const VerbText& verb : verbs) names.push_back(verb.name);
  return joined(names, " ");
}

/// The word of a verb that stands without an option's name, if it has one.
const OptionText* positional_of(const VerbText& verb) {
  for (const OptionText& option : verb.options)
    if (option.positional) return &option;
  return nullptr;
}

std::string bash_offer(const OptionText& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return fmt::format("mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$cur\")",
                         joined(option.choices, " "));
    case Offer::files:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")";
    case Offer::folders:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")";
    case Offer::nothing:
      break;
  }
  return ":";
}

std::string bash_script(const std::vector<VerbText>& verbs) {
  std::string script =
      "# Completion of oktett for bash. Made by: oktett completion bash\n"
      "_oktett() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} verb= i\n"
      "  COMPREPLY=()\n"
      "  # --option=value comes as three words.\n"
      "  if [[ $cur == = ]]; then cur=\n"
      "  elif [[ $prev == = && $COMP_CWORD -ge 2 ]]; then prev=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  fi\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    if [[ ${COMP_WORDS[i]} != -* ]]; then verb=${COMP_WORDS[i]}; break; fi\n"
      "  done\n"
      "  case \"$verb $prev\" in\n";
  for (const VerbText& verb : verbs)
    for (const OptionText& option : verb.options) {
      if (!option.takes_value()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : option.names) patterns.push_back("'" + verb.name + " " + name + "'");
      script += fmt::format("    {}) {}; return ;;\n", joined(patterns, "|"), bash_offer(option));
    }
  script += "  esac\n  case $verb in\n";
  script += fmt::format("    '') mapfile -t COMPREPLY < <(compgen -W '{} --help --version' -- \"$cur\") ;;\n",
                        verb_names(verbs));
  for (const VerbText& verb : verbs) {
    std::vector<std::string> names;
    for (const OptionText& option : verb.options)
      if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
    const OptionText* word = positional_of(verb);
    script += fmt::format(
        "    {})\n"
        "      if [[ $cur == -* ]]; then mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$cur\")\n"
        "      else {}\n"
        "      fi ;;\n",
        verb.name, joined(names, " "), word == nullptr ? ":" : bash_offer(*word));
  }
  return script + "  esac\n}\ncomplete -F _oktett oktett\n";
}

/// Text inside [...] of a specification of zsh's _arguments, inside single quotes.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else if (c == '[' || c == ']' || c == ':' || c == '\\') {
      out += std::string("\\") + c;
    } else {
      out += c;
    }
  }
  return out;
}

std::string zsh_offer(const OptionText& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return "(" + joined(option.choices, " ") + ")";
    case Offer::files:
      return "_files";
    case Offer::folders:
      return "_files -/";
    case Offer::nothing:
      break;
  }
  return " ";
}

std::string zsh_script(const std::vector<VerbText>& verbs) {
  std::string script =
      "#compdef oktett\n"
      "# Completion of oktett for zsh. Made by: oktett completion zsh\n"
      "_oktett() {\n"
      "  if (( CURRENT == 2 )); then\n"
      "    local -a commands=(\n";
  for (const VerbText& verb : verbs)
    script += fmt::format("      '{}:{}'\n", verb.name, zsh_escaped(verb.help));
  script +=
      "    )\n"
      "    _describe -t commands command commands\n"
      "    _arguments '--help[Print help and exit]' '--version[Print the version and exit]'\n"
      "    return\n"
      "  fi\n"
      "  local verb=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $verb in\n";
  for (const VerbText& verb : verbs) {
    script += fmt::format("    {})\n      _arguments -s \\\n", verb.name);
    for (const OptionText& option : verb.options) {
      if (option.positional) continue;
      const std::string value =
          option.takes_value() ? fmt::format(":{}:{}", zsh_escaped(option.value), zsh_offer(option)) : "";
      // An option that may be repeated excludes nothing; others exclude all their names.
      const std::string excluded = option.repeated ? "*" : "(" + joined(option.names, " ") + ")";
      for (const std::string& name : option.names)
        script += fmt::format("        '{}{}{}[{}]{}' \\\n", excluded, name,
                              !option.takes_value()    ? ""
                              : name.starts_with("--") ? "="
                                                       : "+",
                              zsh_escaped(option.help), value);
    }
    const OptionText* word = positional_of(verb);
    script += word == nullptr
                  ? "        && return\n"
                  : fmt::format("        '{}{}:{}:{}'\n", word->repeated ? "*" : "1",
                                word->repeated ? "" : "", zsh_escaped(word->value), zsh_offer(*word));
    script += "      ;;\n";
  }
  return script + "  esac\n}\n_oktett \"$@\"\n";
}

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string fish_offer(const OptionText& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return " -x -a " + fish_quoted(joined(option.choices, " "));
    case Offer::files:
      return " -r -F";
    case Offer::folders:
      return " -x -a '(__fish_complete_directories)'";
    case Offer::nothing:
      break;
  }
  return " -x";
}

std::string fish_script(const std::vector<VerbText>& verbs) {
  std::string script =
      "# Completion of oktett for fish. Made by: oktett completion fish\n"
      "complete -c oktett -n __fish_use_subcommand -f\n"
      "complete -c oktett -n __fish_use_subcommand -l help -s h -d 'Print help and exit'\n"
      "complete -c oktett -n __fish_use_subcommand -l version -d 'Print the version and exit'\n";
  for (const VerbText& verb : verbs)
    script += fmt::format("complete -c oktett -n __fish_use_subcommand -a {} -d {}\n", verb.name,
                          fish_quoted(verb.help));
  for (const VerbText& verb : verbs) {
    const std::string condition =
        fmt::format("complete -c oktett -n '__fish_seen_subcommand_from {}'", verb.name);
    const OptionText* word = positional_of(verb);
    // Without this, files are offered.
    if (word == nullptr || offer_of(*word) == Offer::nothing) script += condition + " -f\n";
    if (word != nullptr && offer_of(*word) == Offer::choices)
      script += condition + " -f -a " + fish_quoted(joined(word->choices, " ")) + "\n";
    for (const OptionText& option : verb.options) {
      if (option.positional) continue;
      script += condition;
      for (const std::string& name : option.names)
        script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.takes_value()) script += fish_offer(option);
      script += " -d " + fish_quoted(option.help) + "\n";
    }
  }
  return script;
}

}  // namespace

std::string completion_script(const std::vector<VerbText>& verbs, const std::string& shell) {
  if (shell == "bash") return bash_script(verbs);
  if (shell == "zsh") return zsh_script(verbs);
  if (shell == "fish") return fish_script(verbs);
  throw Error("completion: unknown shell '" + shell + "'; expected bash, zsh or fish");
}

}  // namespace oktett
