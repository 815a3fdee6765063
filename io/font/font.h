#pragma once
/// \file Outlines of letters from font files. Within io/ only.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"
#include "kernels/exact/prism_data.h"

namespace oktett {

/// Whether this build reads fonts.
bool can_read_fonts();

/// A line of text as closed outlines of PrismShape::Curve::bezier, in units of the font's em.
struct WrittenText {
  std::vector<PlaneOutline> outlines;
  std::vector<char32_t> missing;  ///< characters that the font does not have, each once
};

/// Writes a line as POV-Ray's `text` does: with the font's advance widths and its table of kerning, beginning
/// with the left edge of the first letter at x = 0 and standing on y = 0. Each letter is moved by `advance`
/// from the one before in addition. Control characters are left out. Throws Error, of kind io if the file
/// cannot be read or this build reads no fonts.
WrittenText write_text(const std::string& font, std::u32string_view text, const Vec3d& advance);

// ---- The shared library that knows FreeType, liboktett_fonts, which brings others along.

class FontLibrary {
 public:
  /// See write_text; `content` is that of the file, and messages call it `path`.
  virtual WrittenText write(const std::string& path, std::string_view content, std::u32string_view text,
                            const Vec3d& advance) const = 0;

 protected:
  ~FontLibrary() = default;
};

/// What the library shows, by its name for dlsym.
inline constexpr const char* kFontLibraryEntry = "oktett_font_library";
using FontLibraryEntry = const FontLibrary* (*)();

}  // namespace oktett
