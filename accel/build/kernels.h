#pragma once
/// \file Binning, partitioning and sweeping of references, compiled per instruction set.

#include <algorithm>
#include <bit>
#include <cstring>

#include "accel/build/sah.h"
#include "core/simd.h"

namespace oktett {

// ---- The tree over a few references by an exact sweep: each axis is sorted once, and every place to split
// at is tried (Wald 2007). The cost counts blocks of eight, so that leaves come out full. Compiled per
// instruction set.

template <class A>
class Sweep {
 public:
  explicit Sweep(SweepJob& job) : job_(job), n_(job.count) {}

  void run() {
    load();
    if (n_ > TriangleBlock::kSize || !one_leaf(0, n_, order_start_))
      for (int axis = 0; axis < 3; ++axis) sort(axis);
    else
      for (std::uint32_t i = 0; i < n_; ++i) order_[0][i] = static_cast<std::uint8_t>(i);
    nodes_ = 1;
    build(0, n_, job_.depth, 0, 0, job_.cost);
    job_.node_count = nodes_;
  }

 private:
  using F = Simd<float, 4, A>;
  using B = Simd<float, 8, A>;
  using I = Simd<std::int32_t, 16, A>;
  static constexpr std::uint32_t N = kMaxSweep;

  struct alignas(32) Box8 {
    float v[8];  ///< {-lo.xyz, any, hi.xyz, any}
  };

  /// Loads the boxes, halved and scaled to a scene of size 1 by a power of two, which is exact, and the
  /// bounds of centres. Item number and kind in the gaps look like denormals, which are slow to multiply: set
  /// to 0.
  void load() {
    const B unit(0.5f * job_.unit);
    F lo(Centers::kInf), hi(-Centers::kInf);
    for (std::uint32_t i = 0; i < n_; ++i) {
      const B b = select(B::M::from_bits(0x77), B::load(job_.refs[i].negative_lo), B(0.0f)) * unit;
      b.store(box_[i].v);
      const F c = F::load(box_[i].v + 4) - F::load(box_[i].v);
      lo = min(c, lo), hi = max(c, hi);
    }
    lo.store(lo_), hi.store(hi_);
    for (std::uint32_t i = 0; i < TriangleBlock::kSize; ++i) order_start_[i] = static_cast<std::uint8_t>(i);
  }

  /// Sorts the references by centre along each axis into order_[axis]. Keys are unique, so a reference's
  /// place is the number of smaller keys, which is counted in lanes and without branches.
  void sort(int axis) {
    constexpr float kSteps = 0x1p23f - 1;
    const float extent = hi_[axis] - lo_[axis];
    float scale = kSteps / extent;
    if (!(extent > 0 && scale <= std::numeric_limits<float>::max())) scale = 0;
    alignas(64) std::int32_t key[N];
    const std::uint32_t padded = (n_ + 15) / 16 * 16;
    for (std::uint32_t i = 0; i < n_; ++i) {
      // Centres beyond the range of float are infinite, and then all keys are 0: the first operand of
      // std::max is taken for NaN.
      const float c = std::max(0.0f, (box_[i].v[4 + axis] - box_[i].v[axis] - lo_[axis]) * scale);
      key[i] = static_cast<std::int32_t>(c) << 8 | static_cast<std::int32_t>(i);
    }
    for (std::uint32_t i = n_; i < padded; ++i) key[i] = std::numeric_limits<std::int32_t>::max();
    for (std::uint32_t b = 0; b < n_; b += 16) {
      const I own = I::load(key + b), zero(0), one(1);
      I rank(0);
      for (std::uint32_t i = 0; i < n_; ++i) rank = rank + select(I(key[i]) < own, one, zero);
      alignas(64) std::int32_t place[16];
      rank.store(place);
      for (std::uint32_t i = b; i < n_ && i < b + 16; ++i)
        order_[axis][place[i - b]] = static_cast<std::uint8_t>(i);
    }
  }

  /// Whether a range is a leaf: few enough items, all of one kind, and of triangles few enough corners, whose
  /// numbers it notes. Shapes that cost more to test than a node are leaves of their own.
  bool one_leaf(std::uint32_t begin, std::uint32_t end, const std::uint8_t* order) {
    if (end - begin > TriangleBlock::kSize) return false;
    if (packed_end_[begin] == end) return true;
    const std::uint32_t kind = job_.refs[order[begin]].kind;
    if (stands_alone(static_cast<Kind>(kind & 0xff))) return end - begin == 1;
    for (std::uint32_t i = begin + 1; i < end; ++i)
      if (job_.refs[order[i]].kind != kind) return false;
    if (static_cast<Kind>(kind & 0xff) != Kind::triangle) return true;
    if (!pack_corners(order + begin, end - begin, job_.corners + begin)) return false;
    packed_end_[begin] = static_cast<std::uint16_t>(end);
    return true;
  }

  /// Numbers the corners of `count` <= 8 triangles for TriangleBlock::Lists::corners, in the order in which
  /// they come; false if a block does not hold so many. refs[reference[i]] is triangle i.
  bool pack_corners(const std::uint8_t* reference, std::uint32_t count, std::uint16_t* corners) const {
    constexpr std::uint32_t kAll = 3 * TriangleBlock::kSize;
    alignas(64) std::int32_t vertex[32] = {};
    for (std::uint32_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k)
        vertex[3 * i + k] = static_cast<std::int32_t>(job_.vertices[reference[i]].of[k]);
    // A vertex that occurs several times has the number of its first occurrence.
    const I low = I::load(vertex), high = I::load(vertex + 16);
    unsigned first[kAll], firsts = 0;
    for (std::uint32_t i = 0; i < 3 * count; ++i) {
      const I own(vertex[i]);
      first[i] = static_cast<unsigned>(__builtin_ctz(bits(low == own) | bits(high == own) << 16));
      firsts |= static_cast<unsigned>(first[i] == i) << i;
    }
    if (std::popcount(firsts) > TriangleBlock::kCorners) {
      // Vertices with other numbers may stand at the same place.
      std::uint32_t items[TriangleBlock::kSize];
      for (std::uint32_t i = 0; i < count; ++i) items[i] = job_.refs[reference[i]].item;
      return oktett::pack_corners(*job_.triangles, items, static_cast<int>(count), corners);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      int packed = 0;
      for (std::uint32_t k = 0; k < 3; ++k)
        packed |= std::popcount(firsts & ((1u << first[3 * i + k]) - 1)) << 4 * k;
      corners[i] = static_cast<std::uint16_t>(packed);
    }
    return true;
  }

  /// Half the surface of the box with these corners.
  OKTETT_INLINE static float area(const F& negative_lo, const F& hi) {
    alignas(16) float e[4];
    (negative_lo + hi).store(e);
    return e[0] * (e[1] + e[2]) + e[1] * e[2];
  }

  OKTETT_INLINE float scaled_area(const F& negative_lo, const F& hi) const {
    const F half(0.5f * job_.unit), zero(0.0f);
    const auto xyz = F::M::from_bits(7);
    return area(select(xyz, negative_lo, zero) * half, select(xyz, hi, zero) * half);
  }

  /// Node `at` over the range. A range that is one leaf needs to be in order along `axis` only.
  void build(std::uint32_t begin, std::uint32_t end, int depth, int axis, std::uint32_t at,
             SubtreeCost& cost) {
    BinaryNode& node = job_.nodes[at];
    if (one_leaf(begin, end, order_[axis])) return make_leaf(begin, end, order_[axis], node, cost);
    const std::uint32_t middle = split(begin, end, depth, axis);
    const std::uint32_t children = nodes_;
    nodes_ += 2;
    SubtreeCost l, r;
    build(begin, middle, depth + 1, axis, children, l);
    build(middle, end, depth + 1, axis, children + 1, r);
    const BinaryNode &a = job_.nodes[children], &b = job_.nodes[children + 1];
    const F lo = max(F::load(a.negative_lo), F::load(b.negative_lo)), hi = max(F::load(a.hi), F::load(b.hi));
    lo.store(node.negative_lo), hi.store(node.hi);
    node.link = children;
    node.info = collapse(l, r, scaled_area(lo, hi), cost);
  }

  void make_leaf(std::uint32_t begin, std::uint32_t end, const std::uint8_t* order, BinaryNode& node,
                 SubtreeCost& cost) {
    B box = B::load(job_.refs[order[begin]].negative_lo);
    for (std::uint32_t i = begin; i < end; ++i) {
      box = max(B::load(job_.refs[order[i]].negative_lo), box);
      job_.items[i] = job_.refs[order[i]].item;
    }
    box.store(node.negative_lo);
    const std::uint32_t count =
        job_.pieces ? distinct(job_.items + begin, job_.corners + begin, end - begin) : end - begin;
    cost = leaf_cost(scaled_area(F::load(node.negative_lo), F::load(node.hi)));
    node.link = job_.first + begin;
    node.info = BinaryNode::leaf_info(count, job_.refs[order[begin]].kind);
  }

  /// Removes repeated items and their corners; returns the number of items left.
  static std::uint32_t distinct(std::uint32_t* items, std::uint16_t* corners, std::uint32_t count) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      bool seen = false;
      for (std::uint32_t k = 0; k < kept; ++k) seen |= items[k] == items[i];
      if (!seen) items[kept] = items[i], corners[kept++] = corners[i];
    }
    return kept;
  }

  /// Orders the range so that the left part comes first, at least along `axis`; returns where the right one
  /// begins.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, int depth, int& axis) {
    const std::uint32_t n = end - begin;
    if (n <= TriangleBlock::kSize) {
      const std::uint32_t kind = job_.refs[order_[0][begin]].kind;
      std::uint32_t same = 0;
      for (std::uint32_t i = begin; i < end; ++i) {
        side_[order_[0][i]] = job_.refs[order_[0][i]].kind == kind;
        same += side_[order_[0][i]];
      }
      if (same < n) {
        for (int k = 0; k < 3; ++k) divide(k, begin, end);
        return begin + same;
      }
    }
    axis = 0;
    std::uint32_t middle = begin + balanced_half(n);
    if (depth + kLog < kMaxDepth) find(begin, end, axis, middle);
    if (one_leaf(begin, middle, order_[axis]) && one_leaf(middle, end, order_[axis])) return middle;
    for (std::uint32_t i = begin; i < end; ++i) side_[order_[axis][i]] = i < middle;
    for (int k = 0; k < 3; ++k)
      if (k != axis) divide(k, begin, end);
    return middle;
  }

  /// Boxes that grow along the three orders.
  struct Growing {
    F lo[3], hi[3];
    OKTETT_INLINE Growing() {
      for (int axis = 0; axis < 3; ++axis) lo[axis] = hi[axis] = F(-Centers::kInf);
    }
    OKTETT_INLINE void grow(int axis, const Box8& b) {
      lo[axis] = max(F::load(b.v), lo[axis]), hi[axis] = max(F::load(b.v + 4), hi[axis]);
    }
    /// In lane k the area of the box of order k.
    OKTETT_INLINE F areas() const {
      F x = lo[0] + hi[0], y = lo[1] + hi[1], z = lo[2] + hi[2];
      transpose3(x, y, z);
      return x * (y + z) + y * z;
    }
  };

  /// The split of least cost; of equally good ones in the first half, the most balanced.
  void find(std::uint32_t begin, std::uint32_t end, int& best_axis, std::uint32_t& best_middle) {
    const std::uint32_t n = end - begin, step = n > job_.effort.every_place ? TriangleBlock::kSize - 1 : 0;
    const bool instances = n <= TriangleBlock::kSize;
    const auto wanted = [&](std::uint32_t p) { return ((end - p) & step) == 0 || ((p - begin) & step) == 0; };
    const auto blocks = [&](std::uint32_t k) { return F(static_cast<float>(instances ? k : blocks_of(k))); };
    Growing right;
    for (std::uint32_t p = end; --p > begin;) {
      for (int axis = 0; axis < 3; ++axis) right.grow(axis, box_[order_[axis][p]]);
      if (wanted(p)) right.areas().store(right_area_[p]);
    }
    Growing left;
    F best(Centers::kInf), place(0.0f);
    const auto scan = [&](std::uint32_t from, std::uint32_t to, auto&& better) {
      for (std::uint32_t p = from; p < to; ++p) {
        for (int axis = 0; axis < 3; ++axis) left.grow(axis, box_[order_[axis][p - 1]]);
        if (!wanted(p)) continue;
        const F cost = left.areas() * blocks(p - begin) + F::load(right_area_[p]) * blocks(end - p);
        const auto take = better(cost, best);
        best = select(take, cost, best);
        place = select(take, F(static_cast<float>(p)), place);
      }
    };
    const std::uint32_t half = begin + n / 2 + 1;
    scan(begin + 1, half, [](const F& a, const F& b) { return a <= b; });
    scan(half, end, [](const F& a, const F& b) { return a < b; });
    alignas(16) float cost[4], at[4];
    best.store(cost), place.store(at);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0 && !(cost[axis] < cost[best_axis])) continue;
      best_axis = axis, best_middle = static_cast<std::uint32_t>(at[axis]);
    }
  }

  /// Moves those marked in side_ to the front of one order, which stays sorted on both sides.
  void divide(int axis, std::uint32_t begin, std::uint32_t end) {
    std::uint8_t* order = order_[axis];
    std::uint8_t rest[N];
    std::uint32_t l = begin, r = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint8_t k = order[i];
      order[l] = k, rest[r] = k;
      l += side_[k], r += 1 - side_[k];
    }
    for (std::uint32_t i = 0; i < r; ++i) order[l + i] = rest[i];
  }

  static constexpr int kLog = 14;  ///< levels that halving the largest range and telling kinds apart can take

  SweepJob& job_;
  const std::uint32_t n_;
  std::uint32_t nodes_ = 0;
  alignas(32) Box8 box_[N];
  alignas(16) float lo_[4], hi_[4];
  alignas(16) float right_area_[N][4];  ///< by axis
  std::uint8_t order_[3][N], side_[N], order_start_[TriangleBlock::kSize];
  std::uint16_t packed_end_[N] = {};  ///< where the range from here ends whose corners job_.corners holds
};

// ---- Binning and partitioning.

template <class A>
struct BuildCode {
  using F = Simd<float, 4, A>;
  using B = Simd<float, 8, A>;

  // Item number and kind in the gaps of a reference look like denormals, which are slow to multiply: set to
  // 0.

  /// (centre - origin) * scale, clamped to [0, bins - 1].
  struct Cell {
    F origin, scale, last;
    explicit OKTETT_INLINE Cell(const Grid& g)
        : origin(F::load(g.origin)), scale(F::load(g.scale)), last(static_cast<float>(g.bins - 1)) {}
    OKTETT_INLINE F operator()(const PrimRef& r) const {
      const F c = center(r);
      return min(max((c - origin) * scale, F(0.0f)), last);
    }
  };
  /// Twice the centre.
  OKTETT_INLINE static F center(const PrimRef& r) {
    return select(F::M::from_bits(7), F::load(r.hi) - F::load(r.negative_lo), F(0.0f));
  }

  /// Which side of a plane a reference is on, as its bin says.
  struct Side {
    int axis;
    float plane, origin, scale;
    OKTETT_INLINE Side(const Grid& g, const Split& s)
        : axis(s.axis),
          plane(static_cast<float>(s.bin + 1)),
          origin(g.origin[s.axis]),
          scale(g.scale[s.axis]) {}
    OKTETT_INLINE bool is_left(const PrimRef& r) const {
      return (r.hi[axis] - r.negative_lo[axis] - origin) * scale < plane;
    }
  };

  static void bin(const BinJob& job) {
    // Successive references tend to fall into the same bin, and reading what was just written is slow: two
    // sets of bins take turns.
    Bins other;
    Bins* const sets[2] = {job.out, &other};
    const B empty(-std::numeric_limits<float>::infinity());
    const int bins = job.grid.bins;
    for (Bins* out : sets)
      for (int axis = 0; axis < 3; ++axis)
        for (int b = 0; b < bins; ++b) empty.store(out->box[axis][b].v), out->count[axis][b] = 0;
    const Cell cell(job.grid);
    const auto add = [&](const PrimRef& r, Bins& out) {
      const B box = B::load(r.negative_lo);
      alignas(16) float c[4];
      cell(r).store(c);
      for (int axis = 0; axis < 3; ++axis) {
        const auto b = static_cast<std::uint64_t>(static_cast<std::int64_t>(c[axis]));
        float* v = out.box[axis][b].v;
        max(box, B::load(v)).store(v);
        ++out.count[axis][b];
      }
    };
    const PrimRef* const refs = job.refs;
    const std::size_t step = job.every == 1 ? job.count : job.every * kBinGroup;
    for (std::size_t begin = 0; begin < job.count; begin += step) {
      const std::size_t end = std::min(job.count, job.every == 1 ? job.count : begin + kBinGroup);
      std::size_t i = begin;
      for (; i + 1 < end; i += 2) add(refs[i], *job.out), add(refs[i + 1], other);
      if (i < end) add(refs[i], other);
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int b = 0; b < bins; ++b) {
        float* v = job.out->box[axis][b].v;
        max(B::load(other.box[axis][b].v), B::load(v)).store(v);
        job.out->count[axis][b] += other.count[axis][b];
      }
  }

  static std::size_t count_left(const CountJob& job) {
    const Side side(job.grid, job.split);
    std::size_t left = 0;
    for (std::size_t i = 0; i < job.count; ++i) left += static_cast<std::size_t>(side.is_left(job.refs[i]));
    return left;
  }

  static void bound(const PrimRef* refs, std::size_t count, Centers& out) {
    F lo[2] = {F::load(out.lo), F::load(out.lo)}, hi[2] = {F::load(out.hi), F::load(out.hi)};
    std::size_t i = 0;
    for (; i + 1 < count; i += 2)
      for (int k = 0; k < 2; ++k) {
        const F c = center(refs[i + k]);
        lo[k] = min(c, lo[k]), hi[k] = max(c, hi[k]);
      }
    if (i < count) {
      const F c = center(refs[i]);
      lo[0] = min(c, lo[0]), hi[0] = max(c, hi[0]);
    }
    min(lo[0], lo[1]).store(out.lo), max(hi[0], hi[1]).store(out.hi);
  }

  static void partition(PartitionJob& job) {
    constexpr std::size_t kPiece = 256;  // bounds are computed of pieces that are still in the cache
    const Side side(job.grid, job.split);
    const PrimRef* const refs = job.refs;
    const std::size_t count = job.count;
    // Places count from job.left.
    std::ptrdiff_t left = 0, right = job.right - job.left;
    for (std::size_t i = 0; i < count;) {
      const std::ptrdiff_t left_begin = left, right_end = right;
      const std::size_t end = count - i > kPiece ? i + kPiece : count;
      for (; i < end; ++i) {
        // Without a branch, which would be mispredicted half the time.
        const std::ptrdiff_t is_left = side.is_left(refs[i]);
        const std::ptrdiff_t to = (right - 1) ^ (((right - 1) ^ left) & -is_left);
        B::load(refs[i].negative_lo).store(job.left[to].negative_lo);
        left += is_left, right += is_left - 1;
      }
      bound(job.left + left_begin, static_cast<std::size_t>(left - left_begin), job.centers[0]);
      bound(job.left + right, static_cast<std::size_t>(right_end - right), job.centers[1]);
    }
    job.lefts = static_cast<std::size_t>(left);
  }

  static void sweep(SweepJob& job) { Sweep<A>(job).run(); }
};

template <class A>
const BuildKernels& build_kernels() {
  static constexpr BuildKernels kernels = {BuildCode<A>::bin, BuildCode<A>::count_left, BuildCode<A>::bound,
                                           BuildCode<A>::partition, BuildCode<A>::sweep};
  return kernels;
}

}  // namespace oktett
