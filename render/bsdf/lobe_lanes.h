#pragma once
/// \file What the lobes of all materials share: limits of their parameters, results and the choice of a lobe.
/// Lobes compute in lanes of doubles D. Single surfaces use them with one lane, so a surface gets the same
/// bits alone and in a group.

#include <algorithm>

#include "core/elementary.h"
#include "core/lanes.h"
#include "render/bsdf/optics.h"

namespace oktett {

/// Scattering from one direction.
struct BsdfValue {
  Color value;    ///< f |cos(wi)|, the sum of all lobes that are not delta
  float pdf = 0;  ///< density per solid angle of `sample` choosing wi by those lobes
};

/// A sampled direction.
struct BsdfSample {
  Vec3f direction;
  Color weight;              ///< value / pdf; for delta lobes their coefficient / probability
  float pdf = 0;             ///< as in BsdfValue; 0 for delta lobes
  bool delta = false;        ///< the direction is one of finitely many
  bool transmitted = false;  ///< the direction leads below the surface
};

/// `x` within [least, most]; `least` for NaN.
inline double limited(double x, double least, double most) { return x > least ? std::min(x, most) : least; }
inline Vec3d limited(const Color& c, double least, double most) {
  return {limited(c.x, least, most), limited(c.y, least, most), limited(c.z, least, most)};
}

/// BsdfValue in lanes.
template <class D>
struct BsdfValues {
  Vec3<FloatsOf<D>> value;
  FloatsOf<D> pdf;
};

/// BsdfSample in lanes. The members of lanes that are not `found` hold no defined value.
template <class D>
struct BsdfSamples {
  using M = typename FloatsOf<D>::M;
  Vec3<FloatsOf<D>> direction, weight;
  FloatsOf<D> pdf;  ///< 0: a delta lobe
  M found;
  M transmitted;
  /// The lanes, none of them `found`, whose directions lead above the shading normal's horizon, but behind
  /// the true surface. Set by ShadingFrame::to_world.
  M behind;
};

template <class D>
OKTETT_INLINE Vec3<D> above_horizon(const Vec3<D>& w) {
  return unit_lanes(Vec3<D>{w.x, w.y, max(D(1e-6), w.z)});
}
/// The direction to a viewer, of unit length in double and not below or along the surface.
template <class D>
OKTETT_INLINE Vec3<D> direction_above(const Vec3<FloatsOf<D>>& wo) {
  return above_horizon(to_double(wo));
}

/// A direction above the surface with density cos / pi, from a point of the unit square.
template <class D>
OKTETT_INLINE Vec3<D> cosine_above(const D& x, const D& y) {
  const D radius = sqrt(x);
  D sine, cosine;
  sin_cos_of_turn(y, sine, cosine);
  return {radius * cosine, radius * sine, sqrt(D(1.0) - x)};
}

/// Probabilities of N lobes.
template <class D, int N>
class LobeChances {
 public:
  LobeChances() {
    for (D& p : probability_) p = D(0.0);
  }
  D& operator[](int lobe) { return probability_[lobe]; }
  const D& operator[](int lobe) const { return probability_[lobe]; }

  /// Scales weights >= 0 to probabilities.
  OKTETT_INLINE void normalize() {
    D sum(0.0);
    for (const D& p : probability_) sum = sum + p;
    const auto some = sum > D(0.0);
    for (D& p : probability_) p = select(some, p / sum, D(0.0));
  }

  /// The number of the lobe at place `u` in [0, 1); `u` becomes the place within that lobe, [0, 1). -1 if
  /// there is none.
  OKTETT_INLINE D pick(D& u) const {
    const D zero(0.0);
    D chosen(-1.0), begin = zero, end = zero, size(1.0);
    auto done = zero < zero;
    for (int i = 0; i < N; ++i) {
      const D& p = probability_[i];
      const auto here = (p > zero) & ~done;
      chosen = select(here, D(i), chosen), size = select(here, p, size);
      begin = select(here, end, begin), end = select(here, end + p, end);
      done = done | (here & (u < end));
    }
    u = within((u - begin) / size, zero, D(1 - 0x1p-53));
    return chosen;
  }

 private:
  D probability_[N];
};

/// The frame about a shading normal, and what shading and geometric normal together allow.
template <class D>
class ShadingFrame {
 public:
  using F = FloatsOf<D>;
  using M = typename F::M;

  /// Both normals point to the side of the viewer.
  OKTETT_INLINE ShadingFrame(const Vec3<F>& ns, const Vec3<F>& ng) : z_(ns), ng_(ng) {
    basis_lanes(z_, x_, y_);
  }

  /// Turns x towards y by the angle of this cosine and sine.
  void turn(const Vec2f& angle) {
    const Vec3<F> x = x_;
    x_ = x_ * F(angle.x) + y_ * F(angle.y), y_ = y_ * F(angle.x) - x * F(angle.y);
  }

  OKTETT_INLINE Vec3<F> to_local(const Vec3<F>& v) const {
    return {dot_lanes(v, x_), dot_lanes(v, y_), dot_lanes(v, z_)};
  }

  /// The lanes in which both normals agree on which side the light is that comes from the unit vectors `l`,
  /// `local` in this frame. Light from behind counts only if the surface transmits it.
  OKTETT_INLINE M agrees(const Vec3<F>& l, const Vec3<F>& local, bool transmits) const {
    const F zero(0.0f), side = dot_lanes(ng_, l);
    const M agree = side * local.z > zero;
    return transmits ? agree : agree & ~(side < zero);
  }

  /// Brings sampled directions to world space. Those that lead to the wrong side of the true surface count as
  /// not found. But ideal mirrors and glass keep their light: their direction is folded back to its side.
  OKTETT_INLINE void to_world(BsdfSamples<D>& s) const {
    const F zero(0.0f);
    s.direction = unit_lanes(x_ * s.direction.x + y_ * s.direction.y + z_ * s.direction.z);
    const F side = dot_lanes(ng_, s.direction);
    const M agree = (s.transmitted & (side < zero)) | (~s.transmitted & (side > zero));
    const M delta = s.pdf == zero, folded = s.found & delta & ~agree;
    if (any(folded))
      s.direction = select_lanes(folded, unit_lanes(s.direction - ng_ * (F(2.0f) * side)), s.direction);
    s.behind = s.found & ~(agree | delta | s.transmitted) & (dot_lanes(z_, s.direction) > zero);
    s.found = s.found & (agree | delta);
  }

 private:
  Vec3<F> x_, y_, z_, ng_;
};

}  // namespace oktett
