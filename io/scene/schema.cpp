#include "io/scene/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/error.h"
#include "io/scene/read_probe.h"
#include "io/scene/readers.h"
#include "io/scene/schema_types.h"

namespace oktett {
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
