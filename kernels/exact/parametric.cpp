#include "kernels/exact/parametric.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "kernels/functions/function_tape.h"

namespace oktett {
namespace {

using UvLane = Simd<double, 1, ScalarIsa>;
using UvSpan = Interval<UvLane>;
using UvDual = Dual<UvSpan>;
using SurfacePart = ParametricElement::Piece;

/// Halvings of the rectangle along each axis, and pieces after which it is not divided any more.
constexpr int kLeastHalvings = 2, kMostHalvings = 7;
constexpr std::size_t kMostParts = 8192;

bool is_finite_box(const Vec3d& lo, const Vec3d& hi) {
  const Vec3d sum = lo + hi;
  return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z);
}

/// Whether the derivatives vary so little that most rays find their crossing at once.
bool is_smooth(const SurfacePart& part) {
  const Vec3d a = (part.u_lo + part.u_hi) * 0.5, b = (part.v_lo + part.v_hi) * 0.5;
  const double stray =
      length(part.u_hi - part.u_lo) * 0.5 * length(b) + length(part.v_hi - part.v_lo) * 0.5 * length(a);
  return stray <= 0.25 * length(cross(a, b));
}

struct WaitingPart {
  UvBox box;
  int halvings[2];
};

/// The axis to halve: along which the part is longer, as far as that is known.
int longer_axis(const SurfacePart& part, const int (&halvings)[2]) {
  const double u = (length(part.u_lo) + length(part.u_hi)) * (part.box.u1 - part.box.u0),
               v = (length(part.v_lo) + length(part.v_hi)) * (part.box.v1 - part.box.v0);
  const bool known = std::isfinite(u) && std::isfinite(v);
  const int axis = known ? (u >= v ? 0 : 1) : halvings[0] <= halvings[1] ? 0 : 1;
  const int least = std::min(halvings[0], halvings[1]);
  // Neither axis gets far ahead of what every part has to have.
  if (least < kLeastHalvings) return halvings[0] <= halvings[1] ? 0 : 1;
  return halvings[axis] < kMostHalvings ? axis : 1 - axis;
}

bool is_in_cut(const ParametricElement& e, const SurfacePart& part) {
  if (!e.is_cut) return true;
  for (int k = 0; k < 3; ++k)
    if (part.lo[k] > e.cut_hi[k] || part.hi[k] < e.cut_lo[k]) return false;
  return true;
}

/// Calls take(part) for the parts of the rectangle in which the surface is, divided far enough.
template <class Take>
void divide_rectangle(const ParametricElement& e, int most_halvings, const Take& take) {
  std::deque<WaitingPart> waiting{{e.whole, {0, 0}}};
  std::size_t taken = 0;
  while (!waiting.empty()) {
    const WaitingPart here = waiting.front();
    waiting.pop_front();
    SurfacePart part;
    if (!enclose_parametric(e, here.box, part) || !is_in_cut(e, part)) continue;
    const int least = std::min(here.halvings[0], here.halvings[1]);
    const bool ends = least >= most_halvings || taken + waiting.size() >= kMostParts;
    if (ends || (least >= std::min(kLeastHalvings, most_halvings) && is_smooth(part))) {
      ++taken;
      take(part);
      continue;
    }
    const int axis = longer_axis(part, here.halvings);
    WaitingPart low = here, high = here;
    ++low.halvings[axis], ++high.halvings[axis];
    if (axis == 0)
      low.box.u1 = high.box.u0 = here.box.u0 + (here.box.u1 - here.box.u0) * 0.5;
    else
      low.box.v1 = high.box.v0 = here.box.v0 + (here.box.v1 - here.box.v0) * 0.5;
    waiting.push_back(low), waiting.push_back(high);
  }
}

/// Sets the own space: about the part of the surface that is seen, and 1 in size. False if there is none.
bool set_own_space(ParametricElement& e, const ParametricShape& s) {
  e.origin = {0, 0, 0}, e.per_size = 1;
  Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi = -lo;
  e.is_cut = s.cut, e.cut_lo = s.lo, e.cut_hi = s.hi;
  constexpr int kRough = 4;
  divide_rectangle(e, kRough, [&](const SurfacePart& part) {
    if (is_finite_box(part.lo, part.hi)) lo = min(lo, part.lo), hi = max(hi, part.hi);
  });
  if (s.cut) lo = max(lo, s.lo), hi = min(hi, s.hi);
  const double size = 0.5 * max_component(hi - lo);
  if (!(size > 0) || !is_finite_box(lo, hi)) return false;
  int shift = 0;
  std::frexp(size, &shift);
  e.per_size = std::ldexp(1.0, -shift);
  if (!(std::isfinite(e.per_size) && std::isfinite(1 / e.per_size))) return false;
  e.origin = (lo + hi) * 0.5;
  e.cut_lo = (s.lo - e.origin) * e.per_size, e.cut_hi = (s.hi - e.origin) * e.per_size;
  constexpr double kBeyond = 1.5;
  e.reach_lo = s.cut ? e.cut_lo : Vec3d{-kBeyond, -kBeyond, -kBeyond};
  e.reach_hi = s.cut ? e.cut_hi : Vec3d{kBeyond, kBeyond, kBeyond};
  return true;
}

}  // namespace

bool enclose_parametric(const ParametricElement& e, const UvBox& box, ParametricElement::Piece& piece) {
  const UvLane zero(0.0), one(1.0);
  const UvSpan u(UvLane(box.u0), UvLane(box.u1)), v(UvLane(box.v0), UvLane(box.v1)), none(zero), unit(one);
  const UvSpan mu(UvLane(box.u0 + (box.u1 - box.u0) * 0.5)), mv(UvLane(box.v0 + (box.v1 - box.v0) * 0.5));
  piece.box = box;
  const UvLane per(e.per_size);
  for (int k = 0; k < 3; ++k) {
    const FunctionTape& f = e.f[k];
    const UvDual by_u = run_tape(f, UvDual{u, unit}, UvDual{v, none}, UvDual{none, none});
    const UvDual by_v = run_tape(f, UvDual{u, none}, UvDual{v, unit}, UvDual{none, none});
    const UvSpan at = run_tape(f, mu, mv, none), origin(UvLane(e.origin[k]));
    if (any(by_u.v.is_void())) return false;
    const UvSpan value = (by_u.v - origin) * per, middle = (at - origin) * per;
    piece.lo[k] = only_lane(value.lo), piece.hi[k] = only_lane(value.hi);
    const double low = only_lane(middle.lo), high = only_lane(middle.hi);
    piece.middle[k] = (low + high) * 0.5, piece.noise[k] = (high - low) * 0.5;
    if (!std::isfinite(piece.noise[k])) piece.middle[k] = std::nan(""), piece.noise[k] = 0;
    const UvSpan along_u = by_u.d * per, along_v = by_v.d * per;
    piece.u_lo[k] = only_lane(along_u.lo), piece.u_hi[k] = only_lane(along_u.hi);
    piece.v_lo[k] = only_lane(along_v.lo), piece.v_hi[k] = only_lane(along_v.hi);
    // What the mean value theorem makes of bounded derivatives.
    const double reach =
        std::max(std::abs(piece.u_lo[k]), std::abs(piece.u_hi[k])) * (box.u1 - box.u0) * 0.5 +
        std::max(std::abs(piece.v_lo[k]), std::abs(piece.v_hi[k])) * (box.v1 - box.v0) * 0.5;
    const double room = reach * (1 + 0x1p-40) + (std::abs(low) + std::abs(high)) * 0x1p-50;
    if (!std::isfinite(piece.lo[k])) piece.lo[k] = e.reach_lo[k];
    if (!std::isfinite(piece.hi[k])) piece.hi[k] = e.reach_hi[k];
    if (std::isfinite(room))
      piece.lo[k] = std::max(piece.lo[k], low - room), piece.hi[k] = std::min(piece.hi[k], high + room);
  }
  return true;
}

UvFrame parametric_at(const ParametricElement& e, double u, double v) {
  using Number = Gradient<UvLane>;
  const UvLane zero(0.0), one(1.0);
  const Number at_u{UvLane(u), {one, zero, zero}}, at_v{UvLane(v), {zero, one, zero}},
      none{zero, {zero, zero, zero}};
  UvFrame f{};
  for (int k = 0; k < 3; ++k) {
    const Number value = run_tape(e.f[k], at_u, at_v, none);
    f.p[k] = (only_lane(value.v) - e.origin[k]) * e.per_size;
    f.by_u[k] = only_lane(value.d.x) * e.per_size, f.by_v[k] = only_lane(value.d.y) * e.per_size;
  }
  return f;
}

void Parametric::add(Pool& pool, const ParametricShape& s, const ExactPlace& place) {
  if (!(s.from[0] < s.to[0] && s.from[1] < s.to[1])) return;
  ParametricElement e;
  e.f[0] = s.x.tape, e.f[1] = s.y.tape, e.f[2] = s.z.tape;
  for (const FunctionTape& f : e.f)
    if (f.steps.empty() && !f.varies) return;
  e.whole = {s.from[0], s.to[0], s.from[1], s.to[1]};
  if (!set_own_space(e, s)) return;
  divide_rectangle(e, kMostHalvings, [&](const SurfacePart& part) { e.pieces.push_back(part); });
  if (e.pieces.empty()) return;
  if (!s.open) turn_outwards(e);
  const double size = 1 / e.per_size;
  add_element(pool, e, place.to_world * Affine::translation(e.origin) * Affine::scaling({size, size, size}),
              place);
  constexpr double kRoom = 0x1p-40;
  const Vec3d room{kRoom, kRoom, kRoom};
  for (std::size_t k = 0; k < e.pieces.size(); ++k) {
    Vec3d lo = e.pieces[k].lo, hi = e.pieces[k].hi;
    if (e.is_cut) lo = max(lo, e.cut_lo), hi = min(hi, e.cut_hi);
    add_cell(pool, lo - room, hi + room).begin = static_cast<std::uint32_t>(k);
  }
}

int Parametric::first_of(const ParametricElement& e, std::size_t piece, const Vec3d& o, const Vec3d& d,
                         double begin, int room, double* t, double* turn, double& up_to) {
  return first_crossings_of(e, piece, o, d, begin, room, t, turn, up_to);
}

UvPoint Parametric::point(const ParametricElement& e, std::size_t, double u, double v) {
  const UvFrame f = parametric_at(e, u, v);
  return {f.p, f.by_u, f.by_v, {u, v}, f.by_u, f.by_v};
}

bool Parametric::is_cut(const ParametricElement& e, const Vec3d& p) {
  if (!e.is_cut) return false;
  for (int k = 0; k < 3; ++k)
    if (!(e.cut_lo[k] <= p[k] && p[k] <= e.cut_hi[k])) return true;
  return false;
}

}  // namespace oktett
