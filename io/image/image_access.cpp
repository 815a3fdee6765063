#include "io/image/image_access.h"

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "io/text/file_access.h"
#include "io/text/mapped_file.h"

namespace oktett {
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

}  // namespace

std::string why_not_an_image(const std::string& path) {
  std::string why = why_unreadable(path);
  if (why.empty() && files_are_confined() && !is_usual(path))
    why = "begins like none of the image formats that may be read here";
  return why;
}

}  // namespace oktett
