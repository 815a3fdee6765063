#pragma once
/// \file What describes a prism: outlines in a plane, and the way that they are swept.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// A point of the plane y = 0, or of y = 1 where a prism has a tip.
struct FlatPoint {
  double x, z;

  bool operator==(const FlatPoint&) const = default;
};

/// The points of one outline in order. What they mean depends on the kind of curve.
using PlaneOutline = std::vector<FlatPoint>;

/// Most outlines of a prism in a scene file, and most points of one.
inline constexpr std::uint32_t kMaxOutlines = 1 << 20;
inline constexpr std::uint32_t kMaxOutlinePoints = 1 << 20;

/// All points between two heights that a vertical line, or one through the tip, joins with a point inside of
/// the outlines: one from which a ray in the plane crosses them an odd number of times.
struct PrismShape {
  /// What goes through the points, after POV-Ray's splines of the same names.
  enum class Curve : std::uint8_t {
    linear,     ///< straight from point to point
    quadratic,  ///< between two points the parabola through both and the one before; the first is not met
    cubic,      ///< a Catmull-Rom curve; the first and the last point are not met
    bezier,     ///< cubic pieces of 3 n + 1 control points; pieces share their ends
  };
  enum class Sweep : std::uint8_t {
    linear,  ///< straight up
    conic,   ///< from the origin: at the height y the outlines are y times as large
  };
  /// Along which they are swept. The outlines' coordinates are the other two in the order of the alphabet.
  enum class Axis : std::uint8_t { x, y, z };
  std::vector<PlaneOutline> outlines;
  Axis axis = Axis::y;
  Curve curve = Curve::linear;
  Sweep sweep = Sweep::linear;
  double from = 0, to = 1;  ///< heights
  bool open = false;        ///< without the flat ends

  void describe(auto& p) {
    p.required(
        "outlines", outlines, whole(1, kMaxOutlines),
        "closed curves, by a straight line where the last point is not the first. What an odd number of "
        "them surrounds is inside");
    p.choice("axis", axis, {{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}},
             "along which they are swept; points are `[y, z]`, `[x, z]` or `[x, y]`");
    p.choice("curve", curve,
             {{"linear", Curve::linear},
              {"quadratic", Curve::quadratic},
              {"cubic", Curve::cubic},
              {"bezier", Curve::bezier}},
             "through the points: `quadratic` does not meet the first one, `cubic` neither the first nor the "
             "last; `bezier`: 3 n + 1 control points");
    p.choice(
        "sweep", sweep, {{"linear", Sweep::linear}, {"conic", Sweep::conic}},
        "`conic`: at the height h along the axis the outlines are h times as large, so that the tip is the "
        "origin");
    p.field("from", from, kCoordinate, "the height of the lower end");
    p.field("to", to, kCoordinate, "that of the upper end");
    p.field("open", open, "without the flat ends");
    p.normals();
    p.nothing_if(from == to, "both ends have the same height");
  }
  static void surfaces(auto& v);
};

/// Letters in a scene file: a prism along z whose outlines are those of a font.
struct TextKeys {
  double thickness = 1;
  Vec3d advance{0, 0, 0};

  void describe(auto& p) {
    p.required("font", ByHand{"file", "file"}, "a font that FreeType reads, such as TrueType or OpenType");
    p.required("text", ByHand{"text", "text"},
               "what is written, in UTF-8; a line begins at x = 0 and stands on y = 0");
    p.field("thickness", thickness, kLength, "along z from 0; the em of the font is 1");
    p.field("advance", advance, "what is added to the way from each letter to the next");
    p.normals();
    p.nothing_if(thickness == 0, "the thickness is zero");
  }
};

void PrismShape::surfaces(auto& v) {
  v.surface({"prism", "outlines in a plane, swept along an axis"}, PrismShape{});
  v.surface({"text", "letters of a font, as a prism along z"}, TextKeys{});
}

}  // namespace oktett
