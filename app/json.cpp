#include "app/json.h"

#include <fmt/format.h>

#include <cmath>

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

static std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

void JsonObject::add_member(const std::string& name, const std::string& value) {
  if (!members_.empty()) members_ += ", ";
  members_ += quoted(name) + ": " + value;
}

void JsonObject::add(const std::string& name, const std::string& text) { add_member(name, quoted(text)); }
void JsonObject::add(const std::string& name, bool value) { add_member(name, value ? "true" : "false"); }
void JsonObject::add(const std::string& name, std::uint64_t value) {
  add_member(name, std::to_string(value));
}
void JsonObject::add(const std::string& name, double value) { add_member(name, number(value)); }
void JsonObject::add(const std::string& name, const JsonObject& value) { add_member(name, value.text()); }

void JsonObject::add(const std::string& name, const std::vector<double>& values) {
  std::string list;
  for (const double v : values) list += (list.empty() ? "" : ", ") + number(v);
  add_member(name, "[" + list + "]");
}

}  // namespace oktett
