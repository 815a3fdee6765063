#include "io/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh_geometry.h"
#include "io/gltf/gltf.h"
#include "io/mesh/load/load_file_scene.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/reading.h"
#include "io/ply/ply.h"
#include "io/pov/translate/translate.h"
#include "io/scene/meshes.h"
#include "io/scene/pov_scene.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/text/files.h"
#include "io/yaml/scene_limits.h"
#include "io/yaml/utf8.h"
#include "io/yaml/yaml.h"
#include "render/look/default_look.h"
#include "render/look/up_direction.h"
#include "render/recentre.h"
#include "render/scene.h"

namespace oktett {

// ---- Whole scenes from files that place meshes.

namespace {

/// Adds the parts of a file to a scene.
class Adding {
 public:
  Adding(const std::string& path, double stroke_width, FileScene& file, Scene& scene)
      : path_(path),
        file_(file),
        scene_(scene),
        stroke_width_(stroke_width > 0 ? stroke_width : usual_stroke_width(file, path)) {
    MeshFile common;
    common.materials = std::move(file.materials), common.textures = std::move(file.textures);
    common.media = std::move(file.media);
    common.texture_places = std::move(file.texture_places), common.warnings = std::move(file.warnings);
    check_textures(common);
    materials_ = append_materials(common, scene);
    std::ranges::move(common.warnings, std::back_inserter(scene.warnings));
  }

  void add_objects() {
    std::vector<std::uint32_t> uses(file_.meshes.size()), prototypes(file_.meshes.size(), kNoId);
    for (const PlacedMesh& placement : file_.placements) ++uses[placement.mesh];
    for (std::uint32_t i = 0; i < uses.size(); ++i) {
      if (uses[i] < 2) continue;
      if (file_.meshes[i].bending != nullptr)
        scene_.warnings.push_back({Location{path_}, "mesh " + quote_name(file_.meshes[i].name) +
                                                        ": instances are not blurred as they are bent"});
      prototypes[i] = static_cast<std::uint32_t>(scene_.prototypes.size());
      scene_.prototypes.push_back({file_.meshes[i].name, {object(file_.meshes[i].name, shape(i))}});
    }
    // Instances that follow each other may become one list.
    for (const PlacedMesh& placement : file_.placements)
      if (uses[placement.mesh] < 2) add(placement, shape(placement.mesh));
    for (const PlacedMesh& placement : file_.placements)
      if (uses[placement.mesh] > 1) add(placement, InstanceShape{prototypes[placement.mesh]});
  }

  void add_view_and_lights() {
    if (file_.camera) scene_.camera = *file_.camera, scene_.camera_given = true;
    if (file_.lights.empty()) return;
    std::ranges::move(file_.lights, std::back_inserter(scene_.lights));
    scene_.lights_given = true;
  }

 private:
  MeshShape shape(std::uint32_t mesh) {
    MeshShape shape;
    shape.mesh = file_.meshes[mesh].mesh;
    if (file_.meshes[mesh].is_strokes) shape.stroke_width = stroke_width_;
    shape.bending = file_.meshes[mesh].bending;
    const bool colored = find_attribute(*shape.mesh, kColorAttribute) != nullptr;
    for (const std::uint32_t slot : file_.meshes[mesh].slots)
      shape.slot_materials.push_back(slot < materials_.size() ? materials_[slot]
                                     : colored                ? colors()
                                                              : kNoId);
    return shape;
  }

  /// The material of what has colours but no material.
  std::uint32_t colors() {
    if (colors_ == kNoId) colors_ = add_color_material(scene_);
    return colors_;
  }

  Object object(const std::string& name, Shape shape) const {
    Object object;
    object.shape = std::move(shape), object.name = name, object.where = Location{path_};
    return object;
  }

  void add(const PlacedMesh& placement, Shape shape) {
    scene_.objects.push_back(object(placement.name, std::move(shape)));
    scene_.objects.back().transform = placement.to_world;
    scene_.objects.back().motion = placement.motion;
  }

  const std::string& path_;
  FileScene& file_;
  Scene& scene_;
  const double stroke_width_;
  std::vector<std::uint32_t> materials_;
  std::uint32_t colors_ = kNoId;
};

}  // namespace

/// Adds the objects of `file`, which was read from `path`, with their materials and lights to `scene`. Its
/// camera replaces that of the scene. A mesh in several places becomes a prototype.
static void add_file_scene(const std::string& path, const GltfOptions& options, FileScene file,
                           Scene& scene) {
  Adding adding(path, options.stroke_width, file, scene);
  adding.add_objects();
  adding.add_view_and_lights();
}

namespace {

constexpr std::size_t kMaxIncludeDepth = 16;
constexpr std::size_t kMaxIncludedFiles = 256;
/// Behind things that stand in no scene.
constexpr Color kPlainBackground{0.30f, 0.34f, 0.40f};
/// Per pixel, of a file with a camera, lights or many instances of its own.
constexpr std::uint32_t kSceneSamples = 64;

/// A section with a reader of its own, and what it may be. One that `defines` names may be what is missing
/// later.
struct Section {
  std::function<void(SceneLoad&, const YamlNode&)> read;
  std::function<std::string(Schema&)> schema;
  bool defines = false;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Section& section) {
  if (!attempt(node, [&] { section.read(load, node); }) && section.defines) load.miss_definitions();
}
std::string schema_of(Schema& schema, const Range&, const Section& section) { return section.schema(schema); }

/// The top level of a scene file, in the order in which it is read.
struct SceneKeys {
  Scene& scene;
  Section include{};

  static constexpr const char* kMap = "a scene";
  void describe(auto& p) {
    p.required("oktett", Section{read_version, version_schema}, "version of the format");
    p.optional("params", Section{read_parameters, parameters_schema, true}, "values of ${name}");
    p.optional("include", include, "files to merge, as if their sections stood before those of the file");
    p.optional("camera", scene.camera, "of the whole scene if left out");
    p.optional("film", scene.film, "size and form of the picture");
    p.optional("integrator", scene.integrator, "how light is computed");
    p.optional("background", Textured<Color>{scene.background, scene.background_texture},
               "colour where rays meet nothing, or a pattern on the sphere of directions");
    p.optional("ambient_light", scene.ambient_light, "colour that `ambient` of materials multiplies");
    p.optional("media", Section{define_media, media_schema, true}, "media by name");
    p.optional("medium", Section{read_outer_medium, medium_schema},
               "name of the medium outside of all solids");
    p.optional("fog", Section{read_fogs, fogs_schema}, "`whitted`: fog outside of solids");
    p.optional("rainbow", Section{read_rainbows, rainbows_schema}, "`whitted`: rainbows outside of solids");
    p.optional("materials", Section{define_materials, materials_schema, true}, "materials by name");
    p.optional("lights", Section{read_lights, lights_schema}, "two by the camera if left out");
    p.optional("define", Section{define_prototypes, prototypes_schema, true}, "prototypes by name");
    p.optional("objects", Section{read_objects, objects_schema}, "what there is to be seen");
  }

 private:
  static void read_version(SceneLoad& load, const YamlNode& node) {
    if (!node.missing && (node.kind != YamlKind::scalar || load.values.text(node) != "1"))
      throw Error(node.where(), "expected format version 1, found " + node.describe());
  }
  static std::string version_schema(Schema&) { return Schema::number(whole(1, 1), "integer"); }
  static void read_parameters(SceneLoad& load, const YamlNode& node) { load.parameters.add_defaults(node); }
  static std::string parameters_schema(Schema&) { return Schema::entries(Schema::text()); }
};

/// Reads a scene file and, before its own sections, those that it includes.
class FileReader {
 public:
  explicit FileReader(SceneLoad& load) : load_(load) {}

  void read(const std::string& path) {
    chain_.push_back({path, canonical_path(path)});
    seen_.push_back(chain_.back().canonical);
    const bool pov = is_pov_file(path);
    if (!attempt(load_.errors, [&] { pov ? read_pov(path) : read_file(path); })) load_.miss_definitions();
    chain_.pop_back();
  }

  void read_sections(const YamlNode& root) {
    if (root.kind != YamlKind::map)
      throw Error(root.where(), "expected a map that begins with 'oktett: 1', found " + root.describe());
    SceneKeys keys{load_.scene,
                   {[this](SceneLoad&, const YamlNode& node) { read_includes(node); }, {}, true}};
    const Fields fields(root, keys.kMap, KeyList(keys).keys);
    if (!fields["oktett"]) report(root, "the format version is missing: expected 'oktett: 1'");
    ParameterReader reader(load_, root, fields);
    keys.describe(reader);
  }

 private:
  struct Link {
    std::string path, canonical;
  };

  void read_file(const std::string& path) {
    YamlFile file;
    file.path = path;
    file.errors = load_.errors;
    file.text = read_text_file(path, kMaxSceneBytes);
    bytes_ += file.text.size();
    if (bytes_ > kMaxSceneBytes)
      throw Error(Location{path, 0, 0}, "the scene and the files that it includes are larger than " +
                                            std::to_string(kMaxSceneBytes >> 20) + " MiB in all");
    parse_yaml(file, kMaxSceneNodes - nodes_);
    nodes_ += file.expanded_nodes;
    read_sections(*file.root);
  }

  /// A scene in POV-Ray's language.
  void read_pov(const std::string& path) {
    pov::TranslatedScene translated = read_pov_tree(path, load_.definitions, load_.pov);
    for (const std::unique_ptr<YamlFile>& file : translated.files) file->errors = load_.errors;
    for (const auto& [name, mesh] : translated.meshes) load_.meshes.add(name, mesh);
    for (const Warning& warning : translated.warnings) load_.warn(warning.where, warning.message);
    read_sections(*translated.root);
  }

  void read_includes(const YamlNode& node) {
    for (const YamlNode* item : list_items(node, "include"))
      if (!attempt(*item, [&] { read_include(*item); })) load_.miss_definitions();
  }

  void read_include(const YamlNode& item) {
    const std::string path = load_.values.existing_file(item);
    const std::string canonical = canonical_path(path);
    check_cycle(item, path, canonical);
    if (std::find(seen_.begin(), seen_.end(), canonical) != seen_.end()) return;
    if (has_file_scene(path)) {
      seen_.push_back(canonical);
      GltfOptions options;
      if (is_gltf_file(path)) options = load_.gltf;
      options.stroke_width = load_.gltf.stroke_width;
      add_file_scene(path, options, load_file_scene(path, options), load_.scene);
      load_.prototype_levels.resize(load_.scene.prototypes.size());
      load_.prototype_hides.resize(load_.scene.prototypes.size());
      return;
    }
    if (chain_.size() > kMaxIncludeDepth)
      throw Error(item.where(),
                  "included files are nested deeper than " + std::to_string(kMaxIncludeDepth) + " levels");
    if (seen_.size() > kMaxIncludedFiles)
      throw Error(item.where(), "more than " + std::to_string(kMaxIncludedFiles) + " files are included");
    read(path);
  }

  void check_cycle(const YamlNode& place, const std::string& path, const std::string& canonical) {
    const auto is_same = [&](const Link& link) { return link.canonical == canonical; };
    const auto begin = std::find_if(chain_.begin(), chain_.end(), is_same);
    if (begin == chain_.end()) return;
    std::string message = "include cycle: ";
    for (auto link = begin; link != chain_.end(); ++link) message += link->path + " -> ";
    throw Error(place.where(), message + path);
  }

  SceneLoad& load_;
  std::vector<Link> chain_;            ///< the files being read, outermost first
  std::vector<std::string> seen_;      ///< canonical paths; a file that is included twice is merged once
  std::size_t nodes_ = 0, bytes_ = 0;  ///< of the files so far
};

void expect_readable(const std::string& path) {
  if (const std::string reason = why_unreadable(path); !reason.empty())
    throw Error(Location{path, 0, 0}, reason, ErrorKind::io);
}

/// A scene far from the origin counts from another place.
void move_near(Scene& scene) {
  recentre(scene);
  std::ranges::move(find_lost_digits(scene), std::back_inserter(scene.warnings));
}

/// A scene of its own: path tracing, which its materials are made for.
Scene scene_from_file(const std::string& path, const GltfOptions& options, FileScene file, const Vec3d& up) {
  Scene scene;
  scene.source = path;
  scene.camera.up = up;
  scene.background = kPlainBackground;
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = kSceneSamples;
  scene.film.tone.kind = ToneKind::neutral;
  if (!file.lights.empty()) scene.background = {0, 0, 0};
  if (file.aspect > 0)
    scene.film.width =
        static_cast<std::uint32_t>(std::clamp(std::round(scene.film.height * file.aspect), 1.0, 4096.0));
  add_file_scene(path, options, std::move(file), scene);
  move_near(scene);
  warn_of_insides(scene);
  return scene;
}

}  // namespace

std::string scene_schema() {
  Scene usual;
  Schema schema;
  const Section include{{}, [](Schema&) { return Schema::list(Schema::file()); }};
  return schema.text(schema.map(SceneKeys::kMap, SceneKeys{usual, include}));
}

void read_scene_file(const std::string& path, SceneLoad& load) {
  load.scene.source = path;
  FileReader(load).read(path);
  resolve_light_lists(load);
  if (load.errors != nullptr && load.errors->failures() > 0) return;
  if (load.integrator) load.scene.integrator.kind = *load.integrator;
  move_near(load.scene);
  warn_of_energy(load.scene);
  warn_of_fog(load.scene);
  warn_of_attributes(load.scene);
  warn_of_insides(load.scene);
  if (is_pov_file(path)) return;
  for (const Warning& warning : load.parameters.unused()) load.scene.warnings.push_back(warning);
}

Scene read_scene_tree(const YamlNode& root,
                      const std::map<std::string, std::shared_ptr<const TriangleMesh>>& meshes) {
  SceneLoad load{Definitions{}};
  for (const auto& [name, mesh] : meshes) load.meshes.add(name, mesh);
  FileReader(load).read_sections(root);
  resolve_light_lists(load);
  recentre(load.scene);
  return std::move(load.scene);
}

static Scene load_scene_file(const std::string& path, const Definitions& definitions,
                             std::optional<IntegratorKind> integrator, const GltfOptions& gltf,
                             const PovOptions& pov = {}) {
  SceneLoad load(definitions);
  load.pov = pov;
  load.gltf = gltf;
  load.integrator = integrator;
  read_scene_file(path, load);
  return std::move(load.scene);
}

Scene load_scene_file(const std::string& path, const Definitions& definitions) {
  return load_scene_file(path, definitions, std::nullopt, {});
}

/// Whether a ray could hit one of the triangles.
static bool has_area(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
    if (length(area_normal(mesh, i)) > 0) return true;
  return false;
}

/// What points up in the files of a format. In glTF +y does, in 3MF and STL, the formats of printers, +z, and
/// in PLY by Blender its own +z, unlike in its OBJ.
static std::optional<Vec3d> up_of_format(const std::string& path) {
  if (is_gltf_file(path)) return Vec3d{0, 1, 0};
  const std::string extension = lower_case_extension(without_packing(path));
  if (extension == ".stl" || extension == ".3mf" || (extension == ".ply" && is_ply_of_blender(path)))
    return Vec3d{0, 0, 1};
  return std::nullopt;
}

/// What points up in a mesh that is given alone.
static Vec3d up_of(const std::string& path, const TriangleMesh& mesh) {
  const std::optional<Vec3d> up = up_of_format(path);
  return up ? *up : guess_up(mesh);
}

Scene scene_from_mesh(const std::string& path, const GltfOptions& gltf) {
  expect_readable(path);
  check_gltf_options(path, gltf);
  Scene scene;
  scene.source = path;
  MeshLibrary meshes;
  MeshLibrary::Entry entry;
  if (has_file_scene(path)) {
    FileScene file = load_file_scene(path, gltf);
    const bool moves = std::ranges::any_of(file.placements, [&](const PlacedMesh& p) {
      return p.motion != nullptr || file.meshes[p.mesh].bending != nullptr;
    });
    if (moves || file.camera || !file.lights.empty() || !can_be_one_mesh(file))
      return scene_from_file(path, gltf, std::move(file), *up_of_format(path));
    entry = MeshLibrary::add(one_mesh(path, std::move(file)), scene);
  } else {
    entry = meshes.load(path, {.weld = repeats_vertices(path)}, scene);
  }
  const bool has_triangles = entry.mesh->triangle_count() > 0;
  if (!has_triangles && entry.strokes.empty()) {
    scene.warnings.push_back(Warning{Location{path, 0, 0}, "the mesh has no triangles"});
    return scene;
  }
  if (entry.strokes.empty() && !has_area(*entry.mesh))
    scene.warnings.push_back(
        Warning{Location{path, 0, 0}, "no triangle of the mesh has an area: there is nothing to be seen"});
  scene.camera.up = up_of(path, *entry.mesh);
  scene.background = kPlainBackground;
  std::vector<MeshShape> strokes = entry.stroke_shapes(gltf.stroke_width, Location{path}, scene.warnings);
  scene.origin = has_triangles ? entry.mesh->origin : strokes[0].mesh->origin;
  const auto add = [&](MeshShape shape) {
    Object object;
    object.shape = std::move(shape);
    place_mesh(object);
    object.transform = Affine::translation(scene.origin * -1.0) * object.transform;
    object.name = std::filesystem::path(without_packing(path)).stem().string();
    object.where = {path, 0, 0};
    show_colors(scene, object);
    scene.objects.push_back(std::move(object));
  };
  // glTF 2.0, 3.7.2.1: without normals triangles are flat.
  const bool smooth = !is_gltf_file(path) || !entry.mesh->normals.empty();
  if (has_triangles) add({entry.mesh, entry.slot_materials, smooth});
  for (MeshShape& each : strokes) add(std::move(each));
  warn_of_insides(scene);
  return scene;
}

Scene load_scene(const std::string& path, const Definitions& definitions) {
  return load_scene(path, definitions, std::nullopt);
}

Scene load_scene(const std::string& path, const Definitions& definitions,
                 std::optional<IntegratorKind> integrator, const GltfOptions& gltf, const PovOptions& pov) {
  expect_readable(path);
  const std::string extension = lower_case_extension(path);
  if (extension == ".yaml" || extension == ".yml" || is_pov_file(path))
    return load_scene_file(path, definitions, integrator, gltf, pov);
  if (!is_mesh_file(path))
    throw Error(Location{path, 0, 0},
                std::string("unknown kind of file; expected a scene (.yaml, .yml, .pov) or a mesh (") +
                    mesh_extensions() + ")");
  Scene scene = scene_from_mesh(path, gltf);
  if (integrator) scene.integrator.kind = *integrator;
  for (const Warning& warning : SceneParameters(definitions).unused()) scene.warnings.push_back(warning);
  return scene;
}

}  // namespace oktett
