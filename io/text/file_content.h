#pragma once
/// \file The content of a file: mapped into memory without a copy, or unpacked by gzip.

#include <cstddef>
#include <optional>
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

/// Bytes in memory of their own, behind which more zero bytes follow.
class UnpackedBytes {
 public:
  /// Throws std::bad_alloc if there is no room for `capacity` bytes.
  explicit UnpackedBytes(std::size_t capacity);
  ~UnpackedBytes();
  UnpackedBytes(UnpackedBytes&& other) noexcept;
  UnpackedBytes& operator=(UnpackedBytes&&) = delete;
  UnpackedBytes(const UnpackedBytes&) = delete;
  UnpackedBytes& operator=(const UnpackedBytes&) = delete;

  char* data() { return data_; }
  const char* data() const { return data_; }
  std::size_t capacity() const { return capacity_; }
  /// Moves pages, copies nothing. Bytes that are new are zero.
  void resize(std::size_t capacity);

  std::size_t size = 0;  ///< bytes that count

 private:
  char* data_ = nullptr;
  std::size_t capacity_ = 0;
};

/// The most that `packed` bytes may unpack to: files of meshes shrink to a tenth, small ones may be all
/// zeros.
constexpr std::size_t most_unpacked(std::size_t packed) { return (std::size_t{16} << 20) + 256 * packed; }

/// Unpacks all members of a gzip file one after the other; `padding` zero bytes follow the result. Memory
/// grows with the data. Throws Error, which names `path`, if they are damaged, cut short, followed by
/// something else than zeros, or unpack to more than most_unpacked.
UnpackedBytes unpack_gzip(const std::string& path, std::string_view packed, std::size_t padding);

/// Reads as MappedFile does. A file whose name ends in `.gz` is unpacked to memory.
class FileContent {
 public:
  static constexpr std::size_t kPadding = MappedFile::kPadding;

  /// Throws Error as MappedFile and unpack_gzip do.
  explicit FileContent(const std::string& path);

  /// The content, with kPadding zero bytes behind it.
  std::string_view text() const;
  /// As MappedFile::release; what was unpacked stays.
  void release(const char* begin, const char* end) const;

 private:
  std::optional<MappedFile> mapped_;
  std::optional<UnpackedBytes> unpacked_;
};

}  // namespace oktett
