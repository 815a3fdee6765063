#pragma once
/// \file Read-only access to a whole file through the page cache, without a copy.

#include <cstddef>
#include <string>
#include <string_view>

namespace oktett {

/// Maps a regular file for reading. A file that is cut short by another process while it is mapped raises
/// SIGBUS on access, as with every mapping.
class MappedFile {
 public:
  /// So many zero bytes can be read past the end of the text: scanners may load whole blocks and need not
  /// test for the end at every character.
  static constexpr std::size_t kPadding = 64;

  /// Throws Error of ErrorKind::io if `path` is missing, unreadable or not a regular file.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// The content; text().data()[text().size()] is 0.
  std::string_view text() const { return {data_, size_}; }

  /// Gives the memory of the whole pages within [begin, end) back. They may still be read, at the price of
  /// fetching them again.
  void release(const char* begin, const char* end) const;

 private:
  char* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t reserved_ = 0;
};

}  // namespace oktett
