#include "io/scene/schema.h"

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "io/scene/readers.h"
#include "kernels/heights/height_grid.h"

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

std::string quoted_list(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + quoted(word);
  return list;
}

std::string reference(const std::string& name) { return fmt::format("{{\"$ref\": \"#/$defs/{}\"}}", name); }

std::string limits(const Range& range) {
  std::string text;
  if (range.lo > -kMaxCoordinate)
    text += fmt::format(", \"{}\": {}", range.lo_open ? "exclusiveMinimum" : "minimum", range.lo);
  if (range.hi < kMaxCoordinate)
    text += fmt::format(", \"{}\": {}", range.hi_open ? "exclusiveMaximum" : "maximum", range.hi);
  return text;
}

/// What ByHand::form may be.
constexpr SchemaRow kForms[] = {
    {"file", "", [](Schema&) { return Schema::file(); }},
    {"text", "", [](Schema&) { return Schema::text(); }},
    {"points", "", [](Schema&) { return Schema::list(Schema::vector()); }},
    {"samples", "",
     [](Schema&) {
       const std::string number = Schema::number(whole(2, kMaxHeightSide), "integer");
       return Schema::any_of({number, Schema::list(number, whole(2, 2))});
     }},
    {"elements", "", elements_schema},
    {"blends", "", blends_schema},
};

}  // namespace

std::string Schema::define(const std::string& what, std::type_index type,
                           const std::function<std::string()>& make) {
  const auto [known, is_new] = numbers_.try_emplace({type, what}, definitions_.size());
  const std::size_t index = known->second;
  if (!is_new) return reference(definitions_[index].first);
  // "a point light" becomes point_light; of several maps of one name the later ones are numbered.
  std::string name = what;
  for (const std::string_view article : {"a ", "an "})
    if (name.starts_with(article)) name.erase(0, article.size());
  std::ranges::replace(name, ' ', '_');
  const int number = ++names_[name];
  definitions_.emplace_back(number == 1 ? name : fmt::format("{}_{}", name, number), "");
  std::string text = make();
  definitions_[index].second = std::move(text);
  return reference(definitions_[index].first);
}

std::string Schema::text(const std::string& root) const {
  std::string text =
      "{\n"
      "\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
      "\"title\": \"Oktett scene\",\n"
      "\"description\": \"Printed by `oktett info --schema`; docs/scene-format.md explains it.\",\n" +
      root.substr(1, root.size() - 2) +
      ",\n"
      "\"$defs\": {\n"
      "\"expression\": {\"type\": \"string\", \"pattern\": \"[0-9$(]|^ *(pi|e) *$\"},\n"
      "\"parameter\": {\"type\": \"string\", \"pattern\": \"[$]\"},\n"
      "\"vector\": " +
      numbers(3) +
      ",\n"
      "\"color\": {\"anyOf\": [" +
      numbers(3, kNonNegative) + ", {\"type\": \"string\", \"pattern\": \"^#[0-9a-fA-F]{6}$|[$]\"}]}";
  for (const auto& [name, definition] : definitions_)
    text += fmt::format(",\n{}: {}", quoted(name), definition);
  return text + "\n}\n}\n";
}

std::string Schema::any_of(const std::vector<std::string>& schemas) {
  return schemas.size() == 1 ? schemas.front() : fmt::format("{{\"anyOf\": [{}]}}", fmt::join(schemas, ", "));
}

std::string Schema::number(const Range& range, const char* type) {
  return any_of({fmt::format("{{\"type\": \"{}\"{}}}", type, limits(range)), reference("expression")});
}

std::string Schema::numbers(std::size_t count, const Range& range) {
  const auto n = static_cast<std::uint32_t>(count);
  return list(number(range), whole(n, n));
}

std::string Schema::vector(const Range& range) {
  return limits(range).empty() ? reference("vector") : numbers(3, range);
}

std::string Schema::color() { return reference("color"); }

std::string Schema::list(const std::string& item, const Range& counts) {
  // An empty node is a list without items.
  std::string text = fmt::format("{{\"type\": {}, \"items\": {}",
                                 counts.lo > 0 ? "\"array\"" : "[\"array\", \"null\"]", item);
  if (counts.lo > 0) text += fmt::format(", \"minItems\": {}", counts.lo);
  if (counts.hi < kMaxCoordinate) text += fmt::format(", \"maxItems\": {}", counts.hi);
  return text + "}";
}

std::string Schema::entries(const std::string& value) {
  return fmt::format("{{\"type\": [\"object\", \"null\"], \"additionalProperties\": {}}}", value);
}

std::string Schema::words(const std::vector<std::string>& words) {
  return any_of({fmt::format("{{\"enum\": [{}]}}", quoted_list(words)), reference("parameter")});
}

std::string Schema::boolean() { return any_of({"{\"type\": \"boolean\"}", reference("parameter")}); }
std::string Schema::text() { return "{\"type\": [\"string\", \"number\", \"boolean\"]}"; }
std::string Schema::file() { return "{\"type\": [\"string\", \"number\"]}"; }
std::string Schema::matching(const std::string& pattern) {
  return any_of(
      {fmt::format("{{\"type\": [\"string\", \"integer\", \"boolean\"], \"pattern\": {}}}", quoted(pattern)),
       reference("parameter")});
}

std::string written(std::span<const Vec3d> points) {
  std::string text;
  for (const Vec3d& p : points) text += (text.empty() ? "[" : ", ") + written(p);
  return text + "]";
}
std::string written(const ClipBox& box) {
  return fmt::format("{{min: {}, max: {}}}", written(box.lo), written(box.hi));
}

std::string schema_of(Schema& schema, const Range&, const ByHand& value) {
  for (const SchemaRow& form : kForms)
    if (std::string_view(form.key) == value.form) return form.schema(schema);
  throw Error(std::string("no form of a value is called ") + value.form);
}

void SchemaMap::not_both(const char* a, const char* b, const char*, const char*) {
  // Without the type a map that is left empty, which is null, would have both.
  apart_.push_back(fmt::format("{{\"type\": \"object\", \"required\": [{}]}}", quoted_list({a, b})));
}

void SchemaMap::add(const std::string& key, const std::string& meaning, const std::string& schema) {
  const std::string text =
      meaning.empty() ? schema : fmt::format("{{\"description\": {}, {}", quoted(meaning), schema.substr(1));
  properties_.push_back(fmt::format("{}: {}", quoted(key), text));
}

std::string SchemaMap::text() const {
  // An empty node is a map without keys.
  const bool may_be_empty = required_.empty() && one_of_.empty();
  std::string text = fmt::format("{{\n\"type\": {},\n\"additionalProperties\": false",
                                 may_be_empty ? "[\"object\", \"null\"]" : "\"object\"");
  if (!one_of_.empty() && one_of_.size() == properties_.size()) {
    text += ",\n\"minProperties\": 1,\n\"maxProperties\": 1";
  } else if (!one_of_.empty()) {
    std::vector<std::string> alternatives;
    for (const std::string& key : one_of_)
      alternatives.push_back(fmt::format("{{\"required\": [{}]}}", quoted(key)));
    text += fmt::format(",\n\"oneOf\": [{}]", fmt::join(alternatives, ", "));
  }
  if (!apart_.empty()) text += fmt::format(",\n\"not\": {}", Schema::any_of(apart_));
  if (!required_.empty()) text += fmt::format(",\n\"required\": [{}]", quoted_list(required_));
  return text + fmt::format(",\n\"properties\": {{\n  {}}}}}", fmt::join(properties_, ",\n  "));
}

}  // namespace oktett
