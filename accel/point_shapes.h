#pragma once
/// \file Spheres, discs and round lines that may move, as shapes for scenes with time.

#include <memory>
#include <vector>

#include "accel/trace_scene.h"

namespace oktett {

/// A point with a radius. One that is not finite or whose radius is not positive has no surface; the end of a
/// round line may also have the radius 0.
struct RoundPoint {
  Vec3f center;
  float radius;
};

/// Points with a radius, all at each of one or more keys; see UserShape::key_count. Between keys centres and
/// radii are interpolated in float as vertices of a MovingMesh are, the rest is computed in double.
using RoundPointKeys = std::vector<std::vector<RoundPoint>>;

// Each throws Error if keys differ in size, there is none, or an index is out of range.

/// Spheres. A hit has u = v = 0 and the normal from the centre to the hit.
std::shared_ptr<const UserShape> make_moving_spheres(RoundPointKeys keys);

/// Discs that face every ray. A hit is where the ray is nearest to the centre, if that is not farther away
/// than the radius and the ray begins farther away; it has u = v = 0 and the normal against the direction of
/// the ray. So rays that begin on a disc do not meet it again.
std::shared_ptr<const UserShape> make_facing_discs(RoundPointKeys keys);

/// Discs with a normal at each key, of any length but zero, interpolated in float. A hit has u = v = 0.
std::shared_ptr<const UserShape> make_discs(RoundPointKeys keys, std::vector<std::vector<Vec3f>> normals);

/// Segments between points `first[i]` and `first[i]` + 1: each the convex hull of its two spheres, so
/// segments in a row have no gaps. A hit has u along the segment, from 0 to 1, v = 0, and a normal that
/// points outwards.
std::shared_ptr<const UserShape> make_round_lines(RoundPointKeys keys, std::vector<std::uint32_t> first);

}  // namespace oktett
