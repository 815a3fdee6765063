#include "io/yaml/write_yaml.h"

#include <fmt/format.h>

#include <algorithm>

namespace oktett {
namespace {

/// Characters of a line.
constexpr std::size_t kWidth = 110;

bool is_plain(const std::string& text) {
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return false;
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '-' || c == '+' || c == '/';
  };
  return std::ranges::all_of(text, plain) && text[0] != '/' && (text[0] != '-' || text.size() > 1);
}

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (c == '\n')
      out += "\\n";
    else if (static_cast<unsigned char>(c) < ' ')
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + '"';
}

std::string scalar(const YamlNode& node) { return is_plain(node.text) ? node.text : in_quotes(node.text); }

bool is_leaf(const YamlNode& node) {
  return node.kind == YamlKind::null || node.kind == YamlKind::scalar || node.items.empty();
}

/// Appends a node in one line. Returns false once `out` is longer than `most`.
bool append_flow(const YamlNode& node, std::size_t most, std::string& out) {
  switch (node.kind) {
    case YamlKind::null:
      break;
    case YamlKind::scalar:
      out += scalar(node);
      break;
    case YamlKind::sequence:
      out += '[';
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        if (i > 0) out += ", ";
        if (!append_flow(*node.items[i], most, out)) return false;
      }
      out += ']';
      break;
    case YamlKind::map:
      out += '{';
      for (std::size_t i = 0; i + 1 < node.items.size(); i += 2) {
        if (i > 0) out += ", ";
        out += scalar(*node.items[i]) + ": ";
        if (!append_flow(*node.items[i + 1], most, out)) return false;
      }
      out += '}';
      break;
  }
  return out.size() <= most;
}

class Writer {
 public:
  std::string out;

  /// A node behind a key or a dash, from a line that has `column` characters.
  void value(const YamlNode& node, std::size_t column, std::size_t indent, bool behind_key, bool is_top) {
    std::string flow;
    const std::size_t most = kWidth > column + 12 ? kWidth - column : 12;
    if (is_leaf(node) || (append_flow(node, most, flow) && !is_top)) {
      if (flow.empty() || is_leaf(node)) flow = flow_text(node);
      if (behind_key && !flow.empty()) out += ' ';
      out += flow + '\n';
      return;
    }
    if (behind_key) out += '\n';
    block(node, indent, !behind_key, is_top);
  }

  /// The entries of a map or list; the first one stands in the line that is there if `first_here`.
  void block(const YamlNode& node, std::size_t indent, bool first_here, bool is_top) {
    const bool is_map = node.kind == YamlKind::map;
    for (std::size_t i = 0; i < node.items.size(); i += is_map ? 2 : 1) {
      if (i > 0 || !first_here) out.append(indent, ' ');
      if (is_map) {
        const std::string key = scalar(*node.items[i]);
        out += key + ':';
        const YamlNode& value_node = *node.items[i + 1];
        value(value_node, indent + key.size() + 1, indent + 2, true,
              is_top && (key == "objects" || key == "define" || key == "materials" || key == "lights"));
      } else {
        out += "- ";
        value(*node.items[i], indent + 2, indent + 2, false, false);
      }
    }
  }
};

}  // namespace

std::string flow_text(const YamlNode& node) {
  std::string out;
  append_flow(node, static_cast<std::size_t>(-1), out);
  return out;
}

std::string yaml_text(const YamlNode& root) {
  Writer writer;
  if (root.kind == YamlKind::map)
    writer.block(root, 0, true, true);
  else
    writer.value(root, 0, 0, false, false);
  return writer.out;
}

}  // namespace oktett
