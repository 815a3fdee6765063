#pragma once
/// \file Files by their names: which may be read, which were read, which one a misspelt name means, what is
/// opened in place of another. And a folder for temporary files.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oktett {

/// From here on, only files below the folder `root` may be read, wherever symbolic links lead. For the whole
/// process; call it before threads read. Throws Error if there is no such folder.
void confine_files(const std::string& root);

/// Whether confine_files has been called.
bool files_are_confined();

/// Why `path` cannot be read as a regular file, e.g. "no such file"; empty if it can. The files by which the
/// system shows its state (/proc, /sys and the like) do not count as regular: they may never end, and some
/// change the system when they are read.
std::string why_unreadable(const std::string& path);

/// The same for a file that has been opened: whatever its path leads to by now, this is what will be read.
std::string why_unreadable(int descriptor);

/// ".obj" of "a.OBJ".
std::string lower_case_extension(const std::string& path);

/// `path` as seen from the folder in which the file `from` lies.
std::string path_beside(const std::string& from, const std::string& path);

/// Whether the name ends in `.gz`, in upper or lower case: gzip has packed the file.
bool is_packed(const std::string& path);
/// The path without that end.
std::string without_packing(const std::string& path);

/// "; did you mean 'x'?" with the file in the folder of `path` whose name is most like that of `path`, which
/// does not exist; nothing if none is. Upper and lower case count as the same, and about one letter in three
/// may differ. Looks at no more than 10,000 names, and names no file that may not be read.
std::string did_you_mean_file(const std::string& path);

/// While an object of this class exists, whoever reads the file `first` of an entry reads the file `second`.
/// Messages and FilesRead name the first. For the whole process; only one may exist at a time.
class StandIns {
 public:
  explicit StandIns(std::map<std::string, std::string> files);
  ~StandIns();
  StandIns(const StandIns&) = delete;
  StandIns& operator=(const StandIns&) = delete;
};

/// The path of the file that is opened for `path`: that of its stand-in, or `path` itself. Threads may call
/// it at the same time.
std::string path_to_open(const std::string& path);

/// A new folder for temporary files that only this user can enter. It is removed with all it holds at the
/// end of its life.
class PrivateFolder {
 public:
  /// Throws Error.
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Makes a file that only this user can read, and returns its path. Throws Error.
  std::filesystem::path write(std::string_view name, std::string_view content) const;

 private:
  std::filesystem::path path_;
};

/// Notes the files that are read while an object of this class exists. Only one may exist at a time.
class FilesRead {
 public:
  FilesRead();
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;

  /// Their paths as they were opened, each once, in alphabetical order.
  std::vector<std::string> paths() const;
};

/// Called by whoever opens a file of a scene. Threads may call it at the same time.
void note_file_read(const std::string& path);

/// The checksum of the content of a file that is being noted, where it is known without reading the file.
void note_content(const std::string& path, std::uint64_t checksum);
std::optional<std::uint64_t> known_content(const std::string& path);

}  // namespace oktett
