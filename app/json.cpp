#include "app/json.h"

#include <fmt/format.h>

namespace oktett {

static std::string quoted(const std::string& text) {
  std::string s = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      s += '\\';
      s += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      s += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      s += c;
    }
  }
  return s + '"';
}

JsonValue::JsonValue(const std::string& value) : text(quoted(value)) {}
JsonValue::JsonValue(double value) : text(number_text(value)) {}
JsonValue::JsonValue(const JsonObject& object) : text(object.text()) {}
JsonValue::JsonValue(const std::vector<double>& values) {
  for (const double v : values) text += (text.empty() ? "[" : ", ") + JsonValue(v).text;
  text += text.empty() ? "[]" : "]";
}

void JsonObject::add(const std::string& name, const JsonValue& value) {
  if (!members_.empty()) members_ += ", ";
  members_ += quoted(name) + ": " + value.text;
}

}  // namespace oktett
