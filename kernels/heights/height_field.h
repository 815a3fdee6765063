#pragma once
/// \file Height fields: surfaces y = h(x, z) over a grid of samples, traced as a grid and not as a mesh
/// (slides; F. K. Musgrave: Grid Tracing, 1988).

#include "kernels/heights/height_crossings.h"
#include "kernels/heights/height_slope.h"

namespace oktett {

/// Parts: 0 the surface, 1 to 6 the faces of the box, 7 to 10 upright walls (HeightPart).
struct HeightField {
  using Data = HeightFieldShape;
  using Pool = HeightFieldPool;
  static constexpr int kMaxCrossings = 18;
  static constexpr bool kOneCell = true;
  static constexpr bool kStopsAtLimit = true;
  /// A ray on its own is faster as a number than in lanes that have nothing else to do.
  static constexpr bool kLoneLanes = true;

  static void add(Pool& pool, const HeightFieldShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    height::crossings(pool.elements[cell.element], line, range, active, out);
  }
  template <class D>
  static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                    Vec3<D>& gradient) {
    height::slope(pool.elements[i], part, p, value, gradient);
  }
  /// Below the surface and above the bottom of a solid; nothing is inside of an open surface.
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u from the first column to the last, v from the last row to the first, as in an image that is looked at
  /// from above.
  static void uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, SurfaceInteraction& s);
};

}  // namespace oktett
