#include "io/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

#include "core/phase.h"
#include "io/gltf/gltf_file.h"
#include "io/gltf/materials.h"
#include "io/gltf/mesh.h"
#include "io/text/extension.h"

namespace oktett {
namespace {

constexpr std::size_t kMostWarnings = 100;
/// Beyond it, transforms are of no use to coordinates in float.
constexpr double kMostEntry = 1e15;

double degrees(double radians) { return radians * (180 / std::numbers::pi); }

/// What no point of a place can be beyond, and what can be undone.
bool is_usable(const Affine& map) {
  for (const auto& row : map.m)
    for (const double x : row)
      if (!(std::abs(x) <= kMostEntry)) return false;
  return map.is_invertible();
}

/// Goes through the nodes of the scene.
class SceneReader {
 public:
  explicit SceneReader(const std::string& path)
      : phase_("reading", std::filesystem::path(path).filename().string(), 0),
        file_(path),
        accessors_(file_),
        builder_(accessors_) {}

  GltfScene run() {
    add_gltf_materials(file_, scene_);
    visit_nodes();
    for (const std::string& words : file_.model().warnings) warn(words);
    return std::move(scene_);
  }

 private:
  struct Visit {
    std::uint32_t node;
    Affine parent_to_world;
  };

  void warn(const std::string& words) {
    if (scene_.warnings.size() < kMostWarnings)
      scene_.warnings.push_back({Location{file_.path()}, words});
    else if (scene_.warnings.size() == kMostWarnings)
      scene_.warnings.push_back({Location{file_.path()}, "there are more warnings, which are not shown"});
  }

  void visit_nodes() {
    const GltfModel& model = file_.model();
    std::vector<bool> seen(model.nodes.size());
    std::vector<Visit> waiting;
    const auto add = [&](const std::vector<std::uint32_t>& nodes, const Affine& to_world) {
      for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) waiting.push_back({*node, to_world});
    };
    add(model.roots, {});
    while (!waiting.empty()) {
      const Visit visit = waiting.back();
      waiting.pop_back();
      if (seen[visit.node])
        file_.fail("nodes[" + std::to_string(visit.node) +
                   "] is in more than one place; nodes must form a tree");
      seen[visit.node] = true;
      const GltfNode& node = model.nodes[visit.node];
      const Affine to_world = visit.parent_to_world * node.to_parent;
      show(node, visit.node, to_world);
      add(node.children, to_world);
    }
  }

  void show(const GltfNode& node, std::uint32_t number, const Affine& to_world) {
    if (node.mesh == kNoId && node.camera == kNoId && node.light == kNoId) return;
    if (!is_usable(to_world)) {
      warn("nodes[" + std::to_string(number) +
           "]: its transform is singular or out of range; what it shows is skipped");
      return;
    }
    if (node.mesh != kNoId) place_mesh(node, to_world);
    if (node.camera != kNoId && !scene_.camera) set_camera(file_.model().cameras[node.camera], to_world);
    if (node.light != kNoId) add_light(file_.model().lights[node.light], to_world);
  }

  void place_mesh(const GltfNode& node, const Affine& to_world) {
    const auto [found, is_new] =
        mesh_of_.try_emplace(node.mesh, static_cast<std::uint32_t>(scene_.meshes.size()));
    const std::string& name = file_.model().meshes[node.mesh].name;
    if (is_new) {
      std::vector<std::string> warnings;
      GltfBuiltMesh built = builder_.build(node.mesh, warnings);
      for (const std::string& words : warnings) warn(words);
      if (built.mesh.triangle_count() == 0)
        found->second = kNoId;
      else
        scene_.meshes.push_back(
            {name, std::make_shared<TriangleMesh>(std::move(built.mesh)), std::move(built.slots)});
    }
    if (found->second != kNoId)
      scene_.placements.push_back({node.name.empty() ? name : node.name, found->second, to_world});
  }

  void set_camera(const GltfCamera& in, const Affine& to_world) {
    Camera camera;
    camera.from = to_world.point({0, 0, 0});
    camera.at = camera.from + normalize(to_world.vector({0, 0, -1}));
    camera.up = normalize(to_world.vector({0, 1, 0}));
    camera.projection = in.is_perspective ? Projection::perspective : Projection::orthographic;
    camera.fov = std::min(degrees(in.yfov), 179.0);
    camera.height = 2 * in.ymag;
    scene_.camera = camera, scene_.aspect = in.aspect;
  }

  /// In glTF a point gives candela, parallel light lux, a surface nits: here radiance is that in nits, and
  /// colours of lights are those of a white surface that faces them, which are pi times less.
  void add_light(const GltfLight& in, const Affine& to_world) {
    const Color color = in.color * static_cast<float>(in.intensity / std::numbers::pi);
    const Vec3d position = to_world.point({0, 0, 0}), direction = normalize(to_world.vector({0, 0, -1}));
    switch (in.kind) {
      case GltfLight::Kind::directional: {
        DirectionalLight light;
        light.direction = direction, light.color = color;
        scene_.lights.push_back(light);
        return;
      }
      case GltfLight::Kind::point: {
        PointLight light;
        light.position = position, light.color = color, light.falloff = true;
        scene_.lights.push_back(light);
        return;
      }
      case GltfLight::Kind::spot: {
        SpotLight light;
        light.position = position, light.direction = direction, light.color = color;
        light.outer_angle = degrees(in.outer_angle);
        light.inner_angle = std::min(degrees(in.inner_angle), light.outer_angle);
        scene_.lights.push_back(light);
        return;
      }
    }
  }

  const Phase phase_;
  const GltfFile file_;
  GltfAccessors accessors_;
  GltfMeshBuilder builder_;
  GltfScene scene_;
  std::map<std::uint32_t, std::uint32_t> mesh_of_;  ///< index in the scene, by that in the file
};

}  // namespace

GltfScene load_gltf_scene(const std::string& path) { return SceneReader(path).run(); }

bool is_gltf_file(const std::string& path) {
  const std::string extension = lower_case_extension(without_packing(path));
  return extension == ".gltf" || extension == ".glb";
}

}  // namespace oktett
