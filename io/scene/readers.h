#pragma once
/// \file The readers of the sections of a scene file and of what stands in them. Within io/ only.

#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/description.h"
#include "io/scene/load.h"
#include "io/scene/utf8.h"

namespace oktett {

// Each changes only what its node gives, so that a file overrides what it includes key by key.
void read_camera(SceneLoad& load, const YamlNode& node);
void read_film(SceneLoad& load, const YamlNode& node);
void read_integrator(SceneLoad& load, const YamlNode& node);

/// The keys of a motion: at least one, of ascending times and regular transforms.
std::vector<MotionKey> read_motion(SceneValues& values, const YamlNode& node);

/// Adds warnings of materials of Phong's model that may give back more light than they receive, if the scene
/// is path traced: of each one in a scene file, and once of each MTL file. Called when all else is read.
void warn_of_energy(Scene& scene);

/// Reads a scene file with all that it includes. Throws Error; where errors are gathered, keeps them in
/// `load.errors`.
void read_scene_file(const std::string& path, SceneLoad& load);
/// Reads all sections of a scene from a tree that stands in no file. Throws Error.
void read_scene_tree(const YamlNode& root);

/// Adds the lights in a list.
void read_lights(SceneLoad& load, const YamlNode& node);
/// The name of a light group; empty for the default one.
std::string read_light_group(SceneLoad& load, const YamlNode& node);
/// Adds the named media in the map `media` to the scene.
void define_media(SceneLoad& load, const YamlNode& media);
/// Sets what fills the space around the scene, by the name of a medium.
void read_outer_medium(SceneLoad& load, const YamlNode& node);
/// The keys of a material that say what is inside of its solids; those of its surface have been read.
void read_interior(SceneLoad& load, const Fields& fields, const YamlNode& node, Material& m);
/// Adds the named materials in the map `materials` to the scene.
void define_materials(SceneLoad& load, const YamlNode& materials);
/// Adds the prototypes in the map `define` to the scene. Each may hold instances of those before it.
void define_prototypes(SceneLoad& load, const YamlNode& define);
/// Adds the objects in the list `objects` to the scene.
void read_objects(SceneLoad& load, const YamlNode& objects);

/// A texture: a file, or a map with the file and how it lies on the surface, or with a pattern. `out` becomes
/// its index into Scene::textures; it stays if `node` is null.
void read_texture(SceneLoad& load, const YamlNode* node, std::uint32_t& out);
/// What every pattern has besides its own parameters.
inline constexpr const char* kPatternKeys[] = {"colors", "transform"};
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

/// The boolean combinations by their keys.
inline constexpr Choice<CsgOp> kCsgKeys[] = {
    {"union", CsgOp::unite}, {"intersection", CsgOp::intersect}, {"difference", CsgOp::subtract}};
/// Every key that says what an object is: shapes, boolean combinations, `group` and `instance`.
const std::vector<std::string>& object_keys();

/// The shape that `node`, the value of `key`, describes. Nothing, after a warning, if it is degenerate.
std::optional<Shape> read_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node);
/// A list of spheres, {centers, radius} or {file}. Spheres of radius 0 are left out with a warning; nothing,
/// after another one, if no sphere is left.
std::optional<Shape> read_spheres(SceneLoad& load, const YamlNode& key, const YamlNode& node);

/// Calls read(path) for the image file that `node` names. An Error that it throws, whose text may begin with
/// the path, is thrown again at the place of the name, since an image has no lines.
template <class Read>
auto read_image_file(SceneLoad& load, const YamlNode& node, Read&& read) {
  const std::string path = load.values.existing_file(node);
  try {
    return read(path);
  } catch (const Error& e) {
    const std::string what = e.what();
    throw Error(node.where(), quote(path, 1000) + what.substr(what.find(path) == 0 ? path.size() : 0));
  }
}

/// Throws Error at the object's place if it has no inside: if it is flat, open, or a mesh that is not closed.
/// `why` ends the message: "only solids ...".
void require_solid(const SceneLoad& load, const Object& object, const std::string& why);

// Each says why nothing of the shape or the transform can be seen, or nothing if it is usable.
/// Zero area, edges that touch each other, or a vertex further from the plane than 1e-5 of the polygon's
/// size.
std::string why_degenerate(const PolygonShape& polygon);
/// Singular, or with numbers beyond kMaxCoordinate.
std::string why_degenerate(const Affine& transform);

/// Removes each vertex that repeats the one before it, and a last one that repeats the first.
void remove_repeated_vertices(PolygonShape& polygon);

}  // namespace oktett
