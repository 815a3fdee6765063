#pragma once
/// \file Lines of MTL files, and their texture statements: `map_Kd -o 0.5 0 -clamp on brick.png` and the
/// like.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/vec3.h"
#include "io/text/scan.h"
#include "render/material.h"

namespace oktett {

/// A line whose first word is the keyword. What cannot be read becomes a warning, because materials must not
/// keep a mesh from being loaded.
class MtlLine {
 public:
  /// The line at `p`; `lines` tells its position when a warning needs it.
  MtlLine(const char* p, const std::string& path, LineCounter& lines, std::vector<Warning>& warnings);

  /// In lower case: exporters disagree about `map_Bump` and `map_bump`.
  const std::string& keyword() const { return keyword_; }

  /// The next word, or an empty one at the end of the line.
  std::string_view peek() const;
  std::string_view take();
  /// All that is left, blanks within kept, joints of lines as one blank.
  std::string take_rest();
  /// Whether more than one word is left.
  bool has_more_than_one_word() const;

  /// The next word if all of it is a finite number; if not, it is left where it is.
  std::optional<float> take_number_if_any();
  /// The same, with a warning if there is none.
  std::optional<float> take_number();
  /// One number (a grey) or three; nothing and a warning if they are malformed or in an unsupported form.
  std::optional<Color> take_color();

  void warn(const std::string& message) const;
  /// Where the line begins.
  Location where() const;

 private:
  const char* start_;
  const char* next_;
  const std::string& path_;
  LineCounter& lines_;
  std::vector<Warning>& warnings_;
  std::string keyword_;
};

/// Adds textures to a list, equal ones once.
class TextureList {
 public:
  explicit TextureList(std::vector<Texture>& textures);
  std::uint32_t add(const Texture& texture);

 private:
  std::vector<Texture>& textures_;
  std::multimap<std::string, std::uint32_t> by_path_;
};

/// What a texture statement says.
struct MtlTexture {
  Texture texture;
  float bump_scale = 1;  ///< `-bm`
};

/// Reads the options and the file name behind the keyword. The name may contain blanks; it is relative to
/// `directory`. `channel` is what a number is taken from without `-imfchan`. Nothing, and a warning, if there
/// is no name.
std::optional<MtlTexture> read_mtl_texture(MtlLine& line, const std::string& directory, ImageChannel channel);

}  // namespace oktett
