#pragma once
/// \file Outlines in a plane: closed curves of Bezier pieces of degree 1 to 3, and their crossings with a
/// straight line.
///
/// The line is where g(x, z) = (gx x + gz z) + g0 is zero. Along a piece g is a polynomial in Bernstein form
/// whose coefficients are its values at the control points (T. W. Sederberg, T. Nishita: Curve intersection
/// using Bezier clipping, Computer-Aided Design 22, 1990). They are computed by the same operations wherever
/// they are needed, and a zero counts as positive; so pieces that share an end agree about it, and a line
/// crosses a closed outline an even number of times. The polynomial with the computed coefficients is that of
/// a piece whose control points have moved by a few roundings; its changes of sign are found one and all: the
/// piece is cut where the polynomial is greatest or least, and the signs there decide.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/simd.h"
#include "core/simd_native.h"
#include "kernels/exact/prism_data.h"

namespace oktett {

/// A point, and the derivatives of the curve by its parameter there.
struct OutlinePoint {
  FlatPoint at, slope, bend;
};

/// A Bezier piece, 0 <= s <= 1.
struct OutlinePiece {
  FlatPoint p[4];         ///< control points; those beyond the degree are copies of the last one
  int degree = 1;         ///< 1 to 3
  double begin, per_one;  ///< place along the whole outline, from 0 to 1: begin + per_one s

  OutlinePoint at(double s) const;
  /// The unit normal to the right of the piece at s; to that of its chord where it has no direction.
  FlatPoint right(double s) const;
  /// The parameter of the point of the piece that is nearest to q.
  double nearest(const FlatPoint& q) const;
};

/// Where g(x, z) = (gx x + gz z) + g0 is zero.
struct PlaneLine {
  double gx, gz, g0;

  double at(const FlatPoint& p) const { return (gx * p.x + gz * p.z) + g0; }
};

/// A change of the sign of g along a piece.
struct OutlineRoot {
  std::uint32_t piece;
  bool rises;  ///< from negative to positive as s grows
  double s;
};

/// A tree over pieces in the order of a walk: what is below a node follows it up to `skip`.
struct OutlineNode {
  FlatPoint middle, half;      ///< of a box that holds all control points
  std::uint32_t skip;          ///< the next node that is not below this one
  std::uint32_t first, count;  ///< of the pieces of a leaf; 0 of any other node
};

/// Pieces of closed outlines, gathered in groups whose boxes do not overlap.
class OutlineSet {
 public:
  struct Group {
    std::uint32_t begin, end;  ///< nodes
    FlatPoint lo, hi;
  };

  OutlineSet() = default;
  /// Outlines without pieces are left out.
  explicit OutlineSet(const std::vector<std::vector<OutlinePiece>>& outlines);

  const std::vector<OutlinePiece>& pieces() const { return pieces_; }
  const std::vector<OutlineNode>& nodes() const { return nodes_; }
  const std::vector<Group>& groups() const { return groups_; }
  FlatPoint lo() const { return lo_; }
  FlatPoint hi() const { return hi_; }
  std::size_t bytes() const;

  /// Calls f(numbers, count) for the pieces below the nodes from `begin` to `end` along which g may change
  /// its sign, not more than kBatch at a time. Pieces go in lanes.
  template <class A, class F>
  OKTETT_INLINE void each_candidate(const PlaneLine& line, std::uint32_t begin, std::uint32_t end,
                                    F&& f) const;
  /// Appends the changes of sign of g along pieces.
  void find_roots(const PlaneLine& line, std::span<const std::uint32_t> candidates,
                  std::vector<OutlineRoot>& out) const;
  /// Whether p is inside of the outlines.
  bool inside(const FlatPoint& p) const;
  /// The point of the outlines nearest to q.
  struct Nearest {
    std::uint32_t piece = 0;
    double s = 0, d2;
  };
  Nearest nearest(const FlatPoint& q) const;

  static constexpr int kBatch = 64;

 private:
  static constexpr int kPadding = 8;
  void build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
             const std::vector<OutlinePiece>& pieces);

  std::vector<OutlinePiece> pieces_;
  std::vector<double> x_[4], z_[4];  ///< control points in columns, with padding at the end
  std::vector<OutlineNode> nodes_;
  std::vector<Group> groups_;
  FlatPoint lo_{0, 0}, hi_{0, 0};
  double reach_ = 0;  ///< greatest coordinate
};

/// The pieces of an outline as it is described, closed. Pieces without length are left out, and those whose
/// coordinates are of a lower degree up to `rounding` become so.
std::vector<OutlinePiece> outline_pieces(const PlaneOutline& points, PrismShape::Curve curve,
                                         double rounding);

template <class A, class F>
OKTETT_INLINE void OutlineSet::each_candidate(const PlaneLine& line, std::uint32_t begin, std::uint32_t end,
                                              F&& f) const {
  constexpr int W = kDoubleLanes<A>;
  using D = Simd<double, W, A>;
  static_assert(W <= kPadding);
  const double ax = std::fabs(line.gx), az = std::fabs(line.gz);
  // What the values at control points, and at the middle of a box, are off by is less.
  const double margin = 0x1p-48 * ((ax + az) * reach_ + std::fabs(line.g0));
  const D gx(line.gx), gz(line.gz), g0(line.g0), zero(0.0);
  std::uint32_t batch[kBatch];
  int size = 0;
  for (std::uint32_t i = begin; i < end;) {
    const OutlineNode& node = nodes_[i];
    if (std::fabs(line.at(node.middle)) > (ax * node.half.x + az * node.half.z) + margin) {
      i = node.skip;
      continue;
    }
    ++i;
    for (std::uint32_t k = 0; k < node.count; k += W) {
      const std::uint32_t first = node.first + k;
      D least, most;
      for (int c = 0; c < 4; ++c) {
        const D g = (gx * D::load(&x_[c][first]) + gz * D::load(&z_[c][first])) + g0;
        least = c == 0 ? g : min(g, least);
        most = c == 0 ? g : max(g, most);
      }
      unsigned found = bits((least < zero) & ~(most < zero));
      if (node.count - k < W) found &= (1u << (node.count - k)) - 1;
      for (; found != 0; found &= found - 1) {
        batch[size++] = first + static_cast<std::uint32_t>(__builtin_ctz(found));
        if (size == kBatch) f(batch, size), size = 0;
      }
    }
  }
  if (size > 0) f(batch, size);
}

}  // namespace oktett
