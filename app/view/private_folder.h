#pragma once
/// \file Temporary files that other users of the machine cannot read.

#include <filesystem>
#include <string_view>

namespace oktett {

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

}  // namespace oktett
