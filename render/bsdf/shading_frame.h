#pragma once
/// \file The frame about a shading normal, and what shading and geometric normal together allow, in lanes of
/// doubles D.

#include "render/bsdf/lobe_lanes.h"

namespace oktett {

template <class D>
class ShadingFrame {
 public:
  using F = FloatsOf<D>;
  using M = typename F::M;

  /// Both normals point to the side of the viewer.
  OKTETT_INLINE ShadingFrame(const Vec3<F>& ns, const Vec3<F>& ng) : z_(ns), ng_(ng) {
    basis_lanes(z_, x_, y_);
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
    s.found = s.found & (agree | delta);
  }

 private:
  Vec3<F> x_, y_, z_, ng_;
};

}  // namespace oktett
