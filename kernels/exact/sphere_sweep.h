#pragma once
/// \file Sweeps of spheres: what a sphere passes over whose centre and radius are polynomials of degree 1 or
/// 3 in pieces (J. J. van Wijk: Ray Tracing Objects Defined by Sweeping a Sphere, Computers & Graphics 9,
/// 1985).
///
/// Seen along a ray a sphere at v is a disk, and the ray is inside of it from b - sqrt(D) to b + sqrt(D),
/// where b(v) is how far along the ray its centre is, and D(v) its squared radius less the squared distance
/// of its centre from the ray. Where D is positive over an interval of v, so is all between the least
/// beginning and the greatest end of these; both are at an end of the interval or where the slope of one of
/// them is zero: 4 b'^2 D = D'^2, of degree 2 or 10. What is inside of some piece is inside.

#include "kernels/exact/line_columns.h"
#include "kernels/exact/sphere_sweep_data.h"

namespace oktett {

struct SphereSweepElement {
  /// Centre and radius in powers of v, -1 <= v <= 1.
  struct Piece {
    Vec3d c[4];
    double r[4];
    Vec3d lo, hi;  ///< what it holds
  };
  /// A tree over pieces in the order of a walk: what is below a node follows it up to `skip`.
  struct Node {
    Vec3d lo, hi;
    std::uint32_t skip;
    std::uint32_t first, count;  ///< of the pieces of a leaf; 0 of any other node
  };
  std::vector<Piece> pieces;
  std::vector<Node> nodes;
  int degree;  ///< of the pieces
};

struct SphereSweepPool : ExactPool<SphereSweepElement> {
  std::size_t bytes() const;
};

struct SphereSweep {
  using Data = SphereSweepShape;
  using Pool = SphereSweepPool;
  static constexpr int kMaxCrossings = 16;
  static constexpr bool kOneCell = true;

  static void add(Pool& pool, const SphereSweepShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const SphereSweepElement& e = pool.elements[cell.element];
    const LineColumns<D> rays(line, range);
    CrossingColumns<K, D> lists;
    for (unsigned lanes = bits(active); lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      double t[K];
      const int count = list(e, rays.o(i), rays.d(i), rays.begin(i), K, t, lists.turn[0][i], lists.up_to[i]);
      const double first = lists.turn[0][i];
      for (int k = 0; k < count; ++k)
        lists.t[k][i] = t[k], lists.turn[k][i] = k % 2 == 0 ? first : -first, lists.part[k][i] = 0;
    }
    lists.load(out);
  }

  /// The least of the squared distance from a centre less the squared radius, over all spheres.
  static Slope slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);

 private:
  /// The first `room` crossings of the ray from `begin` on, in turn; `first` is the turn of the first one.
  /// All below `up_to` are listed.
  static int list(const SphereSweepElement& e, const Vec3d& o, const Vec3d& d, double begin, int room,
                  double* t, double& first, double& up_to);
};

}  // namespace oktett
