#pragma once
/// \file A directory that lives as long as a test.

#include <cstddef>
#include <filesystem>
#include <string>

namespace oktett::test {

/// Creates an empty directory on construction and removes it with all it holds on destruction.
class TempDir {
 public:
  TempDir();
  ~TempDir();
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Path of `name` inside the directory.
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Writes `content` to `name` inside the directory and returns its path.
  std::string write(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

/// The bytes of a file; none if it cannot be read.
std::string file_content(const std::filesystem::path& path);

/// The number of files and folders directly in a directory.
std::size_t file_count(const TempDir& directory);

}  // namespace oktett::test
