#pragma once
/// \file Where a ray that crosses meshes is inside of them. One rule serves inside(), combinations, and so
/// `solid: winding` of scene files. Where triangles pair up along every edge in opposite directions, a point
/// is inside if the mesh winds around it, in either sense. Where they only come in even numbers, wound as
/// they may be, it is inside after an odd number of crossings. All other meshes are open: a ray is inside
/// after as many triangles met from the front as let it begin outside or leave last, whichever is more.

#include <span>
#include <vector>

#include "accel/accel_data.h"
#include "accel/hit_sink.h"
#include "core/vec3.h"

namespace oktett {

/// The sense of a mesh: `closed`, `even`, or `open`, and `inverted` if an open one has a negative volume. The
/// first call for a structure finds those of all its meshes; they are kept.
MeshSense mesh_sense(const Accel& accel, std::uint32_t geometry);

/// A number for a place, for edges that are told apart by their ends; both zeros are one. Two places share
/// one once in 2^64.
std::uint64_t place_number(const Vec3f& p);
/// A number for an edge from place `a` to place `b`, its negative for one from b to a: where edges pair up in
/// opposite directions the sum is zero.
std::uint64_t edge_number(std::uint64_t a, std::uint64_t b);

/// Whether a ray begins inside of a mesh, given all its crossings with that mesh in their order.
bool begins_inside(MeshSense sense, std::span<const Crossing> crossings);

/// For each crossing of one ray, all to infinity, its turn as a crossing of a solid: those of closed and even
/// meshes become -1 where the ray comes to be inside, 1 where it leaves, 0 where it stays inside; those of
/// meshes of negative volume that are open are turned round; all others are as they are. Valid until the
/// thread's next call.
std::span<const float> solid_turns(const Accel& accel, std::span<const Crossing> crossings);

}  // namespace oktett
