#pragma once
/// \file One ray by itself through the tree, with the float arithmetic of interleaved rays: triangles are
/// classified, and the nearest hit is decided when the ray is finished.

#include <array>
#include <cmath>

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/single.h"
#include "core/simd_order.h"

namespace oktett {

/// A ray and its way through a tree.
template <Query Q, class A>
class SoloTraversal {
 public:
  OKTETT_INLINE SoloTraversal(const Accel& accel, const Ray& ray) : accel_(accel), ray_(ray) {
    const auto lanes = [](const Vec3f& p) { return V::of(p.x, p.y, p.z, 0.0f); };
    const V o = lanes(ray.origin), unflushed = lanes(ray.direction), big(std::numeric_limits<float>::max());
    const V d = select(abs(unflushed) < V(std::numeric_limits<float>::min()), V(0.0f), unflushed);
    const float extent = box_extent(accel.bounds);
    const float d_max = horizontal_max(abs(d)), span = horizontal_max(abs(o)) + extent;
    const unsigned finite = bits((abs(o) <= big) & (abs(d) <= big));
    tame_ = finite == 0xf && 0 <= ray.tmin && ray.tmin < ray.tmax && kChunkMinExtent <= span &&
            span <= kClassifyMaxExtent && 1 / kClassifyMaxDirection <= d_max &&
            d_max <= kClassifyMaxDirection;
    const V reach = V(span) / V(d_max);
    const SlabLines<V> line = slab_lines(o, d, reach, V(d_max * kChunkMinComponent), V(extent));
    line.inverse.store(inv_), line.near_shift.store(near_shift_), line.far_shift.store(far_shift_);
    d.store(d_), chunk_slack(reach).store(slack_);
    const float ax = std::abs(d_[0]), ay = std::abs(d_[1]), az = std::abs(d_[2]);
    z_axis_ = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    inv_dz_ = 1.0 / static_cast<double>(d_[z_axis_]);
    shear_x_ = static_cast<double>(d_[(z_axis_ + 1) % 3]) * inv_dz_;
    shear_y_ = static_cast<double>(d_[(z_axis_ + 2) % 3]) * inv_dz_;
    negative_ = bits(line.inverse < V(0.0f));
    weight_scale_ = d_max * kWeightError, det_scale_ = d_max * kVolumeError;
    tmax_ = hit_lo_ = ray.tmax;
  }

  OKTETT_INLINE Hit run() {
    if (OKTETT_UNLIKELY(!tame_)) return trace_exact<Q, A>(accel_, ray_);
    if (OKTETT_LIKELY(accel_.unbounded.empty()) || !unbounded()) traverse();
    if (candidate_ == kNoCandidate) return {};
    if constexpr (Q == Query::any) return {ray_.tmax, 0, 0, 0, kNoId};
    return candidate_ == kDecidedHit ? state_.hit(0) : decide();
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  using F = Simd<float, kBlock, A>;
  using V = Simd<float, 4, A>;

  OKTETT_NOINLINE bool unbounded() {
    for (const LeafEntry& leaf : accel_.unbounded) table_leaf_single<Q>(accel_, leaf, exact_state());
    adopt();
    return found();
  }

  OKTETT_INLINE bool found() const { return Q == Query::any && candidate_ == kDecidedHit; }

  OKTETT_INLINE void traverse() {
    constexpr int kWidth = BvhNode::kWidth;
    std::uint32_t ref_of[kStackSize + kWidth];
    float near_of[kStackSize + kWidth];
    ref_of[0] = NodeRef::none().bits(), near_of[0] = -1;
    int size = 1;
    std::array<F, 3> inv, near_shift, far_shift;
    std::uint32_t near_row[3];
    for (std::size_t k = 0; k < 3; ++k) {
      inv[k] = F(inv_[k]), near_shift[k] = F(near_shift_[k]), far_shift[k] = F(far_shift_[k]);
      near_row[k] = near_offset(static_cast<std::uint32_t>(k), negative_ >> k & 1);
    }
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    const F tmin(ray_.tmin + 0.0f);
    const BvhNode* nodes = accel_.nodes.data();
    const TreeBytes bytes(accel_);
    const bool fetch = tree_bytes(accel_) > kPrefetchBytes;
    float limit = tmax_ + slack_[0];
    NodeRef ref = accel_.root;
    for (;;) {
      if (!ref.is_leaf()) {
        const BvhNode& node = nodes[ref.bits()];
        F near;
        const unsigned met = fused_slab<A>(node, near_row, inv, near_shift, far_shift, tmin, F(limit), near);
        if (met != 0) {
          if ((met & (met - 1)) == 0) {
            ref = node.child[__builtin_ctz(met)];
            continue;
          }
          if (OKTETT_UNLIKELY(fetch))
            for (unsigned m = met; m != 0; m &= m - 1) bytes.prefetch(node.child[__builtin_ctz(m)]);
          size += store_descending<A>(near, met, node.child_bits(), ref_of + size, near_of + size) - 1;
          ref = NodeRef::from_bits(ref_of[size]);
          continue;
        }
      } else if (ref.is_triangles()) {
        if (OKTETT_UNLIKELY(leaf(ref))) {
          if (found()) return;
          limit = tmax_ + slack_[0];
        }
      } else {
        if (ref.is_none()) return;
        table_leaf_single<Q>(accel_, accel_.leaves[ref.table_index()], exact_state());
        adopt();
        if (found()) return;
        limit = tmax_ + slack_[0];
      }
      const float end = limit * kSlabRelativeSlack;
      do --size;
      while (near_of[size] > end);
      ref = NodeRef::from_bits(ref_of[size]);
    }
  }

  /// Tests a block of triangles; returns true if there is a new nearest hit.
  OKTETT_INLINE bool leaf(NodeRef ref) {
    const auto guess = guess_triangle(Vec3<F>{F(ray_.origin.x), F(ray_.origin.y), F(ray_.origin.z)},
                                      Vec3<F>{F(d_[0]), F(d_[1]), F(d_[2])}, F(weight_scale_), F(det_scale_),
                                      filter_triangle(load_triangles<F>(accel_.blocks[ref.block()])));
    const unsigned present = (2u << (ref.triangle_count() - 1)) - 1;
    const unsigned maybe = bits(maybe_hit(guess, F(tmax_))) & present;
    return OKTETT_UNLIKELY(maybe != 0) && take(ref, guess, maybe);
  }

  /// The same for the triangles that the filter did not reject, the bits of `maybe`.
  OKTETT_INLINE bool take(NodeRef ref, const TriangleGuess<F>& guess, unsigned maybe) {
    const TriangleBlock& block = accel_.blocks[ref.block()];
    const float o[3] = {ray_.origin.x, ray_.origin.y, ray_.origin.z};
    const auto repeated = [&] {
      if (!accel_.pieces) return 0u;
      return repeated_lane<A>(candidate_item(accel_.blocks.data(), candidate_, state_, kNoId), block);
    };
    const auto interval = [&] { return hit_interval(guess, F(ray_.tmin), F(tmax_)); };
    SureHit hit;
    switch (judge_block<Q, A>(guess, maybe, 0, block, o, d_, true, hit_lo_, repeated, interval, hit)) {
      case BlockVerdict::missed:
        return false;
      case BlockVerdict::hit:
        candidate_ = kDecidedHit;
        return true;
      case BlockVerdict::nearest:
        candidate_ = ref.block() * kBlock + static_cast<std::uint32_t>(hit.lane);
        hit_lo_ = hit.lo, tmax_ = hit.hi;
        return true;
      case BlockVerdict::open:
        break;
    }
    leaf_triangles_single(block, ref.triangle_count(), exact_state());
    return adopt();
  }

  /// The state for exact tests, in which the candidate has been decided.
  OKTETT_NOINLINE RayState<1, A>& exact_state() {
    if (!has_state_) state_.set(ray_, accel_.bounds);
    has_state_ = true;
    if (candidate_ < kDecidedHit) {
      const Hit h = decide();
      if (h.valid()) accept_hit(state_, 0, h.t, h.u, h.v, h.item, h.instance);
    }
    return state_;
  }

  /// Decides the candidate.
  OKTETT_INLINE Hit decide() const {
    using D = Simd<double, V::kWidth, A>;
    const TriangleBlock& block = accel_.blocks[candidate_ / kBlock];
    const std::uint32_t lane = candidate_ % kBlock;
    const auto origin = [&](int axis) { return D(static_cast<double>(ray_.origin[axis % 3])); };
    HitLanes<V> h;
    const unsigned met = bits(decide_watertight(
        ShearLanes<D>{{origin(z_axis_ + 1), origin(z_axis_ + 2), origin(z_axis_)},
                      D(inv_dz_),
                      D(shear_x_),
                      D(shear_y_)},
        broadcast_triangle<V>(block, static_cast<int>(lane), z_axis_), V(ray_.tmin), V(ray_.tmax), h));
    if (OKTETT_UNLIKELY(met == 0)) return {};
    float t[V::kWidth], u[V::kWidth], v[V::kWidth];
    h.t.store(t), h.u.store(u), h.v.store(v);
    return {t[0], u[0], v[0], block.item[lane], kNoId};
  }

  OKTETT_INLINE bool adopt() {
    if (state_.item[0] == kNoId) return false;
    candidate_ = kDecidedHit;
    hit_lo_ = tmax_ = state_.tmax[0];
    return true;
  }

  const Accel& accel_;
  const Ray& ray_;
  float inv_[4], near_shift_[4], far_shift_[4], d_[4], slack_[4];
  unsigned negative_;
  int z_axis_;
  double inv_dz_, shear_x_, shear_y_;
  bool tame_, has_state_ = false;
  float weight_scale_, det_scale_, tmax_, hit_lo_;
  std::uint32_t candidate_ = kNoCandidate;
  RayState<1, A> state_;
};

}  // namespace oktett
