#pragma once
/// \file Where rays leave smooth triangles towards the far side of the triangle's plane.
///
/// Interpolated normals show a curved surface, whose horizon is not that of the flat triangle. Light above
/// the curved surface's horizon and below the triangle's would be lost, which shows as black teeth where the
/// light ends. Such rays start from a point raised to about where the curved surface lies (Hanika 2021).
/// Departs from the paper: only these rays do, and the raised point lies at most halfway to the nearest
/// surface above.

#include <cstddef>
#include <cstdint>

#include "accel/accel.h"
#include "accel/interaction_block.h"
#include "core/isa.h"
#include "core/ray.h"
#include "core/vec3.h"

namespace oktett {

/// The raised points of the hits of a block, each found when it is first asked for.
class RaisedPoints {
 public:
  /// `found` are the surfaces at the hits of rays which[0], which[1], ... of `rays`, whose directions are
  /// unit vectors. All must outlive this.
  RaisedPoints(const Accel& accel, const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which,
               const InteractionBlock& found, Isa isa);

  /// The raised point of hit `k`; null if the hit is not on a smooth triangle, or if the curved surface does
  /// not lie above it.
  const Vec3f* point(std::size_t k);

  /// Whether a ray from the raised point, which hit `k` must have, may go along `direction`: it leads above
  /// the curved surface. Textures of normals do not count.
  bool leads_above(std::size_t k, const Vec3f& direction) const;

  /// Both in one: where a ray starts that leaves hit `k` along `direction`, which leads behind the plane of
  /// the triangle; null if there is no such ray.
  const Vec3f* origin(std::size_t k, const Vec3f& direction);

 private:
  enum class State : std::uint8_t { unknown, none, raised };

  State find(std::size_t k);

  const Accel& accel_;
  const RaySpan rays_;
  const HitSpan hits_;
  const std::uint32_t* which_;
  const InteractionBlock& found_;
  Isa isa_;
  State state_[InteractionBlock::kMost] = {};
  Vec3f point_[InteractionBlock::kMost];
  Vec3f normal_[InteractionBlock::kMost];  ///< interpolated, turned towards the origin of the hit's ray
};

}  // namespace oktett
