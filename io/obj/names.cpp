#include "io/obj/names.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace oktett {
namespace {

std::string_view without_blanks_behind(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string with_plain_blanks(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == ' ') continue;
    plain += text[i];
  }
  return plain;
}

std::string with_slashes(std::string text) {
  std::replace(text.begin(), text.end(), '\\', '/');
  return text;
}

std::string without_quotes(const std::string& text) {
  if (text.size() < 3 || text.front() != '"' || text.back() != '"') return text;
  return text.substr(1, text.size() - 2);
}

bool exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

}  // namespace

std::string_view without_comment(std::string_view text) {
  for (std::size_t i = 1; i < text.size(); ++i)
    if (text[i] == '#' && (text[i - 1] == ' ' || text[i - 1] == '\t'))
      return without_blanks_behind(text.substr(0, i));
  return text;
}

std::vector<std::string> readings_of_name(std::string_view text) {
  std::vector<std::string> readings;
  const auto add = [&](std::string reading) {
    if (std::ranges::find(readings, reading) == readings.end()) readings.push_back(std::move(reading));
  };
  for (const std::string_view whole : {text, without_comment(text)}) {
    const std::string plain = with_plain_blanks(whole), bare = without_quotes(plain);
    add(std::string(whole)), add(with_slashes(std::string(whole)));
    add(plain), add(with_slashes(plain));
    add(bare), add(with_slashes(bare));
  }
  return readings;
}

std::string find_named_file(const std::string& directory, std::string_view text) {
  const auto in_directory = [&](const std::string& name) {
    return (std::filesystem::path(directory) / name).string();
  };
  const std::vector<std::string> readings = readings_of_name(text);
  for (const std::string& reading : readings)
    if (std::string path = in_directory(reading); exists(path)) return path;
  return in_directory(readings.back());
}

std::string plain_material_name(std::string_view text) { return with_plain_blanks(without_comment(text)); }

}  // namespace oktett
