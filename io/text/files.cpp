#include "io/text/files.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/error.h"

namespace oktett {

namespace fs = std::filesystem;

namespace {

/// Canonical; empty: any file may be read.
fs::path root_folder;

bool is_in_root(const fs::path& canonical) {
  const auto [root_end, rest] =
      std::mismatch(root_folder.begin(), root_folder.end(), canonical.begin(), canonical.end());
  return root_end == root_folder.end();
}

constexpr const char* kOutside = "lies outside of the folder that files may be read from";
constexpr const char* kNotRegular = "is not a regular file";

/// File systems whose files are no files: proc, sysfs, debugfs, tracefs, securityfs, cgroup, cgroup2, bpf,
/// efivarfs, pstore, configfs, selinuxfs (magic numbers as in linux/magic.h).
bool shows_the_system(std::uint64_t type) {
  constexpr std::array<std::uint64_t, 12> kTypes{0x9fa0,     0x62656572, 0x64626720, 0x74726163,
                                                 0x73636673, 0x27e0eb,   0x63677270, 0xcafe4a11,
                                                 0xde5e81e4, 0x6165676c, 0x62656570, 0xf97cff8c};
  return std::ranges::find(kTypes, type & 0xffffffffu) != kTypes.end();
}

}  // namespace

void confine_files(const std::string& root) {
  std::error_code error;
  fs::path canonical = fs::canonical(root, error);
  if (error) throw Error("no folder '" + root + "' to read files from: " + error.message(), ErrorKind::io);
  if (!fs::is_directory(canonical, error))
    throw Error("'" + root + "', to read files from, is not a folder", ErrorKind::io);
  root_folder = std::move(canonical);
}

bool files_are_confined() { return !root_folder.empty(); }

std::string why_unreadable(const std::string& named) {
  const std::string path = path_to_open(named);
  std::error_code error;
  // Strangers learn nothing about what is outside.
  if (files_are_confined() && (!is_in_root(fs::weakly_canonical(path, error)) || error)) return kOutside;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return "no such file" + did_you_mean_file(named);
  if (error) return error.message();
  if (fs::is_directory(status)) return "is a directory";
  if (!fs::is_regular_file(status)) return kNotRegular;
  struct statfs system {};
  if (statfs(path.c_str(), &system) == 0 && shows_the_system(static_cast<std::uint64_t>(system.f_type)))
    return kNotRegular;
  if (access(path.c_str(), R_OK) != 0) return "permission denied";
  return "";
}

std::string why_unreadable(int descriptor) {
  struct stat status {};
  struct statfs system {};
  if (fstat(descriptor, &status) != 0 || fstatfs(descriptor, &system) != 0)
    return std::generic_category().message(errno);
  if (S_ISDIR(status.st_mode)) return "is a directory";
  if (!S_ISREG(status.st_mode) || shows_the_system(static_cast<std::uint64_t>(system.f_type)))
    return kNotRegular;
  if (!files_are_confined()) return "";
  std::error_code error;
  const fs::path opened = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error);
  return error || !is_in_root(opened) ? kOutside : "";
}

std::string lower_case_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string path_beside(const std::string& from, const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::absolute(from, error).parent_path().lexically_normal();
  const fs::path name = fs::absolute(path, error).lexically_normal().lexically_relative(folder);
  return name.empty() ? path : name.string();
}

bool is_packed(const std::string& path) { return lower_case_extension(path) == ".gz"; }

std::string without_packing(const std::string& path) {
  return is_packed(path) ? path.substr(0, path.size() - 3) : path;
}

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

namespace {

std::mutex stand_in_mutex;
std::map<std::string, std::string> stand_ins;

}  // namespace

StandIns::StandIns(std::map<std::string, std::string> files) {
  const std::lock_guard lock(stand_in_mutex);
  stand_ins = std::move(files);
}

StandIns::~StandIns() {
  const std::lock_guard lock(stand_in_mutex);
  stand_ins.clear();
}

std::string path_to_open(const std::string& path) {
  const std::lock_guard lock(stand_in_mutex);
  const auto found = stand_ins.find(path);
  return found == stand_ins.end() ? path : found->second;
}

PrivateFolder::PrivateFolder() {
  std::error_code error;
  std::string pattern = (fs::temp_directory_path(error) / "oktett-XXXXXX").string();
  if (error || mkdtemp(pattern.data()) == nullptr)
    throw Error("no temporary folder can be made", ErrorKind::io);
  path_ = pattern;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path PrivateFolder::write(std::string_view name, std::string_view content) const {
  const fs::path file = path_ / name;
  const int to = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  bool written = to >= 0;
  while (written && !content.empty()) {
    // No more than 2 GB are written at once.
    const ssize_t count = ::write(to, content.data(), content.size());
    written = count > 0;
    if (written) content.remove_prefix(static_cast<std::size_t>(count));
  }
  if (to >= 0) close(to);
  if (!written) throw Error(file.string() + ": cannot be written", ErrorKind::io);
  return file;
}

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
