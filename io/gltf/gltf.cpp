#include "io/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "core/parallel.h"
#include "core/phase.h"
#include "io/gltf/accessor.h"
#include "io/gltf/gltf_file.h"
#include "io/gltf/packed.h"
#include "io/mesh/reading.h"
#include "io/text/files.h"

namespace oktett {

// ---- Meshes of glTF files.

struct GltfBuiltMesh {
  TriangleMesh mesh;
  /// Material of the file per slot of the mesh; kNoId: none.
  std::vector<std::uint32_t> slots;
};

/// Makes meshes of a file, as long as they take no more memory than the file justifies.
class GltfMeshBuilder {
 public:
  explicit GltfMeshBuilder(GltfAccessors& accessors) : accessors_(accessors) {}

  /// All triangles of the mesh with this number. Throws Error. What is left out is added to `warnings`.
  GltfBuiltMesh build(std::uint32_t number, std::vector<std::string>& warnings);

 private:
  void spend(std::uint64_t bytes);

  GltfAccessors& accessors_;
  std::uint64_t spent_ = 0;
};

/// The set of texture coordinates that the textures of a primitive's material show; the first such set if
/// they show several.
static std::size_t gltf_uv_set(const GltfModel& model, const GltfPrimitive& primitive) {
  if (primitive.material == kNoId) return 0;
  const GltfMaterial& m = model.materials[primitive.material];
  for (const GltfTextureUse* use : {&m.base_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                    &m.emission_texture, &m.transmission_texture, &m.coat_texture})
    if (use->texture != kNoId) return use->uvs;
  return 0;
}

namespace {

constexpr std::uint64_t kMostElements = 0xfffffffeu;
/// An accessor with so many elements for each corner of a mesh is not read as a whole.
constexpr std::uint64_t kRareUse = 4;

/// The columns that a mesh reads.
enum Role : std::size_t { kPositions, kNormals, kUvs, kRoles };

/// A primitive that is shown.
struct Part {
  const GltfPrimitive* primitive = nullptr;
  std::string name;
  bool has[kRoles] = {};
  std::uint32_t accessor[kRoles] = {kNoId, kNoId, kNoId};  ///< kNoId: of this part alone
  GltfElements elements[kRoles];
  std::uint64_t base[kRoles] = {};  ///< of its elements in the columns of the mesh
  bool is_indexed = false;
  GltfElements indices;
  std::uint64_t corners = 0, first_triangle = 0, triangles = 0;
  std::uint16_t slot = 0;
  const DracoMesh* draco = nullptr;
  bool picks = false;  ///< reads only the elements that its corners name
};

/// Elements without gaps in memory.
GltfElements elements_of(const std::string& name, const void* data, std::uint64_t count,
                         std::uint32_t components, GltfNumber number = GltfNumber::float32) {
  GltfElements e;
  e.name = name, e.data = static_cast<const char*>(data), e.count = count;
  e.components = components, e.number = number, e.stride = bytes_of(number) * components;
  return e;
}

/// The building of one mesh.
class Build {
 public:
  Build(GltfAccessors& accessors, std::uint32_t number, std::vector<std::string>& warnings)
      : accessors_(accessors), file_(accessors.file()), number_(number), warnings_(warnings) {}

  /// Finds out how large the mesh will be and returns its bytes.
  std::uint64_t measure() {
    find_parts();
    choose_slots();
    find_rare_uses();
    std::uint64_t bytes = 0, triangles = 0;
    for (Part& part : parts_) {
      part.first_triangle = triangles;
      triangles += part.triangles;
    }
    bytes += 12 * triangles * (1u + (any(kNormals) ? 1u : 0u) + (any(kUvs) ? 1u : 0u));
    for (const Part& part : parts_)
      for (std::size_t role = 0; role < kRoles; ++role)
        if (part.has[role]) bytes += 12 * (part.picks ? part.corners : part.elements[role].count);
    check_limit(file_.path(), triangles, "triangles", kMostElements);
    triangles_ = triangles;
    return bytes;
  }

  GltfBuiltMesh run() {
    out_.mesh.indices.resize_uninitialized(3 * triangles_);
    for (Part& part : parts_) read_corners(part);
    for (const std::size_t role : {kPositions, kNormals, kUvs}) place(role);
    read_columns();
    fill_indices();
    fill_slots();
    return std::move(out_);
  }

 private:
  bool any(std::size_t role) const {
    return std::ranges::any_of(parts_, [role](const Part& part) { return part.has[role]; });
  }

  void find_parts() {
    const GltfMesh& mesh = file_.model().meshes[number_];
    std::size_t lines = 0;
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
      const GltfPrimitive& primitive = mesh.primitives[i];
      const std::string name =
          "meshes[" + std::to_string(number_) + "].primitives[" + std::to_string(i) + "]";
      if (primitive.mode < GltfPrimitive::kTriangles) {
        ++lines;
        continue;
      }
      if (primitive.attributes.positions == kNoId) file_.fail(name + ": expected an attribute POSITION");
      Part& part = parts_.emplace_back();
      part.primitive = &primitive, part.name = name;
      const std::size_t uv_set = gltf_uv_set(file_.model(), primitive);
      if (primitive.draco_view != kNoId && (can_unpack_draco() || !has_plain_data(primitive)))
        find_draco(part, uv_set);
      else
        find_plain(part, uv_set);
      count_corners(part);
    }
    if (lines > 0)
      warnings_.push_back("meshes[" + std::to_string(number_) + "]: lines and points are skipped");
  }

  bool has_plain_data(const GltfPrimitive& primitive) const {
    return file_.model().accessors[primitive.attributes.positions].view != kNoId;
  }

  void find_plain(Part& part, std::size_t uv_set) {
    const GltfAttributes& a = part.primitive->attributes;
    const std::uint32_t accessors[kRoles] = {a.positions, a.normals, a.uvs[uv_set]};
    for (std::size_t role = 0; role < kRoles; ++role) {
      if (accessors[role] == kNoId) continue;
      part.has[role] = true, part.accessor[role] = accessors[role];
      part.elements[role] = accessors_.elements(accessors[role]);
    }
    if (part.primitive->indices == kNoId) return;
    part.is_indexed = true;
    part.indices = accessors_.elements(part.primitive->indices);
  }

  void find_draco(Part& part, std::size_t uv_set) {
    const GltfView& view = file_.model().views[part.primitive->draco_view];
    const std::string_view bytes = file_.bytes(view.range, part.name);
    DracoMesh& mesh =
        draco_.emplace_back(unpack_draco(file_, bytes, part.primitive->draco_attributes, uv_set, part.name));
    const auto take = [&](Role role, const std::vector<float>& numbers, std::uint32_t components) {
      if (numbers.empty()) return;
      part.has[role] = true;
      part.elements[role] = elements_of(part.name, numbers.data(), mesh.vertices, components);
    };
    part.has[kPositions] = true;
    part.elements[kPositions] = elements_of(part.name, mesh.positions.data(), mesh.vertices, 3);
    take(kNormals, mesh.normals, 3), take(kUvs, mesh.uvs, 2);
    part.draco = &mesh, part.is_indexed = true;
    part.indices = elements_of(part.name, mesh.indices.data(), mesh.indices.size(), 1, GltfNumber::uint32);
  }

  void count_corners(Part& part) {
    const std::uint64_t vertices = part.elements[kPositions].count;
    check_limit(file_.path(), vertices, "vertices", kMostElements);
    for (const std::size_t role : {kNormals, kUvs})
      if (part.has[role] && part.elements[role].count != vertices)
        file_.fail(part.elements[role].name + ": " + std::to_string(part.elements[role].count) +
                   " elements for " + std::to_string(vertices) + " vertices of " + part.name);
    part.corners = part.is_indexed ? part.indices.count : vertices;
    if (part.primitive->mode == GltfPrimitive::kTriangles || part.draco != nullptr) {
      if (part.corners % 3 != 0)
        file_.fail(part.name + ": expected three corners for each triangle, found " +
                   std::to_string(part.corners) + " in all");
      part.triangles = part.corners / 3;
    } else {
      part.triangles = part.corners < 3 ? 0 : part.corners - 2;
    }
  }

  void choose_slots() {
    std::map<std::uint32_t, std::uint16_t> slots;
    for (Part& part : parts_) {
      const auto [found, is_new] =
          slots.try_emplace(part.primitive->material, static_cast<std::uint16_t>(slots.size()));
      if (is_new) out_.slots.push_back(part.primitive->material);
      if (slots.size() > 65535) file_.fail(part.name + ": more than 65535 materials in a mesh");
      part.slot = found->second;
    }
  }

  /// Many meshes may share the elements of an accessor, each for itself only a few of them.
  void find_rare_uses() {
    std::map<std::uint32_t, std::uint64_t> corners;
    for (const Part& part : parts_) corners[part.accessor[kPositions]] += part.corners;
    for (Part& part : parts_) {
      part.picks = part.is_indexed && part.draco == nullptr &&
                   part.elements[kPositions].count > 1024 + kRareUse * corners[part.accessor[kPositions]];
      for (std::size_t role = 0; role < kRoles; ++role)
        if (part.has[role])
          part.picks =
              part.picks && part.elements[role].data != nullptr && part.elements[role].sparse_count == 0;
      if (part.picks) std::ranges::fill(part.accessor, kNoId);
    }
  }

  /// Writes the corners of all triangles, as numbers of the part's own elements.
  void read_corners(Part& part) {
    std::uint32_t* const out = out_.mesh.indices.data() + 3 * part.first_triangle;
    const std::uint64_t vertices = part.elements[kPositions].count;
    const bool is_list = part.primitive->mode == GltfPrimitive::kTriangles || part.draco != nullptr;
    Column<std::uint32_t> row;
    if (part.is_indexed) {
      if (!is_list) row.resize_uninitialized(part.corners);
      read_gltf_indices(file_, part.indices, vertices, is_list ? out : row.data());
    }
    const auto corner = [&](std::uint64_t i) {
      return part.is_indexed ? row[i] : static_cast<std::uint32_t>(i);
    };
    if (is_list) {
      if (!part.is_indexed)
        for (std::uint64_t i = 0; i < part.corners; ++i) out[i] = static_cast<std::uint32_t>(i);
    } else {
      // glTF 2.0, 3.7.2.1.
      for (std::uint64_t i = 0; i < part.triangles; ++i) {
        const bool fan = part.primitive->mode == GltfPrimitive::kFan;
        const std::uint64_t turn = i % 2;
        out[3 * i] = corner(fan ? i + 1 : i);
        out[3 * i + 1] = corner(fan ? i + 2 : i + 1 + turn);
        out[3 * i + 2] = corner(fan ? 0 : i + 2 - turn);
      }
    }
    if (part.picks) pick_used(part, out);
  }

  /// Leaves only the elements that the part's corners name.
  void pick_used(Part& part, std::uint32_t* corners) {
    const std::size_t count = 3 * part.triangles;
    std::vector<std::uint32_t> used(corners, corners + count);
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::size_t i = 0; i < count; ++i)
      corners[i] = static_cast<std::uint32_t>(std::ranges::lower_bound(used, corners[i]) - used.begin());
    for (std::size_t role = 0; role < kRoles; ++role)
      if (part.has[role]) pick(part, role, used);
  }

  void pick(Part& part, std::size_t role, const std::vector<std::uint32_t>& used) {
    GltfElements& e = part.elements[role];
    const std::size_t size = std::size_t{bytes_of(e.number)} * e.components;
    std::string& picked = picked_.emplace_back();
    picked.resize(used.size() * size);
    for (std::size_t i = 0; i < used.size(); ++i)
      std::memcpy(picked.data() + i * size, e.data + std::uint64_t{e.stride} * used[i], size);
    e.data = picked.data(), e.count = used.size(), e.stride = static_cast<std::uint32_t>(size);
  }

  /// Gives each accessor its place in the column.
  void place(std::size_t role) {
    std::map<std::uint32_t, std::uint64_t> places;
    std::uint64_t next = 0;
    for (Part& part : parts_) {
      if (!part.has[role]) continue;
      if (part.accessor[role] != kNoId) {
        const auto [found, is_new] = places.try_emplace(part.accessor[role], next);
        part.base[role] = found->second;
        if (!is_new) {
          part.elements[role].count = 0;  // has been read
          continue;
        }
      }
      part.base[role] = next;
      next += part.elements[role].count;
    }
    check_limit(file_.path(), next, "vertices", kMostElements);
    sizes_[role] = next;
  }

  static GltfCheck check_of(std::size_t role) {
    return role == kPositions ? GltfCheck::coordinate : GltfCheck::finite;
  }

  void read_columns() {
    TriangleMesh& mesh = out_.mesh;
    mesh.positions.resize_uninitialized(sizes_[kPositions]);
    mesh.normals.resize_uninitialized(sizes_[kNormals]);
    mesh.uvs.resize_uninitialized(sizes_[kUvs]);
    for (const Part& part : parts_) {
      for (const std::size_t role : {kPositions, kNormals}) {
        Column<Vec3f>& column = role == kPositions ? mesh.positions : mesh.normals;
        if (part.elements[role].count > 0)
          read_gltf_vectors(file_, part.elements[role], check_of(role), column.data() + part.base[role]);
      }
      if (part.elements[kUvs].count > 0)
        read_gltf_uvs(file_, part.elements[kUvs], mesh.uvs.data() + part.base[kUvs]);
    }
  }

  void fill_indices() {
    TriangleMesh& mesh = out_.mesh;
    for (const std::size_t role : {kNormals, kUvs}) {
      if (!any(role)) continue;
      Column<std::uint32_t>& column = role == kNormals ? mesh.normal_indices : mesh.uv_indices;
      column.resize_uninitialized(mesh.indices.size());
      for (const Part& part : parts_) shift(part, mesh.indices, column, role);
    }
    for (const Part& part : parts_) shift(part, mesh.indices, mesh.indices, kPositions);
  }

  /// Makes numbers of the part's elements those of the column.
  static void shift(const Part& part, const Column<std::uint32_t>& from, Column<std::uint32_t>& to,
                    std::size_t role) {
    const auto base = static_cast<std::uint32_t>(part.base[role]);
    if (base == 0 && part.has[role] && &from == &to) return;
    const std::uint32_t* const in = from.data() + 3 * part.first_triangle;
    std::uint32_t* const out = to.data() + 3 * part.first_triangle;
    const bool has = part.has[role];
    in_parts(3 * part.triangles, std::size_t{1} << 17, [&](std::uint64_t first, std::uint64_t last) {
      for (std::uint64_t i = first; i < last; ++i) out[i] = has ? in[i] + base : kNoId;
    });
  }

  void fill_slots() {
    TriangleMesh& mesh = out_.mesh;
    if (out_.slots.size() < 2) return;
    mesh.material_slots.resize_uninitialized(triangles_);
    for (const Part& part : parts_)
      std::fill_n(mesh.material_slots.data() + part.first_triangle, part.triangles, part.slot);
  }

  GltfAccessors& accessors_;
  const GltfFile& file_;
  const std::uint32_t number_;
  std::vector<std::string>& warnings_;
  std::vector<Part> parts_;
  std::deque<DracoMesh> draco_;
  std::deque<std::string> picked_;
  std::uint64_t triangles_ = 0;
  std::uint64_t sizes_[kRoles] = {};
  GltfBuiltMesh out_;
};

}  // namespace

GltfBuiltMesh GltfMeshBuilder::build(std::uint32_t number, std::vector<std::string>& warnings) {
  Build build(accessors_, number, warnings);
  spend(build.measure());
  return build.run();
}

void GltfMeshBuilder::spend(std::uint64_t bytes) {
  spent_ += bytes;
  const std::uint64_t most = (std::uint64_t{64} << 20) + 256 * accessors_.file().total_bytes();
  if (spent_ > most)
    accessors_.file().fail("its meshes take more than " + std::to_string(most) + " bytes, too many for " +
                           std::to_string(accessors_.file().total_bytes()) + " bytes of files");
}

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
