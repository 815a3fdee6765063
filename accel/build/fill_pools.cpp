#include "accel/build/fill_pools.h"

#include <algorithm>

#include "accel/geometry_bounds.h"
#include "core/error.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

/// Fills the pools in the order in which the leaves refer to them.
class PoolFiller {
 public:
  PoolFiller(Accel& accel, ItemOrder& order) : accel_(accel), order_(order) {}

  void run() {
    number_primitives();
    align_spheres();
    each<Sphere>(Kind::sphere, [](auto& pool, const Geometry& g, std::uint32_t local, std::uint32_t item) {
      Sphere::add(pool, moved_sphere(std::get<SpheresShape>(g.shape).spheres[local], g.transform), item);
    });
    each<Disk>(Kind::disk, [](auto& pool, const Geometry& g, std::uint32_t, std::uint32_t item) {
      const DiskShape& s = std::get<DiskShape>(g.shape);
      const Vec3d n = g.transform.inverse().normal_by_inverse(s.normal);
      Disk::add(pool, {g.transform.point(s.center), n, s.radius * g.transform.uniform_scale()}, item);
    });
    each<BoxSolid>(Kind::box, [](auto& pool, const Geometry& g, std::uint32_t, std::uint32_t item) {
      BoxSolid::add(pool, std::get<BoxShape>(g.shape), g.transform, item);
    });
    each<Polygon>(Kind::polygon, [](auto& pool, const Geometry& g, std::uint32_t, std::uint32_t item) {
      PolygonShape s = std::get<PolygonShape>(g.shape);
      for (Vec3d& v : s.vertices) v = g.transform.point(v);
      if (g.transform.determinant() < 0) std::reverse(s.vertices.begin(), s.vertices.end());
      Polygon::add(pool, s, item);
    });
    each<Plane>(Kind::plane, [](auto& pool, const Geometry& g, std::uint32_t, std::uint32_t item) {
      Plane::add(pool, moved_plane(std::get<PlaneShape>(g.shape), g.transform), item);
    });
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

  /// Calls add(pool, geometry, number within the geometry, item) for the items of a closed-form shape.
  template <class S, class Add>
  void each(Kind kind, Add&& add) {
    auto& pool = std::get<typename S::Pool>(accel_.pools);
    for (std::uint32_t item : order_[static_cast<int>(kind)]) {
      const std::uint32_t g = accel_.geometry_of(item);
      add(pool, accel_.geometries[g], item - accel_.first_item[g], item);
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
    for (std::uint32_t item : order_[static_cast<int>(Kind::instance)])
      steps.push_back({0, item, std::get<InstanceGeometry>(geometry(item).shape).child.get(), 0, false});
    for (const CsgItem& csg : accel_.combinations) steps.push_back({0, csg.item, csg.solids.get(), 0, true});
    for (std::uint32_t g = 0; g < accel_.geometries.size(); ++g)
      if (accel_.kinds[g] == static_cast<int>(Kind::instance_list) &&
          accel_.first_item[g] < accel_.first_item[g + 1])
        steps.push_back({0, accel_.first_item[g], nullptr, 1, false});
    std::sort(steps.begin(), steps.end(),
              [](const PathStep& a, const PathStep& b) { return a.item < b.item; });
    // Children that no instance shows need no numbers.
    for (const ListedInstance& listed : accel_.listed_instances) {
      std::uint32_t& stride = step_of(accel_.first_item[accel_.geometry_of(listed.item)]).stride;
      stride = std::max(stride, 1 + accel_.listed_children[listed.child]->path_count);
    }
    std::uint64_t paths = 0;
    for (PathStep& step : steps) {
      step.first_path = static_cast<std::uint32_t>(paths);
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
  std::uint32_t first_path(std::uint32_t item) const { return step_of(item).first_path; }

  void fill_instances() {
    for (std::uint32_t item : order_[static_cast<int>(Kind::instance)]) {
      const Geometry& g = geometry(item);
      InstanceItem instance{};
      g.transform.inverse().to_rows(instance.to_child);
      instance.child = std::get<InstanceGeometry>(g.shape).child.get();
      instance.item = item;
      instance.first_path = first_path(item);
      accel_.instances.push_back(instance);
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
      ordered.back().first_path = first_path(ordered.back().item);
      accel_.stats.other_bytes += sizeof(CsgItem) + ordered.back().nodes.size() * sizeof(CsgNode) +
                                  stats(*ordered.back().solids).bytes();
    }
    accel_.combinations = std::move(ordered);
  }

  const Geometry& geometry(std::uint32_t item) const { return accel_.geometries[accel_.geometry_of(item)]; }

  Accel& accel_;
  ItemOrder& order_;
};

}  // namespace

void fill_pools(Accel& accel, ItemOrder& order) { PoolFiller(accel, order).run(); }

}  // namespace oktett
