#pragma once
/// \file Prisms: outlines in the xz plane swept along y, straight up or from the origin as a tip.
///
/// Seen from above, or from the tip, a ray is a straight line in the plane of the outlines (J. T. Kajiya: New
/// Techniques for Ray Tracing Procedurally Defined Objects, SIGGRAPH 1983). All crossings of that line with
/// the outlines are found (outline.h); they are even in number, and from the end that is outside every second
/// one leads in. So the ray is inside of the flat ends and between the sides by one and the same count.

#include "kernels/closed/surface_points.h"
#include "kernels/exact/line_columns.h"
#include "kernels/exact/outline.h"

namespace oktett {

struct PrismElement {
  OutlineSet outlines;
  double from, to;  ///< heights, from < to
  bool conic, open;
};

struct PrismPool : ExactPool<PrismElement> {
  std::size_t bytes() const;
};

/// Parts: 0 the flat end at `from`, 1 that at `to`; 2 + 2 k and 3 + 2 k the side at piece k where its outside
/// is to the left and to the right of it, looking along the piece with x to the right and z up.
struct Prism {
  using Data = PrismShape;
  using Pool = PrismPool;
  static constexpr int kMaxCrossings = 16;

  static void add(Pool& pool, const PrismShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const PrismElement& e = pool.elements[cell.element];
    const LineColumns<D> rays(line, range);
    CrossingColumns<K, D> lists;
    for (unsigned lanes = bits(active); lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      Seen seen(e, rays.o(i), rays.d(i));
      if (!seen.may_meet) continue;
      e.outlines.each_candidate<typename D::Isa>(
          seen.line, cell.begin, cell.count,
          [&](const std::uint32_t* numbers, int count) { seen.add(numbers, count); });
      Listed found[K];
      const int count = seen.list(rays.begin(i), K, found, lists.up_to[i]);
      for (int k = 0; k < count; ++k)
        lists.t[k][i] = found[k].t, lists.turn[k][i] = found[k].turn, lists.part[k][i] = found[k].part;
    }
    lists.load(out);
  }

  static Slope slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// On the side u along the outline and v the height, both in [0, 1]; on a flat end the place in the box of
  /// all outlines.
  static SurfaceUv uv(const Pool& pool, std::size_t i, int part, const Vec3d& p);
  /// See ExactOps::closest.
  static SurfaceNearest closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p);
  static bool is_kept_by(const Affine& to_world);

 private:
  struct Listed {
    double t, turn, part;
  };

  /// A ray as it is seen in the plane of the outlines.
  class Seen {
   public:
    Seen(const PrismElement& e, const Vec3d& o, const Vec3d& d);
    /// Takes the pieces along which g may change its sign.
    void add(const std::uint32_t* numbers, int count);
    /// The first `room` crossings from `begin` on. All below `up_to` are listed.
    int list(double begin, int room, Listed* out, double& up_to);

    PlaneLine line;
    bool may_meet;

   private:
    struct Side {
      double t;
      std::uint32_t piece;
      bool rises;
    };
    /// Where the ray is at a point of the outlines' plane, or along x from the ray if that is seen as a
    /// point.
    double place_of(const FlatPoint& p) const;

    const PrismElement& e_;
    Vec3d o_, d_;
    double shift_, square_;
    FlatPoint at_;  ///< the point as which the ray is seen, or the one nearest to the middle
    bool is_point_;
    std::vector<OutlineRoot>& roots_;
  };
};

}  // namespace oktett
