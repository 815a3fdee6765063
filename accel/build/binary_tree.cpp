/// \file From references to a binary tree, top-down: binned splits of large ranges (Wald 2007), sweeps of
/// small ones.

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "accel/build/build_arrays.h"
#include "accel/build/sah.h"
#include "accel/build/spatial.h"
#include "accel/build/wide_tree.h"
#include "core/parallel.h"
#include "core/phase.h"

namespace oktett {

/// Hands out the nodes of a build to threads. Their pages are allocated piece by piece, shortly before they
/// are written.
class NodeSupply {
 public:
  explicit NodeSupply(const BuildArrays& arrays) : arrays_(arrays) { populate_piece(0); }

  BinaryNode& operator[](std::size_t i) const { return arrays_.nodes[i]; }

  /// The first of `count` new nodes.
  std::uint32_t take(std::uint32_t count) {
    const std::uint32_t first = taken_.fetch_add(count);
    // The thread that reaches a new piece has its pages allocated.
    const std::size_t piece = (first + count) / kPiece;
    if (first / kPiece != piece) populate_piece(piece);
    return first;
  }

 private:
  static constexpr std::size_t kPiece = (std::size_t{1} << 17) / sizeof(BinaryNode);

  void populate_piece(std::size_t piece) const {
    const std::size_t begin = std::min(piece * kPiece, arrays_.node_room);
    arrays_.populate(arrays_.nodes + begin, std::min(kPiece, arrays_.node_room - begin), false);
  }

  const BuildArrays& arrays_;
  std::atomic<std::uint32_t> taken_{0};
};

// ---- References in the order of a space-filling curve, for the fast build.

/// Bits of a cell's number: seven per axis, interleaved (Morton 1966).
inline constexpr int kMortonBits = 21;

namespace {

constexpr std::size_t kLeastKeys = 1u << 13, kMostKeyChunks = 32;
constexpr int kDigit = 11;  ///< bits sorted by in one pass
constexpr std::uint32_t kDigits = 1u << kDigit;

/// Bits 0-6 to every third place.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 8) & 0x0000700fu;
  v = (v | v << 4) & 0x000430c3u;
  return (v | v << 2) & 0x00049249u;
}

/// One pass of a stable counting sort: each chunk counts its digits, then moves its keys to places of its
/// own.
void sort_pass(const Chunks& chunks, bool parallel, const CellKey* from, int shift, CellKey* to) {
  std::vector<std::uint32_t> next(chunks.count * kDigits, 0);
  const auto digit = [&](const CellKey& k) { return k.cell >> shift & (kDigits - 1); };
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++next[c * kDigits + digit(from[i])];
  });
  std::uint32_t sum = 0;
  for (std::uint32_t d = 0; d < kDigits; ++d)
    for (std::size_t c = 0; c < chunks.count; ++c) {
      const std::uint32_t n = next[c * kDigits + d];
      next[c * kDigits + d] = sum;
      sum += n;
    }
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) to[next[c * kDigits + digit(from[i])]++] = from[i];
  });
}

}  // namespace

/// Copies the references to arrays.more_refs in the order of the cells that their centres lie in, of a
/// cubic grid over `centers`, and sets arrays.cells. References of one cell keep their order.
static void sort_by_cells(const BuildArrays& arrays, const Centers& centers, bool parallel) {
  const std::size_t count = arrays.count;
  const Chunks chunks(count, kLeastKeys, kMostKeyChunks);
  const PrimRef* const refs = arrays.refs;
  CellKey* const keys = arrays.keys;
  constexpr float kPerAxis = 1 << kMortonBits / 3;
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, centers.hi[k] - centers.lo[k]);
  float scale = kPerAxis / extent;
  if (!(extent > 0 && std::isfinite(extent) && std::isfinite(scale))) scale = 0;
  arrays.populate(keys, count, parallel), arrays.populate(arrays.more_keys, count, parallel);
  chunks.each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t cell = 0;
      for (int k = 0; k < 3; ++k) {
        const float c = (refs[i].hi[k] - refs[i].negative_lo[k] - centers.lo[k]) * scale;
        // NaN, from infinite bounds, is cell 0.
        const float inside = c > 0 ? std::min(c, kPerAxis - 1) : 0;
        cell |= spread(static_cast<std::uint32_t>(inside)) << (2 - k);
      }
      keys[i] = {cell, static_cast<std::uint32_t>(i)};
    }
  });
  sort_pass(chunks, parallel, keys, 0, arrays.more_keys);
  sort_pass(chunks, parallel, arrays.more_keys, kDigit, keys);
  arrays.populate(arrays.cells, count, parallel);
  chunks.each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      arrays.more_refs[i] = refs[keys[i].place], arrays.cells[i] = keys[i].cell;
  });
}

namespace {

/// Smaller ranges are built by one task. In ranges above kParallelSplit binning and partitioning are tasks
/// too, of at most kMaxChunks chunks.
constexpr std::size_t kParallelTask = 4096;
constexpr std::size_t kParallelSplit = 1u << 15;
constexpr std::size_t kMinChunk = 1u << 13;
constexpr std::size_t kMaxChunks = 64;
/// About so many references of a range are binned to find a plane, but no fewer than one in kMostSkipped.
/// More find no better plane.
constexpr std::size_t kSampled = 1u << 13;
constexpr std::size_t kMostSkipped = 8;
/// The same of those that are sliced to find a spatial split, which takes several times as long.
constexpr std::size_t kSliced = 1u << 10;
constexpr std::size_t kMostUnsliced = 32;

/// A spatial split is tried only if the children of the best object split overlap by more than this part of
/// the scene's surface (Stich et al. 2009, section 4.5).
constexpr double kLeastOverlap = 1e-3;

/// Half the surface of a box in the {-lo, hi} form, scaled.
float half_area(const float* negative_lo, const float* hi, float unit) {
  float e[3];
  for (int k = 0; k < 3; ++k) e[k] = (negative_lo[k] * 0.5f + hi[k] * 0.5f) * unit;
  return e[0] * (e[1] + e[2]) + e[1] * e[2];
}

/// The union of bins.
struct Extent {
  float v[8];
  Extent() { std::fill_n(v, 8, -Centers::kInf); }
  void grow(const float* b) {
    for (int k = 0; k < 8; ++k) v[k] = b[k] > v[k] ? b[k] : v[k];
  }
  float area(float unit) const { return half_area(v, v + 4, unit); }
  Box box() const { return {{-v[0], -v[1], -v[2]}, {v[4], v[5], v[6]}}; }
};

/// A range of references in `from`. Its children are written to [first, last) of `to`, which has room for
/// references that spatial splits add; their children are written to the same place of `from`.
struct Range {
  std::size_t begin = 0, end = 0;
  PrimRef *from = nullptr, *to = nullptr;
  Centers centers;
  std::size_t first = begin, last = end;
  std::size_t size() const { return end - begin; }
  std::size_t room() const { return last - first; }
};

class Builder {
 public:
  Builder(const BuildArrays& arrays, const TriangleSource& triangles, const Box& bounds,
          const BuildOptions& options, const BuildKernels& kernels, const TreePart& part)
      : arrays_(arrays),
        triangles_(triangles),
        unit_(scene_unit(bounds)),
        least_overlap_(kLeastOverlap * half_area(bounds)),
        effort_(effort_of(options.quality)),
        parallel_(options.parallel),
        kernels_(kernels),
        phase_("building the tree", part.name, arrays.count),
        depth_(part.depth),
        nodes_(arrays) {}

  BinaryTree run() {
    const std::size_t n = arrays_.count;
    arrays_.populate(arrays_.items, n, parallel_);
    arrays_.populate(arrays_.corners, n, parallel_);
    if (n > effort_.sweep) arrays_.populate(arrays_.more_refs, n, parallel_);
    nodes_.take(1);
    // The arrays may have been made for more.
    Range all{0, n, arrays_.refs, arrays_.more_refs, {}, 0, std::min(room_for(n, effort_), arrays_.room)};
    bound(all);
    SubtreeCost cost;
    if (effort_.cells && n > effort_.sweep) {
      sort_by_cells(arrays_, all.centers, parallel_);
      std::swap(all.from, all.to);
      build_cells(all, depth_, 0, cost);
    } else {
      build(all, depth_, 0, cost);
    }
    return {arrays_.nodes, arrays_.items, arrays_.corners, pieces_};
  }

 private:
  void bound(Range& r) const {
    if (r.size() <= effort_.sweep) return;
    const Chunks chunks(r.size(), kMinChunk, kMaxChunks);
    std::vector<Centers> parts(chunks.count);
    chunks.each(parallel_, [&](std::size_t c, std::size_t begin, std::size_t end) {
      kernels_.bound(r.from + r.begin + begin, end - begin, parts[c]);
    });
    for (const Centers& p : parts) r.centers.grow(p);
  }

  void build(const Range& r, int depth, std::uint32_t at, SubtreeCost& cost) {
    if (r.size() <= effort_.sweep) return sweep(r, depth, at, cost);
    Range left, right;
    split(r, depth, left, right);
    build_children(left, right, at, cost, [&](const Range& side, std::uint32_t child, SubtreeCost& c) {
      build(side, depth + 1, child, c);
    });
  }

  /// Builds a range that is sorted by cells: splits it where the highest bit of their numbers changes, which
  /// halves space (Lauterbach et al. 2009). Ranges within one cell are built by build().
  void build_cells(Range& r, int depth, std::uint32_t at, SubtreeCost& cost) {
    if (r.size() <= effort_.sweep) return sweep(r, depth, at, cost);
    const std::uint32_t *first = arrays_.cells + r.begin, *last = arrays_.cells + r.end - 1;
    if (*first == *last) {
      bound(r);
      return build(r, depth, at, cost);
    }
    const int bit = std::bit_width(*first ^ *last) - 1;
    const std::uint32_t upper = *last >> bit << bit;
    const auto middle = static_cast<std::size_t>(std::lower_bound(first, last, upper) - arrays_.cells);
    Range left{r.begin, middle, r.from, r.to, {}}, right{middle, r.end, r.from, r.to, {}};
    build_children(left, right, at, cost, [&](Range& side, std::uint32_t child, SubtreeCost& c) {
      build_cells(side, depth + 1, child, c);
    });
  }

  /// Builds both sides by `build_side`, then the node above them.
  template <class BuildSide>
  void build_children(Range& left, Range& right, std::uint32_t at, SubtreeCost& cost,
                      const BuildSide& build_side) {
    const std::uint32_t children = nodes_.take(2);
    SubtreeCost l, rr;
    if (parallel_ && left.size() + right.size() >= kParallelTask) {
      tbb::parallel_invoke([&] { build_side(left, children, l); },
                           [&] { build_side(right, children + 1, rr); });
    } else {
      build_side(left, children, l);
      build_side(right, children + 1, rr);
    }
    BinaryNode& node = nodes_[at];
    const BinaryNode &a = nodes_[children], &b = nodes_[children + 1];
    for (int k = 0; k < 3; ++k) {
      node.negative_lo[k] = std::max(a.negative_lo[k], b.negative_lo[k]);
      node.hi[k] = std::max(a.hi[k], b.hi[k]);
    }
    node.link = children;
    node.info = collapse(l, rr, half_area(node.negative_lo, node.hi, unit_), cost);
  }

  void sweep(const Range& r, int depth, std::uint32_t at, SubtreeCost& cost) {
    BinaryNode nodes[2 * kMaxSweep];
    VertexNumbers vertices[kMaxSweep];
    SweepJob job;
    job.refs = r.from + r.begin;
    job.count = static_cast<std::uint32_t>(r.size());
    triangles_.note_vertices(job.refs, job.count, vertices);
    job.triangles = &triangles_, job.vertices = vertices;
    job.first = static_cast<std::uint32_t>(r.begin);
    job.items = arrays_.items + r.begin;
    job.corners = arrays_.corners + r.begin;
    job.depth = depth;
    job.unit = unit_;
    job.effort = effort_;
    job.pieces = pieces_;  // set before the ranges below a spatial split are built
    job.nodes = nodes;
    kernels_.sweep(job);
    phase_.add(r.size());
    cost = job.cost;
    const std::uint32_t rest = nodes_.take(job.node_count - 1);
    for (std::uint32_t i = 0; i < job.node_count; ++i) {
      BinaryNode& to = nodes_[i == 0 ? at : rest + i - 1];
      to = nodes[i];
      if (!to.is_leaf()) to.link += rest - 1;
    }
  }

  void split(const Range& r, int depth, Range& left, Range& right) {
    Grid grid;
    grid.bins = effort_.bins;
    for (int k = 0; k < 3; ++k) {
      const float extent = r.centers.hi[k] - r.centers.lo[k];
      const float scale = static_cast<float>(grid.bins) / extent;
      grid.origin[k] = r.centers.lo[k];
      grid.scale[k] = extent > 0 && std::isfinite(scale) && std::isfinite(extent) ? scale : 0;
    }
    const Chunks chunks =
        r.size() >= kParallelSplit ? Chunks(r.size(), kMinChunk, kMaxChunks) : Chunks(r.size(), r.size());
    std::vector<Bins> more(chunks.count - 1);
    Bins first;
    const auto bins = [&](std::size_t c) -> Bins& { return c == 0 ? first : more[c - 1]; };
    const std::size_t every = std::clamp<std::size_t>(r.size() / kSampled, 1, kMostSkipped);
    Split best;
    // The remaining depth must suffice for splits in half.
    if (depth + std::bit_width(r.size()) + 7 < kMaxDepth) {
      chunks.each(parallel_, [&](std::size_t c, std::size_t begin, std::size_t end) {
        kernels_.bin({r.from + r.begin + begin, end - begin, grid, &bins(c), every});
      });
      best = find(grid, chunks.count, bins);
    }
    if (effort_.spatial > 0 && best.axis >= 0 &&
        split_space(r, grid, best, chunks.count, bins, every, left, right))
      return;
    if (best.axis >= 0) return partition(r, grid, best, chunks, left, right);
    const std::size_t half = balanced_half(r.size());
    PrimRef *const from = r.from + r.begin, *const middle = from + half;
    std::copy(from, middle, r.to + r.first);
    std::copy(middle, r.from + r.end, r.to + r.last - (r.size() - half));
    share_room(r, half, r.size() - half, left, right);
    bound(left), bound(right);
  }

  /// The children of `r`, at either end of its place in `to`. They share the free room between them in
  /// proportion to their sizes.
  static void share_room(const Range& r, std::size_t l, std::size_t rr, Range& left, Range& right) {
    const std::size_t spare = r.room() - l - rr;
    const std::size_t middle = r.first + l +
                               static_cast<std::size_t>(static_cast<double>(spare) * static_cast<double>(l) /
                                                        static_cast<double>(l + rr));
    left = {r.first, r.first + l, r.to, r.from, {}, r.first, middle};
    right = {r.last - rr, r.last, r.to, r.from, {}, middle, r.last};
  }

  /// Makes a spatial split if the children of the object split `object` would overlap and it costs less.
  template <class BinsOf>
  bool split_space(const Range& r, const Grid& grid, const Split& object, std::size_t chunks,
                   const BinsOf& bins, std::size_t every, Range& left, Range& right) {
    if (r.room() == r.size()) return false;
    Extent side[2];
    for (std::size_t c = 0; c < chunks; ++c)
      for (int b = 0; b < grid.bins; ++b) side[b > object.bin].grow(bins(c).box[object.axis][b].v);
    Box all = side[0].box(), overlap = all;
    const Box other = side[1].box();
    all.grow(other);
    overlap.lo = max(overlap.lo, other.lo), overlap.hi = min(overlap.hi, other.hi);
    const double area = half_area(overlap);
    if (!(area > least_overlap_) || area < effort_.overlap * half_area(all)) return false;
    const auto blocks = [&](bool on_right) {
      return blocks_of(static_cast<std::uint32_t>(every) * count_of(object, on_right, grid, chunks, bins));
    };
    const double object_cost = half_area(side[0].box()) * blocks(false) + half_area(other) * blocks(true);
    // `best` looks at all.
    const std::size_t sliced =
        effort_.every_axis ? 1 : std::clamp<std::size_t>(r.size() / kSliced, 1, kMostUnsliced);
    const SpatialSplit s =
        find_spatial(r.from + r.begin, r.size(), all, triangles_, {effort_.every_axis, sliced, parallel_});
    if (s.axis < 0 || !(s.cost < object_cost)) return false;
    const SpatialParts parts = partition_spatial(r.from + r.begin, r.size(), r.room(), s, triangles_,
                                                 parallel_, r.to + r.first, r.to + r.last);
    if (parts.left == 0) return false;
    if (parts.left + parts.right > r.size()) pieces_ = true;
    share_room(r, parts.left, parts.right, left, right);
    bound(left), bound(right);
    return true;
  }

  template <class BinsOf>
  static std::uint32_t count_of(const Split& s, bool right, const Grid& grid, std::size_t chunks,
                                const BinsOf& bins) {
    std::uint32_t n = 0;
    for (std::size_t c = 0; c < chunks; ++c)
      for (int b = right ? s.bin + 1 : 0; b < (right ? grid.bins : s.bin + 1); ++b)
        n += bins(c).count[s.axis][b];
    return n;
  }

  /// The plane of least surface-area cost.
  template <class BinsOf>
  Split find(const Grid& grid, std::size_t chunks, const BinsOf& bins) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (grid.scale[axis] == 0) continue;
      Extent box[kMaxBins];
      std::uint32_t count[kMaxBins] = {};
      for (std::size_t c = 0; c < chunks; ++c)
        for (int b = 0; b < grid.bins; ++b)
          box[b].grow(bins(c).box[axis][b].v), count[b] += bins(c).count[axis][b];
      float right_cost[kMaxBins];
      Extent side;
      std::uint32_t n = 0;
      for (int b = grid.bins - 1; b > 0; --b) {
        side.grow(box[b].v), n += count[b];
        right_cost[b] = n > 0 ? side.area(unit_) * static_cast<float>(blocks_of(n)) : Centers::kInf;
      }
      side = {}, n = 0;
      for (int b = 0; b + 1 < grid.bins; ++b) {
        side.grow(box[b].v), n += count[b];
        if (n == 0) continue;
        const float cost = side.area(unit_) * static_cast<float>(blocks_of(n)) + right_cost[b + 1];
        if (cost < best.cost) best = {axis, b, cost};
      }
    }
    return best;
  }

  void partition(const Range& r, const Grid& grid, const Split& s, const Chunks& chunks, Range& left,
                 Range& right) {
    std::vector<std::size_t> lefts(chunks.count + 1, 0);
    if (chunks.count > 1)
      chunks.each(parallel_, [&](std::size_t c, std::size_t begin, std::size_t end) {
        lefts[c + 1] = kernels_.count_left({r.from + r.begin + begin, end - begin, grid, s});
      });
    for (std::size_t c = 0; c < chunks.count; ++c) lefts[c + 1] += lefts[c];
    std::vector<PartitionJob> jobs(chunks.count);
    chunks.each(parallel_, [&](std::size_t c, std::size_t begin, std::size_t end) {
      PartitionJob& job = jobs[c];
      job.refs = r.from + r.begin + begin;
      job.count = end - begin;
      job.left = r.to + r.first + lefts[c];
      job.right = r.to + r.last - (begin - lefts[c]);
      job.grid = grid, job.split = s;
      kernels_.partition(job);
    });
    std::size_t all_left = 0;
    for (const PartitionJob& job : jobs) all_left += job.lefts;
    share_room(r, all_left, r.size() - all_left, left, right);
    for (const PartitionJob& job : jobs)
      left.centers.grow(job.centers[0]), right.centers.grow(job.centers[1]);
  }

  const BuildArrays& arrays_;
  const TriangleSource& triangles_;
  float unit_;
  double least_overlap_;
  const Effort effort_;
  const bool parallel_;
  std::atomic<bool> pieces_{false};  ///< some item has several references
  const BuildKernels& kernels_;
  Phase phase_;
  const int depth_;
  NodeSupply nodes_;
};

}  // namespace

Effort effort_of(BuildQuality quality) {
  if (quality == BuildQuality::fast) return {8, 256, 32, true, 0, 0, false};
  // In scanned meshes the overlap stays below 0.3, so that they are built without spatial splits; in
  // buildings it is greater near the root, where a split gains most.
  if (quality != BuildQuality::best) return {16, 256, 64, false, 0.3, 0.4, false};
  return {32, 32, 32, false, 0.3, 0, true};
}

bool pack_corners(const TriangleSource& triangles, const std::uint32_t* items, int count,
                  std::uint16_t* corners) {
  return triangles.pack_corners(items, count, corners);
}

float scene_unit(const Box& bounds) {
  float size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, bounds.hi[k] * 0.5f - bounds.lo[k] * 0.5f);
  if (!(size > 0 && std::isfinite(size))) return 1;
  return std::ldexp(1.0f, -std::clamp(std::ilogb(size), -126, 126));
}

BinaryTree build_binary(const BuildArrays& arrays, const TriangleSource& triangles, const Box& bounds,
                        const BuildOptions& options, const BuildKernels& kernels, const TreePart& part) {
  return Builder(arrays, triangles, bounds, options, kernels, part).run();
}

}  // namespace oktett
