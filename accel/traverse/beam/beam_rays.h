#pragma once
/// \file A beam: up to 256 rays whose lines pass through one point, the apex, as points of a plane.
///
/// The apex is the origin. z is the axis along which the middle ray is steepest, mirrored so that the rays go
/// towards +z. A ray becomes the point (x, y) = (dx/dz, dy/dz), and a point on it has the inverse depth s =
/// 1/z. A box becomes a rectangle with a greatest s. The barycentric coordinates of a triangle and its s are
/// linear functions of (x, y). The axes are only exchanged, not rotated, so a projected coordinate has two
/// roundings.
///
/// The apex is the common origin of the rays, or the point where all of them end, as shadow rays do at a
/// point light. In the second case rounding moves their lines off the apex by at most `slip`.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "accel/exact_table.h"
#include "accel/ray_state.h"
#include "accel/traverse/leaf.h"

namespace oktett {

/// Where the lines of a beam meet.
struct Apex {
  Vec3f point;
  bool at_end = false;  ///< the rays end there (at tmax) instead of starting there
};

/// A parallelogram in the plane of a beam: middle + a * (x1, y1) + b * (x2, y2) with |a|, |b| <= 1.
struct BeamPatch {
  float x, y;
  float x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};

/// The part of the plane that some rays cover: a rectangle and a patch that each contain all of them, and the
/// least inverse depth at which one of them may still find a nearer hit.
struct BeamWindow {
  float x_lo, x_hi, y_lo, y_hi, least;
  BeamPatch patch;
};

template <class A>
struct alignas(64) BeamRays {
  using F = Simd<float, kBeamGroup, A>;

  float x[kBeamRays], y[kBeamRays];
  /// Bounds on the inverse depth of the nearest hit so far; before the first hit, of the end of the ray. What
  /// is surely below hit_lo is farther away, what is surely above hit_hi is nearer.
  float hit_lo[kBeamRays], hit_hi[kBeamRays];
  /// The candidate hit of each ray: a triangle, 8 * block + lane, that the ray surely hits and that is not
  /// decided yet. kNoId: none.
  std::uint32_t candidate[kBeamRays];
  /// Rectangles around the groups, and the least hit_lo in each.
  float x_lo[kBeamGroups], x_hi[kBeamGroups], y_lo[kBeamGroups], y_hi[kBeamGroups], least[kBeamGroups];
  /// Middles of the groups. If `regular`, all groups have the shape of `shape`; otherwise each is a rectangle
  /// with half sides of its own.
  float x_mid[kBeamGroups], y_mid[kBeamGroups], x_half[kBeamGroups], y_half[kBeamGroups];
  bool regular;
  bool ranged;  ///< some ray has a finite end
  BeamPatch shape;
  bool may_sort;  ///< the groups of a full beam overlap, so sorting the rays would make them smaller
  /// If `sorted`, ray i of the beam is ray order[i] of the batch.
  bool sorted = false;
  std::uint8_t order[kBeamRays];
  unsigned groups;  ///< groups that hold a ray that can hit anything
  BeamWindow window;

  int axis[3];    ///< which axes of the scene are x, y, z
  bool mirrored;  ///< z runs against the scene's axis
  bool at_end;    ///< the apex is where the rays end
  float apex[3];  ///< in the order of `axis`
  float slip;     ///< how far, in x and y, a line passes from the apex at its depth
  float behind;   ///< how far beyond the apex the rays may reach
  float near_s;   ///< hits with an inverse depth above this may lie outside a ray's range
  float margin;   ///< how far rounding may displace a vertex in the exact decision
  float spread;   ///< max(1, |x|, |y|)

  /// Prepares up to kBeamRays rays. False if they are no beam: they do not share the apex, fan out too far,
  /// or their numbers are too large or too small for the error bounds. `extent` is the greatest |coordinate|
  /// of the scene. `may_be_sorted`: the rays may be put into another order later.
  bool set(const RaySpan& rays, const Apex& at, float extent, bool may_be_sorted);

  /// Puts the rays into an order that makes the groups small.
  void sort();

  /// Updates least[group] after hits.
  OKTETT_INLINE void refresh(int group) {
    least[group] = horizontal_min(F::load(hit_lo + group * kBeamGroup));
  }
  OKTETT_INLINE void refresh_groups() {
    if (ranged) {
      for (int g = 0; g < kBeamGroups; ++g) refresh(g);
    } else {
      Simd<float, kBeamGroups, A>(0.0f).store(least);
    }
    refresh_window();
  }
  OKTETT_INLINE void refresh_window() { window.least = horizontal_min(F::load(least)); }

 private:
  bool set_frame(const RaySpan& rays, const Apex& at, float extent);
  bool project(const RaySpan& rays, const Apex& at);
  void bound();
  float bound_groups();
};

/// Scales between which products of three lengths and their inverses neither overflow nor underflow in float.
inline constexpr float kBeamLeast = 0x1p-40f, kBeamMost = 0x1p40f;
/// Relative slack for the few roundings of a projected box.
inline constexpr float kBeamSlack = 0x1p-20f;
/// The same for the inverse depth of one point.
inline constexpr float kBeamPointSlack = 0x1p-22f;

template <class A>
bool BeamRays<A>::set_frame(const RaySpan& rays, const Apex& at, float extent) {
  const Vec3f p = at.point;
  const float reach = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z), extent});
  if (!(reach >= kBeamLeast && reach <= kBeamMost)) return false;
  margin = reach * 0x1p-46f;
  const std::size_t middle = rays.size / 2;
  const float d[3] = {rays.direction[0][middle], rays.direction[1][middle], rays.direction[2][middle]};
  int z = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(d[k]) > std::fabs(d[z])) z = k;
  axis[0] = (z + 1) % 3, axis[1] = (z + 2) % 3, axis[2] = z;
  mirrored = (d[z] < 0) != at.at_end, at_end = at.at_end;
  for (int k = 0; k < 3; ++k) apex[k] = p[axis[k]];
  return std::fabs(d[z]) > 0;
}

/// Fills x, y, hit_lo, hit_hi and candidate, and bounds slip, behind and near_s.
template <class A>
bool BeamRays<A>::project(const RaySpan& rays, const Apex& at) {
  const F zero(0.0f), one(1.0f), infinity(std::numeric_limits<float>::infinity());
  const F least_dz(kBeamLeast), most_dz(kBeamMost), limit(kBeamMost), most_s(kBeamMost * kBeamMost);
  const F big(std::numeric_limits<float>::max()), slack_lo(1 - kBeamPointSlack),
      slack_hi(1 + kBeamPointSlack);
  const F apex_lanes[3] = {F(at.point.x), F(at.point.y), F(at.point.z)};
  // Directions from the apex, towards +z.
  const F turn(at.at_end ? -1.0f : 1.0f), sign_z(mirrored != at.at_end ? -1.0f : 1.0f);
  F slips = zero, behinds = zero, nears = zero;
  float first_x = 0, first_y = 0;
  groups = 0;
  const int count = static_cast<int>(rays.size);
  for (int g = 0; g * kBeamGroup < count; ++g) {
    const int base = g * kBeamGroup;
    const RayLanes<F> r = load_span<F>(rays, static_cast<std::size_t>(base));
    const F* o[3] = {&r.o.x, &r.o.y, &r.o.z};
    const F* d[3] = {&r.d.x, &r.d.y, &r.d.z};
    const F dz = *d[axis[2]] * sign_z, dx = *d[axis[0]] * turn, dy = *d[axis[1]] * turn;
    const F inverse = one / dz;
    auto usable = (dz >= least_dz) & (dz <= most_dz) & (abs(dx) <= dz + dz) & (abs(dy) <= dz + dz);
    F s;
    if (!at.at_end) {
      usable = usable & (r.o.x == apex_lanes[0]) & (r.o.y == apex_lanes[1]) & (r.o.z == apex_lanes[2]);
      s = inverse / r.tmax;
      usable = usable & (s <= most_s);
      nears = max(r.tmin * dz, nears);
    } else {
      // The end of the ray relative to the apex, in double, because the difference is a rounding error of the
      // caller. Followed along its line to the apex's depth, it gives the slip.
      using D = Simd<double, kBeamGroup, A>;
      const D length = to_double(r.tmax);
      const auto end = [&](int k) {
        return fast_fma(length, to_double(*d[axis[k]]), to_double(*o[axis[k]])) - D(apex[k]);
      };
      const D over_d = end(2), beyond = mirrored ? over_d : -over_d;
      const F slip_x = abs(to_float(fast_fma(beyond, to_double(dx * inverse), end(0))));
      const F slip_y = abs(to_float(fast_fma(beyond, to_double(dy * inverse), end(1))));
      const F over = abs(to_float(over_d));
      const F depth = (*o[axis[2]] - F(apex[2])) * F(mirrored ? -1.0f : 1.0f);
      s = one / depth;
      usable = usable & (abs(r.o.x) <= limit) & (abs(r.o.y) <= limit) & (abs(r.o.z) <= limit) &
               (r.tmin == zero) & (depth > F(margin * 0x1p26f)) & (s <= most_s) & (zero < r.tmax) &
               (r.tmax <= limit);
      slips = max(select(usable, max(slip_x, slip_y), zero), slips);
      behinds = max(select(usable, over, zero), behinds);
    }
    const unsigned inside = count - base >= kBeamGroup ? 0xffffu : (1u << (count - base)) - 1;
    unsigned valid = inside & bits((zero <= r.tmin) & (r.tmin < r.tmax));
    if (OKTETT_UNLIKELY((valid & ~bits(usable)) != 0)) {
      // Rays that can hit nothing may stay in the beam, other unusable ones not. Each comparison is false on
      // NaN.
      const F ex = abs(r.d.x), ey = abs(r.d.y), ez = abs(r.d.z);
      valid &= bits((abs(r.o.x) <= big) & (abs(r.o.y) <= big) & (abs(r.o.z) <= big) & (ex <= big) &
                    (ey <= big) & (ez <= big) & (zero < max(ex, max(ey, ez))));
      if ((valid & ~bits(usable)) != 0) return false;
    }
    F px = dx * inverse, py = dy * inverse, lo = s * slack_lo, hi = s * slack_hi;
    px.store(x + base), py.store(y + base);
    if (valid != 0) {
      if (groups == 0) first_x = x[base + __builtin_ctz(valid)], first_y = y[base + __builtin_ctz(valid)];
      groups |= 1u << g;
    }
    if (OKTETT_UNLIKELY(valid != 0xffff)) {
      const auto m = F::M::from_bits(valid);
      select(m, px, F(first_x)).store(x + base), select(m, py, F(first_y)).store(y + base);
      lo = select(m, lo, infinity), hi = select(m, hi, infinity);  // what makes a ray idle
    }
    lo.store(hit_lo + base), hi.store(hit_hi + base);
    std::memset(candidate + base, 0xff, kBeamGroup * sizeof candidate[0]);
  }
  // Lanes and groups without a ray take the place of the first ray, so that they widen no bounds.
  const int ends = (count + kBeamGroup - 1) / kBeamGroup * kBeamGroup;
  for (int i = 0; i < kBeamRays; i += kBeamGroup) {
    if (i < ends && (groups & ((2u << i / kBeamGroup) - 1)) != 0) continue;
    F(first_x).store(x + i), F(first_y).store(y + i), infinity.store(hit_lo + i), infinity.store(hit_hi + i);
  }
  behind = at.at_end ? horizontal_max(behinds) * (1 + kBeamSlack) + margin : 0.0f;
  slip = at.at_end ? horizontal_max(slips) * (1 + kBeamSlack) + behind * kBeamSlack + margin : 0.0f;
  const float near = at.at_end ? behind : horizontal_max(nears);
  near_s = near > kBeamLeast * kBeamLeast ? (1 - kBeamSlack) / near : 1 / (kBeamLeast * kBeamLeast);
  // A slip greater than rounding errors means that the rays do not share the apex.
  return slip + behind <= margin * 0x1p28f;
}

/// Two directions along which the rays of the first group lie in rows, as pixels do; the axes if there are
/// none.
OKTETT_INLINE void group_axes(const float* x, const float* y, float (&e)[2][2]) {
  e[0][0] = e[1][1] = 1, e[0][1] = e[1][0] = 0;
  const float ax = x[1] - x[0], ay = y[1] - y[0], a = std::sqrt(ax * ax + ay * ay);
  float far = 0, bx = 0, by = 0;
  for (int i = 2; i < kBeamGroup; ++i) {
    const float dx = x[i] - x[0], dy = y[i] - y[0], distance = std::fabs(ax * dy - ay * dx);
    if (distance > far * 1.01f) far = distance, bx = dx, by = dy;
  }
  const float b = std::sqrt(bx * bx + by * by);
  // Directions that are nearly parallel are useless.
  if (!(a > 0) || !(far > 0.2f * a * b)) return;
  e[0][0] = ax / a, e[0][1] = ay / a, e[1][0] = bx / b, e[1][1] = by / b;
}

OKTETT_INLINE float patch_area(const BeamPatch& p) { return 4 * std::fabs(p.x1 * p.y2 - p.y1 * p.x2); }

/// Rectangles and patches around the groups and the whole.
template <class A>
void BeamRays<A>::bound() {
  using G = Simd<float, kBeamGroups, A>;
  float e[2][2];
  group_axes(x, y, e);
  const float det = e[0][0] * e[1][1] - e[0][1] * e[1][0];
  // (x, y) = a e[0] + b e[1]
  const F ax(e[1][1] / det), ay(-e[1][0] / det), bx(-e[0][1] / det), by(e[0][0] / det);
  window.patch.x = 0.5f * (x[0] + x[kBeamRays - 1]), window.patch.y = 0.5f * (y[0] + y[kBeamRays - 1]);
  F ga(0.0f), gb = ga, gx = ga, gy = ga, wa = ga, wb = ga, least_x(x[0]), most_x = least_x, least_y(y[0]),
              most_y = least_y, any_range(0.0f);
  for (int g = 0; g < kBeamGroups; ++g) {
    const int base = g * kBeamGroup;
    const F px = F::load(x + base), py = F::load(y + base);
    x_mid[g] = 0.5f * (x[base] + x[base + kBeamGroup - 1]),
    y_mid[g] = 0.5f * (y[base] + y[base + kBeamGroup - 1]);
    const F dx = px - F(x_mid[g]), dy = py - F(y_mid[g]);
    ga = max(abs(dx * ax + dy * ay), ga), gb = max(abs(dx * bx + dy * by), gb);
    gx = max(abs(dx), gx), gy = max(abs(dy), gy);
    const F ux = px - F(window.patch.x), uy = py - F(window.patch.y);
    wa = max(abs(ux * ax + uy * ay), wa), wb = max(abs(ux * bx + uy * by), wb);
    least_x = min(px, least_x), most_x = max(px, most_x), least_y = min(py, least_y),
    most_y = max(py, most_y);
    any_range = max(F::load(hit_lo + base), any_range);
  }
  window.x_lo = horizontal_min(least_x), window.x_hi = horizontal_max(most_x);
  window.y_lo = horizontal_min(least_y), window.y_hi = horizontal_max(most_y);
  spread = std::max(
      {1.0f, std::fabs(window.x_lo), std::fabs(window.x_hi), std::fabs(window.y_lo), std::fabs(window.y_hi)});
  const auto set_axes = [&](BeamPatch& p, float a, float b) {
    p.x1 = a * e[0][0], p.y1 = a * e[0][1], p.x2 = b * e[1][0], p.y2 = b * e[1][1];
  };
  constexpr float kWiden = 1 + 0x1p-10f;
  const float hx = horizontal_max(gx) * kWiden, hy = horizontal_max(gy) * kWiden;
  set_axes(shape, horizontal_max(ga) * kWiden, horizontal_max(gb) * kWiden);
  set_axes(window.patch, horizontal_max(wa) * kWiden, horizontal_max(wb) * kWiden);
  // Groups that are about a sixteenth of the whole: pixels in blocks or rows.
  regular = hx * hy * 8 <= (window.x_hi - window.x_lo) * (window.y_hi - window.y_lo);
  if (regular) {
    const G xm = G::load(x_mid), ym = G::load(y_mid), pad(spread * 0x1p-22f);
    (xm - G(hx) - pad).store(x_lo), (xm + G(hx) + pad).store(x_hi);
    (ym - G(hy) - pad).store(y_lo), (ym + G(hy) + pad).store(y_hi);
  }
  ranged = horizontal_max(any_range) != 0;
}

/// Rectangles around groups that have no common shape. Returns the sum of their areas.
template <class A>
float BeamRays<A>::bound_groups() {
  using G = Simd<float, kBeamGroups, A>;
  for (int g = 0; g < kBeamGroups; ++g) {
    const F px = F::load(x + g * kBeamGroup), py = F::load(y + g * kBeamGroup);
    x_lo[g] = horizontal_min(px), x_hi[g] = horizontal_max(px);
    y_lo[g] = horizontal_min(py), y_hi[g] = horizontal_max(py);
  }
  const G half(0.5f), x0 = G::load(x_lo), x1 = G::load(x_hi), y0 = G::load(y_lo), y1 = G::load(y_hi);
  ((x0 + x1) * half).store(x_mid), ((y0 + y1) * half).store(y_mid);
  ((x1 - x0) * half).store(x_half), ((y1 - y0) * half).store(y_half);
  alignas(64) float area[kBeamGroups];
  ((x1 - x0) * (y1 - y0)).store(area);
  float sum = 0;
  for (int g = 0; g < kBeamGroups; ++g) sum += area[g];
  return sum;
}

/// A counting sort by cells of a grid, row by row, in turn to the right and to the left, so that consecutive
/// rays make small groups.
template <class A>
void BeamRays<A>::sort() {
  constexpr int kCells = 64, kMostRows = 8;
  const float width = std::max(window.x_hi - window.x_lo, 1e-30f),
              height = std::max(window.y_hi - window.y_lo, 1e-30f);
  // So many rows that groups are about square.
  const int rows = std::clamp(static_cast<int>(4 * std::sqrt(height / width) + 0.5f), 1, kMostRows);
  const int columns = kCells / rows;
  const float down = (static_cast<float>(rows) - 0.01f) / height, x0 = window.x_lo, y0 = window.y_lo;
  const float along = (static_cast<float>(columns) - 0.01f) / width;
  alignas(64) float cx[kBeamRays], cy[kBeamRays], lo[kBeamRays], hi[kBeamRays];
  std::memcpy(cx, x, sizeof x), std::memcpy(cy, y, sizeof y);
  std::memcpy(lo, hit_lo, sizeof lo), std::memcpy(hi, hit_hi, sizeof hi);
  alignas(64) std::int32_t key[kBeamRays];
  for (int i = 0; i < kBeamRays; ++i) {
    const int row = static_cast<int>((cy[i] - y0) * down), column = static_cast<int>((cx[i] - x0) * along);
    key[i] = row * columns + ((row & 1) != 0 ? columns - 1 - column : column);
  }
  // Two halves with a table each, because successive rays of one cell wait for each other.
  constexpr int kHalf = kBeamRays / 2;
  std::uint8_t next[kCells][2] = {};
  for (int i = 0; i < kHalf; ++i) ++next[key[i]][0], ++next[key[kHalf + i]][1];
  unsigned at = 0;
  for (auto& cell : next)
    for (std::uint8_t& half : cell) {
      const unsigned count = half;
      half = static_cast<std::uint8_t>(at), at += count;
    }
  const auto move = [&](int i, int half) {
    const int to = next[key[i]][half]++;
    order[to] = static_cast<std::uint8_t>(i);
    x[to] = cx[i], y[to] = cy[i], hit_lo[to] = lo[i], hit_hi[to] = hi[i];
  };
  for (int i = 0; i < kHalf; ++i) move(i, 0), move(kHalf + i, 1);
  sorted = true, may_sort = false, regular = false;
  groups = (1u << kBeamGroups) - 1;
  bound_groups();
  refresh_groups();
}

template <class A>
bool BeamRays<A>::set(const RaySpan& rays, const Apex& at, float extent, bool may_be_sorted) {
  sorted = false;
  if (!set_frame(rays, at, extent) || !project(rays, at)) return false;
  if (groups == 0) return true;
  bound();
  if (window.x_hi - window.x_lo > 1 || window.y_hi - window.y_lo > 1) return false;
  // Groups that do not overlap cover the window about once.
  const float area = (window.x_hi - window.x_lo) * (window.y_hi - window.y_lo);
  const float covered = regular ? patch_area(shape) * kBeamGroups : bound_groups();
  may_sort = may_be_sorted && rays.size == kBeamRays && covered > area;
  refresh_groups();
  return true;
}

/// The rays of a beam from place `at` on, as many as F has lanes.
template <class F, class A>
OKTETT_INLINE RayLanes<F> load_rays(const BeamRays<A>& beam, const RaySpan& rays, std::size_t at) {
  if (!beam.sorted) return load_span<F>(rays, at);
  const auto gather = [&](const float* column) {
    alignas(64) float lanes[F::kWidth];
    for (int i = 0; i < F::kWidth; ++i) lanes[i] = column[beam.order[at + static_cast<std::size_t>(i)]];
    return F::load(lanes);
  };
  return load_ray_lanes(gather, rays.origin, rays.direction, rays.tmin, rays.tmax);
}

/// The rays of one group.
template <class A>
OKTETT_INLINE RayLanes<Simd<float, kBeamGroup, A>> load_group(const BeamRays<A>& beam, const RaySpan& rays,
                                                              int group) {
  return load_rays<Simd<float, kBeamGroup, A>>(beam, rays, static_cast<std::size_t>(group) * kBeamGroup);
}

/// The window of a single group.
template <class A>
OKTETT_INLINE BeamWindow group_window(const BeamRays<A>& t, int g) {
  BeamWindow w{t.x_lo[g], t.x_hi[g], t.y_lo[g], t.y_hi[g], t.least[g], t.shape};
  if (!t.regular) w.patch = {0, 0, t.x_half[g], 0, 0, t.y_half[g]};
  w.patch.x = t.x_mid[g], w.patch.y = t.y_mid[g];
  return w;
}

}  // namespace oktett
