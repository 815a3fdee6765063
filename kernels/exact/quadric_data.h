#pragma once
/// \file What describes a quadric.

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0 (Zachmann 2010: x^2 + y^2 = 1,
/// x^2 + y^2 - z = 0, x^2 + y^2 - z^2 = 1).
struct QuadricShape {
  std::array<double, 10> coefficients{1, 1, 1, 0, 0, 0, 0, 0, 0, -1};  ///< A to J
  bool clipped = false;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi; nothing is outside of this box if `clipped`
  bool open = false;                  ///< without the faces of the box, which otherwise close the solid

  static void surfaces(auto& v);

  void describe(auto& p) {
    p.field("coefficients", coefficients, "of x², y², z², xy, xz, yz, x, y, z and 1");
    describe_clip(p);
  }

  void describe_clip(auto& p) {
    clipped |= p.optional("clip", ClipBox{lo, hi}, "a box that cuts it, and whose faces close it");
    p.field("open", open, "without the faces of the box");
    p.normals();
    const auto& c = coefficients;
    p.nothing_if(std::all_of(c.begin(), c.end() - 1, [](double x) { return x == 0; }),
                 "the equation does not depend on x, y or z");
    p.nothing_if(!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z), "the clip box has no volume");
  }
};

/// A quadric whose coefficients are given by its name.
struct FixedQuadric : QuadricShape {
  void describe(auto& p) { describe_clip(p); }
};

struct Hyperboloid : QuadricShape {
  void describe(auto& p) {
    std::uint32_t sheets = 1;
    p.field("sheets", sheets, whole(1, 2), "how many parts it has");
    coefficients = {1, 1, -1, 0, 0, 0, 0, 0, 0, sheets == 2 ? 1.0 : -1.0};
    describe_clip(p);
  }
};

void QuadricShape::surfaces(auto& v) {
  v.surface({"quadric", "where a polynomial of degree 2 is at most 0"}, QuadricShape{});
  v.surface({"infinite_cylinder", "x² + y² <= 1"}, FixedQuadric{{{1, 1, 0, 0, 0, 0, 0, 0, 0, -1}}});
  v.surface({"paraboloid", "x² + y² <= z"}, FixedQuadric{{{1, 1, 0, 0, 0, 0, 0, 0, -1, 0}}});
  v.surface({"hyperboloid", "x² + y² - z² <= 1, or -1 with two sheets"}, Hyperboloid{});
}

}  // namespace oktett
