#pragma once
/// \file The search for the nearest point: what it knows of the point and of the nearest surface so far. The
/// tree is searched by code for each instruction set (accel/traverse/closest.h), shapes other than triangles
/// by code that exists once.

#include <cmath>
#include <limits>

#include "accel/accel_data.h"
#include "accel/point_query.h"
#include "core/platform.h"

namespace oktett {

/// The surface nearest to a point so far.
struct Nearest {
  double d2 = std::numeric_limits<double>::infinity();  ///< squared distance
  std::uint32_t item = kNoId, instance = kNoId;

  /// Takes what is nearer, or at equal distance of lower (instance, item).
  OKTETT_INLINE void keep(double d2_new, std::uint32_t item_new, std::uint32_t instance_new) {
    if (!(d2_new <= d2)) return;
    // Adding one puts "no instance" first.
    if (d2_new == d2 && (instance_new + 1 > instance + 1 || (instance_new == instance && item_new >= item)))
      return;
    d2 = d2_new, item = item_new, instance = instance_new;
  }
};

/// The point of a query, as one structure sees it.
struct PointPlace {
  Vec3d world;                     ///< in the space of the structure that is queried
  Affine to_world, to_here;        ///< between that space and this structure's; only if `moved`
  bool moved = false;              ///< the structure is shown by an instance
  Vec3f lo, hi;                    ///< a box that holds the point in this space
  double scale = 1;                ///< what is at a distance d in the world is at most d * scale away here
  double slack = 0;                ///< bounds the rounding errors of distances in the world
  std::uint32_t instance = kNoId;  ///< the number of the chain of instances

  /// The square of the distance in this space up to which surfaces may be nearer than `best`, or as near.
  /// Beyond it no surface is, however its distance is rounded.
  OKTETT_INLINE float limit(const Nearest& best) const {
    const double reach = (std::sqrt(best.d2) + slack) * scale, square = reach * reach * (1 + 0x1p-20);
    constexpr float greatest = std::numeric_limits<float>::max();
    return square < greatest ? static_cast<float>(square) : std::numeric_limits<float>::infinity();
  }
};

/// The place of a point, which is finite, in the structure that is queried.
PointPlace place_point(const Accel& accel, const Vec3f& point);
/// What is known of the nearest surface before it is looked for, given that of another point: no more than
/// the way to that point farther, by the triangle inequality.
Nearest nearest_by(const PointPlace& place, const Vec3d& other, const Nearest& of_other);
/// Its place in what an instance shows: `number` as in each_instance's leaves, see first_instance().
PointPlace place_in_instance(const PointPlace& outer, const Accel& accel, std::uint32_t number);

/// Keeps the nearest point of the shapes of a leaf, which holds neither triangles nor instances.
void closest_in_leaf(const Accel& accel, const LeafEntry& leaf, const PointPlace& place, Nearest& best);

/// The distance, infinite for a miss.
inline float distance_of(const Nearest& nearest) { return static_cast<float>(std::sqrt(nearest.d2)); }

/// The surface at the nearest point that was found.
ClosestPoint closest_surface(const Accel& accel, const Vec3f& point, const Nearest& nearest);

/// Sets Accel::no_closest_point.
void note_missing_closest(Accel& accel);

}  // namespace oktett
