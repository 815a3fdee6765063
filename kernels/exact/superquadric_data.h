#pragma once
/// \file What describes a superquadric.

#include <cstdint>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// Superquadrics (Zachmann 2010). With `ratio` the powers |x|^p are replaced by Blanc and Schlick's
/// pseudo-powers g_p(x) = |x| / (p + (1 - p) |x|); nothing is inside beyond their poles, |x| >= p / (p - 1)
/// for p > 1.
struct SuperquadricShape {
  enum class Form : std::uint8_t {
    ellipsoid,    ///< |x/a|^p + |y/b|^q + |z/c|^r = 1
    hyperboloid,  ///< |x/a|^p + |y/b|^q - |z/c|^r = 1, cut by a box
    toroid,       ///< |d - (|x/a|^m + |y/b|^n)^q|^r + |z/c|^p = e^2
  };
  Form form = Form::ellipsoid;
  bool ratio = false;
  Vec3d radii{1, 1, 1};  ///< a, b, c > 0
  double p = 2, q = 2, r = 2;
  double m = 2, n = 2, d = 1, e = 0.5;  ///< of the toroid
  Vec3d lo{-2, -2, -2}, hi{2, 2, 2};    ///< the box of the hyperboloid, lo < hi
  bool open = false;                    ///< without the faces of the box

  static void surfaces(auto& v) {
    const auto of = [](Form kind, bool pseudo) {
      SuperquadricShape s;
      s.form = kind, s.ratio = pseudo, s.q = kind == Form::toroid ? 0.5 : 2;
      return s;
    };
    v.surface({"superellipsoid", "\\|x/a\\|^p + \\|y/b\\|^q + \\|z/c\\|^r <= 1"}, of(Form::ellipsoid, false));
    v.surface(
        {"ratioellipsoid", "the same with [pseudo-powers](surfaces.md#superquadrics-and-ratioquadrics)"},
        of(Form::ellipsoid, true));
    v.surface({"superhyperboloid", "\\|x/a\\|^p + \\|y/b\\|^q - \\|z/c\\|^r <= 1"},
              of(Form::hyperboloid, false));
    v.surface({"ratiohyperboloid", "the same with pseudo-powers"}, of(Form::hyperboloid, true));
    v.surface({"supertoroid", "\\|d - (\\|x/a\\|^m + \\|y/b\\|^n)^q\\|^r + \\|z/c\\|^p <= e²"},
              of(Form::toroid, false));
    v.surface({"ratiotoroid", "the same with pseudo-powers"}, of(Form::toroid, true));
  }

  void describe(auto& v) {
    // Nothing overflows with exponents up to this, and the shape is its box to within a thousandth.
    constexpr Range kExponent{0, 1024, true};
    v.field("radii", radii, kLength, "a, b and c");
    if (form == Form::toroid) {
      v.field("m", m, kExponent, "exponent of x");
      v.field("n", n, kExponent, "exponent of y");
      v.field("q", q, kExponent, "exponent of the ring");
      v.field("r", r, kExponent, "exponent of the tube");
      v.field("p", p, kExponent, "exponent of z");
      v.field("d", d, kNonNegative, "distance of the middle of the tube from the axis, in radii");
      v.field("e", e, kNonNegative, "thickness of the tube, in radii");
      v.nothing_if(e == 0, "the tube has no thickness");
    } else {
      v.field("p", p, kExponent, "exponent of x");
      v.field("q", q, kExponent, "exponent of y");
      v.field("r", r, kExponent, "exponent of z");
    }
    if (form == Form::hyperboloid) {
      v.field("clip", ClipBox{lo, hi}, "a box that cuts it, and whose faces close it");
      v.field("open", open, "without the faces of the box");
      v.nothing_if(!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z), "the clip box has no volume");
    }
    v.normals();
    v.nothing_if(radii.x == 0 || radii.y == 0 || radii.z == 0, "a radius is zero");
  }
};

}  // namespace oktett
