#pragma once
/// \file A file that appears under its name only when it is complete.

#include <string>

namespace oktett {

/// Reserves a temporary name beside `path`, with the same extension, on construction; `commit` moves it to
/// `path`. Without that the destructor removes it.
class OutputFile {
 public:
  /// Creates the temporary, empty. Throws Error of kind io if `path` is no place to write to.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& temporary() const { return temporary_; }
  /// Flushes the temporary to the disk and renames it to the path. Throws Error of kind io.
  void commit();

 private:
  std::string path_;    ///< as the user gave it
  std::string target_;  ///< where symbolic links lead
  std::string temporary_;
};

}  // namespace oktett
