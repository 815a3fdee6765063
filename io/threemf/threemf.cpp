#include "io/threemf/threemf.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/phase.h"
#include "io/library/loaded_library.h"
#include "io/mesh/reading.h"
#include "io/text/file_content.h"
#include "io/threemf/model.h"

namespace oktett {

#ifdef OKTETT_THREEMF_LIBRARY

namespace {

const ThreeMfLibrary& threemf_library() {
  static const ThreeMfLibrary* const library = reinterpret_cast<ThreeMfLibraryEntry>(load_library(
      {OKTETT_THREEMF_LIBRARY, kThreeMfLibraryEntry, "reads 3MF files", std::size_t{64} << 20}))();
  return *library;
}

/// Makes what can be rendered of what a file says.
class ThreeMfReading {
 public:
  explicit ThreeMfReading(const std::string& path)
      : path_(path), file_(path), model_(threemf_library().read(path, file_.text())) {}

  FileScene run() {
    for (const std::string& words : model_.warnings) warn(words);
    if (model_.unit != std::string("millimeter"))
      warn(std::string("its unit is the ") + model_.unit + "; coordinates are taken as they stand");
    add_materials();
    mesh_of_.assign(model_.objects.size(), kNoId);
    for (const ThreeMfPart& part : model_.build) place(part, Affine{}, "", 0);
    return std::move(scene_);
  }

 private:
  void warn(std::string words) { scene_.warnings.push_back({Location{path_}, std::move(words)}); }
  [[noreturn]] void fail(const std::string& words) const { throw Error(Location{path_}, words); }

  std::uint32_t add(Texture texture) {
    scene_.textures.push_back(std::move(texture));
    scene_.texture_places.push_back(Location{path_});
    return static_cast<std::uint32_t>(scene_.textures.size() - 1);
  }

  void add_materials() {
    for (ThreeMfImage& image : model_.images) {
      Texture texture;
      texture.path = path_ + ":" + image.path;
      texture.content = std::make_shared<const std::string>(std::move(image.content));
      texture.lookup = image.lookup;
      add(std::move(texture));
    }
    for (const ThreeMfLook& look : model_.looks) scene_.materials.push_back(material_of(look));
  }

  Material material_of(const ThreeMfLook& look) {
    Material m = image_material(look.name, look.image);
    if (look.kind == ThreeMfLook::Kind::base) {
      for (int k = 0; k < 3; ++k) m.color[k] = linear_of_srgb_byte(look.rgba[static_cast<std::size_t>(k)]);
      m.diffuse = 1, m.opacity = static_cast<float>(look.rgba[3]) / 255;
    }
    if (look.kind != ThreeMfLook::Kind::colors) return m;
    Texture texture;
    texture.attribute = kColorAttribute;
    m = image_material(look.name, add(texture));
    texture.channel = ImageChannel::alpha;
    if (std::ranges::any_of(model_.objects, has_alpha)) m.opacity_texture = add(texture);
    return m;
  }

  static bool has_alpha(const ThreeMfObject& object) {
    for (std::size_t i = 3; i < object.colors.size(); i += 4)
      if (object.colors[i] != 255) return true;
    return false;
  }

  /// Shows an object in a place of `outer`.
  void place(const ThreeMfPart& part, const Affine& outer, const std::string& outer_name, int level) {
    if (++places_ > kMostThreeMfShown)
      fail("its components show more than " + std::to_string(kMostThreeMfShown) + " objects");
    if (level > kMostThreeMfLevels)
      fail("its components are nested deeper than " + std::to_string(kMostThreeMfLevels) + " levels");
    ThreeMfObject& object = model_.objects[part.object];
    const std::string& name = object.name.empty() ? outer_name : object.name;
    const Affine map = outer * part.place;
    for (const ThreeMfPart& inner : object.parts) place(inner, map, name, level + 1);
    std::uint32_t& mesh = mesh_of_[part.object];
    if (mesh == kNoId && object.indices.empty()) return;
    if (!is_usable_place(map)) {
      warn("the transform of object " + quote_name(name) + " is singular or out of range; it is skipped");
      return;
    }
    if (mesh == kNoId) mesh = add_mesh(object);
    scene_.placements.push_back({name, mesh, map});
  }

  std::uint32_t add_mesh(ThreeMfObject& object) {
    for (const Vec3f& p : object.positions)
      for (const float x : {p.x, p.y, p.z})
        if (!is_coordinate(x)) fail("object " + quote_name(object.name) + ": " + bad_coordinate(x));
    for (const std::uint32_t index : object.indices)
      if (index >= object.positions.size())
        fail("object " + quote_name(object.name) + ": vertex index " + std::to_string(index) +
             " is out of range: it has " + std::to_string(object.positions.size()) + " vertices");
    SharedMesh shared{object.name, std::make_shared<TriangleMesh>(), {}};
    TriangleMesh& mesh = *shared.mesh;
    mesh.positions = std::move(object.positions), mesh.indices = std::move(object.indices);
    set_slots(object, shared);
    set_uvs(object, mesh);
    if (!object.colors.empty()) {
      MeshAttribute& colors = mesh.attributes.emplace_back();
      colors.name = kColorAttribute, colors.domain = AttributeDomain::corner, colors.components = 4;
      colors.srgb = std::move(object.colors);
    }
    scene_.meshes.push_back(std::move(shared));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

  void set_slots(const ThreeMfObject& object, SharedMesh& shared) const {
    std::map<std::uint32_t, std::uint16_t> slot_of;
    Column<std::uint16_t> slots(object.looks.size());
    for (std::size_t i = 0; i < object.looks.size(); ++i) {
      const auto [entry, is_new] = slot_of.try_emplace(object.looks[i]);
      if (is_new) {
        if (shared.slots.size() > 0xfffe) fail("more than 65535 materials in a mesh");
        entry->second = static_cast<std::uint16_t>(shared.slots.size());
        shared.slots.push_back(object.looks[i]);
      }
      slots[i] = entry->second;
    }
    if (shared.slots.size() > 1) shared.mesh->material_slots = std::move(slots);
    if (shared.slots.empty()) shared.slots.push_back(kNoId);
  }

  void set_uvs(ThreeMfObject& object, TriangleMesh& mesh) const {
    if (object.uvs.empty()) return;
    mesh.uv_indices.resize_uninitialized(mesh.indices.size());
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const std::uint32_t look = object.looks[i / 3];
      const bool has_uv = look != kNoId && model_.looks[look].kind == ThreeMfLook::Kind::image;
      mesh.uv_indices[i] = has_uv ? static_cast<std::uint32_t>(i) : kNoId;
      const Vec2f& uv = object.uvs[i];
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
        fail("object " + quote_name(object.name) + ": a texture coordinate is not finite");
    }
    mesh.uvs = std::move(object.uvs);
  }

  const std::string& path_;
  Phase phase_{"reading", std::filesystem::path(path_).filename().string(), 0};
  const FileContent file_;
  ThreeMfModel model_;
  FileScene scene_;
  std::vector<std::uint32_t> mesh_of_;  ///< index in the scene, by that of the object
  std::uint64_t places_ = 0;
};

}  // namespace

FileScene load_threemf_scene(const std::string& path) { return ThreeMfReading(path).run(); }

#else

FileScene load_threemf_scene(const std::string& path) {
  throw Error(Location{path}, "is a 3MF file, and this program is built without lib3mf");
}

#endif

}  // namespace oktett
