#pragma once
/// \file What describes a blob tree: blends of the potentials around skeletons.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/fields/metaballs_data.h"

namespace oktett {

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
