#include "io/scene/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "core/error.h"
#include "core/precise_math.h"
#include "io/text/files.h"
#include "io/yaml/utf8.h"
#include "kernels/functions/expression.h"

namespace oktett {

std::string describe(const Range& range, const char* noun) {
  const auto& [lo, hi, lo_open, hi_open, unit] = range;
  const bool has_lo = lo > -kMaxCoordinate, has_hi = hi < kMaxCoordinate;
  if (has_lo && has_hi && !lo_open && !hi_open) return fmt::format("{} from {} to {}", noun, lo, hi);
  const std::string least = fmt::format("{} {}", lo_open ? "greater than" : "of at least", lo);
  const std::string greatest = fmt::format("{} {}", hi_open ? "less than" : "of at most", hi);
  if (has_lo && has_hi) return fmt::format("{} {} and {}", noun, least, greatest);
  if (has_lo) return fmt::format("{} {}", noun, least);
  return has_hi ? fmt::format("{} {}", noun, greatest) : noun;
}

std::vector<MapEntry> map_entries(const YamlNode& node, const std::string& what) {
  std::vector<MapEntry> entries;
  if (node.kind == YamlKind::null) return entries;
  if (node.kind != YamlKind::map)
    throw Error(node.where(), "expected a map for " + what + ", found " + node.describe());
  for (std::size_t i = 0; i + 1 < node.items.size(); i += 2)
    entries.push_back({node.items[i], node.items[i + 1]});
  return entries;
}

std::span<const YamlNode* const> list_items(const YamlNode& node, const std::string& what) {
  if (node.kind == YamlKind::null) return {};
  if (node.kind != YamlKind::sequence)
    throw Error(node.where(), "expected a list for " + what + ", found " + node.describe());
  return node.items;
}

std::string suggest(const std::string& name, std::span<const std::string> known) {
  return did_you_mean(name, known);
}

Fields::Fields(const YamlNode& node, const std::string& what, std::span<const char* const> known)
    : node_(node), what_(what) {
  for (const auto& [key, value] : map_entries(node, what)) {
    if (std::find(known.begin(), known.end(), key->text) != known.end()) continue;
    const std::vector<std::string> names(known.begin(), known.end());
    std::string message = "unknown key " + quote(key->text) + " in " + what + suggest(key->text, names);
    if (message.back() != '?') message += fmt::format("; known are {}", fmt::join(names, ", "));
    report(*key, message);
  }
}

const YamlNode* Fields::operator[](const char* key) const {
  if (node_.kind != YamlKind::map) return nullptr;
  for (std::size_t i = 0; i < node_.items.size(); i += 2)
    if (node_.items[i]->text == key) return node_.items[i + 1];
  return nullptr;
}

const YamlNode& Fields::require(const char* key) const {
  if (const YamlNode* value = (*this)[key]) return *value;
  const Error error(node_.where(), what_ + " needs " + quote(key));
  ErrorList* const errors = node_.file->errors;
  if (errors == nullptr) throw error;
  if (!node_.missing) errors->add_if_first(error);
  return errors->missing_value(node_);
}

/// A number in the range.
static double some_number(const Range& range) {
  for (const double x : {1.0, 0.5, 0.0, range.lo, range.hi})
    if (range.contains(x)) return x;
  return 0.5 * (range.lo + range.hi);
}

std::string SceneValues::text(const YamlNode& node) {
  if (node.kind != YamlKind::scalar) throw Error(node.where(), "expected text, found " + node.describe());
  return parameters_.expand(node);
}

bool SceneValues::boolean(const YamlNode& node) {
  const auto read = [&] {
    const std::string word = node.kind == YamlKind::scalar ? text(node) : "";
    if (word == "true") return true;
    if (word == "false") return false;
    throw Error(node.where(), "expected true or false, found " + node.describe());
  };
  return read_or(node, read, [] { return false; });
}

static bool is_plain_word(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '.' || c == '~';
  });
}

double SceneValues::expression(const YamlNode& node, const std::string& text) {
  try {
    return evaluate(parse_expression(text));
  } catch (const Error& e) {
    // A single word is a mistake of another kind than a wrong expression.
    if (!node.quoted && is_plain_word(text))
      throw Error(node.where(), "expected a number, found " + quote(text));
    const auto at = std::min(static_cast<std::size_t>(e.where().column) - 1, text.size());
    const bool as_written = text == node.text;
    std::string message = fmt::format("bad expression: {} (column {})", e.what(), e.where().column);
    if (text.size() <= 200 && text.find('\n') == std::string::npos)
      message += fmt::format("\n  {}\n  {}^", text, std::string(character_count(text.substr(0, at)), ' '));
    throw Error(as_written ? node.where(at) : node.where(), message);
  }
}

double SceneValues::number(const YamlNode& node, const Range& range) {
  return read_or(
      node, [&] { return read_number(node, range); }, [&] { return some_number(range); });
}

double SceneValues::read_number(const YamlNode& node, const Range& range) {
  if (node.kind != YamlKind::scalar) throw Error(node.where(), "expected a number, found " + node.describe());
  const std::string written = text(node);
  const char* begin = written.data() + (written.starts_with('+') ? 1 : 0);
  const char* const end = written.data() + written.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc::result_out_of_range && stop == end)
    throw Error(node.where(), "number out of range: " + quote(written));
  const bool is_infinite_in_yaml = written.ends_with(".inf") || written == ".nan";
  if (is_infinite_in_yaml) value = std::numeric_limits<double>::infinity();
  if (!is_infinite_in_yaml && (error != std::errc() || stop != end)) value = expression(node, written);
  if (!std::isfinite(value)) throw Error(node.where(), "expected a finite number, found " + quote(written));
  if (range.contains(value)) return value;
  if (std::abs(value) > kMaxCoordinate)
    throw Error(node.where(), fmt::format("number out of range: {} (magnitude at most {:g})", quote(written),
                                          kMaxCoordinate));
  throw Error(node.where(),
              fmt::format("expected {}, found {}", describe(range, "a number"), quote(written)));
}

float SceneValues::single(const YamlNode& node, const Range& range) {
  const auto value = static_cast<float>(number(node, range));
  // A tiny number may become a zero that is not allowed.
  if (!range.contains(value))
    report(node, "expected " + describe(range, "a number") + ", found " + node.describe());
  return value;
}

std::uint32_t SceneValues::integer(const YamlNode& node, std::uint32_t lo, std::uint32_t hi) {
  return read_or(
      node, [&] { return read_integer(node, lo, hi); }, [&] { return lo; });
}

std::uint32_t SceneValues::read_integer(const YamlNode& node, std::uint32_t lo, std::uint32_t hi) {
  const double value =
      number(node, {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()});
  if (value != std::floor(value) || value < lo || value > hi)
    throw Error(node.where(),
                fmt::format("expected a whole number from {} to {}, found {}", lo, hi, node.describe()));
  return static_cast<std::uint32_t>(value);
}

void SceneValues::numbers(const YamlNode& node, std::span<double> out, const Range& range) {
  if (node.missing || !attempt(node, [&] { read_numbers(node, out, range); }))
    std::fill(out.begin(), out.end(), some_number(range));
}

void SceneValues::read_numbers(const YamlNode& node, std::span<double> out, const Range& range) {
  if (node.kind != YamlKind::sequence)
    throw Error(node.where(),
                fmt::format("expected a list of {} numbers, found {}", out.size(), node.describe()));
  if (node.items.size() != out.size())
    throw Error(node.where(), fmt::format("expected {} numbers, found {}", out.size(), node.items.size()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = number(*node.items[i], range);
}

Vec3d SceneValues::vector(const YamlNode& node) {
  double v[3];
  numbers(node, v);
  return {v[0], v[1], v[2]};
}

static float linear_from_srgb(int byte) {
  const double s = byte / 255.0;
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : precise::pow((s + 0.055) / 1.055, 2.4));
}

Color SceneValues::color(const YamlNode& node) {
  return read_or(
      node, [&] { return color_of(node); },
      [] {
        return Color{1, 1, 1};
      });
}

Color SceneValues::color_of(const YamlNode& node) {
  if (node.kind == YamlKind::sequence) {
    double c[3];
    numbers(node, c, kNonNegative);
    return static_cast<Color>(Vec3d{c[0], c[1], c[2]});
  }
  const std::string written = node.kind == YamlKind::scalar ? text(node) : "";
  unsigned rgb = 0;
  const char* const end = written.data() + written.size();
  if (written.size() == 7 && written[0] == '#') {
    const auto [stop, error] = std::from_chars(written.data() + 1, end, rgb, 16);
    if (error == std::errc() && stop == end)
      return {linear_from_srgb(rgb >> 16), linear_from_srgb(rgb >> 8 & 255), linear_from_srgb(rgb & 255)};
  }
  const char* hint = node.kind == YamlKind::null ? " (a colour that starts with # must stand in quotes)" : "";
  throw Error(node.where(), "expected a colour, [r, g, b] or \"#rrggbb\", found " + node.describe() + hint);
}

std::string SceneValues::existing_file(const YamlNode& node) {
  if (node.missing) throw FollowingError();
  const std::string written = text(node);
  if (written.empty()) throw Error(node.where(), "expected the path of a file, found nothing");
  // A NUL would cut the path short on its way to the system.
  if (written.find('\0') != std::string::npos) throw Error(node.where(), "not a path: " + quote(written));
  // The same path as an operator on std::filesystem::path, which keeps an absolute path as it is.
  const std::string path = (std::filesystem::path(node.file->path).parent_path() / written).string();
  if (const std::string reason = why_unreadable(path); !reason.empty())
    throw Error(node.where(), quote(path, 1000) + ": " + reason);
  return path;
}

void SceneValues::fail_choice(const YamlNode& node, const std::string& word,
                              std::span<const std::string> names) {
  std::string message = fmt::format("expected {}, found {}", fmt::join(names, " or "), quote(word));
  throw Error(node.where(), message + suggest(word, names));
}

}  // namespace oktett
