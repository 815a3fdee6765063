#include "io/text/file_access.h"

#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "core/error.h"
#include "io/text/similar_file.h"
#include "io/text/stand_ins.h"

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

}  // namespace oktett
