#pragma once
/// \file Judges of hits that a ray finds on its way through a structure.

#include "accel/hit_sink.h"

namespace oktett {

/// A hit, and the normal of the triangle where one was hit, if it is known.
struct HitWithNormal : Hit {
  Vec3f normal;  ///< see triangle_normal(), in the space of the structure that holds the triangle
  bool has_normal = false;

  HitWithNormal() = default;
  OKTETT_INLINE HitWithNormal(const Hit& hit) : Hit(hit) {}
  OKTETT_INLINE HitWithNormal(const Hit& hit, const Vec3f& n, bool known)
      : Hit(hit), normal(n), has_normal(known) {}
};

/// Says which hits of a ray count, while it is on its way: what does not count hides nothing.
class HitJudge {
 public:
  /// Not inline, so that the class's table of functions is compiled for the baseline only.
  virtual ~HitJudge();
  /// Hits of one place in the structure, none beyond end(), in no order. Returns true if one of them counts,
  /// the nearest that does; end() is its distance then, or less.
  virtual bool offer(HitWithNormal* hits, int count) = 0;
  /// Where the ray ends: at its nearest hit that counts, or at its own end.
  virtual float end() const = 0;
  /// A list that a traversal may fill, and then offers from.
  virtual HitList& scratch() = 0;
};

/// What counts without being judged.
struct NoJudge {};

}  // namespace oktett
