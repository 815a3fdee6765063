#pragma once
/// \file Data that all pixels of a render share, prepared once.

#include <memory>
#include <span>
#include <vector>

#include "core/isa.h"
#include "render/area_lights.h"
#include "render/camera.h"
#include "render/dielectric_stack.h"
#include "render/geometry.h"
#include "render/insides.h"
#include "render/medium/medium_tracker.h"
#include "render/sampling/warp.h"
#include "render/scene.h"
#include "render/scene_lights.h"
#include "render/shading_columns.h"
#include "render/texture_sampler.h"

namespace oktett {

struct LightGroups;
struct PathSurface;
struct Mattes;

class Caustics;

/// What the textures of a material ask of a hit.
struct TextureNeeds {
  bool any = false;         ///< there are some
  bool uv = false;          ///< some image or pattern lies by uv
  bool position = false;    ///< some texture is a pattern
  bool mesh = false;        ///< some texture shows an attribute of the mesh
  bool second_uvs = false;  ///< some texture has uv_layer 1
};

struct RenderContext {
  const World* world = nullptr;
  const TextureSampler* textures = nullptr;  ///< of images; null: they are white
  std::span<const Texture> texture_list;     ///< Scene::textures
  Isa isa = Isa::scalar;
  CameraFrame camera;
  PixelWindow window;
  std::uint32_t full_width = 1, full_height = 1;
  FilterSampler filter;
  IntegratorSettings settings;
  std::vector<LightSource> lights;          ///< those that have a place or a direction, for Whitted's model
  AreaLights area_lights;                   ///< glowing surfaces, for Whitted's model
  const SceneLights* sampled = nullptr;     ///< all lights, for path tracing
  const Caustics* caustics = nullptr;       ///< photons that path tracing asks for light; may be null
  std::vector<ShadingMaterial> materials;   ///< numbered as in World::materials
  std::vector<TextureNeeds> texture_needs;  ///< the same
  bool some_only_send_rays = false;  ///< some of `materials`, see only_sends_rays(); for Whitted's model
  /// Two for each of World::materials, for path tracing; else null.
  std::shared_ptr<const std::vector<PathSurface>> path_surfaces;
  bool tracks_dielectrics = false;  ///< rays must know in which solids they are, see dielectric_stack.h
  bool hides_objects = false;       ///< rays of some kind do not meet all objects, see World::seen_by
  bool bounces_differ = false;      ///< those of bounces of different kinds meet different objects
  /// Path tracing where shadow rays meet other objects than bounces, see transport/met_lights.h.
  bool shadows_decide = false;
  bool catches = false;  ///< the light of shadow catchers is kept apart, see SampleBatch::caught()
  /// Where it is: the same, but that rays other than those of the camera meet only catchers and what glows.
  const RenderContext* without_others = nullptr;
  std::vector<MediumTracker> media;    ///< numbered as in Scene::media
  std::uint32_t outer_medium = kNoId;  ///< the medium outside of all solids
  DielectricStack camera_dielectrics;  ///< the solids around the camera
  Vec3f camera_place;                  ///< where `camera_dielectrics` holds
  // What fills the ways of rays in Whitted's model:
  bool tracks_insides = false;        ///< any of the following
  std::span<const Fog> fogs;          ///< Scene::fogs
  std::span<const Rainbow> rainbows;  ///< Scene::rainbows
  std::span<const Medium> marched;    ///< Scene::media
  Insides camera_insides;             ///< the solids around the camera
  Color background, ambient_light;
  std::uint32_t background_texture = kNoId;  ///< Scene::background_texture
  /// A background that gives light is part of the picture, with alpha 1; a black one leaves the picture
  /// transparent.
  bool opaque_background = false;
  bool all_opaque = false;  ///< alpha is 1 everywhere: the background counts, and no surface has holes
  bool data_layers = true;
  bool one_by_one = false;  ///< shades each hit alone, for tests: hits in lanes must have the same bits
  float ao_radius = 1;      ///< reach of ambient-occlusion rays
  float near_depth = 0, far_depth = 1;        ///< what the depth integrator shows as white and black
  const Mattes* mattes = nullptr;             ///< null: no mattes are wanted
  const LightGroups* light_groups = nullptr;  ///< null: no layers of light groups are wanted
  /// If not null, one for each moment while the shutter is open, see render/moments.h.
  const std::vector<RenderContext>* moments = nullptr;
  float footprint_scale = 1;  ///< width of a sample's share of the pixel, in pixels
};

/// The number of samples that every pixel gets.
std::uint32_t first_samples(const IntegratorSettings& settings);

/// The lights that have a place or a direction.
std::vector<LightSource> light_sources(const Scene& scene);

/// Finds the solids around the camera, if the scene tracks them.
void enclose_camera(const Camera& camera, RenderContext& context);

/// ShadingMaterial::exponent of a highlight of that weight and power.
std::int16_t highlight_exponent(float specular, float phong);

/// Sets what of a context depends on which objects rays meet in its world.
void set_visibility(RenderContext& context);

/// `scene` has its camera and lights filled in. `scene`, `world`, `lights` and `textures` must outlive the
/// result.
RenderContext make_context(const Scene& scene, const World& world, const SceneLights& lights,
                           const TextureSampler* textures, Isa isa);

}  // namespace oktett
