#pragma once
/// \file Things that give light. Each is data; the functions below sample them.
///
/// Radiance, intensity and irradiance are per colour channel, see light_sample.h.

#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <variant>

#include "core/vec3.h"
#include "render/light/environment_map.h"
#include "render/light/light_fade.h"
#include "render/light/light_profile.h"
#include "render/light/light_sample.h"
#include "render/light/light_tree.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- A profile on an emitter that points somewhere.

/// A profile and where its angles count from; without a profile the same in all directions.
struct AimedProfile {
  std::shared_ptr<const LightProfile> profile = nullptr;
  Vec3d down{0, -1, 0};  ///< unit; vertical angles count from here
  Vec3d zero{1, 0, 0};   ///< unit, perpendicular to `down`: horizontal angle 0

  /// The factor on the intensity in the unit vector `direction` away from the emitter.
  float operator()(const Vec3d& direction) const;
};

/// The profile aimed along `down`, not zero, and turned about that by `rotation` degrees. Horizontal angles
/// count from +x, counter-clockwise as seen from above, if `down` points down; else they are turned with it
/// by the shortest way.
AimedProfile aim(std::shared_ptr<const LightProfile> profile, const Vec3d& down, double rotation);

// ---- Emitters.

/// The front is the side from which the corners run counter-clockwise. Directions are uniform over the
/// spherical triangle (Arvo 1995).
struct TriangleEmitter {
  Vec3f a, b, c;
  Color radiance;
  bool both_sides = false;  ///< false: only the front gives light
};

/// A parallelogram whose front is where cross(edge_u, edge_v) points. Directions are uniform over the
/// spherical rectangle (Urena 2013) if the edges are perpendicular; else points are uniform over the area.
struct RectangleEmitter {
  Vec3f corner, edge_u, edge_v;
  Color radiance;
  bool both_sides = false;
};

/// Points are uniform over the area; close to the disk, half of the directions are uniform over the largest
/// circle in it around the place below the point.
struct DiskEmitter {
  Vec3f center;
  Vec3f normal;  ///< unit; points to the front
  float radius;
  Color radiance;
  bool both_sides = false;
};

/// Directions are uniform over the sphere as it is seen, from inside as from outside.
struct SphereEmitter {
  Vec3f center;
  float radius;
  Color radiance;
  bool both_sides = false;  ///< false: the inside is dark
};

struct PointEmitter {
  Vec3f position;
  Color intensity;
  /// False: it lights each point, however far, with the irradiance `intensity`.
  bool falloff = true;
  AimedProfile profile = {};
  LightFade fade = {};
};

/// A point that gives light into a cone. Between the two angles the intensity falls as 3 t^2 - 2 t^3, where t
/// goes from 1 to 0 linearly in the cosine.
struct SpotEmitter {
  Vec3f position;
  Vec3f axis;  ///< unit vector along the middle of the cone
  Color intensity;
  float cos_inner = 1;  ///< cosine of the angle to the axis up to which the intensity is full
  float cos_outer = 0;  ///< cosine of the angle beyond which it is dark, < cos_inner
  bool falloff = true;  ///< as of PointEmitter
  LightFade fade = {};
  double tightness = 0;  ///< power of the cosine to the axis that multiplies the intensity
};

/// Light from infinitely far away: from one direction, or from a disk in the sky.
struct DirectionalEmitter {
  /// Sets the first three members, and the others from them.
  DirectionalEmitter(const Vec3f& towards, const Color& facing, float diameter = 0);

  Vec3f direction;   ///< unit vector towards the light
  Color irradiance;  ///< on a surface that faces the light
  float angle;       ///< angular diameter in radians, [0, pi]; 0 if the radiance would be no finite float
  // Of the disk, if the angle is not 0:
  double height = 0;  ///< 1 - cosine of the angular radius
  Color radiance;
};

/// Light from all directions.
struct EnvironmentEmitter {
  std::shared_ptr<const EnvironmentMap> map;
};

using Emitter = std::variant<TriangleEmitter, RectangleEmitter, DiskEmitter, SphereEmitter, PointEmitter,
                             SpotEmitter, DirectionalEmitter, EnvironmentEmitter>;

/// Chooses a direction to the emitter. Nothing if the emitter cannot light the point. The sample's `emitter`
/// is 0 and its pdf that of this emitter alone.
std::optional<LightSample> sample_emitter(const Emitter& emitter, const LightPoint& point,
                                          const SquareSample& s);

/// The density, per solid angle, with which sample_emitter chooses the unit vector `direction`, in which the
/// emitter is at `distance`; the direction must meet the emitter. 0 for emitters that are seen as points, and
/// where the emitter does not light the point. For infinite emitters the distance does not matter, and
/// the direction may miss.
float emitter_pdf(const Emitter& emitter, const LightPoint& point, const Vec3f& direction, float distance);

/// sample_emitter and emitter_pdf for a point on the emitter's own surface, wherever rounding has moved it:
/// flat emitters do not light themselves, and spheres only from within.
std::optional<LightSample> sample_own_emitter(const Emitter& emitter, const LightPoint& point,
                                              const SquareSample& s);
float own_emitter_pdf(const Emitter& emitter);

/// A vector perpendicular to the surface of an emitter at a place on it, not normalised; zero for emitters
/// that have no surface.
Vec3d normal_at(const Emitter& emitter, const Vec3d& place);

/// Radiance of an infinite emitter in the unit vector `direction` away from the point; black for emitters
/// that have a place or are seen as points.
Color infinite_radiance(const Emitter& emitter, const Vec3f& direction);

/// Where the light of an emitter that has a place comes from and goes. Nothing for emitters whose light does
/// not depend on the distance, and for emitters of no area or no power: those with a NaN or infinite number,
/// too.
std::optional<LightBounds> light_bounds(const Emitter& emitter);

/// The mean of the channels of the irradiance by an emitter without place on a surface that faces it; for an
/// environment, averaged over all orientations. 0 for other emitters, and where that is not finite.
double distant_irradiance(const Emitter& emitter);

/// The importance of a colour: the mean of its channels, negative ones taken as 0; 0 if not finite.
float color_weight(const Color& c);

}  // namespace oktett
