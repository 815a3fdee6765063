/// \file From geometries to a tree: numbers the items and drops degenerate ones.

#include <algorithm>
#include <cmath>

#include "accel/build/build_parts.h"
#include "accel/build/mesh_source.h"
#include "accel/build/refit.h"
#include "accel/build/tree_store.h"
#include "accel/build/wide_tree.h"
#include "accel/closest.h"
#include "accel/csg/csg.h"
#include "accel/geometry_bounds.h"
#include "accel/winding/winding_field.h"
#include "core/error.h"
#include "core/memory.h"
#include "kernels/exact_ops.h"

namespace oktett {

// ---- The pools, laid out in the order in which the leaves refer to them.

namespace {

/// Fills the pools in the order in which the leaves refer to them.
class PoolFiller {
 public:
  PoolFiller(Accel& accel, ItemOrder& order) : accel_(accel), order_(order) {}

  void run() {
    number_primitives();
    align_spheres();
    each_closed_form([&]<class S>(S, Kind kind) { fill_pool<S>(kind); });
    for (int kind = 0; kind < kKinds; ++kind)
      if (accel_.exact[kind]) arrange_cells(static_cast<Kind>(kind), *accel_.exact[kind]);
    number_paths();
    fill_instances();
    arrange_listed();
    arrange_combinations();
  }

 private:
  /// Gives every primitive of a closed-form or exact shape and every listed instance a place in pool_index.
  void number_primitives() {
    std::uint32_t count = 0;
    std::vector<std::uint32_t> first(accel_.geometries.size());
    for (std::uint32_t g = 0; g < first.size(); ++g) {
      first[g] = count;
      const auto kind = static_cast<Kind>(accel_.kinds[g]);
      if (is_shape(kind) || kind == Kind::instance_list)
        count += accel_.first_item[g + 1] - accel_.first_item[g];
    }
    if (count == 0) return;
    accel_.first_pool_index = std::move(first);
    accel_.pool_index.resize(count, kNoId);
  }

  /// Moves the spheres of each leaf to a multiple of eight, so that they share one cache line of each column
  /// of doubles. The gaps are filled by spheres that no leaf refers to there.
  void align_spheres() {
    std::vector<std::uint32_t>& order = order_[static_cast<int>(Kind::sphere)];
    std::vector<std::uint32_t> aligned;
    for (LeafEntry& leaf : accel_.leaves) {
      if (leaf.kind != Kind::sphere) continue;
      const std::uint32_t* items = order.data() + leaf.begin;
      while (aligned.size() % TriangleBlock::kSize != 0) aligned.push_back(items[0]);
      leaf.begin = static_cast<std::uint32_t>(aligned.size());
      aligned.insert(aligned.end(), items, items + leaf.count);
    }
    order = std::move(aligned);
  }

  /// Sets what Accel::index_in_pool() returns for `item`.
  void set_pool_index(std::uint32_t item, std::uint32_t index) {
    const std::uint32_t g = accel_.geometry_of(item);
    accel_.pool_index[accel_.first_pool_index[g] + item - accel_.first_item[g]] = index;
  }

  /// Fills the pool of a closed form.
  template <class S>
  void fill_pool(Kind kind) {
    auto& pool = std::get<typename S::Pool>(accel_.pools);
    for (std::uint32_t item : order_[static_cast<int>(kind)]) {
      const std::uint32_t number = accel_.geometry_of(item);
      const Geometry& g = accel_.geometries[number];
      const auto& data = std::get<typename S::Data>(g.shape);
      S::add(pool, nth_shape<S>(data, item - accel_.first_item[number]), g.transform, item);
    }
    for (std::uint32_t i = 0; i < pool.item.size(); ++i) set_pool_index(pool.item[i], i);
    S::finish(pool);
    accel_.stats.other_bytes += pool.bytes();
  }

  /// Brings the cells of an exact kind into leaf order.
  void arrange_cells(Kind kind, ExactPoolBase& pool) {
    std::vector<ExactCell> cells;
    for (std::uint32_t cell : order_[static_cast<int>(kind)]) cells.push_back(pool.cells[cell]);
    pool.cells = std::move(cells);
    for (std::uint32_t i = 0; i < pool.frames.size(); ++i) set_pool_index(pool.frames[i].item, i);
    accel_.stats.other_bytes += exact_ops(kind).bytes(pool);
  }

  /// Numbers the paths in the order of items, so that hits at equal distance keep the order of the scene.
  void number_paths() {
    std::vector<PathStep>& steps = accel_.path_steps;
    // Also of those that are left out.
    for (std::uint32_t g = 0; g < accel_.geometries.size(); ++g)
      if (const auto* instance = std::get_if<InstanceGeometry>(&accel_.geometries[g].shape))
        steps.push_back({0, accel_.first_item[g], instance->child.get(), 0, false});
    for (const CsgItem& csg : accel_.combinations) steps.push_back({0, csg.item, csg.solids.get(), 0, true});
    for (std::uint32_t g = 0; g < accel_.geometries.size(); ++g)
      if (accel_.kinds[g] == static_cast<int>(Kind::instance_list) &&
          accel_.first_item[g] < accel_.first_item[g + 1])
        steps.push_back({0, accel_.first_item[g], nullptr, 1, false});
    const auto by_item = [](const PathStep& a, const PathStep& b) { return a.item < b.item; };
    if (!std::is_sorted(steps.begin(), steps.end(), by_item)) std::sort(steps.begin(), steps.end(), by_item);
    // Children that no instance shows need no numbers.
    for (const ListedInstance& listed : accel_.listed_instances) {
      std::uint32_t& stride = step_of(accel_.first_item[accel_.geometry_of(listed.item)]).stride;
      stride = std::max(stride, 1 + accel_.listed_children[listed.child]->path_count);
    }
    std::uint64_t paths = 0;
    first_path_of_.resize(accel_.geometries.size());
    for (PathStep& step : steps) {
      step.first_path = static_cast<std::uint32_t>(paths);
      first_path_of_[accel_.geometry_of(step.item)] = step.first_path;
      if (step.stride != 0) {
        const std::uint32_t g = accel_.geometry_of(step.item);
        paths += std::uint64_t{step.stride} * (accel_.first_item[g + 1] - step.item);
      } else {
        paths += (1 + std::uint64_t{step.child->path_count}) * (step.is_combination ? 2 : 1);
      }
      if (paths >= kNoId) throw Error("more than 2^32 - 2 nested instances");
    }
    accel_.path_count = static_cast<std::uint32_t>(paths);
  }

  PathStep& step_of(std::uint32_t item) const {
    std::vector<PathStep>& steps = accel_.path_steps;
    return *std::lower_bound(steps.begin(), steps.end(), item,
                             [](const PathStep& step, std::uint32_t value) { return step.item < value; });
  }

  void fill_instances() {
    for (std::uint32_t item : order_[static_cast<int>(Kind::instance)]) {
      const std::uint32_t g = accel_.geometry_of(item);
      InstanceItem& instance = accel_.instances.emplace_back();
      accel_.frames[g].inverse.to_rows(instance.to_child);
      instance.child = std::get<InstanceGeometry>(accel_.geometries[g].shape).child.get();
      instance.item = item;
      instance.first_path = first_path_of_[g];
    }
    accel_.stats.other_bytes += accel_.instances.size() * sizeof(InstanceItem);
  }

  /// Brings the listed instances into leaf order.
  void arrange_listed() {
    const std::vector<std::uint32_t>& order = order_[static_cast<int>(Kind::instance_list)];
    std::vector<ListedInstance> ordered;
    ordered.reserve(order.size());
    for (const std::uint32_t index : order) {
      ListedInstance& listed = ordered.emplace_back(accel_.listed_instances[index]);
      const std::uint32_t g = accel_.geometry_of(listed.item), local = listed.item - accel_.first_item[g];
      const PathStep& step = step_of(accel_.first_item[g]);
      listed.first_path = step.first_path + local * step.stride;
      set_pool_index(listed.item, static_cast<std::uint32_t>(ordered.size() - 1));
    }
    accel_.listed_instances = std::move(ordered);
    accel_.stats.other_bytes += accel_.listed_instances.size() * sizeof(ListedInstance);
  }

  /// Brings the combinations into leaf order.
  void arrange_combinations() {
    std::vector<CsgItem> ordered;
    for (std::uint32_t index : order_[static_cast<int>(Kind::csg)]) {
      ordered.push_back(std::move(accel_.combinations[index]));
      ordered.back().first_path = first_path_of_[accel_.geometry_of(ordered.back().item)];
      accel_.stats.other_bytes += sizeof(CsgItem) + ordered.back().nodes.size() * sizeof(CsgNode) +
                                  stats(*ordered.back().solids).bytes();
    }
    accel_.combinations = std::move(ordered);
  }

  Accel& accel_;
  ItemOrder& order_;
  std::vector<std::uint32_t> first_path_of_;  ///< of each geometry that rays enter
};

}  // namespace

/// Fills the pools of `accel`, its instances and combinations, and numbers the paths through them. Cells of
/// exact surfaces, listed instances and combinations are there already and are brought into order.
/// Moves the leaves of spheres to multiples of eight, in `order` too.
static void fill_pools(Accel& accel, ItemOrder& order) { PoolFiller(accel, order).run(); }

namespace {

std::size_t item_count(const Geometry& g) {
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) return mesh->mesh->triangle_count();
  if (const auto* list = std::get_if<InstanceList>(&g.shape)) return list->places.size();
  std::size_t count = 1;
  visit_closed_form(g.shape, [&]<class S>(S, Kind, const auto& data) { count = shape_count<S>(data); });
  return count;
}

/// Whether the transform of each geometry is invertible; others are left out.
using Usable = std::vector<bool>;

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
  for (Geometry& g : geometries)
    if (is_wrapped(g)) g = as_instance(std::move(g));
}

/// An entry of the list beside the tree, which every ray is tested against: the next item of its kind.
void add_unbounded(Accel& accel, Kind kind, std::uint32_t item, ItemOrder& order) {
  std::vector<std::uint32_t>& list = order[static_cast<int>(kind)];
  accel.unbounded.push_back({static_cast<std::uint32_t>(list.size()), 1, kind, TriangleTest::watertight});
  list.push_back(item);
}

/// Adds the shapes of a geometry of a closed form.
template <class S>
void add_closed_form(Accel& accel, const Geometry& geometry, const typename S::Data& data, Kind kind,
                     std::uint32_t first, Column<PrimRef>& refs, ItemOrder& order) {
  const auto count = static_cast<std::uint32_t>(shape_count<S>(data));
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& shape = nth_shape<S>(data, i);
    if (!kHasBounds<S> && !S::is_empty(shape)) add_unbounded(accel, kind, first + i, order);
    const Box box = moved_bounds<S>(shape, geometry.transform);
    if (!is_usable(box)) continue;
    refs.push_back(make_ref(box, first + i, kind));
    accel.bounds.grow(box);
  }
}

/// Adds an instance.
void add_instance(Accel& accel, const Geometry& geometry, std::uint32_t item, Column<PrimRef>& refs,
                  ItemOrder& order) {
  const Accel& child = *std::get<InstanceGeometry>(geometry.shape).child;
  if (!child.unbounded.empty()) return add_unbounded(accel, Kind::instance, item, order);
  const Box box = instance_bounds(geometry.transform, child);
  if (!is_usable(box)) return;
  refs.push_back(make_ref(box, item, Kind::instance));
  accel.bounds.grow(box);
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
std::vector<std::size_t> add_others(Accel& accel, const Usable& usable, Column<PrimRef>& refs,
                                    ItemOrder& order, const BuildOptions& options) {
  std::vector<std::size_t> first_ref;
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    first_ref.push_back(refs.size());
    const Geometry& geometry = accel.geometries[g];
    const Kind kind = kind_of(geometry);
    const std::uint32_t first = accel.first_item[g];
    if (!usable[g]) continue;
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
    if (kind == Kind::instance) add_instance(accel, geometry, first, refs, order);
    visit_closed_form(geometry.shape, [&]<class S>(S, Kind, const auto& data) {
      add_closed_form<S>(accel, geometry, data, kind, first, refs, order);
    });
  }
  return first_ref;
}

/// Writes all references in the order of their geometries into arrays.refs: to triangles, and `others`, which
/// it uses up.
void add_references(Accel& accel, const Usable& usable, const MeshSource& meshes, Column<PrimRef>& others,
                    const std::vector<std::size_t>& first_other, BuildArrays& arrays, bool parallel) {
  const PrimRef* next = others.begin();
  const auto add_others_before = [&](const PrimRef* end) {
    arrays.populate(arrays.refs + arrays.count, static_cast<std::size_t>(end - next), parallel);
    for (; next != end; ++next) arrays.refs[arrays.count++] = *next;
  };
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    if (static_cast<Kind>(accel.kinds[g]) != Kind::triangle || !usable[g]) continue;
    add_others_before(others.begin() + first_other[g]);
    accel.bounds.grow(meshes.add_references(g, arrays, parallel));
  }
  add_others_before(others.end());
  others.clear();
}

/// Whether there is memory for a tree is asked for so many triangles or more.
constexpr std::size_t kMuchWork = 4'000'000;

/// The geometries whose triangles are in the tree.
std::vector<std::uint32_t> usable_meshes(const Accel& accel, const Usable& usable) {
  std::vector<std::uint32_t> meshes;
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g)
    if (static_cast<Kind>(accel.kinds[g]) == Kind::triangle && usable[g]) meshes.push_back(g);
  return meshes;
}

/// Makes tree, bounds and the order of the items, or takes them from the store.
void make_tree(Accel& accel, const Usable& usable, ItemOrder& order, const BuildOptions& options) {
  Column<PrimRef> others;
  const std::vector<std::size_t> first_other = add_others(accel, usable, others, order, options);
  TreeStore* const store = tree_store();
  const bool keeps = store != nullptr && accel.stats.triangles >= store->least_triangles();
  const std::uint64_t key = keeps ? tree_key(accel, others, options) : 0;
  if (keeps && load_kept_tree(accel, order, others, key, *store)) return;
  {
    const MeshSource meshes(accel);
    const BuildKernels& kernels = build_kernels(available_isas().back());
    const std::size_t most = others.size() + accel.stats.triangles;
    if (accel.stats.triangles >= kMuchWork) expect_memory(accel.stats.triangles, options, available_memory());
    if (most > options.together) {
      build_in_parts(accel, meshes, usable_meshes(accel, usable), others, order, options, kernels);
    } else {
      BuildArrays arrays(most, effort_of(options.quality));
      add_references(accel, usable, meshes, others, first_other, arrays, options.parallel);
      build_tree(accel, arrays, meshes, order, options, kernels);
    }
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

bool is_wrapped(const Geometry& g) {
  bool needs_similarity = false;
  visit_closed_form(g.shape, [&]<class S>(S, Kind, const auto&) { needs_similarity = S::kNeedsSimilarity; });
  return needs_similarity && g.transform.is_invertible() && g.transform.uniform_scale() == 0;
}

PointAnswers::PointAnswers() = default;
PointAnswers::~PointAnswers() = default;
Accel::Accel() : answers(std::make_unique<PointAnswers>()) {}
Accel::~Accel() = default;

/// A geometry with a singular transform is left out, but counts.
static void leave_out(std::vector<Geometry>& geometries, std::uint32_t mask) {
  for (Geometry& g : geometries)
    if ((g.mask & mask) == 0) g.transform = Affine::scaling({0, 0, 0});
}

std::shared_ptr<const Accel> build_accel(std::vector<Geometry> geometries, const BuildOptions& options) {
  auto accel = std::make_shared<Accel>();
  wrap_sheared_shapes(geometries);
  leave_out(geometries, options.mask);
  accel->geometries = std::move(geometries);
  std::uint64_t items = 0;
  Usable usable;
  const std::size_t count = accel->geometries.size();
  accel->first_item.reserve(count + 1), accel->frames.reserve(count), usable.reserve(count);
  accel->kinds.reserve(count), accel->users.reserve(count);
  for (const Geometry& g : accel->geometries) {
    accel->first_item.push_back(static_cast<std::uint32_t>(items));
    items += item_count(g);
    GeometryFrame& frame = accel->frames.emplace_back();
    frame.inverse = g.transform.inverse();
    usable.push_back(g.transform.is_invertible(frame.inverse));
    frame.identity = g.transform.is_identity(), frame.mirrored = g.transform.determinant() < 0;
    accel->has_mirrors |= accel->frames.back().mirrored;
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
  make_tree(*accel, usable, order, options);
  fill_pools(*accel, order);
  accel->stats.unbounded = accel->unbounded.size();
  accel->stats.sah_cost = sah_cost(*accel);
  note_missing_closest(*accel);
  return accel;
}

AccelStats stats(const Accel& accel) { return accel.stats; }
Box bounds(const Accel& accel) { return accel.bounds; }

}  // namespace oktett
