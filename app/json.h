#pragma once
/// \file Writing JSON objects.

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

namespace oktett {

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
