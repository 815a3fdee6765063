#include "accel/build/build_parts.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "accel/build/build_arrays.h"
#include "accel/build/tree_store.h"
#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// The number of a reference's part; kLeftOut: it is in none, as it is not finite.
using PartNumber = std::uint8_t;
constexpr PartNumber kLeftOut = 255;
constexpr std::size_t kMostParts = 255;
/// A part may always have a 128th of all references, so that there are not too many parts.
constexpr std::size_t kLeastShare = 128;
/// A division leaves each side at least an eighth of the most that a part may have, where that is possible.
constexpr std::size_t kLeastSide = 8;

/// Levels of nodes that stand over the parts at most.
constexpr int kTopLevels = 20;

// ---- The references, made anew each time they are read: they take more memory than the triangles.

class References {
 public:
  References(const Accel& accel, const MeshSource& source, const std::vector<std::uint32_t>& meshes,
             const Column<PrimRef>& others)
      : source_(source), others_(others) {
    for (const std::uint32_t g : meshes) {
      const std::uint32_t first = accel.first_item[g];
      add_spans(g, first, accel.first_item[g + 1] - first);
    }
    add_spans(kNoId, 0, others.size());
  }

  /// How many there are, those that are not finite included.
  std::size_t size() const { return size_; }

  /// Calls f(span, refs, count, number_of) for each span of references, in parallel; number_of(refs[i]) is
  /// the number of a reference, which counts those that are left out as well.
  template <class F>
  void each(bool parallel, F&& f) const {
    Chunks(spans_.size(), 1).each(parallel, [&](std::size_t s, std::size_t, std::size_t) { visit(s, f); });
  }

  /// The same for the spans that hold a reference of a part; `numbers` are the parts of all.
  template <class F>
  void each_of(PartNumber part, const Column<PartNumber>& numbers, bool parallel, F&& f) const {
    Chunks(spans_.size(), 1).each(parallel, [&](std::size_t s, std::size_t, std::size_t) {
      if (std::memchr(&numbers[spans_[s].first], part, spans_[s].count) != nullptr) visit(s, f);
    });
  }

  std::size_t spans() const { return spans_.size(); }
  /// The numbers of the references of a span.
  std::pair<std::size_t, std::size_t> range(std::size_t span) const {
    return {spans_[span].first, spans_[span].first + spans_[span].count};
  }

 private:
  static constexpr std::size_t kSpan = 1024;

  struct Span {
    std::uint32_t geometry;    ///< kNoId: others
    std::uint32_t first_item;  ///< of its first triangle
    std::size_t begin, count;  ///< of the triangles of the mesh, or of the others
    std::size_t first;         ///< number of its first reference
  };

  template <class F>
  void visit(std::size_t s, F& f) const {
    const Span& span = spans_[s];
    if (span.geometry == kNoId) {
      const PrimRef* const refs = &others_[span.begin];
      return f(s, refs, span.count,
               [&](const PrimRef& ref) { return span.first + static_cast<std::size_t>(&ref - refs); });
    }
    PrimRef refs[kSpan];
    Box bounds;
    const std::size_t count =
        source_.references(span.geometry, span.begin, span.begin + span.count, refs, bounds);
    f(s, static_cast<const PrimRef*>(refs), count,
      [&](const PrimRef& ref) { return span.first + (ref.item - span.first_item); });
  }

  void add_spans(std::uint32_t geometry, std::uint32_t first_item, std::size_t count) {
    for (std::size_t begin = 0; begin < count; begin += kSpan) {
      const std::size_t size = std::min(kSpan, count - begin);
      spans_.push_back({geometry, first_item + static_cast<std::uint32_t>(begin), begin, size, size_});
      size_ += size;
    }
  }

  const MeshSource& source_;
  const Column<PrimRef>& others_;
  std::vector<Span> spans_;
  std::size_t size_ = 0;
};

// ---- Dividing.

/// A box in the form of PrimRef.
struct CellBox {
  float negative_lo[3] = {-Centers::kInf, -Centers::kInf, -Centers::kInf};
  float hi[3] = {-Centers::kInf, -Centers::kInf, -Centers::kInf};

  template <class Other>
  void grow(const Other& o) {
    for (int k = 0; k < 3; ++k) {
      negative_lo[k] = std::max(negative_lo[k], o.negative_lo[k]);
      hi[k] = std::max(hi[k], o.hi[k]);
    }
  }
  Box box() const { return {{-negative_lo[0], -negative_lo[1], -negative_lo[2]}, {hi[0], hi[1], hi[2]}}; }
  double area() const {
    const auto edge = [&](int k) { return static_cast<double>(hi[k]) + static_cast<double>(negative_lo[k]); };
    return edge(0) * (edge(1) + edge(2)) + edge(1) * edge(2);
  }
};

/// A cell of a grid: what the references with their centres in it take.
struct Cell {
  CellBox box;
  std::uint64_t count = 0;
  std::uint8_t at[3] = {};
};

constexpr int kCells = 64;  ///< along each axis
constexpr std::size_t kAllCells = std::size_t{kCells} * kCells * kCells;

std::size_t number_of_cell(const std::uint8_t (&at)[3]) {
  return (std::size_t{at[0]} * kCells + at[1]) * kCells + at[2];
}

class Divider {
 public:
  Divider(const References& references, std::size_t most, bool parallel)
      : references_(references),
        most_(most),
        parallel_(parallel),
        numbers_(filled_column<PartNumber>(references.size(), kLeftOut)) {}

  /// Grows `bounds` by all references. Returns the sizes of the parts.
  std::vector<std::size_t> run(Box& bounds) {
    std::atomic<std::size_t> all = 0;
    tbb::enumerable_thread_specific<CellBox> boxes;
    references_.each(parallel_, [&](std::size_t, const PrimRef* refs, std::size_t count, auto&& number_of) {
      CellBox& box = boxes.local();
      for (std::size_t i = 0; i < count; ++i) numbers_[number_of(refs[i])] = 0, box.grow(refs[i]);
      all += count;
    });
    for (const CellBox& box : boxes) bounds.grow(box.box());
    sizes_ = {all};
    for (std::size_t k = 0; k < sizes_.size(); ++k)
      // Where many triangles stand in one cell, the cell is divided by a grid of its own.
      while (sizes_[k] > most_ && divide(static_cast<PartNumber>(k))) {}
    return sizes_;
  }

  const Column<PartNumber>& numbers() const { return numbers_; }

 private:
  /// Divides a part; false if that is not possible.
  bool divide(PartNumber part) {
    tbb::enumerable_thread_specific<Centers> all_centers;
    each_of(part, all_centers, [&](Centers& own, const PrimRef& ref, std::size_t) {
      for (int k = 0; k < 3; ++k) {
        const float c = ref.hi[k] - ref.negative_lo[k];
        own.lo[k] = std::min(own.lo[k], c), own.hi[k] = std::max(own.hi[k], c);
      }
    });
    Centers centers;
    for (const Centers& own : all_centers) centers.grow(own);
    float scale[3];
    for (int k = 0; k < 3; ++k) {
      const float extent = centers.hi[k] - centers.lo[k];
      scale[k] = static_cast<float>(kCells) / extent;
      if (!(extent > 0 && std::isfinite(extent) && std::isfinite(scale[k]))) scale[k] = 0;
    }
    const auto cell_of = [&](const PrimRef& ref, std::uint8_t(&at)[3]) {
      for (int k = 0; k < 3; ++k) {
        const float c = (ref.hi[k] - ref.negative_lo[k] - centers.lo[k]) * scale[k];
        // NaN, from infinite centres, is cell 0.
        at[k] = c > 0 ? static_cast<std::uint8_t>(std::min(c, static_cast<float>(kCells - 1))) : 0;
      }
      return number_of_cell(at);
    };
    tbb::enumerable_thread_specific<std::vector<Cell>> grids(kAllCells);
    each_of(part, grids, [&](std::vector<Cell>& grid, const PrimRef& ref, std::size_t) {
      std::uint8_t at[3];
      Cell& cell = grid[cell_of(ref, at)];
      cell.box.grow(ref), ++cell.count;
    });
    std::vector<Cell> cells;
    for (std::size_t c = 0; c < kAllCells; ++c) {
      Cell cell;
      for (const std::vector<Cell>& grid : grids) cell.box.grow(grid[c].box), cell.count += grid[c].count;
      if (cell.count == 0) continue;
      cell.at[0] = static_cast<std::uint8_t>(c / (kCells * kCells));
      cell.at[1] = static_cast<std::uint8_t>(c / kCells % kCells),
      cell.at[2] = static_cast<std::uint8_t>(c % kCells);
      cells.push_back(cell);
    }
    grids.clear();
    if (cells.size() < 2 || sizes_.size() >= kMostParts) return false;
    std::vector<PartNumber> part_of(kAllCells, part);
    sizes_[part] = 0;
    is_used_ = false;
    split(cells.data(), cells.data() + cells.size(), part, part_of);
    tbb::enumerable_thread_specific<int> nothing;
    each_of(part, nothing, [&](int, const PrimRef& ref, std::size_t number) {
      std::uint8_t at[3];
      numbers_[number] = part_of[cell_of(ref, at)];
    });
    return true;
  }

  /// Calls f(own, ref, number) for each reference of a part; `own` is what `all` holds for the thread.
  template <class All, class F>
  void each_of(PartNumber part, All& all, F&& f) {
    references_.each_of(part, numbers_, parallel_,
                        [&](std::size_t, const PrimRef* refs, std::size_t count, auto&& number_of) {
                          auto& own = all.local();
                          for (std::size_t i = 0; i < count; ++i) {
                            const std::size_t number = number_of(refs[i]);
                            if (numbers_[number] == part) f(own, refs[i], number);
                          }
                        });
  }

  /// Splits cells where it costs least, until they are few enough for a part. The first part that is made
  /// keeps the number `first`.
  void split(Cell* begin, Cell* end, PartNumber first, std::vector<PartNumber>& part_of) {
    std::uint64_t all = 0;
    for (const Cell* c = begin; c != end; ++c) all += c->count;
    if (all > most_ && end - begin > 1 && sizes_.size() + open_ < kMostParts) {
      Plane plane = least(begin, end, all, std::max<std::size_t>(most_ / kLeastSide, 1));
      if (plane.axis < 0) plane = least(begin, end, all, 1);
      Cell* const middle =
          std::stable_partition(begin, end, [&](const Cell& c) { return c.at[plane.axis] <= plane.at; });
      ++open_;
      split(begin, middle, first, part_of);
      --open_;
      return split(middle, end, first, part_of);
    }
    PartNumber part = first;
    if (is_used_) part = static_cast<PartNumber>(sizes_.size()), sizes_.push_back(0);
    is_used_ = true;
    sizes_[part] = all;
    for (const Cell* c = begin; c != end; ++c) part_of[number_of_cell(c->at)] = part;
  }

  /// A plane behind the cells with coordinate `at`; axis < 0: none.
  struct Plane {
    int axis = -1, at = 0;
    double cost = std::numeric_limits<double>::infinity();
  };

  /// The plane of least surface-area cost with at least `side` references, 1 or more, on each side.
  static Plane least(const Cell* begin, const Cell* end, std::uint64_t all, std::size_t side) {
    Plane best;
    for (int axis = 0; axis < 3; ++axis) {
      Cell slab[kCells];
      for (const Cell* c = begin; c != end; ++c)
        slab[c->at[axis]].box.grow(c->box), slab[c->at[axis]].count += c->count;
      double right_cost[kCells + 1] = {};
      Cell right;
      for (int i = kCells - 1; i > 0; --i) {
        right.box.grow(slab[i].box), right.count += slab[i].count;
        right_cost[i] = right.count > 0 ? right.box.area() * static_cast<double>(right.count) : 0;
      }
      Cell left;
      for (int i = 0; i + 1 < kCells; ++i) {
        left.box.grow(slab[i].box), left.count += slab[i].count;
        if (left.count < side || all - left.count < side) continue;
        const double cost = left.box.area() * static_cast<double>(left.count) + right_cost[i + 1];
        // Areas of huge scenes may overflow.
        if (best.axis < 0 || cost < best.cost) best = {axis, i, cost};
      }
    }
    return best;
  }

  const References& references_;
  const std::size_t most_;
  const bool parallel_;
  Column<PartNumber> numbers_;
  std::vector<std::size_t> sizes_;
  std::size_t open_ = 0;  ///< parts that are still to come, at least
  bool is_used_ = false;  ///< the first part has its number
};

// ---- Building.

/// Copies the references of a part into arrays.refs, in their order.
void gather_part(const References& references, const Column<PartNumber>& numbers, PartNumber part,
                 BuildArrays& arrays, bool parallel) {
  std::vector<std::size_t> first(references.spans() + 1, 0);
  for_all(references.spans(), [&](std::size_t p) {
    const auto [begin, end] = references.range(p);
    first[p + 1] = static_cast<std::size_t>(std::count(&numbers[begin], numbers.begin() + end, part));
  });
  for (std::size_t p = 0; p < references.spans(); ++p) first[p + 1] += first[p];
  arrays.count = first.back();
  arrays.populate(arrays.refs, arrays.count, parallel);
  references.each_of(part, numbers, parallel,
                     [&](std::size_t p, const PrimRef* refs, std::size_t count, auto&& number_of) {
                       PrimRef* out = arrays.refs + first[p];
                       for (std::size_t i = 0; i < count; ++i)
                         if (numbers[number_of(refs[i])] == part) *out++ = refs[i];
                     });
}

/// What a tree takes in the arrays of another.
struct TreePlace {
  std::uint32_t node = 0, leaf = 0, entry = 0;

  NodeRef moved(NodeRef ref) const {
    if (ref.is_none()) return ref;
    return NodeRef::from_bits(ref.bits() + (!ref.is_leaf() ? node : ref.is_triangles() ? leaf : entry));
  }
};

/// Joins the trees of the parts under that over them, of which entry i of the leaf table is part item_of[i].
void join(Accel& accel, const Accel& top, std::vector<std::unique_ptr<Accel>>& parts,
          const std::vector<std::uint32_t>& item_of, bool parallel) {
  std::size_t nodes = top.stats.nodes, blocks = 0, entries = 0;
  std::vector<TreePlace> at(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    at[k] = {static_cast<std::uint32_t>(nodes), static_cast<std::uint32_t>(TriangleBlock::kLeaves * blocks),
             static_cast<std::uint32_t>(entries)};
    nodes += parts[k]->stats.nodes, blocks += block_count(*parts[k]), entries += parts[k]->leaves.size();
  }
  if (blocks > NodeRef::kMaxTriangleLeaves / TriangleBlock::kLeaves || nodes >= std::size_t{1} << 31)
    throw Error("too many triangles for one structure");
  const auto root_of = [&](NodeRef ref) {
    if (!ref.is_leaf() || ref.is_none()) return ref;
    const std::uint32_t k = item_of[top.leaves[ref.table_index()].begin];
    return at[k].moved(parts[k]->root);
  };
  accel.root = root_of(top.root);
  std::vector<int> depth_of(top.stats.nodes, 1);  // of nodes; children come behind their parents
  accel.nodes = VirtualArray<BvhNode>(nodes);
  accel.blocks = VirtualArray<TriangleBlock>(blocks);
  accel.leaves.reserve(entries);
  std::vector<int> above(parts.size(), 0);  // levels of nodes over each part
  for (std::size_t n = 0; n < top.stats.nodes; ++n) {
    accel.nodes[n] = top.nodes[n];
    for (NodeRef& ref : accel.nodes[n].child) {
      if (ref.is_none()) continue;
      if (ref.is_leaf())
        above[item_of[top.leaves[ref.table_index()].begin]] = depth_of[n];
      else
        depth_of[ref.node_index()] = depth_of[n] + 1;
      ref = root_of(ref);
    }
  }
  int depth = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Accel& part = *parts[k];
    Chunks(part.stats.nodes, 4096).each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        BvhNode& node = accel.nodes[at[k].node + n] = part.nodes[n];
        for (NodeRef& ref : node.child) ref = at[k].moved(ref);
      }
    });
    Chunks(block_count(part), 4096).each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
      std::memcpy(&accel.blocks[at[k].leaf / TriangleBlock::kLeaves + begin], &part.blocks[begin],
                  (end - begin) * sizeof(TriangleBlock));
    });
    for (LeafEntry entry : part.leaves) {
      if (entry.kind == Kind::triangle) entry.begin += at[k].leaf;
      accel.leaves.push_back(entry);
    }
    accel.pieces |= part.pieces;
    depth = std::max(depth, above[k] + part.stats.depth);
    parts[k] = nullptr;
  }
  accel.stats.depth = depth;
  count_tree(accel, nodes, blocks);
}

}  // namespace

/// How many of so many references a part has at most. Half of what is built at once leaves room for the
/// blocks of a part beside its references.
static std::size_t part_size(std::size_t references, const BuildOptions& options) {
  return std::max(options.together / 2, references / kLeastShare);
}

std::uint64_t build_bytes(std::size_t triangles, const BuildOptions& options) {
  // Two references, items with their corners, and binary nodes; then nodes and blocks, more than scans take.
  const double building = 80 * (1 + effort_of(options.quality).spatial);
  const double tree = options.quality == BuildQuality::compact ? 32 : 44;
  const auto all = static_cast<double>(triangles), together = static_cast<double>(options.together);
  if (all <= together) return static_cast<std::uint64_t>(all * std::max(building, tree));
  // A part has all its blocks before it is made compact.
  return static_cast<std::uint64_t>(all * (tree + 1) +
                                    (building + tree) * static_cast<double>(part_size(triangles, options)));
}

void expect_memory(std::size_t triangles, const BuildOptions& options, std::uint64_t available) {
  const std::uint64_t needed = build_bytes(triangles, options);
  if (needed <= available) return;
  std::string advice;
  BuildOptions compact = options;
  compact.quality = BuildQuality::compact;
  if (build_bytes(triangles, compact) < needed)
    advice =
        fmt::format("; of the quality 'compact' it takes {}", memory_text(build_bytes(triangles, compact)));
  throw Error(fmt::format("building the tree over {} triangles takes up to {} of memory, but {} are free{}",
                          triangles, memory_text(needed), memory_text(available), advice),
              ErrorKind::io);
}

void build_in_parts(Accel& accel, const MeshSource& source, const std::vector<std::uint32_t>& meshes,
                    Column<PrimRef>& others, ItemOrder& order, const BuildOptions& options,
                    const BuildKernels& kernels) {
  const References references(accel, source, meshes, others);
  std::vector<std::unique_ptr<Accel>> parts;
  BuildArrays roots(kMostParts, effort_of(BuildQuality::balanced));
  {
    Divider divider(references, part_size(references.size(), options), options.parallel);
    const std::vector<std::size_t> sizes = divider.run(accel.bounds);
    // Made once: the system clears the pages of new memory.
    BuildArrays arrays(*std::ranges::max_element(sizes), effort_of(options.quality));
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      if (sizes[k] == 0) continue;
      gather_part(references, divider.numbers(), static_cast<PartNumber>(k), arrays, options.parallel);
      Accel& part = *parts.emplace_back(std::make_unique<Accel>());
      const Chunks chunks(arrays.count, std::size_t{1} << 16);
      std::vector<CellBox> boxes(chunks.count);
      chunks.each(options.parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) boxes[c].grow(arrays.refs[i]);
      });
      CellBox box;
      for (const CellBox& b : boxes) box.grow(b);
      part.bounds = box.box();
      PrimRef& root = roots.refs[roots.count];
      for (int axis = 0; axis < 3; ++axis)
        root.negative_lo[axis] = box.negative_lo[axis], root.hi[axis] = box.hi[axis];
      root.item = static_cast<std::uint32_t>(roots.count++),
      root.kind = static_cast<std::uint32_t>(Kind::instance);
      build_tree(part, arrays, source, order, options, kernels,
                 {1 + kTopLevels, fmt::format("part {} of {}", k + 1, sizes.size()), true});
    }
  }
  others = {};
  if (parts.empty()) return;
  Accel top;
  ItemOrder roots_in_order;
  top.bounds = accel.bounds;
  build_tree(top, roots, NoTriangles{}, roots_in_order, {}, kernels, {kMaxDepth - kTopLevels, {}});
  join(accel, top, parts, roots_in_order[static_cast<int>(Kind::instance)], options.parallel);
}

}  // namespace oktett
