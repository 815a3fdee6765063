#pragma once
/// \file Spatial splits: a triangle that crosses the plane becomes two references with tighter boxes (Stich,
/// Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).

#include <vector>

#include "accel/accel_data.h"
#include "accel/build/sah.h"

namespace oktett {

// ---- What the builder asks of triangles.

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
  /// Numbers the corners of 1 to 8 items for TriangleBlock::Lists::corners, one number for those that have
  /// the same bits; false if a block does not hold so many.
  virtual bool pack_corners(const std::uint32_t* items, int count, std::uint16_t* corners) const = 0;
  /// Fills a block with 1 to 8 items and their packed corners, of which number 0 comes first.
  virtual void fill(const std::uint32_t* items, const std::uint16_t* corners, int count,
                    TriangleBlock& block) const = 0;
  /// Prefetches the memory that fill() will need for these items.
  virtual void prefetch(const std::uint32_t* items, int count) const = 0;
};

/// For trees without blocks of triangles.
class NoTriangles final : public TriangleSource {
 public:
  void note_vertices(const PrimRef*, std::uint32_t, VertexNumbers*) const override {}
  bool pack_corners(const std::uint32_t*, int, std::uint16_t*) const override { return false; }
  void fill(const std::uint32_t*, const std::uint16_t*, int, TriangleBlock&) const override {}
  void prefetch(const std::uint32_t*, int) const override {}
  void corners(std::uint32_t, Vec3f (&)[3]) const override {}
};

// ---- Spatial splits.

/// The plane at `place` across an axis, and the cost of the split there; axis < 0: none.
struct SpatialSplit {
  int axis = -1;
  float place = 0;
  double cost = std::numeric_limits<double>::infinity();  ///< areas times blocks of eight, as of `unit` 1
  Box side[2];
  double count[2] = {};  ///< of references; about, where a sample was sliced
};

/// Half the surface of a box in double, where no float overflows.
double half_area(const Box& box);

/// How planes are sought.
struct SpatialSearch {
  bool every_axis = false;  ///< across every axis, not only across the longest
  std::size_t every = 1;    ///< of so many groups of kBinGroup references one is looked at
  bool parallel = false;
};

/// The plane of least surface-area cost among equidistant ones across axes of `box`, which bounds refs[0,
/// count).
SpatialSplit find_spatial(const PrimRef* refs, std::size_t count, const Box& box,
                          const TriangleCorners& triangles, const SpatialSearch& search);

/// Copies refs[0, count) to `left` upwards and to `right` downwards (the first goes to right[-1]). A triangle
/// that crosses the plane becomes a reference on each side or, where that is cheaper, a whole one on one
/// side. Returns the numbers of references on the left and on the right. Returns {0, 0}, without a split, if
/// there would be `room` or more together or none on one side.
struct SpatialParts {
  std::size_t left = 0, right = 0;
};
SpatialParts partition_spatial(const PrimRef* refs, std::size_t count, std::size_t room,
                               const SpatialSplit& split, const TriangleCorners& triangles, bool parallel,
                               PrimRef* left, PrimRef* right);

}  // namespace oktett
