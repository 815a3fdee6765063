#pragma once
/// \file Files of the cache: a header and large sections that are mapped into memory. Within io/ only.
///
/// A file is a line with the version of the format, the length of the header, the header, and its checksum;
/// the header begins with the sizes and checksums of the sections. Each section begins at a multiple of 64
/// KiB. All numbers are little-endian. Files are not trusted: lengths are compared with that of the file, and
/// nothing is used whose checksum is wrong.

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/pages.h"
#include "core/soa.h"

namespace oktett {

/// The bytes of a section.
struct CacheSection {
  const void* data = nullptr;
  std::size_t bytes = 0;
};

template <class T>
CacheSection section_of(const Column<T>& column) {
  return {column.data(), column.size() * sizeof(T)};
}

/// Nanoseconds since 1970.
std::int64_t nanoseconds(const timespec& time);

/// The size of such a file.
std::uint64_t cache_file_bytes(std::string_view header, std::span<const CacheSection> sections);

/// Writes the file under another name and renames it. It counts as changed last at `time`, in nanoseconds
/// since 1970. Throws Error of kind io; then nothing has changed.
void write_cache_file(const std::string& path, std::string_view header,
                      std::span<const CacheSection> sections, std::int64_t time);

/// A file that has been opened.
class CacheFile {
 public:
  /// Reads the header. Throws Error with the path if there is no such file, or if it is none of this version
  /// or damaged.
  explicit CacheFile(const std::string& path);
  ~CacheFile();
  CacheFile(const CacheFile&) = delete;
  CacheFile& operator=(const CacheFile&) = delete;

  const std::string& header() const { return header_; }
  std::size_t sections() const { return sections_.size(); }
  /// When the file was changed last, in nanoseconds since 1970.
  std::int64_t time() const { return time_; }
  /// It counts as changed now, if that is permitted.
  void touch() const;
  /// Throws Error that names the file.
  [[noreturn]] void fail(const std::string& message) const;

  /// The elements of a section, mapped for reading. Throws Error if the checksum is wrong.
  template <class T>
  VirtualArray<T> map(std::size_t section) const {
    VirtualArray<T> array(count<T>(section));
    map_to(section, array.data());
    return array;
  }
  /// A copy of the elements of a section. Throws Error if the checksum is wrong.
  template <class T>
  void copy(std::size_t section, Column<T>& column) const {
    column.resize_uninitialized(count<T>(section));
    copy_to(section, column.data());
  }
  /// The number of elements of a section. Throws Error if its size is no multiple of theirs.
  template <class T>
  std::size_t count(std::size_t section) const {
    const std::size_t bytes = section_bytes(section);
    if (bytes % sizeof(T) != 0) fail("a section has an impossible size");
    return bytes / sizeof(T);
  }

 private:
  struct Entry {
    std::uint64_t bytes, checksum, place;
  };
  void read_header();
  std::size_t section_bytes(std::size_t section) const;
  void map_to(std::size_t section, void* memory) const;
  void copy_to(std::size_t section, void* memory) const;

  std::string path_;
  int file_ = -1;
  std::int64_t time_ = 0;
  std::string header_;
  std::vector<Entry> sections_;
};

}  // namespace oktett
