#include "python/src/mesh_arrays.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/far_mesh.h"

namespace oktett::python {
namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Vec2f) == 2 * sizeof(float));
static_assert(sizeof(Vec3d) == 3 * sizeof(double));

template <class T>
void copy_to(const T* from, std::size_t count, void* to) {
  if (count > 0) std::memcpy(to, from, count * sizeof(T));
}

/// What the rows of an array belong to, and how many numbers each has.
struct Rows {
  AttributeDomain domain = AttributeDomain::vertex;
  std::uint32_t components = 1;
};

/// By its shape: (n, k) for vertices, (m, k) for faces, (m, 3, k) for the corners of faces; k may be missing
/// where it is 1 and may_lack_last. Where there are as many faces as vertices, (n, k) is that of vertices.
std::optional<Rows> rows_of(const py::array& array, const TriangleMesh& mesh, bool may_lack_last) {
  const auto vertices = static_cast<py::ssize_t>(mesh.positions.size());
  const auto faces = static_cast<py::ssize_t>(mesh.triangle_count());
  const py::ssize_t last = array.ndim() > 1 ? array.shape(array.ndim() - 1) : 1;
  if (last < 1 || last > 4) return std::nullopt;
  const auto components = static_cast<std::uint32_t>(last);
  if (array.ndim() == 3 && array.shape(0) == faces && array.shape(1) == 3)
    return Rows{AttributeDomain::corner, components};
  if (array.ndim() != 2 && !(array.ndim() == 1 && may_lack_last)) return std::nullopt;
  if (array.shape(0) == vertices) return Rows{AttributeDomain::vertex, components};
  if (array.shape(0) == faces) return Rows{AttributeDomain::face, components};
  return std::nullopt;
}

[[noreturn]] void fail_shape(const std::string& name, const std::string& expected, const py::array& array) {
  throw py::value_error(name + ": expected an array of shape " + expected + ", found the shape " +
                        shape_text(array));
}

/// Normals or texture coordinates of `last` numbers, of vertices or corners.
FloatArray vector_rows(const py::object& value, const char* name, py::ssize_t last, const TriangleMesh& mesh,
                       bool& of_corners) {
  FloatArray array = float_rows(value, name, last);
  const std::optional<Rows> rows = rows_of(array, mesh, false);
  if (!rows || rows->domain == AttributeDomain::face)
    fail_shape(name, "(n, " + std::to_string(last) + ") or (m, 3, " + std::to_string(last) + ")", array);
  of_corners = rows->domain == AttributeDomain::corner;
  return array;
}

/// The indices of what vertices or corners have.
Column<std::uint32_t> own_indices(const TriangleMesh& mesh, bool of_corners) {
  Column<std::uint32_t> indices(mesh.indices);
  if (of_corners) std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

void set_normals(const py::object& value, TriangleMesh& mesh) {
  if (value.is_none()) return;
  bool of_corners = false;
  const FloatArray array = vector_rows(value, "normals", 3, mesh, of_corners);
  mesh.normals.resize_uninitialized(static_cast<std::size_t>(array.size()) / 3);
  copy_to(array.data(), static_cast<std::size_t>(array.size()), mesh.normals.data());
  mesh.normal_indices = own_indices(mesh, of_corners);
  for (std::uint32_t& index : mesh.normal_indices)
    if (!is_normal(mesh.normals[index])) index = kNoId;
}

void set_uvs(const py::object& value, TriangleMesh& mesh) {
  if (value.is_none()) return;
  bool of_corners = false;
  const FloatArray array = vector_rows(value, "uvs", 2, mesh, of_corners);
  for (py::ssize_t i = 0; i < array.size(); ++i)
    if (!std::isfinite(array.data()[i])) throw py::value_error("uvs: expected finite numbers");
  mesh.uvs.resize_uninitialized(static_cast<std::size_t>(array.size()) / 2);
  copy_to(array.data(), static_cast<std::size_t>(array.size()), mesh.uvs.data());
  mesh.uv_indices = own_indices(mesh, of_corners);
}

py::array any_array(const py::handle& value, const std::string& name) {
  py::array array = py::array::ensure(value);
  if (array && !(py::hasattr(value, "mask") && py::hasattr(value, "filled"))) return array;
  PyErr_Clear();
  throw py::value_error(name + ": expected an array of numbers");
}

void set_floats(const py::array& array, MeshAttribute& attribute) {
  const auto floats = dense<float>(array);
  attribute.floats.resize_uninitialized(static_cast<std::size_t>(floats.size()));
  copy_to(floats.data(), static_cast<std::size_t>(floats.size()), attribute.floats.data());
}

void set_colors(const py::object& value, TriangleMesh& mesh) {
  if (value.is_none()) return;
  const py::array array = any_array(value, "colors");
  const std::optional<Rows> rows = rows_of(array, mesh, false);
  if (!rows || rows->components < 3)
    fail_shape("colors", "(n, 3), (n, 4), (m, 3), (m, 4), (m, 3, 3) or (m, 3, 4)", array);
  MeshAttribute color;
  color.name = kColorAttribute, color.domain = rows->domain, color.components = rows->components;
  const char kind = array.dtype().kind();
  if (kind == 'u' && array.itemsize() == 1) {
    const auto bytes = dense<std::uint8_t>(array);
    color.srgb.resize_uninitialized(static_cast<std::size_t>(bytes.size()));
    copy_to(bytes.data(), static_cast<std::size_t>(bytes.size()), color.srgb.data());
  } else if (kind == 'u' && array.itemsize() == 2) {
    const auto words = dense<std::uint16_t>(array);
    color.floats.resize_uninitialized(static_cast<std::size_t>(words.size()));
    for (std::size_t i = 0; i < color.floats.size(); ++i) {
      const double part = words.data()[i] / 65535.0;
      color.floats[i] = i % color.components < 3 ? linear_of_srgb(part) : static_cast<float>(part);
    }
  } else if (kind == 'f') {
    set_floats(array, color);
  } else {
    throw py::value_error("colors: expected floats, uint8 or uint16, found elements of type " +
                          std::string(py::str(array.dtype())));
  }
  mesh.attributes.push_back(std::move(color));
}

void set_attributes(const py::object& value, TriangleMesh& mesh) {
  if (value.is_none()) return;
  if (!py::isinstance<py::dict>(value)) throw py::value_error("attributes: expected a dict of arrays");
  for (const auto& [key, given] : py::cast<py::dict>(value)) {
    if (!py::isinstance<py::str>(key) || py::len(key) == 0)
      throw py::value_error("attributes: expected names, found " + std::string(py::repr(key)));
    MeshAttribute attribute;
    attribute.name = key.cast<std::string>();
    const std::string what = "attributes['" + attribute.name + "']";
    if (find_attribute(mesh, attribute.name) != nullptr)
      throw py::value_error(what + ": 'colors' gives this attribute, too");
    const py::array array = any_array(given, what);
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b')
      throw py::value_error(what + ": expected numbers, found elements of type " +
                            std::string(py::str(array.dtype())));
    const std::optional<Rows> rows = rows_of(array, mesh, true);
    if (!rows) fail_shape(what, "(n,), (n, k), (m,), (m, k) or (m, 3, k) with k from 1 to 4", array);
    attribute.domain = rows->domain, attribute.components = rows->components;
    set_floats(array, attribute);
    mesh.attributes.push_back(std::move(attribute));
  }
}

template <class T>
py::bytes bytes_of(const Column<T>& column) {
  return {reinterpret_cast<const char*>(column.data()), column.size() * sizeof(T)};
}

template <class T>
void set_bytes(const py::handle& value, Column<T>& column) {
  const auto bytes = value.cast<std::string_view>();
  column.resize_uninitialized(bytes.size() / sizeof(T));
  copy_to(bytes.data(), column.size() * sizeof(T), column.data());
}

/// Those that lie far from the origin count from a place near them.
void place_vertices(const py::array& vertices, TriangleMesh& mesh) {
  const auto count = static_cast<std::size_t>(vertices.shape(0));
  const bool are_floats = vertices.dtype().kind() == 'f' && vertices.itemsize() <= 4;
  if (!are_floats) {
    const DoubleArray positions = dense<double>(vertices);
    return set_positions({reinterpret_cast<const Vec3d*>(positions.data()), count}, mesh);
  }
  const FloatArray positions = dense<float>(vertices);
  mesh.positions.resize_uninitialized(count);
  copy_to(positions.data(), 3 * count, mesh.positions.data());
  if (const std::optional<Vec3d> centre = far_centre(mesh.positions, true)) take_off(*centre, mesh);
}

}  // namespace

std::shared_ptr<const TriangleMesh> make_mesh(const MeshArrays& arrays) {
  const py::array positions = number_rows(arrays.vertices, "vertices", 3);
  if (positions.ndim() != 2)
    throw py::value_error("vertices: expected an array of numbers of shape (n, 3), found the shape " +
                          shape_text(positions));
  const auto count = static_cast<std::size_t>(positions.shape(0));
  const auto indices = triangle_rows(arrays.faces, count);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->indices.resize_uninitialized(static_cast<std::size_t>(indices.size()));
  place_vertices(positions, *mesh);
  copy_to(indices.data(), mesh->indices.size(), mesh->indices.data());
  set_normals(arrays.normals, *mesh);
  set_uvs(arrays.uvs, *mesh);
  set_colors(arrays.colors, *mesh);
  set_attributes(arrays.attributes, *mesh);
  return mesh;
}

MeshChange make_change(const py::object& vertices, std::size_t first, const py::object& normals) {
  const py::array given = number_rows(vertices, "vertices", 3);
  if (given.ndim() != 2) fail_shape("vertices", "(n, 3)", given);
  MeshChange change;
  change.first = first;
  change.are_floats = given.dtype().kind() == 'f' && given.itemsize() <= 4;
  const DoubleArray positions = dense<double>(given);
  const auto count = static_cast<std::size_t>(given.shape(0));
  change.positions.resize(count);
  copy_to(positions.data(), 3 * count, change.positions.data());
  if (normals.is_none()) return change;
  const FloatArray rows = float_rows(normals, "normals", 3);
  if (rows.ndim() != 2 || rows.shape(0) != given.shape(0))
    fail_shape("normals", "(" + std::to_string(count) + ", 3)", rows);
  change.normals.resize(count);
  copy_to(rows.data(), 3 * count, change.normals.data());
  return change;
}

py::tuple columns_of(const TriangleMesh& mesh) {
  py::list attributes;
  for (const MeshAttribute& a : mesh.attributes)
    attributes.append(py::make_tuple(a.name, static_cast<int>(a.domain), a.components, bytes_of(a.floats),
                                     bytes_of(a.srgb)));
  return py::make_tuple(bytes_of(mesh.positions), bytes_of(mesh.indices), bytes_of(mesh.normals),
                        bytes_of(mesh.normal_indices), bytes_of(mesh.uvs), bytes_of(mesh.uv_indices),
                        attributes, py::make_tuple(mesh.origin.x, mesh.origin.y, mesh.origin.z));
}

std::shared_ptr<const TriangleMesh> mesh_of(const py::tuple& columns) {
  auto mesh = std::make_shared<TriangleMesh>();
  set_bytes(columns[0], mesh->positions), set_bytes(columns[1], mesh->indices);
  set_bytes(columns[2], mesh->normals), set_bytes(columns[3], mesh->normal_indices);
  set_bytes(columns[4], mesh->uvs), set_bytes(columns[5], mesh->uv_indices);
  for (const py::handle entry : columns[6].cast<py::list>()) {
    const auto given = entry.cast<py::tuple>();
    MeshAttribute a;
    a.name = given[0].cast<std::string>();
    a.domain = static_cast<AttributeDomain>(given[1].cast<int>());
    a.components = given[2].cast<std::uint32_t>();
    set_bytes(given[3], a.floats), set_bytes(given[4], a.srgb);
    mesh->attributes.push_back(std::move(a));
  }
  const auto origin = columns[7].cast<py::tuple>();
  for (int k = 0; k < 3; ++k) mesh->origin[k] = origin[static_cast<std::size_t>(k)].cast<double>();
  return mesh;
}

}  // namespace oktett::python
