#include "io/scene/gltf.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "io/scene/meshes.h"

namespace oktett {
namespace {

/// Adds the parts of a file to a scene.
class Adding {
 public:
  Adding(const std::string& path, GltfScene& file, Scene& scene) : path_(path), file_(file), scene_(scene) {
    MeshFile common;
    common.materials = std::move(file.materials), common.textures = std::move(file.textures);
    common.texture_places = std::move(file.texture_places), common.warnings = std::move(file.warnings);
    check_textures(common);
    materials_ = append_materials(common, scene);
    std::ranges::move(common.warnings, std::back_inserter(scene.warnings));
  }

  void add_objects() {
    std::vector<std::uint32_t> uses(file_.meshes.size()), prototypes(file_.meshes.size(), kNoId);
    for (const GltfPlacement& placement : file_.placements) ++uses[placement.mesh];
    for (std::uint32_t i = 0; i < uses.size(); ++i) {
      if (uses[i] < 2) continue;
      prototypes[i] = static_cast<std::uint32_t>(scene_.prototypes.size());
      scene_.prototypes.push_back({file_.meshes[i].name, {object(file_.meshes[i].name, shape(i))}});
    }
    // Instances that follow each other may become one list.
    for (const GltfPlacement& placement : file_.placements)
      if (uses[placement.mesh] < 2) add(placement, shape(placement.mesh));
    for (const GltfPlacement& placement : file_.placements)
      if (uses[placement.mesh] > 1) add(placement, InstanceShape{prototypes[placement.mesh]});
  }

  void add_view_and_lights() {
    if (file_.camera) scene_.camera = *file_.camera, scene_.camera_given = true;
    if (file_.lights.empty()) return;
    std::ranges::move(file_.lights, std::back_inserter(scene_.lights));
    scene_.lights_given = true;
  }

 private:
  MeshShape shape(std::uint32_t mesh) const {
    MeshShape shape;
    shape.mesh = file_.meshes[mesh].mesh;
    for (const std::uint32_t slot : file_.meshes[mesh].slots)
      shape.slot_materials.push_back(slot < materials_.size() ? materials_[slot] : kNoId);
    return shape;
  }

  Object object(const std::string& name, Shape shape) const {
    Object object;
    object.shape = std::move(shape), object.name = name, object.where = Location{path_};
    return object;
  }

  void add(const GltfPlacement& placement, Shape shape) {
    scene_.objects.push_back(object(placement.name, std::move(shape)));
    scene_.objects.back().transform = placement.to_world;
  }

  const std::string& path_;
  GltfScene& file_;
  Scene& scene_;
  std::vector<std::uint32_t> materials_;
};

}  // namespace

void add_gltf(const std::string& path, GltfScene file, Scene& scene) {
  Adding adding(path, file, scene);
  adding.add_objects();
  adding.add_view_and_lights();
}

}  // namespace oktett
