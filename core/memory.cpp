#include "core/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

namespace oktett {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

/// The number that a file begins with; nothing for "max" and for files that there are not.
std::optional<std::uint64_t> number_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

/// The number behind a word at the beginning of a line.
std::optional<std::uint64_t> number_behind(const std::string& path, const std::string& word) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string first;
    std::uint64_t number = 0;
    if (words >> first >> number && first == word) return number;
  }
  return std::nullopt;
}

/// What a control group leaves. Its file pages that are not in use can be taken back.
std::uint64_t left_by(const std::string& group, const char* limit, const char* usage, const char* cache) {
  const std::optional<std::uint64_t> most = number_in(group + '/' + limit),
                                     used = number_in(group + '/' + usage);
  if (!most || !used) return kUnknown;
  const std::uint64_t idle = number_behind(group + "/memory.stat", cache).value_or(0);
  const std::uint64_t held = *used - std::min(*used, idle);
  return *most - std::min(*most, held);
}

}  // namespace

std::uint64_t available_memory(const std::string& meminfo, const std::string& self,
                               const std::string& groups) {
  std::uint64_t bytes = kUnknown;
  if (const auto kilobytes = number_behind(meminfo, "MemAvailable:");
      kilobytes && *kilobytes < kUnknown / 1024)
    bytes = *kilobytes * 1024;
  std::ifstream file(self);
  for (std::string line; std::getline(file, line);) {
    // "0::/a/b" of version 2, "4:memory:/a/b" of version 1; a container may see no more than the root.
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool new_version = controllers.empty();
    if (!new_version && controllers != "memory") continue;
    const std::string top = new_version ? groups : groups + "/memory";
    std::string path = line.substr(second + 1);
    for (;;) {
      while (path.ends_with('/')) path.pop_back();
      bytes =
          std::min(bytes, new_version ? left_by(top + path, "memory.max", "memory.current", "inactive_file")
                                      : left_by(top + path, "memory.limit_in_bytes", "memory.usage_in_bytes",
                                                "total_inactive_file"));
      if (path.empty()) break;
      path.erase(path.rfind('/') == std::string::npos ? 0 : path.rfind('/'));
    }
  }
  return bytes;
}

std::uint64_t available_memory() {
  return available_memory("/proc/meminfo", "/proc/self/cgroup", "/sys/fs/cgroup");
}

std::string memory_text(std::uint64_t bytes) {
  if (bytes >= 1'000'000'000) return fmt::format("{:.1f} GB", static_cast<double>(bytes) / 1e9);
  return fmt::format("{:.0f} MB", static_cast<double>(bytes) / 1e6);
}

}  // namespace oktett
