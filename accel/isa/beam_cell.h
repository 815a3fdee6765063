#pragma once
/// \file The cell of an exact surface as a beam sees it.

#include <algorithm>
#include <cmath>

#include "accel/exact_table.h"
#include "core/lanes.h"
#include "core/simd.h"
#include "kernels/exact/exact_pool.h"
#include "kernels/exact/segment.h"

namespace oktett {

/// Lines of a beam in the own space of an element. At the depth z = (1 + s) depth, where `depth` is that of
/// the middle of the cell, the ray (x, y) is at q + s w. Here q = middle + dx u + dy v and w = q - middle +
/// from_apex, with (dx, dy) from the middle to (x, y). Near the cell dx, dy and s are small, so hardly any
/// digits cancel, however far away the apex is.
struct BeamCell {
  float x, y, depth;
  Vec3f middle, u, v, from_apex;
  Vec3f lo, hi;      ///< the cell, wider by twice the error
  float error;       ///< bound on the error of a coordinate in the cell
  bool may_be_sure;  ///< the whole cell is farther than 1 / near_s, see BeamRays

  /// False if the cell is too near or too large for the bound.
  OKTETT_INLINE bool set(const ExactPoolBase& pool, const ExactCell& cell, const BeamView& beam) {
    const auto& to_own = pool.frames[cell.element].to_own.m;
    const auto& to_world = pool.frames[cell.element].to_world.m;
    const Vec3d c = (cell.lo + cell.hi) * 0.5, half = (cell.hi - cell.lo) * 0.5;
    double from[3], reach[3];
    for (int k = 0; k < 3; ++k) {
      const auto& row = to_world[static_cast<std::size_t>(beam.axis[k])];
      from[k] = row[0] * c.x + row[1] * c.y + row[2] * c.z + row[3] - beam.apex[beam.axis[k]];
      reach[k] = std::fabs(row[0]) * half.x + std::fabs(row[1]) * half.y + std::fabs(row[2]) * half.z;
    }
    const double z = beam.mirrored ? -from[2] : from[2];
    if (!(z >= 2 * reach[2])) return false;
    const double cx = from[0] / z, cy = from[1] / z;
    double most = 0;
    Vec3d w{0, 0, 0}, col[2];
    for (int i = 0; i < 3; ++i) {
      const auto& row = to_own[static_cast<std::size_t>(i)];
      most = std::max(most, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
      for (int k = 0; k < 3; ++k) w[i] += row[static_cast<std::size_t>(beam.axis[k])] * from[k];
      for (int k = 0; k < 2; ++k) col[k][i] = row[static_cast<std::size_t>(beam.axis[k])] * z;
    }
    const double far = std::max({double{beam.farthest}, std::fabs(cx), std::fabs(cy)});
    const double size = most * (1 + far) * std::max({reach[0], reach[1], reach[2]});
    const double own = std::max({std::fabs(c.x), std::fabs(c.y), std::fabs(c.z)});
    const double bound = 0x1p-23 * (3 * far * most * z + 24 * size + 4 * own) + 2 * most * beam.slack;
    if (!(far <= 4 && most * z <= 0x1p14 && bound <= 0x1p-6 && size <= 0x1p6)) return false;
    x = static_cast<float>(cx), y = static_cast<float>(cy), depth = static_cast<float>(z);
    middle = Vec3f(c), u = Vec3f(col[0]), v = Vec3f(col[1]), from_apex = Vec3f(w);
    error = static_cast<float>(bound);
    const Vec3d wider{2 * bound, 2 * bound, 2 * bound};
    lo = Vec3f(cell.lo - wider), hi = Vec3f(cell.hi + wider);
    may_be_sure = 2 / z < beam.near_s;
    return true;
  }
};

/// The 16 rays of a group in the cell.
template <class F>
struct BeamCellRays {
  Segment<F> segment;
  typename F::M empty;  ///< surely miss the cell, or meet it farther away than what they have hit already
  typename F::M whole;  ///< their range surely reaches beyond the cell
  typename F::M ends;   ///< their range surely ends before they leave the cell

  OKTETT_INLINE BeamCellRays(const BeamCell& cell, const BeamView& beam, int base) {
    const F dx = F::load(beam.x + base) - F(cell.x), dy = F::load(beam.y + base) - F(cell.y), one(1.0f);
    F from(-1.0f), to(std::numeric_limits<float>::max());
    F step[3], start[3];
    for (int k = 0; k < 3; ++k) {
      const F moved = fast_fma(dx, F(cell.u[k]), dy * F(cell.v[k]));
      start[k] = moved + F(cell.middle[k]), step[k] = moved + F(cell.from_apex[k]);
      // NaN, for lines along a face, restricts nothing.
      const F inverse = fast_reciprocal(step[k]);
      const F p = (F(cell.lo[k]) - start[k]) * inverse, q = (F(cell.hi[k]) - start[k]) * inverse;
      from = max(min(p, q), from), to = min(max(p, q), to);
    }
    // The range of a ray ends at the inverse depth hit_lo.
    const F leave = (to + one) * F(cell.depth), hit_lo = F::load(beam.hit_lo + base);
    whole = leave * F::load(beam.hit_hi + base) <= F(1 - 0x1p-20f);
    const auto inside = leave * hit_lo <= one;
    ends = F(1 + 0x1p-20f) <= leave * hit_lo;
    if (any(~inside)) {
      const F end = fast_fma(fast_reciprocal(F(cell.depth) * hit_lo), F(1 + 0x1p-19f), F(-1.0f));
      to = select(inside, to, min(end, to));
    }
    empty = to < from;
    const auto place = [&](const F& s) {
      return Vec3<F>{fast_fma(s, step[0], start[0]), fast_fma(s, step[1], start[1]),
                     fast_fma(s, step[2], start[2])};
    };
    segment = {place(from), place(to), cell.error};
  }
};

/// Those rays of the segment that are surely inside of the cell at the place `at`.
template <class F>
OKTETT_INLINE typename F::M surely_in_cell(const BeamCell& cell, const Segment<F>& s, const F& at) {
  auto in = F::M::all_true();
  const F* a[3] = {&s.a.x, &s.a.y, &s.a.z};
  const F* b[3] = {&s.b.x, &s.b.y, &s.b.z};
  const float inner = 4 * cell.error;
  for (int k = 0; k < 3; ++k) {
    const F p = fast_fma(at, *b[k] - *a[k], *a[k]);
    in = in & (F(cell.lo[k] + inner) < p) & (p < F(cell.hi[k] - inner));
  }
  return in;
}

}  // namespace oktett
