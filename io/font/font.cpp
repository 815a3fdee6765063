#include "io/font/font.h"

#include "core/error.h"
#include "io/library/loaded_library.h"
#include "io/text/file_content.h"

namespace oktett {

#ifdef OKTETT_FONT_LIBRARY

bool can_read_fonts() { return true; }

WrittenText write_text(const std::string& font, std::u32string_view text, const Vec3d& advance) {
  static const FontLibrary* const library = reinterpret_cast<FontLibraryEntry>(
      load_library({OKTETT_FONT_LIBRARY, kFontLibraryEntry, "reads fonts", std::size_t{32} << 20}))();
  const MappedFile file(font);
  return library->write(font, file.text(), text, advance);
}

#else

bool can_read_fonts() { return false; }

WrittenText write_text(const std::string& font, std::u32string_view, const Vec3d&) {
  throw Error(Location{font}, "is a font, and this program is built without FreeType", ErrorKind::io);
}

#endif

}  // namespace oktett
