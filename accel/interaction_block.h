#pragma once
/// \file The surface interactions of many hits, in columns.

#include <cstddef>
#include <cstdint>

#include "core/surface_interaction.h"

namespace oktett {

/// Up to 64 surface interactions. The columns are the members of SurfaceInteraction; there is none for
/// tangents. Component k of a vector stands in row k.
struct InteractionBlock {
  static constexpr std::size_t kMost = 64;

  float position[3][kMost], position_error[3][kMost];
  float geometric_normal[3][kMost], shading_normal[3][kMost];
  float uv[2][kMost];  ///< only if `has_uv`
  bool has_uv = false;
  std::uint32_t geometry[kMost], primitive[kMost], user[kMost], material_slot[kMost];

  /// Entry i. Tangents are zero, and so is uv unless `has_uv`.
  SurfaceInteraction operator[](std::size_t i) const {
    SurfaceInteraction s;
    s.position = get(position, i), s.position_error = get(position_error, i);
    s.geometric_normal = get(geometric_normal, i), s.shading_normal = get(shading_normal, i);
    if (has_uv) s.uv = {uv[0][i], uv[1][i]};
    s.geometry = geometry[i], s.primitive = primitive[i];
    s.user = user[i], s.material_slot = material_slot[i];
    return s;
  }
  /// Sets position, its error and the normals of entry i.
  void set_shape(std::size_t i, const SurfaceInteraction& s) {
    put(position, i, s.position), put(position_error, i, s.position_error);
    put(geometric_normal, i, s.geometric_normal), put(shading_normal, i, s.shading_normal);
  }

  void set_uv(std::size_t i, const Vec2f& place) { uv[0][i] = place.x, uv[1][i] = place.y; }

  /// Entry i of three columns.
  template <class T>
  static Vec3<T> get(const T (&column)[3][kMost], std::size_t i) {
    return {column[0][i], column[1][i], column[2][i]};
  }
  /// Sets entry i of three columns.
  template <class T>
  static void put(T (&column)[3][kMost], std::size_t i, const Vec3<T>& v) {
    column[0][i] = v.x, column[1][i] = v.y, column[2][i] = v.z;
  }
};

}  // namespace oktett
