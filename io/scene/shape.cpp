#include <type_traits>
#include <utility>
#include <variant>

#include "io/mesh/load/load_mesh.h"
#include "io/scene/exact.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"

namespace oktett {
namespace {

using MaybeShape = std::optional<Shape>;

/// Where errors are gathered, keeps all that is wrong in the file.
const MeshLibrary::Entry& load_file(SceneLoad& load, const std::string& path, const MeshOptions& options) {
  try {
    return load.meshes.load(path, options, load.scene);
  } catch (const Error&) {
    if (load.errors != nullptr)
      for (const Error& error : find_mesh_errors(path)) load.errors->add(error);
    throw;
  }
}

/// Loads the file of a mesh. Returns whether there is anything in it; its strokes are added by who reads the
/// object.
bool finish(const ShapeNode& at, MeshShape& shape) {
  const YamlNode& file = at.fields.require("file");
  if (const MeshLibrary::Entry* const given = at.load.meshes.find(at.load.values.text(file))) {
    shape.mesh = given->mesh;
    return true;
  }
  const std::string path = at.load.values.existing_file(file);
  if (!is_mesh_file(path))
    throw Error(file.where(), std::string("unknown kind of mesh file; expected ") + mesh_extensions());
  const MeshLibrary::Entry& entry = load_file(at.load, path, {.weld = shape.weld});
  shape.mesh = entry.mesh;
  shape.slot_materials = entry.slot_materials;
  const bool is_empty = shape.mesh->triangle_count() == 0 && entry.strokes.empty();
  if (is_empty) at.skip("the mesh has no triangles");
  at.load.warn_if_unused(at.fields, "stroke_width", entry.strokes.empty(),
                         "the file has no points and lines");
  return !is_empty;
}

/// Returns whether a polygon can be shown.
bool finish(const ShapeNode& at, PolygonShape& shape) {
  remove_repeated_vertices(shape);
  const std::string reason = why_degenerate(shape);
  if (!reason.empty()) at.skip(reason);
  return reason.empty();
}

template <class T, class... U>
constexpr bool is_one_of(std::type_identity<std::variant<U...>>) {
  return (std::is_same_v<T, U> || ...);
}

/// Reads the shape whose key is that of `at`.
class ShapeReader {
 public:
  ShapeReader(SceneLoad& load, const YamlNode& key, const YamlNode& node)
      : load_(load), key_(key), node_(node) {}

  template <class T>
  void surface(const ShapeInfo& surface, T shape) {
    if (known || key_.text != surface.key) return;
    known = true;
    const KeyList list(shape);
    const Fields fields(node_, surface.key, list.keys);
    ParameterReader reader(load_, node_, fields);
    shape.describe(reader);
    const ShapeNode at{load_, key_, node_, fields};
    // What follows relies on what the parameters promise.
    if (reader.is_wrong()) return;
    if (reader.why_nothing) {
      at.skip(reader.why_nothing);
    } else if constexpr (is_one_of<T>(std::type_identity<Shape::variant>{})) {
      if constexpr (requires { finish(at, shape); })
        if (!finish(at, shape)) return;
      if (load_.is_clean()) result = std::move(shape);
    } else if (std::optional<ExactForm> form = form_of(at, shape); form && load_.is_clean()) {
      result = ExactShape{std::move(*form), reader.normal_method};
    }
  }

  bool known = false;
  MaybeShape result;

 private:
  template <class T>
  static std::optional<ExactForm> form_of(const ShapeNode& at, T& shape) {
    if constexpr (requires { finish(at, shape); })
      return finish(at, shape);
    else
      return ExactForm(std::move(shape));
  }

  SceneLoad& load_;
  const YamlNode &key_, &node_;
};

struct SurfaceNames {
  void surface(const ShapeInfo& surface, const auto&) { names.push_back(surface.key); }
  std::vector<std::string> names;
};

}  // namespace

const std::vector<std::string>& shape_keys() {
  static const std::vector<std::string> keys = [] {
    SurfaceNames all;
    visit_surfaces(all);
    return all.names;
  }();
  return keys;
}

MaybeShape read_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  if (key.text == "spheres") return read_spheres(load, key, node);
  ShapeReader reader(load, key, node);
  visit_surfaces(reader);
  if (reader.known) return std::move(reader.result);
  throw Error(key.where(), "unknown shape " + quote(key.text));
}

}  // namespace oktett
