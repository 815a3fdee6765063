#pragma once
/// \file The properties of a PLY file that a mesh carries as attributes: colours, and all other numbers of
/// vertices and faces that have no meaning of their own here. Within io/ only.
///
/// Colours are `red green blue`, `diffuse_red ...` or `r g b`, and `alpha` or `a` with them, encoded by the
/// sRGB curve: programs for scans copy them from photographs, and Blender and three.js encode floats so, too.
/// Whole numbers count 255ths, those of 16 bits without sign 65535ths. Beside them `color_0 color_1 color_2`,
/// and `color_3`, are the same in linear floats: what write_ply adds where bytes would round.

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "io/ply/header.h"

namespace oktett {

/// What becomes of the number of a property.
enum class PlyMeaning : std::uint8_t {
  number,  ///< it stays as it is
  byte,    ///< cut off to 8 bits
  srgb,    ///< by the sRGB curve
  srgb8,   ///< 255ths by the sRGB curve
  srgb16,  ///< 65535ths by the sRGB curve
  part8,   ///< 255ths
  part16,  ///< 65535ths
  slot,    ///< the number of a texture
};

/// A property of an element and where its numbers go.
struct PlyExtra {
  int property = PlyElement::kNone;
  PlyMeaning meaning = PlyMeaning::number;
  std::uint32_t attribute = 0, component = 0;  ///< in TriangleMesh::attributes; not of a slot
  // Set by place().
  float* floats = nullptr;
  std::uint8_t* bytes = nullptr;
  std::uint16_t* slots = nullptr;
  std::uint32_t step = 1;
  std::uint16_t textures = 0;  ///< of a slot: other numbers stand for no texture, which is the slot behind

  /// Finds the columns of `mesh`, which have their size.
  void place(TriangleMesh& mesh);
  /// Sets what element `i` gets of the number `x`. NaN is 0 where it stands for a colour or a slot.
  template <class T>
  void put(std::uint64_t i, T x) const {
    if (meaning == PlyMeaning::number)
      floats[i * step] = static_cast<float>(x);
    else if (meaning == PlyMeaning::byte)
      bytes[i * step] = byte_of(x);
    else
      put_other(i, static_cast<double>(x));
  }

 private:
  template <class T>
  static std::uint8_t byte_of(T x) {
    if constexpr (std::same_as<T, std::uint8_t>) return x;
    const auto value = static_cast<double>(x);
    return static_cast<std::uint8_t>(value > 0 ? std::min(value, 255.0) : 0);
  }
  void put_other(std::uint64_t i, double x) const;
};

/// Chooses which properties of an element, other than those whose indices are `used`, become attributes,
/// which are appended to `attributes` without values. A property whose name is taken is left out, but that of
/// a face gets "face_" before it.
std::vector<PlyExtra> choose_attributes(const PlyElement& element, std::span<const int> used,
                                        AttributeDomain domain, std::vector<MeshAttribute>& attributes);

/// What stands between the name of an attribute of several components and the number of one, as in "flow_0",
/// "flow_1". The first is written; NumPy's reader of text, which meshio uses, drops other signs than letters,
/// digits and this one from names. Older files of Oktett have the second.
inline constexpr std::string_view kPlyComponents = "_.";

}  // namespace oktett
