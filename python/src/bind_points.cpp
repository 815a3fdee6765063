#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <string>

#include "python/src/bind.h"
#include "python/src/fields.h"
#include "python/src/point_queries.h"
#include "python/src/unlocked.h"

namespace oktett::python {
namespace {

const Fields kPointFields{"distance", "point",  "object",   "primitive", "instance",
                          "uv",       "normal", "texcoord", "color"};

py::object ask_closest_point(SceneStore& scene, py::handle given, const Fields& fields) {
  check_fields(fields, kPointFields);
  const py::array rows = number_rows(given, "points", 3);
  const ArrayShape shape = row_shape(rows);
  ClosestColumns columns;
  py::dict result;
  const auto add = [&](const char* name, auto*& column, py::ssize_t components) {
    column = make_column(result, name, fields, shape, components, column);
  };
  add("distance", columns.distance, 0);
  add("object", columns.hit.object, 0);
  add("primitive", columns.hit.primitive, 0);
  add("instance", columns.hit.instance, 0);
  add("uv", columns.hit.uv, 2);
  add("normal", columns.hit.normal, 3);
  add("texcoord", columns.hit.texcoord, 2);
  const std::shared_ptr<const PlacedWorld> world = world_of(scene);
  const FloatArray points = floats_from(world->origin, rows);
  make_places(result, "point", fields, shape, world->origin, columns.point);
  columns.hit.attributes = attribute_columns(fields, *world);
  make_attributes(result, shape, columns.hit.attributes, fields);
  run_in_pieces(static_cast<std::size_t>(points.size() / 3), [&](std::size_t begin, std::size_t end) {
    closest_points(*world, points.data(), begin, end, columns);
  });
  return py::module_::import("oktett._results").attr("ClosestPoints")(**result);
}

InsideRule rule_of(const std::string& name, const char* argument) {
  if (name == "crossings") return InsideRule::crossings;
  if (name == "winding") return InsideRule::winding;
  throw py::value_error(std::string(argument) + ": expected 'crossings' or 'winding', not '" + name + "'");
}

/// An answer for each point: ask(world, points, begin, end, answers) gives those of the points [begin, end).
template <class T, class Ask>
py::array ask_each(SceneStore& scene, py::handle given, const Ask& ask) {
  const py::array rows = number_rows(given, "points", 3);
  py::array_t<T> result(row_shape(rows));
  T* const answers = result.mutable_data();
  const std::shared_ptr<const PlacedWorld> world = world_of(scene);
  const FloatArray points = floats_from(world->origin, rows);
  run_in_pieces(static_cast<std::size_t>(points.size() / 3),
                [&](std::size_t begin, std::size_t end) { ask(*world, points.data(), begin, end, answers); });
  return result;
}

py::array ask_inside(SceneStore& scene, py::handle points, const std::string& name) {
  const InsideRule rule = rule_of(name, "rule");
  return ask_each<bool>(scene, points,
                        [&](const World& world, const float* rows, auto begin, auto end, bool* out) {
                          inside(world, rows, begin, end, rule, reinterpret_cast<std::uint8_t*>(out));
                        });
}

py::array ask_winding_number(SceneStore& scene, py::handle points, double error) {
  if (!(error >= 0x1p-20))
    throw py::value_error("error: expected a number of at least 2^-20, not " + number_text(error));
  return ask_each<float>(scene, points,
                         [&](const World& world, const float* rows, auto begin, auto end, float* out) {
                           winding_numbers(world, rows, begin, end, error, out);
                         });
}

py::array ask_signed_distance(SceneStore& scene, py::handle points, const std::string& name) {
  const InsideRule rule = rule_of(name, "sign");
  return ask_each<float>(scene, points,
                         [&](const World& world, const float* rows, auto begin, auto end, float* out) {
                           signed_distances(world, rows, begin, end, rule, out);
                         });
}

constexpr const char* kClosestPointDoc = R"(The point of all surfaces that is nearest to each point.

points: shape (..., 3). C-contiguous float32 is read in place, anything else is copied. The origin of a scene
    is taken off in float64 before.
fields: what is wanted. The others are None in the result.

Returns ClosestPoints:
    distance   float32 (...)     inf if there are no surfaces or if the point is not finite
    point      float32 (..., 3)  the nearest point; float64 if the scene has an origin
    object, primitive, instance, uv, normal, texcoord, color, attributes: as in Hits, see closest_hit

Of points at equal distance that of the lowest (instance, object, primitive) counts. Meshes, spheres, boxes,
planes, disks, polygons, cylinders, cones, tori and instances of them are answered. Raises ValueError if the
scene holds another shape, or one of the round ones distorted, and for other shapes of arrays.)";

constexpr const char* kInsideDoc = R"(Whether each point is inside of any solid: bool (...).

points: shape (..., 3).
rule: how meshes are judged.
    'crossings': each alone, by one ray from the point. A point is inside of a closed mesh that winds around it,
        in either sense; where faces are wound against each other, after an odd number of crossings. In meshes
        with holes the answer depends on the direction of the ray.
    'winding': all together, where abs(winding_number) > 1/2; for open and damaged meshes. Decided exactly.

Solids are meshes, spheres, boxes, half-spaces of planes, exact surfaces that are not open, combinations, and
instances of them. Of points on a boundary nothing is promised. A point that is not finite is outside. Raises
ValueError for other shapes of arrays.)";

constexpr const char* kWindingNumberDoc =
    R"(How often all meshes together wind around each point: float32 (...).

points: shape (..., 3).
error: the numbers are off by at most this, at least 2^-20, and a rounding.

It is the sum of the solid angles of the triangles over 4 pi, positive seen from the back: 1 in a closed mesh,
-1 if that is inside out, 0 outside, between where there are holes, the mean of both sides on a surface. Each
other solid that holds the point adds 1. NaN for points that are not finite. Raises ValueError for other shapes
of arrays.)";

constexpr const char* kSignedDistanceDoc =
    R"(The distance of each point to the nearest surface: float32 (...).

It is that of closest_point, and negative where inside, by the rule that `sign` names, says that the point is
inside. points and errors are those of closest_point.)";

}  // namespace

void bind_point_queries(SceneClass& scene) {
  using namespace pybind11::literals;
  const Fields usual{"distance", "point", "object", "primitive", "uv", "normal"};
  scene.def("closest_point", ask_closest_point, "points"_a, py::kw_only(), "fields"_a = usual,
            kClosestPointDoc);
  scene.def("inside", ask_inside, "points"_a, py::kw_only(), "rule"_a = "crossings", kInsideDoc);
  scene.def("winding_number", ask_winding_number, "points"_a, py::kw_only(), "error"_a = 1e-4,
            kWindingNumberDoc);
  scene.def("signed_distance", ask_signed_distance, "points"_a, py::kw_only(), "sign"_a = "crossings",
            kSignedDistanceDoc);
}

}  // namespace oktett::python
