#pragma once
/// \file Numbers as JSON and YAML write them, and JSON objects.

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "core/vec3.h"

namespace oktett {

/// The fewest digits that give back the number; null if it is not finite.
template <class T>
std::string number_text(T value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

/// "[x, y, z]"
template <class T>
std::string list_text(const Vec3<T>& v) {
  return "[" + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + "]";
}

class JsonObject;

/// A value as JSON text. NaN and infinities, which JSON does not have, become null.
struct JsonValue {
  JsonValue(const std::string& value);
  JsonValue(const char* value) : JsonValue(std::string(value)) {}
  JsonValue(std::same_as<bool> auto value) : text(value ? "true" : "false") {}
  JsonValue(std::uint64_t value) : text(std::to_string(value)) {}
  JsonValue(double value);
  JsonValue(const std::vector<double>& values);
  JsonValue(const JsonObject& object);

  std::string text;
};

/// One JSON object, its members in the order in which they were added.
class JsonObject {
 public:
  struct Member {
    std::string name;
    JsonValue value;
  };
  JsonObject(std::initializer_list<Member> members = {}) { add(members); }

  void add(const std::string& name, const JsonValue& value);
  void add(std::initializer_list<Member> members) {
    for (const auto& [name, value] : members) add(name, value);
  }

  /// On one line.
  std::string text() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

}  // namespace oktett
