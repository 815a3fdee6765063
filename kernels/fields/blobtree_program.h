#pragma once
/// \file From the description of a blob tree to the program and the elements that its pool holds.

#include "kernels/fields/blobtree.h"

namespace oktett::field {

/// The program: each list of a blend taken two at a time, from the left. Empty if the description is
/// malformed.
std::vector<std::uint32_t> program(const BlobTreeShape& shape);

/// What is within `reach` of a skeleton; of an ellipsoid, reach times its radii.
CellBox box_of(const Skeleton& skeleton, double reach);

/// An element in the own space, which is about `middle` and in units of `size`. Appends the corners of a
/// polygon to `corners`.
FieldPart make_part(const FieldElement& element, const Vec3d& middle, double size,
                    std::vector<double>& corners);

}  // namespace oktett::field
