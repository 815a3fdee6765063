#include "python/src/scene_store.h"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>
#include <utility>
#include <variant>

#include "core/error.h"
#include "core/far_mesh.h"
#include "core/rounding.h"
#include "render/append_materials.h"
#include "render/look/default_look.h"
#include "render/material.h"
#include "render/recentre.h"

namespace oktett::python {
namespace {

/// The bytes of the file `path`.
std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (!file || (file.peek() != std::ifstream::traits_type::eof() && !(content << file.rdbuf())))
    throw Error(Location{path}, "cannot read", ErrorKind::io);
  return std::move(content).str();
}

/// Numbers that the operands of a combination take.
std::uint32_t operand_count(const CsgShape& shape) {
  std::uint32_t count = 0;
  for (const Object& operand : *shape.operands) {
    const auto* csg = std::get_if<CsgShape>(&operand.shape);
    count += csg != nullptr ? operand_count(*csg) : 1;
  }
  return count;
}

std::uint32_t count_objects(std::span<const Object> objects) {
  std::uint32_t count = 0;
  for (const Object& object : objects) {
    const auto* csg = std::get_if<CsgShape>(&object.shape);
    count += 1 + (csg != nullptr ? operand_count(*csg) : 0);
  }
  return count;
}

/// The images of a scene and those of materials that were added to it.
class JoinedTextures final : public TextureSampler {
 public:
  explicit JoinedTextures(TextureParts parts) : parts_(std::move(parts)) {}

  Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const auto [images, own] = part(index);
    return images == nullptr ? Color{1, 1, 1} : images->color(own, uv, dx, dy);
  }
  float value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const auto [images, own] = part(index);
    return images == nullptr ? 1 : images->value(own, uv, dx, dy);
  }
  Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const auto [images, own] = part(index);
    return images == nullptr ? Vec3f{0.5f, 0.5f, 1} : images->normal(own, uv, dx, dy);
  }

 private:
  /// What holds a texture, and the number that it has there.
  std::pair<const TextureSampler*, std::uint32_t> part(std::uint32_t index) const {
    for (auto p = parts_.rbegin(); p != parts_.rend(); ++p)
      if (p->first <= index) return {p->images.get(), index - static_cast<std::uint32_t>(p->first)};
    return {nullptr, index};
  }

  TextureParts parts_;
};

std::shared_ptr<const TextureSampler> joined(const std::shared_ptr<const TextureSampler>& own,
                                             const TextureParts& added) {
  if (added.empty()) return own;
  TextureParts parts{{0, own}};
  parts.insert(parts.end(), added.begin(), added.end());
  return std::make_shared<const JoinedTextures>(std::move(parts));
}

/// The number of the material of that name. Throws Error if there is none.
std::uint32_t material_of(const Scene& scene, const std::string& name) {
  std::vector<std::string> known;
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name) return i;
    if (!scene.materials[i].name.empty()) known.push_back(scene.materials[i].name);
  }
  throw Error("material: the scene has no material '" + name + "'" + did_you_mean(name, known));
}

}  // namespace

std::uint32_t object_count(const Scene& scene) {
  std::uint32_t count = count_objects(scene.objects);
  for (const Prototype& prototype : scene.prototypes) count += count_objects(prototype.objects);
  return count;
}

SceneStore::FileState SceneStore::state_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  return {std::int64_t{status.st_mtim.tv_sec} * 1000000000 + status.st_mtim.tv_nsec,
          static_cast<std::uint64_t>(status.st_size)};
}

std::shared_ptr<SceneStore> SceneStore::load(const Files& reader, const std::string& path,
                                             const Definitions& definitions, FileContents files) {
  auto store = std::make_shared<SceneStore>();
  SceneRead read = reader.read(path, definitions, files);
  store->scene_ = std::move(read.scene);
  store->reader_ = &reader;
  store->path_ = path;
  store->definitions_ = definitions;
  store->files_ = std::move(files);
  store->textures_ = std::move(read.textures);
  store->own_textures_ = store->scene_.textures.size();
  store->read_objects_ = store->scene_.objects.size();
  store->states_.resize(store->read_objects_);
  std::uint32_t number = 0;
  for (const Prototype& prototype : store->scene_.prototypes) number += count_objects(prototype.objects);
  for (const Object& object : store->scene_.objects) {
    store->numbers_.push_back(number);
    number += count_objects({&object, 1});
  }
  for (const std::string& name : read.paths) store->read_.emplace(name, state_of(name));
  return store;
}

FileContents AddedMesh::material_contents() const {
  FileContents all = material_files;
  for (const std::string& path : material_paths) all.emplace(path, content_of(path));
  return all;
}

std::uint32_t SceneStore::append_material(SceneRead read) {
  Scene& other = read.scene;
  other.materials.resize(1);
  other.materials[0].name.clear();
  if (!other.textures.empty() && read.textures != nullptr)
    added_textures_.push_back({scene_.textures.size(), std::move(read.textures)});
  std::ranges::move(other.warnings, std::back_inserter(scene_.warnings));
  return append_materials(std::move(other.materials), std::move(other.textures), std::move(other.media),
                          scene_);
}

std::uint32_t SceneStore::add(AddedMesh added, const Files& (*reader)()) {
  std::optional<SceneRead> material;
  if (!added.material_files.empty()) {
    material = reader().read(AddedMesh::kMaterialFile, {}, added.material_files);
    added.material_paths = material->paths;
  }
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  const std::uint32_t number = python::object_count(scene_);
  Object object;
  place(added, object);
  object.name = added.name;
  if (material) object.material = append_material(std::move(*material));
  if (!added.material_name.empty()) object.material = material_of(scene_, added.material_name);
  const std::size_t materials = scene_.materials.size();
  show_colors(scene_, object);
  if (material || scene_.materials.size() != materials) ++read_changes_;
  scene_.objects.push_back(std::move(object));
  added_.push_back(std::move(added));
  states_.emplace_back(), numbers_.push_back(number);
  worlds_.clear(), ++changes_;
  return number;
}

// ---- Changes.

std::size_t SceneStore::find(std::uint32_t number) const {
  const auto at = std::ranges::lower_bound(numbers_, number);
  const auto fail = [&](const char* why) { throw Error("object " + std::to_string(number) + ' ' + why); };
  if (at == numbers_.end() || *at != number)
    fail(number < python::object_count(scene_) ? "stands in a prototype or a combination" : "does not exist");
  const auto k = static_cast<std::size_t>(at - numbers_.begin());
  if (states_[k].removed) fail("was removed");
  return k;
}

AddedMesh& SceneStore::find_added(std::uint32_t number, const char* what) {
  const std::size_t k = find(number);
  if (k < read_objects_)
    throw Error("object " + std::to_string(number) + " was read: only meshes that were added have " + what);
  return added_[k - read_objects_];
}

void SceneStore::place(const AddedMesh& added, Object& object) const {
  MeshShape shape;
  shape.mesh = added.mesh;
  object.shape = std::move(shape);
  object.transform = added.transform;
  place_mesh(object);
  if (!(scene_.origin == Vec3d{}))
    object.transform = Affine::translation(scene_.origin * -1.0) * object.transform;
}

void SceneStore::note_change(std::size_t object) {
  worlds_.clear(), ++changes_;
  if (object < read_objects_) ++read_changes_;
}

/// Whether a mesh among the objects, or in their operands, counts from a place of its own.
static bool hold_far_meshes(std::span<const Object> objects) {
  return std::ranges::any_of(objects, [](const Object& object) {
    const auto* const mesh = std::get_if<MeshShape>(&object.shape);
    if (mesh != nullptr) return mesh->mesh != nullptr && !(mesh->mesh->origin == Vec3d{});
    const auto* const csg = std::get_if<CsgShape>(&object.shape);
    return csg != nullptr && hold_far_meshes(*csg->operands);
  });
}

bool SceneStore::is_shifted(const Object& object) const {
  if (std::holds_alternative<CsgShape>(object.shape))
    return !(scene_.origin == Vec3d{}) || hold_far_meshes({&object, 1});
  if (!std::holds_alternative<InstanceShape>(object.shape)) return false;
  return !(scene_.origin == Vec3d{}) ||
         std::ranges::any_of(scene_.prototypes,
                             [](const Prototype& prototype) { return hold_far_meshes(prototype.objects); });
}

void SceneStore::set_transform(std::uint32_t number, const Affine& transform) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  const std::size_t k = find(number);
  Object& object = scene_.objects[k];
  if (k >= read_objects_) {
    AddedMesh& added = added_[k - read_objects_];
    added.transform = transform;
    place(added, object);
  } else {
    if (object.motion != nullptr)
      throw Error("object " + std::to_string(number) + " moves by itself; its transform cannot be set");
    if (is_shifted(object))
      throw Error(
          "object " + std::to_string(number) +
          " is a combination or an instance of what lies far from the origin; its transform cannot be set");
    object.transform = transform;
    place_mesh(object);
    object.transform = Affine::translation(scene_.origin * -1.0) * object.transform;
    states_[k].transform = transform;
  }
  note_change(k);
}

void SceneStore::set_enabled(std::uint32_t number, bool enabled) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  const std::size_t k = find(number);
  if (std::exchange(states_[k].enabled, enabled) != enabled) note_change(k);
}

void SceneStore::remove(std::uint32_t number) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  const std::size_t k = find(number);
  states_[k].removed = true;
  note_change(k);
  if (k < read_objects_) return;
  const std::size_t i = k - read_objects_;
  if (i < in_top_.size() && in_top_[i] != kNoId) top_->remove(std::exchange(in_top_[i], kNoId));
  added_[i].mesh = nullptr, scene_.objects[k].shape = MeshShape{};
}

void SceneStore::set_mask(std::uint32_t number, std::uint32_t mask) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  find_added(number, "masks");
  if (mask == 0) throw Error("a mask needs at least one bit; a disabled object is met by no ray");
  for (const Object& object : scene_.objects)
    if (object.motion != nullptr) throw Error("scenes in which objects move by themselves have no masks");
  const std::size_t k = find(number);
  states_[k].mask = mask;
  note_change(k);
}

/// Whether each corner has the normal of its vertex, or none.
static bool has_vertex_normals(const TriangleMesh& mesh) {
  if (mesh.normals.size() != mesh.positions.size()) return false;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.normal_indices[i] != mesh.indices[i] && mesh.normal_indices[i] != kNoId) return false;
  return true;
}

std::shared_ptr<const TriangleMesh> SceneStore::replaced(const AddedMesh& added,
                                                         const MeshChange& change) const {
  const TriangleMesh& mesh = *added.mesh;
  const std::size_t size = mesh.positions.size(), end = change.first + change.positions.size();
  const auto is_given = [&](std::size_t i) { return i >= change.first && i < end; };
  const auto position = [&](std::size_t i) {
    return is_given(i) ? change.positions[i - change.first] : Vec3d(mesh.positions[i]) + mesh.origin;
  };
  // Of nearly all meshes a few tell that they are not far.
  std::vector<Vec3d> some;
  for (std::size_t i = 0; i < 16 && size > 0; ++i) some.push_back(position(i * (size - 1) / 15));
  const WideBox box = box_of_some(some);
  const bool is_near = mesh.origin == Vec3d{} && surely_near(box) && box.extent() > 0;
  const bool some_lack_normals =
      !change.normals.empty() &&
      (std::ranges::count(mesh.normal_indices, kNoId) > 0 || !std::ranges::all_of(change.normals, is_normal));
  if (is_near && !some_lack_normals) return nullptr;
  auto changed = std::make_shared<TriangleMesh>(mesh);
  std::vector<Vec3d> all;
  all.reserve(size);
  for (std::size_t i = 0; i < size; ++i) all.push_back(position(i));
  // Those that stay may have digits that floats lack.
  const bool are_floats = change.are_floats && std::ranges::all_of(all, [](const Vec3d& p) {
                            return rounded_to_floats(p) == p || !is_finite(p);
                          });
  if (are_floats) {
    changed->origin = {};
    for (std::size_t i = 0; i < size; ++i) changed->positions[i] = Vec3f(all[i]);
    if (const std::optional<Vec3d> centre = far_centre(changed->positions, true)) take_off(*centre, *changed);
  } else {
    set_positions(all, *changed);
  }
  std::ranges::copy(change.normals, changed->normals.begin() + change.first);
  if (some_lack_normals)
    for (std::size_t i = 0; i < changed->indices.size(); ++i)
      changed->normal_indices[i] =
          is_normal(changed->normals[changed->indices[i]]) ? changed->indices[i] : kNoId;
  return changed;
}

void SceneStore::set_vertices(std::uint32_t number, const MeshChange& change) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  AddedMesh& added = find_added(number, "vertices that can be moved");
  const std::size_t k = find(number), size = added.mesh->positions.size();
  if (change.first > size || change.positions.size() > size - change.first)
    throw Error("vertices: object " + std::to_string(number) + " has " + std::to_string(size) +
                " vertices; " + std::to_string(change.positions.size()) + " from number " +
                std::to_string(change.first) + " on were given");
  if (!change.normals.empty() && !has_vertex_normals(*added.mesh))
    throw Error("normals: object " + std::to_string(number) + " has no normals of vertices");
  std::shared_ptr<const TriangleMesh> mesh = replaced(added, change);
  const std::size_t i = k - read_objects_;
  const bool stands = i < in_top_.size();
  worlds_.clear();
  if (mesh == nullptr && stands) {
    // Nobody else may hold the mesh, or it would be copied.
    std::vector<Vec3f> positions;
    positions.reserve(change.positions.size());
    for (const Vec3d& p : change.positions) positions.push_back(Vec3f(p));
    added.mesh = nullptr, scene_.objects[k].shape = MeshShape{};
    try {
      top_->set_vertices(in_top_[i], positions, change.first, change.normals);
    } catch (...) {
      added.mesh = top_->mesh(in_top_[i]);
      place(added, scene_.objects[k]);
      throw;
    }
    mesh = top_->mesh(in_top_[i]);
  } else if (mesh == nullptr) {
    auto changed = std::make_shared<TriangleMesh>(*added.mesh);
    std::ranges::transform(change.positions, changed->positions.begin() + change.first,
                           [](const Vec3d& p) { return Vec3f(p); });
    std::ranges::copy(change.normals, changed->normals.begin() + change.first);
    mesh = std::move(changed);
  } else if (stands && mesh->origin == added.mesh->origin && change.normals.empty()) {
    top_->set_vertices(in_top_[i], mesh->positions);
  } else if (stands) {
    Geometry geometry = top_->geometry(in_top_[i]);
    top_->replace(in_top_[i], mesh, std::move(geometry));
  }
  added.mesh = std::move(mesh);
  Object& object = scene_.objects[k];
  place(added, object);
  note_change(k);
}

// ---- The structure.

std::uint32_t SceneStore::least_mask(std::uint32_t mask) const {
  std::uint32_t used = 0;
  for (const ObjectState& state : states_)
    if (state.mask != ~0u) used |= state.mask;
  return oktett::least_mask(mask, used);
}

std::shared_ptr<const PlacedWorld> SceneStore::built_world(std::uint32_t mask) const {
  const std::lock_guard lock(mutex_);
  const auto found = worlds_.find(least_mask(mask));
  return found != worlds_.end() ? found->second : nullptr;
}

Scene SceneStore::shown_scene() const {
  Scene scene = scene_;
  for (std::size_t k = 0; k < states_.size(); ++k)
    if (states_[k].removed || !states_[k].enabled) scene.objects[k].shape = MeshShape{};
  return scene;
}

World SceneStore::build(const Scene& scene, std::uint32_t mask) {
  BuildOptions options;
  options.quality = quality_;
  const bool moves = std::ranges::any_of(scene.objects, [](const Object& object) {
    const auto* const mesh = std::get_if<MeshShape>(&object.shape);
    return object.motion != nullptr || (mesh != nullptr && mesh->bending != nullptr);
  });
  if (scene.objects.size() == read_objects_ || moves) {
    World world = build_world(scene, options);
    if (mask == 0) world.accel = build_accel({}, options);
    return world;
  }
  if (others_ == nullptr || others_changes_ != read_changes_ || !(others_origin_ == scene.origin)) {
    Scene read = scene;
    read.objects.resize(read_objects_);
    others_ = std::make_shared<const World>(build_world(read, options));
    others_changes_ = read_changes_, others_origin_ = scene.origin;
    const Geometry instance{InstanceGeometry{others_->accel}, {}, kNoId};
    if (!top_) {
      top_.emplace(options);
      top_->add(instance);
    } else {
      top_->replace(0, instance);
    }
    top_->set_enabled(0, stats(*others_->accel).items > 0);
  }
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::size_t k = read_objects_ + i;
    if (states_[k].removed) {
      if (i == in_top_.size()) in_top_.push_back(kNoId);
      continue;
    }
    const Affine& transform = scene.objects[k].transform;
    if (i == in_top_.size())
      in_top_.push_back(top_->add(added_[i].mesh, {MeshGeometry{}, transform, numbers_[k]}));
    if (!(top_->geometry(in_top_[i]).transform == transform)) top_->set_transform(in_top_[i], transform);
    top_->set_enabled(in_top_[i], states_[k].enabled && !states_[k].removed);
    top_->set_mask(in_top_[i], states_[k].mask);
  }
  return with_meshes(*others_, scene, read_objects_, top_->accel(mask));
}

std::shared_ptr<const PlacedWorld> SceneStore::world(std::uint32_t mask) {
  const std::lock_guard build_lock(building_);
  return world_while_held(mask);
}

std::vector<std::shared_ptr<const PlacedWorld>> SceneStore::worlds(const std::vector<std::uint32_t>& masks) {
  const std::lock_guard build_lock(building_);
  std::set<std::uint32_t> different;
  for (const std::uint32_t mask : masks) different.insert(least_mask(mask));
  if (different.size() > kMostMasks)
    throw Error("mask: " + std::to_string(different.size()) +
                " masks that see different things; expected at most " + std::to_string(kMostMasks) +
                " for one query");
  std::vector<std::shared_ptr<const PlacedWorld>> all;
  for (const std::uint32_t mask : masks) all.push_back(world_while_held(mask));
  return all;
}

std::shared_ptr<const PlacedWorld> SceneStore::world_while_held(std::uint32_t mask) {
  Scene scene;
  std::uint64_t changes;
  {
    const std::lock_guard lock(mutex_);
    mask = least_mask(mask);
    if (const auto found = worlds_.find(mask); found != worlds_.end()) return found->second;
    scene = shown_scene(), changes = changes_;
  }
  recentre(scene);
  auto world = std::make_shared<const PlacedWorld>(
      PlacedWorld{build(scene, mask), scene.origin, find_lost_digits(scene)});
  const std::lock_guard lock(mutex_);
  if (worlds_.size() >= 2 * kMostMasks) worlds_.clear();
  if (changes == changes_) worlds_[mask] = world;
  return world;
}

std::shared_ptr<const TextureSampler> SceneStore::textures() {
  const std::lock_guard build(building_);
  std::vector<Texture> textures;
  {
    const std::lock_guard lock(mutex_);
    if (textures_ != nullptr || reader_ == nullptr) return joined(textures_, added_textures_);
    const auto own = scene_.textures.begin() + static_cast<std::ptrdiff_t>(own_textures_);
    textures.assign(scene_.textures.begin(), own);
  }
  auto read = reader_->textures(std::move(textures));
  const std::lock_guard lock(mutex_);
  textures_ = std::move(read);
  return joined(textures_, added_textures_);
}

std::uint32_t SceneStore::object_count() const {
  const std::lock_guard lock(mutex_);
  return python::object_count(scene_);
}

Scene SceneStore::scene() const {
  Scene scene;
  {
    const std::lock_guard lock(mutex_);
    scene = shown_scene();
  }
  recentre(scene);
  return scene;
}

std::vector<Warning> SceneStore::warnings() const {
  const std::lock_guard lock(mutex_);
  return scene_.warnings;
}

std::vector<std::string> SceneStore::take_unsaid(const std::vector<Warning>& warnings) {
  std::vector<std::string> unsaid;
  const std::lock_guard lock(mutex_);
  for (const Warning& warning : warnings)
    if (said_.insert(warning.message).second) unsaid.push_back(warning.message);
  return unsaid;
}

std::vector<AddedMesh> SceneStore::added() const {
  const std::lock_guard lock(mutex_);
  return added_;
}

std::vector<SceneStore::Change> SceneStore::changes() const {
  const std::lock_guard lock(mutex_);
  std::vector<Change> all;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const ObjectState& s = states_[k];
    if (!s.enabled || s.removed || s.mask != ~0u || s.transform)
      all.push_back({numbers_[k], s.enabled, s.removed, s.mask, s.transform});
  }
  return all;
}

void SceneStore::set_quality(BuildQuality quality) {
  const std::lock_guard build(building_);
  const std::lock_guard lock(mutex_);
  quality_ = quality;
  worlds_.clear(), ++changes_;
  top_.reset(), in_top_.clear(), others_.reset();
}

BuildQuality SceneStore::quality() const {
  const std::lock_guard lock(mutex_);
  return quality_;
}

FileContents SceneStore::contents() const {
  FileContents all = files_;
  for (const auto& [path, state] : read_) {
    // An image that was not there is a warning.
    if (state == FileState{}) continue;
    if (state_of(path) != state)
      throw Error(Location{path}, "has changed since the scene was read; read it again before pickling",
                  ErrorKind::io);
    all.emplace(path, content_of(path));
  }
  return all;
}

}  // namespace oktett::python
