#pragma once
/// \file Bicubic Bezier patches. Along a ray the coordinates of the control points in the ray's frame are
/// those of two bicubic functions, which lie between their Bernstein coefficients, as do the derivatives
/// between the differences of these (T. Nishita, T. W. Sederberg, M. Kakimoto: Ray Tracing Trimmed Rational
/// Surface Patches, 1990). Zeros by kernels/exact/uv_solver.h.
///
/// Patches are divided when the tree is built, until each piece is nearly flat. Neighbours with the same
/// control points along an edge see it in the same place but for rounding, for which the solver has room.

#include "kernels/exact/bezier_patch_data.h"
#include "kernels/exact/uv_surface.h"

namespace oktett {

struct BezierPatchElement : UvElement {
  /// A part of a patch.
  struct Piece {
    Vec3d p[16];
    Vec3d lo, hi;
    UvBox box;  ///< in the parameters of the patch
  };
  std::vector<Piece> pieces;
  double uv[8];
};

struct BezierPatch : UvSurface<BezierPatch, BezierPatchShape, BezierPatchElement> {
  static void add(Pool& pool, const BezierPatchShape& shape, const ExactPlace& place);

  static int first_of(const BezierPatchElement& e, std::size_t piece, const Vec3d& o, const Vec3d& d,
                      double begin, int room, double* t, double* turn, double& up_to);
  static UvPoint point(const BezierPatchElement& e, std::size_t piece, double u, double v);
  static bool is_cut(const BezierPatchElement&, const Vec3d&) { return false; }
  template <class Found>
  static bool search(const BezierPatchElement& e, std::size_t piece, const UvRay& ray, const Found& found);
};

// ---- Patches in the frame of a ray.

/// Weights of four control points, and of them for the derivative.
struct CubicWeights {
  double w[4], d[4];

  explicit CubicWeights(double t) {
    const double s = 1 - t;
    w[0] = s * s * s, w[1] = 3 * s * s * t, w[2] = 3 * s * t * t, w[3] = t * t * t;
    d[0] = -3 * s * s, d[1] = 3 * s * (s - 2 * t), d[2] = 3 * t * (2 * s - t), d[3] = 3 * t * t;
  }
};

/// The point of 16 control points, and its derivatives.
inline UvFrame bicubic_at(const Vec3d (&p)[16], double u, double v) {
  const CubicWeights a(u), b(v);
  UvFrame f{};
  for (int j = 0; j < 4; ++j) {
    const Vec3d* row = p + 4 * j;
    const Vec3d at = (row[0] * a.w[0] + row[1] * a.w[1]) + (row[2] * a.w[2] + row[3] * a.w[3]);
    const Vec3d by = (row[0] * a.d[0] + row[1] * a.d[1]) + (row[2] * a.d[2] + row[3] * a.d[3]);
    f.p += at * b.w[j], f.by_u += by * b.w[j], f.by_v += at * b.d[j];
  }
  return f;
}

/// A piece as UvSearch wants it. Its parameters run from 0 to 1.
class BezierSheet {
 public:
  struct Node {
    UvBox box;
    double g[2][16];
  };

  BezierSheet(const Vec3d (&p)[16], const UvRay& ray) : error(ray.error) {
    for (int k = 0; k < 16; ++k) p_[k] = ray.framed(p[k]);
  }
  Node whole() const {
    Node node;
    node.box = {0, 1, 0, 1};
    for (int k = 0; k < 16; ++k) node.g[0][k] = p_[k].x, node.g[1][k] = p_[k].y;
    return node;
  }

  void bounds(const Node& node, UvBounds (&g)[2]) const {
    for (int i = 0; i < 2; ++i) {
      g[i] = {node.g[i][0], node.g[i][0]};
      for (int k = 1; k < 16; ++k) grow(g[i], node.g[i][k]);
    }
  }
  void slopes(const Node& node, double (&m)[2], double& rounding, UvBounds (&j)[2][2]) const {
    rounding = 0;
    for (int i = 0; i < 2; ++i) {
      const double* c = node.g[i];
      UvBounds along{HUGE_VAL, -HUGE_VAL}, across = along;
      double sum[4];
      for (int row = 0; row < 4; ++row) {
        const double* r = c + 4 * row;
        for (int k = 0; k < 3; ++k) grow(along, r[k + 1] - r[k]);
        sum[row] = (r[0] + r[3]) + 3 * (r[1] + r[2]);
      }
      for (int k = 0; k < 12; ++k) grow(across, c[k + 4] - c[k]);
      m[i] = ((sum[0] + sum[3]) + 3 * (sum[1] + sum[2])) * (1.0 / 64);
      // A step of half the width, and a derivative of three times the difference.
      j[i][0] = {along.lo * 1.5, along.hi * 1.5}, j[i][1] = {across.lo * 1.5, across.hi * 1.5};
    }
  }
  void split(const Node& node, int axis, Node& low, Node& high) const {
    // `node` may not be one of the halves.
    low.box = high.box = node.box;
    const int step = axis == 0 ? 1 : 4, row = axis == 0 ? 4 : 1;
    if (axis == 0)
      low.box.u1 = high.box.u0 = (node.box.u0 + node.box.u1) * 0.5;
    else
      low.box.v1 = high.box.v0 = (node.box.v0 + node.box.v1) * 0.5;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 4; ++k) {
        const double* c = node.g[i] + k * row;
        double *l = low.g[i] + k * row, *h = high.g[i] + k * row;
        const double a = (c[0] + c[step]) * 0.5, b = (c[step] + c[2 * step]) * 0.5,
                     d = (c[2 * step] + c[3 * step]) * 0.5, ab = (a + b) * 0.5, bd = (b + d) * 0.5,
                     middle = (ab + bd) * 0.5;
        l[0] = c[0], l[step] = a, l[2 * step] = ab, l[3 * step] = middle;
        h[0] = middle, h[step] = bd, h[2 * step] = d, h[3 * step] = c[3 * step];
      }
  }
  UvFrame at(double u, double v) const { return bicubic_at(p_, u, v); }

  double error;

 private:
  static void grow(UvBounds& b, double x) { b.lo = std::min(b.lo, x), b.hi = std::max(b.hi, x); }

  Vec3d p_[16];
};

template <class Found>
bool BezierPatch::search(const BezierPatchElement& e, std::size_t piece, const UvRay& ray,
                         const Found& found) {
  const BezierPatchElement::Piece& part = e.pieces[piece];
  const BezierSheet sheet(part.p, ray);
  // Roots count in the parameters of the patch.
  const double wide = part.box.u1 - part.box.u0, high = part.box.v1 - part.box.v0;
  UvSearch zeros(sheet, [&](const UvRoot& root) {
    found(UvRoot{part.box.u0 + root.u * wide, part.box.v0 + root.v * high, root.turn});
  });
  return zeros.run(sheet.whole());
}

}  // namespace oktett
