#include "render/geometry.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include "accel/build/refit.h"
#include "core/mesh_geometry.h"
#include "render/solids.h"

namespace oktett {

// ---- What rays of each kind meet.

/// Bits of Geometry::mask: for each tree of a SeenBy whether the geometry is in it; and that a structure
/// inside is in the trees of catchers as in the others.
constexpr std::uint32_t kBareRays = std::uint32_t{kAllRays} << kRayKinds, kWholeInside = 1u << 31;

/// Builds what rays of each kind meet of `geometries`, whose masks have such bits; `trees`: of how many
/// kinds. `child_seen_by` finds what they meet of a structure inside; null: all.
template <class Find>
static SeenBy build_seen_by(const std::vector<Geometry>& geometries, std::size_t trees,
                            const Find& child_seen_by, const BuildOptions& options) {
  SeenBy seen;
  const auto child_in = [&](std::size_t tree, const Geometry& g, const std::shared_ptr<const Accel>& child) {
    const SeenBy* const inner = child_seen_by(child.get());
    const bool whole = tree >= kRayKinds && (g.mask & kWholeInside) != 0;
    const std::size_t k = whole ? tree - kRayKinds : tree;
    return inner != nullptr && (*inner)[k] != nullptr ? (*inner)[k] : child;
  };
  // What stands in the tree for each geometry: nothing, a child, or the geometry.
  std::array<std::vector<const void*>, std::tuple_size_v<SeenBy>> parts;
  const auto parts_of = [&](std::size_t tree) {
    std::vector<const void*> list;
    for (const Geometry& g : geometries) {
      const bool shown = (g.mask >> tree & 1) != 0;
      if (const auto* const instances = std::get_if<InstanceList>(&g.shape))
        for (const auto& child : instances->children) list.push_back(child_in(tree, g, child).get());
      const auto* const instance = std::get_if<InstanceGeometry>(&g.shape);
      if (shown && instance != nullptr)
        list.push_back(child_in(tree, g, instance->child).get());
      else
        list.push_back(shown ? &g : nullptr);
    }
    return list;
  };
  std::vector<const void*> all;
  for (const Geometry& g : geometries) {
    if (const auto* const instances = std::get_if<InstanceList>(&g.shape))
      for (const auto& child : instances->children) all.push_back(child.get());
    const auto* const instance = std::get_if<InstanceGeometry>(&g.shape);
    all.push_back(instance != nullptr ? static_cast<const void*>(instance->child.get()) : &g);
  }
  for (std::size_t tree = 0; tree < trees; ++tree) {
    parts[tree] = parts_of(tree);
    if (parts[tree] == all) continue;
    const auto same =
        static_cast<std::size_t>(std::find(parts.begin(), parts.begin() + tree, parts[tree]) - parts.begin());
    if (same < tree) {
      seen[tree] = seen[same];
      continue;
    }
    std::vector<Geometry> shown = geometries;
    for (Geometry& g : shown) {
      if (auto* const instance = std::get_if<InstanceGeometry>(&g.shape))
        instance->child = child_in(tree, g, instance->child);
      if (auto* const list = std::get_if<InstanceList>(&g.shape))
        for (auto& child : list->children) child = child_in(tree, g, child);
    }
    BuildOptions of_tree = options;
    of_tree.mask = std::uint32_t{1} << tree;
    seen[tree] = build_accel(std::move(shown), of_tree);
  }
  return seen;
}

static bool hides(const SeenBy& seen) {
  return std::ranges::any_of(seen, [](const auto& accel) { return accel != nullptr; });
}

bool hides_objects(const World& world) {
  return std::any_of(world.seen_by.begin(), world.seen_by.begin() + kRayKinds,
                     [](const auto& accel) { return accel != nullptr; });
}

World without_others(const World& world) {
  World bare = world;
  for (std::size_t k = 0; k < kRayKinds; ++k)
    if (k != static_cast<std::size_t>(RayKind::camera)) bare.seen_by[k] = world.seen_by[kRayKinds + k];
  return bare;
}

bool bounces_differ(const World& world) {
  return std::ranges::any_of(
      kBounceKinds, [&](RayKind kind) { return &seen_by(world, kind) != &seen_by(world, RayKind::diffuse); });
}

bool shadows_differ(const World& world) {
  return std::ranges::any_of(
      kBounceKinds, [&](RayKind kind) { return &seen_by(world, kind) != &seen_by(world, RayKind::shadow); });
}

// ---- Geometries of objects.

static void set_materials(const Scene& scene, World& world) {
  world.materials = scene.materials;
  world.materials.emplace_back();
  for (const Material& m : scene.materials) {
    world.has_holes |=
        m.opacity != 1 || m.opacity_texture != kNoId || m.tint_opacity_texture != kNoId || !m.surface;
    world.has_clear |= m.transparency != 0;
  }
}

namespace {

/// Turns lists of objects into acceleration structures, one list after the other.
class WorldBuilder {
 public:
  WorldBuilder(const Scene& scene, const BuildOptions& options)
      : scene_(scene),
        options_(options),
        catches_(any_object(scene, [](const Object& object) { return object.shadow_catcher; })),
        hides_objects_(catches_ ||
                       any_object(scene, [](const Object& o) { return o.visible_to != kAllRays; })) {}

  World build() {
    world_.tracks_dielectrics = needs_dielectrics(scene_);
    world_.tracks_insides = needs_insides(scene_);
    world_.has_catchers = catches_;
    set_light_lists();
    for (const Prototype& prototype : scene_.prototypes) prototypes_.push_back(build_list(prototype.objects));
    world_.accel = build_list(scene_.objects);
    world_.seen_by = seen_by_[world_.accel.get()];
    world_.bounds = bounds(*world_.accel);
    if (!world_.moving.empty()) {
      world_.still = world_.accel, world_.still_seen_by = world_.seen_by;
      pose(world_, 0, options_);
    }
    world_.sah_cost = stats(*world_.accel).sah_cost;
    world_.structure_objects = std::make_shared<const StructureObjects>(std::move(structure_objects_));
    set_materials(scene_, world_);
    return std::move(world_);
  }

 private:
  template <class Test>
  static bool any_object(const Scene& scene, const Test& test) {
    return std::ranges::any_of(scene.objects, test) ||
           std::ranges::any_of(scene.prototypes, [&](const Prototype& prototype) {
             return std::ranges::any_of(prototype.objects, test);
           });
  }

  std::uint32_t full_mask() const { return catches_ ? kAllRays | kBareRays : kAllRays; }

  /// Whether the object gives light itself, or may, by what it shows.
  bool may_glow(const Object& object) const {
    const auto glowing = [&](std::uint32_t material) {
      return material < scene_.materials.size() && glows(scene_.materials[material]);
    };
    if (const auto* const csg = std::get_if<CsgShape>(&object.shape))
      return std::ranges::any_of(*csg->operands, [&](const Object& operand) { return may_glow(operand); });
    const auto* const mesh = std::get_if<MeshShape>(&object.shape);
    if (object.material != kNoId || mesh == nullptr) return glowing(object.material);
    return std::ranges::any_of(mesh->slot_materials, glowing);
  }

  /// Geometry::mask of the object.
  std::uint32_t mask_of(const Object& object) const {
    std::uint32_t mask = object.visible_to;
    // Without media there are no rays of volumes, so a tree for them is that of others.
    if (!world_.tracks_dielectrics) {
      const bool diffuse = (mask & bit_of(RayKind::diffuse)) != 0;
      mask = diffuse ? mask | bit_of(RayKind::volume) : mask & ~std::uint32_t{bit_of(RayKind::volume)};
    }
    if (!catches_) return mask;
    const bool stays = object.shadow_catcher || may_glow(object);
    const bool instance = std::holds_alternative<InstanceShape>(object.shape);
    if (stays || instance) mask |= mask << kRayKinds;
    return stays && instance ? mask | kWholeInside : mask;
  }

  std::shared_ptr<const Accel> build_list(const std::vector<Object>& objects) {
    std::vector<Geometry> geometries;
    std::vector<std::uint32_t> shown;  // as in StructureObjects
    std::uint64_t instances = 0;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      const Object& object = objects[k];
      if (&objects == &scene_.objects && (object.motion != nullptr || is_bent(object))) {
        add_moving(object);
        continue;
      }
      Geometry geometry;
      if (const std::size_t run = instances_from(objects, k); run >= kLeastInstanceList) {
        shown.push_back(next_object());
        geometries.push_back({instance_list(objects, k, run), {}, kNoId, full_mask()});
        instances += run;
        k += run - 1;
        continue;
      }
      const std::uint32_t id = next_object();
      if (!make_geometry(object, geometry)) continue;
      // A hidden combination has a structure of its own, as hits would be numbered otherwise without it.
      const bool wraps = geometry.mask != full_mask() && std::holds_alternative<CsgGeometry>(geometry.shape);
      if (wraps) geometry = own_structure(std::move(geometry), id);
      shown.push_back(wraps ? kNoId : id);
      const bool instance = std::holds_alternative<InstanceGeometry>(geometry.shape);
      if (instance && object.transform.is_invertible()) ++instances;
      geometries.push_back(std::move(geometry));
    }
    return build_counted(std::move(geometries), std::move(shown), instances);
  }

  void set_light_lists() {
    for (std::size_t i = 0; i < scene_.light_lists.size(); ++i)
      if (scene_.light_lists[i].lights_others)
        world_.lists_of_others = static_cast<std::uint16_t>(world_.lists_of_others | 1u << i);
    world_.has_light_lists = !scene_.light_lists.empty();
  }

  /// An instance of a structure of the geometry alone, which shows object `id`.
  Geometry own_structure(Geometry geometry, std::uint32_t id) {
    Geometry instance;
    instance.mask = std::exchange(geometry.mask, full_mask());
    instance.shape = InstanceGeometry{build_counted({std::move(geometry)}, {id}, 0)};
    return instance;
  }

  /// The number of the object that is added next.
  std::uint32_t next_object() const { return static_cast<std::uint32_t>(world_.objects.size()); }

  /// A structure whose triangles, primitives and bytes are counted. Its geometries show the objects `shown`;
  /// so many of its items are `instances`.
  std::shared_ptr<const Accel> build_counted(std::vector<Geometry> geometries,
                                             std::vector<std::uint32_t> shown, std::uint64_t instances) {
    std::vector<Geometry> seen;
    if (hides_objects_) seen = geometries;
    std::shared_ptr<const Accel> accel = build_accel(std::move(geometries), options_);
    structure_objects_.emplace(accel.get(), std::move(shown));
    if (hides_objects_) {
      // What rays of each kind meet of structures that have been built.
      const auto child_seen_by = [this](const Accel* child) {
        const auto found = seen_by_.find(child);
        return found != seen_by_.end() ? &found->second : nullptr;
      };
      const SeenBy own = build_seen_by(seen, catches_ ? 2 * kRayKinds : kRayKinds, child_seen_by, options_);
      count_seen_by(own);
      seen_by_.emplace(accel.get(), own);
    }
    const AccelStats s = stats(*accel);
    world_.triangles += s.triangles;
    world_.primitives += s.items - std::min<std::uint64_t>(s.items, instances);
    world_.bvh_bytes += s.bytes();
    return accel;
  }

  void count_seen_by(const SeenBy& seen) {
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (seen[k] != nullptr && std::find(seen.begin(), seen.begin() + k, seen[k]) == seen.begin() + k)
        world_.bvh_bytes += stats(*seen[k]).bytes();
  }

  void add_moving(const Object& object) {
    if (is_bent(object)) return add_bent(object);
    Object unmoved = object;
    unmoved.transform = {};
    Geometry geometry;
    const std::uint32_t id = next_object();
    if (!make_geometry(unmoved, geometry)) return;
    geometry.mask = full_mask();
    if (const auto* instance = std::get_if<InstanceGeometry>(&geometry.shape))
      world_.moving.push_back({instance->child, object.motion, geometry.user, id, mask_of(object),
                               seen_by_[instance->child.get()]});
    else
      world_.moving.push_back(
          {build_counted({std::move(geometry)}, {id}, 0), object.motion, kNoId, kNoId, mask_of(object)});
  }

  static bool is_bent(const Object& object) {
    const auto* const mesh = std::get_if<MeshShape>(&object.shape);
    return mesh != nullptr && mesh->mesh != nullptr && mesh->bending != nullptr;
  }

  /// Its structure is that of each moment.
  void add_bent(const Object& object) {
    const std::uint32_t id = next_object();
    const auto& mesh = std::get<MeshShape>(object.shape);
    add_object(object, id).slots = mesh.slot_materials;
    MovingObject moving;
    moving.motion = object.motion, moving.mask = mask_of(object);
    if (moving.motion == nullptr && !object.transform.is_identity()) {
      Motion still;
      still.factors.push_back({{0, object.transform}});
      moving.motion = std::make_shared<const Motion>(std::move(still));
    }
    moving.bent = std::make_shared<const MeshShape>(mesh), moving.user = id;
    moving.following = std::make_shared<FollowingTree>();
    const std::size_t count = mesh.mesh->triangle_count();
    world_.primitives += count, world_.bent_triangles += count;
    if (mesh.stroke_width == 0) world_.triangles += count;
    keep(mesh.mesh);
    world_.moving.push_back(std::move(moving));
  }

  /// Whether rays of some kind do not meet all of a prototype. Then paths through lists of its instances
  /// might be numbered otherwise.
  bool differs(std::uint32_t prototype) const {
    const auto found = seen_by_.find(prototypes_[prototype].get());
    return found != seen_by_.end() && hides(found->second);
  }

  /// Number of instances in a row from object `first` on.
  std::size_t instances_from(const std::vector<Object>& objects, std::size_t first) const {
    std::size_t end = first;
    while (end < objects.size()) {
      const auto* instance = std::get_if<InstanceShape>(&objects[end].shape);
      if (instance == nullptr || instance->prototype >= prototypes_.size() || objects[end].motion ||
          mask_of(objects[end]) != full_mask() || differs(instance->prototype))
        break;
      ++end;
    }
    return end - first;
  }

  InstanceList instance_list(const std::vector<Object>& objects, std::size_t first, std::size_t count) {
    InstanceList list;
    list.children = prototypes_;
    list.places.reserve(count);
    for (std::size_t k = first; k < first + count; ++k) {
      const Object& object = objects[k];
      const std::uint32_t id = next_object();
      add_object(object, id);
      // Without a material of its own, an instance shows those of the objects inside.
      InstancePlace place{
          {}, std::get<InstanceShape>(object.shape).prototype, object.material == kNoId ? kNoId : id};
      object.transform.to_rows(place.to_list);
      list.places.push_back(place);
    }
    return list;
  }

  /// Adds object number `id`.
  ObjectMaterials& add_object(const Object& object, std::uint32_t id) {
    if (object.visible_to != kAllRays && world_.tracks_dielectrics)
      check_not_entered(object, kNoId, scene_, object.where);
    ObjectMaterials& own = world_.objects.emplace_back();
    own.material = object.material, own.solid = solid(object, id), own.name = object.name;
    own.listed = object.listed, own.light_list = object.light_list;
    own.shadow_catcher = object.shadow_catcher;
    own.hollow = combination_ != kNoId ? world_.objects[combination_].hollow : object.hollow;
    own.has_inside = world_.tracks_insides && oktett::has_inside(object, scene_);
    return own;
  }

  bool make_geometry(const Object& object, Geometry& geometry) {
    const std::uint32_t id = next_object();
    add_object(object, id);
    geometry.transform = object.transform;
    geometry.user = id, geometry.mask = mask_of(object);
    if (!std::visit([&](const auto& shape) { return convert(shape, geometry); }, object.shape)) return false;
    // Without a material of its own, an instance shows those of the objects inside; a combination always
    // does, as its operands have been given its material if they had none.
    const bool combination = std::holds_alternative<CsgGeometry>(geometry.shape);
    if (combination || (std::holds_alternative<InstanceGeometry>(geometry.shape) && object.material == kNoId))
      geometry.user = kNoId;
    return true;
  }

  /// Shapes that the acceleration structure takes as they are.
  template <class Shape>
  bool convert(const Shape& shape, Geometry& geometry) {
    geometry.shape = shape;
    return true;
  }

  bool convert(const MeshShape& shape, Geometry& geometry) {
    if (shape.mesh == nullptr) return false;
    world_.objects.back().slots = shape.slot_materials;
    if (shape.stroke_width > 0)
      convert_strokes(shape, geometry);
    else
      geometry.shape = MeshGeometry{shape.mesh.get(), shape.smooth, shape.test};
    keep(shape.mesh);
    return true;
  }

  /// Several geometries are a structure of their own.
  void convert_strokes(const MeshShape& shape, Geometry& geometry) {
    std::vector<Geometry> parts;
    world_.objects.back().strokes = std::make_shared<const StrokeParts>(
        add_strokes(shape.mesh, shape.stroke_width / 2, geometry.user, parts));
    std::vector<std::uint32_t> shown(parts.size(), geometry.user);
    if (parts.size() == 1)
      geometry.shape = std::move(parts[0].shape);
    else
      geometry.shape = InstanceGeometry{build_counted(std::move(parts), std::move(shown), 0)};
  }

  bool convert(const SphereShape& shape, Geometry& geometry) {
    geometry.shape = SpheresShape{{shape}};
    return true;
  }

  bool convert(const TriangleShape& shape, Geometry& geometry) {
    auto mesh = std::make_shared<TriangleMesh>();
    for (std::uint32_t k = 0; k < 3; ++k) {
      // Moved in double, so that what is rounded to float is the corner in its final place.
      mesh->positions.push_back(Vec3f(geometry.transform.point(shape.v[k])));
      mesh->indices.push_back(k);
    }
    // A mirror reverses the winding of the corners, but the front stays the front.
    if (geometry.transform.determinant() < 0) std::swap(mesh->indices[1], mesh->indices[2]);
    geometry.transform = {};
    geometry.shape = MeshGeometry{mesh.get(), false, TriangleTest::watertight};
    keep(mesh);
    return true;
  }

  bool convert(const CsgShape& shape, Geometry& geometry) {
    combination_ = static_cast<std::uint32_t>(world_.objects.size() - 1);
    // A copy: operands are added to the list that holds it.
    const std::string name = world_.objects.back().name;
    auto expression = std::make_shared<CsgExpression>(csg_expression(shape, name));
    combination_ = kNoId;
    if (shape.windows != nullptr) add_windows(*shape.windows, expression->windows);
    geometry.shape = CsgGeometry{std::move(expression)};
    return true;
  }

  /// Operands are numbered as objects of their own, so that each shows its material. Those without a name get
  /// that of the combination around them, `name`.
  CsgExpression csg_expression(const CsgShape& shape, const std::string& name) {
    CsgExpression expression;
    expression.op = shape.op;
    for (const Object& object : *shape.operands) {
      CsgExpression& child = expression.children.emplace_back();
      const std::string& own_name = object.name.empty() ? name : object.name;
      if (const auto* csg = std::get_if<CsgShape>(&object.shape)) {
        const bool were_surfaces = std::exchange(surfaces_, csg->op == CsgOp::surfaces);
        child = csg_expression(*csg, own_name);
        surfaces_ = were_surfaces;
        move(child, object.transform);
        if (child.op == CsgOp::surfaces) gather_solids(child);
        continue;
      }
      Geometry solid;
      if (make_geometry(object, solid)) {
        world_.objects.back().name = own_name;
        if (only_cuts(object)) solid.mask = 0;
        child.solids.push_back(std::move(solid));
      } else {
        // Operands have consecutive numbers, see StructureObjects.
        world_.objects.pop_back();
      }
    }
    return expression;
  }

  /// Windows are never hit, so they are no objects.
  void add_windows(const std::vector<Object>& windows, std::vector<Geometry>& to) {
    const std::size_t count = world_.objects.size();
    for (const Object& window : windows) {
      Geometry solid;
      if (make_geometry(window, solid)) to.push_back(std::move(solid));
      world_.objects.resize(count);
    }
  }

  /// Whether an operand has no surface and nothing inside: its material is a hole.
  bool only_cuts(const Object& object) const {
    if (object.material >= scene_.materials.size() || std::holds_alternative<MeshShape>(object.shape) ||
        std::holds_alternative<InstanceShape>(object.shape))
      return false;
    const Material& m = scene_.materials[object.material];
    return m.opacity == 0 && m.surface && m.interior == kNoId && m.priority == kNoPriority && !glows(m) &&
           m.transparency == 0;
  }

  /// Those of the children become those of the expression.
  static void gather_solids(CsgExpression& expression) {
    for (CsgExpression& child : expression.children)
      std::ranges::move(child.solids, std::back_inserter(expression.solids));
    expression.children.clear();
  }

  static void move(CsgExpression& expression, const Affine& transform) {
    for (Geometry& solid : expression.solids) solid.transform = transform * solid.transform;
    for (CsgExpression& child : expression.children) move(child, transform);
  }

  bool convert(const InstanceShape& shape, Geometry& geometry) {
    if (shape.prototype >= prototypes_.size()) return false;
    geometry.shape = InstanceGeometry{prototypes_[shape.prototype]};
    return true;
  }

  void keep(const std::shared_ptr<const TriangleMesh>& mesh) {
    if (!seen_.insert(mesh.get()).second) return;
    world_.meshes.push_back(mesh);
    world_.geometry_bytes += mesh->bytes();
  }

  /// What ObjectMaterials::solid is for object number `id`.
  std::uint32_t solid(const Object& object, std::uint32_t id) {
    if (!world_.tracks_dielectrics || surfaces_ || !is_entered(object, scene_)) return kNoId;
    world_.has_enclosing_solids = true;
    return combination_ != kNoId ? combination_ : id;
  }

  const Scene& scene_;
  const BuildOptions& options_;
  World world_;
  std::vector<std::shared_ptr<const Accel>> prototypes_;
  StructureObjects structure_objects_;
  std::set<const TriangleMesh*> seen_;
  std::uint32_t combination_ = kNoId;                 ///< the object whose operands are being made
  bool surfaces_ = false;                             ///< the operands are those of CsgOp::surfaces
  const bool catches_;                                ///< there are shadow catchers
  const bool hides_objects_;                          ///< some object is not in all trees of a SeenBy
  std::unordered_map<const Accel*, SeenBy> seen_by_;  ///< of the structures of lists
};

}  // namespace

World build_world(const Scene& scene, const BuildOptions& options) {
  return WorldBuilder(scene, options).build();
}

World with_meshes(const World& others, const Scene& scene, std::size_t first,
                  std::shared_ptr<const Accel> top) {
  World world = others;
  world.seen_by = {};
  set_materials(scene, world);
  std::vector<std::uint32_t> shown;  // as in StructureObjects
  const bool shows_others = stats(*others.accel).items > 0;
  if (shows_others) shown.push_back(kNoId);
  world.paths_of_others = shows_others ? others.accel->path_count : 0;
  std::set<const TriangleMesh*> seen;
  for (const auto& mesh : world.meshes) seen.insert(mesh.get());
  for (const Object& object : std::span(scene.objects).subspan(first)) {
    const auto id = static_cast<std::uint32_t>(world.objects.size());
    const auto& shape = std::get<MeshShape>(object.shape);
    ObjectMaterials& own = world.objects.emplace_back();
    own.material = object.material, own.slots = shape.slot_materials, own.name = object.name;
    own.hollow = object.hollow, own.has_inside = world.tracks_insides && has_inside(object, scene);
    if (shape.mesh == nullptr) continue;
    shown.push_back(id);
    if (world.tracks_dielectrics && is_entered(object, scene))
      own.solid = id, world.has_enclosing_solids = true;
    const std::size_t count = shape.mesh->triangle_count();
    world.triangles += count, world.primitives += count;
    if (!seen.insert(shape.mesh.get()).second) continue;
    world.meshes.push_back(shape.mesh);
    world.geometry_bytes += shape.mesh->bytes();
  }
  auto structure_objects = std::make_shared<StructureObjects>(*others.structure_objects);
  structure_objects->insert_or_assign(top.get(), std::move(shown));
  world.structure_objects = std::move(structure_objects);
  world.accel = std::move(top);
  world.bounds = bounds(*world.accel);
  return world;
}

std::shared_ptr<const TriangleMesh> mesh_at(const MeshShape& shape, double time) {
  if (shape.bending == nullptr) return shape.mesh;
  const std::vector<MeshPose>& poses = shape.bending->poses;
  const auto next = std::ranges::find_if(poses, [&](const MeshPose& p) { return p.time >= time; });
  const MeshPose& to = next == poses.end() ? poses.back() : *next;
  const MeshPose& from = next == poses.begin() || next == poses.end() ? to : *(next - 1);
  const double span = to.time - from.time, part = span > 0 ? (time - from.time) / span : 0;
  const auto a = static_cast<float>(1 - part), b = static_cast<float>(part);
  auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
  for (std::size_t i = 0; i < mesh->positions.size(); ++i)
    mesh->positions[i] = from.positions[i] * a + to.positions[i] * b;
  for (std::size_t i = 0; i < mesh->normals.size(); ++i)
    mesh->normals[i] = from.normals[i] * a + to.normals[i] * b;
  for (std::size_t i = 0; i < mesh->tangents.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      mesh->tangents[i][k] = from.tangents[i][k] * a + to.tangents[i][k] * b;
  return mesh;
}

/// Gives a bent object the structure of a time: the tree of the time before is refitted where that is as good
/// as building it, which takes much longer.
static void bend(World& world, MovingObject& object, double time, const BuildOptions& options) {
  const MeshShape& shape = *object.bent;
  object.mesh = mesh_at(shape, time);
  if (shape.stroke_width > 0) {
    std::vector<Geometry> strokes;
    world.objects[object.user].strokes = std::make_shared<const StrokeParts>(
        add_strokes(object.mesh, shape.stroke_width / 2, object.user, strokes));
    object.shape = build_accel(std::move(strokes), options);
    return;
  }
  FollowingTree& following = *object.following;
  BuildOptions followed = options;  // packed corners cannot be moved
  if (followed.quality == BuildQuality::compact) followed.quality = BuildQuality::balanced;
  if (following.tree() == nullptr || shape.test != TriangleTest::watertight ||
      !following.follow(*object.mesh, options.parallel))
    following.set(std::const_pointer_cast<Accel>(build_accel(
        {{MeshGeometry{object.mesh.get(), shape.smooth, shape.test}, {}, object.user}}, followed)));
  object.shape = following.tree();
}

Box tight_bounds(const World& world) {
  if (world.paths_of_others == kNoId) return world.bounds;
  Box box;
  for (const Geometry& shown : world.accel->geometries) {
    const auto* const instance = std::get_if<InstanceGeometry>(&shown.shape);
    // A mesh alone is the structure itself.
    if (instance == nullptr) return world.bounds;
    const Accel& child = *instance->child;
    if (!shown.transform.is_invertible()) continue;
    if (shown.transform.is_identity())
      box.grow(child.bounds);
    else
      each_corner(*std::get<MeshGeometry>(child.geometries[0].shape).mesh, [&](const Vec3f& p) {
        if (is_finite(p)) box.grow(Vec3f(shown.transform.point(Vec3d(p))));
      });
  }
  return box;
}

void pose(World& world, double time, const BuildOptions& options) {
  std::vector<Geometry> geometries;
  if (world.still != nullptr && stats(*world.still).items > 0)
    geometries.push_back({InstanceGeometry{world.still}, {}, kNoId, kAllRays | kBareRays});
  bool hides_any = hides(world.still_seen_by);
  for (MovingObject& object : world.moving) {
    if (object.bent != nullptr) bend(world, object, time, options);
    geometries.push_back({InstanceGeometry{object.shape},
                          object.motion != nullptr ? object.motion->at(time) : Affine{}, object.user,
                          object.mask});
    hides_any = hides_any || object.mask != kAllRays || hides(object.seen_by);
  }
  const auto child_seen_by = [&](const Accel* child) -> const SeenBy* {
    if (child == world.still.get()) return &world.still_seen_by;
    const auto found = std::ranges::find(world.moving, child, [](const auto& m) { return m.shape.get(); });
    return found != world.moving.end() ? &found->seen_by : nullptr;
  };
  const std::size_t trees = world.has_catchers ? 2 * kRayKinds : kRayKinds;
  world.seen_by = hides_any ? build_seen_by(geometries, trees, child_seen_by, options) : SeenBy{};
  world.accel = build_accel(std::move(geometries), options);
  world.bounds = bounds(*world.accel);
}

}  // namespace oktett
