#include "accel/time/near_primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "accel/accel_data.h"
#include "accel/time/instance_motion.h"
#include "accel/time/scene_data.h"

namespace oktett {
namespace {

/// The point of a query as one scene sees it.
struct Near {
  Vec3d point;
  /// A length in the outermost scene is at most so many times as long along each axis of this one.
  Vec3d stretch{1, 1, 1};

  Near in(const Affine& to_inner) const {
    Near inner;
    inner.point = to_inner.point(point);
    for (int k = 0; k < 3; ++k) {
      const auto& row = to_inner.m[static_cast<std::size_t>(k)];
      inner.stretch[k] = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]) *
                         std::max({stretch.x, stretch.y, stretch.z});
    }
    return inner;
  }

  /// The least radius with which a query may meet a box; infinite for an empty one. A point of the box at a
  /// distance d along an axis of this space is at least d / stretch away outside.
  double distance(const Box& box) const {
    if (box.empty()) return std::numeric_limits<double>::infinity();
    double sum = 0;
    const double most = std::max({stretch.x, stretch.y, stretch.z});
    for (int k = 0; k < 3; ++k) {
      const double off = std::max(
          {0.0, static_cast<double>(box.lo[k]) - point[k], point[k] - static_cast<double>(box.hi[k])});
      sum += off * off;
    }
    // Rounded so that what is exactly at the radius counts.
    return std::sqrt(sum) / most * (1 - 0x1p-20);
  }
};

class NearWalk {
 public:
  NearWalk(const TraceScene& scene, const Near& near, float time, NearVisitor& visitor)
      : scene_(scene), near_(near), time_(time), visitor_(visitor) {}

  void run() {
    structure(*scene_.fixed, nullptr);
    for (const MovingPart& part : scene_.moving) moving(part);
  }

 private:
  bool is_near(const Box& box) const { return near_.distance(box) <= static_cast<double>(visitor_.radius()); }

  static Box box_of(const BvhNode& node, int i) {
    return {{node.plane[0][i], node.plane[2][i], node.plane[4][i]},
            {node.plane[1][i], node.plane[3][i], node.plane[5][i]}};
  }

  /// Calls leaf(ref) for the leaves below `root` whose boxes are near, the nearest of a node first.
  template <class BoxOf, class ChildrenOf, class Leaf>
  void walk(NodeRef root, const BoxOf& box, const ChildrenOf& children, const Leaf& leaf) const {
    struct Entry {
      NodeRef ref;
      double distance;
    };
    if (root.is_none()) return;
    std::vector<Entry> stack{{root, 0}};
    while (!stack.empty()) {
      const Entry e = stack.back();
      stack.pop_back();
      if (e.distance > static_cast<double>(visitor_.radius())) continue;
      if (e.ref.is_leaf()) {
        leaf(e.ref);
        continue;
      }
      const std::size_t first = stack.size();
      for (int i = 0; i < BvhNode::kWidth; ++i) {
        const NodeRef child = children(e.ref)[i];
        if (!child.is_none()) stack.push_back({child, near_.distance(box(e.ref, i))});
      }
      std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end(),
                [](const Entry& a, const Entry& b) { return a.distance > b.distance; });
    }
  }

  // ---- What does not move.

  /// All of a structure: the fixed one of the scene, or that of the only geometry `own`.
  void structure(const Accel& accel, const SceneGeometry* own) {
    own_ = own;
    for (const LeafEntry& leaf : accel.unbounded) visit(accel, leaf);
    walk(
        accel.root, [&](NodeRef ref, int i) { return box_of(accel.nodes[ref.node_index()], i); },
        [&](NodeRef ref) { return accel.nodes[ref.node_index()].child; },
        [&](NodeRef ref) {
          if (ref.is_triangles())
            visit(accel, accel.triangles(ref.triangle_leaf()), ref.triangle_count());
          else
            visit(accel, accel.leaves[ref.table_index()]);
        });
  }

  void visit(const Accel& accel, const TriangleLeaf& leaf, int count) {
    for (int lane = 0; lane < count; ++lane) {
      Box box;
      for (int k = 0; k < 3; ++k) box.grow(leaf.vertex(k, lane));
      if (is_near(box)) visit(accel, leaf.item(lane));
    }
  }

  void visit(const Accel& accel, const LeafEntry& leaf) {
    if (leaf.kind == Kind::triangle) return visit(accel, accel.triangles(leaf.begin), leaf.count);
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
      if (leaf.kind == Kind::instance)
        visit(accel, accel.instances[k].item);
      else if (leaf.kind == Kind::csg)
        visit(accel, accel.combinations[k].item);
      else if (is_exact(leaf.kind))
        visit(accel, accel.exact_pool(leaf.kind).item_of_cell(k));
      else
        visit(accel, accel.item_in_pool(leaf.kind, k));
    }
  }

  void visit(const Accel& accel, std::uint32_t item) {
    if (own_ != nullptr) return tell(*own_, item);
    const std::uint32_t g = accel.geometry_of(item);
    const ItemTable::Place place = scene_.fixed_geometries[g].place;
    const SceneGeometry& geometry = scene_.geometries[place.geometry];
    const Affine& to_scene = accel.geometries[g].transform;
    if (!std::holds_alternative<Geometry>(geometry.shape))
      return enter(geometry, place.geometry, place.primitive, to_scene);
    if (geometry.tree == nullptr) return tell(geometry, item - accel.first_item[g]);
    const Affine to_tree = to_scene.inverse();
    if (to_scene.is_invertible(to_tree))
      NearWalk(scene_, near_.in(to_tree), time_, visitor_).structure(*geometry.tree, &geometry);
  }

  void tell(const SceneGeometry& geometry, std::uint32_t primitive) {
    if (geometry.faces != nullptr) {
      float u = 0, v = 0;
      geometry.faces->to_face(primitive, u, v);
      if (!told_.emplace(geometry.number, primitive).second) return;
    }
    visitor_.visit(geometry, primitive);
  }

  void enter(const SceneGeometry& geometry, std::uint32_t place, std::uint32_t index,
             const Affine& to_scene) {
    const Affine to_child = to_scene.inverse();
    if (!to_scene.is_invertible(to_child) || !visitor_.enter(geometry, index, to_scene)) return;
    NearWalk(scene_.child(place, index), near_.in(to_child), time_, visitor_).run();
    visitor_.leave();
  }

  // ---- What moves.

  void moving(const MovingPart& part) {
    if (!part.is_there(time_)) return;
    const TimeTree& tree = *part.tree;
    const KeyTime at = KeyTime::of(part.own_time(time_), tree.keys);
    const std::uint32_t next = std::min(at.key + 1, tree.keys - 1);
    const auto box_at = [&](NodeRef ref, int i) {
      const Box a = box_of(tree.nodes[at.key][ref.node_index()], i);
      const Box b = box_of(tree.nodes[next][ref.node_index()], i);
      Box box;
      for (int k = 0; k < 3; ++k)
        box.lo[k] = at.between(a.lo[k], b.lo[k]), box.hi[k] = at.between(a.hi[k], b.hi[k]);
      return box;
    };
    walk(
        tree.root, box_at, [&](NodeRef ref) { return tree.nodes[0][ref.node_index()].child; },
        [&](NodeRef ref) {
          const LeafEntry& leaf = tree.leaves[ref.table_index()];
          for (std::uint32_t k = 0; k < leaf.count; ++k) {
            if (leaf.kind != Kind::box)
              called(part, tree.called_items[leaf.begin + k]);
            else if (is_near(triangle_box(tree, leaf.begin, k, at, next)))
              triangle(part, tree.block_items[leaf.begin][k]);
          }
        });
  }

  static Box triangle_box(const TimeTree& tree, std::uint32_t block, std::uint32_t lane, const KeyTime& at,
                          std::uint32_t next) {
    const MovingCorners& a = tree.corners[std::size_t{block} * tree.keys + at.key];
    const MovingCorners& b = tree.corners[std::size_t{block} * tree.keys + next];
    Box box;
    for (int c = 0; c < 3; ++c)
      box.grow(Vec3f{at.between(a.at[c][0][lane], b.at[c][0][lane]),
                     at.between(a.at[c][1][lane], b.at[c][1][lane]),
                     at.between(a.at[c][2][lane], b.at[c][2][lane])});
    return box;
  }

  void triangle(const MovingPart& part, std::uint32_t item) {
    const ItemTable::Place place = part.items[item];
    tell(scene_.geometries[place.geometry], place.primitive);
  }

  void called(const MovingPart& part, std::uint32_t item) {
    const ItemTable::Place place = part.items[item];
    const SceneGeometry& geometry = scene_.geometries[place.geometry];
    if (std::holds_alternative<std::shared_ptr<const UserShape>>(geometry.shape))
      return tell(geometry, place.primitive);
    enter(geometry, place.geometry, place.primitive, map_at(geometry, place.primitive, part.own_time(time_)));
  }

  const TraceScene& scene_;
  const Near near_;
  const float time_;
  NearVisitor& visitor_;
  const SceneGeometry* own_ = nullptr;  ///< whose structure is walked; null: that of the scene
  std::set<std::pair<std::uint32_t, std::uint32_t>> told_;  ///< faces, by the numbers of their geometries
};

}  // namespace

void visit_near(const TraceScene& scene, const Vec3f& point, const Affine& to_scene, float time,
                NearVisitor& visitor) {
  if (!is_finite(point)) return;
  const Near near{Vec3d(point)};
  NearWalk(scene, to_scene.is_identity() ? near : near.in(to_scene), time, visitor).run();
}

}  // namespace oktett
