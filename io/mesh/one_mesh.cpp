#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/far_mesh.h"
#include "core/mesh_geometry.h"
#include "core/parallel.h"
#include "io/mesh/file_scene.h"
#include "io/mesh/reading.h"
#include "io/mesh/rounding.h"
#include "io/mesh/strokes.h"

namespace oktett {
namespace {

/// Elements that further places of the same mesh may add: corners of four million triangles.
constexpr std::uint64_t kMostAdded = 12'000'000;

/// Elements in the columns of a mesh.
struct Sizes {
  std::uint64_t positions = 0, normals = 0, uvs = 0, corners = 0;

  void add(const TriangleMesh& m) {
    positions += m.positions.size(), normals += m.normals.size(), uvs += m.uvs.size(),
        corners += m.indices.size();
  }
  std::uint64_t most() const { return std::max({positions, normals, uvs, corners}); }
};

Sizes once(const FileScene& scene) {
  Sizes sizes;
  for (const SharedMesh& shared : scene.meshes) sizes.add(*shared.mesh);
  return sizes;
}

Sizes placed(const FileScene& scene) {
  Sizes sizes;
  for (const PlacedMesh& placement : scene.placements) sizes.add(*scene.meshes[placement.mesh].mesh);
  return sizes;
}

/// Puts what meshes carry behind each other. Where a mesh does not carry what another one does, it is white,
/// or zero.
class AttributeJoining {
 public:
  AttributeJoining(const FileScene& scene, const TriangleMesh& whole) : scene_(scene), whole_(whole) {
    for (const PlacedMesh& placement : scene.placements) {
      shown_.emplace(placement.mesh);
      for (const MeshAttribute& a : scene.meshes[placement.mesh].mesh->attributes)
        if (known_.insert(a.name).second) names_.push_back(a.name);
    }
    room_ = kAlways * whole.indices.size();
    for (const std::uint32_t mesh : shown_)
      for (const MeshAttribute& a : scene.meshes[mesh].mesh->attributes) room_ += a.size() * a.components;
  }

  std::vector<MeshAttribute> run(const std::string& path, std::vector<Warning>& warnings) {
    std::vector<MeshAttribute> all;
    for (const std::string& name : names_) {
      MeshAttribute joined = empty(name);
      const std::uint64_t size = domain_size(whole_, joined.domain) * std::uint64_t{joined.components};
      if (size > room_) {
        warnings.push_back({Location{path}, "the attribute " + quote_name(name) +
                                                " is left out: one mesh of all has no room for it"});
        continue;
      }
      room_ -= size;
      joined.floats = Column<float>(size, name == kColorAttribute ? 1.0f : 0.0f);
      Sizes before;
      for (const PlacedMesh& placement : scene_.placements) {
        const TriangleMesh& part = *scene_.meshes[placement.mesh].mesh;
        if (const MeshAttribute* const a = of_mesh_[placement.mesh])
          copy(part, *a, placement.to_world.determinant() < 0, before, joined);
        before.add(part);
      }
      all.push_back(std::move(joined));
    }
    return all;
  }

 private:
  /// Numbers for which there is always room, for each corner.
  static constexpr std::uint64_t kAlways = 16;

  MeshAttribute empty(const std::string& name) {
    MeshAttribute all;
    all.name = name;
    of_mesh_.assign(scene_.meshes.size(), nullptr);
    for (const std::uint32_t mesh : shown_) {
      const MeshAttribute* const a = find_attribute(*scene_.meshes[mesh].mesh, name);
      if (a == nullptr) continue;
      of_mesh_[mesh] = a;
      all.components = std::max(all.components, a->components);
      if (a->domain != AttributeDomain::vertex) all.domain = AttributeDomain::corner;
    }
    return all;
  }

  static void copy(const TriangleMesh& part, const MeshAttribute& a, bool is_mirror, const Sizes& before,
                   MeshAttribute& all) {
    const bool by_vertex = all.domain == AttributeDomain::vertex;
    float* const out = all.floats.data() + all.components * (by_vertex ? before.positions : before.corners);
    for_all(by_vertex ? part.positions.size() : part.indices.size(), [&](std::size_t i) {
      const std::size_t corner = i % 3, source = is_mirror && corner > 0 ? 3 - corner : corner;
      for (std::uint32_t k = 0; k < a.components; ++k)
        out[i * all.components + k] = by_vertex ? a.value(i, k) : corner_value(part, a, i / 3, source, k);
    });
  }

  const FileScene& scene_;
  const TriangleMesh& whole_;
  std::set<std::uint32_t> shown_;
  std::set<std::string> known_;
  std::vector<std::string> names_;             ///< in the order in which they come
  std::vector<const MeshAttribute*> of_mesh_;  ///< those of a name, by mesh
  std::uint64_t room_ = 0;                     ///< for numbers
};

/// Appends meshes to one.
class Joining {
 public:
  Joining(const std::string& path, const FileScene& scene) : path_(path), scene_(scene) {
    const Sizes sizes = placed(scene);
    check_limit(path, sizes.positions, "vertices", 0xfffffffeu);
    check_limit(path, sizes.corners / 3, "triangles", 0xfffffffeu);
    mesh_.positions.resize_uninitialized(sizes.positions);
    mesh_.normals.resize_uninitialized(sizes.normals);
    mesh_.uvs.resize_uninitialized(sizes.uvs);
    const auto any = [&](const auto& has) {
      return std::ranges::any_of(scene.meshes, [&](const SharedMesh& m) { return has(*m.mesh); });
    };
    if (any([](const TriangleMesh& m) { return !m.tangents.empty(); })) {
      mesh_.tangents.resize_uninitialized(sizes.normals);
      std::fill(mesh_.tangents.begin(), mesh_.tangents.end(), std::array<float, 4>{});
    }
    if (any([](const TriangleMesh& m) { return !m.second_uvs.empty(); })) {
      mesh_.second_uvs.resize_uninitialized(sizes.uvs);
      std::fill(mesh_.second_uvs.begin(), mesh_.second_uvs.end(), Vec2f{0, 0});
    }
    mesh_.indices.resize_uninitialized(sizes.corners);
    if (sizes.normals > 0) mesh_.normal_indices.resize_uninitialized(sizes.corners);
    if (sizes.uvs > 0) mesh_.uv_indices.resize_uninitialized(sizes.corners);
  }

  /// `origin`: from where positions count; null: as they are best kept. Adds to `warnings`.
  TriangleMesh run(const std::vector<std::vector<std::uint16_t>>& slots, const Vec3d* origin,
                   std::vector<Warning>& warnings) {
    if (!slots.empty()) mesh_.material_slots.resize_uninitialized(mesh_.triangle_count());
    for (const PlacedMesh& placement : scene_.placements) {
      const TriangleMesh& part = *scene_.meshes[placement.mesh].mesh;
      move_normals_and_uvs(placement, part);
      copy_corners(placement.to_world.determinant() < 0, part);
      if (!slots.empty()) {
        const std::vector<std::uint16_t>& own = slots[placement.mesh];
        for_all(part.triangle_count(), [&](std::size_t i) {
          mesh_.material_slots[before_.corners / 3 + i] =
              own[part.material_slots.empty() ? 0 : part.material_slots[i]];
        });
      }
      before_.add(part);
    }
    move_positions({});
    check_positions();
    mesh_.origin = origin != nullptr ? *origin : far_centre(mesh_.positions, false).value_or(Vec3d{});
    if (!(mesh_.origin == Vec3d{})) move_positions(mesh_.origin);
    std::string words = find_rounding(mesh_, [this](const Vec3d& centre) { move_positions(centre); });
    if (!words.empty()) warnings.push_back({Location{path_}, std::move(words)});
    return std::move(mesh_);
  }

 private:
  /// Less `centre`.
  void move_positions(const Vec3d& centre) {
    Vec3f* out = mesh_.positions.data();
    for (const PlacedMesh& placement : scene_.placements) {
      const Column<Vec3f>& own = scene_.meshes[placement.mesh].mesh->positions;
      const Affine& map = placement.to_world;
      const bool stays = map.is_identity() && centre == Vec3d{};
      for_all(own.size(),
              [&](std::size_t i) { out[i] = stays ? own[i] : Vec3f(map.point(Vec3d(own[i])) - centre); });
      out += own.size();
    }
  }

  /// Places may have moved them out of range.
  void check_positions() const {
    const Vec3f* at = mesh_.positions.data();
    for (const PlacedMesh& placement : scene_.placements) {
      const std::size_t count = scene_.meshes[placement.mesh].mesh->positions.size();
      for (std::size_t i = 0; i < count && !placement.to_world.is_identity(); ++i)
        for (const float x : {at[i].x, at[i].y, at[i].z})
          if (!is_coordinate(x))
            throw Error(Location{path_}, "object '" + placement.name + "': " + bad_coordinate(x));
      at += count;
    }
  }

  void move_normals_and_uvs(const PlacedMesh& placement, const TriangleMesh& part) {
    const Affine& map = placement.to_world;
    const bool is_identity = map.is_identity();
    const Affine inverse = map.inverse();
    for_all(part.normals.size(), [&](std::size_t i) {
      Vec3f& out = mesh_.normals[before_.normals + i];
      out = part.normals[i];
      if (is_identity) return;
      const Vec3d moved = inverse.normal_by_inverse(Vec3d(out));
      const double size = length(moved);
      if (size > 0) out = Vec3f(moved * (1 / size));
    });
    std::ranges::copy(part.uvs, mesh_.uvs.begin() + static_cast<std::ptrdiff_t>(before_.uvs));
    std::ranges::copy(part.second_uvs, mesh_.second_uvs.begin() + static_cast<std::ptrdiff_t>(before_.uvs));
    const float side = map.determinant() < 0 ? -1 : 1;
    for_all(part.tangents.size(), [&](std::size_t i) {
      const std::array<float, 4>& own = part.tangents[i];
      const Vec3f t(map.vector(Vec3d(Vec3f{own[0], own[1], own[2]})));
      mesh_.tangents[before_.normals + i] = is_identity ? own : std::array{t.x, t.y, t.z, own[3] * side};
    });
  }

  /// A mirror turns the corners around, so that the front stays the front.
  void copy_corners(bool is_mirror, const TriangleMesh& part) {
    const auto copy = [&](const Column<std::uint32_t>& from, std::uint64_t shift, Column<std::uint32_t>& to) {
      if (to.empty()) return;
      for_all(part.indices.size(), [&](std::size_t i) {
        const std::size_t corner = i % 3;
        const std::size_t source = is_mirror && corner > 0 ? i - corner + 3 - corner : i;
        const std::uint32_t index = from.empty() ? kNoId : from[source];
        to[before_.corners + i] = index == kNoId ? kNoId : index + static_cast<std::uint32_t>(shift);
      });
    };
    copy(part.indices, before_.positions, mesh_.indices);
    copy(part.normal_indices, before_.normals, mesh_.normal_indices);
    copy(part.uv_indices, before_.uvs, mesh_.uv_indices);
  }

  const std::string& path_;
  const FileScene& scene_;
  TriangleMesh mesh_;
  Sizes before_;
};

/// Gives each material that is shown a slot of the whole mesh.
class Slots {
 public:
  Slots(const std::string& path, FileScene& scene)
      : path_(path), scene_(scene), slot_of_(scene.materials.size() + 1, kNoId) {
    for (const SharedMesh& shared : scene.meshes) {
      std::vector<std::uint16_t>& own = own_.emplace_back();
      for (const std::uint32_t material : shared.slots) own.push_back(slot(material));
    }
    // A mesh without materials is one without materials in every format.
    if (materials.size() == 1 && slot_of_.back() == 0) materials.clear();
    if (materials.size() <= 1) own_.clear();
  }

  std::vector<Material> materials;
  /// Per mesh of the scene and slot of it; empty if all are in slot 0.
  const std::vector<std::vector<std::uint16_t>>& numbers() const { return own_; }

 private:
  std::uint16_t slot(std::uint32_t material) {
    std::uint32_t& slot = slot_of_[std::min<std::size_t>(material, scene_.materials.size())];
    if (slot != kNoId) return static_cast<std::uint16_t>(slot);
    if (materials.size() > 0xfffe) throw Error(Location{path_}, "more than 65535 materials in a mesh");
    slot = static_cast<std::uint32_t>(materials.size());
    materials.push_back(material == kNoId ? Material{} : scene_.materials[material]);
    return static_cast<std::uint16_t>(slot);
  }

  const std::string& path_;
  FileScene& scene_;
  std::vector<std::uint32_t> slot_of_;  ///< the last one is that of no material
  std::vector<std::vector<std::uint16_t>> own_;
};

}  // namespace

/// All that the placements of a scene show. `origin`: from where positions count; null: as they are best
/// kept.
static TriangleMesh joined(const std::string& path, FileScene& scene, const Slots& slots,
                           const Vec3d* origin) {
  const bool is_whole =
      scene.placements.size() == 1 && scene.meshes.size() == 1 && scene.placements[0].to_world.is_identity();
  if (is_whole) {
    TriangleMesh mesh = std::move(*scene.meshes[0].mesh);
    if (const std::optional<Vec3d> centre = far_centre(mesh.positions, true)) take_off(*centre, mesh);
    return mesh;
  }
  if (scene.placements.empty()) return {};
  TriangleMesh mesh = Joining(path, scene).run(slots.numbers(), origin, scene.warnings);
  mesh.attributes = AttributeJoining(scene, mesh).run(path, scene.warnings);
  return mesh;
}

bool is_usable_place(const Affine& map) {
  // Beyond it, transforms are of no use to coordinates in float.
  constexpr double kMostEntry = 1e15;
  for (const auto& row : map.m)
    for (const double x : row)
      if (!(std::abs(x) <= kMostEntry)) return false;
  return map.is_invertible();
}

double usual_stroke_width(FileScene& scene, const std::string& path) {
  StrokeCount count;
  for (const SharedMesh& shared : scene.meshes)
    if (shared.is_strokes) count.add(*shared.mesh);
  if (count.all() == 0) return 0;
  Box box;
  std::map<std::uint32_t, Box> boxes;
  for (const PlacedMesh& placement : scene.placements) {
    const auto [found, is_new] = boxes.try_emplace(placement.mesh);
    if (is_new) found->second = corner_box(*scene.meshes[placement.mesh].mesh);
    box.grow(placement.to_world.is_identity() ? found->second
                                              : transform_bounds(placement.to_world, found->second));
  }
  const double width = usual_stroke_width(box, count.all());
  scene.warnings.push_back({Location{path}, count.width_message(width)});
  return width;
}

bool can_be_one_mesh(const FileScene& scene) {
  return placed(scene).most() <= once(scene).most() + kMostAdded;
}

MeshFile one_mesh(const std::string& path, FileScene scene) {
  if (!can_be_one_mesh(scene))
    throw Error(Location{path},
                "its objects show " + std::to_string(placed(scene).corners / 3) + " triangles, of which " +
                    std::to_string(once(scene).corners / 3) +
                    " are different; too many for one mesh, but 'include' keeps them as instances");
  return join_placements(path, std::move(scene));
}

MeshFile join_placements(const std::string& path, FileScene scene) {
  MeshFile file;
  Slots slots(path, scene);
  std::vector<PlacedMesh> all = std::move(scene.placements);
  for (const bool strokes : {false, true}) {
    scene.placements.clear();
    std::ranges::copy_if(all, std::back_inserter(scene.placements),
                         [&](const PlacedMesh& p) { return scene.meshes[p.mesh].is_strokes == strokes; });
    // Strokes count from where triangles do.
    const bool follows = strokes && file.mesh.triangle_count() > 0;
    (strokes ? file.strokes : file.mesh) = joined(path, scene, slots, follows ? &file.mesh.origin : nullptr);
  }
  const bool has_materials = std::ranges::any_of(scene.meshes, [](const SharedMesh& m) {
    return std::ranges::any_of(m.slots, [](auto s) { return s != kNoId; });
  });
  if (has_materials) {
    file.materials = std::move(slots.materials);
    file.textures = std::move(scene.textures), file.media = std::move(scene.media);
    file.texture_places = std::move(scene.texture_places);
  } else {
    file.mesh.material_slots.clear(), file.strokes.material_slots.clear();
  }
  file.warnings = std::move(scene.warnings);
  if (file.mesh.triangle_count() + file.strokes.triangle_count() == 0)
    file.warnings.push_back({Location{path}, "no triangles"});
  return file;
}

}  // namespace oktett
