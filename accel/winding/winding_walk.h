#pragma once
/// \file The sum over a tree of surfaces as seen from one point: in the nodes, expansions whose remainder is
/// bounded; near the point, solid angles of triangles (van Oosterom and Strackee 1983). The bounds are
/// derived in docs/numerics.md. Operations have one order everywhere, so the sums are the same bits.

#include <type_traits>

#include "accel/winding/winding_sum.h"
#include "accel/winding/winding_tree.h"
#include "core/elementary.h"
#include "core/lanes.h"

namespace oktett {

/// The arc tangent of 0 <= t <= 1, off by less than 2^-21.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> winding_atan(const Simd<float, W, A>& t) {
  using F = Simd<float, W, A>;
  const F z = t * t;
  F sum(kWindingAtan[0]);
  for (int i = 1; i < 8; ++i) sum = sum * z + F(kWindingAtan[i]);
  return sum * t;
}

/// The angle of (x, y) in turns, from -1/2 to 1/2. `slope`: the lesser magnitude over the greater.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> winding_turns(const Simd<float, W, A>& y, const Simd<float, W, A>& x,
                                              const Simd<float, W, A>& slope) {
  using F = Simd<float, W, A>;
  F turns = winding_atan(slope) * F(0.15915494f);
  turns = select(abs(y) > abs(x), F(0.25f) - turns, turns);
  turns = select(x < F(0.0f), F(0.5f) - turns, turns);
  return select(y < F(0.0f), -turns, turns);
}
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> winding_turns(const Simd<double, W, A>& y, const Simd<double, W, A>& x,
                                               const Simd<double, W, A>&) {
  return atan2_lanes(y, x) * Simd<double, W, A>(0.15915494309189535);
}

/// Sums up one tree for one point. `R`: float or double. `kMapped`: as a map shows the tree.
template <class A, class R, bool kMapped>
class WindingWalk {
 public:
  OKTETT_INLINE WindingWalk(const WindingTree& tree, const Vec3<R>& point, R limit, const WindingMap* map,
                            OpenParts* parts)
      : tree_(tree), at_{L(point.x), L(point.y), L(point.z)}, limit_(limit), map_(map), parts_(parts) {}

  OKTETT_INLINE WindingSum run() {
    std::uint32_t stack[kStack];
    int size = 0;
    stack[size++] = 0;
    do {
      const WindingNode& node = tree_.nodes[stack[--size]];
      for (unsigned open = add_node(node); open != 0; open &= open - 1) {
        const std::uint32_t child = node.child[__builtin_ctz(open)];
        if ((child & WindingNode::kLeaf) == 0)
          stack[size++] = child;
        else if (tree_.groups.empty())
          parts_->push(child & ~WindingNode::kLeaf);
        else
          add_group(tree_.groups[child & ~WindingNode::kLeaf]);
      }
    } while (size > 0);
    return total();
  }

 private:
  static constexpr int W = WindingNode::kWidth;
  static constexpr int kStack = 8 * 16;
  static_assert(WindingGroup::kSize == W);
  using L = Simd<R, W, A>;

  OKTETT_INLINE static L load(const float (&column)[W]) {
    if constexpr (std::is_same_v<R, float>)
      return L::load(column);
    else
      return to_double(Simd<float, W, A>::load(column));
  }
  /// From the point to a place of the tree.
  OKTETT_INLINE Vec3<L> way(const float (&to)[3][W]) const {
    const Vec3<L> r = Vec3<L>{load(to[0]), load(to[1]), load(to[2])} - at_;
    if constexpr (kMapped)
      return times(map_->linear, r);
    else
      return r;
  }
  OKTETT_INLINE static Vec3<L> times(const double (&m)[3][3], const Vec3<L>& v) {
    const auto row = [&](int i) { return L(R(m[i][0])) * v.x + L(R(m[i][1])) * v.y + L(R(m[i][2])) * v.z; };
    return {row(0), row(1), row(2)};
  }

  /// Adds the children of a node whose remainder is within the limit. Returns the others.
  OKTETT_INLINE unsigned add_node(const WindingNode& node) {
    const Vec3<L> r = way(node.center);
    const L one(R(1));
    const L s = one / sqrt(dot(r, r)), s2 = s * s;
    L reach = load(node.reach), area = load(node.area);
    if constexpr (kMapped) reach = reach * L(R(map_->stretch)), area = area * L(R(map_->turned));
    const L q = reach * s, gap = one - q;
    L left, rounding;
    if constexpr (kMapped) {
      left = area * q * s2 * (L(R(2)) - q) / (gap * gap);
      rounding = L(R(0x1p-20));
    } else {
      left = load(node.spread) * (s2 * s2 * s) * (L(R(4)) - L(R(3)) * q) / (gap * gap);
      if constexpr (std::is_same_v<R, float>)
        rounding = L(0x1p-19f) + q * (L(0x1p-15f) + q * L(0x1p-12f));
      else
        rounding = L(0x1p-23) + q * (L(0x1p-20) + q * L(0x1p-18));
    }
    const L size = area * s2;
    left = left + size * rounding;
    const auto taken = (left <= L(limit_)) & (q < L(R(0.98)));
    const unsigned lanes = bits(taken);
    ++steps_;
    if (lanes == 0) return (1u << W) - 1;
    const L zero(R(0)), value = expansion(node, r, s, s2);
    sum_ = sum_ + select(taken, value, zero);
    error_ = error_ + select(taken, left, zero);
    size_ = size_ + select(taken, size, zero);
    return ~lanes & ((1u << W) - 1);
  }

  /// What the children look like from afar.
  OKTETT_INLINE L expansion(const WindingNode& node, const Vec3<L>& r, const L& s, const L& s2) const {
    const Vec3<L> v{r.x * s, r.y * s, r.z * s};
    const Vec3<L> dipole{load(node.dipole[0]), load(node.dipole[1]), load(node.dipole[2])};
    if constexpr (kMapped) {
      return s2 * dot(times(map_->cofactor, dipole), v);
    } else {
      const L xx = v.x * v.x, yy = v.y * v.y, zz = v.z * v.z, xy = v.x * v.y;
      const L three(R(3)), xz = xx - zz, yz = yy - zz;
      const auto q = [&](int i) { return load(node.quadrupole[i]); };
      const auto o = [&](int i) { return load(node.octupole[i]); };
      const L second = q(0) * xz + q(1) * yz + q(2) * xy + v.z * (q(3) * v.x + q(4) * v.y);
      const L third = v.x * (o(0) * (xx - three * zz) + o(1) * yz) +
                      v.y * (o(2) * xz + o(3) * (yy - three * zz)) +
                      v.z * (o(4) * (three * xx - zz) + o(5) * (three * yy - zz) + o(6) * xy);
      return s2 * (dot(dipole, v) + s * (s * third - second));
    }
  }

  /// Adds the solid angles of triangles.
  OKTETT_NOINLINE void add_group(const WindingGroup& group) {
    // Roundings of coordinates, and of products of them, in units of the product of the lengths.
    constexpr R unit = std::is_same_v<R, float> ? R(0x1p-24) : R(0x1p-53);
    constexpr R least = std::is_same_v<R, float> ? R(0x1p-100) : R(0x1p-240);
    const L off(kMapped ? R(64) * R(map_->unit) : R(64) * unit);
    const Vec3<L> a = way(group.corner[0]), b = way(group.corner[1]), c = way(group.corner[2]);
    const L la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
    const L size = la * lb * lc, scale = L(R(1)) / size;
    L y = dot(a, cross(b, c)) * scale;
    if constexpr (kMapped) y = y * L(R(map_->side));
    const L x = (size + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) * scale;
    const L ax = abs(x), ay = abs(y), most = max(ax, ay), share = L(R(1)) / most;
    const L turns = winding_turns(y, x, min(ax, ay) * share);
    // A quarter of what is off, over the length of (x, y), bounds the error in turns; beside the cut, and
    // where lengths vanish, nothing is known.
    const auto known = (size > L(least)) & (most > off) & ((x > off) | (ay > off));
    const L zero(R(0));
    sum_ = sum_ + select(known, turns, zero);
    size_ = size_ + select(known, abs(turns), zero);
    const L rounding(std::is_same_v<R, float> ? R(0x1p-22) : R(0x1p-38));
    error_ = error_ + select(known, L(R(0.25)) * off * share + rounding, L(R(0.5)));
    ++steps_;
  }

  OKTETT_INLINE WindingSum total() const {
    alignas(64) R sum[W], error[W], size[W];
    sum_.store(sum), error_.store(error), size_.store(size);
    WindingSum total{0, 0x1p-60};
    double sizes = 0;
    for (int i = 0; i < W; ++i) {
      total.value += static_cast<double>(sum[i]);
      total.error += static_cast<double>(error[i]);
      sizes += static_cast<double>(size[i]);
    }
    // A term is at most six times its area over the squared distance; each addition rounds once.
    constexpr double unit = std::is_same_v<R, float> ? 0x1p-24 : 0x1p-53;
    total.error = total.error * (1 + 0x1p-8) + 6 * sizes * unit * (steps_ + 8);
    return total;
  }

  const WindingTree& tree_;
  const Vec3<L> at_;
  const R limit_;
  const WindingMap* map_;
  OpenParts* parts_;
  L sum_ = L(R(0)), error_ = L(R(0)), size_ = L(R(0));
  int steps_ = 0;
};

}  // namespace oktett
