#pragma once
/// \file The readers of the sections of a scene file and of what stands in them. Within io/ only.

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/description.h"
#include "io/scene/load.h"
#include "io/yaml/utf8.h"

namespace oktett {

class Schema;

// ---- Values that are read by their type, see io/scene/described.h.

/// A file that is there.
struct FilePath {
  std::string& path;
};
/// A number or a colour, or an index into Scene::textures: that of a texture that takes its place.
template <class T>
struct Textured {
  T& value;
  std::uint32_t& texture;
};
/// A texture, or a file with an image. One that `multiplies` a value must not find a texture in its place.
struct TextureMap {
  std::uint32_t& texture;
  bool multiplies = false;
};
/// The index into Scene::media by name.
struct MediumName {
  std::uint32_t& index;
};
/// The name of a light group; empty for the default one.
struct LightGroupName {
  std::string& name;
};
/// Names of objects: an index into Scene::light_lists. `lights_others`: as in LightList.
struct LightListNames {
  std::uint32_t& list;
  bool lights_others;
};
/// Names of kinds of rays, as in Object::visible_to.
struct RayKindSet {
  std::uint8_t& kinds;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range& range, FilePath& file);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, LightListNames& names);
std::string schema_of(Schema& schema, const Range& range, const LightListNames& names);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, RayKindSet& set);
std::string schema_of(Schema& schema, const Range& range, const RayKindSet& set);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Textured<float>& number);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Textured<Color>& color);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, TextureMap& map);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, MediumName& medium);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, LightGroupName& group);
/// A list of operations, applied in order, or a single one: translate, scale, rotate or matrix. The result
/// may be singular.
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Affine& transform);
/// Never null; one factor.
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, MotionPointer& motion);
// These change only what the node gives, so that a file overrides what it includes key by key.
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Camera& camera);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Camera::Focus& focus);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Camera::Angles& angles);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, CameraMeshPointer& mesh);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, IntegratorSettings& integrator);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, CausticSettings& caustics);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, CausticSettings::Radius& radius);

std::string schema_of(Schema& schema, const Range& range, const FilePath& file);
std::string schema_of(Schema& schema, const Range& range, const Textured<float>& number);
std::string schema_of(Schema& schema, const Range& range, const Textured<Color>& color);
std::string schema_of(Schema& schema, const Range& range, const TextureMap& map);
std::string schema_of(Schema& schema, const Range& range, const MediumName& medium);
std::string schema_of(Schema& schema, const Range& range, const LightGroupName& group);
std::string schema_of(Schema& schema, const Range& range, const MotionPointer& motion);
std::string schema_of(Schema& schema, const Range& range, const Camera::Focus& focus);
std::string schema_of(Schema& schema, const Range& range, const Camera::Angles& angles);
std::string schema_of(Schema& schema, const Range& range, const CameraMeshPointer& mesh);
std::string schema_of(Schema& schema, const Range& range, const CausticSettings& caustics);
std::string schema_of(Schema& schema, const Range& range, const CausticSettings::Radius& radius);

void read_value(SceneLoad& load, const YamlNode& node, const Range& range, VoxelFile& file);
std::string schema_of(Schema& schema, const Range& range, const VoxelFile& file);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, TextureIndex& texture);
void read_value(SceneLoad& load, const YamlNode& node, const Range& range, PatternColor& color);
std::string schema_of(Schema& schema, const Range& range, const TextureIndex& texture);
std::string schema_of(Schema& schema, const Range& range, const PatternColor& color);

// ---- What is read by hand, each with what it may be.

/// A map that is a texture; its index into Scene::textures.
std::uint32_t read_texture(SceneLoad& load, const YamlNode& node);
std::string texture_schema(Schema& schema);
/// The pattern of this name, if there is one.
std::optional<PatternTexture> read_pattern(SceneLoad& load, const std::string& name, const YamlNode& node);
/// What the value of each pattern may be: what(info, schema) with the ShapeInfo of its kind.
void visit_pattern_schemas(Schema& schema,
                           const std::function<void(const ShapeInfo&, const std::string&)>& what);
/// Throws Error at `place` if the patterns in a pattern are too many or too deep. Notes how many there are,
/// for the texture of this index.
void check_nesting(SceneLoad& load, std::uint32_t texture, const Location& place);

Affine read_transform(SceneLoad& load, const YamlNode& node);
/// The keys of a motion: at least one, of ascending times and regular transforms.
std::vector<MotionKey> read_motion(SceneLoad& load, const YamlNode& node);

/// Adds warnings of materials of Phong's model in a scene file that may give back more light than they
/// receive, if the scene is path traced. Called when all else is read.
void warn_of_energy(Scene& scene);

/// Adds warnings of objects whose materials by slots attenuate light inside, but have no inside.
void warn_of_insides(Scene& scene);

/// Reads a scene file with all that it includes. Throws Error; where errors are gathered, keeps them in
/// `load.errors`.
void read_scene_file(const std::string& path, SceneLoad& load);
/// A scene of the sections of a tree that was not read from a file, with the meshes that the tree names.
/// Throws Error.
Scene read_scene_tree(const YamlNode& root,
                      const std::map<std::string, std::shared_ptr<const TriangleMesh>>& meshes);
/// Adds the lights in a list.
void read_lights(SceneLoad& load, const YamlNode& node);
std::string lights_schema(Schema& schema);
/// Greatest absorption, scattering and emission of a medium per unit length, after `density`.
inline constexpr float kMostCoefficient = 1e9f;
/// Adds the named media in the map `media` to the scene.
void define_media(SceneLoad& load, const YamlNode& media);
std::string media_schema(Schema& schema);
/// Adds the fogs in the list `fog` to the scene.
void read_fogs(SceneLoad& load, const YamlNode& fog);
std::string fogs_schema(Schema& schema);
/// Adds the rainbows in the list `rainbow` to the scene.
void read_rainbows(SceneLoad& load, const YamlNode& rainbow);
std::string rainbows_schema(Schema& schema);
/// Adds a warning if the scene is path traced and has fog, which it does not show then.
void warn_of_fog(Scene& scene);
/// Sets what fills the space around the scene, by the name of a medium.
void read_outer_medium(SceneLoad& load, const YamlNode& node);
std::string medium_schema(Schema& schema);
/// Adds the named materials in the map `materials` to the scene.
void define_materials(SceneLoad& load, const YamlNode& materials);
std::string materials_schema(Schema& schema);
/// Adds the prototypes in the map `define` to the scene. Each may hold instances of those before it.
void define_prototypes(SceneLoad& load, const YamlNode& define);
std::string prototypes_schema(Schema& schema);
/// Adds the objects in the list `objects` to the scene.
void read_objects(SceneLoad& load, const YamlNode& objects);
std::string objects_schema(Schema& schema);

/// Calls what(pattern) for one pattern of each kind, with its defaults.
template <class What, class... P>
void visit_patterns_of(const What& what, std::type_identity<std::variant<P...>>) {
  (what(P{}), ...);
}
template <class What>
void visit_patterns(const What& what) {
  visit_patterns_of(what, std::type_identity<Pattern>{});
}

/// Index into Scene::materials for a name, or for an inline map, which is appended.
std::uint32_t read_material(SceneLoad& load, const YamlNode& node);
std::string material_schema(Schema& schema);

/// The boolean combinations by their keys, and what may be their operand besides.
inline constexpr Choice<CsgOp> kCsgKeys[] = {{"union", CsgOp::unite},
                                             {"intersection", CsgOp::intersect},
                                             {"difference", CsgOp::subtract},
                                             {"surfaces", CsgOp::surfaces}};
/// Every shape that describes its parameters, by its key.
const std::vector<std::string>& shape_keys();

/// The shape that `node`, the value of `key`, describes. Nothing, after a warning, if it is degenerate.
std::optional<Shape> read_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node);
/// A list of spheres, {centers, radius} or {file}. Spheres of radius 0 are left out with a warning; nothing,
/// after another one, if no sphere is left.
std::optional<Shape> read_spheres(SceneLoad& load, const YamlNode& key, const YamlNode& node);
std::string spheres_schema(Schema& schema);

// The elements of metaballs, and the lists of blob trees.
std::string elements_schema(Schema& schema);
std::string blends_schema(Schema& schema);

/// Calls read(path) for the file that `node` names, such as an image or a font. An Error that it throws,
/// whose text may begin with the path, is thrown again at the place of the name, since such a file has no
/// lines.
template <class Read>
auto read_named_file(SceneLoad& load, const YamlNode& node, Read&& read) {
  const std::string path = load.values.existing_file(node);
  try {
    return read(path);
  } catch (const Error& e) {
    const std::string what = e.what();
    const bool has_path = what.starts_with(path);
    throw Error(node.where(), quote(path, 1000) + (has_path ? what.substr(path.size()) : ": " + what));
  }
}

/// Throws Error at the object's place if it has no inside: if it is flat, open, or a mesh that is not closed.
/// `why` ends the message: "only solids ...".
void require_solid(const SceneLoad& load, const Object& object, const std::string& why);

/// Finds the objects that lists of lights name, after all objects have been read. Throws Error at names that
/// no object has.
void resolve_light_lists(SceneLoad& load);

// Each says why nothing of the shape or the transform can be seen, or nothing if it is usable.
/// Zero area, edges that touch each other, or a vertex further from the plane than 1e-5 of the polygon's
/// size.
std::string why_degenerate(const PolygonShape& polygon);
/// Singular, or with numbers beyond kMaxCoordinate.
std::string why_degenerate(const Affine& transform);

/// Removes each vertex that repeats the one before it, and a last one that repeats the first.
void remove_repeated_vertices(PolygonShape& polygon);

}  // namespace oktett
