#pragma once
/// \file Hits that are shaded together, in columns: what the code of each instruction set works on.

#include <cstdint>

#include "accel/interaction_block.h"
#include "core/vec3.h"
#include "render/light/emitter.h"
#include "render/light/light_sample.h"

namespace oktett {

class RaisedPoints;

/// A light in the precision of shading.
struct LightSource {
  Vec3f place;  ///< position, or the unit vector towards a directional light
  Color color;
  bool directional = false;
  bool falloff = false;
  bool spot = false;
  bool glows = false;                  ///< a point of a glowing surface, whose light goes by Lambert's law
  std::uint8_t list = kNoLightList;    ///< bit of LightPoint::lists of what it lights
  Vec3f axis;                          ///< of a spot: unit vector along the middle of its cone; of a glowing
                                       ///< surface: the unit normal of its front
  float cos_inner = 1, cos_outer = 0;  ///< of a spot: cosines of the angles between which it fades
  float back = 0;  ///< of a glowing surface: the fraction of the front's light that the back gives, 0 or 1
  float lift = 0;  ///< of a glowing surface: shadow rays end this far above it
  AimedProfile profile = {};
  LightFade fade = {};
  bool from_place = false;  ///< of a directional light: `from` counts, and `beam`
  Vec3d from = {};
  LightBeam beam = {};
  double tightness = 0;        ///< of a spot
  bool shadows = true;         ///< things are in its way
  bool highlights = true;      ///< it shows Phong's highlights
  bool dimmed_by_fog = false;  ///< fog on its way takes light
};

/// What local shading needs of a material, in one cache line. Numbered like World::materials.
struct alignas(64) ShadingMaterial {
  static constexpr std::int16_t kAnyPower = -1;

  Color color, specular_color;
  Color unlit;  ///< light that needs no emitter: emission + color * ambient * ambient light
  float diffuse, specular, phong, reflection, transparency, ior;
  /// `phong` if highlights are raised to it by squaring, 0 if there are none, else kAnyPower.
  std::int16_t exponent;
  /// Colours, normal, emission or what light loses inside are known only at the hit. Such hits are finished
  /// one by one, not in lanes.
  bool varies;

  /// Whether it sends rays on.
  bool sends_rays() const { return reflection != 0 || transparency != 0; }
  /// Whether light that passes goes on as it came.
  bool passes_unbent() const { return transparency != 0 && ior == 1; }
  /// Whether its surfaces show no light but that of the rays that they send on.
  bool only_sends_rays() const { return !varies && diffuse == 0 && specular == 0 && unlit == Color{0, 0, 0}; }
};
static_assert(sizeof(ShadingMaterial) == 64);

/// Beside the hits' InteractionBlock: their rays and materials. Lanes read and write whole groups, so the
/// entries between the last hit and the end of its group must hold numbers, whatever their values.
struct ShadingColumns {
  static constexpr std::size_t kMost = InteractionBlock::kMost;
  static constexpr std::size_t kGroup = 16;  ///< the most lanes of any instruction set

  std::size_t count = 0;
  float cutoff = 0;               ///< IntegratorSettings::cutoff
  std::uint32_t ray[kMost];       ///< entry of the wavefront's rays
  std::uint32_t material[kMost];  ///< index of the ShadingMaterial

  float direction[3][kMost];         ///< unit direction in which the ray travels
  float throughput[3][kMost];        ///< of the ray, times the opacity of the surface
  float ng[3][kMost], ns[3][kMost];  ///< as in ShadingPoint
  float color[3][kMost], specular_color[3][kMost];
  float filter[3][kMost];  ///< of light that passes through hits that are `varying`; of others it is `color`
  float mirror_color[3][kMost];  ///< of hits that are `varying`; of others it is `specular_color`
  float diffuse[kMost], specular[kMost], phong[kMost], reflection[kMost], transparency[kMost];
  float brilliance[kMost], grain[kMost];      ///< of hits that are `uneven`; `grain` is what is taken there
  float specular_blinn[kMost], blinn[kMost];  ///< of hits that are `blinned`
  float diffuse_back[kMost];                  ///< of hits that are `lit_behind`
  float film[kMost], film_thickness[kMost];   ///< of hits that are `filmed`
  float eta[kMost];  ///< index of refraction behind the surface, as the ray sees it, relative to before it
  std::int32_t exponent[kMost];
  /// Bit k: the material of hit k `varies`, or `sends_rays`. Lanes after the last hit repeat its bits.
  std::uint64_t varying, sending;
  /// Bit k: light that passes hit k is not split by Fresnel's equations, see Material::fresnel. Of hits that
  /// are `varying` alone.
  std::uint64_t unsplit;
  /// Bit k: the diffuse light of hit k is not that of Lambert's law, or the hit has a highlight by Blinn. Of
  /// hits that are `varying` alone.
  std::uint64_t uneven, blinned;
  /// Bit k: lamps behind hit k light it; a film colours light there; the colours of its highlights fade. Of
  /// hits that are `varying` alone.
  std::uint64_t lit_behind, filmed, fading;

  RaisedPoints* raised = nullptr;  ///< of the hits
};

/// The mirrored or the refracted rays of hits; entry k leaves hit k.
struct BounceColumns {
  float origin[3][ShadingColumns::kMost], direction[3][ShadingColumns::kMost];
  float throughput[3][ShadingColumns::kMost];
  std::uint64_t sent = 0;  ///< bit k: hit k sends such a ray
};

/// The columns of the rays of a wavefront, of their hits and of the light that they find.
struct ArrivingRays {
  const float *direction[3], *throughput[3];
  const float *distance, *t;  ///< lengths of the paths to the rays' origins, and from there to the hits
  const std::uint32_t* sample;
  const std::uint8_t* bounces;
  float* radiance[3];
};

/// The columns of a queue of shadow rays. Rays are added behind the first `size`. One group of lanes more
/// than are added may be overwritten.
struct ShadowColumns {
  float *origin[3], *direction[3], *tmax, *light[3];
  std::uint32_t* owner;
  std::size_t size;
};

/// The columns of a queue of rays of the next bounce, likewise.
struct OnwardColumns {
  float *origin[3], *direction[3], *throughput[3], *distance;
  std::uint32_t* sample;
  std::uint8_t* bounces;
  std::size_t size;
};

}  // namespace oktett
