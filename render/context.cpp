#include "render/context.h"

#include <algorithm>
#include <cmath>

#include "render/direct_light.h"

namespace oktett {

static LightSource light_source(const Light& light) {
  if (const auto* point = std::get_if<PointLight>(&light))
    return {Vec3f(point->position), point->color, false, point->falloff};
  const auto& directional = std::get<DirectionalLight>(light);
  return {Vec3f(normalize(-directional.direction)), directional.color, true, false};
}

static ShadingMaterial shading_material(const Material& m, const RenderContext& context) {
  ShadingMaterial s;
  s.color = m.color, s.specular_color = m.specular_color;
  s.unlit = m.emission + m.color * m.ambient * context.ambient_light;
  s.diffuse = m.diffuse, s.specular = m.specular, s.phong = m.phong;
  s.exponent = ShadingMaterial::kAnyPower;
  if (m.specular == 0)
    s.exponent = 0;
  else if (by_squaring(m.phong))
    s.exponent = static_cast<std::int32_t>(m.phong);
  s.textured = context.textures != nullptr && has_textures(m);
  s.reflection = m.reflection;
  s.transparent = m.transparency != 0;
  return s;
}

/// Range of distances along the view axis that the bounds of the scene span in front of the camera.
static void set_depth_range(const Box& box, RenderContext& context) {
  if (box.empty()) return;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                  corner & 4 ? box.hi.z : box.lo.z};
    const double depth = camera_depth(context.camera, p);
    nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
  }
  nearest = std::max(nearest, 0.0);
  if (!(farthest > nearest)) return;
  context.near_depth = static_cast<float>(nearest), context.far_depth = static_cast<float>(farthest);
}

RenderContext make_context(const Scene& scene, const World& world, const TextureSampler* textures, Isa isa) {
  RenderContext c;
  c.world = &world;
  c.textures = textures;
  c.isa = isa;
  c.camera = camera_frame(scene.camera, scene.film);
  c.window = crop_window(scene.film);
  c.full_width = std::max(scene.film.width, 1u), c.full_height = std::max(scene.film.height, 1u);
  c.settings = scene.integrator;
  c.settings.samples = std::clamp(c.settings.samples, 1u, 65536u);
  c.settings.depth = std::min(c.settings.depth, 64u);
  for (const Light& light : scene.lights) c.lights.push_back(light_source(light));
  c.background = scene.background, c.ambient_light = scene.ambient_light;
  for (const Material& material : world.materials) c.materials.push_back(shading_material(material, c));
  c.opaque_background = !(c.background == Color{0, 0, 0});
  const double diagonal = world.bounds.empty() ? 0 : length(Vec3d(world.bounds.hi) - Vec3d(world.bounds.lo));
  const double radius = scene.integrator.ao_radius > 0 ? scene.integrator.ao_radius : diagonal / 10;
  c.ao_radius = radius > 0 ? static_cast<float>(radius) : 1;
  set_depth_range(world.bounds, c);
  // With more samples per pixel each looks up a smaller part of a texture, but not below an eighth of a pixel
  // (pbrt's bound).
  c.footprint_scale = std::max(0.125f, 1 / std::sqrt(static_cast<float>(c.settings.samples)));
  return c;
}

}  // namespace oktett
