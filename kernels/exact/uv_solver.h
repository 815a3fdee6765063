#pragma once
/// \file Where a ray meets a surface that is given by two parameters: the zeros of two functions g of (u, v)
/// over a rectangle, the distances of the surface from two planes through the ray.
///
/// A part of the rectangle is dropped if bounds of g, or Krawczyk's operator, prove that there is no zero in
/// it (R. Krawczyk: Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken, 1969; D. L. Toth:
/// On Ray Tracing Parametric Surfaces, 1985). Where the operator contracts there is at most one, which
/// Newton's method finds. Any other part is halved. All bounds have room for rounding, so a zero at the
/// border of two parts, or of two surfaces that share an edge, is found in one of them at least.
///
/// `Sheet` says what g is:
/// - `Node`: a part and what is known of it, with its UvBox `box`;
/// - `bounds(node, g)`: what each function lies between;
/// - `slopes(node, m, error, j)`: the functions in the middle with the error of that, and what their
///   derivatives lie between, for a step from the middle of the part to its border;
/// - `split(node, axis, low, high)`: the halves along u (0) or v (1);
/// - `at(u, v)`: a UvFrame, in plain arithmetic;
/// - `error`: bounds the rounding of g.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/vec3.h"

namespace oktett {

/// A rectangle of parameters.
struct UvBox {
  double u0, u1, v0, v1;
};

/// What a value lies between.
struct UvBounds {
  double lo, hi;

  double middle() const { return lo + (hi - lo) * 0.5; }
  double radius() const { return (hi - lo) * 0.5; }
  double most() const { return std::max(std::abs(lo), std::abs(hi)); }
  bool is_finite() const { return std::isfinite(lo) && std::isfinite(hi); }
};

/// A point of the surface and its derivatives as seen along the ray: x and y are the functions g, z is the
/// way along the ray.
struct UvFrame {
  Vec3d p, by_u, by_v;
};

/// A zero, and whether the surface is left there along its normal (1) or entered against it (-1).
struct UvRoot {
  double u, v, turn;
};

/// Steps after which a ray is given up.
inline constexpr int kMaxUvSteps = 1 << 14;

/// A search for all zeros in one node. Calls found(UvRoot) for each; one at the border of two halves may be
/// found twice.
template <class Sheet, class Found>
class UvSearch {
 public:
  UvSearch(const Sheet& sheet, Found found) : sheet_(sheet), found_(std::move(found)) {}

  /// Returns false if it was given up.
  bool run(const typename Sheet::Node& whole) {
    // Halves wait here, one of each size.
    constexpr int kDepth = 112;
    typename Sheet::Node waiting[kDepth];
    waiting[0] = whole, whole_ = whole.box;
    int count = 1;
    for (int step = 0; count > 0; ++step) {
      if (step == kMaxUvSteps) return false;
      const typename Sheet::Node node = waiting[--count];
      const int axis = examine(node);
      if (axis < 0) continue;
      if (count + 2 > kDepth) {
        end_in(node);
        continue;
      }
      sheet_.split(node, axis, waiting[count], waiting[count + 1]);
      count += 2;
    }
    return true;
  }

 private:
  /// Rows of numbers for the two functions.
  struct Operator {
    double y[2][2];       ///< the inverse of the derivatives in the middle
    double shrink[2][2];  ///< bounds what the operator makes of the half sizes of the part
    double error[2];      ///< bounds its rounding
    double sum(int i) const { return shrink[i][0] + shrink[i][1]; }
  };

  /// Finds or excludes a zero; else returns the axis to halve, or -1.
  int examine(const typename Sheet::Node& node) {
    UvBounds g[2], j[2][2];
    sheet_.bounds(node, g);
    for (const UvBounds& b : g)
      if (b.lo > sheet_.error || b.hi < -sheet_.error) return -1;
    double m[2], error = 0;
    sheet_.slopes(node, m, error, j);
    error += sheet_.error;
    for (int i = 0; i < 2; ++i)
      if (std::abs(m[i]) > (j[i][0].most() + j[i][1].most()) * (1 + 0x1p-40) + error) return -1;
    Operator k;
    if (make_operator(j, error, k)) {
      double step[2];
      bool contracts = true;
      for (int i = 0; i < 2; ++i) {
        step[i] = -(k.y[i][0] * m[0] + k.y[i][1] * m[1]);
        const double reach = k.sum(i) + k.error[i];
        if (std::abs(step[i]) > 1 + reach) return -1;
        contracts &= k.sum(i) <= 0.3 && k.error[i] < 0.5;
      }
      if (contracts) {
        find_one(node.box, k, step);
        return -1;
      }
    }
    return where_to_halve(node, g, j, error);
  }

  static bool make_operator(const UvBounds (&j)[2][2], double error, Operator& k) {
    double c[2][2], r[2][2];
    for (int i = 0; i < 2; ++i)
      for (int a = 0; a < 2; ++a) {
        if (!j[i][a].is_finite()) return false;
        c[i][a] = j[i][a].middle(), r[i][a] = j[i][a].radius() * (1 + 0x1p-40) + 16 * error;
      }
    const double det = c[0][0] * c[1][1] - c[0][1] * c[1][0];
    const double per = 1 / det;
    if (!std::isfinite(per)) return false;
    k.y[0][0] = c[1][1] * per, k.y[0][1] = -c[0][1] * per;
    k.y[1][0] = -c[1][0] * per, k.y[1][1] = c[0][0] * per;
    for (int i = 0; i < 2; ++i) {
      const double a = std::abs(k.y[i][0]), b = std::abs(k.y[i][1]);
      for (int axis = 0; axis < 2; ++axis) k.shrink[i][axis] = a * r[0][axis] + b * r[1][axis];
      k.error[i] = (a + b) * error;
      if (!std::isfinite(k.sum(i))) return false;
    }
    return true;
  }

  /// The axis along which the part is larger as seen along the ray, or -1 where rounding ends the search.
  int where_to_halve(const typename Sheet::Node& node, const UvBounds (&g)[2], const UvBounds (&j)[2][2],
                     double error) {
    const UvBox& box = node.box;
    const double along_u = j[0][0].most() + j[1][0].most(), along_v = j[0][1].most() + j[1][1].most();
    const double mu = box.u0 + (box.u1 - box.u0) * 0.5, mv = box.v0 + (box.v1 - box.v0) * 0.5;
    const bool by_u = box.u0 < mu && mu < box.u1, by_v = box.v0 < mv && mv < box.v1;
    const bool tiny = std::max(g[0].hi - g[0].lo, g[1].hi - g[1].lo) <= 8 * error;
    if (tiny || (!by_u && !by_v)) {
      end_in(node);
      return -1;
    }
    if (std::isfinite(along_u) && std::isfinite(along_v)) {
      if (is_edge_on(j, error, along_u + along_v)) return -1;
      return by_u && (along_u >= along_v || !by_v) ? 0 : 1;
    }
    // Nothing is known of the slopes. What is torn or not defined is left out in the end.
    const double wide = box.u1 - box.u0, high = box.v1 - box.v0;
    constexpr double kLeast = 0x1p-16, kTorn = 0x1p-12;
    if (wide < (whole_.u1 - whole_.u0) * kLeast && high < (whole_.v1 - whole_.v0) * kLeast &&
        !(std::max(g[0].hi - g[0].lo, g[1].hi - g[1].lo) < kTorn))
      return -1;
    return by_u && (wide >= high || !by_v) ? 0 : 1;
  }

  /// Whether the part, if it is no mere tip, is seen as a line, as far as rounding lets one tell. Rays in a
  /// surface do not cross it.
  static bool is_edge_on(const UvBounds (&j)[2][2], double error, double size) {
    const auto product = [](const UvBounds& a, const UvBounds& b) {
      const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
      return UvBounds{std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s))};
    };
    const UvBounds a = product(j[0][0], j[1][1]), b = product(j[0][1], j[1][0]);
    return size > 0x1p-24 && std::max(a.hi - b.lo, b.hi - a.lo) <= 4 * error * size;
  }

  /// The only zero that there may be in `box`, from the operator's first step on.
  void find_one(const UvBox& box, const Operator& k, const double (&step)[2]) {
    const double hu = (box.u1 - box.u0) * 0.5, hv = (box.v1 - box.v0) * 0.5;
    const double mu = box.u0 + hu, mv = box.v0 + hv;
    double x = std::clamp(step[0], -1.0, 1.0), y = std::clamp(step[1], -1.0, 1.0);
    const double room[2] = {1 + 2 * k.error[0] + 0x1p-40, 1 + 2 * k.error[1] + 0x1p-40};
    const double noise = std::max(k.error[0], k.error[1]);
    double before = HUGE_VAL;
    for (int i = 0; i < 12; ++i) {
      const UvFrame f = sheet_.at(mu + x * hu, mv + y * hv);
      const double det = f.by_u.x * f.by_v.y - f.by_v.x * f.by_u.y;
      const double du = (f.by_v.x * f.p.y - f.by_v.y * f.p.x) / det,
                   dv = (f.by_u.y * f.p.x - f.by_u.x * f.p.y) / det;
      if (!std::isfinite(du) || !std::isfinite(dv)) break;
      x += du / hu, y += dv / hv;
      const double moved = std::max(std::abs(du / hu), std::abs(dv / hv));
      // At the end steps are mere rounding.
      if (moved <= std::max(0x1p-44, noise * 0.25) || (moved >= before && moved <= noise * 4)) {
        if (std::abs(x) <= room[0] && std::abs(y) <= room[1]) {
          found_(UvRoot{mu + x * hu, mv + y * hv, det < 0 ? -1.0 : 1.0});
          return;
        }
        break;
      }
      before = moved;
      x = std::clamp(x, -2.0, 2.0), y = std::clamp(y, -2.0, 2.0);
    }
    find_surely(box, k);
  }

  /// The same by the operator alone, on ever smaller parts.
  void find_surely(const UvBox& box, const Operator& k) {
    const double half[2] = {(box.u1 - box.u0) * 0.5, (box.v1 - box.v0) * 0.5};
    const double middle[2] = {box.u0 + half[0], box.v0 + half[1]};
    double c[2] = {0, 0}, r[2] = {1, 1};
    for (int i = 0; i < 96; ++i) {
      const UvFrame f = sheet_.at(middle[0] + c[0] * half[0], middle[1] + c[1] * half[1]);
      bool rests = true;
      double lo[2], hi[2];
      for (int a = 0; a < 2; ++a) {
        const double to = c[a] - (k.y[a][0] * f.p.x + k.y[a][1] * f.p.y);
        const double reach = k.shrink[a][0] * r[0] + k.shrink[a][1] * r[1] + k.error[a] + 0x1p-50;
        lo[a] = std::max(c[a] - r[a], to - reach), hi[a] = std::min(c[a] + r[a], to + reach);
        if (!(lo[a] <= hi[a])) return;
        rests &= hi[a] - lo[a] > 1.9 * r[a] || hi[a] - lo[a] < 0x1p-44;
      }
      for (int a = 0; a < 2; ++a) c[a] = (lo[a] + hi[a]) * 0.5, r[a] = (hi[a] - lo[a]) * 0.5;
      if (rests) break;
    }
    const double u = middle[0] + c[0] * half[0], v = middle[1] + c[1] * half[1];
    const UvFrame f = sheet_.at(u, v);
    const double det = f.by_u.x * f.by_v.y - f.by_v.x * f.by_u.y;
    found_(UvRoot{u, v, det < 0 ? -1.0 : 1.0});
  }

  /// A part within rounding of the ray on which nothing is proved: the tip of an edge that has collapsed, a
  /// kink, or where the ray touches the surface. It is a crossing if the surface faces one way all over and
  /// is not seen edge-on.
  void end_in(const typename Sheet::Node& node) {
    const UvBox& box = node.box;
    double facing = 0, size = 0;
    for (int i = 0; i < 5; ++i) {
      const double u = i == 4 ? box.u0 + (box.u1 - box.u0) * 0.5 : i % 2 == 0 ? box.u0 : box.u1;
      const double v = i == 4 ? box.v0 + (box.v1 - box.v0) * 0.5 : i / 2 == 0 ? box.v0 : box.v1;
      const UvFrame f = sheet_.at(u, v);
      const Vec3d n = cross(f.by_u, f.by_v);
      if (!(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z))) continue;
      if (facing * n.z < 0) return;
      facing += n.z, size += length(n);
    }
    if (std::abs(facing) > 0x1p-16 * size)
      found_(UvRoot{box.u0 + (box.u1 - box.u0) * 0.5, box.v0 + (box.v1 - box.v0) * 0.5,
                    facing < 0 ? -1.0 : 1.0});
  }

  const Sheet& sheet_;
  Found found_;
  UvBox whole_{};
};

}  // namespace oktett
