#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "python/src/arrays.h"
#include "python/src/bind.h"
#include "python/src/ray_queries.h"
#include "python/src/unlocked.h"

namespace oktett::python {
namespace {

using Fields = std::vector<std::string>;

/// The arguments of a query: arrays that are kept alive, and where they lie.
struct RayArguments {
  FloatArray rays, tmin, tmax;
  Shape shape;
  RayRows rows;

  RayArguments(py::handle given, py::handle given_tmin, py::handle given_tmax)
      : rays(float_rows(given, "rays", 6)), shape(row_shape(rays)) {
    tmin = float_each(given_tmin, "tmin", shape);
    tmax = float_each(given_tmax, "tmax", shape);
    rows = {rays.data(),
            tmin.data(),
            tmax.data(),
            tmin.ndim() == 0 ? 0u : 1u,
            tmax.ndim() == 0 ? 0u : 1u,
            static_cast<std::size_t>(rays.size() / 6)};
    for (py::ssize_t i = 0; i < tmin.size(); ++i)
      if (tmin.data()[i] < 0)
        throw py::value_error("tmin: expected no negative numbers, found " + std::to_string(tmin.data()[i]));
  }
};

const char* const kFields[] = {"t", "object", "primitive", "instance", "uv", "normal", "position"};

/// Finds the column of a field by its name.
template <class Visit>
void visit_fields(HitColumns& columns, const Visit& visit) {
  visit("t", columns.t, 0);
  visit("object", columns.object, 0);
  visit("primitive", columns.primitive, 0);
  visit("instance", columns.instance, 0);
  visit("uv", columns.uv, 2);
  visit("normal", columns.normal, 3);
  visit("position", columns.position, 3);
}

bool contains(const Fields& fields, const std::string& name) {
  return std::find(fields.begin(), fields.end(), name) != fields.end();
}

void check_fields(const Fields& fields) {
  for (const std::string& field : fields)
    if (std::find(std::begin(kFields), std::end(kFields), field) == std::end(kFields))
      throw py::value_error("fields: there is no field '" + field +
                            "'; expected t, object, primitive, instance, uv, normal, position");
}

/// A field that is a vector adds its components as the last dimension.
Shape field_shape(const Shape& shape, py::ssize_t components) {
  return components == 0 ? shape : with_last(shape, components);
}

py::object ask_closest_hit(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax,
                           const Fields& fields) {
  check_fields(fields);
  const RayArguments arguments(rays, tmin, tmax);
  HitColumns columns;
  py::dict result;
  visit_fields(columns, [&](const char* name, auto*& column, py::ssize_t components) {
    using Value = std::remove_reference_t<decltype(*column)>;
    result[name] = py::none();
    if (!contains(fields, name)) return;
    py::array_t<Value> array(field_shape(arguments.shape, components));
    column = array.mutable_data();
    result[name] = array;
  });
  const std::shared_ptr<const World> world = world_of(scene);
  run_in_parts(arguments.rows.size, [&](std::size_t begin, std::size_t end) {
    closest_hits(*world, arguments.rows, begin, end, columns);
  });
  return py::module_::import("oktett._results").attr("Hits")(**result);
}

py::array ask_any_hit(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax) {
  const RayArguments arguments(rays, tmin, tmax);
  py::array_t<bool> result(arguments.shape);
  auto* const out = reinterpret_cast<std::uint8_t*>(result.mutable_data());
  const std::shared_ptr<const World> world = world_of(scene);
  run_in_parts(arguments.rows.size, [&](std::size_t begin, std::size_t end) {
    any_hits(*world, arguments.rows, begin, end, out);
  });
  return result;
}

py::array ask_count_hits(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax) {
  const RayArguments arguments(rays, tmin, tmax);
  py::array_t<std::uint32_t> result(arguments.shape);
  const std::shared_ptr<const World> world = world_of(scene);
  run_in_parts(arguments.rows.size, [&, out = result.mutable_data()](std::size_t begin, std::size_t end) {
    count_hits(*world, arguments.rows, begin, end, out);
  });
  return result;
}

/// An array that owns `values`.
template <class T>
py::array own(std::vector<T>&& values, py::ssize_t components) {
  auto* const kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  const auto size = static_cast<py::ssize_t>(kept->size());
  const Shape shape = components == 0 ? Shape{size} : Shape{size / components, components};
  return py::array_t<T>(shape, kept->data(), owner);
}

py::object ask_all_hits(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax,
                        const Fields& fields) {
  check_fields(fields);
  const RayArguments arguments(rays, tmin, tmax);
  // Only whether a column is null counts.
  HitColumns wanted;
  static float some_float;
  static std::uint32_t some_id;
  visit_fields(wanted, [&](const char* name, auto*& column, py::ssize_t) {
    if (!contains(fields, name)) return;
    if constexpr (std::is_same_v<decltype(column), float*&>)
      column = &some_float;
    else
      column = &some_id;
  });
  FoundHits found;
  const std::shared_ptr<const World> world = world_of(scene);
  run_in_parts(arguments.rows.size, [&](std::size_t begin, std::size_t end) {
    all_hits(*world, arguments.rows, begin, end, wanted, found);
  });
  py::dict result;
  const auto add = [&](const char* name, auto&& values, const void* column, py::ssize_t components) {
    if (column == nullptr)
      result[name] = py::none();
    else
      result[name] = own(std::move(values), components);
  };
  add("t", found.t, wanted.t, 0);
  add("object", found.object, wanted.object, 0);
  add("primitive", found.primitive, wanted.primitive, 0);
  add("instance", found.instance, wanted.instance, 0);
  add("uv", found.uv, wanted.uv, 2);
  add("normal", found.normal, wanted.normal, 3);
  add("position", found.position, wanted.position, 3);
  add("splits", found.splits, &found, 0);
  return py::module_::import("oktett._results").attr("HitLists")(**result);
}

constexpr const char* kClosestHitDoc = R"(The nearest hit of each ray.

rays: shape (..., 6), origin and direction of each ray in a row. A hit is at origin + t * direction with
    tmin < t <= tmax; t counts in lengths of the direction, which need not be 1. C-contiguous float32 is read
    in place, anything else is copied.
tmin, tmax: a number for all rays, or one for each, shape (...). tmin >= 0.
fields: what is wanted. The others are None in the result.

Returns Hits:
    t          float32 (...)     distance; inf for a miss
    object     uint32  (...)     number of the object, an index into Scene.objects; 0xffffffff for a miss
    primitive  uint32  (...)     number inside the object, such as the triangle; 0xffffffff for a miss
    instance   uint32  (...)     number of the chain of instances; 0xffffffff for none
    uv         float32 (..., 2)  barycentric weights of a triangle's second and third corner; else 0
    normal     float32 (..., 3)  of unit length, out of solids, for meshes by the order of the corners;
                                 0 for a miss
    position   float32 (..., 3)  the point; 0 for a miss

A ray with a NaN, or of direction zero, hits nothing. Of hits at equal distance the lowest (instance, object,
primitive) counts. Raises ValueError for other shapes and types.)";

constexpr const char* kAllHitsDoc = R"(Every hit of each ray, nearest first.

A closed mesh contributes each crossing once, also at edges and corners of triangles. rays, tmin, tmax, fields
and errors are those of closest_hit.

Returns HitLists: the fields of Hits, with the hits of ray 0 first, then those of ray 1, and so on; and
    splits     int64 (rays + 1,)  the hits of ray i are splits[i] to splits[i + 1] - 1)";

}  // namespace

void bind_ray_queries(SceneClass& scene) {
  using namespace pybind11::literals;
  const Fields usual{"t", "object", "primitive", "uv", "normal"};
  const float zero = 0, infinity = std::numeric_limits<float>::infinity();
  scene.def("closest_hit", ask_closest_hit, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(),
            "fields"_a = usual, kClosestHitDoc);
  scene.def(
      "any_hit", ask_any_hit, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity,
      "Whether each ray hits anything: bool (...). rays, tmin, tmax and errors are those of closest_hit.");
  scene.def(
      "count_hits", ask_count_hits, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity,
      "How many hits all_hits lists for each ray: uint32 (...). rays, tmin, tmax and errors are those of "
      "closest_hit.");
  scene.def("all_hits", ask_all_hits, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(),
            "fields"_a = usual, kAllHitsDoc);
}

}  // namespace oktett::python
