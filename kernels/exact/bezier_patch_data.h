#pragma once
/// \file What describes Bezier patches.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// The 16 control points of a bicubic patch: point 4 j + i has Bernstein's polynomial i of u and j of v as
/// its weight.
struct BezierPatchPoints {
  Vec3d p[16];
};

/// Most patches of an object in a scene file.
inline constexpr std::uint32_t kMaxBezierPatches = 1 << 20;

/// Bicubic Bezier patches. Edges may be points.
struct BezierPatchShape {
  std::vector<BezierPatchPoints> patches;
  /// Texture coordinates at (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) of each patch, and between them.
  double uv[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  bool open = true;  ///< else the patches surround a solid

  static constexpr ShapeInfo kShapeInfo{"bezier_patch", "bicubic Bezier patches"};
  void describe(auto& p) {
    p.required("patches", patches, whole(1, kMaxBezierPatches),
               "control points, four rows of four: u runs along a row, v from row to row");
    p.field("uv", uv, "texture coordinates at (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) of each patch");
    p.field("open", open,
            "`false`: the patches surround a solid, with no gaps between them; all have u and v turning the "
            "same way around, as seen from outside");
  }
};

}  // namespace oktett
