#pragma once
/// \file Crossings of lines with a height field.

#include "kernels/heights/height_pyramid.h"

namespace oktett::height {

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

/// The first K crossings with the element.
template <int K, class D>
void crossings(const HeightFieldElement& e, const Line<D>& line, const LineRange<D>& range,
               const typename D::M& active, Crossings<K, D>& out) {
  const GridLines<D> g(*e.grid, e.frame, e.margin, line);
  if (!e.solid) return find(e, g, range, active, out);
  constexpr int kOwn = K > 2 ? K - 2 : K;
  Crossings<kOwn, D> own;
  find(e, g, range, active, own);
  // Without a crossing it is inside all the way or not at all.
  const auto silent = active & ~(own.t[0] < D(roots::kNoRoot));
  close_by_cell(own, starts_inside(e, g, range, silent), range, active, out);
}

}  // namespace oktett::height
