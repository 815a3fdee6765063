#include "io/image/output.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>
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

// The names of temporaries that exist, for remove_unfinished_files(). More than these at a time are not known
// there.
constexpr std::size_t kMostNames = 16;
constexpr std::size_t kLongestName = 4096;
struct UnfinishedName {
  std::atomic<bool> taken{false}, complete{false};
  char text[kLongestName];
};
UnfinishedName unfinished[kMostNames];

void remember(const std::string& name) {
  if (name.size() >= kLongestName) return;
  for (UnfinishedName& u : unfinished) {
    if (u.taken.exchange(true)) continue;
    std::copy_n(name.c_str(), name.size() + 1, u.text);
    u.complete = true;
    return;
  }
}

void forget(const std::string& name) {
  for (UnfinishedName& u : unfinished) {
    if (!u.complete || name != u.text) continue;
    u.complete = false;
    u.taken = false;
    return;
  }
}

/// Calls `create(name)` with new names beside `target` until it does not fail because there is such a file;
/// the number makes names unique within the process. Returns its result and puts the name into `name`.
template <class Create>
int create_beside(const std::string& path, const fs::path& target, std::string& name, const Create& create) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const std::string stem = ".oktett-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
    name = (target.parent_path() / (stem + target.extension().string())).string();
    const int result = create(name.c_str());
    if (result >= 0) {
      remember(name);
      return result;
    }
    if (errno != EEXIST) break;
  }
  name.clear();
  fail(path, "cannot write: " + reason(errno));
}

/// Where a file that is open can be found without its name.
std::string place_of(int file) { return "/proc/self/fd/" + std::to_string(file); }

/// A file without a name in the directory of `target`; -1 if the file system has none or cannot name it
/// later.
int create_unnamed(const fs::path& target) {
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const int file = open(directory.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0 || access(place_of(file).c_str(), F_OK) == 0) return file;
  close(file);
  return -1;
}

}  // namespace

void remove_unfinished_files() {
  for (UnfinishedName& u : unfinished)
    if (u.complete) unlink(u.text);
}

bool is_same_output(const std::string& a, const std::string& b) {
  const auto place = [](const std::string& path) {
    const fs::path target = fs::absolute(resolve(path)).lexically_normal();
    std::error_code error;
    const fs::path directory = fs::weakly_canonical(target.parent_path(), error);
    return (error ? target.parent_path() : directory) / target.filename();
  };
  return place(a) == place(b);
}

OutputFile::OutputFile(const std::string& path) : path_(path) {
  const fs::path target = resolve(path);
  check_target(path, target);
  target_ = target.string();
  file_ = create_unnamed(target);
  if (file_ >= 0) return;
  file_ = create_beside(path, target, temporary_, [](const char* name) {
    return open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  });
}

OutputFile::~OutputFile() {
  close(file_);
  if (temporary_.empty()) return;
  unlink(temporary_.c_str());
  forget(temporary_);
}

const std::string& OutputFile::temporary() {
  if (temporary_.empty())
    create_beside(path_, target_, temporary_, [this](const char* name) {
      return linkat(AT_FDCWD, place_of(file_).c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW);
    });
  return temporary_;
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(place_));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, "cannot write: " + reason(errno));
    place_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::commit() {
  // A rename may reach the disk before the data it names, unless the data is flushed first. Some file systems
  // cannot flush; that is no reason to lose a picture.
  if (fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(path_, "cannot write: " + reason(errno));
  rename_to_target();
}

void OutputFile::commit_unflushed(std::int64_t time) {
  timespec times[2];
  for (timespec& t : times)
    t.tv_sec = static_cast<time_t>(time / 1'000'000'000), t.tv_nsec = static_cast<long>(time % 1'000'000'000);
  if (futimens(file_, times) != 0) fail(path_, "cannot write: " + reason(errno));
  rename_to_target();
}

void OutputFile::rename_to_target() {
  std::error_code error;
  fs::rename(temporary(), target_, error);
  if (error) fail(path_, "cannot write: " + error.message());
  forget(temporary_);
  temporary_.clear();
}

}  // namespace oktett
