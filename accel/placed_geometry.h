#pragma once
/// \file Walks over everything that a structure shows, through all chains of instances.

#include <functional>

#include "accel/accel.h"

namespace oktett {

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
