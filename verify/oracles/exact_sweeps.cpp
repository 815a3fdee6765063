/// \file Sweeps of spheres: how far a point is from the nearest of the spheres, by search along the curve.

#include <algorithm>
#include <cmath>

#include "kernels/exact/sphere_sweep.h"
#include "verify/oracles/exact_families.h"

namespace oktett {
namespace {

using SweepCurve = SphereSweepShape::Curve;

/// A coordinate or the radius in powers of s, 0 <= s <= 1, by the definitions of the curves.
template <class R>
struct SweptNumber {
  R c[4] = {};

  SweptNumber(SweepCurve curve, const R (&p)[4]) {
    switch (curve) {
      case SweepCurve::linear:
        c[0] = p[0], c[1] = p[1] - p[0];
        break;
      case SweepCurve::cubic: {
        const R m = (p[2] - p[0]) / 2, n = (p[3] - p[1]) / 2, d = p[2] - p[1];
        c[0] = p[1], c[1] = m, c[2] = 3 * d - 2 * m - n, c[3] = m + n - 2 * d;
        break;
      }
      case SweepCurve::b_spline:
        // (1-s)^3, 3 s^3 - 6 s^2 + 4, -3 s^3 + 3 s^2 + 3 s + 1 and s^3, each over 6.
        c[0] = (p[0] + 4 * p[1] + p[2]) / 6, c[1] = (p[2] - p[0]) / 2;
        c[2] = (p[0] - 2 * p[1] + p[2]) / 2, c[3] = (p[3] - p[0] + 3 * (p[1] - p[2])) / 6;
        break;
    }
  }
  R at(R s) const { return ((c[3] * s + c[2]) * s + c[1]) * s + c[0]; }
  R slope(R s) const { return (3 * c[3] * s + 2 * c[2]) * s + c[1]; }
  R bend(R s) const { return 6 * c[3] * s + 2 * c[2]; }
};

template <class R>
struct SweptPiece {
  SweptNumber<R> x, y, z, r;

  static SweptPiece of(const SphereSweepShape& s, std::size_t first) {
    R p[4][4] = {};
    const std::size_t count = s.curve == SweepCurve::linear ? 2 : 4;
    for (std::size_t k = 0; k < count; ++k) {
      const SweptSphere& sphere = s.spheres[first + k];
      p[0][k] = sphere.center.x, p[1][k] = sphere.center.y, p[2][k] = sphere.center.z,
      p[3][k] = sphere.radius;
    }
    return {{s.curve, p[0]}, {s.curve, p[1]}, {s.curve, p[2]}, {s.curve, p[3]}};
  }
  /// The distance from the sphere at s, negative inside.
  R away(const Vec3<R>& q, R s) const {
    const R dx = x.at(s) - q.x, dy = y.at(s) - q.y, dz = z.at(s) - q.z;
    return std::sqrt(dx * dx + dy * dy + dz * dz) - std::abs(r.at(s));
  }
  /// How fast that changes with s where the radius is positive.
  R away_slope(const Vec3<R>& q, R s) const {
    const R dx = x.at(s) - q.x, dy = y.at(s) - q.y, dz = z.at(s) - q.z;
    return (dx * x.slope(s) + dy * y.slope(s) + dz * z.slope(s)) / std::sqrt(dx * dx + dy * dy + dz * dz) -
           r.slope(s);
  }
  /// A step of Newton's method towards where the squared distance less the squared radius turns.
  R turned(const Vec3<R>& q, R s) const {
    R slope = 0, bend = 0;
    const auto add = [&](const SweptNumber<R>& f, R from, R sign) {
      slope += sign * (f.at(s) - from) * f.slope(s);
      bend += sign * (f.slope(s) * f.slope(s) + (f.at(s) - from) * f.bend(s));
    };
    add(x, q.x, 1), add(y, q.y, 1), add(z, q.z, 1), add(r, 0, -1);
    const R next = s - slope / bend;
    return bend > 0 && next >= 0 && next <= 1 ? next : s;
  }
  /// The least distance between a and b by the golden section.
  R least_between(const Vec3<R>& q, R a, R b, int steps) const {
    const R g = (std::sqrt(R(5)) - 1) / 2;
    R c = b - g * (b - a), d = a + g * (b - a), at_c = away(q, c), at_d = away(q, d);
    for (int i = 0; i < steps; ++i) {
      if (at_c < at_d)
        b = d, d = c, at_d = at_c, c = b - g * (b - a), at_c = away(q, c);
      else
        a = c, c = d, at_c = at_d, d = a + g * (b - a), at_d = away(q, d);
    }
    return (a + b) / 2;
  }
};

struct Sweep {
  std::vector<SweptPiece<double>> rough;
  std::vector<SweptPiece<Real>> exact;
  std::vector<double> speed;        ///< no distance changes faster with s
  std::vector<double> bend;         ///< its slope falls no faster; infinite if a radius is not positive
  std::vector<SweptSphere> around;  ///< a ball about the whole piece

  void add(const SphereSweepShape& s, std::size_t first) {
    const auto piece = SweptPiece<double>::of(s, first);
    rough.push_back(piece), exact.push_back(SweptPiece<Real>::of(s, first));
    constexpr int kParts = 64;
    SweptSphere ball{{piece.x.at(0.5), piece.y.at(0.5), piece.z.at(0.5)}, 0};
    double fastest = 0, widening = 0, thinnest = HUGE_VAL;
    for (int k = 0; k <= kParts; ++k) {
      const double v = double(k) / kParts, x = piece.x.slope(v), y = piece.y.slope(v), z = piece.z.slope(v);
      fastest = std::max(fastest, std::sqrt(x * x + y * y + z * z) + std::abs(piece.r.slope(v)));
      widening = std::max(widening, std::abs(piece.r.slope(v)));
      thinnest = std::min(thinnest, piece.r.at(v));
      const Vec3d center{piece.x.at(v), piece.y.at(v), piece.z.at(v)};
      ball.radius = std::max(ball.radius, length(center - ball.center) + std::abs(piece.r.at(v)));
    }
    speed.push_back(1.1 * fastest + 1e-9);
    ball.radius += speed.back() / kParts;
    around.push_back(ball);
    const auto bend_at = [&](double v) {
      return length(Vec3d{piece.x.bend(v), piece.y.bend(v), piece.z.bend(v)}) + std::abs(piece.r.bend(v));
    };
    bend.push_back(thinnest > widening / kParts ? std::max(bend_at(0), bend_at(1)) : HUGE_VAL);
  }

  /// Whether the distance is surely above `room` or surely below -`room`.
  bool is_far_from_surface(const Vec3d& q, double room) const {
    bool outside = true;
    for (std::size_t k = 0; k < rough.size(); ++k)
      if (length(q - around[k].center) - around[k].radius <= room &&
          is_inside(k, q, room, 0.5, 0.5, 8, outside))
        return true;
    return outside;
  }
  /// Whether it is surely below -`room`, by the part of piece k up to `half` before and after `s`, which is
  /// halved up to so many times. If not, and if it is not surely above `room` there, `outside` becomes false.
  bool is_inside(std::size_t k, const Vec3d& q, double room, double s, double half, int times,
                 bool& outside) const {
    const double away = rough[k].away(q, s);
    if (away < -room) return true;
    const double slope = std::abs(rough[k].away_slope(q, s));
    const double least = away - std::min(speed[k], slope + bend[k] * half / 2) * half;
    if (least > room) return false;
    if (away <= room || times == 0) outside = false;
    if (times == 0 || (!outside && least >= -room)) return false;
    return is_inside(k, q, room, s - half / 2, half / 2, times - 1, outside) ||
           is_inside(k, q, room, s + half / 2, half / 2, times - 1, outside);
  }

  Real distance(const Vec3l& p) const {
    const Vec3<double> q{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    Real best = HUGE_VALL;
    for (std::size_t k = 0; k < rough.size(); ++k) {
      if (length(q - around[k].center) - around[k].radius > best) continue;
      constexpr int kSteps = 24;
      double d[kSteps + 1];
      double least = HUGE_VAL;
      for (int i = 0; i <= kSteps; ++i) least = std::min(least, d[i] = rough[k].away(q, i / double{kSteps}));
      if (least - speed[k] / (2 * kSteps) > best) continue;
      for (int i = 0; i <= kSteps; ++i) {
        best = std::min<Real>(best, d[i]);
        if ((i > 0 && d[i - 1] < d[i]) || (i < kSteps && d[i + 1] < d[i])) continue;
        const double a = std::max(i - 1, 0) / double{kSteps}, b = std::min(i + 1, kSteps) / double{kSteps};
        const double s = rough[k].least_between(q, a, b, 24);
        const double about = rough[k].away(q, s);
        best = std::min<Real>(best, about);
        // In `Real` where `double` might not tell the sign.
        if (std::abs(about) > 0x1p-20) continue;
        Real t = s;
        for (int step = 0; step < 4; ++step) t = exact[k].turned(p, t);
        for (const Real at : {t, static_cast<Real>(s), Real(0), Real(1)})
          best = std::min(best, exact[k].away(p, at));
      }
    }
    return best;
  }
};

template <SweepCurve kCurve>
ExactOracle sweep(CaseRandom& random) {
  SphereSweepShape s;
  s.curve = kCurve;
  const int count = (kCurve == SweepCurve::linear ? 2 : 4) + static_cast<int>(random.unit() * 5);
  const bool thin = random.unit() < 0.3, even = random.unit() < 0.3, coarse = random.unit() < 0.3;
  const double radius = thin ? random.magnitude(-2, -1) : 0.1 + 0.3 * random.unit();
  Vec3d at = random.vector() * 0.5;
  for (int i = 0; i < count; ++i) {
    if (coarse)
      for (int k = 0; k < 3; ++k) at[k] = std::round(at[k] * 2) / 2;
    s.spheres.push_back({at, even ? radius : radius * (0.2 + 1.6 * random.unit())});
    // Now and then one inside of the last, or in the same place.
    if (random.unit() < 0.9) at += random.vector() * (random.unit() < 0.2 ? 0.1 : 0.7);
  }
  if (kCurve == SweepCurve::linear && random.unit() < 0.1)
    s.spheres[random.bits() % s.spheres.size()].radius = 0;
  return oracle_of(s);
}

}  // namespace

ExactOracle oracle_of(const SphereSweepShape& s) {
  Sweep sweep;
  const std::size_t width = s.curve == SweepCurve::linear ? 2 : 4;
  ExactOracle o{{s}, {}};
  for (std::size_t i = 0; i + width <= s.spheres.size(); ++i) {
    sweep.add(s, i);
    const SweptPiece<double>& piece = sweep.rough.back();
    for (int k = 0; k <= 64; ++k) {
      const double v = k / 64.0;
      o.grow({piece.x.at(v), piece.y.at(v), piece.z.at(v)}, std::abs(piece.r.at(v)));
    }
  }
  // The distance changes no faster than the place.
  o.clear = [sweep](const Vec3d& a, const Vec3d& b) {
    return sweep.is_far_from_surface((a + b) * 0.5, 0.5 * length(b - a) + 1e-12);
  };
  o.f = [sweep](const Vec3l& p) { return sweep.distance(p); };
  return o;
}

std::vector<ExactCase> sweep_cases() {
  return {{"sphere_sweep", sweep<SweepCurve::linear>},
          {"sphere_sweep_cubic", sweep<SweepCurve::cubic>},
          {"sphere_sweep_b_spline", sweep<SweepCurve::b_spline>}};
}

}  // namespace oktett
