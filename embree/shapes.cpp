/// \file The shapes of geometries, made of their buffers.

#include <algorithm>
#include <limits>

#include "accel/point_shapes.h"
#include "embree/callbacks.h"
#include "embree/geometry.h"
#include "embree/scene.h"

namespace oktett::embree {

namespace {

/// Vertices farther away are taken as not finite, as Embree takes them: one of them would make the tolerances
/// of all rays through a scene so large that they meet every box.
constexpr float kFarthest = 1.844e18f;

Vec3f near_or_nan(const Vec3f& p) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  return max_component(abs(p)) <= kFarthest ? p : Vec3f{nan, nan, nan};
}

/// The positions of one time step, and at the end one that is not finite, for triangles without a surface.
Column<Vec3f> read_positions(const Geometry& g, unsigned step) {
  const View* const view = g.find(RTC_BUFFER_TYPE_VERTEX, step);
  const std::size_t count = view != nullptr ? view->count : 0;
  Column<Vec3f> positions;
  positions.resize_uninitialized(count + 1);
  for (std::size_t i = 0; i < count; ++i) positions[i] = near_or_nan(view->vec3(i));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  positions[count] = {nan, nan, nan};
  return positions;
}

/// The mesh of a geometry with these indices, which moves if there are several time steps.
Made make_mesh(const Geometry& g, Column<std::uint32_t> indices, std::shared_ptr<const FaceMap> faces) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = read_positions(g, 0);
  mesh->indices = std::move(indices);
  const auto vertices = static_cast<std::uint32_t>(mesh->positions.size() - 1);
  for (std::size_t i = 0; i < mesh->indices.size(); i += 3)
    if (std::max({mesh->indices[i], mesh->indices[i + 1], mesh->indices[i + 2]}) >= vertices)
      for (std::size_t k = 0; k < 3; ++k) mesh->indices[i + k] = vertices;
  Made made;
  made.mesh = mesh, made.faces = std::move(faces);
  if (g.time_steps == 1) {
    oktett::Geometry fixed;
    fixed.shape = MeshGeometry{mesh.get(), false};
    made.shape = std::move(fixed);
    return made;
  }
  MovingMesh moving;
  moving.mesh = mesh;
  for (unsigned step = 1; step < g.time_steps; ++step) {
    Column<Vec3f>& positions = moving.later_positions.emplace_back(read_positions(g, step));
    positions.resize_uninitialized(mesh->positions.size());
  }
  made.shape = std::move(moving);
  return made;
}

}  // namespace

Made make_triangles(const Geometry& g) {
  const View* const view = g.find(RTC_BUFFER_TYPE_INDEX);
  Column<std::uint32_t> indices;
  indices.resize_uninitialized(view != nullptr ? 3 * view->count : 0);
  for (std::size_t i = 0; 3 * i < indices.size(); ++i)
    std::copy_n(view->item<std::uint32_t>(i), 3, &indices[3 * i]);
  return make_mesh(g, std::move(indices), nullptr);
}

Made make_quads(const Geometry& g) {
  static const auto faces = std::make_shared<const QuadFaces>();
  const View* const view = g.find(RTC_BUFFER_TYPE_INDEX);
  Column<std::uint32_t> indices;
  indices.resize_uninitialized(view != nullptr ? 6 * view->count : 0);
  for (std::size_t i = 0; 6 * i < indices.size(); ++i) {
    const auto* const v = view->item<std::uint32_t>(i);
    const std::uint32_t both[6] = {v[0], v[1], v[3], v[2], v[3], v[1]};
    std::copy_n(both, 6, &indices[6 * i]);
  }
  return make_mesh(g, std::move(indices), faces);
}

namespace {

/// Grids of quads: u and v count over a whole grid.
class GridFaces final : public FaceMap {
 public:
  struct Grid {
    std::uint32_t first;          ///< triangle
    std::uint32_t width, height;  ///< vertices
  };
  std::vector<Grid> grids;

  void to_face(std::uint32_t& primitive, float& u, float& v) const override {
    const auto after =
        std::upper_bound(grids.begin(), grids.end(), primitive,
                         [](std::uint32_t triangle, const Grid& grid) { return triangle < grid.first; });
    const Grid& grid = after[-1];
    std::uint32_t quad = primitive - grid.first;
    QuadFaces().to_face(quad, u, v);
    const std::uint32_t cells = grid.width - 1;
    u = (static_cast<float>(quad % cells) + u) / static_cast<float>(cells);
    v = (static_cast<float>(quad / cells) + v) / static_cast<float>(grid.height - 1);
    primitive = static_cast<std::uint32_t>(&grid - grids.data());
  }
};

}  // namespace

Made make_grids(const Geometry& g) {
  const View* const view = g.find(RTC_BUFFER_TYPE_GRID);
  const auto faces = std::make_shared<GridFaces>();
  Column<std::uint32_t> indices;
  for (std::size_t i = 0; view != nullptr && i < view->count; ++i) {
    const RTCGrid grid = *view->item<RTCGrid>(i);
    faces->grids.push_back({static_cast<std::uint32_t>(indices.size() / 3), grid.width, grid.height});
    for (std::uint64_t y = 0; y + 1 < grid.height; ++y)
      for (std::uint64_t x = 0; x + 1 < grid.width; ++x) {
        const auto vertex = [&](std::uint64_t column, std::uint64_t row) {
          const std::uint64_t n = grid.startVertexID + row * grid.stride + column;
          return static_cast<std::uint32_t>(std::min<std::uint64_t>(n, kNoId));
        };
        const std::uint32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1),
                            d = vertex(x, y + 1);
        for (const std::uint32_t corner : {a, b, d, c, d, b}) indices.push_back(corner);
      }
  }
  return make_mesh(g, std::move(indices), faces);
}

// ---- Points and lines.

namespace {

RoundPointKeys read_points(const Geometry& g) {
  RoundPointKeys keys(g.time_steps);
  for (unsigned step = 0; step < g.time_steps; ++step) {
    const View* const view = g.find(RTC_BUFFER_TYPE_VERTEX, step);
    keys[step].reserve(view != nullptr ? view->count : 0);
    for (std::size_t i = 0; view != nullptr && i < view->count; ++i)
      keys[step].push_back({near_or_nan(view->vec3(i)), view->item<float>(i)[3]});
  }
  return keys;
}

}  // namespace

Made make_points(const Geometry& g) {
  RoundPointKeys keys = read_points(g);
  Made made;
  if (g.type == RTC_GEOMETRY_TYPE_DISC_POINT) {
    made.shape = make_facing_discs(std::move(keys));
  } else if (g.type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT) {
    std::vector<std::vector<Vec3f>> normals(g.time_steps);
    for (unsigned step = 0; step < g.time_steps; ++step) {
      const View* const view = g.find(RTC_BUFFER_TYPE_NORMAL, step);
      for (std::size_t i = 0; view != nullptr && i < view->count; ++i) normals[step].push_back(view->vec3(i));
      normals[step].resize(keys[step].size());
    }
    made.shape = make_discs(std::move(keys), std::move(normals));
  } else if (g.time_steps > 1) {
    made.shape = make_moving_spheres(std::move(keys));
  } else {
    SpheresShape spheres;
    // A radius of zero is nothing.
    for (const RoundPoint& p : keys[0])
      spheres.spheres.push_back({Vec3d(p.center), p.radius > 0 ? static_cast<double>(p.radius) : 0});
    oktett::Geometry fixed;
    fixed.shape = std::move(spheres);
    made.shape = std::move(fixed);
  }
  return made;
}

Made make_lines(const Geometry& g) {
  RoundPointKeys keys = read_points(g);
  const View* const view = g.find(RTC_BUFFER_TYPE_INDEX);
  std::vector<std::uint32_t> first;
  const std::size_t points = keys[0].size();
  bool has_invalid = false;
  for (std::size_t i = 0; view != nullptr && i < view->count; ++i) {
    const std::uint32_t begin = *view->item<std::uint32_t>(i);
    const bool valid = begin < points && points - begin >= 2;
    has_invalid |= !valid;
    first.push_back(valid ? begin : static_cast<std::uint32_t>(points));
  }
  // Points without a surface, for segments that are out of range.
  if (has_invalid)
    for (auto& at_key : keys) at_key.insert(at_key.end(), 2, RoundPoint{{}, -1});
  Made made;
  made.shape = make_round_lines(std::move(keys), std::move(first));
  return made;
}

// ---- Shapes of the program, and instances.

Made make_user(const Geometry& g) {
  Made made;
  made.shape = std::static_pointer_cast<const UserShape>(std::make_shared<const UserCallbacks>(g));
  return made;
}

Made make_instance(const Geometry& g) {
  static const std::shared_ptr<const TraceScene> nothing = build_trace_scene({});
  const auto traced = [&](std::size_t i) {
    const std::shared_ptr<const Traced> scene = i < g.scenes.size() ? g.scenes[i]->traced() : nullptr;
    return scene != nullptr ? std::shared_ptr<const TraceScene>(scene, scene->scene.get()) : nothing;
  };
  Made made;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
  if (g.type == RTC_GEOMETRY_TYPE_INSTANCE_ARRAY) {
    SceneInstances many;
    for (std::size_t i = 0; i < g.scenes.size(); ++i) many.children.push_back(traced(i));
    const View* const which = g.find(RTC_BUFFER_TYPE_INDEX);
    const std::uint32_t count = g.primitive_count();
    const bool turn =
        count > 0 && g.view({RTC_BUFFER_TYPE_TRANSFORM, 0}).format == RTC_FORMAT_QUATERNION_DECOMPOSITION;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t child = which != nullptr && i < which->count ? *which->item<std::uint32_t>(i) : 0;
      if (child >= many.children.size())
        fail(RTC_ERROR_INVALID_OPERATION, "instance " + std::to_string(i) + " shows scene " +
                                              std::to_string(child) + " of " +
                                              std::to_string(many.children.size()));
      many.places.push_back({{}, child});
    }
    for (unsigned step = 0; step < g.time_steps && count > 0; ++step) {
      const View& view = g.view({RTC_BUFFER_TYPE_TRANSFORM, step});
      if (view.count != count || (view.format == RTC_FORMAT_QUATERNION_DECOMPOSITION) != turn)
        fail(RTC_ERROR_INVALID_OPERATION, "the transforms of time step " + std::to_string(step) +
                                              " are of another number or kind than those of step 0");
      if (turn) {
        std::vector<TurningMap>& key = many.turning.emplace_back();
        for (std::uint32_t i = 0; i < count; ++i)
          key.push_back(to_turning_map(*view.item<RTCQuaternionDecomposition>(i)));
      } else if (step == 0) {
        for (std::uint32_t i = 0; i < count; ++i)
          many.places[i].transform = read_transform(view.format, view.item<float>(i));
      } else {
        std::vector<Affine>& key = many.later_transforms.emplace_back();
        for (std::uint32_t i = 0; i < count; ++i)
          key.push_back(read_transform(view.format, view.item<float>(i)));
      }
    }
    made.shape = std::move(many);
    return made;
  }
#endif
  SceneInstance one;
  one.child = traced(0);
  one.transforms = g.transforms, one.turning = g.turning;
  made.shape = std::move(one);
  return made;
}

}  // namespace oktett::embree
