#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "python/src/arrays.h"
#include "python/src/bind.h"
#include "python/src/fields.h"
#include "python/src/pieces.h"
#include "python/src/ray_queries.h"
#include "python/src/unlocked.h"

namespace oktett::python {
namespace {

/// The arguments of a query: arrays that are kept alive, and where they lie.
class RayArguments {
 public:
  RayArguments(py::handle given, py::handle given_tmin, py::handle given_tmax)
      : given_(number_rows(given, "rays", 6)), shape(row_shape(given_)) {
    tmin_ = float_each(given_tmin, "tmin", shape);
    tmax_ = float_each(given_tmax, "tmax", shape);
    for (py::ssize_t i = 0; i < tmin_.size(); ++i)
      if (tmin_.data()[i] < 0)
        throw py::value_error("tmin: expected no negative numbers, found " + number_text(tmin_.data()[i]));
  }

  /// The rays of a world, which may count from elsewhere.
  const RayRows& rows_in(const PlacedWorld& world) {
    rays_ = floats_from(world.origin, given_);
    rows_ = {rays_.data(),
             tmin_.data(),
             tmax_.data(),
             tmin_.ndim() == 0 ? 0u : 1u,
             tmax_.ndim() == 0 ? 0u : 1u,
             static_cast<std::size_t>(rays_.size() / 6)};
    return rows_;
  }

 private:
  py::array given_;
  FloatArray rays_, tmin_, tmax_;
  RayRows rows_;

 public:
  const ArrayShape shape;
};

/// Calls work(k, places) for the pieces of all rays, in the order of a picture if they look like one.
template <class Work>
void run_in_places(const RayOrder& order, const Work& work) {
  run_tasks(order.piece_count(), [&](std::size_t k) {
    static thread_local std::vector<std::size_t> places;
    order.piece(k, places);
    work(k, Places(places));
  });
}

/// The masks of rays: one for all, or one for each.
class RayMasks {
 public:
  RayMasks(SceneStore& scene, py::handle given, const ArrayShape& shape) {
    if (py::isinstance<py::int_>(given)) {
      worlds_.push_back(world_of(scene, mask_of(given)));
      return;
    }
    const py::array array = py::array::ensure(given);
    PyErr_Clear();
    const char kind = array ? array.dtype().kind() : 'f';
    if ((kind == 'u' || kind == 'i') && array.ndim() == 0) {
      worlds_.push_back(world_of(scene, mask_of(array.attr("item")())));
      return;
    }
    if ((kind != 'u' && kind != 'i') || row_shape_of(array) != shape)
      throw py::value_error("mask: expected a number of 32 bits, or an array of them of shape " +
                            text_of(shape));
    const auto each = dense<std::int64_t>(array);
    std::map<std::int64_t, std::uint32_t> index;
    std::vector<std::uint32_t> masks;
    for (py::ssize_t i = 0; i < each.size(); ++i) {
      const std::int64_t mask = each.data()[i];
      if (mask < 0 || mask > std::int64_t{~0u}) throw py::value_error("mask: expected numbers of 32 bits");
      const auto [found, is_new] = index.try_emplace(mask, static_cast<std::uint32_t>(masks.size()));
      if (is_new) masks.push_back(static_cast<std::uint32_t>(mask));
      index_.push_back(found->second);
    }
    if (masks.empty()) masks.push_back(~0u);
    worlds_ = worlds_of(scene, masks);
  }

  /// One of the worlds, which differ in what rays meet alone.
  const PlacedWorld& world() const { return *worlds_[0]; }

  /// Calls work(world, places) for the pieces of all rays, those with each mask by themselves.
  template <class Work>
  void run(const RayOrder& order, const Work& work) const {
    run_in_places(order, [&](std::size_t, Places places) {
      if (worlds_.size() == 1) return work(*worlds_[0], places);
      std::map<std::uint32_t, std::vector<std::size_t>> of_world;
      for (const std::size_t place : places) of_world[index_[place]].push_back(place);
      for (const auto& [index, own] : of_world) work(*worlds_[index], Places(own));
    });
  }

 private:
  static std::uint32_t mask_of(py::handle given) {
    try {
      return given.cast<std::uint32_t>();
    } catch (const py::cast_error&) {
      throw py::value_error("mask: expected a number of 32 bits");
    }
  }
  static ArrayShape row_shape_of(const py::array& array) {
    return {array.shape(), array.shape() + array.ndim()};
  }
  static std::string text_of(const ArrayShape& shape) { return py::str(py::tuple(py::cast(shape))); }

  std::vector<std::shared_ptr<const PlacedWorld>> worlds_;
  std::vector<std::uint32_t> index_;  ///< of each ray: its world; empty if there is one
};

/// Flags of primitives by their objects: arrays that are kept alive, and where they lie.
class Ignored {
 public:
  explicit Ignored(py::handle given) {
    if (given.is_none()) return;
    if (!py::isinstance<py::dict>(given))
      throw py::value_error("ignore: expected a dict of arrays of bool by objects");
    for (const auto& [object, flags] : py::reinterpret_borrow<py::dict>(given)) {
      std::uint32_t number;
      try {
        number = object.cast<std::uint32_t>();
      } catch (const py::cast_error&) {
        throw py::value_error("ignore: expected numbers of objects as keys");
      }
      const py::array array = py::array::ensure(flags);
      PyErr_Clear();
      if (!array || array.dtype().kind() != 'b' || array.ndim() != 1)
        throw py::value_error("ignore: expected one bool for each primitive of an object");
      const auto& kept = arrays_.emplace_back(dense<bool>(array));
      primitives.of_object[number] = {kept.data(), static_cast<std::size_t>(kept.size())};
    }
  }

  IgnoredPrimitives primitives;

 private:
  std::vector<py::array_t<bool, py::array::c_style | py::array::forcecast>> arrays_;
};

RayOrder picture_order(const RayRows& rays) {
  return RayOrder(rays.size, picture_width(rays.rows, rays.size));
}

const Fields kHitFields{"t",      "object",   "primitive", "instance", "uv",
                        "normal", "position", "texcoord",  "color"};

/// Calls visit(name, column, components) for each column.
template <class Visit>
void visit_fields(HitColumns& columns, const Visit& visit) {
  visit("t", columns.t, 0);
  visit("object", columns.object, 0);
  visit("primitive", columns.primitive, 0);
  visit("instance", columns.instance, 0);
  visit("uv", columns.uv, 2);
  visit("normal", columns.normal, 3);
  visit("texcoord", columns.texcoord, 2);
}

py::object ask_closest_hit(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax,
                           const Fields& fields, py::handle mask, py::handle ignore) {
  check_fields(fields, kHitFields);
  RayArguments arguments(rays, tmin, tmax);
  HitColumns columns;
  py::dict result;
  visit_fields(columns, [&](const char* name, auto*& column, py::ssize_t components) {
    column = make_column(result, name, fields, arguments.shape, components, column);
  });
  const RayMasks masks(scene, mask, arguments.shape);
  const Ignored ignored(ignore);
  const RayRows& rows = arguments.rows_in(masks.world());
  make_places(result, "position", fields, arguments.shape, masks.world().origin, columns.position);
  columns.attributes = attribute_columns(fields, masks.world());
  make_attributes(result, arguments.shape, columns.attributes, fields);
  masks.run(picture_order(rows), [&](const World& world, Places places) {
    closest_hits(world, rows, places, ignored.primitives, columns);
  });
  return py::module_::import("oktett._results").attr("Hits")(**result);
}

py::array ask_any_hit(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax, py::handle mask,
                      py::handle ignore) {
  RayArguments arguments(rays, tmin, tmax);
  py::array_t<bool> result(arguments.shape);
  auto* const out = reinterpret_cast<std::uint8_t*>(result.mutable_data());
  const RayMasks masks(scene, mask, arguments.shape);
  const Ignored ignored(ignore);
  const RayRows& rows = arguments.rows_in(masks.world());
  masks.run(picture_order(rows), [&](const World& world, Places places) {
    any_hits(world, rows, places, ignored.primitives, out);
  });
  return result;
}

py::array ask_count_hits(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax,
                         py::handle mask, py::handle ignore) {
  RayArguments arguments(rays, tmin, tmax);
  py::array_t<std::uint32_t> result(arguments.shape);
  const RayMasks masks(scene, mask, arguments.shape);
  const Ignored ignored(ignore);
  const RayRows& rows = arguments.rows_in(masks.world());
  masks.run(picture_order(rows), [&, out = result.mutable_data()](const World& world, Places places) {
    count_hits(world, rows, places, ignored.primitives, out);
  });
  return result;
}

/// One column of the hits of all pieces, as an array.
template <class T>
py::object joined(const std::vector<FoundHits>& pieces, std::vector<T> FoundHits::*column, const void* wanted,
                  py::ssize_t components) {
  if (wanted == nullptr) return py::none();
  std::size_t size = 0;
  for (const FoundHits& piece : pieces) size += (piece.*column).size();
  const auto count = static_cast<py::ssize_t>(size);
  py::array_t<T> array(components == 0 ? ArrayShape{count} : ArrayShape{count / components, components});
  T* out = array.mutable_data();
  for (const FoundHits& piece : pieces) out = std::copy((piece.*column).begin(), (piece.*column).end(), out);
  return array;
}

/// Places of a world in float64 if they count from elsewhere; `places` itself, which may be None, if not.
py::object placed(const py::object& places, const Vec3d& origin) {
  if (places.is_none() || origin == Vec3d{}) return places;
  DoubleArray result = dense<double>(places);
  double* const numbers = result.mutable_data();
  for (py::ssize_t i = 0; i < result.size(); ++i) numbers[i] += origin[static_cast<int>(i % 3)];
  return result;
}

/// Where the hits of each ray begin in the columns of all pieces.
py::array joined_splits(const std::vector<FoundHits>& pieces, std::size_t rays) {
  py::array_t<std::int64_t> splits(static_cast<py::ssize_t>(rays + 1));
  std::int64_t* out = splits.mutable_data();
  std::int64_t before = 0;
  for (const FoundHits& piece : pieces) {
    for (std::size_t i = 0; i + 1 < piece.begin.size(); ++i)
      *out++ = before + static_cast<std::int64_t>(piece.begin[i]);
    before += static_cast<std::int64_t>(piece.begin.back());
  }
  *out = before;
  return splits;
}

py::object ask_all_hits(SceneStore& scene, py::handle rays, py::handle tmin, py::handle tmax,
                        const Fields& fields, std::uint32_t mask, py::handle ignore) {
  check_fields(fields, kHitFields);
  RayArguments arguments(rays, tmin, tmax);
  const Ignored ignored(ignore);
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
  if (contains(fields, "position")) wanted.position.floats = &some_float;
  const std::shared_ptr<const PlacedWorld> world = world_of(scene, mask);
  const RayRows& rows = arguments.rows_in(*world);
  const RayOrder order(rows.size, 0);
  std::vector<FoundHits> pieces(order.piece_count());
  wanted.attributes = attribute_columns(fields, *world);
  run_in_places(order, [&](std::size_t k, Places places) {
    all_hits(*world, rows, places, ignored.primitives, wanted, pieces[k]);
  });
  py::dict result;
  result["splits"] = joined_splits(pieces, rows.size);
  result["t"] = joined(pieces, &FoundHits::t, wanted.t, 0);
  result["object"] = joined(pieces, &FoundHits::object, wanted.object, 0);
  result["primitive"] = joined(pieces, &FoundHits::primitive, wanted.primitive, 0);
  result["instance"] = joined(pieces, &FoundHits::instance, wanted.instance, 0);
  result["uv"] = joined(pieces, &FoundHits::uv, wanted.uv, 2);
  result["normal"] = joined(pieces, &FoundHits::normal, wanted.normal, 3);
  result["position"] = placed(joined(pieces, &FoundHits::position, wanted.position.floats, 3), world->origin);
  result["texcoord"] = joined(pieces, &FoundHits::texcoord, wanted.texcoord, 2);
  put_attributes(result, wanted.attributes, fields, [&](std::size_t i) -> py::object {
    std::size_t size = 0;
    for (const FoundHits& piece : pieces) size += piece.attributes[i].size();
    const auto count = static_cast<py::ssize_t>(size),
               components = py::ssize_t{wanted.attributes[i].components};
    py::array_t<float> array(components == 1 ? ArrayShape{count}
                                             : ArrayShape{count / components, components});
    float* out = array.mutable_data();
    for (const FoundHits& piece : pieces) out = std::ranges::copy(piece.attributes[i], out).out;
    return array;
  });
  return py::module_::import("oktett._results").attr("HitLists")(**result);
}

constexpr const char* kClosestHitDoc = R"(The nearest hit of each ray.

rays: shape (..., 6), origin and direction of each ray in a row. A hit is at origin + t * direction with
    tmin < t <= tmax; t counts in lengths of the direction, which need not be 1. C-contiguous float32 is read
    in place, anything else is copied. The origin of a scene is taken off in float64 before.
tmin, tmax: a number for all rays, or one for each, shape (...). tmin >= 0.
fields: what is wanted. The others are None in the result.
mask: 32 bits for all rays, or for each, shape (...); they meet objects that have one of them, see set_mask.
ignore: a dict of arrays of bool by numbers of objects, a flag for each primitive: rays pass those that are
    flagged. Primitives behind the end of an array are met.

Returns Hits:
    t          float32 (...)     distance; inf for a miss
    object     uint32  (...)     number of the object, an index into Scene.objects; 0xffffffff for a miss
    primitive  uint32  (...)     number inside the object, such as the triangle; 0xffffffff for a miss
    instance   uint32  (...)     number of the chain of instances; 0xffffffff for none
    uv         float32 (..., 2)  barycentric weights of a triangle's second and third corner; else 0
    normal     float32 (..., 3)  of unit length, out of solids, for meshes by the order of the corners;
                                 0 for a miss
    position   float32 (..., 3)  the point; 0 for a miss; float64 if the scene has an origin
    texcoord   float32 (..., 2)  texture coordinates of the mesh; NaN where it has none
    color      float32 (..., 3)  linear colour of the mesh; NaN where it has none
    attributes                   a dict of float32 by name for fields "attribute:NAME", (...) or, of k
                                 numbers, (..., k); NaN where the mesh has none

Values of corners are interpolated in double by the hit's uv, then rounded to float32.
A ray with a NaN, or of direction zero, hits nothing. Of hits at equal distance the lowest (instance, object,
primitive) counts, of those with meshes that were added the lowest (object, primitive), after all others. Raises ValueError for other shapes and types.)";

constexpr const char* kAllHitsDoc = R"(Every hit of each ray, nearest first.

A closed mesh contributes each crossing once, also at edges and corners of triangles. rays, tmin, tmax, fields,
ignore and errors are those of closest_hit; mask is one for all rays.

Returns HitLists: the fields of Hits, with the hits of ray 0 first, then those of ray 1, and so on; and
    splits     int64 (rays + 1,)  the hits of ray i are splits[i] to splits[i + 1] - 1)";

}  // namespace

void bind_ray_queries(SceneClass& scene) {
  using namespace pybind11::literals;
  const Fields usual{"t", "object", "primitive", "uv", "normal"};
  const float zero = 0, infinity = std::numeric_limits<float>::infinity();
  scene.def("closest_hit", ask_closest_hit, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(),
            "fields"_a = usual, "mask"_a = ~0u, "ignore"_a = py::none(), kClosestHitDoc);
  scene.def(
      "any_hit", ask_any_hit, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(), "mask"_a = ~0u,
      "ignore"_a = py::none(),
      "Whether each ray hits anything: bool (...). rays, tmin, tmax, mask, ignore and errors are those of "
      "closest_hit.");
  scene.def("count_hits", ask_count_hits, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(),
            "mask"_a = ~0u, "ignore"_a = py::none(),
            "How many hits all_hits lists for each ray: uint32 (...). rays, tmin, tmax, mask and errors are "
            "those of "
            "closest_hit.");
  scene.def("all_hits", ask_all_hits, "rays"_a, "tmin"_a = zero, "tmax"_a = infinity, py::kw_only(),
            "fields"_a = usual, "mask"_a = ~0u, "ignore"_a = py::none(), kAllHitsDoc);
}

}  // namespace oktett::python
