#pragma once
/// \file Which files a scene is read from.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace oktett {

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
