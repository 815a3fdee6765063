#include "io/scene/shape.h"

#include <utility>

#include "io/scene/degenerate.h"
#include "io/scene/exact.h"
#include "io/scene/spheres.h"
#include "io/scene/utf8.h"

namespace oktett {
namespace {

using MaybeShape = std::optional<Shape>;

/// The shape, or nothing after a warning at `place` if it is degenerate.
template <class T>
MaybeShape unless_degenerate(SceneLoad& load, const YamlNode& place, T shape) {
  const std::string reason = why_degenerate(shape);
  if (reason.empty()) return Shape(std::move(shape));
  load.warn(place.where(), reason + "; the object is skipped");
  return std::nullopt;
}

MaybeShape read_mesh(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "mesh", {"file", "smooth", "test", "solid"});
  const YamlNode& file = fields.require("file");
  MeshShape shape;
  load.values.read(fields["smooth"], shape.smooth);
  if (const YamlNode* test = fields["test"])
    shape.test = load.values.choice<TriangleTest>(*test, {{"watertight", TriangleTest::watertight},
                                                          {"moller_trumbore", TriangleTest::moller_trumbore},
                                                          {"badouel", TriangleTest::badouel},
                                                          {"segura_feito", TriangleTest::segura_feito}});
  if (const YamlNode* solid = fields["solid"])
    shape.by_winding = load.values.choice<bool>(*solid, {{"closed", false}, {"winding", true}});
  const std::string path = load.values.existing_file(file);
  if (!is_mesh_file(path)) throw Error(file.where(), "unknown kind of mesh file; expected .obj");
  const MeshLibrary::Entry& entry = load.meshes.load(path, load.scene);
  shape.mesh = entry.mesh;
  shape.slot_materials = entry.slot_materials;
  if (shape.mesh->triangle_count() > 0) return shape;
  load.warn(key.where(), "the mesh has no triangles; the object is skipped");
  return std::nullopt;
}

MaybeShape read_triangle(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "triangle", {"vertices"});
  TriangleShape shape;
  if (const YamlNode* vertices = fields["vertices"]) {
    const auto corners = list_items(*vertices, "vertices");
    if (corners.size() != 3)
      throw Error(vertices->where(), "expected 3 vertices, found " + std::to_string(corners.size()));
    for (std::size_t i = 0; i < 3; ++i) shape.v[i] = load.values.vector(*corners[i]);
  }
  return unless_degenerate(load, key, shape);
}

MaybeShape read_sphere_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  return unless_degenerate(load, key, read_sphere(load.values, node));
}

MaybeShape read_spheres_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  SpheresShape shape = read_spheres(load, node);
  if (!shape.spheres.empty()) return shape;
  load.warn(key.where(), "there are no spheres; the object is skipped");
  return std::nullopt;
}

MaybeShape read_plane(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "plane", {"normal", "offset"});
  PlaneShape shape;
  load.values.read(fields["normal"], shape.normal);
  load.values.read(fields["offset"], shape.offset);
  return unless_degenerate(load, key, shape);
}

MaybeShape read_disk(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "disk", {"center", "normal", "radius"});
  DiskShape shape;
  load.values.read(fields["center"], shape.center);
  load.values.read(fields["normal"], shape.normal);
  load.values.read(fields["radius"], shape.radius, kNonNegative);
  return unless_degenerate(load, key, shape);
}

MaybeShape read_box(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "box", {"min", "max"});
  BoxShape shape;
  load.values.read(fields["min"], shape.min);
  load.values.read(fields["max"], shape.max);
  for (int axis = 0; axis < 3; ++axis) {
    if (shape.min[axis] <= shape.max[axis]) continue;
    const YamlNode& place = fields["max"] ? *fields["max"] : fields.require("min");
    throw Error(place.where(), std::string("the box has min > max along ") + "xyz"[axis]);
  }
  return unless_degenerate(load, key, shape);
}

MaybeShape read_polygon(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "polygon", {"vertices"});
  const YamlNode& vertices = fields.require("vertices");
  const auto corners = list_items(vertices, "vertices");
  if (corners.size() < 3 || corners.size() > kMaxPolygonVertices)
    throw Error(vertices.where(), "expected 3 to " + std::to_string(kMaxPolygonVertices) +
                                      " vertices, found " + std::to_string(corners.size()));
  PolygonShape shape;
  for (const YamlNode* corner : corners) shape.vertices.push_back(load.values.vector(*corner));
  remove_repeated_vertices(shape);
  return unless_degenerate(load, key, std::move(shape));
}

struct Reader {
  const char* key;
  MaybeShape (*read)(SceneLoad&, const YamlNode& key, const YamlNode& node);
};

constexpr Reader kReaders[] = {
    {"mesh", read_mesh},   {"triangle", read_triangle},     {"sphere", read_sphere_shape},
    {"plane", read_plane}, {"spheres", read_spheres_shape}, {"disk", read_disk},
    {"box", read_box},     {"polygon", read_polygon},
};

}  // namespace

const std::vector<std::string>& shape_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> names;
    for (const Reader& reader : kReaders) names.push_back(reader.key);
    for (std::string& key : exact_keys()) names.push_back(std::move(key));
    return names;
  }();
  return keys;
}

std::optional<Shape> read_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  for (const Reader& reader : kReaders)
    if (key.text == reader.key) return reader.read(load, key, node);
  bool known = false;
  const std::optional<ExactShape> exact = read_exact(load, key, node, known);
  if (exact) return Shape(*exact);
  if (known) return std::nullopt;
  throw Error(key.where(), "unknown shape " + quote(key.text));
}

}  // namespace oktett
