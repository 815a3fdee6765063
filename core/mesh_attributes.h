#pragma once
/// \file Numbers that meshes carry beside positions, normals and texture coordinates.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/soa.h"

namespace oktett {

/// What each value of an attribute belongs to.
enum class AttributeDomain : std::uint8_t { vertex, face, corner };

/// The attribute that holds colours: linear Rec.709, and alpha if there are four components.
inline constexpr const char* kColorAttribute = "color";

/// Colours, weights, labels: one to four numbers for each vertex, triangle, or corner of a triangle.
struct MeshAttribute {
  std::string name;
  AttributeDomain domain = AttributeDomain::vertex;
  std::uint32_t components = 1;  ///< 1 to 4
  Column<float> floats;          ///< `components` for each vertex, triangle or corner; or empty
  /// Instead of `floats`: numbers of 8 bits, the first three of which the sRGB curve encodes. The fourth
  /// counts 255ths.
  Column<std::uint8_t> srgb;

  /// How many vertices, triangles or corners there are values for.
  std::size_t size() const { return (floats.empty() ? srgb.size() : floats.size()) / components; }
  std::size_t bytes() const { return floats.bytes() + srgb.bytes(); }
  /// Component `k` of the value number `i`, linear.
  float value(std::size_t i, std::uint32_t k) const;
};

/// What a part of 1 means that the sRGB curve encodes, rounded to float; and a byte, which counts 255ths.
float linear_of_srgb(double part);
float linear_of_srgb_byte(std::uint8_t byte);

/// A value of up to four components. Those that an attribute lacks: one number is a grey, two are red and
/// green without blue, and alpha is 1.
using AttributeValue = std::array<float, 4>;

}  // namespace oktett
