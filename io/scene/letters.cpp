/// \file Text in scene files: the letters of a font as a prism.

#include <fmt/format.h>

#include "io/font/font.h"
#include "io/scene/exact.h"
#include "io/scene/readers.h"
#include "kernels/exact/prism.h"

namespace oktett {
namespace {

/// The code points of text that is valid UTF-8, as that of scene files is.
std::u32string code_points(std::string_view text) {
  std::u32string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i++]);
    const int more = byte < 0x80 ? 0 : byte < 0xe0 ? 1 : byte < 0xf0 ? 2 : 3;
    char32_t c = more == 0 ? byte : byte & (0x3fu >> more);
    for (int k = 0; k < more && i < text.size(); ++k)
      c = c << 6 | (static_cast<unsigned char>(text[i++]) & 0x3fu);
    out.push_back(c);
  }
  return out;
}

}  // namespace

std::optional<ExactForm> finish(const ShapeNode& at, TextKeys& keys) {
  const YamlNode &font = at.fields.require("font"), &text = at.fields.require("text");
  const std::string words = at.load.values.text(text);
  WrittenText written = read_named_file(at.load, font, [&](const std::string& path) {
    return write_text(path, code_points(words), keys.advance);
  });
  if (!written.missing.empty()) {
    std::string missing;
    for (const char32_t c : written.missing)
      missing += fmt::format("{}U+{:04X}", missing.empty() ? "" : ", ", static_cast<std::uint32_t>(c));
    at.load.warn(text.where(),
                 "the font has no " + missing + "; its sign for missing letters takes their place");
  }
  PrismShape shape;
  shape.outlines = std::move(written.outlines);
  shape.axis = PrismShape::Axis::z, shape.curve = PrismShape::Curve::bezier;
  shape.to = keys.thickness;
  Prism::Pool pool;
  Prism::add(pool, shape, {});
  if (pool.elements.empty()) return at.skip("there is nothing to see of the text");
  return shape;
}

}  // namespace oktett
