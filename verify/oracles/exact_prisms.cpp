/// \file Prisms: inside is where a line across crosses the outlines an odd number of times, by the
/// polynomials of their pieces in powers.

#include <algorithm>
#include <cmath>

#include "kernels/exact/prism.h"
#include "verify/oracles/curve_boxes.h"
#include "verify/oracles/exact_families.h"

namespace oktett {
namespace {

using PrismCurve = PrismShape::Curve;

/// x or z of a piece in powers of s, 0 <= s <= 1.
template <class R>
struct Powers {
  R c[4] = {}, end = 0;  ///< `end`: the value at 1, the same bits as the next piece has at 0

  R at(R s) const { return ((c[3] * s + c[2]) * s + c[1]) * s + c[0]; }
  R slope(R s) const { return (3 * c[3] * s + 2 * c[2]) * s + c[1]; }
  /// Calls f(s) where the value is `y`, by halving each part between places at which the slope is zero.
  template <class F>
  void each_place(R y, F&& f) const {
    R cuts[4] = {0}, disc = c[2] * c[2] - 3 * c[3] * c[1];
    int n = 1;
    if (c[3] == 0 && c[2] != 0) cuts[n++] = -c[1] / (2 * c[2]);
    if (c[3] != 0 && disc > 0) {
      const R q = -(c[2] + std::copysign(std::sqrt(disc), c[2])), u = q / (3 * c[3]), v = c[1] / q;
      cuts[n++] = std::min(u, v), cuts[n++] = std::max(u, v);
    }
    R lo = 0, at_lo = c[0];
    for (int i = 1; i <= n; ++i) {
      const R hi = i < n ? cuts[i] : 1;
      if (!(hi > lo && hi <= 1)) continue;
      const bool below = at_lo < y;
      at_lo = hi < 1 ? at(hi) : end;
      if (below != (at_lo < y)) {
        // Newton's method, kept between a and b.
        R a = lo, b = hi, s = (a + b) / 2;
        for (int k = 0; k < 100; ++k) {
          const R value = at(s) - y;
          ((value < 0) == below ? a : b) = s;
          constexpr R kEnough = std::numeric_limits<R>::epsilon();
          R next = s - value / slope(s);
          if (!(std::abs(next - s) < kEnough) && !(next > a && next < b)) next = (a + b) / 2;
          if (std::abs(next - s) < kEnough) break;
          s = next;
        }
        f(s);
      }
      lo = hi;
    }
  }
};

/// A piece of an outline and its box.
template <class R>
struct OutlineTruth {
  Powers<R> x, z;
  R lo_x = 0, hi_x = 0, lo_z = 0, hi_z = 0;
};

/// Straight edges that lie on each other two by two are not there.
template <class R>
void drop_doubled(std::vector<OutlineTruth<R>>& edges) {
  const auto same = [](const OutlineTruth<R>& a, const OutlineTruth<R>& b) {
    const R from[2] = {a.x.c[0], a.z.c[0]}, to[2] = {a.x.end, a.z.end};
    const bool along = from[0] == b.x.c[0] && from[1] == b.z.c[0] && to[0] == b.x.end && to[1] == b.z.end;
    const bool back = to[0] == b.x.c[0] && to[1] == b.z.c[0] && from[0] == b.x.end && from[1] == b.z.end;
    return along || back;
  };
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t k = i + 1; k < edges.size(); ++k) {
      if (!same(edges[i], edges[k])) continue;
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(k));
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(i));
      --i;
      break;
    }
}

/// By the definitions of the curves; the last piece closes the outline.
template <class R>
std::vector<OutlineTruth<R>> pieces_of(const PrismShape& s) {
  std::vector<OutlineTruth<R>> all;
  for (const PlaneOutline& p : s.outlines) {
    const std::size_t n = p.size(),
                      begin = s.curve == PrismCurve::quadratic || s.curve == PrismCurve::cubic ? 1 : 0;
    const std::size_t end = s.curve == PrismCurve::cubic ? n - 2 : n - 1;
    const auto add = [&](std::size_t last, const auto& powers) {
      OutlineTruth<R> piece;
      for (int axis = 0; axis < 2; ++axis) {
        const auto at = [&](std::size_t k) { return static_cast<R>(axis == 0 ? p[k].x : p[k].z); };
        Powers<R>& out = axis == 0 ? piece.x : piece.z;
        powers(at, out.c), out.end = at(last);
        R lo = out.at(0), hi = lo;
        for (int i = 1; i <= 64; ++i)
          lo = std::min(lo, out.at(R(i) / 64)), hi = std::max(hi, out.at(R(i) / 64));
        const R room = (hi - lo) / 8 + R(0x1p-30);
        (axis == 0 ? piece.lo_x : piece.lo_z) = lo - room, (axis == 0 ? piece.hi_x : piece.hi_z) = hi + room;
      }
      all.push_back(piece);
    };
    const auto line = [&](std::size_t a, std::size_t b) {
      add(b, [&](const auto& at, R(&c)[4]) { c[0] = at(a), c[1] = at(b) - at(a); });
    };
    for (std::size_t i = begin; i < end; i += s.curve == PrismCurve::bezier ? 3 : 1)
      add(s.curve == PrismCurve::bezier ? i + 3 : i + 1, [&](const auto& at, R(&c)[4]) {
        c[0] = at(i);
        switch (s.curve) {
          case PrismCurve::linear:
            c[1] = at(i + 1) - at(i);
            break;
          case PrismCurve::quadratic:
            // At -1, 0 and 1 it is at the point before, this and the next one.
            c[1] = (at(i + 1) - at(i - 1)) / 2, c[2] = (at(i + 1) + at(i - 1)) / 2 - at(i);
            break;
          case PrismCurve::cubic: {
            const R m = (at(i + 1) - at(i - 1)) / 2, l = (at(i + 2) - at(i)) / 2, d = at(i + 1) - at(i);
            c[1] = m, c[2] = 3 * d - 2 * m - l, c[3] = m + l - 2 * d;
            break;
          }
          case PrismCurve::bezier:
            c[1] = 3 * (at(i + 1) - at(i)), c[2] = 3 * (at(i) - 2 * at(i + 1) + at(i + 2));
            c[3] = at(i + 3) - at(i) + 3 * (at(i + 1) - at(i + 2));
            break;
        }
      });
    if (!(p[begin] == p[end])) line(end, begin);
  }
  if (s.curve == PrismCurve::linear) drop_doubled(all);
  return all;
}

/// About how far outside of the outlines: by the nearest of their points on the lines along x and z.
template <class R>
R outside_outlines(const std::vector<OutlineTruth<R>>& pieces, R x, R z) {
  R away = 3;
  bool odd = false;
  for (const OutlineTruth<R>& piece : pieces) {
    if (z >= piece.lo_z && z <= piece.hi_z && x <= piece.hi_x + away)
      piece.z.each_place(z, [&](R s) {
        const R at = piece.x.at(s);
        away = std::min(away, std::abs(at - x)), odd ^= at > x;
      });
    if (x >= piece.lo_x && x <= piece.hi_x && z >= piece.lo_z - away && z <= piece.hi_z + away)
      piece.x.each_place(x, [&](R s) { away = std::min(away, std::abs(piece.z.at(s) - z)); });
  }
  return odd ? -away : away;
}

/// A closed curve about a point, by points in turn; `wild` ones cross themselves.
PlaneOutline round_outline(CaseRandom& random, const FlatPoint& middle, double size, std::size_t n, bool wild,
                           bool coarse) {
  PlaneOutline p;
  for (std::size_t i = 0; i < n; ++i) {
    const double turn = wild ? random.unit() : static_cast<double>(i) / static_cast<double>(n);
    const double r = size * (0.45 + 0.55 * random.unit()), angle = 6.283185307179586 * turn;
    FlatPoint q{middle.x + r * std::cos(angle), middle.z + r * std::sin(angle)};
    if (coarse) q = {std::round(q.x * 8) / 8, std::round(q.z * 8) / 8};
    p.push_back(q);
  }
  return p;
}

/// How near to the tip rounding moves a point too much as seen from there.
constexpr double kTip = 1e-4;

/// The points with which a curve of a kind goes around and meets its beginning, or is closed by a line.
PlaneOutline around(CaseRandom& random, PlaneOutline p, PrismCurve curve) {
  if (curve == PrismCurve::linear) {
    if (random.unit() < 0.5) p.push_back(p.front());
    return p;
  }
  if (curve == PrismCurve::bezier) {
    while (p.size() % 3 != 0) p.pop_back();
    p.push_back(p.front());
    return p;
  }
  if (random.unit() < 0.2) return p;
  const PlaneOutline first = p;
  p.insert(p.begin(), first.back());
  p.push_back(first[0]);
  if (curve == PrismCurve::cubic) p.push_back(first[1]);
  return p;
}

template <PrismCurve kCurve>
ExactOracle prism(CaseRandom& random) {
  PrismShape s;
  s.curve = kCurve;
  s.open = random.unit() < 0.25;
  const bool coarse = random.unit() < 0.2, wild = random.unit() < 0.25;
  const auto corners = [&] { return static_cast<std::size_t>(4 + random.unit() * (wild ? 5 : 12)); };
  const double kind = random.unit();
  if (kind < 0.4) {
    // One, perhaps with a hole or with one across.
    s.outlines.push_back(round_outline(random, {0, 0}, 1, corners(), wild, coarse));
    if (random.unit() < 0.5) {
      const double shift = random.unit() < 0.5 ? 0 : random.unit();
      s.outlines.push_back(round_outline(random, {shift, 0}, 0.4, corners(), wild, coarse));
    }
  } else {
    // Letters.
    const int count = 2 + static_cast<int>(random.unit() * 4);
    for (int i = 0; i < count; ++i) {
      const FlatPoint at{(2.0 * i + 1) / count - 1, 0.3 * random.sign()};
      s.outlines.push_back(round_outline(random, at, 0.9 / count, corners(), wild, coarse));
      if (random.unit() < 0.4)
        s.outlines.push_back(round_outline(random, at, 0.3 / count, corners(), false, coarse));
    }
  }
  for (PlaneOutline& p : s.outlines) p = around(random, p, kCurve);
  if (random.unit() < 0.35) {
    s.sweep = PrismShape::Sweep::conic;
    const double where = random.unit();
    s.from = where < 0.4 ? 0 : where < 0.7 ? 0.2 + 0.5 * random.unit() : -1;
    s.to = 1;
    if (random.unit() < 0.2) std::swap(s.from, s.to), s.from = -s.from, s.to = -s.to;
  } else {
    s.from = random.sign(), s.to = s.from + random.magnitude(-1.5, 0.3);
  }
  if (s.from == s.to) s.to = s.from + 1;
  return oracle_of(s);
}

}  // namespace

ExactOracle oracle_of(const PrismShape& s) {
  const bool conic = s.sweep == PrismShape::Sweep::conic;
  const double from = std::min(s.from, s.to), to = std::max(s.from, s.to);
  const auto rough = pieces_of<double>(s);
  const auto pieces = pieces_of<Real>(s);
  ExactOracle o{{s}, {}};
  // In `Real` where `double` might not tell the sign.
  const auto side = [rough, pieces, conic](const Vec3l& p) -> Real {
    if (conic && p.y == 0) return 1;
    const Real x = conic ? p.x / p.y : p.x, z = conic ? p.z / p.y : p.z, scale = conic ? std::abs(p.y) : 1;
    const double about = outside_outlines<double>(rough, static_cast<double>(x), static_cast<double>(z));
    if (std::abs(about) > 0x1p-20 * (1 + static_cast<double>(std::abs(x) + std::abs(z))))
      return scale * about;
    return scale * outside_outlines<Real>(pieces, x, z);
  };
  const auto slab = [from, to](const Vec3l& p) { return std::max(from - p.y, p.y - to); };
  if (s.open) {
    o.f = side, o.where = slab;
  } else {
    o.f = [side, slab](const Vec3l& p) { return std::max(side(p), slab(p)); };
  }
  CurveBoxes curves;
  for (const OutlineTruth<double>& piece : rough) curves.add(piece.x, piece.z);
  // Where no curve is, the number of crossings stays the same. Seen from the tip a way is straight, too.
  o.clear = [curves, conic, from, to, side, open = s.open](const Vec3d& a, const Vec3d& b) {
    const Enclosure y = box_about(a, b).y;
    if (y.hi < from || y.lo > to) return true;
    if (conic && !(y.lo > kTip || y.hi < -kTip)) return false;
    const double ya = conic ? a.y : 1, yb = conic ? b.y : 1;
    if (curves.meet(Enclosure::between(a.x / ya, b.x / yb), Enclosure::between(a.z / ya, b.z / yb)))
      return false;
    // A flat end is none where the sides are not about it.
    return open || (y.lo > from && y.hi < to) || side(Vec3l(a)) > 0;
  };
  const double most = std::max(std::abs(from), std::abs(to));
  double x0 = HUGE_VAL, x1 = -HUGE_VAL, z0 = HUGE_VAL, z1 = -HUGE_VAL;
  for (const OutlineTruth<double>& piece : rough) {
    for (int i = 0; i <= 16; ++i) {
      const double x = piece.x.at(i / 16.0), z = piece.z.at(i / 16.0);
      x0 = std::min(x0, x), x1 = std::max(x1, x), z0 = std::min(z0, z), z1 = std::max(z1, z);
    }
  }
  if (conic) x1 = most * std::max(std::abs(x0), std::abs(x1)), x0 = -x1;
  if (conic) z1 = most * std::max(std::abs(z0), std::abs(z1)), z0 = -z1;
  o.lo = {x0, from, z0}, o.hi = {x1, to, z1};
  return o;
}

std::vector<ExactCase> prism_cases() {
  return {{"prism", prism<PrismCurve::linear>},
          {"prism_quadratic", prism<PrismCurve::quadratic>},
          {"prism_cubic", prism<PrismCurve::cubic>},
          {"prism_bezier", prism<PrismCurve::bezier>}};
}

}  // namespace oktett
