#include "python/src/scene_store.h"

#include <sys/stat.h>

#include <fstream>
#include <sstream>
#include <utility>
#include <variant>

#include "core/error.h"

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
  for (const std::string& name : read.paths) store->read_.emplace(name, state_of(name));
  return store;
}

std::uint32_t SceneStore::add(AddedMesh added) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t number = python::object_count(scene_);
  Object object;
  MeshShape shape;
  shape.mesh = added.mesh;
  object.shape = std::move(shape);
  object.transform = added.transform;
  object.name = added.name;
  scene_.objects.push_back(std::move(object));
  added_.push_back(std::move(added));
  world_.reset(), ++changes_;
  return number;
}

std::shared_ptr<const World> SceneStore::built_world() const {
  const std::lock_guard lock(mutex_);
  return world_;
}

std::shared_ptr<const World> SceneStore::world() {
  const std::lock_guard build(building_);
  Scene scene;
  BuildOptions options;
  std::uint64_t changes;
  {
    const std::lock_guard lock(mutex_);
    if (world_ != nullptr) return world_;
    scene = scene_, options.quality = quality_, changes = changes_;
  }
  auto world = std::make_shared<const World>(build_world(scene, options));
  const std::lock_guard lock(mutex_);
  if (changes == changes_) world_ = world;
  return world;
}

std::shared_ptr<const TextureSampler> SceneStore::textures() {
  const std::lock_guard build(building_);
  std::vector<Texture> textures;
  {
    const std::lock_guard lock(mutex_);
    if (textures_ != nullptr || reader_ == nullptr) return textures_;
    textures = scene_.textures;
  }
  auto read = reader_->textures(std::move(textures));
  const std::lock_guard lock(mutex_);
  return textures_ = std::move(read);
}

std::uint32_t SceneStore::object_count() const {
  const std::lock_guard lock(mutex_);
  return python::object_count(scene_);
}

Scene SceneStore::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
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
