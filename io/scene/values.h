#pragma once
/// \file Typed values out of YAML nodes, with the error that says what was expected and where. Within io/
/// only.

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "io/scene/parameters.h"
#include "io/yaml/error_list.h"
#include "io/yaml/yaml.h"

namespace oktett {

/// What `range` allows, e.g. "a number greater than 0" for the noun "a number".
std::string describe(const Range& range, const char* noun);

struct MapEntry {
  const YamlNode* key;
  const YamlNode* value;
};

/// The entries of a map in order; none for an empty node. Throws Error if `node` is anything else; `what`
/// names it.
std::vector<MapEntry> map_entries(const YamlNode& node, const std::string& what);

/// The items of a list; none for an empty node. Throws Error if `node` is anything else; `what` names it.
std::span<const YamlNode* const> list_items(const YamlNode& node, const std::string& what);

/// "; did you mean 'x'?" for the nearest of `known`, or nothing.
std::string suggest(const std::string& name, std::span<const std::string> known);

/// A map whose keys are known beforehand.
class Fields {
 public:
  /// Throws Error if `node` is no map or has a key that is not in `known`; `what` names it. An empty node is
  /// an empty map. Where errors are gathered, unknown keys are passed over.
  Fields(const YamlNode& node, const std::string& what, std::span<const char* const> known);
  Fields(const YamlNode& node, const std::string& what, std::initializer_list<const char*> known)
      : Fields(node, what, std::span(known.begin(), known.size())) {}

  /// The value of `key`, or null if the map does not have it.
  const YamlNode* operator[](const char* key) const;
  /// The value of `key`. Throws Error if the map does not have it. Where errors are gathered, a node that is
  /// `missing` stands for it.
  const YamlNode& require(const char* key) const;

 private:
  const YamlNode& node_;
  std::string what_;
};

/// Reads values; `${name}` is replaced in every scalar. Throws Error for values of another kind; where errors
/// are gathered, makes up a value that is allowed.
class SceneValues {
 public:
  explicit SceneValues(SceneParameters& parameters) : parameters_(parameters) {}

  std::string text(const YamlNode& node);
  bool boolean(const YamlNode& node);
  /// A number or an expression.
  double number(const YamlNode& node, const Range& range = kAnyNumber);
  /// The same in single precision, which must be in the range, too.
  float single(const YamlNode& node, const Range& range);
  std::uint32_t integer(const YamlNode& node, std::uint32_t lo, std::uint32_t hi);
  /// A list of as many numbers as `out` holds.
  void numbers(const YamlNode& node, std::span<double> out, const Range& range = kAnyNumber);
  /// [x, y, z].
  Vec3d vector(const YamlNode& node);
  /// [r, g, b], linear, or "#rrggbb", sRGB.
  Color color(const YamlNode& node);
  /// A path to a regular file that can be read, relative to the file that `node` stands in.
  std::string existing_file(const YamlNode& node);

  template <class T>
  T choice(const YamlNode& node, std::initializer_list<Choice<T>> choices) {
    return choice<T>(node, std::span(choices.begin(), choices.size()));
  }
  template <class T>
  T choice(const YamlNode& node, std::span<const Choice<T>> choices) {
    const auto read = [&] {
      const std::string word = text(node);
      std::vector<std::string> names;
      for (const Choice<T>& c : choices) {
        if (word == c.name) return c.value;
        names.push_back(c.name);
      }
      fail_choice(node, word, names);
    };
    return read_or(node, read, [&] { return choices[0].value; });
  }

 private:
  [[noreturn]] static void fail_choice(const YamlNode& node, const std::string& word,
                                       std::span<const std::string> names);
  double expression(const YamlNode& node, const std::string& text);
  double read_number(const YamlNode& node, const Range& range);
  std::uint32_t read_integer(const YamlNode& node, std::uint32_t lo, std::uint32_t hi);
  void read_numbers(const YamlNode& node, std::span<double> out, const Range& range);
  Color color_of(const YamlNode& node);

  SceneParameters& parameters_;
};

}  // namespace oktett
