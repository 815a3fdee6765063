#include "render/context.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "render/bsdf/phong_lobes.h"
#include "render/path_surface.h"
#include "render/shading_point.h"

namespace oktett {

/// Whitted's model knows lights that have a place or one direction.
static bool lights_whitted(const Light& light) { return !std::holds_alternative<EnvironmentLight>(light); }

static LightSource light_source(const Light& light) {
  LightSource source;
  if (const auto* point = std::get_if<PointLight>(&light)) {
    source.place = Vec3f(point->position), source.color = point->color, source.falloff = point->falloff;
    source.fade = point->fade;
    source.profile = profile_of(*point);
  } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
    const auto cosine = [](double degrees) { return static_cast<float>(portable::cos(degrees * kDegree)); };
    source.place = Vec3f(spot->position), source.color = spot->color, source.falloff = spot->falloff;
    source.fade = spot->fade, source.tightness = spot->profile == nullptr ? spot->tightness : 0;
    source.spot = spot->profile == nullptr, source.profile = profile_of(*spot);
    source.axis = Vec3f(normalize(spot->direction));
    source.cos_inner = cosine(spot->inner_angle), source.cos_outer = cosine(spot->outer_angle);
  } else {
    const auto* sky = std::get_if<SkyLight>(&light);
    const DirectionalLight directional = sky != nullptr ? sun_of(*sky) : std::get<DirectionalLight>(light);
    source.place = Vec3f(normalize(-directional.direction)), source.color = directional.color;
    source.directional = true;
    if (directional.from) {
      source.from_place = true, source.from = *directional.from;
      source.fade = directional.fade, source.beam = directional.beam;
    }
  }
  return source;
}

std::int16_t highlight_exponent(float specular, float phong) {
  if (specular == 0) return 0;
  return by_squaring(phong) ? static_cast<std::int16_t>(phong) : ShadingMaterial::kAnyPower;
}

static ShadingMaterial shading_material(const Material& m, const RenderContext& context) {
  ShadingMaterial s;
  s.color = m.color, s.specular_color = m.specular_color;
  s.unlit = m.emission + m.color * m.ambient * context.ambient_light;
  s.diffuse = m.diffuse, s.specular = m.specular, s.phong = m.phong;
  s.exponent = highlight_exponent(m.specular, m.phong);
  s.varies = has_textures(m) || m.filter || m.opacity != 1 || (!m.emits_behind && glows(m)) || !m.surface ||
             m.interior != kNoId || m.reflection_varies || !m.fresnel || m.conserve_energy ||
             m.brilliance != 1 || m.specular_blinn != 0 || m.grain != 0 || m.diffuse_back != 0 ||
             m.film != 0 || m.specular_fades || m.reflection_fades || m.reflection_color || m.back != kNoId;
  s.reflection = m.reflection;
  s.transparency = m.transparency, s.ior = m.ior;
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
  // A curved view sees to all sides: the nearest place need not be a corner.
  if (is_curved(context.camera.projection)) {
    const Vec3f eye(context.camera.origin);
    nearest =
        context.camera.curved.parallel ? 0 : camera_depth(context.camera, min(max(eye, box.lo), box.hi));
  }
  nearest = std::max(nearest, 0.0);
  if (!(farthest > nearest)) return;
  context.near_depth = static_cast<float>(nearest), context.far_depth = static_cast<float>(farthest);
}

std::uint32_t first_samples(const IntegratorSettings& settings) {
  return std::clamp(settings.samples, settings.error > 0 ? kLeastPilot : 1u, kMostSamples);
}

std::vector<LightSource> light_sources(const Scene& scene) {
  std::vector<LightSource> sources;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (!lights_whitted(scene.lights[i])) continue;
    sources.push_back(light_source(scene.lights[i]));
    sources.back().list = light_list_number(list_of_light(scene, i));
    if (i >= scene.light_traits.size()) continue;
    sources.back().shadows = scene.light_traits[i].shadows;
    sources.back().highlights = scene.light_traits[i].highlights;
    sources.back().dimmed_by_fog = scene.light_traits[i].dimmed_by_fog;
  }
  return sources;
}

void enclose_camera(const Camera& camera, RenderContext& context) {
  if (context.tracks_insides) context.camera_insides = insides_at(*context.world, Vec3f(camera.from));
  if (!context.tracks_dielectrics) return;
  context.camera_place = Vec3f(camera.from);
  context.camera_dielectrics = dielectrics_at(context, context.camera_place);
}

void set_visibility(RenderContext& context) {
  const World& world = *context.world;
  context.hides_objects = hides_objects(world), context.bounces_differ = bounces_differ(world);
  context.shadows_decide = traits(context.settings.kind).traces_paths && shadows_differ(world);
  context.catches = world.has_catchers && traits(context.settings.kind).bounces();
}

RenderContext make_context(const Scene& scene, const World& world, const SceneLights& lights,
                           const TextureSampler* textures, Isa isa) {
  RenderContext c;
  c.world = &world;
  c.textures = textures;
  c.texture_list = scene.textures;
  for (const Material& material : world.materials)
    c.texture_needs.push_back(texture_needs(c.texture_list, material));
  c.isa = isa;
  c.camera = camera_frame(scene.camera, scene.film);
  c.window = crop_window(scene.film);
  c.full_width = std::max(scene.film.width, 1u), c.full_height = std::max(scene.film.height, 1u);
  c.filter = FilterSampler(scene.film.filter, scene.film.filter_radius);
  c.settings = scene.integrator;
  c.settings.samples = first_samples(scene.integrator);
  c.settings.depth = std::min(c.settings.depth, 64u);
  c.sampled = &lights;
  c.lights = light_sources(scene);
  c.area_lights = area_lights(lights, textures, c.settings);
  c.tracks_dielectrics = world.tracks_dielectrics;
  set_visibility(c);
  c.tracks_insides = world.tracks_insides;
  if (c.tracks_insides) c.fogs = scene.fogs, c.rainbows = scene.rainbows, c.marched = scene.media;
  if (c.tracks_dielectrics)
    for (const Medium& medium : scene.media) c.media.emplace_back(medium);
  if (c.tracks_dielectrics || c.tracks_insides) c.outer_medium = scene.medium;
  enclose_camera(scene.camera, c);
  c.background = scene.background, c.background_texture = scene.background_texture;
  c.ambient_light = scene.ambient_light;
  for (const Material& material : world.materials) c.materials.push_back(shading_material(material, c));
  c.some_only_send_rays = traits(c.settings.kind).light_from_points && !c.tracks_insides &&
                          std::ranges::any_of(c.materials, &ShadingMaterial::only_sends_rays);
  if (traits(c.settings.kind).traces_paths)
    c.path_surfaces = std::make_shared<const std::vector<PathSurface>>(path_surfaces(world));
  c.opaque_background = !(c.background == Color{0, 0, 0}) || c.background_texture != kNoId ||
                        lights.has_environment() || !c.fogs.empty() || !c.rainbows.empty();
  // Shadow catchers count what they cover, and curved views may leave out a part of the picture.
  c.all_opaque = c.opaque_background && !world.has_holes && !c.tracks_dielectrics && !c.catches &&
                 !is_curved(c.camera.projection);
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
