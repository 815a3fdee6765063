#include "python/src/scene_store.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>

#include "core/error.h"
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

std::uint32_t count_objects(const std::vector<Object>& objects) {
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
  const std::lock_guard lock(mutex_);
  const std::uint32_t number = python::object_count(scene_);
  Object object;
  MeshShape shape;
  shape.mesh = added.mesh;
  object.shape = std::move(shape);
  object.transform = added.transform;
  place_mesh(object);
  if (!(scene_.origin == Vec3d{}))
    object.transform = Affine::translation(scene_.origin * -1.0) * object.transform;
  object.name = added.name;
  if (material) object.material = append_material(std::move(*material));
  if (!added.material_name.empty()) object.material = material_of(scene_, added.material_name);
  show_colors(scene_, object);
  scene_.objects.push_back(std::move(object));
  added_.push_back(std::move(added));
  world_.reset(), ++changes_;
  return number;
}

std::shared_ptr<const PlacedWorld> SceneStore::built_world() const {
  const std::lock_guard lock(mutex_);
  return world_;
}

std::shared_ptr<const PlacedWorld> SceneStore::world() {
  const std::lock_guard build(building_);
  Scene scene;
  BuildOptions options;
  std::uint64_t changes;
  {
    const std::lock_guard lock(mutex_);
    if (world_ != nullptr) return world_;
    scene = scene_, options.quality = quality_, changes = changes_;
  }
  recentre(scene);
  auto world = std::make_shared<const PlacedWorld>(
      PlacedWorld{build_world(scene, options), scene.origin, find_lost_digits(scene)});
  const std::lock_guard lock(mutex_);
  if (changes == changes_) world_ = world;
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
    scene = scene_;
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

void SceneStore::set_quality(BuildQuality quality) {
  const std::lock_guard lock(mutex_);
  quality_ = quality;
  world_.reset(), ++changes_;
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
