#include "io/image/library.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "io/library/loaded_library.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett {

namespace {

/// Among the libraries that come along are some whose constructors start threads.
constexpr LoadedLibrary kImages{OKTETT_IMAGE_LIBRARY, kImageLibraryEntry, "reads and writes images",
                                std::size_t{512} << 20};

}  // namespace

const ImageLibrary& image_library() {
  static const ImageLibrary* const library = reinterpret_cast<ImageLibraryEntry>(load_library(kImages))();
  return *library;
}

bool image_library_is_installed() { return is_installed(kImages); }

namespace {

using namespace std::string_view_literals;

/// How files of EXR, PNG, JPEG, TIFF, Radiance HDR, BMP and PNM begin.
constexpr std::string_view kBeginnings[] = {"\x76\x2f\x31\x01"sv,
                                            "\x89PNG\r\n"sv,
                                            "\xff\xd8\xff"sv,
                                            "II*\0"sv,
                                            "MM\0*"sv,
                                            "II+\0"sv,
                                            "MM\0+"sv,
                                            "#?RADIANCE"sv,
                                            "#?RGBE"sv,
                                            "BM"sv,
                                            "P1"sv,
                                            "P2"sv,
                                            "P3"sv,
                                            "P4"sv,
                                            "P5"sv,
                                            "P6"sv};

bool is_usual(const std::string& path) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  if (text.starts_with("RIFF") && text.substr(8).starts_with("WEBP")) return true;
  return std::ranges::any_of(kBeginnings, [&](std::string_view b) { return text.starts_with(b); });
}

/// Whether an EXR file is as long as its header says of the attributes. OpenEXR asks for the memory of a text
/// before it looks. True for files of other formats.
bool holds_its_attributes(std::string_view text) {
  if (!text.starts_with(kBeginnings[0]) || text.size() < 8) return true;
  const bool has_parts = (static_cast<unsigned char>(text[5]) & 0x10) != 0;
  text.remove_prefix(8);
  const auto skip_name = [&] {
    const std::size_t end = text.find('\0');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  };
  while (!text.empty()) {
    if (text.front() == '\0') {
      text.remove_prefix(1);
      // The headers of the parts end with an empty one.
      if (!has_parts || text.empty() || text.front() == '\0') return true;
      continue;
    }
    skip_name(), skip_name();
    std::uint32_t size = 0;
    if (text.size() < sizeof size) return true;
    std::memcpy(&size, text.data(), sizeof size);
    text.remove_prefix(sizeof size);
    if (size > text.size()) return false;
    text.remove_prefix(size);
  }
  return true;
}

}  // namespace

std::string why_not_an_image(const std::string& path) {
  std::string why = why_unreadable(path);
  if (why.empty() && files_are_confined() && !is_usual(path))
    why = "begins like none of the image formats that may be read here";
  if (why.empty() && !holds_its_attributes(MappedFile(path).text()))
    why = "cannot read the image: an attribute in its header is longer than the file";
  return why;
}

std::string image_to_open(const std::string& path) {
  note_file_read(path);
  if (const std::string why = why_not_an_image(path); !why.empty())
    throw Error(Location{path}, why, ErrorKind::io);
  return path_to_open(path);
}

}  // namespace oktett
