/// \file Outlines of letters by FreeType.

// FreeType wants its configuration first.
#include <ft2build.h>

#include <freetype/freetype.h>
#include <freetype/ftoutln.h>

#include <algorithm>
#include <new>
#include <utility>

#include "core/error.h"
#include "io/font/font.h"

namespace oktett {
namespace {

/// FreeType's library and a face, which end with this.
class Face {
 public:
  Face(const std::string& path, std::string_view content) : path_(path) {
    check(FT_Init_FreeType(&library_), "FreeType does not start");
    const FT_Error error = FT_New_Memory_Face(library_, reinterpret_cast<const FT_Byte*>(content.data()),
                                              static_cast<FT_Long>(content.size()), 0, &face_);
    if (error != 0 || !FT_IS_SCALABLE(face_) || face_->units_per_EM == 0) {
      close();
      if (error == FT_Err_Out_Of_Memory) throw std::bad_alloc();
      throw Error(Location{path},
                  error != 0 ? "cannot be read as a font" : "is a font of pixels; expected one of outlines");
    }
  }
  ~Face() { close(); }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  FT_Face get() const { return face_; }
  void check(FT_Error error, const char* what) const {
    if (error == FT_Err_Out_Of_Memory) throw std::bad_alloc();
    if (error != 0) throw Error(Location{path_}, what);
  }

 private:
  void close() {
    if (face_ != nullptr) FT_Done_Face(face_);
    if (library_ != nullptr) FT_Done_FreeType(library_);
    face_ = nullptr, library_ = nullptr;
  }

  const std::string& path_;
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
};

/// Takes the contours of a glyph as cubic pieces.
class OutlineTaker {
 public:
  OutlineTaker(double per_em, const FlatPoint& shift, std::vector<PlaneOutline>& out)
      : per_em_(per_em), shift_(shift), out_(out) {}

  int take(FT_Outline& outline) {
    FT_Outline_Funcs functions{};
    functions.move_to = [](const FT_Vector* to, void* taker) { return of(taker).move_to(*to); };
    functions.line_to = [](const FT_Vector* to, void* taker) { return of(taker).line_to(*to); };
    functions.conic_to = [](const FT_Vector* control, const FT_Vector* to, void* taker) {
      return of(taker).conic_to(*control, *to);
    };
    functions.cubic_to = [](const FT_Vector* a, const FT_Vector* b, const FT_Vector* to, void* taker) {
      return of(taker).cubic_to(*a, *b, *to);
    };
    const int error = FT_Outline_Decompose(&outline, &functions, this);
    close();
    return error;
  }

 private:
  static OutlineTaker& of(void* taker) { return *static_cast<OutlineTaker*>(taker); }
  FlatPoint place(const FT_Vector& v) const {
    return {shift_.x + static_cast<double>(v.x) / per_em_, shift_.z + static_cast<double>(v.y) / per_em_};
  }
  int move_to(const FT_Vector& to) {
    close();
    points_ = {place(to)};
    return 0;
  }
  int line_to(const FT_Vector& to) {
    const FlatPoint a = points_.back(), d = place(to);
    return add({(2 * a.x + d.x) / 3, (2 * a.z + d.z) / 3}, {(a.x + 2 * d.x) / 3, (a.z + 2 * d.z) / 3}, d);
  }
  int conic_to(const FT_Vector& control, const FT_Vector& to) {
    const FlatPoint a = points_.back(), q = place(control), d = place(to);
    return add({(a.x + 2 * q.x) / 3, (a.z + 2 * q.z) / 3}, {(2 * q.x + d.x) / 3, (2 * q.z + d.z) / 3}, d);
  }
  int cubic_to(const FT_Vector& a, const FT_Vector& b, const FT_Vector& to) {
    return add(place(a), place(b), place(to));
  }
  int add(const FlatPoint& a, const FlatPoint& b, const FlatPoint& to) {
    points_.insert(points_.end(), {a, b, to});
    return 0;
  }
  void close() {
    if (points_.size() > 1) out_.push_back(std::move(points_));
    points_.clear();
  }

  double per_em_;
  FlatPoint shift_;
  std::vector<PlaneOutline>& out_;
  PlaneOutline points_;
};

class FreeTypeLibrary final : public FontLibrary {
 public:
  WrittenText write(const std::string& path, std::string_view content, std::u32string_view text,
                    const Vec3d& advance) const override {
    const Face font(path, content);
    const FT_Face face = font.get();
    const double em = face->units_per_EM;
    WrittenText out;
    FlatPoint pen{0, 0};
    FT_UInt before = 0;
    bool first = true;
    for (const char32_t character : text) {
      if (character < 0x20 || character == 0x7f) continue;
      const FT_UInt glyph = FT_Get_Char_Index(face, character);
      if (glyph == 0 && std::ranges::find(out.missing, character) == out.missing.end())
        out.missing.push_back(character);
      font.check(FT_Load_Glyph(face, glyph, FT_LOAD_NO_SCALE), "has a letter that cannot be read");
      if (first) {
        pen.x = -static_cast<double>(face->glyph->metrics.horiBearingX) / em;
      } else {
        FT_Vector kerning{0, 0};
        if (FT_HAS_KERNING(face))
          font.check(FT_Get_Kerning(face, before, glyph, FT_KERNING_UNSCALED, &kerning),
                     "has a table of kerning that cannot be read");
        pen.x += static_cast<double>(kerning.x) / em + advance.x, pen.z += advance.y;
      }
      if (face->glyph->format == FT_GLYPH_FORMAT_OUTLINE)
        font.check(OutlineTaker(em, pen, out.outlines).take(face->glyph->outline),
                   "has a letter that cannot be read");
      pen.x += static_cast<double>(face->glyph->metrics.horiAdvance) / em;
      before = glyph, first = false;
    }
    return out;
  }
};

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) const oktett::FontLibrary* oktett_font_library();
const oktett::FontLibrary* oktett_font_library() {
  static const oktett::FreeTypeLibrary library;
  return &library;
}
