#include "io/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/math.h"
#include "core/phase.h"
#include "io/gltf/accessor.h"
#include "io/gltf/gltf_file.h"
#include "io/gltf/mesh_builder.h"
#include "io/gltf/pose.h"
#include "io/mesh/reading.h"
#include "io/text/files.h"

namespace oktett {
namespace {

constexpr std::size_t kMostWarnings = 100;
/// Keys of what moves while the shutter is open.
constexpr int kPoses = 9;

double degrees(double radians) { return radians * (180 / std::numbers::pi); }

/// How light fades from the inner to the outer angle: as the square of what is linear in the cosine
/// (KHR_lights_punctual).
std::shared_ptr<const LightProfile> spot_profile(const GltfLight& in) {
  constexpr int kSteps = 256;
  const double inner = std::min(in.inner_angle, in.outer_angle), outer = in.outer_angle;
  const double cos_inner = portable::cos(inner), cos_outer = portable::cos(outer);
  LightProfile profile;
  profile.horizontal = {0};
  if (inner > 0) profile.vertical = {0}, profile.values = {1};
  for (int i = 0; i <= kSteps && inner < outer; ++i) {
    const double angle = inner + (outer - inner) * i / kSteps;
    const double part = std::clamp((portable::cos(angle) - cos_outer) / (cos_inner - cos_outer), 0.0, 1.0);
    profile.vertical.push_back(degrees(angle)), profile.values.push_back(static_cast<float>(part * part));
  }
  if (inner >= outer) profile.vertical.push_back(degrees(outer)), profile.values.push_back(1);
  return std::make_shared<const LightProfile>(std::move(profile));
}

/// Goes through the nodes of the scene.
class SceneReader {
 public:
  SceneReader(const std::string& path, const GltfOptions& options)
      : phase_("reading", std::filesystem::path(path).filename().string(), 0),
        file_(path, options.variant),
        accessors_(file_),
        builder_(accessors_) {
    const GltfAnimator animator(accessors_, options.time.has_value());
    const int poses = animator.moves() && options.shutter > 0 ? kPoses : 1;
    for (int i = 0; i < poses; ++i) {
      times_.push_back(static_cast<double>(i) / (kPoses - 1));
      poses_.push_back(animator.at(
          options.time ? std::optional(*options.time + times_.back() * options.shutter) : std::nullopt));
    }
    if (!options.time && !file_.model().channels.empty())
      warn("animations are not shown without a time: things are shown at rest");
  }

  FileScene run() {
    add_gltf_materials(file_, scene_);
    visit_nodes();
    for (const std::string& words : file_.model().warnings) warn(words);
    return std::move(scene_);
  }

 private:
  void warn(const std::string& words) {
    if (scene_.warnings.size() < kMostWarnings)
      scene_.warnings.push_back({Location{file_.path()}, words});
    else if (scene_.warnings.size() == kMostWarnings)
      scene_.warnings.push_back({Location{file_.path()}, "there are more warnings, which are not shown"});
  }

  const GltfPose& pose() const { return poses_.front(); }

  void visit_nodes() {
    const GltfModel& model = file_.model();
    std::vector<bool> seen(model.nodes.size());
    std::vector<std::uint32_t> waiting(model.roots.rbegin(), model.roots.rend());
    while (!waiting.empty()) {
      const std::uint32_t number = waiting.back();
      waiting.pop_back();
      if (seen[number])
        file_.fail("nodes[" + std::to_string(number) + "] is in more than one place; nodes must form a tree");
      seen[number] = true;
      const GltfNode& node = model.nodes[number];
      show(node, number);
      waiting.insert(waiting.end(), node.children.rbegin(), node.children.rend());
    }
  }

  void show(const GltfNode& node, std::uint32_t number) {
    if (node.mesh == kNoId && node.camera == kNoId && node.light == kNoId) return;
    const Affine& to_world = pose().to_world[number];
    const bool is_skinned = node.mesh != kNoId && node.skin != kNoId && has_joints(node.mesh);
    if (!is_usable_place(to_world) && !is_skinned) {
      warn("nodes[" + std::to_string(number) +
           "]: its transform is singular or out of range; what it shows is skipped");
      return;
    }
    if (node.mesh != kNoId) show_mesh(node, number, is_skinned);
    if (!is_usable_place(to_world)) return;
    if (node.camera != kNoId && !scene_.camera) set_camera(node.camera, number);
    if (node.light != kNoId) add_light(file_.model().lights[node.light], to_world);
  }

  bool has_joints(std::uint32_t mesh) const {
    return std::ranges::any_of(file_.model().meshes[mesh].primitives,
                               [](const GltfPrimitive& p) { return !p.attributes.joints.empty(); });
  }

  void show_mesh(const GltfNode& node, std::uint32_t number, bool is_skinned) {
    std::vector<GltfBending> bendings;
    for (const GltfPose& at : poses_) {
      GltfBending& bending = bendings.emplace_back();
      bending.weights = at.weights[number];
      if (is_skinned) bending.joints = gltf_joints(accessors_, file_.model().skins[node.skin], at);
    }
    const bool is_bent = is_skinned || std::ranges::any_of(bendings, [](const GltfBending& bending) {
                           return std::ranges::any_of(bending.weights, [](double w) { return w != 0; });
                         });
    const std::vector<Affine> instances =
        is_skinned ? std::vector<Affine>{Affine{}} : instances_of(node, number);
    for (const GltfChoice& choice : choices_of(node.mesh)) {
      SharedMesh own;
      if (is_bent) own = bent(node.mesh, choice, bendings);
      const SharedMesh& mesh = is_bent ? own : unbent(node.mesh, choice);
      if (mesh.mesh == nullptr) continue;
      const std::string& name = node.name.empty() ? mesh.name : node.name;
      if (is_skinned) {
        // Where the node is does not count (glTF 2.0, 3.7.3.3).
        scene_.placements.push_back({name, add(mesh), {}});
      } else {
        const std::uint32_t shared = choice.strokes ? kNoId : is_bent ? add(mesh) : number_of(node.mesh);
        place(name, number, instances, mesh, shared);
      }
    }
  }

  /// Triangles, and points and lines of each material.
  std::vector<GltfChoice> choices_of(std::uint32_t mesh) const {
    std::vector<GltfChoice> choices{GltfChoice{}};
    for (const GltfPrimitive& primitive : file_.model().meshes[mesh].primitives) {
      const GltfChoice choice{true, primitive.material};
      if (primitive.has_strokes() && std::ranges::find(choices, choice) == choices.end())
        choices.push_back(choice);
    }
    return choices;
  }

  /// Shows a mesh at each instance of a node: as mesh `shared` of the scene or, if that is kNoId, as copies
  /// of `strokes` moved to the world.
  void place(const std::string& name, std::uint32_t node, const std::vector<Affine>& instances,
             const SharedMesh& strokes, std::uint32_t shared) {
    for (const Affine& instance : instances) {
      const Affine to_world = pose().to_world[node] * instance;
      if (!is_usable_place(to_world))
        warn("nodes[" + std::to_string(node) + "]: an instance is singular or out of range and is skipped");
      else if (shared != kNoId)
        scene_.placements.push_back({name, shared, to_world, motion_of(node, instance)});
      else
        scene_.placements.push_back(
            {name, add(moved(strokes, to_world)), {}, motion_of(node, instance * to_world.inverse())});
    }
  }

  /// A mesh as the file has it; a null mesh if it is empty.
  const SharedMesh& unbent(std::uint32_t number, const GltfChoice& choice) {
    const auto [found, is_new] = unbent_.try_emplace({number, choice});
    if (is_new) found->second = build(number, choice, nullptr);
    return found->second;
  }

  /// The index in the scene of the triangles of an unbent mesh, which are there.
  std::uint32_t number_of(std::uint32_t number) {
    const auto [found, is_new] = mesh_of_.try_emplace(number, kNoId);
    if (is_new) found->second = add(unbent(number, {}));
    return found->second;
  }

  std::uint32_t add(SharedMesh mesh) {
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

  SharedMesh build(std::uint32_t number, const GltfChoice& choice, const GltfBending* bending) {
    std::vector<std::string> warnings;
    GltfBuiltMesh built = builder_.build(number, choice, bending, warnings);
    for (const std::string& words : warnings) warn(words);
    SharedMesh mesh;
    mesh.name = file_.model().meshes[number].name, mesh.slots = std::move(built.slots);
    mesh.is_strokes = choice.strokes;
    if (built.mesh.triangle_count() > 0) mesh.mesh = std::make_shared<TriangleMesh>(std::move(built.mesh));
    return mesh;
  }

  /// A mesh as it is bent at all poses, the first of which it shows.
  SharedMesh bent(std::uint32_t number, const GltfChoice& choice, const std::vector<GltfBending>& bendings) {
    SharedMesh mesh = build(number, choice, bendings.data());
    const bool moves = std::ranges::adjacent_find(bendings, std::not_equal_to{}) != bendings.end();
    if (mesh.mesh == nullptr || !moves) return mesh;
    MeshBending all;
    for (std::size_t i = 0; i < bendings.size(); ++i) {
      MeshPose& at = all.poses.emplace_back();
      at.time = times_[i];
      if (i == 0) {
        at.positions = mesh.mesh->positions, at.normals = mesh.mesh->normals;
        at.tangents = mesh.mesh->tangents;
      } else if (bendings[i] == bendings[i - 1]) {
        at.positions = all.poses[i - 1].positions, at.normals = all.poses[i - 1].normals;
        at.tangents = all.poses[i - 1].tangents;
      } else {
        std::vector<std::string> told;
        TriangleMesh now = builder_.build(number, choice, &bendings[i], told).mesh;
        at.positions = std::move(now.positions), at.normals = std::move(now.normals);
        at.tangents = std::move(now.tangents);
      }
    }
    mesh.bending = std::make_shared<const MeshBending>(std::move(all));
    return mesh;
  }

  /// The same strokes in another place.
  SharedMesh moved(const SharedMesh& strokes, const Affine& map) {
    SharedMesh out = strokes;
    if (map.is_identity()) return out;
    const auto move = [&](Column<Vec3f>& positions) {
      accessors_.spend(positions.bytes());
      for (Vec3f& p : positions) {
        p = Vec3f(map.point(Vec3d(p)));
        for (const float x : {p.x, p.y, p.z})
          if (!is_coordinate(x)) file_.fail("mesh '" + strokes.name + "': placed: " + bad_coordinate(x));
      }
    };
    accessors_.spend(strokes.mesh->bytes());
    out.mesh = std::make_shared<TriangleMesh>(*strokes.mesh);
    move(out.mesh->positions);
    if (strokes.bending == nullptr) return out;
    MeshBending bending = *strokes.bending;
    for (MeshPose& at : bending.poses) move(at.positions);
    out.bending = std::make_shared<const MeshBending>(std::move(bending));
    return out;
  }

  /// Where a node shows its mesh, in its own space.
  std::vector<Affine> instances_of(const GltfNode& node, std::uint32_t number) {
    if (!node.is_instanced) return {Affine{}};
    std::vector<GltfPlace> places;
    const auto read = [&](std::uint32_t accessor, std::uint32_t components, const auto& set) {
      if (accessor == kNoId) return;
      const std::vector<float> numbers = accessors_.numbers(accessor, components);
      const std::size_t count = numbers.size() / components;
      accessors_.spend(count * (sizeof(GltfPlace) + sizeof(Affine) + sizeof(PlacedMesh)));
      if (places.empty()) places.resize(count);
      if (places.size() != count)
        file_.fail("nodes[" + std::to_string(number) + "]: attributes of " + std::to_string(places.size()) +
                   " and of " + std::to_string(count) + " instances");
      for (std::size_t i = 0; i < places.size(); ++i) set(places[i], &numbers[components * i]);
    };
    const auto vector = [](const float* x) { return Vec3d(Vec3f{x[0], x[1], x[2]}); };
    read(node.instance_translations, 3, [&](GltfPlace& p, const float* x) { p.translation = vector(x); });
    read(node.instance_rotations, 4, [&](GltfPlace& p, const float* x) {
      if (x[0] != 0 || x[1] != 0 || x[2] != 0 || x[3] != 0)
        p.rotation = {double{x[0]}, double{x[1]}, double{x[2]}, double{x[3]}};
    });
    read(node.instance_scales, 3, [&](GltfPlace& p, const float* x) { p.scale = vector(x); });
    std::vector<Affine> maps;
    for (const GltfPlace& place : places) maps.push_back(place.transform());
    return maps;
  }

  /// How a node moves, with what is beneath it; null if it does not.
  MotionPointer motion_of(std::uint32_t number, const Affine& inner) const {
    const bool moves = std::ranges::any_of(
        poses_, [&](const GltfPose& p) { return !(p.to_world[number] == pose().to_world[number]); });
    if (!moves) return nullptr;
    Motion motion;
    std::vector<MotionKey>& keys = motion.factors.emplace_back();
    for (std::size_t i = 0; i < poses_.size(); ++i)
      keys.push_back({times_[i], poses_[i].to_world[number] * inner});
    const bool mirrored = keys[0].transform.determinant() < 0;
    for (const MotionKey& key : keys)
      if (!is_usable_place(key.transform) || (key.transform.determinant() < 0) != mirrored) return nullptr;
    return std::make_shared<const Motion>(std::move(motion));
  }

  void set_camera(std::uint32_t camera_number, std::uint32_t node) {
    const GltfCamera& in = file_.model().cameras[camera_number];
    if (!in.problem.empty())
      return warn("cameras[" + std::to_string(camera_number) + "]: " + in.problem + "; it is left out");
    const Affine& to_world = pose().to_world[node];
    Camera camera;
    camera.from = to_world.point({0, 0, 0});
    camera.at = camera.from + normalize(to_world.vector({0, 0, -1}));
    camera.up = normalize(to_world.vector({0, 1, 0}));
    camera.projection = in.is_perspective ? Projection::perspective : Projection::orthographic;
    camera.fov = std::min(degrees(in.yfov), 179.0);
    camera.height = 2 * in.ymag;
    // Motions of cameras move what is given for the first time.
    camera.motion = motion_of(node, to_world.inverse());
    scene_.camera = camera, scene_.aspect = in.aspect;
  }

  /// In glTF a point gives candela, parallel light lux, a surface nits: here radiance is that in nits, and
  /// colours of lights are those of a white surface that faces them, which are pi times less.
  void add_light(const GltfLight& in, const Affine& to_world) {
    const Color color = in.color * static_cast<float>(in.intensity / std::numbers::pi);
    const Vec3d position = to_world.point({0, 0, 0}), direction = normalize(to_world.vector({0, 0, -1}));
    switch (in.kind) {
      case GltfLight::Kind::unknown:
        return;
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
        light.profile = spot_profile(in);
        scene_.lights.push_back(light);
        return;
      }
    }
  }

  const Phase phase_;
  const GltfFile file_;
  GltfAccessors accessors_;
  GltfMeshBuilder builder_;
  std::vector<double> times_;    ///< from 0 to 1
  std::vector<GltfPose> poses_;  ///< at these
  FileScene scene_;
  std::map<std::pair<std::uint32_t, GltfChoice>, SharedMesh> unbent_;
  std::map<std::uint32_t, std::uint32_t> mesh_of_;  ///< index in the scene, by that in the file
};

}  // namespace

FileScene load_gltf_scene(const std::string& path, const GltfOptions& options) {
  return SceneReader(path, options).run();
}

bool is_gltf_file(const std::string& path) {
  const std::string extension = lower_case_extension(without_packing(path));
  return extension == ".gltf" || extension == ".glb";
}

}  // namespace oktett
