#pragma once
/// \file Every hit of a batch of rays. No hit shortens a ray here, so the order of the steps does not matter:
/// they are pairs of a ray and a node, then of a ray and a block of triangles, then of a ray and a triangle.
/// Each kind of pair waits in a list of its own, and a list is worked off in a loop whose steps are
/// independent of each other.

#include "accel/traverse/all_hits.h"
#include "accel/traverse/inflight/decide_pairs.h"
#include "accel/traverse/inflight/inflight_ray.h"

namespace oktett {

/// Traces a batch of rays; see the top of the file.
template <class A>
class AllHitsTraversal {
 public:
  AllHitsTraversal(const Accel& accel, const RaySpan& rays, RayHitList& out)
      : accel_(accel), rays_(rays), out_(out), extent_(box_extent(accel.bounds)) {}

  void run() {
    for (first_ = 0; first_ < rays_.size; first_ += kGroup) {
      set_group();
      while (nodes_.size > 0) {
        node_round();
        if (leaves_.size > kLeafRoom - 8 * kRound) leaf_round();
      }
      leaf_round();
      decide_round(0);
    }
    flush();
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr int kChunk = kChunkRays<A>;
  static constexpr int kLeafRays = kBlockRays<A>;
  /// Rays that are in the lists at the same time.
  static constexpr int kGroup = 256;
  /// Nodes visited in one round: the last ones in the list. Their children are one level deeper and follow in
  /// the list, so it never holds more than 8 * kRound nodes of one level.
  static constexpr int kRound = 64;
  static constexpr int kNodeRoom = kGroup + 8 * kRound * kMaxDepth + 8;
  static constexpr int kLeafRoom = 1024;
  static constexpr int kTriangleRoom = 512;
  static constexpr int kHitRoom = 256;

  /// Pairs of a ray of the group and a node, a block (as NodeRef::bits) or a triangle (block *
  /// TriangleBlock::kSize + lane). Stores of eight or sixteen lanes may overwrite what follows the last pair.
  template <int kRoom>
  struct Pairs {
    int size = 0;
    std::uint32_t ray[kRoom + 16], what[kRoom + 16];
  };

  /// The next rays of the batch, at the root of the tree.
  void set_group() {
    const std::size_t count = std::min<std::size_t>(kGroup, rays_.size - first_);
    for (std::size_t b = 0; b < count; b += kChunk) {
      chunk_.set(rays_, first_ + b, extent_);
      for (std::size_t i = 0; i < std::min<std::size_t>(kChunk, count - b); ++i) {
        const auto ray = static_cast<std::uint32_t>(b + i);
        if ((chunk_.tame >> i & 1) == 0 || !accel_.unbounded.empty()) {
          trace_alone(ray);
        } else {
          set_lines(group_[ray], chunk_, static_cast<int>(i));
          set_range(group_[ray], chunk_, static_cast<int>(i));
          if (accel_.root.is_triangles())
            push(leaves_, ray, accel_.root.bits());
          else if (!accel_.root.is_leaf())
            push(nodes_, ray, accel_.root.bits());
          else if (!accel_.root.is_none())
            at_table_leaf(ray, accel_.root);
        }
      }
    }
  }

  template <int kRoom>
  OKTETT_INLINE static void push(Pairs<kRoom>& pairs, std::uint32_t ray, std::uint32_t what) {
    pairs.ray[pairs.size] = ray, pairs.what[pairs.size++] = what;
  }

  /// The end of a list while a round appends to it, kept in registers.
  struct Tail {
    std::uint32_t *ray, *what;

    template <int kRoom>
    OKTETT_INLINE explicit Tail(Pairs<kRoom>& p) : ray(p.ray + p.size), what(p.what + p.size) {}

    /// Appends the children of `node` in `lanes`, with ray `of`.
    OKTETT_INLINE void push(unsigned lanes, std::uint32_t of, const BvhNode& node) {
      using I = Simd<std::int32_t, BvhNode::kWidth, A>;
      I(static_cast<std::int32_t>(of)).store(reinterpret_cast<std::int32_t*>(ray));
      const int count = store_compact<A>(lanes, node.child_bits(), what);
      ray += count, what += count;
    }
  };

  void node_round() {
    using I = Simd<std::int32_t, BvhNode::kWidth, A>;
    // The round overwrites the end of the list, so it works on a copy, of whole vectors.
    std::uint32_t ray_of[kRound], node_of[kRound];
    const int count = std::min(nodes_.size, kRound);
    nodes_.size -= count;
    for (int i = 0; i < count; i += I::kWidth) {
      const auto copy = [&](const std::uint32_t* from, std::uint32_t* to) {
        I::load(reinterpret_cast<const std::int32_t*>(from) + nodes_.size + i)
            .store(reinterpret_cast<std::int32_t*>(to) + i);
      };
      copy(nodes_.ray, ray_of), copy(nodes_.what, node_of);
    }
    if (fetch_)
      for (int i = 0; i < count; ++i) bytes_.prefetch(NodeRef::from_bits(node_of[i]));
    const BvhNode* nodes = accel_.nodes.data();
    const bool has_table = has_table_;
    Tail inner(nodes_), leaf(leaves_);
    for (int i = 0; i < count; ++i) {
      const BvhNode& node = nodes[node_of[i]];
      Simd<float, BvhNode::kWidth, A> near;
      const unsigned met = node_inflight<A>(group_[ray_of[i]], node, near);
      // The top bit of a child tells a leaf from a node, the one below it a leaf of the table from a block.
      const I child = I::load(reinterpret_cast<const std::int32_t*>(node.child_bits()));
      const unsigned is_leaf = bits(child < I(0));
      unsigned blocks = met & is_leaf;
      if (OKTETT_UNLIKELY(has_table)) {
        const unsigned table = blocks & bits(I(static_cast<std::int32_t>(0xbfffffffu)) < child);
        blocks &= ~table;
        for (unsigned rest = table; rest != 0; rest &= rest - 1)
          at_table_leaf(ray_of[i], node.child[__builtin_ctz(rest)]);
      }
      inner.push(met & ~is_leaf, ray_of[i], node);
      leaf.push(blocks, ray_of[i], node);
    }
    nodes_.size = static_cast<int>(inner.ray - nodes_.ray);
    leaves_.size = static_cast<int>(leaf.ray - leaves_.ray);
  }

  void leaf_round() {
    int at = 0;
    for (; leaves_.size - at >= kLeafRays; at += kLeafRays) leaf_step<kLeafRays>(at);
    for (; at < leaves_.size; ++at) leaf_step<1>(at);
    leaves_.size = 0;
  }

  /// N pairs of a ray and a block from position `at` on: notes the triangles that the filter keeps.
  template <int N>
  OKTETT_INLINE void leaf_step(int at) {
    const auto ray = [&](int j) -> const InflightHead& { return group_[leaves_.ray[at + j]]; };
    const auto ref = [&](int j) { return NodeRef::from_bits(leaves_.what[at + j]); };
    const auto guess =
        guess_blocks<N, A>(ray, [&](int j) { return accel_.triangles(ref(j).triangle_leaf()); });
    const unsigned maybe = bits(maybe_hit(guess, spread_blocks<N, A>([&](int j) { return ray(j).tmax; })));
    for (int j = 0; j < N; ++j) {
      const unsigned present = (2u << (ref(j).triangle_count() - 1)) - 1;
      using I = Simd<std::int32_t, kBlock, A>;
      I(static_cast<std::int32_t>(leaves_.ray[at + j]))
          .store(reinterpret_cast<std::int32_t*>(triangles_.ray + triangles_.size));
      triangles_.size += store_set_bits<A>(
          maybe >> (j * kBlock) & present, static_cast<std::int32_t>(ref(j).triangle_leaf() * kBlock),
          reinterpret_cast<std::int32_t*>(triangles_.what + triangles_.size));
    }
    if (triangles_.size > kTriangleRoom - 2 * kBlock) decide_round(kChunk - 1);
  }

  /// Decides pairs of a ray and a triangle until no more than `rest` are left.
  OKTETT_NOINLINE void decide_round(int rest) {
    using C = Simd<float, kChunk, A>;
    using I = Simd<std::int32_t, kChunk, A>;
    while (triangles_.size > rest) {
      const int count = std::min(triangles_.size, kChunk), at = triangles_.size - count;
      std::uint32_t* ray = triangles_.ray + at;
      std::uint32_t* triangle = triangles_.what + at;
      for (int i = count; i < kChunk; ++i) ray[i] = ray[0], triangle[i] = triangle[0];
      constexpr auto kFloats = static_cast<std::int32_t>(sizeof(InflightHead) / sizeof(float));
      const I index = I::load(reinterpret_cast<const std::int32_t*>(ray)) * I(kFloats);
      const auto number = [&](const float& first) { return gather(&first, index); };
      const InflightHead& g = group_[0];
      const RayLanes<C> rays = load_ray_lanes(number, g.o, g.d, g.tmin, g.tmax);
      HitLanes<C> h;
      unsigned front = 0;
      unsigned met = decide_pairs<kChunk, A>(rays, accel_.blocks.data(), triangle, h, &front);
      met &= (2u << (count - 1)) - 1;
      each_hit(met, h, [&](int i, float t, float u, float v) {
        const std::uint32_t item = accel_.triangles(triangle[i] / kBlock).item(triangle[i] % kBlock);
        const bool mirrored = accel_.has_mirrors && is_mirrored(accel_, item);
        const float turn = (front >> i & 1) != (mirrored ? 1u : 0u) ? -1.0f : 1.0f;
        add({{{t, u, v, item, kNoId}, turn}, static_cast<std::uint32_t>(first_) + ray[i]});
      });
      triangles_.size = at;
    }
  }

  OKTETT_INLINE void add(const RayHit& hit) {
    hits_[hit_count_++] = hit;
    if (hit_count_ == kHitRoom) flush();
  }
  OKTETT_NOINLINE void flush() {
    out_.append(hits_, hit_count_);
    hit_count_ = 0;
  }

  /// A ray of the group at a leaf of the table.
  OKTETT_NOINLINE void at_table_leaf(std::uint32_t ray, NodeRef ref) {
    RayState<1, A> state;
    state.set(rays_[first_ + ray], accel_.bounds);
    collect_leaf(accel_, accel_.leaves[ref.table_index()], state, out_.scratch());
    out_.take_scratch(first_ + ray);
  }

  /// A ray that is not valid, whose numbers do not suit the fast arithmetic, or among unbounded shapes.
  OKTETT_NOINLINE void trace_alone(std::uint32_t ray) {
    trace_all_hits<A>(accel_, rays_[first_ + ray], out_.scratch());
    out_.take_scratch(first_ + ray);
  }

  const Accel& accel_;
  const RaySpan rays_;
  RayHitList& out_;
  const float extent_;
  const TreeBytes bytes_{accel_};
  const bool fetch_ = tree_bytes(accel_) > kPrefetchBytes, has_table_ = !accel_.leaves.empty();
  std::size_t first_ = 0;  ///< of the group, in the batch
  RayChunk<kChunk, A> chunk_;
  Pairs<kNodeRoom> nodes_;
  Pairs<kLeafRoom> leaves_;
  Pairs<kTriangleRoom> triangles_;
  int hit_count_ = 0;
  RayHit hits_[kHitRoom];
  InflightHead group_[kGroup];
};

}  // namespace oktett
