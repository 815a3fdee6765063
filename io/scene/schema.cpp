#include "io/scene/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/scene/read_probe.h"
#include "io/scene/readers.h"
#include "io/scene/surface_table.h"

namespace oktett {

// ---- What is known of the places of scene files, and how it is written as a JSON Schema.

/// One thing that may stand at a place: a value, a map with known keys, or a list or map of like entries.
struct SchemaType {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::optional<ReadType> value;
  std::size_t map;                ///< index into SchemaTypes::maps, or kNone
  std::size_t entry;              ///< the place of the entries, or kNone
  std::set<std::size_t> lengths;  ///< that a list may have; empty: any
  bool names = false;             ///< the entries have names
  /// Least and greatest number of entries of a list, if the reader tells.
  std::optional<std::pair<double, double>> counts = {};
  bool operator==(const SchemaType&) const = default;
};

/// A place: the value of a key, or the entries of a list or of a map with any keys.
struct SchemaSlot {
  std::size_t parent = 0;  ///< index of the place of the map or list that it was found in
  std::string key;         ///< empty for entries
  std::vector<SchemaType> found;
  std::size_t beside = SchemaType::kNone;  ///< the place of a key that must stand beside this one to be read
};

/// A map with known keys, in the place of each.
struct SchemaMap {
  std::string what;
  std::vector<std::string> keys;
  std::vector<std::size_t> slots;  ///< per key
  std::set<std::string> required;
  std::vector<std::string> one_of;  ///< exactly one of these keys is given; empty: no such rule
};

struct SchemaTypes {
  std::vector<SchemaSlot> slots;  ///< the first is the whole file
  std::vector<SchemaMap> maps;
};

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

/// What the tables say of shapes, patterns and their keys.
class Meanings {
 public:
  Meanings() {
    for (const auto& list : {described_surfaces(), described_patterns()})
      for (const DescribedSurface& s : list) {
        shapes_[s.surface.key] = s.surface.meaning;
        for (const DescribedParameter& p : s.parameters) keys_[{s.surface.key, p.parameter.key}] = text_of(p);
      }
  }
  /// Of `key` in the map that is called `what`; empty if nothing is known.
  std::string of(const std::string& what, const std::string& key) const {
    if (what == "an object" || what == "a texture")
      if (const auto found = shapes_.find(key); found != shapes_.end()) return found->second;
    const auto found = keys_.find({what, key});
    return found == keys_.end() ? "" : found->second;
  }

 private:
  static std::string text_of(const DescribedParameter& p) {
    const bool plain = p.usual.empty() || p.usual == "none" || p.usual == "required";
    return plain ? p.parameter.meaning : fmt::format("{}; default: {}", p.parameter.meaning, p.usual);
  }
  std::map<std::string, std::string> shapes_;
  std::map<std::pair<std::string, std::string>, std::string> keys_;
};

std::string limits(const Range& range) {
  std::string text;
  if (range.lo > -kMaxCoordinate)
    text += fmt::format(", \"{}\": {}", range.lo_open ? "exclusiveMinimum" : "minimum", range.lo);
  if (range.hi < kMaxCoordinate)
    text += fmt::format(", \"{}\": {}", range.hi_open ? "exclusiveMaximum" : "maximum", range.hi);
  return text;
}

/// Alternatives; a single one stands alone.
std::string any_of(const std::vector<std::string>& schemas) {
  if (schemas.empty()) return "{}";
  return schemas.size() == 1 ? schemas.front() : fmt::format("{{\"anyOf\": [{}]}}", fmt::join(schemas, ", "));
}

constexpr const char* kExpression = "{\"$ref\": \"#/$defs/expression\"}";
constexpr const char* kParameter = "{\"$ref\": \"#/$defs/parameter\"}";

std::string number(const Range& range, const char* type = "number") {
  return any_of({fmt::format("{{\"type\": \"{}\"{}}}", type, limits(range)), kExpression});
}

std::string value_text(const ReadType& t) {
  using Kind = ReadType::Kind;
  switch (t.kind) {
    case Kind::number:
      return number(t.range);
    case Kind::integer:
      return number(t.range, "integer");
    case Kind::boolean:
      return any_of({"{\"type\": \"boolean\"}", kParameter});
    case Kind::text:
      if (!t.pattern.empty())
        return any_of({fmt::format("{{\"type\": [\"string\", \"integer\", \"boolean\"], \"pattern\": {}}}",
                                   quoted(t.pattern)),
                       kParameter});
      return "{\"type\": [\"string\", \"number\", \"boolean\"]}";
    case Kind::file:
      return "{\"type\": [\"string\", \"number\"]}";
    case Kind::color:
      return "{\"$ref\": \"#/$defs/color\"}";
    case Kind::numbers:
      return fmt::format("{{\"type\": \"array\", \"items\": {}, \"minItems\": {}, \"maxItems\": {}}}",
                         number(t.range), t.count, t.count);
    case Kind::choice: {
      std::vector<std::string> words;
      for (const std::string& word : t.words) words.push_back(quoted(word));
      return any_of({fmt::format("{{\"enum\": [{}]}}", fmt::join(words, ", ")), kParameter});
    }
  }
  return "{}";
}

class Writer {
 public:
  explicit Writer(const SchemaTypes& types) : types_(types) { name_maps(); }

  std::string text() const {
    std::string text =
        "{\n"
        "\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
        "\"title\": \"Oktett scene\",\n"
        "\"description\": \"Printed by `oktett info --schema`; docs/scene-format.md explains it.\",\n"
        "\"$ref\": \"#/$defs/" +
        names_[types_.slots[0].found.at(0).map] +
        "\",\n"
        "\"$defs\": {\n"
        "\"expression\": {\"type\": \"string\", \"pattern\": \"[0-9$(]|^ *(pi|e) *$\"},\n"
        "\"parameter\": {\"type\": \"string\", \"pattern\": \"[$]\"},\n"
        "\"color\": {\"anyOf\": [{\"type\": \"array\", \"items\": " +
        number(kNonNegative) +
        ", \"minItems\": 3, \"maxItems\": 3}, {\"type\": \"string\", \"pattern\": "
        "\"^#[0-9a-fA-F]{6}$|[$]\"}]}";
    for (std::size_t i = 0; i < types_.maps.size(); ++i) text += ",\n" + map_text(i);
    return text + "\n}\n}\n";
  }

 private:
  /// "a point light" becomes point_light; of several maps of one name the later ones are numbered.
  void name_maps() {
    std::map<std::string, int> count;
    for (const SchemaMap& map : types_.maps) {
      std::string name = map.what;
      for (const char* article : {"a ", "an "})
        if (name.starts_with(article)) name.erase(0, std::string(article).size());
      std::ranges::replace(name, ' ', '_');
      const int number = ++count[name];
      names_.push_back(number == 1 ? name : fmt::format("{}_{}", name, number));
    }
  }

  std::string map_text(std::size_t index) const {
    const SchemaMap& map = types_.maps[index];
    std::vector<std::string> required;
    for (const std::string& key : map.required) required.push_back(quoted(key));
    if (map.what == "a scene") required.emplace_back("\"oktett\"");
    // An empty node is a map without keys.
    const bool may_be_empty = required.empty() && map.one_of.empty();
    std::string text =
        fmt::format("{}: {{\n\"type\": {},\n\"additionalProperties\": false", quoted(names_[index]),
                    may_be_empty ? "[\"object\", \"null\"]" : "\"object\"");
    if (!map.one_of.empty()) text += ",\n" + one_of_text(map);
    if (!required.empty()) text += fmt::format(",\n\"required\": [{}]", fmt::join(required, ", "));
    text += ",\n\"properties\": {";
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      std::string schema = slot_text(map.slots[i]);
      if (const std::string meaning = meanings_.of(map.what, map.keys[i]); !meaning.empty())
        schema = fmt::format("{{\"description\": {}{}{}", quoted(meaning), schema == "{}" ? "" : ", ",
                             schema.substr(1));
      text += fmt::format("{}\n  {}: {}", i == 0 ? "" : ",", quoted(map.keys[i]), schema);
    }
    return text + "}}";
  }

  static std::string one_of_text(const SchemaMap& map) {
    if (map.one_of.size() == map.keys.size()) return "\"minProperties\": 1,\n\"maxProperties\": 1";
    std::vector<std::string> alternatives;
    for (const std::string& key : map.one_of)
      alternatives.push_back(fmt::format("{{\"required\": [{}]}}", quoted(key)));
    return fmt::format("\"oneOf\": [{}]", fmt::join(alternatives, ", "));
  }

  std::string slot_text(std::size_t slot) const {
    std::vector<std::string> schemas;
    for (const SchemaType& type : types_.slots[slot].found) {
      if (const std::string text = type_text(type); std::ranges::find(schemas, text) == schemas.end())
        schemas.push_back(text);
    }
    return any_of(schemas);
  }

  std::string type_text(const SchemaType& type) const {
    if (type.value) return value_text(*type.value);
    if (type.map != SchemaType::kNone) return fmt::format("{{\"$ref\": \"#/$defs/{}\"}}", names_[type.map]);
    const std::string entry = slot_text(type.entry);
    if (type.names)
      return fmt::format("{{\"type\": [\"object\", \"null\"], \"additionalProperties\": {}}}", entry);
    std::vector<std::string> lists;
    for (const std::size_t n : type.lengths)
      lists.push_back(fmt::format(
          "{{\"type\": \"array\", \"items\": {}, \"minItems\": {}, \"maxItems\": {}}}", entry, n, n));
    if (lists.empty()) {
      const auto [least, most] = type.counts.value_or(std::pair{0.0, kMaxCoordinate});
      std::string text = fmt::format("{{\"type\": {}, \"items\": {}",
                                     least > 0 ? "\"array\"" : "[\"array\", \"null\"]", entry);
      if (least > 0) text += fmt::format(", \"minItems\": {}", least);
      if (most < kMaxCoordinate) text += fmt::format(", \"maxItems\": {}", most);
      lists.push_back(text + "}");
    }
    return any_of(lists);
  }

  const SchemaTypes& types_;
  std::vector<std::string> names_;
  Meanings meanings_;
};

}  // namespace

static std::string schema_text(const SchemaTypes& types) { return Writer(types).text(); }

namespace {

/// Lengths of lists that are tried.
constexpr std::size_t kLengths[] = {1, 2, 3, 4, 12, 16};
/// Words of a choice that are tried where other keys depend on it.
constexpr std::size_t kMostWords = 6;

/// Builds trees that lead to one place, has them read, and notes what is read where.
class Explorer final : public ReadProbe {
 public:
  SchemaTypes explore() {
    types_.slots.push_back({});
    try_all(0);
    std::set<std::size_t> tried, tried_with_others;
    for (bool found = true; found;) {
      found = false;
      for (std::size_t slot = 1; slot < types_.slots.size(); ++slot)
        if (is_reached(slot) && tried.insert(slot).second) try_all(slot), found = true;
      // Keys that are read only beside others, or if a choice has another word.
      for (std::size_t slot = 1; slot < types_.slots.size(); ++slot)
        if (is_reached(slot) && types_.slots[slot].found.empty() && tried_with_others.insert(slot).second)
          try_with_others(slot), found = true;
    }
    for (std::size_t slot = 1; slot < types_.slots.size(); ++slot)
      if (const SchemaType* type = list_type(slot, false); type != nullptr && type->counts)
        try_counts_with_choices(slot);
    return std::move(types_);
  }

  void value(const YamlNode& node, const ReadType& type) override {
    if (const std::size_t slot = slot_of(node); slot != SchemaType::kNone)
      add(slot, SchemaType{type, SchemaType::kNone, SchemaType::kNone, {}});
    read_.insert(&node);
  }

  void keys(const YamlNode& map, const std::string& what, const std::vector<std::string>& known) override {
    if (map_of_.contains(&map)) return;
    const std::size_t slot = slot_of(map);
    std::size_t type = 0;
    while (type < types_.maps.size() && (types_.maps[type].what != what || types_.maps[type].keys != known))
      ++type;
    if (type == types_.maps.size()) {
      SchemaMap& added = types_.maps.emplace_back(SchemaMap{what, known, {}, {}, {}});
      for (const std::string& key : known) {
        added.slots.push_back(types_.slots.size());
        types_.slots.push_back({slot, key, {}});
      }
    }
    map_of_[&map] = type;
    read_.insert(&map);
    if (slot != SchemaType::kNone) add(slot, SchemaType{std::nullopt, type, SchemaType::kNone, {}});
  }

  void entries(const YamlNode& node, const std::string&) override {
    read_.insert(&node);
    const std::size_t slot = slot_of(node);
    if (map_of_.contains(&node) || slot == SchemaType::kNone) return;
    const SchemaType type{std::nullopt, SchemaType::kNone, entry_slot(slot), {}, node.kind == YamlKind::map};
    if (list_type(slot, type.names) == nullptr) add(slot, type);
  }

  void count(const YamlNode& list, const Range& counts) override {
    const std::size_t slot = slot_of(list);
    if (slot == SchemaType::kNone) return;
    auto [found, is_new] = counts_.try_emplace(slot, counts.lo, counts.hi);
    // All rules of one reading hold.
    found->second = {std::max(found->second.first, counts.lo), std::min(found->second.second, counts.hi)};
  }

  void one_of(const YamlNode& map, const std::vector<std::string>& keys) override {
    if (const auto found = map_of_.find(&map); found != map_of_.end())
      types_.maps[found->second].one_of = keys;
  }

  const YamlNode& required(const YamlNode& map, const char* key) override {
    const std::size_t type = map_of_.at(&map);
    missing_.insert({type, key});
    const SchemaMap& m = types_.maps[type];
    const auto at = std::ranges::find(m.keys, key);
    return sample(at == m.keys.end() ? SchemaType::kNone
                                     : m.slots[static_cast<std::size_t>(at - m.keys.begin())]);
  }

  std::size_t chosen(std::size_t words) const override { return word_ % words; }

  void fill(std::span<double> list, const Range& range) override {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto number = static_cast<double>(across_ ? lists_ % list.size() == i : lists_ + 1);
      list[i] = range.contains(number) ? number : some_number(range);
    }
    ++lists_;
  }

 private:
  std::size_t slot_of(const YamlNode& node) const {
    const auto found = slots_.find(&node);
    return found == slots_.end() ? SchemaType::kNone : found->second;
  }

  void add(std::size_t slot, const SchemaType& type) {
    std::vector<SchemaType>& found = types_.slots[slot].found;
    if (std::ranges::find(found, type) == found.end()) found.push_back(type);
  }

  /// What is known of the list, or the map with any keys, at `slot`; null if nothing is.
  SchemaType* list_type(std::size_t slot, bool names) {
    for (SchemaType& type : types_.slots[slot].found)
      if (type.entry != SchemaType::kNone && type.names == names && type.lengths.empty()) return &type;
    return nullptr;
  }

  /// Notes the counts of lists of the tree that was read. In other trees other keys may allow others.
  void note_counts() {
    for (const auto& [slot, counts] : counts_) {
      SchemaType* const type = list_type(slot, false);
      if (type == nullptr) continue;
      auto& known = type->counts;
      if (!known)
        known = counts;
      else
        known = {std::min(known->first, counts.first), std::max(known->second, counts.second)};
    }
  }

  /// The place of the entries of the list or map at `slot`.
  std::size_t entry_slot(std::size_t slot) {
    const auto [place, is_new] = entry_slots_.try_emplace(slot, types_.slots.size());
    if (is_new) types_.slots.push_back({slot, "", {}});
    return place->second;
  }

  // --- trees

  YamlNode& node(std::size_t slot, YamlKind kind) {
    YamlNode& made = file_->nodes.emplace_back();
    made.file = &*file_, made.kind = kind;
    if (kind == YamlKind::scalar) made.text = "x";
    if (slot != SchemaType::kNone) slots_[&made] = slot;
    return made;
  }

  YamlNode& version() {
    YamlNode& made = node(SchemaType::kNone, YamlKind::scalar);
    made.text = "1";
    return made;
  }

  void put(YamlNode& map, const std::string& key, const YamlNode& value) {
    YamlNode& name = node(SchemaType::kNone, YamlKind::scalar);
    name.text = key;
    map.items.push_back(&name), map.items.push_back(&value);
  }

  /// A value of a kind that is known to be read at `slot`.
  YamlNode& sample(std::size_t slot) {
    const std::vector<SchemaType> none;
    const std::vector<SchemaType>& found = slot == SchemaType::kNone ? none : types_.slots[slot].found;
    if (found.empty()) return node(slot, YamlKind::scalar);
    const SchemaType& type = found.front();
    if (type.map != SchemaType::kNone || type.names) return node(slot, YamlKind::map);
    const bool list = type.entry != SchemaType::kNone || type.value->kind == ReadType::Kind::numbers;
    if (!list) return node(slot, YamlKind::scalar);
    return node(slot, YamlKind::sequence);
  }

  /// Reads a tree that leads to `slot`, where it has a value of `kind`, a list of `length` values if it is
  /// one, beside the key at the place `other`. Returns the value, or null if the reader gave up.
  const YamlNode& read_tree(std::size_t slot, YamlKind kind, std::size_t length,
                            std::size_t other = SchemaType::kNone) {
    file_.emplace();
    file_->probe = this;
    slots_.clear(), map_of_.clear(), read_.clear(), missing_.clear(), counts_.clear();
    lists_ = 0;
    YamlNode& target = node(slot, kind);
    if (kind == YamlKind::sequence)
      for (std::size_t i = 0; i < length; ++i)
        target.items.push_back(&node(entry_slot(slot), YamlKind::scalar));
    YamlNode* child = &target;
    for (std::size_t at = slot; at != 0; at = types_.slots[at].parent) {
      const SchemaSlot& place = types_.slots[at];
      const bool in_list = place.key.empty() && !is_named(at);
      YamlNode& parent = node(place.parent, in_list ? YamlKind::sequence : YamlKind::map);
      if (in_list)
        parent.items.push_back(child);
      else
        put(parent, place.key.empty() ? "x" : place.key, *child);
      const std::size_t beside = at == slot && other != SchemaType::kNone ? other : place.beside;
      if (beside != SchemaType::kNone) put(parent, types_.slots[beside].key, sample(beside));
      child = &parent;
    }
    if (slot != 0 || kind == YamlKind::map)
      if (types_.slots[slot].parent != 0 || types_.slots[slot].key != "oktett")
        put(*child, "oktett", version());
    file_->root = child;
    try {
      read_scene_tree(*child);
    } catch (const Error&) {
      // What was noted up to here counts.
    }
    note_counts();
    return target;
  }

  /// Whether `slot` is a key, or what entries of a list or map stand for that is known to be read.
  bool is_reached(std::size_t slot) const {
    if (!types_.slots[slot].key.empty()) return true;
    const std::vector<SchemaType>& found = types_.slots[types_.slots[slot].parent].found;
    return std::ranges::any_of(found, [&](const SchemaType& t) { return t.entry == slot; });
  }

  /// Whether the entry at `slot` is that of a map with any keys.
  bool is_named(std::size_t slot) const {
    const std::vector<SchemaType>& found = types_.slots[types_.slots[slot].parent].found;
    return std::ranges::any_of(found, [&](const SchemaType& t) { return t.entry == slot && t.names; });
  }

  // --- what to try

  void try_all(std::size_t slot, std::size_t other = SchemaType::kNone) {
    note_missing(slot, read_tree(slot, YamlKind::scalar, 0, other));
    try_lists(slot, other);
    note_missing(slot, read_tree(slot, YamlKind::map, 0, other));
    if (other == SchemaType::kNone) note_required(slot);
  }

  /// After a map without keys was read at `slot`: what was asked for is required, if it is in all such
  /// places.
  void note_required(std::size_t slot) {
    for (const auto& [node, type] : map_of_) {
      if (slot_of(*node) != slot) continue;
      std::set<std::string> asked;
      for (const auto& [owner, key] : missing_)
        if (owner == type && !refuted_.contains({type, key})) asked.insert(key);
      std::set<std::string>& required = types_.maps[type].required;
      if (seen_.insert(type).second)
        required = asked;
      else
        std::erase_if(required, [&](const std::string& key) { return !asked.contains(key); });
    }
  }

  void try_lists(std::size_t slot, std::size_t other) {
    SchemaType direct{std::nullopt, SchemaType::kNone, SchemaType::kNone, {}};
    for (const std::size_t length : kLengths) {
      const YamlNode& target = read_tree(slot, YamlKind::sequence, length, other);
      note_missing(slot, target);
      const bool known = read_.contains(&target);
      // Some readers go through the items by themselves.
      if (!known && std::ranges::any_of(target.items, [&](const YamlNode* i) { return read_.contains(i); }))
        direct.lengths.insert(length);
    }
    if (direct.lengths.empty()) return;
    if (direct.lengths.size() == std::size(kLengths)) direct.lengths.clear();
    direct.entry = entry_slot(slot);
    add(slot, direct);
  }

  void try_with_others(std::size_t slot) {
    const std::size_t parent = types_.slots[slot].parent;
    for (std::size_t other = 1; other < types_.slots.size(); ++other) {
      const SchemaSlot& place = types_.slots[other];
      if (other == slot || place.parent != parent || place.key.empty()) continue;
      const auto is_choice = [](const SchemaType& t) {
        return t.value && t.value->kind == ReadType::Kind::choice;
      };
      const std::size_t words = std::ranges::any_of(place.found, is_choice) ? kMostWords : 1;
      for (word_ = 0; word_ < words; ++word_)
        for (const bool across : {false, true}) {
          across_ = across;
          try_all(slot, other);
        }
      word_ = 0, across_ = false;
      if (types_.slots[slot].found.empty()) continue;
      types_.slots[slot].beside = other;
      return;
    }
  }

  /// Reads the list at `slot` beside each word of each choice in its map.
  void try_counts_with_choices(std::size_t slot) {
    for (std::size_t other = 1; other < types_.slots.size(); ++other) {
      const SchemaSlot& place = types_.slots[other];
      if (place.parent != types_.slots[slot].parent || place.key.empty() || types_.slots[slot].key.empty())
        continue;
      for (const SchemaType& type : place.found)
        if (type.value && type.value->kind == ReadType::Kind::choice)
          for (word_ = 0; word_ < type.value->words.size(); ++word_)
            read_tree(slot, YamlKind::sequence, 1, other);
    }
    word_ = 0;
  }

  /// A key that is not asked for beside another one, whose `value` was read, is not required.
  void note_missing(std::size_t slot, const YamlNode& value) {
    if (!read_.contains(&value)) return;
    for (const auto& [node, type] : map_of_) {
      SchemaMap& map = types_.maps[type];
      const std::string& given = types_.slots[slot].key;
      if (slot_of(*node) != types_.slots[slot].parent || given.empty()) continue;
      for (const std::string& key : map.keys)
        if (key != given && !missing_.contains({type, key})) {
          map.required.erase(key);
          refuted_.insert({type, key});
        }
    }
  }

  SchemaTypes types_;
  std::map<std::size_t, std::size_t> entry_slots_;
  std::set<std::pair<std::size_t, std::string>> refuted_;
  std::set<std::size_t> seen_;  ///< maps whose required keys are known
  std::size_t word_ = 0;
  bool across_ =
      false;  ///< lists of numbers are perpendicular to each other, else each is greater than the last
  // Of the tree that is read:
  std::size_t lists_ = 0;  ///< of numbers, so far
  std::optional<YamlFile> file_;
  std::map<const YamlNode*, std::size_t> slots_, map_of_;
  std::set<const YamlNode*> read_;
  std::set<std::pair<std::size_t, std::string>> missing_;
  std::map<std::size_t, std::pair<double, double>> counts_;  ///< of lists, by place
};

}  // namespace

std::string scene_schema() { return schema_text(Explorer().explore()); }

}  // namespace oktett
