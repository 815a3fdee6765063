#pragma once
/// \file A finished picture as named planes of numbers, independent of any file format.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/soa.h"
#include "render/tone.h"

namespace oktett {

/// How a plane is stored in files of formats that can choose.
enum class PlaneType { half_float, single_float, unsigned_int };

/// One channel of a picture: width * height numbers, row by row from the top, in `values` or, for
/// PlaneType::unsigned_int, in `ids`.
struct PicturePlane {
  std::string name;  ///< as in EXR files: "R", "G", "B", "A", "Z", "N.X", "primID.I", ...
  PlaneType type = PlaneType::half_float;
  Column<float> values;
  Column<std::uint32_t> ids;
};

/// Planes of the same size. "R", "G", "B" are linear Rec.709 premultiplied by "A".
struct Picture {
  std::uint32_t width = 0, height = 0;            ///< of the planes, in pixels
  std::uint32_t x = 0, y = 0;                     ///< where their upper left pixel is in the full frame
  std::uint32_t full_width = 0, full_height = 0;  ///< of the frame that the planes are a part of
  std::vector<PicturePlane> planes;
  /// Texts that EXR files keep beside the planes, each with its name.
  std::vector<std::pair<std::string, std::string>> attributes;
  Tone tone;  ///< how formats that store no linear light show the colours

  /// The plane called `name`, or null.
  const PicturePlane* find(const std::string& name) const {
    for (const PicturePlane& plane : planes)
      if (plane.name == name) return &plane;
    return nullptr;
  }
  PicturePlane* find(const std::string& name) {
    return const_cast<PicturePlane*>(static_cast<const Picture*>(this)->find(name));
  }
};

}  // namespace oktett
