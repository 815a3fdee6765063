#include "accel/build/refit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "accel/build/mesh_source.h"
#include "accel/build/tree_store.h"
#include "accel/closest.h"
#include "accel/dynamic_accel.h"
#include "accel/geometry_bounds.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// Nodes so many levels below the root are refitted by tasks of their own.
constexpr int kTaskLevels = 3;

/// The number of corner `k` of triangle `lane`.
int corner_of(const TriangleBlock& block, int k, int lane) { return block.first.corners[lane] >> 4 * k & 15; }

/// What a part of a tree has become.
struct Part {
  Box box;
  double area = 0;  ///< half the areas of all boxes in it, its own included
};

/// Computes the boxes of a tree anew. leaf(ref, box) returns the part that a leaf has become; `box` is that
/// which it had.
template <class Leaf>
class BoxFit {
 public:
  BoxFit(Accel& accel, bool parallel, const Leaf& leaf) : accel_(accel), parallel_(parallel), leaf_(leaf) {}

  /// Sets the bounds and the cost, too.
  void run() {
    const Part all = part(accel_.root, accel_.bounds, 0);
    accel_.bounds = all.box;
    const double root = half_area(all.box);
    accel_.stats.sah_cost = accel_.root.is_leaf() ? 1 : root > 0 ? all.area / root : 0;
  }

 private:
  Part part(NodeRef ref, const Box& box, int level) const {
    return ref.is_leaf() ? leaf_(ref, box) : node(accel_.nodes[ref.node_index()], level);
  }

  Part node(BvhNode& node, int level) const {
    std::array<Part, BvhNode::kWidth> parts;
    const auto one = [&](int i) {
      if (node.child[i].is_none()) return;
      Box before;
      for (int axis = 0; axis < 3; ++axis)
        before.lo[axis] = node.plane[2 * axis][i], before.hi[axis] = node.plane[2 * axis + 1][i];
      const Part& p = parts[static_cast<std::size_t>(i)] = part(node.child[i], before, level + 1);
      for (int axis = 0; axis < 3; ++axis)
        node.plane[2 * axis][i] = p.box.lo[axis], node.plane[2 * axis + 1][i] = p.box.hi[axis];
    };
    if (parallel_ && level < kTaskLevels)
      tbb::parallel_for(0, BvhNode::kWidth, one);
    else
      for (int i = 0; i < BvhNode::kWidth; ++i) one(i);
    Part all;
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      if (node.child[i].is_none()) continue;
      const Part& p = parts[static_cast<std::size_t>(i)];
      all.box.grow(p.box), all.area += p.area;
    }
    all.area += half_area(all.box);
    return all;
  }

  Accel& accel_;
  const bool parallel_;
  const Leaf& leaf_;
};

/// The corners of the blocks of one mesh.
class CornerFit {
 public:
  CornerFit(Accel& accel, const RefitPlan& plan)
      : accel_(accel),
        plan_(plan),
        mesh_(*std::get<MeshGeometry>(accel.geometries[0].shape).mesh),
        source_(accel) {}

  bool failed() const { return failed_; }

  Part operator()(NodeRef ref, const Box&) const {
    if (ref.is_triangles()) return block(ref.triangle_leaf(), ref.triangle_count());
    const LeafEntry& leaf = accel_.leaves[ref.table_index()];
    return block(leaf.begin, leaf.count);
  }

 private:
  /// The first `count` triangles of a leaf, which has a block of its own.
  Part block(std::uint32_t leaf, int count) const {
    const std::uint32_t number = leaf / TriangleBlock::kLeaves;
    TriangleBlock& block = accel_.blocks[number];
    if (const std::uint32_t* const vertices = plan_.vertices(number))
      for (int n = 0; n < TriangleBlock::kCorners; ++n) {
        const Vec3f& p = mesh_.positions[vertices[n]];
        block.x[n] = p.x, block.y[n] = p.y, block.z[n] = p.z;
      }
    else if (!move(block, count) && !pack(block, count))
      failed_ = true;
    Part part;
    float not_finite = 0;  // becomes NaN
    for (int axis = 0; axis < 3; ++axis) {
      const float* const row = block.row(axis);
      float lo = row[0], hi = lo;
      for (int n = 0; n < TriangleBlock::kCorners; ++n) {
        const float x = row[n];
        lo = x < lo ? x : lo, hi = x > hi ? x : hi;
        not_finite += x * 0;
      }
      part.box.lo[axis] = lo, part.box.hi[axis] = hi;
    }
    if (not_finite != 0) failed_ = true;
    part.area = half_area(part.box);
    return part;
  }

  /// Writes the corners to the places that they had. False if two that had one place lie apart.
  bool move(TriangleBlock& block, int count) const {
    std::uint32_t vertex[TriangleBlock::kCorners];
    unsigned known = 0;
    for (int i = 0; i < count; ++i) {
      const std::uint32_t* index = &mesh_.indices[3 * std::size_t{block.first.item[i]}];
      for (int k = 0; k < 3; ++k) {
        const int n = corner_of(block, k, i);
        const Vec3f& p = mesh_.positions[index[k]];
        if ((known >> n & 1) != 0) {
          if (vertex[n] != index[k] && std::memcmp(&mesh_.positions[vertex[n]], &p, sizeof p) != 0)
            return false;
          continue;
        }
        known |= 1u << n, vertex[n] = index[k];
        for (int axis = 0; axis < 3; ++axis) block.row(axis)[n] = p[axis];
      }
    }
    for (int n = 0; n < TriangleBlock::kCorners; ++n)
      if ((known >> n & 1) == 0)
        for (int axis = 0; axis < 3; ++axis) block.row(axis)[n] = block.row(axis)[corner_of(block, 0, 0)];
    return true;
  }

  /// Numbers the corners anew. False if there are too many.
  bool pack(TriangleBlock& block, int count) const {
    std::uint32_t items[TriangleBlock::kSize];
    std::uint16_t corners[TriangleBlock::kSize];
    std::copy(block.first.item, block.first.item + count, items);
    if (!source_.pack_corners(items, count, corners)) return false;
    source_.fill(items, corners, count, block);
    return true;
  }

  Accel& accel_;
  const RefitPlan& plan_;
  const TriangleMesh& mesh_;
  const MeshSource source_;
  mutable std::atomic<bool> failed_ = false;
};

/// Notes the vertices of a block, see RefitPlan. Returns the number of its triangles.
std::size_t note(const TriangleBlock& block, const TriangleMesh& mesh, std::uint32_t* vertices) {
  std::fill(vertices, vertices + TriangleBlock::kCorners, kNoId);
  std::size_t count = 0;
  bool several = block.is_packed();
  for (; !several && count < TriangleBlock::kSize && block.first.item[count] != kNoId; ++count)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex =
          mesh.indices[3 * std::size_t{block.first.item[count]} + static_cast<std::size_t>(k)];
      std::uint32_t& known = vertices[corner_of(block, k, static_cast<int>(count))];
      several |= known != kNoId && known != vertex;
      known = vertex;
    }
  // Corners that are not used repeat number 0.
  std::replace(vertices, vertices + TriangleBlock::kCorners, kNoId, vertices[0]);
  if (several) vertices[0] = kNoId;
  return count;
}

template <class T>
VirtualArray<T> copy_of(const VirtualArray<T>& from, std::size_t size) {
  VirtualArray<T> to(size);
  if (size > 0) std::memcpy(to.data(), from.data(), size * sizeof(T));
  return to;
}

}  // namespace

RefitPlan::RefitPlan(const Accel& accel, const TriangleMesh& mesh, bool parallel) {
  const std::size_t blocks = block_count(accel);
  if (accel.pieces || accel.root.is_none()) return;
  vertices_.resize_uninitialized(blocks * TriangleBlock::kCorners);
  std::atomic<std::size_t> triangles = 0;
  Chunks(blocks, 4096).each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t b = begin; b < end; ++b)
      count += note(accel.blocks[b], mesh, &vertices_[b * TriangleBlock::kCorners]);
    triangles += count;
  });
  // Those that are not finite are left out of a tree.
  is_possible_ = triangles == mesh.triangle_count();
}

bool refit(Accel& accel, const RefitPlan& plan, bool parallel) {
  accel.answers = std::make_unique<PointAnswers>();
  const CornerFit fit(accel, plan);
  BoxFit(accel, parallel, fit).run();
  return !fit.failed();
}

bool move_instances(Accel& accel, const std::vector<Placement>& places, bool parallel) {
  const auto is_moved = [](const Placement& place) { return place.to_world != nullptr; };
  std::ptrdiff_t moved = 0;
  for (const InstanceItem& instance : accel.instances)
    moved += is_moved(places[accel.geometry_of(instance.item)]);
  if (moved != std::ranges::count_if(places, is_moved)) return false;
  Chunks(accel.instances.size(), 1024).each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t g = accel.geometry_of(accel.instances[k].item);
      if (!is_moved(places[g])) continue;
      Geometry& geometry = accel.geometries[g];
      GeometryFrame& frame = accel.frames[g];
      geometry.transform = *places[g].to_world, frame.inverse = *places[g].inverse;
      frame.identity = geometry.transform.is_identity();
      frame.mirrored = geometry.transform.determinant() < 0;
      frame.inverse.to_rows(accel.instances[k].to_child);
    }
  });
  accel.has_mirrors = std::ranges::any_of(accel.frames, &GeometryFrame::mirrored);
  std::atomic<bool> failed = false;
  const auto leaf = [&](NodeRef ref, const Box& before) {
    Part part{before, 0};
    const LeafEntry* const entry = ref.is_triangles() ? nullptr : &accel.leaves[ref.table_index()];
    if (entry != nullptr && entry->kind == Kind::instance) {
      part.box = {};
      for (std::uint32_t k = entry->begin; k < entry->begin + entry->count; ++k) {
        const InstanceItem& instance = accel.instances[k];
        const Box box =
            instance_bounds(accel.geometries[accel.geometry_of(instance.item)].transform, *instance.child);
        if (!is_usable(box)) failed = true;
        part.box.grow(box);
      }
    }
    part.area = half_area(part.box);
    return part;
  };
  if (!accel.root.is_none()) BoxFit(accel, parallel, leaf).run();
  accel.answers = std::make_unique<PointAnswers>();
  note_missing_closest(accel);
  return !failed;
}

std::shared_ptr<Accel> clone_tree(const Accel& accel) {
  auto clone = std::make_shared<Accel>();
  clone->geometries = accel.geometries, clone->first_item = accel.first_item;
  clone->one_item_each = accel.one_item_each;
  clone->root = accel.root, clone->bounds = accel.bounds;
  clone->nodes = copy_of(accel.nodes, accel.stats.nodes);
  clone->blocks = copy_of(accel.blocks, block_count(accel));
  clone->leaves = accel.leaves;
  clone->frames = accel.frames, clone->has_mirrors = accel.has_mirrors;
  clone->kinds = accel.kinds, clone->users = accel.users;
  clone->stats = accel.stats;
  for (int k = 0; k < 2; ++k) clone->no_closest_point[k] = accel.no_closest_point[k];
  return clone;
}

void FollowingTree::set(std::shared_ptr<Accel> tree) {
  tree_ = std::move(tree), plan_ = nullptr;
  built_cost_ = tree_->stats.sah_cost;
}

bool FollowingTree::follow(const TriangleMesh& mesh, bool parallel) {
  if (plan_ == nullptr) plan_ = std::make_shared<const RefitPlan>(*tree_, mesh, parallel);
  if (!plan_->is_possible()) return false;
  if (!is_unshared(tree_)) tree_ = clone_tree(*tree_);
  std::get<MeshGeometry>(tree_->geometries[0].shape).mesh = &mesh;
  return refit(*tree_, *plan_, parallel) && tree_->stats.sah_cost <= DynamicAccel::kMostGrowth * built_cost_;
}

}  // namespace oktett
