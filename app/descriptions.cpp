/// \file The verbs that describe the others: completion and manual.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "core/error.h"

namespace oktett {

// ---- Manual pages for `man`, made from the descriptions of the verbs.

namespace {

/// Text whose characters mean themselves to troff. `bold` text keeps hyphens as they are typed.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool starts_line = out.empty() || out.back() == '\n';
    if (starts_line && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string heading(const std::string& name, const std::string& help) {
  return fmt::format(
      ".TH {} 1 \"\" \"{}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
      [&] {
        std::string upper = name;
        std::ranges::transform(upper, upper.begin(),
                               [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
        return escaped(upper);
      }(),
      escaped(program_version()), escaped(name), escaped(help));
}

std::string lower_first(std::string text) {
  if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = static_cast<char>(text[0] + 32);
  return text;
}

/// The tag of an option's paragraph: "-o, --outfile FILE".
std::string tag(const OptionText& option) {
  std::string text;
  for (const std::string& name : option.names) text += (text.empty() ? "" : ", ") + bold(name);
  if (option.takes_value()) text += " " + italic(option.value);
  return option.positional ? italic(option.value) : text;
}

std::string paragraphs(const VerbText& verb, bool positional) {
  std::string text;
  for (const OptionText& option : verb.options)
    if (option.positional == positional) text += ".TP\n" + tag(option) + "\n" + escaped(option.help) + ".\n";
  return text;
}

std::string synopsis(const VerbText& verb) {
  std::string text = ".SH SYNOPSIS\n" + bold("oktett " + verb.name) + " [" + italic("OPTIONS") + "]";
  for (const OptionText& option : verb.options)
    if (option.positional)
      text += option.required ? " " + italic(option.value) : " [" + italic(option.value) + "]";
  return text + "\n";
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n"
    ".TP\n0\nSuccess.\n"
    ".TP\n1\nA file could not be read or written, or the system refused memory or threads.\n"
    ".TP\n2\nThe command line or a file says something wrong.\n"
    ".TP\n3\nAn error of the program itself, or a finding of\n.BR \"oktett verify\" .\n"
    ".TP\n124\n.B \\-\\-timeout\nended the run; what was finished is kept.\n";

std::string verb_page(const std::vector<VerbText>& verbs, const VerbText& verb) {
  std::string page = heading("oktett-" + verb.name, lower_first(verb.help)) + synopsis(verb);
  page += ".SH DESCRIPTION\n" + escaped(verb.help) + ".\n";
  if (!verb.footer.empty()) page += ".PP\n" + escaped(verb.footer) + "\n";
  const std::string words = paragraphs(verb, true);
  page += words + ".SH OPTIONS\n" + paragraphs(verb, false) + kExitStatus + ".SH SEE ALSO\n.BR oktett (1)";
  for (const VerbText& other : verbs)
    if (other.name != verb.name) page += ",\n.BR " + escaped("oktett-" + other.name) + " (1)";
  return page + "\n";
}

std::string program_page(const std::vector<VerbText>& verbs) {
  std::string page = heading("oktett", "ray tracer for triangle meshes and exact surfaces");
  page += ".SH SYNOPSIS\n" + bold("oktett") + " " + italic("COMMAND") + " [" + italic("OPTIONS") + "]\n";
  page +=
      ".SH DESCRIPTION\nTraces rays in packets through one tree that holds large triangle meshes and exact "
      "surfaces:\nspheres, quadrics, tori, polynomials, implicit functions, combinations of solids, height "
      "fields, "
      "fractals\nand instances of all of them. Pictures are the same bits on every machine.\n.SH COMMANDS\n";
  for (const VerbText& verb : verbs)
    page += ".TP\n" + bold(verb.name) + "\n" + escaped(verb.help) + ". See\n.BR " +
            escaped("oktett-" + verb.name) + " (1).\n";
  page +=
      ".SH EXAMPLES\n"
      ".TP\n.B oktett render mesh.obj\nShows a mesh in a studio and writes mesh.png.\n"
      ".TP\n.B oktett render scene.yaml \\-o scene.exr\nRenders a scene with all its layers.\n"
      ".TP\n.B oktett examples whitted\nCopies an example scene to the current folder.\n"
      ".SH ENVIRONMENT\n"
      ".TP\n.B OKTETT_ISA\nThe instruction set to use: scalar, sse4.2, avx2, avx512 or neon.\n";
  page += kExitStatus;
  page += ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < verbs.size(); ++i)
    page += ".BR " + escaped("oktett-" + verbs[i].name) + (i + 1 < verbs.size() ? " (1),\n" : " (1)\n");
  return page;
}

}  // namespace

/// The page oktett(1), or oktett-VERB(1), as troff with the macros of man(7). Throws Error if there is no
/// such verb.
static std::string manual_page(const std::vector<VerbText>& verbs, const std::string& verb) {
  if (verb.empty()) return program_page(verbs);
  for (const VerbText& known : verbs)
    if (known.name == verb) return verb_page(verbs, known);
  std::vector<std::string> names;
  for (const VerbText& known : verbs) names.push_back(known.name);
  throw Error("manual: there is no command '" + verb + "'" + did_you_mean(verb, names));
}

// ---- Completion of words for shells, made from the descriptions of the verbs.

/// The shells that completion_script() knows.
inline constexpr const char* kShells[] = {"bash", "zsh", "fish"};

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

/// A script that the shell reads to complete the words after `oktett`. Throws Error for other shells.
static std::string completion_script(const std::vector<VerbText>& verbs, const std::string& shell) {
  if (shell == "bash") return bash_script(verbs);
  if (shell == "zsh") return zsh_script(verbs);
  if (shell == "fish") return fish_script(verbs);
  throw Error("completion: unknown shell '" + shell + "'; expected bash, zsh or fish");
}

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
