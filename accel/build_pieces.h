#pragma once
/// \file Large triangles as several references, before the tree is built.

#include "accel/build_tree.h"

namespace oktett {

/// Cuts the boxes of large triangles along planes of a scene-wide grid into pieces with tighter boxes (Karras
/// and Aila 2013, section 4.2): a triangle then stands in several leaves, whose boxes together cover it. At
/// most half as many references are added, where a box has much more surface than its triangle in comparison
/// to others. Only triangles with the watertight test are cut. Returns whether any was.
bool split_large(Column<PrimRef>& refs, const TriangleSource& triangles, const Box& bounds, bool parallel);

}  // namespace oktett
