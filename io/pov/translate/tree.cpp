#include "io/pov/translate/tree.h"

#include <fmt/format.h>

#include <algorithm>

namespace oktett::pov {

Tree::Tree(const Document& document) {
  for (const std::string& path : document.files) {
    files_.push_back(std::make_unique<YamlFile>());
    files_.back()->path = path;
  }
  if (files_.empty()) files_.push_back(std::make_unique<YamlFile>());
}

Node Tree::create(const Place& where, YamlKind kind) {
  YamlFile& file = *files_[std::min<std::size_t>(where.file, files_.size() - 1)];
  YamlNode& node = file.nodes.emplace_back();
  node.file = &file;
  node.kind = kind;
  node.line = where.line, node.column = where.column;
  return &node;
}

Node Tree::word(const Place& where, std::string_view text) {
  const Node node = create(where, YamlKind::scalar);
  node->text = text;
  return node;
}

Node Tree::text(const Place& where, std::string_view text) {
  const Node node = create(where, YamlKind::scalar);
  // What stands for a parameter of scene files elsewhere.
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "${") node->text += '$';
    node->text += text[i];
  }
  node->quoted = true;
  return node;
}

Node Tree::number(const Place& where, double value) {
  return word(where, value == 0 ? "0" : fmt::format("{}", value));
}

Node Tree::numbers(const Place& where, std::span<const double> values) {
  const Node node = list(where);
  for (const double value : values) push(node, number(where, value));
  return node;
}

Node Tree::vector(const Place& where, const Vec3d& v) {
  return numbers(where, std::initializer_list<double>{v.x, v.y, v.z});
}

Node Tree::list(const Place& where) { return create(where, YamlKind::sequence); }
Node Tree::map(const Place& where) { return create(where, YamlKind::map); }

Node Tree::map(const Place& where, std::string_view key, Node value) {
  const Node node = map(where);
  put(node, key, value);
  return node;
}

void Tree::put(Node map, std::string_view key, Node value) {
  const Node name = create({}, YamlKind::scalar);
  name->file = value->file, name->line = value->line, name->column = value->column;
  name->text = key;
  map->items.push_back(name), map->items.push_back(value);
}

const YamlNode** find_value(YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; i + 1 < map.items.size(); i += 2)
    if (map.items[i]->text == key) return &map.items[i + 1];
  return nullptr;
}

const YamlNode* find_value(const YamlNode& map, std::string_view key) {
  for (std::size_t i = 0; i + 1 < map.items.size(); i += 2)
    if (map.items[i]->text == key) return map.items[i + 1];
  return nullptr;
}

}  // namespace oktett::pov
