#pragma once
/// \file Surfaces given by functions of two parameters, x(u, v), y(u, v) and z(u, v), solved by intervals
/// (D. L. Toth: On Ray Tracing Parametric Surfaces, 1985). The rectangle of the parameters is divided when
/// the tree is built, until in each piece the derivatives vary little: what they lie between, and the box of
/// the piece, are kept, so a ray computes intervals only where pieces are not enough.

#include "kernels/exact/parametric_data.h"
#include "kernels/exact/uv_surface.h"

namespace oktett {

struct ParametricElement : UvElement {
  /// A part of the rectangle, and what is known of the surface there, in the own space.
  struct Piece {
    UvBox box;
    Vec3d lo, hi;
    Vec3d middle, noise;           ///< the point in the middle, and how far it may be off
    Vec3d u_lo, u_hi, v_lo, v_hi;  ///< what the derivatives lie between
  };
  std::vector<Piece> pieces;
  FunctionTape f[3];
  UvBox whole;
  Vec3d origin;     ///< of the own space
  double per_size;  ///< lengths of the own space for one of the functions'; a power of two
  bool is_cut;
  Vec3d cut_lo, cut_hi;  ///< in the own space
  /// As far as coordinates count that the functions do not bound, as at the border of where one is defined:
  /// to the box, or without one a little beyond the rest of the surface.
  Vec3d reach_lo{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, reach_hi{HUGE_VAL, HUGE_VAL, HUGE_VAL};
};

struct Parametric : UvSurface<Parametric, ParametricShape, ParametricElement> {
  static void add(Pool& pool, const ParametricShape& shape, const ExactPlace& place);

  static int first_of(const ParametricElement& e, std::size_t piece, const Vec3d& o, const Vec3d& d,
                      double begin, int room, double* t, double* turn, double& up_to);
  static UvPoint point(const ParametricElement& e, std::size_t piece, double u, double v);
  static bool is_cut(const ParametricElement& e, const Vec3d& p);
  template <class Found>
  static bool search(const ParametricElement& e, std::size_t piece, const UvRay& ray, const Found& found);
};

/// What is known of the surface over a rectangle; false if it is nowhere defined there.
bool enclose_parametric(const ParametricElement& e, const UvBox& box, ParametricElement::Piece& piece);
/// A point and its derivatives; NaN where the functions are not defined.
UvFrame parametric_at(const ParametricElement& e, double u, double v);

/// A piece as UvSearch wants it.
class ParametricSheet {
 public:
  using Node = ParametricElement::Piece;

  ParametricSheet(const ParametricElement& e, const UvRay& ray) : error(ray.error), e_(e), ray_(ray) {}

  void bounds(const Node& node, UvBounds (&g)[2]) const {
    const Vec3d middle = (node.lo + node.hi) * 0.5, half = (node.hi - node.lo) * 0.5;
    g[0] = around(ray_.x, middle - ray_.p, half), g[1] = around(ray_.y, middle - ray_.p, half);
  }
  void slopes(const Node& node, double (&m)[2], double& rounding, UvBounds (&j)[2][2]) const {
    const double wide = (node.box.u1 - node.box.u0) * 0.5, high = (node.box.v1 - node.box.v0) * 0.5;
    const Vec3d off = node.middle - ray_.p;
    rounding = 0;
    for (int i = 0; i < 2; ++i) {
      const Vec3d& axis = i == 0 ? ray_.x : ray_.y;
      m[i] = dot(axis, off);
      rounding = std::max(rounding, dot(abs(axis), node.noise));
      j[i][0] = around(axis, (node.u_lo + node.u_hi) * (0.5 * wide), (node.u_hi - node.u_lo) * (0.5 * wide));
      j[i][1] = around(axis, (node.v_lo + node.v_hi) * (0.5 * high), (node.v_hi - node.v_lo) * (0.5 * high));
    }
  }
  void split(const Node& node, int axis, Node& low, Node& high) const {
    UvBox a = node.box, b = node.box;
    if (axis == 0)
      a.u1 = b.u0 = a.u0 + (a.u1 - a.u0) * 0.5;
    else
      a.v1 = b.v0 = a.v0 + (a.v1 - a.v0) * 0.5;
    enclose(a, low), enclose(b, high);
  }
  UvFrame at(double u, double v) const {
    const UvFrame f = parametric_at(e_, u, v);
    return {ray_.framed(f.p), ray_.turned(f.by_u), ray_.turned(f.by_v)};
  }

  double error;

 private:
  /// Where the surface is not defined its box is far from every ray.
  void enclose(const UvBox& box, Node& node) const {
    if (enclose_parametric(e_, box, node)) return;
    node.box = box;
    node.lo = node.hi = node.middle = ray_.p + ray_.x * 0x1p40;
  }
  /// What a coordinate lies between.
  static UvBounds around(const Vec3d& axis, const Vec3d& middle, const Vec3d& half) {
    const double m = dot(axis, middle), r = dot(abs(axis), half) * (1 + 0x1p-48) + std::abs(m) * 0x1p-48;
    if (!std::isfinite(m) || !std::isfinite(r)) return {-HUGE_VAL, HUGE_VAL};
    return {m - r, m + r};
  }

  const ParametricElement& e_;
  const UvRay& ray_;
};

template <class Found>
bool Parametric::search(const ParametricElement& e, std::size_t piece, const UvRay& ray, const Found& found) {
  const ParametricSheet sheet(e, ray);
  UvSearch zeros(sheet, found);
  return zeros.run(e.pieces[piece]);
}

}  // namespace oktett
