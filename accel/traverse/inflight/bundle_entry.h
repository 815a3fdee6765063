#pragma once
/// \file Where short rays that start close together enter the tree: at the nodes and leaves that a box around
/// all of them meets. They replace the top of the tree, whose levels cost each ray steps and hardly ever
/// separate the rays.

#include "accel/traverse/inflight/inflight_ray.h"

namespace oktett {

/// Rays that share an entry: neighbours in their batch.
inline constexpr int kBundleRays = 256;
/// Relative error of the ends of rays and of the points at which they are hit, and a reserve.
inline constexpr float kBundleSlack = 0x1p-20f;

/// A box around the points at which rays may be hit, from their origins to their ends, with room for
/// rounding. Empty if a number of a ray is not finite. `extent` is the greatest |coordinate| of the scene.
template <class A>
OKTETT_INLINE Box reach_of(const RaySpan& rays, float extent) {
  using F = Simd<float, 8, A>;
  const F infinity(std::numeric_limits<float>::infinity()), big(std::numeric_limits<float>::max());
  Vec3<F> lo{infinity, infinity, infinity}, hi{-infinity, -infinity, -infinity};
  auto finite = F::M::all_true();
  for (std::size_t b = 0; b < rays.size; b += 8) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const auto add = [&](const F& from, const F& direction, F& low, F& high) {
      const F to = fast_fma(direction, r.tmax, from);
      finite = finite & (abs(from) <= big) & (abs(to) <= big);
      low = min(low, min(from, to)), high = max(high, max(from, to));
    };
    add(r.o.x, r.d.x, lo.x, hi.x), add(r.o.y, r.d.y, lo.y, hi.y), add(r.o.z, r.d.z, lo.z, hi.z);
  }
  if (bits(finite) != bits(F::M::all_true())) return {};
  alignas(64) float low[3][8], high[3][8];
  lo.x.store(low[0]), lo.y.store(low[1]), lo.z.store(low[2]);
  hi.x.store(high[0]), hi.y.store(high[1]), hi.z.store(high[2]);
  Box box;
  for (int i = 0; i < 8; ++i) {
    box.lo = min(box.lo, Vec3f{low[0][i], low[1][i], low[2][i]});
    box.hi = max(box.hi, Vec3f{high[0][i], high[1][i], high[2][i]});
  }
  const float slack =
      kBundleSlack * (extent + std::max(max_component(abs(box.lo)), max_component(abs(box.hi))));
  const Vec3f room{slack, slack, slack};
  return {box.lo - room, box.hi + room};
}

/// A node made for one bundle: its children are all that the rays of the bundle can meet in the tree.
template <class A>
class BundleEntry {
 public:
  /// Collects what `reach` meets, from the root downwards, as long as there is room; `accel.root` is a node.
  void set(const Accel& accel, const Box& reach) {
    size_ = 0;
    append(accel.nodes[accel.root.node_index()], reach);
    while (size_ > 0) {
      int widest = 0;
      for (int i = 1; i < size_; ++i)
        if (area_[i] > area_[widest]) widest = i;
      if (!(area_[widest] > 0)) break;
      const BvhNode& node = accel.nodes[child_[widest].node_index()];
      if (size_ - 1 + __builtin_popcount(met(node, reach)) > BvhNode::kWidth) {
        area_[widest] = 0;
        continue;
      }
      --size_;
      for (auto& row : plane_) row[widest] = row[size_];
      child_[widest] = child_[size_], area_[widest] = area_[size_];
      append(node, reach);
    }
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      for (int k = 0; k < 6; ++k) node_.plane[k][i] = i < size_ ? plane_[k][i] : k % 2 == 0 ? kInf : -kInf;
      node_.child[i] = i < size_ ? child_[i] : NodeRef::none();
    }
  }

  const BvhNode& node() const { return node_; }

 private:
  using F = Simd<float, BvhNode::kWidth, A>;

  /// The children of `node` that `reach` meets, as bits.
  static OKTETT_INLINE unsigned met(const BvhNode& node, const Box& reach) {
    const auto axis = [&](int k, float lo, float hi) {
      return (F::load(node.plane[2 * k]) <= F(hi)) & (F(lo) <= F::load(node.plane[2 * k + 1]));
    };
    return bits(axis(0, reach.lo.x, reach.hi.x) & axis(1, reach.lo.y, reach.hi.y) &
                axis(2, reach.lo.z, reach.hi.z));
  }

  /// Adds the children of `node` that `reach` meets, and half the surfaces of their boxes inside `reach` (0
  /// for leaves).
  OKTETT_INLINE void append(const BvhNode& node, const Box& reach) {
    int count = 0;
    for (unsigned rest = met(node, reach); rest != 0; rest &= rest - 1, ++count) {
      const int from = __builtin_ctz(rest), to = size_ + count;
      for (int k = 0; k < 6; ++k) plane_[k][to] = node.plane[k][from];
      child_[to] = node.child[from];
    }
    const auto side = [&](int k, float lo, float hi) {
      return min(F::load(plane_[2 * k + 1] + size_), F(hi)) - max(F::load(plane_[2 * k] + size_), F(lo));
    };
    const F x = side(0, reach.lo.x, reach.hi.x), y = side(1, reach.lo.y, reach.hi.y),
            z = side(2, reach.lo.z, reach.hi.z);
    (x * y + y * z + z * x).store(area_ + size_);
    for (int i = size_; i < size_ + count; ++i)
      if (child_[i].is_leaf()) area_[i] = 0;
    size_ += count;
  }

  int size_ = 0;
  /// Columns; append() writes eight elements at a time, those behind size_ have no meaning.
  float plane_[6][2 * BvhNode::kWidth], area_[2 * BvhNode::kWidth];
  NodeRef child_[2 * BvhNode::kWidth];
  BvhNode node_;
};

}  // namespace oktett
