#pragma once
/// \file A file that appears under its name only when it is complete.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

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
  /// Writes `bytes` behind what this object wrote before, and returns the place in the file at which they
  /// start. Throws Error of kind io.
  std::uint64_t append(std::string_view bytes);
  /// Appends make(0), make(1), ... make(count - 1), which any number of threads make at a time, and returns
  /// their places. Throws what `make` throws, and Error of kind io.
  std::vector<std::uint64_t> append_blocks(std::size_t count,
                                           const std::function<std::string(std::size_t)>& make);
  /// Writes `bytes` at a place where something was appended. Throws Error of kind io.
  void overwrite(std::uint64_t place, std::string_view bytes);
  /// Flushes the temporary to the disk and renames it to the path. Throws Error of kind io.
  void commit();

 private:
  std::string path_;    ///< as the user gave it
  std::string target_;  ///< where symbolic links lead
  std::string temporary_;
  int file_ = -1;           ///< the temporary, open for writing
  std::uint64_t size_ = 0;  ///< of what was appended
};

}  // namespace oktett
