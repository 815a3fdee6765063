/// \file From geometries to a tree: numbers the items and drops degenerate ones.

#include <algorithm>
#include <cmath>

#include "accel/build/fill_pools.h"
#include "accel/build/mesh_source.h"
#include "accel/build/tree_store.h"
#include "accel/build/wide_tree.h"
#include "accel/closest.h"
#include "accel/csg/csg.h"
#include "accel/geometry_bounds.h"
#include "core/error.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

std::size_t item_count(const Geometry& g) {
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) return mesh->mesh->triangle_count();
  if (const auto* spheres = std::get_if<SpheresShape>(&g.shape)) return spheres->spheres.size();
  if (const auto* list = std::get_if<InstanceList>(&g.shape)) return list->places.size();
  return 1;
}

bool is_usable(const Box& b) { return !b.empty() && is_finite(b.lo) && is_finite(b.hi); }

PrimRef make_ref(const Box& b, std::uint32_t item, Kind kind) {
  return {{-b.lo.x, -b.lo.y, -b.lo.z}, item, {b.hi.x, b.hi.y, b.hi.z}, static_cast<std::uint32_t>(kind)};
}

/// A shape of its own structure, seen through an instance: for maps under which its kind is not closed (an
/// ellipsoid).
Geometry as_instance(Geometry g) {
  Geometry inner = g;
  inner.transform = Affine{};
  g.shape = InstanceGeometry{build_accel({std::move(inner)}, {})};
  return g;
}

void wrap_sheared_shapes(std::vector<Geometry>& geometries) {
  for (Geometry& g : geometries) {
    const bool needs_similarity =
        std::holds_alternative<SpheresShape>(g.shape) || std::holds_alternative<DiskShape>(g.shape);
    if (needs_similarity && g.transform.is_invertible() && g.transform.uniform_scale() == 0)
      g = as_instance(std::move(g));
  }
}

/// An entry of the list beside the tree, which every ray is tested against: the next item of its kind.
void add_unbounded(Accel& accel, Kind kind, std::uint32_t item, ItemOrder& order) {
  std::vector<std::uint32_t>& list = order[static_cast<int>(kind)];
  accel.unbounded.push_back({static_cast<std::uint32_t>(list.size()), 1, kind, TriangleTest::watertight});
  list.push_back(item);
}

/// Adds one exact surface and its cells. Cells without bounds go into the list beside the tree.
void add_exact(Accel& accel, const ExactShape& shape, Kind kind, const Affine& to_world, std::uint32_t item,
               Column<PrimRef>& refs, ItemOrder& order) {
  const ExactOps& ops = exact_ops(kind);
  auto& pool = accel.exact[static_cast<int>(kind)];
  if (!pool) pool = ops.make_pool();
  accel.has_exact = true;
  const std::size_t first = pool->cells.size();
  ops.add(*pool, shape, to_world, item);
  for (std::size_t cell = first; cell < pool->cells.size(); ++cell) {
    const Box box = ops.cell_bounds(*pool, pool->cells[cell]);
    const auto index = static_cast<std::uint32_t>(cell);
    if (is_usable(box)) {
      refs.push_back(make_ref(box, index, kind));
      accel.bounds.grow(box);
    } else {
      add_unbounded(accel, kind, index, order);
    }
  }
}

/// Builds one combination. Its number takes the place of the item number, as cells do.
void add_combination(Accel& accel, const Geometry& geometry, std::uint32_t item, const BuildOptions& options,
                     Column<PrimRef>& refs, ItemOrder& order) {
  const auto& expression = std::get<CsgGeometry>(geometry.shape).expression;
  if (!expression) return;
  CsgItem csg = build_csg(moved(*expression, geometry.transform), options);
  csg.item = item;
  const Box box = csg_bounds(csg);
  if (box.empty()) return;
  const auto index = static_cast<std::uint32_t>(accel.combinations.size());
  if (is_usable(box)) {
    refs.push_back(make_ref(box, index, Kind::csg));
    accel.bounds.grow(box);
  } else {
    add_unbounded(accel, Kind::csg, index, order);
  }
  accel.combinations.push_back(std::move(csg));
}

/// Adds the instances of a list, each by its number in accel.listed_instances, as cells are.
void add_listed(Accel& accel, Geometry& geometry, std::uint32_t first, Column<PrimRef>& refs,
                ItemOrder& order) {
  InstanceList& list = std::get<InstanceList>(geometry.shape);
  const auto first_child = static_cast<std::uint32_t>(accel.listed_children.size());
  for (const auto& child : list.children) accel.listed_children.push_back(child.get());
  accel.listed_instances.reserve(accel.listed_instances.size() + list.places.size());
  for (std::uint32_t k = 0; k < list.places.size(); ++k) {
    const InstancePlace& place = list.places[k];
    const Affine to_world = geometry.transform * Affine::from_rows(place.to_list);
    if (place.child >= list.children.size() || !to_world.is_invertible()) continue;
    ListedInstance listed{{}, first_child + place.child, first + k, 0, place.user};
    to_world.inverse().to_rows(listed.to_child);
    const Affine to_child = Affine::from_rows(listed.to_child);
    if (!to_child.is_invertible()) continue;
    const Accel& child = *list.children[place.child];
    const Box box = instance_bounds(to_child.inverse(), child);
    const auto index = static_cast<std::uint32_t>(accel.listed_instances.size());
    if (!child.unbounded.empty()) {
      add_unbounded(accel, Kind::instance_list, index, order);
    } else if (is_usable(box)) {
      refs.push_back(make_ref(box, index, Kind::instance_list));
      accel.bounds.grow(box);
    } else {
      continue;
    }
    accel.listed_instances.push_back(listed);
  }
  list.places = {};
}

/// Adds everything but triangles. Returns how many references there are before each geometry.
std::vector<std::size_t> add_others(Accel& accel, Column<PrimRef>& refs, ItemOrder& order,
                                    const BuildOptions& options) {
  std::vector<std::size_t> first_ref;
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    first_ref.push_back(refs.size());
    const Geometry& geometry = accel.geometries[g];
    const Kind kind = kind_of(geometry);
    const std::uint32_t first = accel.first_item[g], end = accel.first_item[g + 1];
    if (!geometry.transform.is_invertible()) continue;
    if (kind == Kind::instance_list) {
      add_listed(accel, accel.geometries[g], first, refs, order);
      continue;
    }
    if (kind == Kind::triangle) continue;
    if (kind == Kind::csg) {
      add_combination(accel, geometry, first, options, refs, order);
      continue;
    }
    if (const auto* exact = std::get_if<ExactShape>(&geometry.shape)) {
      add_exact(accel, *exact, kind, geometry.transform, first, refs, order);
      continue;
    }
    for (std::uint32_t item = first; item < end; ++item) {
      if (is_unbounded(geometry)) {
        if (kind == Kind::plane && !(length(std::get<PlaneShape>(geometry.shape).normal) > 0)) continue;
        add_unbounded(accel, kind, item, order);
        continue;
      }
      const Box box =
          kind == Kind::instance
              ? instance_bounds(geometry.transform, *std::get<InstanceGeometry>(geometry.shape).child)
              : shape_bounds(geometry, item - first);
      if (!is_usable(box)) continue;
      refs.push_back(make_ref(box, item, kind));
      accel.bounds.grow(box);
    }
  }
  return first_ref;
}

/// Writes all references in the order of their geometries into arrays.refs: to triangles, and `others`, which
/// it uses up.
void add_references(Accel& accel, const MeshSource& meshes, Column<PrimRef>& others,
                    const std::vector<std::size_t>& first_other, BuildArrays& arrays, bool parallel) {
  const PrimRef* next = others.begin();
  const auto add_others_before = [&](const PrimRef* end) {
    arrays.populate(arrays.refs + arrays.count, static_cast<std::size_t>(end - next), parallel);
    for (; next != end; ++next) arrays.refs[arrays.count++] = *next;
  };
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    const bool usable = accel.geometries[g].transform.is_invertible();
    if (static_cast<Kind>(accel.kinds[g]) != Kind::triangle || !usable) continue;
    add_others_before(others.begin() + first_other[g]);
    accel.bounds.grow(meshes.add_references(g, arrays, parallel));
  }
  add_others_before(others.end());
  others.clear();
}

/// Makes tree, bounds and the order of the items, or takes them from the store.
void make_tree(Accel& accel, ItemOrder& order, const BuildOptions& options) {
  Column<PrimRef> others;
  const std::vector<std::size_t> first_other = add_others(accel, others, order, options);
  TreeStore* const store = tree_store();
  const bool keeps = store != nullptr && accel.stats.triangles >= store->least_triangles();
  const std::uint64_t key = keeps ? tree_key(accel, others, options) : 0;
  if (keeps && load_kept_tree(accel, order, others, key, *store)) return;
  {
    const MeshSource meshes(accel);
    BuildArrays arrays(others.size() + accel.stats.triangles, effort_of(options.quality));
    add_references(accel, meshes, others, first_other, arrays, options.parallel);
    build_tree(accel, arrays, meshes, order, options, build_kernels(available_isas().back()));
  }
  if (keeps) store->keep(key, accel, order);
}

/// Expected node and leaf visits of a random ray that meets the root's box (MacDonald and Booth 1990).
double sah_cost(const Accel& accel) {
  if (accel.root.is_leaf()) return accel.root.is_none() ? 0 : 1;
  const auto half_area = [](double x, double y, double z) { return x * y + y * z + z * x; };
  const Vec3d extent = Vec3d(accel.bounds.hi) - Vec3d(accel.bounds.lo);
  const double root = half_area(extent.x, extent.y, extent.z);
  double area = root;
  for (std::size_t n = 0; n < accel.stats.nodes; ++n) {
    const BvhNode& node = accel.nodes[n];
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      if (node.child[i].is_none()) continue;
      const auto width = [&](int axis) {
        return double(node.plane[2 * axis + 1][i]) - node.plane[2 * axis][i];
      };
      area += half_area(width(0), width(1), width(2));
    }
  }
  return root > 0 ? area / root : 0;
}

}  // namespace

Accel::Accel() = default;
Accel::~Accel() = default;

std::shared_ptr<const Accel> build_accel(std::vector<Geometry> geometries, const BuildOptions& options) {
  auto accel = std::make_shared<Accel>();
  wrap_sheared_shapes(geometries);
  accel->geometries = std::move(geometries);
  std::uint64_t items = 0;
  for (const Geometry& g : accel->geometries) {
    accel->first_item.push_back(static_cast<std::uint32_t>(items));
    items += item_count(g);
    accel->frames.push_back(
        {g.transform.inverse(), g.transform.is_identity(), g.transform.determinant() < 0});
    accel->kinds.push_back(static_cast<std::uint8_t>(kind_of(g)));
    accel->users.push_back(g.user);
    if (std::holds_alternative<MeshGeometry>(g.shape)) accel->stats.triangles += item_count(g);
    if (items >= kNoId) throw Error("more than 2^32 - 2 primitives in one structure");
  }
  accel->first_item.push_back(static_cast<std::uint32_t>(items));
  accel->stats.items = items;
  accel->one_item_each = true;
  for (std::size_t g = 0; g < accel->geometries.size(); ++g)
    accel->one_item_each &= accel->first_item[g + 1] == g + 1;

  ItemOrder order;
  make_tree(*accel, order, options);
  fill_pools(*accel, order);
  accel->stats.unbounded = accel->unbounded.size();
  accel->stats.sah_cost = sah_cost(*accel);
  note_missing_closest(*accel);
  return accel;
}

AccelStats stats(const Accel& accel) { return accel.stats; }
Box bounds(const Accel& accel) { return accel.bounds; }

}  // namespace oktett
