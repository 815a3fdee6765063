#include "core/error.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace oktett {

std::string to_string(const Location& where) {
  std::string s = where.file;
  for (const int number : {where.line, where.line > 0 ? where.column : 0})
    if (number > 0) s.append(1, ':').append(std::to_string(number));
  return s;
}

static std::string place_first(const Location& where, const std::string& message) {
  return where.file.empty() ? message : to_string(where) + ": " + message;
}

Error::Error(const std::string& message, ErrorKind kind) : std::runtime_error(message), kind_(kind) {}

Error::Error(Location where, const std::string& message, ErrorKind kind)
    : std::runtime_error(place_first(where, message)), where_(std::move(where)), kind_(kind) {}

std::string to_string(const Warning& warning) {
  return place_first(warning.where, "warning: " + warning.message);
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

std::string nearest_name(const std::string& name, const char* const* known, std::size_t known_count) {
  // A name of thousands of characters is not a typing error, and computing its distance takes quadratic time.
  if (name.size() > 64) return {};
  std::size_t best = std::max<std::size_t>(2, name.size() / 3) + 1;
  std::string nearest;
  for (std::size_t i = 0; i < known_count; ++i) {
    const std::size_t d = edit_distance(name, known[i]);
    if (d < best) best = d, nearest = known[i];
  }
  return nearest;
}

std::string did_you_mean(const std::string& name, std::span<const std::string> known,
                         const std::string& otherwise) {
  // Enough for names that people write; a machine's million names would take too long to compare.
  constexpr std::size_t kMostNames = 10000;
  std::vector<const char*> names;
  for (const std::string& k : known.first(std::min(known.size(), kMostNames))) names.push_back(k.c_str());
  std::string nearest = nearest_name(name, names.data(), names.size());
  // A name that shares no letter with it was not meant.
  if (edit_distance(name, nearest) >= name.size()) nearest.clear();
  if (nearest.empty()) return otherwise.empty() ? "" : "; " + otherwise;
  for (char& c : nearest)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return "; did you mean '" + nearest + "'?";
}

static std::string list_of(std::span<const std::string> words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  return text;
}

std::string or_list(std::span<const std::string> words) { return list_of(words, " or "); }
std::string and_list(std::span<const std::string> words) { return list_of(words, " and "); }

}  // namespace oktett
