#pragma once
/// \file The JSON Schema of scene files, from what describes its parameters (core/description.h).

#include <fmt/format.h>

#include <concepts>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "core/description.h"
#include "io/scene/described.h"
#include "io/scene/readers.h"

namespace oktett {

/// A JSON Schema (draft 2020-12) of scene files for editors. It allows more than their readers do where a
/// rule is one of numbers that are computed, and in expressions.
std::string scene_schema();

/// The counts of lists that must not be empty.
inline constexpr Range kNotEmpty{1, kMaxCoordinate};

class Schema;
/// A key that is read by hand, and what its value may be.
struct SchemaRow {
  const char *key, *meaning;
  std::string (*schema)(Schema&);
};

/// The definitions of a schema. Those of maps, which may contain each other, have names.
class Schema {
 public:
  /// A reference to the definition of a map that is called `what`, such as "a medium". It is made of `value`,
  /// with the defaults, when it is first asked for.
  template <class T>
  std::string map(const std::string& what, T value);
  /// The same of what `make` returns; `type` tells maps of one name apart.
  std::string define(const std::string& what, std::type_index type, const std::function<std::string()>& make);
  /// The same of a map with exactly one of the keys of a table, whose rows have `key`, `meaning` and
  /// `schema`, which is called for what the value may be.
  template <class Row, std::size_t N>
  std::string one_of(const std::string& what, const Row (&rows)[N]);
  /// All definitions; `root` is the reference to that of the whole.
  std::string text(const std::string& root) const;

  // What a value may be. Alternatives of one stand alone.
  static std::string any_of(const std::vector<std::string>& schemas);
  static std::string number(const Range& range, const char* type = "number");
  static std::string numbers(std::size_t count, const Range& range = kAnyNumber);
  static std::string vector(const Range& range = kAnyNumber);
  static std::string color();
  static std::string list(const std::string& item, const Range& counts = kNonNegative);
  /// A map with any keys.
  static std::string entries(const std::string& value);
  static std::string words(const std::vector<std::string>& words);
  static std::string boolean();
  static std::string text();
  static std::string file();
  /// Text that matches a regular expression.
  static std::string matching(const std::string& pattern);

 private:
  std::map<std::pair<std::type_index, std::string>, std::size_t> numbers_;
  std::map<std::string, int> names_{{"expression", 1}, {"parameter", 1}, {"color", 1}, {"vector", 1}};
  std::vector<std::pair<std::string, std::string>> definitions_;  ///< name and text
};

// How a default is written in a scene file.
inline std::string written(std::floating_point auto x) { return fmt::format("{:g}", x); }
inline std::string written(std::uint32_t x) { return fmt::format("{}", x); }
inline std::string written(std::same_as<bool> auto x) { return x ? "true" : "false"; }
inline std::string written(const Vec3d& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x, v.y, v.z); }
inline std::string written(const Color& c) { return written(Vec3d(c)); }
inline std::string written(std::span<const double> x) { return fmt::format("[{:g}]", fmt::join(x, ", ")); }
std::string written(std::span<const Vec3d> points);
std::string written(const ClipBox& box);
inline std::string written(const ByHand& value) { return value.usual; }
template <class T>
std::string written(const Textured<T>& value) {
  return written(value.value);
}
template <class T>
std::string written(const ChoiceOf<T>& choice) {
  for (const Choice<T>& c : choice.choices)
    if (c.value == choice.value) return c.name;
  return "";
}
/// The default of a parameter; "required" or "none", or empty if it is not written in one word.
template <class T>
std::string usual_value(const Parameter& parameter, const T& value) {
  if (parameter.need == Parameter::Need::required) return "required";
  if (parameter.need == Parameter::Need::optional) return "none";
  if constexpr (requires { written(value); })
    return written(value);
  else
    return "";
}

// What a value of a type may be. `range` is that of its parameter.
inline std::string schema_of(Schema&, const Range& range, std::floating_point auto) {
  return Schema::number(range);
}
inline std::string schema_of(Schema&, const Range& range, std::uint32_t) {
  return Schema::number(range, "integer");
}
inline std::string schema_of(Schema&, const Range&, std::same_as<bool> auto) { return Schema::boolean(); }
inline std::string schema_of(Schema&, const Range& range, const Vec3d&) { return Schema::vector(range); }
inline std::string schema_of(Schema&, const Range&, const Color&) { return Schema::color(); }
inline std::string schema_of(Schema&, const Range& range, std::span<const double> value) {
  return Schema::numbers(value.size(), range);
}
inline std::string schema_of(Schema&, const Range& counts, std::span<const Vec3d>) {
  return Schema::list(Schema::vector(), counts);
}
inline std::string schema_of(Schema&, const Range&, const std::vector<Monomial>&) { return Schema::text(); }
inline std::string schema_of(Schema&, const Range&, const FunctionTape&) { return Schema::text(); }
inline std::string schema_of(Schema&, const Range&, const UvFunction&) { return Schema::text(); }
inline std::string schema_of(Schema&, const Range&, const BezierPatchPoints& patch) {
  return Schema::list(Schema::vector(), whole(std::size(patch.p), std::size(patch.p)));
}
inline std::string schema_of(Schema&, const Range&, const PolygonHole&) {
  return Schema::list(Schema::vector(), whole(3, kMaxPolygonVertices));
}
inline std::string schema_of(Schema&, const Range&, const HalfSpace&) { return Schema::numbers(4); }
inline std::string schema_of(Schema&, const Range&, const ProfilePoint&) { return Schema::numbers(2); }
inline std::string schema_of(Schema&, const Range&, const SweptSphere&) { return Schema::numbers(4); }
inline std::string schema_of(Schema&, const Range&, const FlatPoint&) { return Schema::numbers(2); }
std::string schema_of(Schema& schema, const Range& range, const Affine& value);
std::string schema_of(Schema& schema, const Range& range, const BlobSource& value);
std::string schema_of(Schema& schema, const Range& range, const ByHand& value);
template <class T>
std::string schema_of(Schema&, const Range&, const ChoiceOf<T>& choice) {
  std::vector<std::string> words;
  for (const Choice<T>& c : choice.choices) words.push_back(c.name);
  return Schema::words(words);
}

/// The same of any value; `key` names a map without another name.
template <class T>
std::string any_schema(Schema& schema, const char* key, const Range& range, const T& value) {
  if constexpr (requires { schema_of(schema, range, value); })
    return schema_of(schema, range, value);
  else
    return schema.map(map_name<T>(key), value);
}
template <class T>
std::string any_schema(Schema& schema, const char* key, const Range& counts,
                       const std::vector<T>&) requires(!std::same_as<T, Monomial>) {
  return Schema::list(any_schema(schema, key, kAnyNumber, T{}), counts);
}

/// The definition of a map with known keys, from a description or key by key.
class SchemaMap : public ParameterVisitor<SchemaMap> {
 public:
  explicit SchemaMap(Schema& schema) : schema_(schema) {}

  template <class T>
  bool visit(const Parameter& parameter, T& value) {
    std::string meaning = parameter.meaning;
    if (const std::string usual = usual_value(parameter, value); usual == "required")
      required_.push_back(parameter.key);
    else if (!usual.empty() && usual != "none")
      meaning += "; default: " + usual;
    add(parameter.key, meaning, any_schema(schema_, parameter.key, parameter.range, value));
    return false;
  }
  void normals() {
    NormalMethod method = NormalMethod::gradient;
    describe_normals(*this, method);
  }
  void one_of(std::initializer_list<const char*> keys, const char* /*message*/ = nullptr) {
    one_of_.assign(keys.begin(), keys.end());
  }
  void not_both(const char* a, const char* b, const char* /*message*/ = nullptr,
                const char* /*at*/ = nullptr);
  void add(const std::string& key, const std::string& meaning, const std::string& schema);
  /// The same for one of the keys of which exactly one is given.
  void add_one_of(const std::string& key, const std::string& meaning, const std::string& schema) {
    add(key, meaning, schema);
    one_of_.push_back(key);
  }
  /// Adds the rows of a table as Schema::one_of does, and their keys to those of which one is given.
  void add_one_of(const auto& rows) {
    for (const auto& row : rows) add_one_of(row.key, row.meaning, row.schema(schema_));
  }

  std::string text() const;

 private:
  Schema& schema_;
  std::vector<std::string> properties_, required_, one_of_;
  std::vector<std::string> apart_;  ///< pairs of keys of which at most one is given
};

template <class T>
std::string Schema::map(const std::string& what, T value) {
  return define(what, typeid(T), [&] {
    SchemaMap map(*this);
    value.describe(map);
    return map.text();
  });
}

template <class Row, std::size_t N>
std::string Schema::one_of(const std::string& what, const Row (&rows)[N]) {
  return define(what, typeid(Row), [&] {
    SchemaMap map(*this);
    map.add_one_of(rows);
    return map.text();
  });
}

}  // namespace oktett
