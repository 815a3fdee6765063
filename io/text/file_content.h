#pragma once
/// \file The content of a file, which may be packed by gzip.

#include <optional>
#include <string>
#include <string_view>

#include "io/text/gzip.h"
#include "io/text/mapped_file.h"

namespace oktett {

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
