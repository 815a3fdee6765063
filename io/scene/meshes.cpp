#include "io/scene/meshes.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

#include "core/mesh_geometry.h"
#include "io/cache/scene_cache.h"
#include "io/image/library.h"
#include "io/mesh/reading.h"
#include "io/mesh/strokes.h"
#include "io/text/files.h"
#include "render/append_materials.h"

namespace oktett {

void check_textures(MeshFile& file) {
  for (std::size_t i = 0; i < file.textures.size(); ++i) {
    Texture& texture = file.textures[i];
    if (texture.content) continue;
    note_file_read(texture.path);
    const std::string why = why_not_an_image(texture.path);
    if (why.empty()) continue;
    file.warnings.push_back(
        {file.texture_places[i], "texture " + texture.path + " not used: " + why + "; white instead"});
    texture.path.clear();
  }
}

std::vector<std::uint32_t> append_materials(MeshFile& file, Scene& scene) {
  scene.texture_places.resize(scene.textures.size());
  scene.material_places.resize(scene.materials.size());
  std::ranges::move(file.texture_places, std::back_inserter(scene.texture_places));
  std::ranges::move(file.material_places, std::back_inserter(scene.material_places));
  std::vector<std::uint32_t> indices(file.materials.size());
  const std::uint32_t first =
      append_materials(std::move(file.materials), std::move(file.textures), std::move(file.media), scene);
  std::iota(indices.begin(), indices.end(), first);
  return indices;
}

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path canonical = std::filesystem::canonical(path, error);
  return error ? path : canonical.string();
}

namespace {

class AttributeCheck {
 public:
  explicit AttributeCheck(Scene& scene) : scene_(scene) {
    for (std::uint32_t i = 0; i < scene.materials.size(); ++i)
      for_each_texture(scene.materials[i], [&](std::uint32_t texture) {
        if (texture != kNoId && !scene.textures[texture].attribute.empty()) textures_.emplace(i, texture);
      });
  }

  void run() {
    if (textures_.empty()) return;
    for (const Prototype& prototype : scene_.prototypes)
      for (const Object& object : prototype.objects) check(object, kNoId);
    for (const Object& object : scene_.objects) check(object, kNoId);
  }

 private:
  /// `outer` is the material of the instance or combination around the object.
  void check(const Object& object, std::uint32_t outer) {
    const std::uint32_t own = object.material != kNoId ? object.material : outer;
    if (const auto* csg = std::get_if<CsgShape>(&object.shape)) {
      for (const Object& operand : *csg->operands) check(operand, own);
    } else if (const auto* instance = std::get_if<InstanceShape>(&object.shape)) {
      if (own == kNoId || instance->prototype >= scene_.prototypes.size()) return;
      for (const Object& inner : scene_.prototypes[instance->prototype].objects) check_material(inner, own);
    } else {
      check_material(object, own);
    }
  }

  void check_material(const Object& object, std::uint32_t material) {
    const auto* shape = std::get_if<MeshShape>(&object.shape);
    const TriangleMesh* const mesh = shape == nullptr ? nullptr : shape->mesh.get();
    if (material != kNoId || shape == nullptr) return check_textures_of(mesh, material);
    for (const std::uint32_t slot : shape->slot_materials) check_textures_of(mesh, slot);
  }

  void check_textures_of(const TriangleMesh* mesh, std::uint32_t material) {
    const auto [begin, end] = textures_.equal_range(material);
    for (auto entry = begin; entry != end; ++entry) {
      const std::string& name = scene_.textures[entry->second].attribute;
      if (mesh != nullptr && find_attribute(*mesh, name) != nullptr) continue;
      if (!told_.emplace(entry->second, mesh).second) continue;
      warn(entry->second, name, mesh);
    }
  }

  void warn(std::uint32_t texture, const std::string& name, const TriangleMesh* mesh) {
    // Those of other files are white where a mesh has no colours.
    const std::vector<Location>& places = scene_.texture_places;
    if (texture >= places.size() || places[texture].line == 0) return;
    std::string message = "an object of this material is no mesh, and has no attribute " + quote_name(name);
    if (mesh != nullptr) {
      std::vector<std::string> known;
      for (const MeshAttribute& a : mesh->attributes) known.push_back(a.name);
      message = "a mesh of this material has no attribute " + quote_name(name) + did_you_mean(name, known);
    }
    scene_.warnings.push_back({places[texture], message + "; white instead"});
  }

  Scene& scene_;
  std::multimap<std::uint32_t, std::uint32_t> textures_;  ///< those of attributes, by material
  std::set<std::pair<std::uint32_t, const TriangleMesh*>> told_;
};

}  // namespace

void warn_of_attributes(Scene& scene) { AttributeCheck(scene).run(); }

const MeshLibrary::Entry& MeshLibrary::load(const std::string& path, const MeshOptions& options,
                                            Scene& scene) {
  const std::pair key(canonical_path(path), options.weld);
  const auto found = entries_.find(key);
  if (found != entries_.end()) return found->second;
  SceneCache* const cache = SceneCache::current();
  MeshFile file = cache != nullptr ? cache->load_mesh(path, options) : load_mesh(path, options);
  const Entry& entry = entries_.emplace(key, add(std::move(file), scene)).first->second;
  entry_of_[entry.mesh.get()] = &entry;
  return entry;
}

void MeshLibrary::add(const std::string& name, std::shared_ptr<const TriangleMesh> mesh) {
  Entry& entry = entries_[{name, false}];
  entry.mesh = std::move(mesh);
  entry_of_[entry.mesh.get()] = &entry;
}

const MeshLibrary::Entry* MeshLibrary::find(const std::string& name) const {
  const auto found = entries_.find({name, false});
  return found == entries_.end() ? nullptr : &found->second;
}

const MeshLibrary::Entry& MeshLibrary::entry_of(const TriangleMesh& mesh) const {
  return *entry_of_.at(&mesh);
}

std::vector<MeshShape> MeshLibrary::Entry::stroke_shapes(double width, const Location& where,
                                                         std::vector<Warning>& warnings) const {
  std::vector<MeshShape> shapes = strokes;
  if (!(width > 0) && !shapes.empty()) {
    StrokeCount count;
    Box box = corner_box(*mesh);
    for (const MeshShape& shape : shapes) count.add(*shape.mesh), box.grow(corner_box(*shape.mesh));
    width = usual_stroke_width(box, count.all());
    warnings.push_back({where, count.width_message(width)});
  }
  for (MeshShape& shape : shapes) shape.stroke_width = width;
  return shapes;
}

MeshLibrary::Entry MeshLibrary::add(MeshFile file, Scene& scene) {
  check_textures(file);
  Entry entry;
  entry.slot_materials = append_materials(file, scene);
  entry.mesh = std::make_shared<const TriangleMesh>(std::move(file.mesh));
  for (StrokeSlot& part : split_by_slot(std::move(file.strokes))) {
    MeshShape& shape = entry.strokes.emplace_back();
    shape.mesh = std::make_shared<const TriangleMesh>(std::move(part.strokes));
    if (part.slot < entry.slot_materials.size()) shape.slot_materials = {entry.slot_materials[part.slot]};
  }
  std::move(file.warnings.begin(), file.warnings.end(), std::back_inserter(scene.warnings));
  return entry;
}

}  // namespace oktett
