#include "io/text/files_read.h"

#include <map>
#include <mutex>

namespace oktett {
namespace {

std::mutex mutex;
bool noting = false;
std::map<std::string, std::optional<std::uint64_t>> noted;

}  // namespace

FilesRead::FilesRead() {
  const std::lock_guard lock(mutex);
  noting = true;
  noted.clear();
}

FilesRead::~FilesRead() {
  const std::lock_guard lock(mutex);
  noting = false;
  noted.clear();
}

std::vector<std::string> FilesRead::paths() const {
  const std::lock_guard lock(mutex);
  std::vector<std::string> paths;
  for (const auto& entry : noted) paths.push_back(entry.first);
  return paths;
}

void note_file_read(const std::string& path) {
  const std::lock_guard lock(mutex);
  if (noting) noted.try_emplace(path);
}

void note_content(const std::string& path, std::uint64_t checksum) {
  const std::lock_guard lock(mutex);
  if (noting) noted[path] = checksum;
}

std::optional<std::uint64_t> known_content(const std::string& path) {
  const std::lock_guard lock(mutex);
  const auto found = noted.find(path);
  return found == noted.end() ? std::nullopt : found->second;
}

}  // namespace oktett
