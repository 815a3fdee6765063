#pragma once
/// \file Ray against axis-aligned box by slabs, robust: a box is rejected only if no point of the ray, moved
/// by the rounding errors of the shapes inside, can lie in it.
///
/// After Kay and Kajiya 1986 with the error bound of Ize, "Robust BVH Ray Traversal" (JCGT 2(2), 2013). A
/// direction component of zero gives an infinite reciprocal; then a plane through the origin gives 0 * inf =
/// NaN, which the minimum and maximum ignore, so rays inside a face plane are kept and no threshold is
/// needed.

#include "core/lanes.h"

namespace oktett {

/// (plane - origin) * (1/d) carries three roundings on either side, and a hit's own t one more: 2^-21 covers
/// seven of 2^-24.
inline constexpr float kSlabRelativeSlack = 1.0f + 0x1p-21f + 0x1p-22f;

/// Times the distance in t to the far end of the scene, added to the far distance: what the double-precision
/// shear of the triangle test may displace.
inline constexpr float kSlabAbsoluteSlack = 0x1p-48f;
/// Added to the far distance for products that underflow.
inline constexpr float kSlabUnderflow = 1e-37f;

/// Distances to the near and far side of boxes given as planes[6], clipped to [tmin, tmax]; the box is met
/// where near <= far.
template <class F>
OKTETT_INLINE void slab_interval(const Vec3<F>& o, const Vec3<F>& inv, const F (&near_planes)[3],
                                 const F (&far_planes)[3], const F& tmin, const F& tmax, const F& slack,
                                 F& near, F& far) {
  const F nx = (near_planes[0] - o.x) * inv.x, ny = (near_planes[1] - o.y) * inv.y,
          nz = (near_planes[2] - o.z) * inv.z;
  const F fx = (far_planes[0] - o.x) * inv.x, fy = (far_planes[1] - o.y) * inv.y,
          fz = (far_planes[2] - o.z) * inv.z;
  near = max(nz, max(ny, max(nx, tmin)));
  far = fast_fma(min(fz, min(fy, min(fx, tmax))), F(kSlabRelativeSlack), slack);
}

}  // namespace oktett
