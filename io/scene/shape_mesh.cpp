#include "io/scene/shape_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "io/mesh/polygon.h"

namespace oktett {
namespace {

struct ShapeName {
  std::string operator()(const CsgShape&) const { return "combination"; }
  std::string operator()(const InstanceShape&) const { return "instance"; }
  std::string operator()(const SpheresShape&) const { return "spheres"; }
  std::string operator()(const ExactShape& shape) const {
    return std::visit(
        [](const auto& form) -> std::string {
          // Scene files have several names for quadrics.
          if constexpr (requires { form.kShapeInfo; })
            return form.kShapeInfo.key;
          else
            return "quadric";
        },
        shape.form);
  }
  template <class T>
  std::string operator()(const T& shape) const {
    return shape.kShapeInfo.key;
  }
};

/// Triangles of one normal.
class FlatMesh {
 public:
  explicit FlatMesh(const Vec3d& normal) { mesh.normals.push_back(Vec3f(normalize(normal))); }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t i : {a, b, c}) mesh.indices.push_back(i), mesh.normal_indices.push_back(0);
  }

  TriangleMesh mesh;
};

TriangleMesh mesh_of(const TriangleShape& shape) {
  FlatMesh flat(cross(shape.v[1] - shape.v[0], shape.v[2] - shape.v[0]));
  for (const Vec3d& p : shape.v) flat.mesh.positions.push_back(Vec3f(p));
  flat.add(0, 1, 2);
  return std::move(flat.mesh);
}

TriangleMesh mesh_of(const BoxShape& box) {
  TriangleMesh mesh;
  // Corner k is at the far end along axis a if bit a is set.
  for (std::uint32_t k = 0; k < 8; ++k) {
    Vec3d p = box.min;
    for (int a = 0; a < 3; ++a)
      if ((k >> a & 1) != 0) p[a] = box.max[a];
    mesh.positions.push_back(Vec3f(p));
  }
  for (int a = 0; a < 3; ++a)
    for (const std::uint32_t side : {0u, 1u}) {
      const std::uint32_t x = 1u << a, y = 1u << (a + 1) % 3, z = 1u << (a + 2) % 3, at = side * x;
      Vec3f normal;
      normal[a] = side == 1 ? 1.0f : -1.0f;
      const auto number = static_cast<std::uint32_t>(mesh.normals.size());
      mesh.normals.push_back(normal);
      const std::uint32_t front[] = {at, at + y, at + y + z, at, at + y + z, at + z};
      for (std::size_t k = 0; k < 6; ++k) {
        mesh.indices.push_back(front[side == 1 ? k : 5 - k]);
        mesh.normal_indices.push_back(number);
      }
    }
  return mesh;
}

TriangleMesh mesh_of(const DiskShape& disk, std::uint32_t around) {
  const Vec3d normal = normalize(disk.normal);
  Vec3d x, y;
  make_basis(normal, x, y);
  FlatMesh flat(normal);
  const bool has_hole = disk.inner_radius > 0;
  const auto add_circle = [&](double radius) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      flat.mesh.positions.push_back(
          Vec3f(disk.center + (x * std::cos(angle) + y * std::sin(angle)) * radius));
    }
  };
  add_circle(disk.radius);
  if (has_hole)
    add_circle(disk.inner_radius);
  else
    flat.mesh.positions.push_back(Vec3f(disk.center));
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t next = (k + 1) % around;
    if (has_hole)
      flat.add(k, next, around + next), flat.add(k, around + next, around + k);
    else
      flat.add(k, next, around);
  }
  return std::move(flat.mesh);
}

TriangleMesh mesh_of(const PolygonShape& polygon) {
  std::vector<Vec3f> points;
  Vec3d normal;  // Newell's
  for (std::size_t i = 0; i < polygon.vertices.size(); ++i) {
    const Vec3d a = polygon.vertices[i] - polygon.vertices[0],
                b = polygon.vertices[(i + 1) % polygon.vertices.size()] - polygon.vertices[0];
    normal += cross(a, b);
    points.push_back(Vec3f(polygon.vertices[i]));
  }
  FlatMesh flat(normal);
  PolygonTriangulator triangulator;
  const std::span<const std::uint32_t> corners = triangulator.run(points);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    flat.add(corners[i], corners[i + 1], corners[i + 2]);
  for (const Vec3f& p : points) flat.mesh.positions.push_back(p);
  return std::move(flat.mesh);
}

}  // namespace

std::string shape_name(const Shape& shape) { return std::visit(ShapeName{}, shape); }

std::optional<TriangleMesh> plain_mesh(const Shape& shape, std::uint32_t around) {
  if (const auto* const triangle = std::get_if<TriangleShape>(&shape)) return mesh_of(*triangle);
  if (const auto* const box = std::get_if<BoxShape>(&shape)) return mesh_of(*box);
  if (const auto* const disk = std::get_if<DiskShape>(&shape)) return mesh_of(*disk, around);
  const auto* const polygon = std::get_if<PolygonShape>(&shape);
  if (polygon != nullptr && polygon->holes.empty()) return mesh_of(*polygon);
  return std::nullopt;
}

void leave_out_details(Shape& shape, std::uint32_t cells) {
  if (auto* const csg = std::get_if<CsgShape>(&shape)) {
    auto operands = std::make_shared<std::vector<Object>>(*csg->operands);
    for (Object& operand : *operands) leave_out_details(operand.shape, cells);
    csg->operands = std::move(operands);
    return;
  }
  auto* const exact = std::get_if<ExactShape>(&shape);
  if (exact == nullptr) return;
  // Generations until one, each `ratio` of the size of that before, is less than a cell.
  const auto generations = [&](double ratio) {
    return static_cast<std::uint32_t>(std::ceil(std::log(static_cast<double>(cells)) / std::log(1 / ratio)));
  };
  std::visit(
      [&](auto& form) {
        using Form = std::remove_cvref_t<decltype(form)>;
        if constexpr (std::is_same_v<Form, MengerShape>)
          form.depth = std::min(form.depth, generations(1.0 / 3));
        if constexpr (std::is_same_v<Form, SphereflakeShape>)
          form.depth = std::min(form.depth, generations(form.ratio));
        if constexpr (std::is_same_v<Form, TerrainShape>)
          form.depth = std::min(form.depth, generations(0.5) + 1);
        if constexpr (std::is_same_v<Form, IfsShape>) form.least = std::max(form.least, 1.0 / cells);
      },
      exact->form);
}

}  // namespace oktett
