#include "io/text/files_read.h"

#include <mutex>
#include <set>

namespace oktett {
namespace {

std::mutex mutex;
bool noting = false;
std::set<std::string> noted;

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
  return {noted.begin(), noted.end()};
}

void note_file_read(const std::string& path) {
  const std::lock_guard lock(mutex);
  if (noting) noted.insert(path);
}

}  // namespace oktett
