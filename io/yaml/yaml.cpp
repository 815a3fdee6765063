#include "io/yaml/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <limits>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "io/text/file_content.h"
#include "io/text/files.h"
#include "io/yaml/error_list.h"
#include "io/yaml/scene_limits.h"
#include "io/yaml/utf8.h"

namespace oktett {
namespace {

/// Builds the tree from the parser's events. Throwing from an event also stops yaml-cpp's own recursion,
/// since every level of it reports its start before it descends.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(YamlFile& file, std::size_t max_nodes)
      : file_(file), columns_(file.text), max_nodes_(max_nodes) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (file_.root) fail(mark, "a second document starts here; a scene file holds one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlNode& node = create(YamlKind::null, mark, "", anchor);
    // The event's place is that of whatever comes next; the key is what a reader would look at.
    if (!open_.empty() && open_.back().node->kind == YamlKind::map &&
        open_.back().node->items.size() % 2 == 1) {
      const YamlNode& key = *open_.back().node->items.back();
      node.line = key.line, node.column = key.column, node.offset = key.offset;
    }
    finish(node, 0);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end() || !found->second.finished)
      fail(mark, "the alias stands inside what it names");
    if (depth() + found->second.height > kMaxYamlNesting) fail_nesting(mark);
    count(mark, found->second.nodes);
    attach(*found->second.node, found->second.height);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode& node = create(YamlKind::scalar, mark, tag, anchor);
    node.quoted = tag == "!";
    node.text = value;
    finish(node, 0);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlKind::sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(YamlKind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

  /// Throws the error that yaml-cpp reports at `mark`.
  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& message) {
    if (mark.is_null()) throw Error(Location{file_.path, 0, 0}, message);
    const auto line = static_cast<std::uint32_t>(mark.line) + 1;
    const auto column =
        columns_.of(static_cast<std::size_t>(mark.pos), static_cast<std::size_t>(mark.column));
    throw Error(Location{file_.path, static_cast<int>(line), static_cast<int>(column)}, message);
  }

 private:
  /// A map or list whose end has not been seen.
  struct Open {
    YamlNode* node;
    YAML::anchor_t anchor;
    std::size_t nodes_before;
    int height = 0;  ///< levels of maps and lists below it
    std::unordered_set<std::string_view> keys;
  };
  struct Anchor {
    const YamlNode* node = nullptr;
    std::size_t nodes = 1;
    int height = 0;  ///< levels of maps and lists, its own included
    bool finished = false;
  };

  int depth() const { return static_cast<int>(open_.size()); }

  [[noreturn]] void fail_nesting(const YAML::Mark& mark) {
    fail(mark, "nested deeper than " + std::to_string(kMaxYamlNesting) + " levels");
  }

  void count(const YAML::Mark& mark, std::size_t nodes) {
    file_.expanded_nodes += nodes;
    if (file_.expanded_nodes > max_nodes_)
      fail(mark, "the scene has more than " + std::to_string(kMaxSceneNodes) + " values, aliases expanded");
  }

  YamlNode& create(YamlKind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (!tag.empty() && tag != "?" && tag != "!") fail(mark, "tags are not supported");
    count(mark, 1);
    YamlNode& node = file_.nodes.emplace_back();
    node.file = &file_;
    node.kind = kind;
    node.line = static_cast<std::uint32_t>(mark.line) + 1;
    node.offset = static_cast<std::uint32_t>(mark.pos);
    node.column = columns_.of(node.offset, static_cast<std::size_t>(mark.column));
    if (anchor != 0) anchors_[anchor] = {&node, 1, 0, kind == YamlKind::null || kind == YamlKind::scalar};
    return node;
  }

  void open(YamlKind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (depth() >= kMaxYamlNesting) fail_nesting(mark);
    const std::size_t nodes_before = file_.expanded_nodes;
    open_.push_back({&create(kind, mark, tag, anchor), anchor, nodes_before, 0, {}});
  }

  void close() {
    const Open closed = std::move(open_.back());
    open_.pop_back();
    if (closed.anchor != 0)
      anchors_[closed.anchor] = {closed.node, file_.expanded_nodes - closed.nodes_before, closed.height + 1,
                                 true};
    finish(*closed.node, closed.height + 1);
  }

  void finish(const YamlNode& node, int height) {
    if (open_.empty())
      file_.root = &node;
    else
      attach(node, height);
  }

  void attach(const YamlNode& node, int height) {
    Open& parent = open_.back();
    if (height > parent.height) parent.height = height;
    if (parent.node->kind == YamlKind::map && parent.node->items.size() % 2 == 0) check_key(parent, node);
    parent.node->items.push_back(&node);
  }

  void check_key(Open& map, const YamlNode& key) {
    if (key.kind != YamlKind::scalar)
      throw Error(key.where(), "expected a name as key, found " + key.describe());
    if (map.keys.insert(key.text).second) return;
    for (std::size_t i = 0; i < map.node->items.size(); i += 2)
      if (map.node->items[i]->text == key.text)
        return report(key, "duplicate key " + key.describe() + "; first at line " +
                               std::to_string(map.node->items[i]->line));
  }

  YamlFile& file_;
  ColumnCounter columns_;
  std::size_t max_nodes_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, Anchor> anchors_;
};

}  // namespace

Location YamlNode::where() const { return {file->path, static_cast<int>(line), static_cast<int>(column)}; }

Location YamlNode::where(std::size_t i) const {
  Location place = where();
  const std::size_t begin = offset + (quoted ? 1 : 0);
  const bool verbatim = begin <= file->text.size() && file->text.compare(begin, text.size(), text) == 0 &&
                        text.find('\n') == std::string::npos;
  if (verbatim) {
    const std::string_view before = std::string_view(text).substr(0, i);
    place.column += static_cast<int>(character_count(before)) + (quoted ? 1 : 0);
  }
  return place;
}

std::string YamlNode::describe() const {
  if (kind == YamlKind::scalar) return quote(text);
  return kind == YamlKind::null ? "nothing" : kind == YamlKind::sequence ? "a list" : "a map";
}

std::string read_text_file(const std::string& path, std::size_t max_bytes) {
  note_file_read(path);
  const Location place{path, 0, 0};
  if (const std::string reason = why_unreadable(path); !reason.empty())
    throw Error(place, reason, ErrorKind::io);
  const MappedFile file(path);
  if (file.text().size() > max_bytes)
    throw Error(place, "the file is larger than " + std::to_string(max_bytes >> 20) + " MiB");
  return std::string(file.text());
}

void parse_yaml(YamlFile& file, std::size_t max_nodes) {
  check_text(file.text, file.path);
  TreeBuilder builder(file, max_nodes);
  std::istringstream stream(file.text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {}
  } catch (const YAML::Exception& e) {
    builder.fail(e.mark, "not valid YAML: " + e.msg);
  }
  if (!file.root) throw Error(Location{file.path, 1, 1}, "the file is empty");
}

}  // namespace oktett
