#include "app/manual.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/suggest.h"

namespace oktett {
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
      ".TP\n.B OKTETT_ISA\nThe instruction set to use: scalar, sse4.2, avx2 or avx512.\n";
  page += kExitStatus;
  page += ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < verbs.size(); ++i)
    page += ".BR " + escaped("oktett-" + verbs[i].name) + (i + 1 < verbs.size() ? " (1),\n" : " (1)\n");
  return page;
}

}  // namespace

std::string manual_page(const std::vector<VerbText>& verbs, const std::string& verb) {
  if (verb.empty()) return program_page(verbs);
  for (const VerbText& known : verbs)
    if (known.name == verb) return verb_page(verbs, known);
  std::vector<std::string> names;
  for (const VerbText& known : verbs) names.push_back(known.name);
  throw Error("manual: there is no command '" + verb + "'" + did_you_mean(verb, names));
}

}  // namespace oktett
