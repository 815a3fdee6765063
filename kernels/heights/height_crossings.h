#pragma once
/// \file HeightField::crossings. For accel/isa/ alone, so that a change to the walks recompiles little.

#include "kernels/heights/height_pyramid.h"
#include "kernels/heights/height_slope.h"

namespace oktett {

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
  constexpr int W = D::kWidth;
  double t[K][W], turn[K][W], part[K][W], up_to[W];
  for (int lane = 0; lane < W; ++lane) {
    Crossings<K, One> c;
    c.clear();
    if ((bits(active) >> lane & 1) != 0)
      find_in_lanes(e, GridLines<One>(g, lane), {lane_of(range.a, lane), lane_of(range.b, lane), {}, {}},
                    One::M::all_true(), c);
    for (int k = 0; k < K; ++k)
      t[k][lane] = c.t[k].part[0].v, turn[k][lane] = c.turn[k].part[0].v, part[k][lane] = c.part[k].part[0].v;
    up_to[lane] = c.up_to.part[0].v;
  }
  for (int k = 0; k < K; ++k)
    out.t[k] = D::load(t[k]), out.turn[k] = D::load(turn[k]), out.part[k] = D::load(part[k]);
  out.up_to = D::load(up_to);
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
    below[k] = (bits(side) >> k & 1) != 0 &&
                       HeightField::below_rim(*e.grid, static_cast<int>(faces[k]), x[k], y[k], z[k])
                   ? 1.0
                   : 0.0;
  return asked & (bottom | (D(0.0) < D::load(below)));
}

}  // namespace height

template <int K, class D>
void HeightField::crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                            const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
  const HeightFieldElement& e = pool.elements[cell.element];
  const GridLines<D> g(*e.grid, e.frame, e.margin, line);
  if (!e.solid) return height::find(e, g, range, active, out);
  constexpr int kOwn = K > 2 ? K - 2 : K;
  Crossings<kOwn, D> own;
  height::find(e, g, range, active, own);
  // Without a crossing it is inside all the way or not at all.
  const auto silent = active & ~(own.t[0] < D(roots::kNoRoot));
  close_by_cell(own, height::starts_inside(e, g, range, silent), range, active, out);
}

}  // namespace oktett
