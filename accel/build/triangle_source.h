#pragma once
/// \file What the builder asks of triangles.

#include "accel/accel_data.h"
#include "accel/build/sah.h"

namespace oktett {

/// The corners of triangles, which splits of space ask for. Called from many threads.
class TriangleCorners {
 public:
  virtual ~TriangleCorners() = default;
  virtual void corners(std::uint32_t item, Vec3f (&v)[3]) const = 0;
};

/// The triangles of the scene, for the builder. Called from many threads.
class TriangleSource : public TriangleCorners {
 public:
  /// Writes the numbers of their vertices for those of `count` references that are triangles. Only the same
  /// vertex of the same mesh has the same number.
  virtual void note_vertices(const PrimRef* refs, std::uint32_t count, VertexNumbers* out) const = 0;
  /// Numbers the corners of 1 to 8 items for TriangleBlock::corners, one number for those that have the same
  /// bits; false if a block does not hold so many.
  virtual bool pack_corners(const std::uint32_t* items, int count, std::uint16_t* corners) const = 0;
  /// Fills a block with 1 to 8 items and their packed corners, of which number 0 comes first.
  virtual void fill(const std::uint32_t* items, const std::uint16_t* corners, int count,
                    TriangleBlock& block) const = 0;
  /// Prefetches the memory that fill() will need for these items.
  virtual void prefetch(const std::uint32_t* items, int count) const = 0;
};

}  // namespace oktett
