#pragma once
/// \file Writing JSON objects.

#include <cstdint>
#include <string>
#include <vector>

namespace oktett {

/// One JSON object, its members in the order in which they were added.
class JsonObject {
 public:
  void add(const std::string& name, const std::string& text);
  void add(const std::string& name, const char* text) { add(name, std::string(text)); }
  void add(const std::string& name, bool value);
  void add(const std::string& name, std::uint64_t value);
  /// NaN and infinities, which JSON does not have, become null.
  void add(const std::string& name, double value);
  void add(const std::string& name, const std::vector<double>& values);
  void add(const std::string& name, const JsonObject& value);

  /// On one line.
  std::string text() const { return "{" + members_ + "}"; }

 private:
  void add_member(const std::string& name, const std::string& value);

  std::string members_;
};

}  // namespace oktett
