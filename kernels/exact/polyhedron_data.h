#pragma once
/// \file What describes a convex polyhedron.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// All points p with normal . p <= offset; the normal need not have unit length.
struct HalfSpace {
  Vec3d normal;
  double offset;
};

/// Most half-spaces of a polyhedron: finding its vertices takes quadratic time.
inline constexpr std::uint32_t kMaxHalfSpaces = 1024;

/// What all of the half-spaces have in common; bounded, with an inside.
struct PolyhedronShape {
  std::vector<HalfSpace> planes;

  static constexpr ShapeInfo kShapeInfo{"polyhedron",
                                        "what is inside of all planes; they must bound it on all sides"};
  void describe(auto& p) {
    p.required("planes", planes, whole(0, kMaxHalfSpaces), "each n · p <= d; n need not be of unit length");
    p.normals();
  }
};

}  // namespace oktett
