#pragma once
/// \file Height fields: surfaces y = h(x, z) over a grid of samples, traced as a grid and not as a mesh
/// (Zachmann 2010; F. K. Musgrave: Grid Tracing, 1988).

#include "kernels/heights/height_pyramid.h"

namespace oktett {

/// The own space is a uniformly scaled one: the rectangle and the heights lie about the origin, the longest
/// of their sides 2 or less.
struct HeightFieldElement {
  std::shared_ptr<const HeightGrid> keep;
  const HeightGrid* grid;
  HeightFrame frame;  ///< from the own space to the grid
  double margin;      ///< what the heights are bounded by is so far from them, in samples as stored
  HeightWalk walk;
  bool solid, smooth;
  Vec3d lo, hi;  ///< the box: of a solid, its lower face is the bottom
};

struct HeightFieldPool : ExactPool<HeightFieldElement> {
  /// With the samples and pyramids, each as often as it is in use.
  std::size_t bytes() const;
};

namespace height {

template <int K, class D>
void find_in_lanes(const HeightFieldElement& e, const GridLines<D>& g, const LineRange<D>& range,
                   const typename D::M& active, Crossings<K, D>& out) {
  HeightSearch<K, D> search(*e.grid, g, range.a, range.b, active, out);
  if constexpr (D::kWidth == 1) {
    if (e.walk == HeightWalk::cells) walk_cells(search);
    if (e.walk == HeightWalk::spans) walk_spans(search);
  }
  if (e.walk == HeightWalk::pyramid) PyramidWalk<K, D>(search).run();
  search.finish();
}

template <int K, class D>
void find_one_by_one(const HeightFieldElement& e, const GridLines<D>& g, const LineRange<D>& range,
                     const typename D::M& active, Crossings<K, D>& out) {
  using One = Simd<double, 1, typename D::Isa>;
  CrossingColumns<K, D> columns;
  for (unsigned lanes = bits(active); lanes != 0; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    Crossings<K, One> c;
    find_in_lanes(e, GridLines<One>(g, lane), {lane_of(range.a, lane), lane_of(range.b, lane), {}, {}},
                  One::M::all_true(), c);
    for (int k = 0; k < K; ++k)
      columns.t[k][lane] = only_lane(c.t[k]), columns.turn[k][lane] = only_lane(c.turn[k]),
      columns.part[k][lane] = only_lane(c.part[k]);
    columns.up_to[lane] = only_lane(c.up_to);
  }
  columns.load(out);
}

template <int K, class D>
OKTETT_INLINE void find(const HeightFieldElement& e, const GridLines<D>& g, const LineRange<D>& range,
                        const typename D::M& active, Crossings<K, D>& out) {
  if (D::kWidth == 1 || e.walk == HeightWalk::pyramid)
    find_in_lanes(e, g, range, active, out);
  else
    find_one_by_one(e, g, range, active, out);
  // Rounding may lead a little beyond the end.
  for (int k = 0; k < K; ++k) {
    const auto beyond = (range.b < out.t[k]) & (out.t[k] < D(roots::kNoRoot)) & (D(0.0) < range.exit_face);
    out.t[k] = select(beyond, range.b, out.t[k]);
  }
}

/// Whether (x, y, z), in the space of the grid, is below the surface's edge over a side of the box.
bool below_rim(const HeightGrid& grid, int face, double x, double y, double z);

/// Whether lines of `asked`, which do not cross the surface, are below it: by the face through which they
/// enter, or else leave.
template <class D>
OKTETT_INLINE typename D::M starts_inside(const HeightFieldElement& e, const GridLines<D>& g,
                                          const LineRange<D>& range, const typename D::M& asked) {
  const auto enters = D(0.0) < range.enter_face;
  const D face = select(enters, range.enter_face, range.exit_face);
  const auto bottom = face == D(3.0), top = face == D(4.0);
  const auto side = asked & (D(0.0) < face) & ~bottom & ~top;
  if (none(side)) return asked & bottom;
  constexpr int W = D::kWidth;
  const D t = select(enters, range.a, range.b);
  double faces[W], x[W], y[W], z[W], below[W];
  face.store(faces), (g.o.x + t * g.d.x).store(x), g.height(t).store(y), (g.o.z + t * g.d.z).store(z);
  for (int k = 0; k < W; ++k)
    below[k] = (bits(side) >> k & 1) != 0 && below_rim(*e.grid, static_cast<int>(faces[k]), x[k], y[k], z[k])
                   ? 1.0
                   : 0.0;
  return asked & (bottom | (D(0.0) < D::load(below)));
}

}  // namespace height

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
    const HeightFieldElement& e = pool.elements[cell.element];
    using namespace height;
    const GridLines<D> g(*e.grid, e.frame, e.margin, line);
    if (!e.solid) return find(e, g, range, active, out);
    constexpr int kOwn = K > 2 ? K - 2 : K;
    Crossings<kOwn, D> own;
    find(e, g, range, active, own);
    // Without a crossing it is inside all the way or not at all.
    const auto silent = active & ~(own.t[0] < D(roots::kNoRoot));
    close_by_cell(own, starts_inside(e, g, range, silent), range, active, out);
  }
  template <class D>
  static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                    Vec3<D>& gradient) {
    const HeightFieldElement& e = pool.elements[i];
    const Vec3d &scale = e.frame.scale, &shift = e.frame.shift;
    const HeightPatch<D> patch(*e.grid, p.x * D(scale.x) + D(shift.x), p.z * D(scale.z) + D(shift.z));
    value = p.y - (patch.height - D(shift.y)) / D(scale.y);
    gradient = {-patch.by_x * D(scale.x / scale.y), D(1.0), -patch.by_z * D(scale.z / scale.y)};
    select_faces(e.lo, e.hi, part, p, value, gradient);
    if (none(part > D(6.0))) return;
    // Walls stand at the nearest line of the grid.
    const auto wall = [&](int number, int axis, const D& at, double side) {
      const D shifter(0x1.8p52), line = at * D(scale[axis]) + D(shift[axis]), zero(0.0);
      const D place = (((line + shifter) - shifter) - D(shift[axis])) / D(scale[axis]);
      const auto here = part == D(number);
      value = select(here, (at - place) * D(side), value);
      const Vec3<D> normal{axis == 0 ? D(side) : zero, zero, axis == 2 ? D(side) : zero};
      gradient = select_lanes(here, normal, gradient);
    };
    wall(kWallLowX, 0, p.x, -1), wall(kWallHighX, 0, p.x, 1);
    wall(kWallLowZ, 2, p.z, -1), wall(kWallHighZ, 2, p.z, 1);
  }
  static bool is_smooth(const Pool& pool, std::size_t i) { return pool.elements[i].smooth; }
  /// The gradient that light falls by where a smooth field is hit at p: at a sample that of the heights of
  /// its neighbours, and between four samples the mean of theirs.
  static Vec3d smooth_gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// Below the surface and above the bottom of a solid; nothing is inside of an open surface.
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u from the first column to the last, v from the last row to the first, as in an image that is looked at
  /// from above.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
};

}  // namespace oktett
