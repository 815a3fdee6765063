#include "io/scene/scene_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/memory.h"
#include "io/mesh/contour/contour.h"
#include "io/mesh/file_scene.h"
#include "io/mesh/reading.h"
#include "io/scene/shape_mesh.h"
#include "render/geometry.h"
#include "render/solids.h"

namespace oktett {
namespace {

/// Most places where meshes are shown.
constexpr std::size_t kMostPlacements = 50'000'000;
/// Memory that a triangle takes on the way to a file, with its share of vertices.
constexpr std::uint64_t kBytesOfTriangle = 160;

/// Where refining begins.
constexpr std::uint32_t kFirstCells = 16;

/// A place of an object.
struct ObjectPlace {
  const Object* object;
  Affine to_world;         ///< from its shape's space
  std::uint32_t material;  ///< that of an instance around it; kNoId for its own
};

/// Finds the places of all objects.
class Flattening {
 public:
  Flattening(const Scene& scene, const std::string& select) : scene_(scene), select_(select) {}

  std::vector<ObjectPlace> run() {
    add(scene_.objects, {}, kNoId, select_.empty());
    return std::move(places_);
  }

 private:
  void add(const std::vector<Object>& objects, const Affine& outer, std::uint32_t material, bool selected) {
    for (const Object& object : objects) {
      const bool taken = selected || object.name == select_;
      const Affine to_world = outer * object.transform;
      const std::uint32_t own = material != kNoId ? material : object.material;
      if (const auto* const instance = std::get_if<InstanceShape>(&object.shape)) {
        if (instance->prototype >= scene_.prototypes.size()) continue;
        const Prototype& prototype = scene_.prototypes[instance->prototype];
        add(prototype.objects, to_world, own, taken || prototype.name == select_);
      } else if (taken && to_world.is_invertible()) {
        if (places_.size() == kMostPlacements)
          throw Error(
              Location{scene_.source},
              fmt::format("instances show more than {} objects, too many for one mesh", kMostPlacements));
        places_.push_back({&object, to_world, own});
      }
    }
  }

  const Scene& scene_;
  const std::string& select_;
  std::vector<ObjectPlace> places_;
};

bool has_instances(const Object& object) {
  const auto* const csg = std::get_if<CsgShape>(&object.shape);
  if (csg == nullptr) return std::holds_alternative<InstanceShape>(object.shape);
  return std::ranges::any_of(*csg->operands, has_instances);
}

/// The lengths to which a map stretches the axes.
Vec3d stretch(const Affine& map) {
  Vec3d s;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    s[k] = length(map.vector(axis));
  }
  return s;
}

/// The mesh of one object, and the map from it to the space of the object's shape.
struct ObjectMesh {
  std::shared_ptr<TriangleMesh> mesh;
  std::vector<std::uint32_t> slots;  ///< materials
  Affine to_shape;
};

class SceneMeshing {
 public:
  SceneMeshing(const Scene& scene, const SceneMeshOptions& options) : scene_(scene), options_(options) {}

  MeshFile run() {
    const std::vector<ObjectPlace> places = Flattening(scene_, options_.select).run();
    if (places.empty() && !options_.select.empty())
      throw Error(Location{scene_.source}, "no object is named " + quote_name(options_.select));
    std::map<const Object*, double> scales;
    for (const ObjectPlace& place : places) {
      double& scale = scales[place.object];
      scale = std::max(scale, max_component(stretch(place.to_world)));
    }
    FileScene all;
    all.warnings = scene_.warnings;
    warnings_ = &all.warnings;
    std::uint64_t triangles = 0;
    std::set<const Object*> bare;
    for (const ObjectPlace& place : places) {
      if (place.material < scene_.materials.size() && !scene_.materials[place.material].surface) {
        if (bare.insert(place.object).second) warn(*place.object, "only bounds a medium and is left out");
        continue;
      }
      const ObjectMesh& made = mesh_of(*place.object, scales[place.object]);
      if (made.mesh == nullptr) continue;
      all.placements.push_back(
          {place.object->name, shared(all, place, made), place.to_world * made.to_shape});
      triangles += made.mesh->triangle_count();
    }
    check_room(triangles);
    all.materials = scene_.materials, all.textures = scene_.textures, all.media = scene_.media;
    MeshFile file = join_placements(scene_.source, std::move(all));
    file.mesh.origin = file.mesh.origin + scene_.origin;
    return file;
  }

 private:
  void check_room(std::uint64_t triangles) const {
    const std::uint64_t needed = triangles * kBytesOfTriangle, free = available_memory();
    if (needed > free)
      throw Error(
          Location{scene_.source},
          fmt::format("a mesh of {} triangles takes {} of memory, and {} are free; ask for fewer cells, "
                      "or for some of the objects",
                      triangles, memory_text(needed), memory_text(free)));
  }

  /// The number of the mesh with the material of a place.
  std::uint32_t shared(FileScene& all, const ObjectPlace& place, const ObjectMesh& made) {
    const auto [found, is_new] =
        shared_.try_emplace({place.object, place.material}, static_cast<std::uint32_t>(all.meshes.size()));
    if (is_new) {
      SharedMesh mesh{place.object->name, made.mesh, made.slots};
      // Operands of combinations have the material of the combination already.
      const bool outer = place.material != place.object->material;
      if (place.material != kNoId && (outer || !std::holds_alternative<CsgShape>(place.object->shape)))
        std::ranges::fill(mesh.slots, place.material);
      all.meshes.push_back(std::move(mesh));
    }
    return found->second;
  }

  const ObjectMesh& mesh_of(const Object& object, double scale) {
    const auto [found, is_new] = meshes_.try_emplace(&object);
    if (is_new) {
      found->second =
          std::visit([&](const auto& shape) { return convert(shape, object, scale); }, object.shape);
      const TriangleMesh* const mesh = found->second.mesh.get();
      if (mesh != nullptr && mesh->triangle_count() == 0) found->second.mesh.reset();
    }
    return found->second;
  }

  void warn(const Object& object, const std::string& what) {
    std::string name = shape_name(object.shape);
    if (!object.name.empty()) name += " " + quote_name(object.name);
    warnings_->push_back({object.where, "the " + name + " " + what});
  }

  // ---- Shapes.

  ObjectMesh convert(const MeshShape& shape, const Object& object, double) {
    if (shape.mesh == nullptr) return {};
    if (shape.stroke_width > 0) {
      warn(object, "of points and lines is left out");
      return {};
    }
    auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
    mesh->origin = {};
    if (!shape.smooth) mesh->normals.clear(), mesh->normal_indices.clear(), mesh->tangents.clear();
    std::size_t slots = std::max<std::size_t>(shape.slot_materials.size(), 1);
    for (const std::uint16_t slot : mesh->material_slots) slots = std::max<std::size_t>(slots, slot + 1u);
    std::vector<std::uint32_t> materials = shape.slot_materials;
    materials.resize(slots, kNoId);
    return {std::move(mesh), std::move(materials), {}};
  }
  ObjectMesh convert(const InstanceShape&, const Object&, double) { return {}; }

  template <class T>
  ObjectMesh convert(const T& shape, const Object& object, double scale) {
    // Of a circle; as many corners as keep its polygon within the tolerance.
    const double off = options_.tolerance > 0 ? options_.tolerance / (scale * radius_of(shape)) : 0;
    const double least =
        off > 0 ? std::numbers::pi / std::acos(1 - std::min(off, 1.0)) : 3.0 * options_.resolution;
    const auto around = static_cast<std::uint32_t>(std::clamp(std::ceil(least), 16.0, 1e5));
    if (std::optional<TriangleMesh> mesh = plain_mesh(Shape(shape), around))
      return {std::make_shared<TriangleMesh>(std::move(*mesh)), {object.material}, {}};
    return sampled(object, scale);
  }

  template <class T>
  static double radius_of(const T& shape) {
    if constexpr (std::is_same_v<T, DiskShape>)
      return shape.radius;
    else
      return 1;
  }

  ObjectMesh sampled(const Object& object, double scale) {
    // The object alone, first in its own space, then so that it is about 2 in size.
    Scene alone;
    alone.materials = scene_.materials;
    if (has_instances(object)) alone.prototypes = scene_.prototypes;
    alone.objects.push_back(object);
    Object& only = alone.objects.front();
    const Vec3d stretched = stretch(object.transform);
    only.motion = nullptr, only.transform = {};
    only.visible_to = kAllRays, only.shadow_catcher = false;
    {
      const World world = build_world(alone);
      const Box box = world.bounds;
      if (stats(*world.accel).unbounded > 0) {
        warn(object, "has no end and is left out");
        return {};
      }
      if (box.empty()) return {};
      const Vec3d extent = Vec3d(box.extent()) * stretched;
      const double size = max_component(extent);
      if (!(size > 0) || !is_finite(Vec3d(box.center()))) return {};
      only.transform = Affine::scaling(stretched * (2 / size)) * Affine::translation(-Vec3d(box.center()));
    }
    if (!only.transform.is_invertible()) return {};
    ObjectMesh made;
    made.to_shape = only.transform.inverse();
    const double to_world = scale * max_component(stretch(made.to_shape));
    std::uint32_t cells = options_.tolerance > 0 ? kFirstCells : options_.resolution;
    for (;;) {
      only.shape = object.shape;
      leave_out_details(only.shape, cells);
      // A mesh has no point that rays see it from.
      if (auto* const csg = std::get_if<CsgShape>(&only.shape)) csg->windows = nullptr;
      const World world = build_world(alone);
      Contour found = contour(*world.accel, {cells, is_solid(object.shape, scene_.prototypes)});
      const double error = found.deviation * to_world;
      if (options_.tolerance == 0 || error <= options_.tolerance || cells == kMostMeshCells) {
        if (options_.tolerance > 0 && error > options_.tolerance)
          warn(object, fmt::format("is off by up to {:.2g}", error));
        found.mesh.material_slots = slots_of(found.users, world, made.slots);
        made.mesh = std::make_shared<TriangleMesh>(std::move(found.mesh));
        return made;
      }
      // The error falls with the square of the size of cells, at edges more slowly.
      const double factor = std::clamp(1.1 * std::sqrt(error / options_.tolerance), 1.25, 4.0);
      cells = std::min(kMostMeshCells, static_cast<std::uint32_t>(std::ceil(cells * factor)));
    }
  }

  /// The slot of each triangle, and the materials of slots.
  static Column<std::uint16_t> slots_of(const std::vector<std::uint32_t>& users, const World& world,
                                        std::vector<std::uint32_t>& materials) {
    Column<std::uint16_t> slots;
    std::map<std::uint32_t, std::uint16_t> known;
    for (const std::uint32_t user : users) {
      std::uint32_t material = kNoId;
      if (user < world.objects.size()) {
        const ObjectMaterials& object = world.objects[user];
        material = object.material;
        if (material == kNoId && !object.slots.empty()) material = object.slots.front();
      }
      auto found = known.find(material);
      if (found == known.end()) {
        found = known.emplace(material, static_cast<std::uint16_t>(materials.size() & 0xffff)).first;
        materials.push_back(material);
      }
      slots.push_back(found->second);
    }
    if (materials.size() <= 1) slots.clear();
    if (materials.empty()) materials.push_back(kNoId);
    return slots;
  }

  const Scene& scene_;
  const SceneMeshOptions& options_;
  std::vector<Warning>* warnings_ = nullptr;
  std::map<const Object*, ObjectMesh> meshes_;
  std::map<std::pair<const Object*, std::uint32_t>, std::uint32_t> shared_;
};

}  // namespace

MeshFile mesh_of_scene(const Scene& scene, const SceneMeshOptions& options) {
  return SceneMeshing(scene, options).run();
}

}  // namespace oktett
