#include "io/image/output.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "core/error.h"

namespace oktett {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw Error(Location{path}, message, ErrorKind::io);
}

std::string reason(int error) { return std::error_code(error, std::generic_category()).message(); }

/// Follows symbolic links, so that renaming replaces the file and not the link to it.
fs::path resolve(const std::string& path) {
  std::error_code error;
  fs::path target = path;
  for (int links = 0; links < 40 && fs::is_symlink(target, error); ++links) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

void check_target(const std::string& path, const fs::path& target) {
  std::error_code error;
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(directory, error))
    fail(path, "cannot write: no directory '" + directory.string() + "'");
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) fail(path, "cannot write: is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(path, "cannot write: is not a regular file");
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) fail(path, "cannot write: " + reason(errno));
}

/// Creates a new file beside `target`; the number makes names unique within the process.
std::string create_beside(const std::string& path, const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const std::string name = ".oktett-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
    const fs::path candidate = target.parent_path() / (name + target.extension().string());
    const int file = open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
      close(file);
      return candidate.string();
    }
    if (errno != EEXIST) fail(path, "cannot write: " + reason(errno));
  }
  fail(path, "cannot write: no free temporary name in the directory");
}

/// A rename may reach the disk before the data it names, unless the data is flushed first.
void flush(const std::string& path, const std::string& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot write: " + reason(errno));
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  // Some file systems cannot flush; that is no reason to lose a picture.
  if (error != 0 && error != EINVAL && error != ENOTSUP) fail(path, "cannot write: " + reason(error));
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path) {
  const fs::path target = resolve(path);
  check_target(path, target);
  target_ = target.string();
  temporary_ = create_beside(path, target);
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::commit() {
  flush(path_, temporary_);
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(path_, "cannot write: " + error.message());
  temporary_.clear();
}

}  // namespace oktett
