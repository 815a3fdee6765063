#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "accel/accel_data.h"
#include "accel/time/instance_motion.h"
#include "accel/time/scene_data.h"
#include "core/error.h"

namespace oktett {
namespace {

using UserShapePointer = std::shared_ptr<const UserShape>;

std::uint32_t key_count(const SceneGeometry& g) {
  if (const auto* const mesh = std::get_if<MovingMesh>(&g.shape))
    return 1 + static_cast<std::uint32_t>(mesh->later_positions.size());
  if (const auto* const shape = std::get_if<UserShapePointer>(&g.shape))
    return std::max(1u, (*shape)->key_count());
  if (const auto* const instance = std::get_if<SceneInstance>(&g.shape)) return key_count(*instance);
  if (const auto* const many = std::get_if<SceneInstances>(&g.shape)) return key_count(*many);
  return 1;
}

/// Of geometries that have items of their own in a tree that moves.
std::uint64_t item_count(const SceneGeometry& g) {
  if (const auto* const mesh = std::get_if<MovingMesh>(&g.shape)) return mesh->mesh->triangle_count();
  if (const auto* const shape = std::get_if<UserShapePointer>(&g.shape)) return (*shape)->primitive_count();
  if (const auto* const many = std::get_if<SceneInstances>(&g.shape)) return many->places.size();
  return 1;
}

// ---- What is refused.

[[noreturn]] void refuse(const SceneGeometry& g, const std::string& why) {
  throw Error("geometry " + std::to_string(g.number) + ": " + why);
}

void check(const SceneGeometry& g, const TriangleMesh& mesh) {
  for (const std::uint32_t index : mesh.indices)
    if (index >= mesh.positions.size())
      refuse(g, "a triangle has vertex " + std::to_string(index) + ", expected less than " +
                    std::to_string(mesh.positions.size()));
}

void check(const SceneGeometry& g, const MovingMesh& shape) {
  if (shape.mesh == nullptr || shape.later_positions.empty())
    refuse(g, "expected a mesh and at least two keys");
  for (const Column<Vec3f>& positions : shape.later_positions)
    if (positions.size() != shape.mesh->positions.size())
      refuse(g, "one key has " + std::to_string(shape.mesh->positions.size()) + " vertices, another " +
                    std::to_string(positions.size()));
  check(g, *shape.mesh);
}

void check(const SceneGeometry& g, const Geometry& shape) {
  if (g.tree != nullptr && g.tree->geometries.size() != 1)
    refuse(g, "a structure of one geometry was expected, that of " +
                  std::to_string(g.tree->geometries.size()) + " was given");
  if (std::holds_alternative<InstanceGeometry>(shape.shape) ||
      std::holds_alternative<InstanceList>(shape.shape))
    refuse(g, "an instance in a scene is a SceneInstance or SceneInstances");
}

void check(const SceneGeometry& g, const UserShapePointer& shape) {
  if (shape == nullptr) refuse(g, "expected a shape");
}

void check(const SceneGeometry& g, const SceneInstance& shape) {
  if (shape.child == nullptr || key_count(shape) == 0)
    refuse(g, "expected a scene and at least one transform");
}

void check(const SceneGeometry& g, const SceneInstances& shape) {
  for (const SceneInstances::Place& place : shape.places)
    if (place.child >= shape.children.size() || shape.children[place.child] == nullptr)
      refuse(g, "an instance shows scene " + std::to_string(place.child) + " of " +
                    std::to_string(shape.children.size()));
  const auto check_keys = [&](const auto& keys) {
    for (const auto& key : keys)
      if (key.size() != shape.places.size())
        refuse(g, "one key has " + std::to_string(key.size()) + " transforms of " +
                      std::to_string(shape.places.size()) + " instances");
  };
  check_keys(shape.later_transforms), check_keys(shape.turning);
}

// ---- What does not move.

/// Calls f(child) for the scenes that a geometry shows.
template <class Function>
void each_child(const SceneGeometry& g, Function&& f) {
  if (const auto* const one = std::get_if<SceneInstance>(&g.shape)) f(*one->child);
  if (const auto* const many = std::get_if<SceneInstances>(&g.shape))
    for (const auto& child : many->children)
      if (child != nullptr) f(*child);
}

/// Whether a geometry can stand in an Accel: neither it nor anything that it shows moves or is called.
bool is_fixed(const SceneGeometry& g) {
  if (std::holds_alternative<Geometry>(g.shape)) return true;
  if (std::holds_alternative<MovingMesh>(g.shape) || std::holds_alternative<UserShapePointer>(g.shape))
    return false;
  bool fixed = key_count(g) == 1;
  each_child(g, [&](const TraceScene& child) { fixed &= child.moving.empty(); });
  return fixed;
}

Column<Vec3f> normals_of(const TriangleMesh& mesh, bool parallel) {
  Column<Vec3f> normals;
  normals.resize_uninitialized(mesh.triangle_count());
  constexpr std::size_t kPiece = 1 << 14;
  const auto piece = [&](std::size_t k) {
    for (std::size_t t = k * kPiece; t < std::min(normals.size(), (k + 1) * kPiece); ++t) {
      const std::uint32_t* const i = &mesh.indices[3 * t];
      normals[t] = triangle_normal(mesh.positions[i[0]], mesh.positions[i[1]], mesh.positions[i[2]]);
    }
  };
  const std::size_t pieces = (normals.size() + kPiece - 1) / kPiece;
  if (parallel)
    tbb::parallel_for(std::size_t{0}, pieces, piece);
  else
    for (std::size_t k = 0; k < pieces; ++k) piece(k);
  return normals;
}

void build_fixed(TraceScene& scene, const BuildOptions& options) {
  std::vector<Geometry> fixed;
  const auto add = [&](std::uint32_t g, std::uint32_t index, Geometry geometry) {
    geometry.mask = ~0u, geometry.user = scene.geometries[g].number;
    fixed.push_back(std::move(geometry));
    scene.fixed_geometries.push_back({{g, index}, {}});
  };
  const auto instance = [](const TraceScene& child, const Affine& transform) {
    Geometry geometry;
    geometry.shape = InstanceGeometry{child.fixed};
    geometry.transform = transform;
    return geometry;
  };
  for (std::uint32_t g = 0; g < scene.geometries.size(); ++g) {
    const SceneGeometry& own = scene.geometries[g];
    if (!is_fixed(own)) continue;
    if (const auto* const shape = std::get_if<Geometry>(&own.shape)) {
      Geometry geometry = *shape;
      if (own.tree != nullptr) geometry.shape = InstanceGeometry{own.tree};
      add(g, 0, std::move(geometry));
    }
    if (const auto* const one = std::get_if<SceneInstance>(&own.shape))
      add(g, 0, instance(*one->child, map_at(*one, {})));
    if (const auto* const many = std::get_if<SceneInstances>(&own.shape))
      for (std::uint32_t k = 0; k < many->places.size(); ++k)
        add(g, k, instance(scene.child(g, k), map_at(*many, k, {})));
  }
  BuildOptions plain = options;
  plain.mask = ~0u;
  scene.fixed = build_accel(std::move(fixed), plain);
  scene.has_pieces |= scene.fixed->pieces;
  scene.bounds.grow(scene.fixed->bounds);
  for (std::size_t g = 0; g < scene.fixed_geometries.size(); ++g) {
    const auto* const shape = std::get_if<MeshGeometry>(&scene.fixed->geometries[g].shape);
    if (shape != nullptr && scene.fixed->frames[g].identity)
      scene.fixed_geometries[g].normals = normals_of(*shape->mesh, options.parallel);
  }
}

// ---- What moves.

class MovingSource final : public TimeSource {
 public:
  MovingSource(const TraceScene& scene, const ItemTable& items) : scene_(scene), items_(items) {}

  std::uint32_t count() const override { return items_.count(); }
  bool is_triangle(std::uint32_t item) const override {
    return std::holds_alternative<MovingMesh>(scene_.geometries[items_[item].geometry].shape);
  }
  void corners(std::uint32_t item, std::uint32_t key, Vec3f (&v)[3]) const override {
    const ItemTable::Place place = items_[item];
    const auto& shape = std::get<MovingMesh>(scene_.geometries[place.geometry].shape);
    const Column<Vec3f>& positions = key == 0 ? shape.mesh->positions : shape.later_positions[key - 1];
    const std::uint32_t* const index = &shape.mesh->indices[3 * std::size_t{place.primitive}];
    for (int k = 0; k < 3; ++k) v[k] = positions[index[k]];
  }
  Box bounds(std::uint32_t item, std::uint32_t key) const override {
    const ItemTable::Place place = items_[item];
    const SceneGeometry& g = scene_.geometries[place.geometry];
    if (const auto* const shape = std::get_if<UserShapePointer>(&g.shape))
      return (*shape)->bounds(place.primitive, key);
    const Box& inner = scene_.child(place.geometry, place.primitive).bounds;
    if (const auto* const one = std::get_if<SceneInstance>(&g.shape)) return moved_bounds(*one, inner, key);
    return moved_bounds(std::get<SceneInstances>(g.shape), place.primitive, inner, key);
  }

 private:
  const TraceScene& scene_;
  const ItemTable& items_;
};

void build_moving(TraceScene& scene, const BuildOptions& options) {
  std::map<std::tuple<std::uint32_t, float, float>, ItemTable> by_keys;
  const auto add = [&](std::uint32_t g) {
    const SceneGeometry& own = scene.geometries[g];
    each_child(own, [&](const TraceScene& child) {
      if (!child.fixed->unbounded.empty())
        refuse(own,
               "a scene with something unbounded in it can be shown neither moving nor beside shapes "
               "of the program");
    });
    const std::uint32_t keys = key_count(own);
    ItemTable& items =
        by_keys[keys < 2 ? std::tuple{keys, 0.0f, 1.0f} : std::tuple{keys, own.begin, own.end}];
    const std::uint64_t end = items.count() + item_count(own);
    if (end >= kNoId) throw Error("more than 2^32 - 2 primitives in one scene");
    items.geometry.push_back(g), items.first.push_back(static_cast<std::uint32_t>(end));
  };
  // At equal distance the lowest item counts, and instances come last.
  for (const bool instances : {false, true})
    for (std::uint32_t g = 0; g < scene.geometries.size(); ++g)
      if (!is_fixed(scene.geometries[g]) && is_instance(scene.geometries[g]) == instances) add(g);
  for (auto& [range, items] : by_keys) {
    MovingPart& part = scene.moving.emplace_back();
    part.items = std::move(items);
    part.begin = std::get<1>(range), part.end = std::get<2>(range);
    part.tree = build_time_tree(std::get<0>(range), MovingSource(scene, part.items), options);
    scene.bounds.grow(part.tree->bounds);
  }
}

void note_children(TraceScene& scene) {
  for (const SceneGeometry& g : scene.geometries) {
    if (const auto* const fixed = std::get_if<Geometry>(&g.shape))
      scene.has_simple_hits &= std::holds_alternative<MeshGeometry>(fixed->shape) ||
                               std::holds_alternative<SpheresShape>(fixed->shape);
    scene.has_pieces |= g.tree != nullptr && g.tree->pieces;
    scene.has_masks |= g.mask != ~0u;
    scene.has_closest_filters |= g.closest_filter != nullptr,
        scene.has_any_filters |= g.any_filter != nullptr;
    each_child(g, [&](const TraceScene& child) {
      scene.levels = std::max(scene.levels, child.levels + 1);
      if (scene.levels > InstanceChain::kMost)
        refuse(g, "instances are nested deeper than " + std::to_string(InstanceChain::kMost) + " levels");
      scene.has_simple_hits &= child.has_simple_hits;
      scene.has_pieces |= child.has_pieces;
      scene.has_masks |= child.has_masks;
      scene.has_closest_filters |= child.has_closest_filters, scene.has_any_filters |= child.has_any_filters;
    });
  }
}

}  // namespace

std::shared_ptr<const TraceScene> build_trace_scene(std::vector<SceneGeometry> geometries,
                                                    const BuildOptions& options) {
  auto scene = std::make_shared<TraceScene>();
  scene->geometries = std::move(geometries);
  std::set<std::uint32_t> numbers;
  for (const SceneGeometry& g : scene->geometries) {
    if (g.number == kNoId || !numbers.insert(g.number).second)
      refuse(g, "each geometry has a number of its own, less than 2^32 - 1");
    if (!(g.begin < g.end)) refuse(g, "its range of times ends before it begins");
    std::visit([&](const auto& shape) { check(g, shape); }, g.shape);
  }
  note_children(*scene);
  build_fixed(*scene, options);
  build_moving(*scene, options);
  const bool is_judged = !scene->moving.empty() || scene->has_masks;
  scene->is_plain_closest = !is_judged && !scene->has_closest_filters;
  scene->is_plain_any = !is_judged && !scene->has_any_filters;
  return scene;
}

SceneBounds bounds(const TraceScene& scene) {
  SceneBounds b{scene.fixed->bounds, scene.fixed->bounds};
  for (const MovingPart& part : scene.moving) b.first.grow(part.tree->first), b.last.grow(part.tree->last);
  return b;
}

}  // namespace oktett
