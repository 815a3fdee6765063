#pragma once
/// \file Height fields: surfaces y = h(x, z) over a grid of samples, traced as a grid and not as a mesh
/// (slides; F. K. Musgrave: Grid Tracing, 1988).

#include "kernels/exact/exact.h"
#include "kernels/heights/height_field_data.h"
#include "kernels/heights/height_grid.h"

namespace oktett {

/// Upright walls of `nearest`; the others are parts of the surface (0) and faces of the box (1 to 6).
enum HeightPart { kWallLowX = 7, kWallHighX = 8, kWallLowZ = 9, kWallHighZ = 10 };

/// How the element's own space lies to the grid: column = x * scale.x + shift.x, sample as stored =
/// y * scale.y + shift.y, row = z * scale.z + shift.z.
struct HeightFrame {
  Vec3d scale, shift;
};

/// The own space is a uniformly scaled one: the rectangle and the heights lie about the origin, the longest
/// of their sides 2 or less.
struct HeightFieldElement {
  std::shared_ptr<const HeightGrid> keep;
  const HeightGrid* grid;
  HeightFrame frame;  ///< from the own space to the grid
  double margin;      ///< what the heights are bounded by is so far from them, in samples as stored
  HeightWalk walk;
  bool solid;
  Vec3d lo, hi;  ///< the box: of a solid, its lower face is the bottom
};

struct HeightFieldPool : ExactPool<HeightFieldElement> {
  /// With the samples and pyramids, each as often as it is in use.
  std::size_t bytes() const;
};

/// Parts: 0 the surface, 1 to 6 the faces of the box, 7 to 10 upright walls (HeightPart).
struct HeightField {
  using Data = HeightFieldShape;
  using Pool = HeightFieldPool;
  static constexpr int kMaxCrossings = 18;
  static constexpr bool kStopsAtLimit = true;
  /// A ray on its own is faster as a number than in lanes that have nothing else to do.
  static constexpr bool kLoneLanes = true;

  static void add(Pool& pool, const HeightFieldShape& shape, const ExactPlace& place);

  /// Defined in height_crossings.h, which only the code of the instruction sets needs.
  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out);

  /// Defined in height_slope.h.
  template <class D>
  static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                    Vec3<D>& gradient);
  static double value(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static Vec3d gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// Below the surface and above the bottom of a solid; nothing is inside of an open surface.
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u from the first column to the last, v from the last row to the first, as in an image that is looked at
  /// from above.
  static void uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, SurfaceInteraction& s);

  /// Whether (x, y, z), in the space of the grid, is below the surface's edge over a side of the box.
  static bool below_rim(const HeightGrid& grid, int face, double x, double y, double z);
};

}  // namespace oktett
