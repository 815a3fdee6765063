#pragma once
/// \file A finished picture as named planes of numbers, independent of any file format.

#include <cstdint>
#include <string>
#include <vector>

#include "core/soa.h"

namespace oktett {

/// How a plane is best stored in a file that can choose. Ids are never filtered or converted to float.
enum class PlaneType { half_float, single_float, unsigned_int };

/// One channel of a picture: `values` (or `ids` for unsigned_int) hold width * height entries, row by row
/// from the top.
struct PicturePlane {
  std::string name;  ///< EXR channel name: "R", "G", "B", "A", "Z", "N.X", "primID.I", ...
  PlaneType type = PlaneType::half_float;
  Column<float> values;
  Column<std::uint32_t> ids;
};

/// Planes of equal size. `x`, `y` place the data window inside a frame of `full_width` x `full_height`
/// pixels. "R", "G", "B" are linear Rec.709 premultiplied by "A".
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::uint32_t x = 0, y = 0;
  std::uint32_t full_width = 0, full_height = 0;
  std::vector<PicturePlane> planes;

  const PicturePlane* find(const std::string& name) const {
    for (const PicturePlane& plane : planes)
      if (plane.name == name) return &plane;
    return nullptr;
  }
};

}  // namespace oktett
