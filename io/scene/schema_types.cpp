#include "io/scene/schema_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "io/scene/surface_table.h"

namespace oktett {
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

std::string schema_text(const SchemaTypes& types) { return Writer(types).text(); }

}  // namespace oktett
