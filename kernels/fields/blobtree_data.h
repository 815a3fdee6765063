#pragma once
/// \file What describes a blob tree: blends of the potentials around skeletons.

#include <cstdint>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/fields/metaballs_data.h"

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

/// A blend of `count` values of what stands before it (G. and B. Wyvill, A. Guy: Extending the CSG Tree,
/// 1999). The difference is of the first and all others: min(a, 2 iso - b), so that a point is inside of it
/// if it is inside of a and not of b.
struct Blend {
  enum class Op : std::uint8_t { element, sum, max, min, difference };
  Op op = Op::element;
  std::uint32_t element = 0;  ///< of Op::element
  std::uint32_t count = 0;    ///< of the others, >= 1
};

/// The last of `blends`, which are in postfix order, is `iso` on the surface and greater inside.
struct BlobTreeShape {
  double iso = 0.5;
  std::vector<FieldElement> elements;
  std::vector<Blend> blends;

  static constexpr ShapeInfo kShapeInfo{
      "blobtree",
      "where the blend of potentials, one of the four, exceeds `iso`; at most 32 levels of blends in "
      "blends"};
  void describe(auto& p) {
    constexpr ByHand kList{"list of [elements](#skeletons-and-potentials) and blends", "blends"};
    p.field("iso", iso, kIso, "the value on the surface");
    p.optional("sum", kList, "a blend: the sum of all");
    p.optional("max", kList, "a blend: the greatest of all");
    p.optional("min", kList, "a blend: the least of all");
    p.optional("difference", kList, "a blend: the first without all others");
    p.one_of({"sum", "max", "min", "difference"});
    p.normals();
  }
};
/// Most levels of blends inside blends.
inline constexpr int kMaxBlendLevels = 32;

}  // namespace oktett
