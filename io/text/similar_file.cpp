#include "io/text/similar_file.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "io/text/extension.h"
#include "io/text/file_access.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

/// Longer names are no typing errors, and take long to compare.
constexpr std::size_t kLongest = 100;
constexpr std::size_t kMostFiles = 10000;
constexpr std::size_t kUnlike = SIZE_MAX;

/// A name in lower case, without and with only what begins with its last dot.
struct Name {
  std::string stem, extension;

  explicit Name(const std::string& name) {
    std::string lower = name;
    for (char& c : lower)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    const fs::path path(lower);
    stem = path.stem().string(), extension = path.extension().string();
  }
};

/// How much two names differ; kUnlike if nobody would take one for the other.
std::size_t difference(const Name& a, const Name& b) {
  if (a.extension == b.extension) {
    const std::size_t distance = edit_distance(a.stem, b.stem),
                      least = std::min(a.stem.size(), b.stem.size());
    return distance < least && distance <= std::max<std::size_t>(1, least / 3) ? distance : kUnlike;
  }
  // jpg for png, yml for yaml, but not a mesh for the materials beside it.
  if (a.stem != b.stem || a.extension == ".mtl" || b.extension == ".mtl") return kUnlike;
  const std::size_t distance = edit_distance(a.extension, b.extension);
  return distance <= 2 ? 100 + distance : kUnlike;
}

/// Not for links that lead nowhere: for those why_unreadable asks for similar files itself.
bool is_readable(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && why_unreadable(path.string()).empty();
}

}  // namespace

std::string did_you_mean_file(const std::string& path) {
  const std::string wanted = fs::path(path).filename().string();
  if (wanted.empty() || wanted.size() > kLongest) return "";
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  const Name name(wanted);
  std::size_t best = kUnlike, seen = 0;
  std::string nearest;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && seen < kMostFiles; ++seen) {
    const std::string other = it->path().filename().string();
    const bool can_be = other != wanted && other.size() <= kLongest;
    const std::size_t d = can_be ? difference(name, Name(other)) : kUnlike;
    // Of equal ones the first by name, because folders have no order.
    if (d != kUnlike && (d < best || (d == best && other < nearest)) && is_readable(it->path()))
      best = d, nearest = other;
    it.increment(error);
  }
  return nearest.empty() ? "" : did_you_mean(nearest, std::vector{nearest});
}

}  // namespace oktett
