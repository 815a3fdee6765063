#pragma once
/// \file The rays in flight of an interleaved traversal: how they are prepared, what they have hit, their
/// step through a node, and the queues in which they wait.

#include <algorithm>
#include <array>
#include <cmath>

#include "accel/accel_data.h"
#include "accel/ray_state.h"
#include "accel/traverse/leaf.h"
#include "core/lanes.h"
#include "core/ray.h"
#include "core/simd_order.h"
#include "kernels/closed/slab.h"
#include "kernels/triangle/triangle_classify.h"

namespace oktett {

// ---- Prefetching what a ray visits next.

/// Trees above this size are prefetched; smaller ones are in the caches, where a prefetch costs more than it
/// saves. For rays that begin far from each other the limit is about the size of a core's own cache.
inline constexpr std::size_t kPrefetchBytes = std::size_t{32} << 20,
                             kPrefetchScatteredBytes = std::size_t{2} << 20;

inline std::size_t tree_bytes(const Accel& accel) { return accel.stats.node_bytes + accel.stats.leaf_bytes; }

/// Whether most rays begin farther from the ray before them than a 16th of the scene's longest edge. Looks at
/// 16 pairs of rays at most.
inline bool are_scattered(const RaySpan& rays, const Box& bounds) {
  constexpr std::size_t kPairs = 16;
  if (rays.size < 2 || bounds.empty()) return false;
  const float far = max_component(bounds.hi - bounds.lo) / 16;
  const std::size_t pairs = std::min(kPairs, rays.size - 1);
  std::size_t scattered = 0;
  for (std::size_t n = 0; n < pairs; ++n) {
    const std::size_t i = n * (rays.size - 1) / pairs;
    float most = 0;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(rays.origin[k][i + 1] - rays.origin[k][i]));
    scattered += most > far;
  }
  return 2 * scattered > pairs;
}

/// Whether rays in flight through a tree without instances prefetch it.
inline bool pays_to_prefetch(const Accel& accel, const RaySpan& rays) {
  const std::size_t bytes = tree_bytes(accel);
  return bytes > kPrefetchBytes || (bytes > kPrefetchScatteredBytes && are_scattered(rays, accel.bounds));
}

/// Where the nodes and the blocks of triangles of a structure begin, as bytes.
struct TreeBytes {
  const char* of[2];
  TreeBytes() = default;
  explicit TreeBytes(const Accel& accel)
      : of{reinterpret_cast<const char*>(accel.nodes.data()),
           reinterpret_cast<const char*>(accel.blocks.data())} {}

  OKTETT_INLINE const BvhNode* nodes() const { return reinterpret_cast<const BvhNode*>(of[0]); }
  OKTETT_INLINE const TriangleBlock* blocks() const { return reinterpret_cast<const TriangleBlock*>(of[1]); }

  /// Prefetches a node or a block. For any other leaf the address means nothing, so it is a number here: a
  /// pointer may not leave its array.
  OKTETT_INLINE void prefetch(NodeRef ref) const {
    static_assert(sizeof(TriangleBlock) == sizeof(BvhNode) && TriangleBlock::kLeaves == 2);
    const std::uint32_t is_leaf = ref.bits() >> 31;
    const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(of[is_leaf]) +
                              std::size_t{ref.triangle_leaf() >> is_leaf} * sizeof(BvhNode);
    for (std::size_t line = 0; line < sizeof(BvhNode); line += 64)
      __builtin_prefetch(reinterpret_cast<const void*>(at + line));
  }
};

// ---- Rays prepared for the slab test in fused form, plane * (1/d) - o * (1/d). The bounds on its rounding
// errors are part of the ray.

/// Least extent of scene and origin for which products do not underflow; other rays are not tame.
inline constexpr float kChunkMinExtent = 0x1p-36f;
/// A direction component below this part of the greatest is replaced by it.
inline constexpr float kChunkMinComponent = 0x1p-40f;
/// Relative error of o * (1/d), of its sum with the error, and a reserve.
inline constexpr float kChunkShiftError = 0x1p-21f;

/// What the distances to planes take, along one axis of each lane: plane * inverse + near_shift for a near
/// plane, plane * inverse + far_shift for a far one.
template <class F>
struct SlabLines {
  F inverse, near_shift, far_shift;
};

template <class F>
OKTETT_INLINE F chunk_slack(const F& reach) {
  return fast_fma(reach, F(2 * kSlabAbsoluteSlack), F(2 * kSlabUnderflow));
}

/// `reach` is the distance in t to the far end of the scene, `least` the component that replaces smaller
/// ones.
template <class F>
OKTETT_INLINE SlabLines<F> slab_lines(const F& origin, const F& direction, const F& reach, const F& least,
                                      const F& extent) {
  const auto tiny = abs(direction) < least;
  const F inverse = F(1.0f) / select(tiny, flip_sign(least, direction + F(0.0f)), direction);
  const F shift = origin * inverse;
  // Without a fused operation, the product with the plane rounds too.
  const F size = kHasFma<typename F::Isa> && F::kWidth > 1 ? abs(shift) : abs(shift) + abs(inverse) * extent;
  // Replacing a tiny component turns the ray; it strays no farther than twice the way of the new component.
  const F error = fast_fma(size, F(kChunkShiftError), select(tiny, F(4.0f) * reach, F(0.0f)));
  return {inverse, -(shift + error), (error + chunk_slack(reach)) - shift};
}

/// The offset, in a node's planes, of the near ones along an axis.
OKTETT_INLINE std::uint32_t near_offset(std::uint32_t axis, unsigned negative) {
  return static_cast<std::uint32_t>(BvhNode::kWidth) * (2 * axis + negative);
}

/// The slab test in fused form: where a ray enters the boxes of a node's children, `near`, and where it
/// leaves them, which is returned. It meets those that it does not leave before it enters. `row(offset)` are
/// the planes at an offset in the node, `near_row` the offsets of the near ones, per axis; see RayChunk for
/// the others.
template <class F, class Row>
OKTETT_INLINE F fused_interval(Row&& row, const std::uint32_t (&near_row)[3], const std::array<F, 3>& inverse,
                               const std::array<F, 3>& near_shift, const std::array<F, 3>& far_shift,
                               const F& tmin, const F& limit, F& near) {
  constexpr std::uint32_t kOther = BvhNode::kWidth;
  F n[3], f[3];
  for (std::size_t k = 0; k < 3; ++k) {
    n[k] = fast_fma(row(near_row[k]), inverse[k], near_shift[k]);
    f[k] = fast_fma(row(near_row[k] ^ kOther), inverse[k], far_shift[k]);
  }
  near = max(max(n[0], n[1]), max(n[2], tmin));
  return min(min(f[0], f[1]), min(f[2], limit)) * F(kSlabRelativeSlack);
}

/// The same for the boxes of `node`.
template <class F>
OKTETT_INLINE F fused_interval(const BvhNode& node, const std::uint32_t (&near_row)[3],
                               const std::array<F, 3>& inverse, const std::array<F, 3>& near_shift,
                               const std::array<F, 3>& far_shift, const F& tmin, const F& limit, F& near) {
  const float* const rows = &node.plane[0][0];
  return fused_interval<F>([&](std::uint32_t offset) { return F::load(rows + offset); }, near_row, inverse,
                           near_shift, far_shift, tmin, limit, near);
}

/// W rays in columns. A box is met if
///     max(near plane * inv + near_shift, tmin) <= min(far plane * inv + far_shift, tmax + slack)
///                                                 * kSlabRelativeSlack
/// This rejects no box that contains a hit with t <= tmax (docs/numerics.md). The near planes are the low
/// ones where `negative` is 0, else the high ones.
template <int W, class A>
struct alignas(64) RayChunk {
  using F = Simd<float, W, A>;
  float o[3][W], d[3][W], d_max[W];
  float inv[3][W], near_shift[3][W], far_shift[3][W];
  float tmin[W], tmax[W], slack[W];
  unsigned negative[3];
  unsigned tame;  ///< rays that can hit anything (see Ray) and whose numbers suit the error bounds

  /// Sets the W rays from position `b` of a batch on; lanes past its end are not tame. `extent` is the
  /// greatest |coordinate| of the scene.
  OKTETT_INLINE void set(const RaySpan& rays, std::size_t b, float extent) {
    const std::size_t rest = rays.size - b;
    set(load_span<F>(rays, b), rest >= W ? ~0u : (1u << rest) - 1, F(extent));
  }

  /// Sets W rays; those that are not in `present` are not tame. Each has an extent of its own.
  OKTETT_INLINE void set(const RayLanes<F>& r, unsigned present, const F& extent) {
    const F zero(0.0f), big(std::numeric_limits<float>::max());
    const Vec3<F> dir = flush_direction(r.d);
    const F ax = abs(dir.x), ay = abs(dir.y), az = abs(dir.z);
    const F dm = max(az, max(ay, ax));
    const F om = max(abs(r.o.z), max(abs(r.o.y), abs(r.o.x)));
    // Every component is compared, because a comparison is false on NaN while max() may lose it.
    const auto finite = (ax <= big) & (ay <= big) & (az <= big) & (abs(r.o.x) <= big) & (abs(r.o.y) <= big) &
                        (abs(r.o.z) <= big);
    const auto usable = finite & (zero < dm) & (zero <= r.tmin) & (r.tmin < r.tmax);
    const F span = om + extent;
    const unsigned valid = bits(usable) & present;
    tame = valid & bits((F(kChunkMinExtent) <= span) & (span <= F(kClassifyMaxExtent)) &
                        (F(1 / kClassifyMaxDirection) <= dm) & (dm <= F(kClassifyMaxDirection)));
    const F reach = span / dm, least = dm * F(kChunkMinComponent);
    set_axis(0, r.o.x, dir.x, reach, least, extent);
    set_axis(1, r.o.y, dir.y, reach, least, extent);
    set_axis(2, r.o.z, dir.z, reach, least, extent);
    dm.store(d_max);
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    (r.tmin + zero).store(tmin), r.tmax.store(tmax), chunk_slack(reach).store(slack);
  }

  /// The rays that meet a box each, as bits.
  OKTETT_INLINE unsigned meets(const Vec3<F>& lo, const Vec3<F>& hi) const {
    F near = F::load(tmin), far = F::load(tmax) + F::load(slack);
    const auto axis = [&](int k, const F& low, const F& high) {
      const auto turned = F::M::from_bits(negative[k]);
      const F inverse = F::load(inv[k]);
      near = max(fast_fma(select(turned, high, low), inverse, F::load(near_shift[k])), near);
      far = min(fast_fma(select(turned, low, high), inverse, F::load(far_shift[k])), far);
    };
    axis(0, lo.x, hi.x), axis(1, lo.y, hi.y), axis(2, lo.z, hi.z);
    return bits(near <= far * F(kSlabRelativeSlack));
  }

 private:
  OKTETT_INLINE void set_axis(int k, const F& origin, const F& direction, const F& reach, const F& least,
                              const F& extent) {
    const SlabLines<F> line = slab_lines(origin, direction, reach, least, extent);
    origin.store(o[k]), direction.store(d[k]), line.inverse.store(inv[k]);
    line.near_shift.store(near_shift[k]), line.far_shift.store(far_shift[k]);
    negative[k] = bits(line.inverse < F(0.0f));
  }
};

// ---- The candidate hit of a ray whose triangles are classified in float: the nearest triangle that is
// surely hit, which is decided when the ray is finished.

/// A candidate is leaf * TriangleBlock::kSize + lane, or one of these: nothing has been hit so far, or the
/// nearest hit so far is decided and stands in the ray's RayState.
inline constexpr std::uint32_t kNoCandidate = 0xffffffffu;
inline constexpr std::uint32_t kDecidedHit = 0xfffffffeu;

/// The item of the nearest hit so far, if it is a triangle of a tree with `blocks`, else kNoId. `path` is the
/// path of hits in that tree. `r` is read only if the candidate is kDecidedHit.
template <class A>
OKTETT_INLINE std::uint32_t candidate_item(const TriangleBlock* blocks, std::uint32_t candidate,
                                           const RayState<1, A>& r, std::uint32_t path) {
  constexpr std::uint32_t kBlock = TriangleBlock::kSize;
  if (candidate < kDecidedHit) return TriangleLeaf(blocks, candidate / kBlock).item(candidate % kBlock);
  return candidate == kDecidedHit && r.path[0] == path ? r.item[0] : kNoId;
}

/// The lane of `leaf`, as a bit, that holds the triangle `item`, if there is one. A triangle that was split
/// stands in several leaves, and need not be tested again if it is the nearest hit so far.
template <class A>
OKTETT_INLINE unsigned repeated_lane(std::uint32_t item, const TriangleLeaf& leaf) {
  constexpr int kBlock = TriangleBlock::kSize;
  using I = Simd<std::int32_t, kBlock, A>;
  const auto* items = reinterpret_cast<const std::int32_t*>(leaf.items());
  return item == kNoId ? 0 : bits(I::load(items) == I(static_cast<std::int32_t>(item)));
}

/// The triangles of `leaf` that are surely behind the origin `o` of a ray, as bits.
template <class A>
OKTETT_NOINLINE unsigned behind_origin(const float* o, const float* d, const TriangleLeaf& leaf) {
  using F = Simd<float, TriangleBlock::kSize, A>;
  return bits(surely_behind(Vec3<F>{F(o[0]), F(o[1]), F(o[2])}, Vec3<F>{F(d[0]), F(d[1]), F(d[2])},
                            load_triangles<F>(leaf)));
}

/// A triangle that is surely hit at lo <= t <= hi.
struct SureHit {
  int lane;
  float lo, hi;
};

/// Of the triangles in `sure`, not empty, the one with the least hi. Bit 0 of `sure` is lane `first` of `h`.
template <class F>
OKTETT_INLINE SureHit nearest_sure(const HitInterval<F>& h, unsigned sure, int first) {
  alignas(64) float lo[F::kWidth], hi[F::kWidth];
  h.lo.store(lo), h.hi.store(hi);
  int nearest = __builtin_ctz(sure);
  for (unsigned rest = sure & (sure - 1); rest != 0; rest &= rest - 1)
    if (hi[first + __builtin_ctz(rest)] < hi[first + nearest]) nearest = __builtin_ctz(rest);
  return {nearest, lo[first + nearest], hi[first + nearest]};
}

/// What is known of a ray and the triangles of a block by their classification in float.
enum class BlockVerdict {
  missed,   ///< none of them is the nearest hit
  hit,      ///< of Query::any: one of them surely is hit
  nearest,  ///< one of them surely is the nearest hit so far
  open,     ///< the exact test decides
};

/// The verdict on the triangles of `leaf` that the filter did not reject: the bits of `maybe`, not empty.
/// The leaf is in lanes `first`, `first` + 1, ... of `guess` and of interval(), its HitInterval. `o` and `d`
/// are the ray's, `hit_lo` is the least distance of its nearest hit so far. repeated() returns the lanes that
/// need not be tested again. With `forward`, what is behind the origin is no hit. Sets `nearest` if that is
/// the verdict.
template <Query Q, class A, class F, class Repeated, class Interval>
OKTETT_INLINE BlockVerdict judge_block(const TriangleGuess<F>& guess, unsigned maybe, int first,
                                       const TriangleLeaf& leaf, const float* o, const float* d, bool forward,
                                       float hit_lo, Repeated&& repeated, Interval&& interval,
                                       SureHit& nearest) {
  maybe &= ~repeated();
  const unsigned near = bits(guess.t <= guess.t_error) >> first & maybe;
  if (OKTETT_UNLIKELY(near != 0 && forward)) maybe &= ~(near & behind_origin<A>(o, d, leaf));
  if (maybe == 0) return BlockVerdict::missed;
  const HitInterval<F>& h = interval();
  const unsigned sure = bits(h.sure) >> first & maybe;
  if (sure == 0) return BlockVerdict::open;
  if constexpr (Q == Query::any) return BlockVerdict::hit;
  nearest = nearest_sure(h, sure, first);
  if ((maybe & (maybe - 1)) != 0) maybe &= bits(maybe_hit(guess, F(nearest.hi))) >> first;
  return maybe == 1u << nearest.lane && nearest.hi < hit_lo ? BlockVerdict::nearest : BlockVerdict::open;
}

// ---- One of the rays in flight of an interleaved traversal, and its step through a node.

/// The tree that a ray is in, where there are instances.
struct alignas(64) InflightTree {
  const Accel* accel;
  TreeBytes bytes;         ///< of `accel`
  std::uint32_t instance;  ///< that the ray is in, or kNoInstance; see with_instance()
  /// The instances of the leaf in which `instance` is that the ray has not entered yet: numbers from `next`
  /// to before `end`.
  std::uint32_t next, end;
  std::uint32_t candidate_instance;  ///< that the candidate hit is in, or kNoInstance

  /// The tree `outer`, in no instance.
  OKTETT_INLINE void set(const Accel& outer) {
    accel = &outer, bytes = TreeBytes(outer), instance = kNoInstance;
  }
};

/// An in-flight ray in the space of the tree that it is in, and how far it has come. A node needs the first
/// 64 bytes only.
struct alignas(64) InflightHead {
  float inv[3], near_shift[3], far_shift[3];  ///< see RayChunk
  float tmin, limit;                          ///< limit = tmax + slack
  std::uint32_t near_row[3];                  ///< offset in a node's planes of the near ones, per axis
  NodeRef current;                            ///< the node or leaf to visit next
  std::int32_t size;                          ///< of the stack
  float o[3], d[3], slack;
  float weight_scale, det_scale;  ///< see guess_triangle
  /// Bounds on the distance of the nearest hit so far: hit_lo <= t <= tmax. Without a hit, both are the end
  /// of the ray.
  float tmax, hit_lo;
  /// The nearest hit so far: a triangle that is surely hit and not decided yet, as block *
  /// TriangleBlock::kSize + lane; or kNoCandidate or kDecidedHit.
  std::uint32_t candidate;
  std::uint32_t index;      ///< of the ray in its batch
  std::uint32_t has_state;  ///< the ray's RayState is filled in
  std::uint32_t place;      ///< of the ray in its beam
  std::uint32_t padding;

  OKTETT_INLINE void set_end(float t) { tmax = t, limit = t + slack; }
};

/// One ray in flight and its stack. The size is an odd number of cache lines, so that the rays do not fall
/// into the same sets of the cache.
struct InflightRay : InflightHead {
  static constexpr int kCapacity = (kStackSize + 2 * BvhNode::kWidth + 15) / 16 * 16;
  InflightTree in;
  /// Stack entries: nodes and leaves yet to visit, the next one last, and their near distances. Entry 0 is
  /// NodeRef::none(), which ends the ray.
  std::uint32_t ref[kCapacity];
  float near_of[kCapacity];

  OKTETT_INLINE void push(NodeRef entry, float near) {
    ref[size] = entry.bits(), near_of[size] = near;
    ++size;
  }
};
static_assert(sizeof(InflightRay) / 64 % 2 == 1);

/// Takes what nodes need of origin and direction from ray `i` of a chunk.
template <int W, class A>
OKTETT_INLINE void set_node_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  for (int k = 0; k < 3; ++k) {
    ray.inv[k] = c.inv[k][i], ray.near_shift[k] = c.near_shift[k][i], ray.far_shift[k] = c.far_shift[k][i];
    ray.near_row[k] = near_offset(static_cast<std::uint32_t>(k), c.negative[k] >> i & 1);
  }
  ray.slack = c.slack[i];
}

/// Takes origin and direction, and what triangles need of them.
template <int W, class A>
OKTETT_INLINE void set_triangle_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  for (int k = 0; k < 3; ++k) ray.o[k] = c.o[k][i], ray.d[k] = c.d[k][i];
  ray.weight_scale = c.d_max[i] * kWeightError, ray.det_scale = c.d_max[i] * kVolumeError;
}

/// Takes what nodes and triangles need of ray `i` of a chunk, but for its range.
template <int W, class A>
OKTETT_INLINE void set_lines(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  set_node_lines(ray, c, i);
  set_triangle_lines(ray, c, i);
}

/// Takes where ray `i` of a chunk begins and ends.
template <int W, class A>
OKTETT_INLINE void set_range(InflightHead& ray, const RayChunk<W, A>& c, int i) {
  ray.tmin = c.tmin[i];
  ray.set_end(c.tmax[i]);
}

/// Starts ray `i` of a chunk at `root`. `triangles`: whether the ray may meet triangles or go into instances.
template <int W, class A>
OKTETT_INLINE void start_ray(InflightRay& ray, const RayChunk<W, A>& c, int i, NodeRef root, bool triangles) {
  set_node_lines(ray, c, i);
  if (triangles) set_triangle_lines(ray, c, i);
  set_range(ray, c, i);
  ray.hit_lo = c.tmax[i], ray.candidate = kNoCandidate, ray.has_state = 0, ray.size = 0;
  ray.push(NodeRef::none(), -1), ray.push(root, 0);
}

/// Ends the ray at `tmax` and removes the stack entries that lie beyond.
template <class A>
OKTETT_INLINE void shorten(InflightRay& ray, float tmax) {
  using F = Simd<float, BvhNode::kWidth, A>;
  ray.set_end(tmax);
  const F limit(ray.limit * kSlabRelativeSlack);
  int size = 0;
  for (int k = 0; k < ray.size; k += BvhNode::kWidth) {
    const unsigned present = (2u << std::min(ray.size - 1 - k, BvhNode::kWidth - 1)) - 1;
    const unsigned kept = less_equal_lanes<A>(F::load(ray.near_of + k), limit) & present;
    store_compact<A>(kept, ray.near_of + k, ray.near_of + size);
    size += store_compact<A>(kept, ray.ref + k, ray.ref + size);
  }
  ray.size = size;
}

/// The slab test in fused form: the children of `node` that the ray meets, as bits, and their near distances.
template <class A>
OKTETT_INLINE unsigned node_inflight(const InflightHead& ray, const BvhNode& node,
                                     Simd<float, BvhNode::kWidth, A>& near) {
  using F = Simd<float, BvhNode::kWidth, A>;
  const auto each = [](const float(&v)[3]) { return std::array{F(v[0]), F(v[1]), F(v[2])}; };
  const F far = fused_interval<F>(node, ray.near_row, each(ray.inv), each(ray.near_shift),
                                  each(ray.far_shift), F(ray.tmin), F(ray.limit), near);
  return less_equal_lanes<A>(near, far);
}

/// Pushes the children that the ray meets, the nearest last (for Query::any in any order), and pops the next
/// node or leaf.
template <Query Q, class A>
OKTETT_INLINE NodeRef step_node(InflightRay& ray, const BvhNode& node) {
  Simd<float, BvhNode::kWidth, A> near;
  const unsigned met = node_inflight<A>(ray, node, near);
  const int size = ray.size;
  const int count =
      Q == Query::any ? store_compact<A>(met, node.child_bits(), ray.ref + size)
                      : store_descending<A>(near, met, node.child_bits(), ray.ref + size, ray.near_of + size);
  ray.size = size + count - 1;
  const NodeRef next = NodeRef::from_bits(ray.ref[size + count - 1]);
  ray.current = next;
  return next;
}

// ---- The queues of an interleaved traversal: which rays in flight wait for which kind of step.

/// Rays that are traced at the same time.
inline constexpr int kInflightRays = 48;
/// A round over the nodes takes at least this many steps. With fewer rays than that, a ray takes several
/// steps. The end of each round costs a mispredicted branch, so rounds must not be short.
inline constexpr int kRoundSteps = 16;

/// Rays that wait for one kind of step, first come, first served.
struct InflightQueue {
  static constexpr int kPlaces = 256;
  InflightRay **head = ray, **tail = ray;
  InflightRay* ray[kPlaces];

  int size() const { return static_cast<int>(tail - head); }
};

/// The queues of rays at nodes, at blocks of triangles, and of all others.
struct InflightQueues {
  InflightQueue nodes, leaves, others;

  /// The ends of the three queues while a round fills them, kept in registers.
  struct Tails {
    InflightRay **node, **leaf, **other;
  };

  void clear() {
    for (InflightQueue* q : {&nodes, &leaves, &others}) q->head = q->tail = q->ray;
  }

  bool empty() const { return nodes.size() + leaves.size() + others.size() == 0; }

  /// The ends of the queues, with room for a round and for one more, because enqueue() writes past the end.
  OKTETT_INLINE Tails tails() {
    constexpr int kMost = InflightQueue::kPlaces - std::max(kInflightRays, kRoundSteps) - 1;
    for (InflightQueue* q : {&nodes, &leaves, &others})
      if (OKTETT_UNLIKELY(q->tail > q->ray + kMost))
        q->tail = std::copy(q->head, q->tail, q->ray), q->head = q->ray;
    return {nodes.tail, leaves.tail, others.tail};
  }
  OKTETT_INLINE void keep(const Tails& t) {
    nodes.tail = t.node, leaves.tail = t.leaf, others.tail = t.other;
  }

  /// Queues `ray` for the kind of step that `ref` needs. Has no branches: the pointer is written to the ends
  /// of all three queues, and one of the ends moves on.
  static OKTETT_INLINE void enqueue(InflightRay& ray, NodeRef ref, Tails& t) {
    const std::uint32_t bits = ref.bits(), is_leaf = bits >> 31;
    // Arithmetic on the two top bits of NodeRef::bits: compilers turn comparisons into jumps.
    const std::uint32_t is_other = is_leaf & (bits >> 30);
    *t.node = &ray, t.node += 1 - is_leaf;
    *t.leaf = &ray, t.leaf += is_leaf - is_other;
    *t.other = &ray, t.other += is_other;
  }
};

/// Rays that wait for neither a node nor a block, sorted without branches by what they wait for. `kLeaving`
/// tells whether there may be rays on their way out of an instance.
template <bool kLeaving>
struct SortedOthers {
  using List = InflightRay * [kInflightRays + 1];
  List finished, at_spheres, at_leaf, leaving;
  InflightRay **finished_end = finished, **at_spheres_end = at_spheres, **at_leaf_end = at_leaf,
              **leaving_end = leaving;

  OKTETT_INLINE SortedOthers(InflightRay* const* begin, InflightRay* const* end) {
    for (InflightRay* const* at = begin; at != end; ++at) {
      const NodeRef ref = (*at)->current;
      const int none = ref.is_none(), out = kLeaving && ref.is_way_out(), spheres = ref.is_spheres();
      *finished_end = *at_spheres_end = *at_leaf_end = *at;
      if constexpr (kLeaving) *leaving_end = *at, leaving_end += out;
      finished_end += none, at_spheres_end += spheres, at_leaf_end += 1 - none - out - spheres;
    }
  }
};

}  // namespace oktett
