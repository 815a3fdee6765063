#pragma once
/// \file Colours of vertices in OBJ files, `v x y z r g b` and `#MRGB`. Within io/ only.

#include <cstdint>

#include "core/mesh.h"
#include "core/soa.h"
#include "io/text/number.h"

namespace oktett {

/// What is known of the colours of vertices once they are read.
struct ObjColors {
  std::uint64_t count = 0;        ///< of vertices that have one
  const char* without = nullptr;  ///< the first vertex that has none
  float greatest = 0;             ///< number
  bool are_bytes = true;          ///< all numbers are those of whole 255ths
  bool are_whole = true;          ///< all numbers are whole

  /// What follows in the file.
  ObjColors& operator+=(const ObjColors& later);
};

/// Where colours go, three numbers or bytes each. At most one of the columns is there, with its final size.
struct ObjColorColumns {
  Column<std::uint8_t> levels;   ///< 255ths, as long as all are whole
  Column<float> numbers;         ///< as they stand in the file
  Column<std::uint8_t> painted;  ///< of `#MRGB`, which counts vertices from the first one on
};

/// Reads three numbers behind each other at `p` that are those of bytes, from "0" to "1.000000", and returns
/// their end, behind blanks; null if they are not. Most programs write such: they take a third of the time.
const char* read_color_levels(const char* p, std::uint8_t* out);

/// Instead of the first number of a colour: the vertex has none, and is white.
inline constexpr float kNoObjColor = -1;

/// The linear number that an encoded one means, by the sRGB curve, within 2^-23 of it.
float linear_of_obj_color(float encoded);

/// Gives `mesh` its attribute "color". If a number is greater than 1 and all are whole, they are bytes.
void set_colors(TriangleMesh& mesh, const ObjColors& found, ObjColorColumns colors);

}  // namespace oktett
