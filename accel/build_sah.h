#pragma once
/// \file What the builder works on: primitive references and bins.

#include <cstdint>

#include "accel/layout.h"

namespace oktett {

/// A primitive's box as {-lo, hi}, so that one maximum grows both corners at once (the layout is tinybvh's
/// idea), with its item number and kind in the gaps. 32 bytes.
struct alignas(32) PrimRef {
  float negative_lo[3];
  std::uint32_t item;
  float hi[3];
  std::uint32_t kind;  ///< Kind in bits 0-7, TriangleTest in bits 8-15
};
static_assert(sizeof(PrimRef) == 32);

/// Boxes in the same form, and a count, for every candidate interval of one axis.
struct alignas(32) BinBox {
  float v[8];  ///< {-lo.xyz, any, hi.xyz, any}
};

inline constexpr int kMaxBins = 32;

struct Bins {
  BinBox box[3][kMaxBins];
  std::uint32_t count[3][kMaxBins];
};

/// Bins refs[begin, end) by their centres: bin = floor((centre - origin) * scale), clamped to [0, bins).
struct BinJob {
  const PrimRef* refs;
  std::size_t begin, end;
  float origin[3], scale[3];
  int bins;
  Bins* out;  ///< added to
};

/// The bin of one reference along one axis. The centre is formed from halves, so that huge boxes do not
/// overflow.
inline __attribute__((always_inline)) int bin_of(const PrimRef& r, int axis, float origin, float scale,
                                                 int bins) {
  const float c = (r.hi[axis] * 0.5f - r.negative_lo[axis] * 0.5f - origin) * scale;
  return c >= static_cast<float>(bins - 1) ? bins - 1 : c > 0 ? static_cast<int>(c) : 0;
}

}  // namespace oktett
