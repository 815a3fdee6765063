#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "python/src/arrays.h"
#include "python/src/bind.h"
#include "python/src/mesh_arrays.h"
#include "python/src/unlocked.h"

namespace oktett::python {
namespace {

using StorePointer = std::shared_ptr<SceneStore>;
using FileBytes = std::map<std::string, py::bytes>;

/// Grows with what pickles hold.
constexpr int kPickleVersion = 4;

const std::pair<const char*, BuildQuality> kQualities[] = {{"fast", BuildQuality::fast},
                                                           {"balanced", BuildQuality::balanced},
                                                           {"best", BuildQuality::best},
                                                           {"compact", BuildQuality::compact}};

BuildQuality parse_quality(const std::string& name) {
  for (const auto& [known, quality] : kQualities)
    if (name == known) return quality;
  throw py::value_error("quality: expected 'fast', 'balanced', 'best' or 'compact', found '" + name + "'");
}

const char* quality_name(BuildQuality quality) { return kQualities[static_cast<int>(quality)].first; }

/// A 3x4 or 4x4 matrix; None is the identity.
Affine parse_transform(const py::object& value) {
  if (value.is_none()) return {};
  using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const py::array given = py::array::ensure(value);
  if (!given || given.ndim() != 2 || (given.shape(0) != 3 && given.shape(0) != 4) || given.shape(1) != 4) {
    PyErr_Clear();
    throw py::value_error("transform: expected a matrix of shape (3, 4) or (4, 4)" +
                          (given ? ", found the shape " + shape_text(given) : std::string()));
  }
  const auto rows = Doubles::ensure(given);
  if (!rows) throw py::error_already_set();
  const Affine map = Affine::from_rows(rows.data());
  const double* const last = rows.data() + 12;
  if (given.shape(0) == 4 && (last[0] != 0 || last[1] != 0 || last[2] != 0 || last[3] != 1))
    throw py::value_error("transform: expected the last row 0, 0, 0, 1");
  if (!map.is_invertible()) throw py::value_error("transform: the matrix has no inverse");
  return map;
}

/// The material of a dict, read as that of a scene file; nothing for None. A name is that of `added`.
void set_material(const py::object& material, AddedMesh& added) {
  if (material.is_none()) return;
  if (py::isinstance<py::str>(material)) {
    added.material_name = material.cast<std::string>();
    return;
  }
  if (!py::isinstance<py::dict>(material))
    throw py::value_error("material: expected a dict with the keys of a material, or a name");
  py::dict materials, description;
  materials["added"] = material, description["materials"] = materials;
  const auto [text, meshes] = py::module_::import("oktett._description")
                                  .attr("to_text")(description)
                                  .cast<std::pair<std::string, FileBytes>>();
  added.material_files.emplace(AddedMesh::kMaterialFile, text);
}

std::uint32_t add_mesh(SceneStore& scene, const MeshArrays& arrays, const py::object& transform,
                       const std::string& name, const py::object& material) {
  AddedMesh added;
  added.mesh = make_mesh(arrays);
  added.transform = parse_transform(transform);
  added.name = name;
  set_material(material, added);
  return scene.add(std::move(added), files);
}

StorePointer make_scene(const py::object& vertices, const py::object& faces, const py::object& transform,
                        const std::string& quality, const py::object& normals, const py::object& uvs,
                        const py::object& colors, const py::object& attributes, const py::object& material) {
  auto store = std::make_shared<SceneStore>();
  store->set_quality(parse_quality(quality));
  if (vertices.is_none() != faces.is_none())
    throw py::value_error("expected both vertices and faces, or neither");
  if (!vertices.is_none())
    add_mesh(*store, {vertices, faces, normals, uvs, colors, attributes}, transform, "", material);
  return store;
}

StorePointer load(const std::string& path, const Definitions& definitions, FileContents files,
                  BuildQuality quality) {
  StorePointer store;
  const Files& reader = oktett::python::files();
  run_watched([&] { store = SceneStore::load(reader, path, definitions, std::move(files)); });
  store->set_quality(quality);
  return store;
}

StorePointer from_file(const py::object& path, const Definitions& definitions, const std::string& quality) {
  const auto text = py::module_::import("os").attr("fspath")(path).cast<std::string>();
  return load(text, definitions, {}, parse_quality(quality));
}

StorePointer from_text(const std::string& text, const std::string& name, const FileBytes& files,
                       const Definitions& definitions, const std::string& quality) {
  FileContents contents;
  // As the reader of scene files joins them.
  const std::filesystem::path folder = std::filesystem::path(name).parent_path();
  for (const auto& [file, content] : files) contents.emplace((folder / file).string(), content);
  contents.insert_or_assign(name, text);
  return load(name, definitions, std::move(contents), parse_quality(quality));
}

StorePointer from_dict(const py::object& description, const std::string& name, const FileBytes& files,
                       const Definitions& definitions, const std::string& quality) {
  const auto [text, meshes] = py::module_::import("oktett._description")
                                  .attr("to_text")(description)
                                  .cast<std::pair<std::string, FileBytes>>();
  FileBytes all = files;
  all.insert(meshes.begin(), meshes.end());
  return from_text(text, name, all, definitions, quality);
}

/// Calls change() without the interpreter's lock: it may wait for a build.
template <class Change>
void unlocked(const Change& change) {
  const py::gil_scoped_release released;
  change();
}

std::unique_lock<std::mutex> held_without_lock(SceneStore& scene) {
  const py::gil_scoped_release released;
  return scene.hold();
}

py::array matrix_of(const Affine& transform) {
  DoubleArray matrix(ArrayShape{3, 4});
  transform.to_rows(matrix.mutable_data());
  return matrix;
}

py::tuple pickled(SceneStore& scene) {
  const std::unique_lock<std::mutex> held = held_without_lock(scene);
  py::dict files;
  for (const auto& [path, content] : scene.contents()) files[py::str(path)] = py::bytes(content);
  py::list meshes;
  for (const AddedMesh& added : scene.added()) {
    py::dict material;
    for (const auto& [path, content] : added.material_contents())
      material[py::str(path)] = py::bytes(content);
    meshes.append(py::make_tuple(columns_of(added.mesh != nullptr ? *added.mesh : TriangleMesh{}),
                                 matrix_of(added.transform), added.name, added.material_name, material));
  }
  py::list changes;
  for (const SceneStore::Change& change : scene.changes()) {
    py::object transform = py::none();
    if (change.transform) transform = matrix_of(*change.transform);
    changes.append(py::make_tuple(change.number, change.enabled, change.removed, change.mask, transform));
  }
  return py::make_tuple(kPickleVersion, scene.path(), scene.definitions(), files, meshes,
                        quality_name(scene.quality()), changes);
}

StorePointer unpickled(const py::tuple& state) {
  if (state.size() != 7 || state[0].cast<int>() != kPickleVersion)
    throw py::value_error("the pickle was made by another version of oktett");
  const auto path = state[1].cast<std::string>();
  const BuildQuality quality = parse_quality(state[5].cast<std::string>());
  StorePointer store;
  if (path.empty()) {
    store = std::make_shared<SceneStore>();
    store->set_quality(quality);
  } else {
    FileContents files;
    for (const auto& [file, content] : state[3].cast<FileBytes>()) files.emplace(file, content);
    store = load(path, state[2].cast<Definitions>(), std::move(files), quality);
  }
  for (const py::handle entry : state[4].cast<py::list>()) {
    const auto mesh = entry.cast<py::tuple>();
    AddedMesh added;
    added.mesh = mesh_of(mesh[0].cast<py::tuple>());
    added.transform = parse_transform(mesh[1]);
    added.name = mesh[2].cast<std::string>(), added.material_name = mesh[3].cast<std::string>();
    for (const auto& [file, content] : mesh[4].cast<FileBytes>()) added.material_files.emplace(file, content);
    store->add(std::move(added), files);
  }
  for (const py::handle entry : state[6].cast<py::list>()) {
    const auto change = entry.cast<py::tuple>();
    const auto number = change[0].cast<std::uint32_t>(), mask = change[3].cast<std::uint32_t>();
    if (!change[4].is_none()) store->set_transform(number, parse_transform(change[4]));
    if (mask != ~0u) store->set_mask(number, mask);
    if (!change[1].cast<bool>()) store->set_enabled(number, false);
    if (change[2].cast<bool>()) store->remove(number);
  }
  return store;
}

template <class T>
py::array rows_array(const Vec3<T>& first, const Vec3<T>& second) {
  py::array_t<T> result(ArrayShape{2, 3});
  for (int k = 0; k < 3; ++k) result.mutable_at(0, k) = first[k], result.mutable_at(1, k) = second[k];
  return result;
}

py::object scene_bounds(SceneStore& scene) {
  const std::shared_ptr<const PlacedWorld> world = world_of(scene);
  const Box box = tight_bounds(*world);
  if (!(box.lo.x <= box.hi.x)) return py::none();
  const Vec3d& origin = world->origin;
  if (origin == Vec3d{}) return rows_array(box.lo, box.hi);
  return rows_array(origin + Vec3d(box.lo), origin + Vec3d(box.hi));
}

py::array scene_origin(SceneStore& scene) {
  const std::shared_ptr<const PlacedWorld> world = world_of(scene);
  DoubleArray result(3);
  for (int k = 0; k < 3; ++k) result.mutable_at(k) = world->origin[k];
  return result;
}

std::vector<std::string> object_names(SceneStore& scene) {
  std::vector<std::string> names;
  for (const ObjectMaterials& object : world_of(scene)->objects) names.push_back(object.name);
  return names;
}

std::vector<std::string> warnings(const SceneStore& scene) {
  std::vector<std::string> lines;
  for (const Warning& warning : scene.warnings()) lines.push_back(to_string(warning));
  return lines;
}

constexpr const char* kFromTextDoc = R"(A scene of the text of a scene file.

text: the document, see the scene file format.
name: what errors call it. Files that it names are looked for in the folder of that name.
files: contents (bytes) of files that the text names, by these names; they need not exist.
definitions: values for ${name} in the text.
quality: of the acceleration structure: "fast" to build, "balanced", "best" to trace, or
"compact", in less memory.

Raises ValueError with name, line and column for what the format does not allow, OSError for a file that
cannot be read.)";

constexpr const char* kFromDictDoc = R"(A scene of a dict with the keys of scene files.

description: what a scene file says, as dicts, lists, numbers and strings; "oktett": 1 may be left out. Numpy
    arrays may stand for lists. A mesh may be {"vertices": (n, 3), "faces": (m, 3)} instead of {"file": ...},
    with "normals", "uvs", "colors" and "attributes" as add_mesh takes them, wherever a mesh may stand: in objects, prototypes and combinations.

The others, and errors, are those of from_text.)";

void bind_making(SceneClass& scene) {
  using namespace pybind11::literals;
  const Definitions no_definitions;
  const py::none none;
  scene.def(py::init(&make_scene), "vertices"_a = py::none(), "faces"_a = py::none(), py::kw_only(),
            "transform"_a = none, "quality"_a = "balanced", "normals"_a = none, "uvs"_a = none,
            "colors"_a = none, "attributes"_a = none, "material"_a = none,
            "A scene of one mesh, see add_mesh, or an empty one.");
  scene.def_static(
      "from_file", from_file, "path"_a, py::kw_only(), "definitions"_a = no_definitions,
      "quality"_a = "balanced",
      "A scene of a scene file (.yaml) or a mesh file. Arguments and errors are those of from_text.");
  scene.def_static("from_text", from_text, "text"_a, py::kw_only(), "name"_a = "<text>.yaml",
                   "files"_a = FileBytes{}, "definitions"_a = no_definitions, "quality"_a = "balanced",
                   kFromTextDoc);
  scene.def_static("from_dict", from_dict, "description"_a, py::kw_only(), "name"_a = "<dict>.yaml",
                   "files"_a = FileBytes{}, "definitions"_a = no_definitions, "quality"_a = "balanced",
                   kFromDictDoc);
  scene.def(
      "add_mesh",
      [](SceneStore& s, const py::object& vertices, const py::object& faces, const py::object& transform,
         const std::string& name, const py::object& normals, const py::object& uvs, const py::object& colors,
         const py::object& attributes, const py::object& material) {
        return add_mesh(s, {vertices, faces, normals, uvs, colors, attributes}, transform, name, material);
      },
      "vertices"_a, "faces"_a, py::kw_only(), "transform"_a = none, "name"_a = "", "normals"_a = none,
      "uvs"_a = none, "colors"_a = none, "attributes"_a = none, "material"_a = none,
      R"(Adds a triangle mesh and returns the number of the new object.

vertices: numbers of shape (n, 3), rounded to float32. From those more than 128 times their extent away from
    (0, 0, 0) a centre is taken off in float64 before, and added to the places that queries return: see origin.
faces: whole numbers of shape (m, 3), indices into vertices. Corners run counter-clockwise seen from outside.
transform: a matrix of shape (3, 4) or (4, 4) that maps columns (x, y, z, 1) to the space of the scene.
normals: shape (n, 3), of vertices, or (m, 3, 3), of the corners of faces. Zero or not finite: none.
uvs: texture coordinates, shape (n, 2) or (m, 3, 2).
colors: of vertices, faces or corners of faces, shape (n, 3), (m, 3) or (m, 3, 3), or with alpha 4 for the
    last 3. Floats are linear; uint8 and uint16 are encoded by the sRGB curve. The attribute "color".
attributes: a dict of numbers by name, shape (n,), (n, k), (m,), (m, k) or (m, 3, k), k up to 4, rounded to
    float32. Where m is n, they are those of vertices.
material: a dict with the keys of a material of scene files, or the name of one in the scene. Textures may be
    {"attribute": name}. Without one the mesh shows its colors.

The arrays are copied. Triangles of zero area, and with vertices that are not finite, are never hit. Raises
ValueError for other shapes and for indices out of range.)");
  scene.def(py::pickle(&pickled, &unpickled));
}

void bind_changes(SceneClass& scene) {
  using namespace pybind11::literals;
  scene.def(
      "set_transform",
      [](SceneStore& s, std::uint32_t object, const py::object& transform) {
        const Affine matrix = parse_transform(transform);
        unlocked([&] { s.set_transform(object, matrix); });
      },
      "object"_a, "transform"_a,
      R"(Moves an object.

object: its number, as add_mesh returned it, or its index in objects.
transform: shape (3, 4) or (4, 4), in place of the one it has; None for none.

A mesh that was added keeps its tree. Raises ValueError for objects of prototypes and operands of
combinations, which have no transform of the scene, and for objects that move by themselves.)");
  scene.def(
      "set_vertices",
      [](SceneStore& s, std::uint32_t object, const py::object& vertices, std::size_t first,
         const py::object& normals) {
        const MeshChange change = make_change(vertices, first, normals);
        unlocked([&] { s.set_vertices(object, change); });
      },
      "object"_a, "vertices"_a, "first"_a = 0, py::kw_only(), "normals"_a = py::none(),
      R"(Moves vertices of a mesh that was added.

vertices: shape (n, 3), the new places of vertex number `first` and those behind it, as in add_mesh.
normals: shape (n, 3), of the same vertices, if the mesh has normals of vertices; else they stay.

Faces and all else stay. The tree of the mesh is fitted to the new places; it is built anew by a later query
when rays would take 1.5 times as many steps as through the one that was built last.)");
  scene.def(
      "enable", [](SceneStore& s, std::uint32_t object) { unlocked([&] { s.set_enabled(object, true); }); },
      "object"_a, "Shows an object again that was disabled.");
  scene.def(
      "disable", [](SceneStore& s, std::uint32_t object) { unlocked([&] { s.set_enabled(object, false); }); },
      "object"_a, "Hides an object from rays, points and pictures.");
  scene.def(
      "remove", [](SceneStore& s, std::uint32_t object) { unlocked([&] { s.remove(object); }); }, "object"_a,
      "Removes an object for good. The numbers of the others, and its name, stay.");
  scene.def(
      "set_mask",
      [](SceneStore& s, std::uint32_t object, std::uint32_t mask) {
        unlocked([&] { s.set_mask(object, mask); });
      },
      "object"_a, "mask"_a,
      "Gives a mesh that was added 32 bits. Queries with a mask meet it if both have a bit in common; "
      "it begins with all.");
}

}  // namespace

const Files& files() {
  const py::capsule entry = py::module_::import("oktett._files").attr(kFilesEntry);
  return *entry.get_pointer<const Files>();
}

std::vector<std::shared_ptr<const PlacedWorld>> worlds_of(SceneStore& scene,
                                                          const std::vector<std::uint32_t>& masks) {
  std::vector<std::shared_ptr<const PlacedWorld>> worlds;
  run_watched([&] { worlds = scene.worlds(masks); });
  for (const auto& world : worlds) say_lost_digits(scene, world->lost_digits);
  return worlds;
}

std::shared_ptr<const PlacedWorld> world_of(SceneStore& scene, std::uint32_t mask) {
  std::shared_ptr<const PlacedWorld> world = scene.built_world(mask);
  if (world != nullptr) return world;
  run_watched([&] { world = scene.world(mask); });
  say_lost_digits(scene, world->lost_digits);
  return world;
}

void say_lost_digits(SceneStore& scene, const std::vector<Warning>& lost) {
  for (const std::string& words : scene.take_unsaid(lost))
    if (PyErr_WarnEx(PyExc_UserWarning, words.c_str(), 1) != 0) throw py::error_already_set();
}

void bind_scene(SceneClass& scene) {
  bind_making(scene);
  bind_changes(scene);
  scene.def(
      "build", [](SceneStore& s) { world_of(s); },
      "Builds the acceleration structure now rather than with the first query.");
  scene.def_property_readonly(
      "bounds", scene_bounds,
      "float32 (2, 3): the least and the greatest corner of the box around everything "
      "that is bounded; None if nothing is. float64 if the scene has an origin.");
  scene.def_property_readonly(
      "origin", scene_origin,
      "float64 (3,): the place that is taken off all that lies far from (0, 0, 0), in "
      "float64 before it is rounded to float32; zeros for other scenes.");
  scene.def_property_readonly(
      "objects", object_names,
      "The names of all objects by their numbers: through the prototypes in order, then "
      "the scene's own. Operands of combinations are objects, too; those without a name have that of the "
      "combination.");
  scene.def_property_readonly("warnings", warnings,
                              "What was skipped or given a default while files were read.");
  scene.def_property_readonly(
      "primitive_count", [](SceneStore& s) { return world_of(s)->primitives; },
      "How many triangles and other shapes there are; each counts once, however many instances show it.");
  scene.def_property_readonly("source", &SceneStore::path,
                              "The file that was read, or the name of the text.");
  scene.def("__repr__", [](SceneStore& s) {
    const std::string& path = s.path();
    return "<oktett.Scene" + (path.empty() ? std::string() : " from " + path) + ", " +
           std::to_string(s.object_count()) + " objects>";
  });
}

}  // namespace oktett::python
