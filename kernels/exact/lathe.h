#pragma once
/// \file Surfaces of revolution whose profile is any plane curve: cubic Bezier pieces (r(v), y(v)).
///
/// A ray that rises or falls is at the height y(v) at one t, so that it meets the surface where
/// (x(t)^2 + z(t)^2) - r(v)^2 is zero: of degree 6 in v, of straight pieces 2, of parabolas 4. One that is
/// level meets the piece where y(v) is its height, of degree 3, and then a circle. Whether the ray is inside
/// of the circle where two pieces meet is decided once, by numbers that both have in common.

#include "kernels/exact/lathe_data.h"
#include "kernels/exact/line_columns.h"
#include "kernels/exact/ray_polynomial.h"
#include "kernels/exact/round_profile.h"

namespace oktett {

struct LatheElement {
  struct Piece {
    double r[4], y[4];                 ///< in powers of v, -1 <= v <= 1
    int degree;                        ///< of both
    double radius[2], height[2];       ///< at -1 and 1
    bool cap[2];                       ///< whether a disk closes that end
    double least_y, greatest_y, most;  ///< bounds of y and r
  };
  std::vector<Piece> pieces;
  double side;  ///< side * (y', -r') points outwards
  bool closed;  ///< by disks, or as the curve is closed or begins and ends on the axis
};

/// Parts: 0 the surface, 1 the disk at the curve's beginning, 2 that at its end.
struct Lathe {
  using Data = LatheShape;
  using Pool = ExactPool<LatheElement>;
  static constexpr int kMaxCrossings = 8;

  static void add(Pool& pool, const LatheShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    constexpr int W = D::kWidth;
    const LatheElement& e = pool.elements[cell.element];
    const LatheElement::Piece& piece = e.pieces[cell.begin];
    out.clear();
    // Where it passes the cylinder around the piece by, there is nothing.
    const D dd = line.d.x * line.d.x + line.d.z * line.d.z;
    const D nearest = -((line.o.x * line.d.x + line.o.z * line.d.z) / dd);
    const D x = line.o.x + nearest * line.d.x, z = line.o.z + nearest * line.d.z;
    const D room = D(piece.most * piece.most) - (x * x + z * z);
    const auto slants = dd > D(0x1p-100) * (line.d.y * line.d.y);
    const auto there = active & (~slants | (room >= D(0.0)));
    if (none(there)) return;
    const RaySegment<D> segment(line, range);
    D c[7];
    substitute(piece, segment, c);
    const auto shallow = abs(line.d.y) <= D(kShallow) * sqrt(dd);
    // A disk may be met without the surface.
    const auto settled = no_sign_change(c, 2 * piece.degree) & ~shallow;
    const unsigned doubtful = bits(there & ~settled),
                   lanes = piece.cap[0] || piece.cap[1] ? bits(there) : doubtful;
    if (lanes == 0) return;
    const LineColumns<D> rays(line, range);
    double places[kMostChanges][W];
    D changes[kMostChanges], turns[kMostChanges];
    for (D& s : changes) s = D(roots::kNoRoot);
    const auto steep = there & ~settled & ~shallow;
    if (any(steep)) changes_in_lanes(c, 2 * piece.degree, steep, changes, turns);
    for (int k = 0; k < kMostChanges; ++k) changes[k].store(places[k]);
    CrossingColumns<K, D> lists(out);
    for (int i = 0; i < W; ++i) {
      if (!(lanes >> i & 1)) continue;
      OneRay one;
      for (int k = 0; k < 3; ++k) one.line[k] = rays.o(i)[k], one.line[3 + k] = rays.d(i)[k];
      one.a = rays.a(i), one.b = rays.b(i), one.begin = rays.begin(i);
      one.on_surface = doubtful >> i & 1;
      for (one.count = 0; one.count < kMostChanges && places[one.count][i] < roots::kNoRoot; ++one.count)
        one.changes[one.count] = places[one.count][i];
      Found found;
      find(e, piece, one, found);
      for (int k = 0; k < K && k < found.count; ++k)
        lists.t[k][i] = found.t[k], lists.turn[k][i] = found.turn[k], lists.part[k][i] = found.part[k];
    }
    lists.load(out);
  }

  /// About the distance from the surface.
  static Slope slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// u around the axis from +z towards +x, v along the curve, both in [0, 1].
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);

 private:
  /// A ray that rises by less than this times its way is taken as level: within the surface it goes astray by
  /// no more than that. Above, double-double tells the two roots at one height apart.
  static constexpr double kLevel = 0x1p-40;
  /// One that rises by less than this times its way is solved only where the piece is at its heights: over
  /// all heights its way is long, and the rounding of the polynomial grows with the square of that.
  static constexpr double kShallow = 0x1p-3;
  static constexpr int kMostChanges = 6;

  struct OneRay {
    double line[6];   ///< origin and direction
    double a, b;      ///< the part of the line that is looked at
    double begin;     ///< nothing counts before
    bool on_surface;  ///< whether it may meet the surface at all
    int count;  ///< changes of sign of the polynomial in v, in ascending order, unless the ray is shallow
    double changes[kMostChanges];
  };
  /// In ascending order.
  struct Found {
    int count = 0;
    double t[kMaxCrossings], turn[kMaxCrossings], part[kMaxCrossings];
    void push(double place, double way, double of);
  };
  static void find(const LatheElement& e, const LatheElement::Piece& piece, const OneRay& ray, Found& out);
  static void find_level(const LatheElement& e, const LatheElement::Piece& piece, const OneRay& ray,
                         Found& out);
  static void find_shallow(const LatheElement& e, const LatheElement::Piece& piece, const OneRay& ray,
                           const double (&excess)[2], Found& out);

  /// With m + h s the part of the ray and w = y(v) - m_y: h_y^2 times x^2 + z^2 - r(v)^2 at s = w / h_y.
  template <class D>
  OKTETT_INLINE static void substitute(const LatheElement::Piece& piece, const RaySegment<D>& segment, D* c) {
    const Vec3<D>&m = segment.m, &h = segment.h;
    const D hy2 = h.y * h.y, aa = h.x * h.x + h.z * h.z;
    const D bb = D(2.0) * (m.x * h.x + m.z * h.z) * h.y, cc = (m.x * m.x + m.z * m.z) * hy2;
    const D w[4] = {D(piece.y[0]) - m.y, D(piece.y[1]), D(piece.y[2]), D(piece.y[3])};
    const D r[4] = {D(piece.r[0]) * h.y, D(piece.r[1]) * h.y, D(piece.r[2]) * h.y, D(piece.r[3]) * h.y};
    for (int k = 0; k < 7; ++k) c[k] = D(0.0);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) c[i + k] = c[i + k] + (aa * w[i] * w[k] - r[i] * r[k]);
    for (int i = 0; i < 4; ++i) c[i] = c[i] + bb * w[i];
    c[0] = c[0] + cc;
  }
};

/// Control points of the Catmull-Rom curve through all points but the first and the last, which only give the
/// directions at the ends: at a point the curve goes as the chord between its neighbours, with half its
/// length. At least 4 points.
std::vector<ProfilePoint> curve_through(const std::vector<ProfilePoint>& points);

/// What is wrong with a profile: it reaches over the axis, or it meets itself. Empty if nothing is.
const char* why_bad_profile(const LatheShape& shape);

}  // namespace oktett
