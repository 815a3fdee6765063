#pragma once
/// \file Building the tree of a scene file out of another language, node by node, each with its place there.
/// Within io/ only.

#include <cstddef>
#include <deque>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"
#include "io/pov/document.h"
#include "io/yaml/yaml.h"

namespace oktett::pov {

/// A node that is being filled.
using Node = YamlNode*;

/// Makes nodes that stand in the files of a document.
class Tree {
 public:
  explicit Tree(const Document& document);
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  /// Text in quotes, such as a name.
  Node text(const Place& where, std::string_view text);
  /// A word of scene files, such as `true`.
  Node word(const Place& where, std::string_view text);
  Node flag(const Place& where, bool value) { return word(where, value ? "true" : "false"); }
  /// The shortest text that reads as `value` again.
  Node number(const Place& where, double value);
  Node numbers(const Place& where, std::span<const double> values);
  Node vector(const Place& where, const Vec3d& v);
  Node list(const Place& where);
  Node map(const Place& where);
  /// A map of one entry.
  Node map(const Place& where, std::string_view key, Node value);

  /// Adds an entry to a map, whose key has the place of the value.
  void put(Node map, std::string_view key, Node value);
  static void push(Node list, Node item) { list->items.push_back(item); }

  /// The file that nodes of the file `index` of the document stand in.
  YamlFile& file(std::uint32_t index) { return *files_[index]; }
  /// Gives up the nodes with their files.
  std::vector<std::unique_ptr<YamlFile>> take() { return std::move(files_); }

 private:
  Node create(const Place& where, YamlKind kind);

  std::vector<std::unique_ptr<YamlFile>> files_;
};

/// The value of an entry of a map, which may be replaced; null if there is none of this name.
const YamlNode** find_value(YamlNode& map, std::string_view key);
const YamlNode* find_value(const YamlNode& map, std::string_view key);
inline bool has_key(const YamlNode& map, std::string_view key) { return find_value(map, key) != nullptr; }

}  // namespace oktett::pov
