#pragma once
/// \file A file that appears under its name only when it is complete.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace oktett {

/// Is written to a temporary file in the directory of `path`, which `commit` renames to `path`; without that
/// it is gone with the object. Where the file system can, the temporary has no name until then, so nothing is
/// left of it even if the process is killed.
class OutputFile {
 public:
  /// Creates the temporary, empty. Throws Error of kind io if `path` is no place to write to.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The name of the temporary, with the extension of `path`, for those who write by name.
  const std::string& temporary();
  /// Writes `bytes` at place() and moves it behind them. Throws Error of kind io.
  void write(std::string_view bytes);
  /// Where the next byte is written, counted from the start of the file.
  std::uint64_t place() const { return place_; }
  void seek(std::uint64_t place) { place_ = place; }
  /// Flushes the temporary to the disk and renames it to the path. Throws Error of kind io.
  void commit();
  /// The same without flushing: after a crash of the machine the file may lack some of its bytes. It counts
  /// as changed last at `time`, in nanoseconds since 1970.
  void commit_unflushed(std::int64_t time);

 private:
  void rename_to_target();

  std::string path_;       ///< as the user gave it
  std::string target_;     ///< where symbolic links lead
  std::string temporary_;  ///< empty while the temporary has no name
  int file_ = -1;          ///< the temporary, open for writing
  std::uint64_t place_ = 0;
};

/// Whether an OutputFile of `a` would replace that of `b`: they name the same file, perhaps through symbolic
/// links. Neither needs to exist.
bool is_same_output(const std::string& a, const std::string& b);

/// Removes the temporaries of all OutputFiles that exist. For the end of a process in which destructors do
/// not run; may be called in a signal handler.
void remove_unfinished_files();

}  // namespace oktett
