#pragma once
/// \file The lights of a scene as path tracing asks for them: its emitters, its environment, and the surfaces
/// that glow.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/ray.h"
#include "render/geometry.h"
#include "render/light/emitter.h"
#include "render/light/light_set.h"
#include "render/scene.h"
#include "render/texture_sampler.h"

namespace oktett {

// ---- Rectangles that meshes hold as two triangles.

/// The rectangle that two triangles of the same light cover, within a millionth of its size. As one emitter
/// it is sampled with less noise and in lanes.
std::optional<RectangleEmitter> rectangle_of(const TriangleEmitter& a, const TriangleEmitter& b);

// ---- The lights of a scene.

/// LightTraits::list of a light.
inline std::uint32_t list_of_light(const Scene& scene, std::size_t light) {
  return light < scene.light_traits.size() ? scene.light_traits[light].list : kNoId;
}
/// A list, as in LightTraits, as light sampling numbers it.
inline std::uint8_t light_list_number(std::uint32_t list) {
  return list < kMostLightLists ? static_cast<std::uint8_t>(list) : kNoLightList;
}

/// The sun of a sky.
DirectionalLight sun_of(const SkyLight& light);

/// The profiles of lights, aimed.
AimedProfile profile_of(const PointLight& light);
AimedProfile profile_of(const SpotLight& light);

/// All lights that can be sampled.
///
/// Surfaces that glow are sampled if they are triangles (of which two that follow each other and cover a
/// rectangle count as one emitter, unless they have a texture), spheres, disks or rectangles (polygons of
/// four corners) which no combination cuts, with a material without holes that no other solid can hide;
/// spheres and disks only without a texture of emission and if their transform keeps angles. Path tracing
/// samples only those that all bounces may meet, see Object::visible_to. All other glowing surfaces give
/// light to the paths that happen to meet them.
class SceneLights {
 public:
  /// The lights of `scene`, whose lights are filled in, and if the integrator samples them, of the glowing
  /// surfaces in `world`.
  /// `like`, which may be null, was made for the same scene at another moment: its environments are used
  /// again.
  SceneLights(const Scene& scene, const World& world, const SceneLights* like = nullptr);

  const LightSet& set() const { return set_; }
  /// The number of the emitter in set() whose surface was hit; kNoId if it is not sampled.
  std::uint32_t emitter_at(const Hit& hit) const;
  /// The surfaces of sampled emitters by themselves, in path tracing where shadow rays meet other objects
  /// than bounces; else null.
  const Accel* emitter_surfaces() const { return emitter_surfaces_.get(); }
  /// The hit in the world of a hit of emitter_surfaces().
  Hit world_hit(const Hit& hit) const;
  /// What the texture of emission makes of the light of a sample.
  Color texture_at(const LightSample& sample, const TextureSampler* textures) const;
  /// Whether rays that meet nothing can find more light than the background's.
  bool has_environment() const { return has_environment_; }

  /// The light group of an emitter of set().
  std::uint8_t group(std::uint32_t emitter) const { return groups_.empty() ? 0 : groups_[emitter]; }
  /// The light group of all infinite emitters that rays meet; nothing if these are in several.
  std::optional<std::uint8_t> environment_group() const;

 private:
  /// A triangle whose emission has a texture.
  struct TexturedEmitter {
    std::uint32_t emitter, texture, triangle;
    const TriangleMesh* mesh;
  };
  /// The primitive that an emitter shows, as in Hit.
  struct EmitterKey {
    std::uint32_t instance, item, emitter;
  };

  friend class EmitterCollector;

  LightSet set_;
  std::vector<std::uint8_t> groups_;       ///< of each emitter; empty if all are in the default group
  std::span<const Texture> texture_list_;  ///< Scene::textures
  std::vector<EmitterKey> keys_;           ///< ordered by instance and item
  std::vector<TexturedEmitter> textured_;  ///< ordered by emitter
  std::vector<std::shared_ptr<const EnvironmentMap>> environments_;  ///< in the order of their lights
  bool has_environment_ = false;
  std::shared_ptr<const Accel> emitter_surfaces_;
  std::vector<EmitterKey> surface_keys_;  ///< of each of their geometries: as in Hit, the first item
};

}  // namespace oktett
