#pragma once
/// \file Follows a hit through instances and combinations to the structure that holds its item, and brings
/// its surface interaction back to the world. Also finds all places of geometries.

#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "accel/accel.h"
#include "accel/accel_data.h"

namespace oktett {

/// The structure that contains the item of a hit, and the way there.
struct HitPlace {
  const Accel* accel = nullptr;
  Affine to_world, inverse;  ///< of that structure's space; the identity unless `moved`
  bool moved = false;
  bool flipped = false;             ///< a Boolean combination turns the normal round
  const Accel* combined = nullptr;  ///< the solids of the outermost combination on the way, if there is one
  Affine to_combined;               ///< from the world to their space
  std::uint32_t user = kNoId;       ///< of the outermost instance that has one

  /// True if a surface found in the structure has to be moved to the world or widened.
  bool changes() const { return moved || combined != nullptr; }
};

/// Follows an instance path to the structure that contains the item.
HitPlace follow_path(const Accel& accel, std::uint32_t path);

/// Item of the outermost instance or combination on `path`.
std::uint32_t top_item(const Accel& accel, std::uint32_t path);

/// The outermost link of a chain of instances and combinations, and what follows it.
struct ChainLink {
  std::uint32_t geometry, primitive;  ///< the instance or combination: its geometry, and its place in a list
  bool is_combination;
  const Accel* child;  ///< what the instance shows, or the solids of the combination
  std::uint32_t rest;  ///< the number of the rest of the chain, inside `child`; kNoId if there is none
};
/// `chain` is the number of a chain of `accel`, as Hit::instance is; not kNoId.
ChainLink outermost_link(const Accel& accel, std::uint32_t chain);

/// The solid whose boundary a hit is on, where one chain of instances shows it: a primitive, or a whole mesh
/// or combination.
struct CrossedSolid {
  const Accel* accel;      ///< the structure that holds it
  std::uint32_t instance;  ///< the number of the chain of instances that leads there
  std::uint32_t item;      ///< the primitive, the first of a mesh, or the combination
  std::uint32_t geometry;  ///< in `accel`
};
CrossedSolid crossed_solid(const Accel& accel, const Hit& hit);

/// The image of a ray, computed in double.
Ray moved_ray(const Affine& m, const Ray& ray);
/// The ray in the space of the structure at `place`.
Ray ray_inside(const HitPlace& place, const Ray& ray);

/// The error bound of a position on a combination, where faces within `reach` along the ray count as
/// coincident: it must contain them all, so that rays that leave do. Rounded up.
OKTETT_INLINE float widened_error(float error, float reach, float direction) {
  return (error + reach * std::abs(direction)) * (1 + 0x1p-22f);
}

/// Which surface a hit met; the members are those of SurfaceInteraction.
struct HitNames {
  std::uint32_t geometry, primitive, user;
  std::uint32_t material_slot = 0;
  Kind kind;
};
inline HitNames identify_in(const HitPlace& place, const Hit& hit) {
  const Accel& a = *place.accel;
  HitNames names;
  names.geometry = a.geometry_of(hit.item);
  names.primitive = hit.item - a.first_item[names.geometry];
  names.user = place.user != kNoId ? place.user : a.users[names.geometry];
  names.kind = static_cast<Kind>(a.kinds[names.geometry]);
  if (names.kind == Kind::triangle) {
    const auto& slots = std::get<MeshGeometry>(a.geometries[names.geometry].shape).mesh->material_slots;
    if (!slots.empty()) names.material_slot = slots[names.primitive];
  }
  return names;
}

/// The surface interaction of a hit whose place is known. uv and tangents may be missing unless `uv`.
void interaction_at(const HitPlace& place, const HitNames& names, const Ray& ray, const Hit& hit, bool uv,
                    SurfaceInteraction& s);

/// The corners of the triangle at a hit, which is valid, in the space of `accel` and in the order of the
/// mesh; nothing if what was hit is no triangle.
std::optional<std::array<Vec3f, 3>> triangle_corners(const Accel& accel, const Hit& hit);

/// A triangle whose shading normals are interpolated: its corners in the order of the mesh, and the unit
/// normals there.
struct SmoothTriangle {
  Vec3d corner[3], normal[3];
};
/// The triangle at a hit, which is valid, in the space of `accel`; nothing if what was hit shows no
/// interpolated normals.
std::optional<SmoothTriangle> smooth_triangle(const Accel& accel, const Hit& hit);

// ---- Walks over everything that a structure shows, through all chains of instances.

/// A geometry where one chain of instances shows it. Primitive k of it is met by hits with this `instance`
/// and the item `first_item` + k.
struct PlacedGeometry {
  const Geometry* geometry;  ///< belongs to the structure
  Affine to_world;           ///< from the space of the geometry's shape to that of the structure asked
  std::uint32_t user;        ///< as in SurfaceInteraction
  std::uint32_t instance;    ///< as in Hit
  std::uint32_t first_item;  ///< as in Hit
};

/// Calls `visit` for the geometries of `accel` and of all its instances, once for each chain of instances
/// that shows them, in no particular order. Left out are instances themselves, combinations and the solids in
/// them, and geometries of singular transforms.
void visit_placed_geometries(const Accel& accel, const std::function<void(const PlacedGeometry&)>& visit);

}  // namespace oktett
