#pragma once
/// \file Small scenes and ways to look at their pictures.

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "core/isa.h"
#include "render/picture/render.h"

namespace oktett::test {

/// A square picture of one sample per pixel, seen from +z, without objects, lights or ambient light.
inline Scene bare_scene(std::uint32_t size = 16) {
  Scene scene;
  scene.camera_given = scene.lights_given = true;
  scene.film.width = scene.film.height = size;
  scene.integrator.samples = 1;
  scene.ambient_light = {0, 0, 0};
  return scene;
}

inline std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

inline void add_object(Scene& scene, Shape shape, std::uint32_t material, const Affine& transform = {}) {
  Object object;
  object.shape = std::move(shape);
  object.material = material;
  object.transform = transform;
  scene.objects.push_back(std::move(object));
}

/// Pure diffuse of the given colour: no ambient term, no highlight.
inline Material diffuse(const Color& color) {
  Material m;
  m.color = color;
  m.ambient = 0, m.diffuse = 1, m.specular = 0;
  return m;
}

/// Gives nothing but what it emits.
inline Material glowing(const Color& color) {
  Material m = diffuse({0, 0, 0});
  m.emission = color;
  return m;
}

/// Clear glass without highlight.
inline Material glass(float ior) {
  Material m = diffuse({1, 1, 1});
  m.diffuse = 0;
  m.transparency = 1;
  m.ior = ior;
  return m;
}

inline Material mirror() {
  Material m = diffuse({1, 1, 1});
  m.diffuse = 0;
  m.reflection = 1;
  return m;
}

/// Renders with the widest instruction set on as many threads as there are.
inline RenderResult run(const Scene& scene, const std::function<void(RenderOptions&)>& change = {}) {
  RenderOptions options;
  options.isa = default_isa();
  if (change) change(options);
  return render(scene, options);
}

inline float value(const Picture& picture, const char* plane, std::uint32_t x, std::uint32_t y) {
  return picture.find(plane)->values[static_cast<std::size_t>(y) * picture.width + x];
}

inline std::uint32_t id(const Picture& picture, const char* plane, std::uint32_t x, std::uint32_t y) {
  return picture.find(plane)->ids[static_cast<std::size_t>(y) * picture.width + x];
}

inline Color color(const Picture& p, std::uint32_t x, std::uint32_t y) {
  return {value(p, "R", x, y), value(p, "G", x, y), value(p, "B", x, y)};
}

/// World-space position that the picture's P layer gives.
inline Vec3f position(const Picture& p, std::uint32_t x, std::uint32_t y) {
  return {value(p, "P.X", x, y), value(p, "P.Y", x, y), value(p, "P.Z", x, y)};
}

/// True if all planes have the same names and the same bits.
inline bool same_bytes(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height || a.planes.size() != b.planes.size()) return false;
  for (std::size_t i = 0; i < a.planes.size(); ++i) {
    const PicturePlane &p = a.planes[i], &q = b.planes[i];
    if (p.name != q.name || p.values.size() != q.values.size() || p.ids.size() != q.ids.size()) return false;
    if (p.values.size() > 0 &&
        std::memcmp(p.values.data(), q.values.data(), p.values.size() * sizeof(float)) != 0)
      return false;
    if (p.ids.size() > 0 &&
        std::memcmp(p.ids.data(), q.ids.data(), p.ids.size() * sizeof(std::uint32_t)) != 0)
      return false;
  }
  return true;
}

/// A sphere of unit radius as a mesh of `rings` times 2 `rings` quads, normals as exact as floats are.
inline std::shared_ptr<TriangleMesh> sphere_mesh(int rings, const Vec3d& center = {}, double radius = 1) {
  auto mesh = std::make_shared<TriangleMesh>();
  const int columns = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int c = 0; c < columns; ++c) {
      const double theta = std::numbers::pi * r / rings, phi = 2 * std::numbers::pi * c / columns;
      const Vec3d n{std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)};
      mesh->positions.push_back(Vec3f(center + n * radius));
      mesh->normals.push_back(Vec3f(n));
    }
  const auto triangle = [&](int a, int b, int c) {
    for (const int i : {a, b, c}) {
      mesh->indices.push_back(static_cast<std::uint32_t>(i));
      mesh->normal_indices.push_back(static_cast<std::uint32_t>(i));
    }
  };
  for (int r = 0; r < rings; ++r)
    for (int c = 0; c < columns; ++c) {
      const int a = r * columns + c, b = r * columns + (c + 1) % columns;
      if (r > 0) triangle(a, a + columns, b);
      if (r < rings - 1) triangle(b, a + columns, b + columns);
    }
  return mesh;
}

/// Two triangles with the corners of a parallelogram; the front is where cross(u, v) points.
inline std::shared_ptr<TriangleMesh> parallelogram(const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {corner, corner + u, corner + u + v, corner + v}) mesh->positions.push_back(p);
  for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}}) mesh->uvs.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u})
    mesh->indices.push_back(i), mesh->uv_indices.push_back(i);
  return mesh;
}

}  // namespace oktett::test
