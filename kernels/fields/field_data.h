#pragma once
/// \file What describes an element of metaballs or a blob tree: a skeleton and the potential around it.

#include <cstdint>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// How an influence falls with the distance r from a skeleton. All fall from their greatest value at r = 0,
/// and are convex in r^2.
enum class PotentialKind : std::uint8_t {
  inverse_square,  ///< (scale / r)^2
  gaussian,        ///< e^(-scale r^2)
  quadratic,       ///< 1 - 3 r^2 / scale^2 up to scale / 3, 3/2 (1 - r / scale)^2 up to scale, then 0
  rational,        ///< (q^4 - 2 q^2 + 1) / (1 + d q^2) with q = r / scale up to 1, then 0
  wyvill,          ///< (1 - r^2 / scale^2)^2 up to scale, then 0
};

struct Potential {
  PotentialKind kind = PotentialKind::wyvill;
  double scale = 1;   ///< > 0
  double d = 1;       ///< >= 0; of `rational`
  double weight = 1;  ///< of either sign
};

struct PointSkeleton {
  Vec3d center{0, 0, 0};

  void describe(auto& p) { p.field("center", center, kCoordinate, "the point"); }
};
struct SegmentSkeleton {
  Vec3d from{0, -1, 0}, to{0, 1, 0};

  void describe(auto& p) {
    p.field("from", from, kCoordinate, "one end");
    p.field("to", to, kCoordinate, "the other end");
  }
};
/// Plane and simple; at least three vertices.
struct PolygonSkeleton {
  std::vector<Vec3d> vertices;
};
/// Distances from it are those from its centre with each axis measured in its radius, so that surfaces of
/// equal potential are ellipsoids.
struct EllipsoidSkeleton {
  Vec3d center{0, 0, 0}, radii{1, 1, 1};
  Vec3d rotation{0, 0, 0};  ///< degrees about x, then y, then z

  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the centre");
    p.field("radii", radii, kPositiveLength, "along the axes");
    p.field("rotate", rotation, kAngle, "about the x, then the y, then the z axis");
  }
};
using Skeleton = std::variant<PointSkeleton, SegmentSkeleton, PolygonSkeleton, EllipsoidSkeleton>;

struct FieldElement {
  Skeleton skeleton;
  Potential potential;
};

}  // namespace oktett
