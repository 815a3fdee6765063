#pragma once
/// \file Files that a scene opens with #fopen: text that it reads value by value, or writes.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace oktett::pov {

class TextFile {
 public:
  enum class Mode : std::uint8_t { read, write, append };

  /// Opens `name` below `folder`. Throws what is wrong as a std::string: paths that are absolute, have `..`,
  /// or pass a link are refused.
  TextFile(const std::string& folder, const std::string& name, Mode mode, std::size_t most_bytes);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;

  Mode mode() const { return mode_; }
  /// Whether a file that is read has nothing more, or was closed.
  bool at_end() const { return closed_ || (mode_ == Mode::read && next_ >= text_.size()); }
  /// The rest of a file that is read.
  std::string_view rest() const { return std::string_view(text_).substr(next_); }
  void skip(std::size_t count) { next_ += count; }
  /// Throws what is wrong as a std::string. Small pieces are written together, the last ones by close().
  void write(std::string_view text);
  /// What has been written or read so far, in bytes.
  std::size_t size() const { return text_.size(); }
  /// Throws as write() does.
  void close();

 private:
  void flush();

  Mode mode_;
  bool closed_ = false;
  int descriptor_ = -1;
  std::string text_;
  std::string unwritten_;
  std::size_t next_ = 0;
};

}  // namespace oktett::pov
