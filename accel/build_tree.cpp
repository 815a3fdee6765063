#include "accel/build_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>

#include "core/error.h"

namespace oktett {
namespace {

/// Below this many references a subtree is built by one task; above it, binning and partitioning are parallel
/// too.
constexpr std::size_t kParallelTask = 4096;
constexpr std::size_t kParallelSplit = 1u << 17;
constexpr std::size_t kChunk = 1u << 15;

/// Union of boxes in the {-lo, hi} form; the gaps stay 0.
struct Extent {
  float v[8] = {-kInf, -kInf, -kInf, 0, -kInf, -kInf, -kInf, 0};
  static constexpr float kInf = std::numeric_limits<float>::infinity();

  void grow(const float* b) {
    for (int k = 0; k < 3; ++k) {
      v[k] = b[k] > v[k] ? b[k] : v[k];
      v[4 + k] = b[4 + k] > v[4 + k] ? b[4 + k] : v[4 + k];
    }
  }
  float lo(int k) const { return -v[k]; }
  float hi(int k) const { return v[4 + k]; }
  /// A measure of the surface, 0 for an empty box. `unit` is the scene's (see Builder::unit_).
  float area(float unit) const {
    const float x = half(0) * unit, y = half(1) * unit, z = half(2) * unit;
    return x >= 0 ? x * y + y * z + z * x : 0;
  }
  /// Half the extent, which does not overflow.
  float half(int k) const { return v[4 + k] * 0.5f + v[k] * 0.5f; }
};

/// A range of references with the bounds of their boxes and of their centres.
struct Range {
  std::size_t begin = 0, end = 0;
  Extent box, centers;
  std::size_t size() const { return end - begin; }
};

void grow_range(const PrimRef* refs, std::size_t begin, std::size_t end, Extent& box, Extent& centers) {
  for (std::size_t i = begin; i < end; ++i) {
    const PrimRef& r = refs[i];
    box.grow(r.negative_lo);
    float c[8];
    for (int k = 0; k < 3; ++k) c[4 + k] = r.hi[k] * 0.5f - r.negative_lo[k] * 0.5f, c[k] = -c[4 + k];
    centers.grow(c);
  }
}

/// A plane between bins, or none.
struct Split {
  int axis = -1, bin = 0, bins = 0;
  float origin = 0, scale = 0;
  float cost = std::numeric_limits<float>::infinity();
};

class Builder {
 public:
  Builder(Accel& accel, std::vector<PrimRef>& refs, const TriangleSource& triangles,
          std::vector<std::uint32_t> (&order)[8], const BuildOptions& options, const IsaTable& isa)
      : accel_(accel),
        refs_(refs.data()),
        count_(refs.size()),
        triangles_(triangles),
        order_(order),
        options_(options),
        isa_(isa) {
    options_.bins = std::clamp(options_.bins, 2, kMaxBins);
  }

  void run() {
    Range all{0, count_, {}, {}};
    bound(all);
    const float size = std::max({all.box.half(0), all.box.half(1), all.box.half(2)});
    if (size > 0 && std::isfinite(size))
      unit_ = std::exp2(static_cast<float>(-std::clamp(std::ilogb(size), -126, 126)));
    // A node has at least two children unless it is the root, a block at least one triangle.
    accel_.nodes = VirtualArray<BvhNode>(count_ + 1);
    accel_.blocks = VirtualArray<TriangleBlock>(count_ + 1);
    if (options_.parallel && count_ >= kParallelSplit) scratch_.resize_uninitialized(count_);
    accel_.root = is_leaf(all) ? make_leaf(all) : make_node(all, 1);
    accel_.bounds = {{all.box.lo(0), all.box.lo(1), all.box.lo(2)},
                     {all.box.hi(0), all.box.hi(1), all.box.hi(2)}};
    scratch_.clear();
    accel_.nodes.truncate(nodes_);
    accel_.blocks.truncate(blocks_);
    accel_.stats.nodes = nodes_;
    accel_.stats.leaves = blocks_ + accel_.leaves.size();
    accel_.stats.node_bytes = nodes_ * sizeof(BvhNode);
    accel_.stats.leaf_bytes = blocks_ * sizeof(TriangleBlock) + accel_.leaves.size() * sizeof(LeafEntry);
    accel_.stats.depth = depth_;
  }

 private:
  void bound(Range& r) const {
    if (!options_.parallel || r.size() < kParallelSplit)
      return grow_range(refs_, r.begin, r.end, r.box, r.centers);
    const std::size_t chunks = (r.size() + kChunk - 1) / kChunk;
    std::vector<Range> parts(chunks);
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
      const std::size_t b = r.begin + c * kChunk;
      grow_range(refs_, b, std::min(b + kChunk, r.end), parts[c].box, parts[c].centers);
    });
    for (const Range& p : parts) r.box.grow(p.box.v), r.centers.grow(p.centers.v);
  }

  /// One leaf can hold the range: few primitives, all of one kind.
  bool is_leaf(const Range& r) const {
    if (r.size() > TriangleBlock::kSize) return false;
    for (std::size_t i = r.begin + 1; i < r.end; ++i)
      if (refs_[i].kind != refs_[r.begin].kind) return false;
    return true;
  }

  void clear(Bins& bins, int n) const {
    const Extent empty;
    for (int axis = 0; axis < 3; ++axis)
      for (int b = 0; b < n; ++b) {
        std::memcpy(bins.box[axis][b].v, empty.v, sizeof empty.v);
        bins.count[axis][b] = 0;
      }
  }

  void fill(BinJob job, Bins& bins) const {
    clear(bins, job.bins);
    const std::size_t size = job.end - job.begin;
    if (!options_.parallel || size < kParallelSplit) {
      job.out = &bins;
      return isa_.bin(job);
    }
    const std::size_t chunks = (size + kChunk - 1) / kChunk;
    std::mutex merge;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks),
                      [&](const tbb::blocked_range<std::size_t>& c) {
                        Bins local;
                        clear(local, job.bins);
                        BinJob part = job;
                        part.begin = job.begin + c.begin() * kChunk,
                        part.end = std::min(job.begin + c.end() * kChunk, job.end);
                        part.out = &local;
                        isa_.bin(part);
                        const std::lock_guard lock(merge);
                        // Maxima and sums of integers do not depend on the order of merging.
                        for (int axis = 0; axis < 3; ++axis)
                          for (int b = 0; b < job.bins; ++b) {
                            Extent e;
                            std::memcpy(e.v, bins.box[axis][b].v, sizeof e.v);
                            e.grow(local.box[axis][b].v);
                            std::memcpy(bins.box[axis][b].v, e.v, sizeof e.v);
                            bins.count[axis][b] += local.count[axis][b];
                          }
                      });
  }

  /// Blocks of eight that n primitives fill: what a leaf costs, and why splits fall at multiples of eight
  /// where they can.
  static float blocks(std::uint32_t n) {
    return static_cast<float>((n + TriangleBlock::kSize - 1) / TriangleBlock::kSize);
  }

  /// The plane of least surface-area cost (Wald 2007: binned).
  Split find_split(const Range& r) const {
    const int n = std::min<std::size_t>(options_.bins, 4 + r.size() / 8);
    BinJob job{refs_, r.begin, r.end, {}, {}, n, nullptr};
    for (int k = 0; k < 3; ++k) {
      const float extent = r.centers.hi(k) - r.centers.lo(k);
      job.origin[k] = r.centers.lo(k);
      const float scale = static_cast<float>(n) / extent;
      job.scale[k] = extent > 0 && std::isfinite(scale) && std::isfinite(extent) ? scale : 0;
    }
    Bins bins;
    fill(job, bins);
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (job.scale[axis] == 0) continue;
      float right_cost[kMaxBins];
      Extent right;
      std::uint32_t right_count = 0;
      for (int b = n - 1; b > 0; --b) {
        right.grow(bins.box[axis][b].v);
        right_count += bins.count[axis][b];
        right_cost[b] = right_count > 0 ? right.area(unit_) * blocks(right_count)
                                        : std::numeric_limits<float>::infinity();
      }
      Extent left;
      std::uint32_t left_count = 0;
      for (int b = 0; b + 1 < n; ++b) {
        left.grow(bins.box[axis][b].v);
        left_count += bins.count[axis][b];
        if (left_count == 0) continue;
        const float cost = left.area(unit_) * blocks(left_count) + right_cost[b + 1];
        if (cost < best.cost) best = {axis, b, n, job.origin[axis], job.scale[axis], cost};
      }
    }
    return best;
  }

  /// Moves the references left of the plane to the front; returns where the right ones begin.
  std::size_t partition(const Range& r, const Split& s, Range& left, Range& right) {
    const auto goes_left = [&](const PrimRef& p) {
      return bin_of(p, s.axis, s.origin, s.scale, s.bins) <= s.bin;
    };
    if (!options_.parallel || r.size() < kParallelSplit) {
      std::size_t i = r.begin, j = r.end;
      for (;;) {
        while (i < j && goes_left(refs_[i])) ++i;
        while (i < j && !goes_left(refs_[j - 1])) --j;
        if (i >= j) break;
        std::swap(refs_[i], refs_[j - 1]);
      }
      grow_range(refs_, r.begin, i, left.box, left.centers);
      grow_range(refs_, i, r.end, right.box, right.centers);
      return i;
    }
    return partition_parallel(r, goes_left, left, right);
  }

  /// Stable and parallel: chunks count, then copy to their places.
  template <class Predicate>
  std::size_t partition_parallel(const Range& r, const Predicate& goes_left, Range& left, Range& right) {
    const std::size_t chunks = (r.size() + kChunk - 1) / kChunk;
    std::vector<std::size_t> lefts(chunks + 1, 0);
    std::vector<Range> l(chunks), rr(chunks);
    PrimRef* scratch = scratch_.data() + r.begin;
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
      const std::size_t b = r.begin + c * kChunk, e = std::min(b + kChunk, r.end);
      std::size_t n = 0;
      for (std::size_t i = b; i < e; ++i) n += goes_left(refs_[i]);
      lefts[c + 1] = n;
    });
    for (std::size_t c = 0; c < chunks; ++c) lefts[c + 1] += lefts[c];
    const std::size_t total_left = lefts[chunks];
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
      const std::size_t b = r.begin + c * kChunk, e = std::min(b + kChunk, r.end);
      std::size_t to_left = lefts[c], to_right = total_left + (b - r.begin) - lefts[c];
      for (std::size_t i = b; i < e; ++i) {
        const bool is_left = goes_left(refs_[i]);
        Range& side = is_left ? l[c] : rr[c];
        grow_range(refs_, i, i + 1, side.box, side.centers);
        scratch[is_left ? to_left++ : to_right++] = refs_[i];
      }
    });
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
      const std::size_t b = c * kChunk, e = std::min(b + kChunk, r.size());
      std::memcpy(static_cast<void*>(refs_ + r.begin + b), scratch + b, (e - b) * sizeof(PrimRef));
    });
    for (const Range& p : l) left.box.grow(p.box.v), left.centers.grow(p.centers.v);
    for (const Range& p : rr) right.box.grow(p.box.v), right.centers.grow(p.centers.v);
    return r.begin + total_left;
  }

  /// Splits any range of two or more: by cost, else by kind, else in the middle.
  void split(const Range& r, int depth, Range& left, Range& right) {
    std::size_t middle = r.begin;
    if (r.size() <= TriangleBlock::kSize) {
      const std::uint32_t kind = refs_[r.begin].kind;
      middle =
          std::partition(refs_ + r.begin, refs_ + r.end, [&](const PrimRef& p) { return p.kind == kind; }) -
          refs_;
    } else if (depth < kMaxDepth - 30) {
      const Split s = find_split(r);
      if (s.axis >= 0) middle = partition(r, s, left, right);
    }
    if (middle > r.begin && middle < r.end && r.size() > TriangleBlock::kSize) {
      left.begin = r.begin, left.end = right.begin = middle, right.end = r.end;
      return;
    }
    if (middle == r.begin || middle == r.end) middle = r.begin + r.size() / 2;
    left = {r.begin, middle, {}, {}}, right = {middle, r.end, {}, {}};
    bound(left), bound(right);
  }

  NodeRef make_leaf(const Range& r) {
    const Kind kind = static_cast<Kind>(refs_[r.begin].kind & 0xff);
    const TriangleTest test = static_cast<TriangleTest>(refs_[r.begin].kind >> 8 & 0xff);
    const int count = static_cast<int>(r.size());
    std::uint32_t begin = 0;
    if (kind == Kind::triangle) {
      begin = blocks_.fetch_add(1);
      if (begin >= NodeRef::kMaxBlocks) throw Error("too many triangles for one structure");
      fill_block(r, accel_.blocks[begin]);
      if (test == TriangleTest::watertight) return NodeRef::triangles(begin, count);
    }
    const std::lock_guard lock(leaf_mutex_);
    if (kind != Kind::triangle) {
      std::vector<std::uint32_t>& order = order_[static_cast<int>(kind)];
      begin = static_cast<std::uint32_t>(order.size());
      for (std::size_t i = r.begin; i < r.end; ++i) order.push_back(refs_[i].item);
    }
    accel_.leaves.push_back({begin, static_cast<std::uint16_t>(count), kind, test});
    return NodeRef::leaf(static_cast<std::uint32_t>(accel_.leaves.size() - 1));
  }

  void fill_block(const Range& r, TriangleBlock& block) const {
    std::uint32_t items[TriangleBlock::kSize];
    const int count = std::min(static_cast<int>(r.size()), TriangleBlock::kSize);
    for (int i = 0; i < count; ++i) items[i] = refs_[r.begin + i].item;
    // In order of items, whatever the order in which tasks moved the references.
    for (int i = 1; i < count; ++i)
      for (int j = i; j > 0 && items[j] < items[j - 1]; --j) std::swap(items[j], items[j - 1]);
    for (int i = 0; i < TriangleBlock::kSize; ++i) {
      Vec3f v[3];
      triangles_.corners(items[i < count ? i : 0], v);
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) block.v[k][axis][i] = v[i < count ? k : 0][axis];
      block.item[i] = i < count ? items[i] : kNoId;
    }
  }

  /// A node over the range: the child of greatest surface is split until there are eight or all are leaves.
  NodeRef make_node(const Range& r, int depth) {
    const std::uint32_t index = nodes_.fetch_add(1);
    note_depth(depth);
    Range child[BvhNode::kWidth];
    bool leaf[BvhNode::kWidth] = {};
    child[0] = r;
    int n = 1;
    leaf[0] = is_leaf(r);
    while (n < BvhNode::kWidth) {
      int widest = -1;
      float area = -1;
      for (int i = 0; i < n; ++i) {
        const float a = child[i].box.area(unit_);
        if (!leaf[i] && !(a <= area)) widest = i, area = a;
      }
      if (widest < 0) break;
      Range left, right;
      split(child[widest], depth, left, right);
      child[widest] = left, child[n] = right;
      leaf[widest] = is_leaf(left), leaf[n] = is_leaf(right);
      ++n;
    }
    NodeRef refs[BvhNode::kWidth];
    make_children(child, leaf, n, depth, refs);
    write_node(accel_.nodes[index], child, refs, n);
    return NodeRef::node(index);
  }

  void make_children(const Range* child, const bool* leaf, int n, int depth, NodeRef* refs) {
    tbb::task_group tasks;
    bool spawned = false;
    for (int i = 0; i < n; ++i) {
      if (options_.parallel && !leaf[i] && child[i].size() >= kParallelTask) {
        spawned = true;
        tasks.run([this, child, depth, refs, i] { refs[i] = make_node(child[i], depth + 1); });
      } else {
        refs[i] = leaf[i] ? make_leaf(child[i]) : make_node(child[i], depth + 1);
      }
    }
    if (spawned) tasks.wait();
  }

  void write_node(BvhNode& node, const Range* child, const NodeRef* refs, int n) const {
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[2 * axis][i] = i < n ? child[i].box.lo(axis) : Extent::kInf;
        node.plane[2 * axis + 1][i] = i < n ? child[i].box.hi(axis) : -Extent::kInf;
      }
      node.child[i] = i < n ? refs[i] : NodeRef::none();
    }
  }

  void note_depth(int depth) {
    int seen = depth_.load();
    while (seen < depth && !depth_.compare_exchange_weak(seen, depth)) {}
  }

  Accel& accel_;
  PrimRef* refs_;
  std::size_t count_;
  const TriangleSource& triangles_;
  std::vector<std::uint32_t> (&order_)[8];
  BuildOptions options_;
  const IsaTable& isa_;
  float unit_ =
      1;  ///< a power of two by which the scene is of size 1, so that areas neither overflow nor vanish
  Column<PrimRef> scratch_;
  std::atomic<std::uint32_t> nodes_{0}, blocks_{0};
  std::atomic<int> depth_{0};
  std::mutex leaf_mutex_;
};

}  // namespace

void build_tree(Accel& accel, std::vector<PrimRef>& refs, const TriangleSource& triangles,
                std::vector<std::uint32_t> (&order)[8], const BuildOptions& options, const IsaTable& isa) {
  if (refs.empty()) return;
  Builder(accel, refs, triangles, order, options, isa).run();
}

}  // namespace oktett
