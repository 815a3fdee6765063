/// \file The lights of scene files. Emitters that have an area become objects that glow.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "core/math.h"
#include "io/image/image.h"
#include "io/photometry/ies_file.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"
#include "render/light_groups.h"
#include "render/moments.h"

namespace oktett {
namespace {

constexpr auto kPi = static_cast<float>(std::numbers::pi);

// A colour in a radiometric unit is pi times as much.
Color color_of_unit(Color unit) {
  unit *= 1 / kPi;
  return unit;
}

/// Adds a light, moved to where it stands all the time if its motion has only one key.
void add_light(SceneLoad& load, Light light, LightTraits traits) {
  if (traits.motion && !traits.motion->moves()) {
    light = moved_light(traits.motion->at(0), light);
    traits.motion = nullptr;
  }
  load.scene.lights.push_back(std::move(light));
  if (!traits.motion && traits.group.empty() && traits.list == kNoId && traits.shadows && traits.highlights &&
      !traits.dimmed_by_fog)
    return;
  load.scene.light_traits.resize(load.scene.lights.size());
  load.scene.light_traits.back() = std::move(traits);
}

/// The power of an emitter of greatest intensity 1.
double flux(const PointLight& light) {
  return light.profile ? profile_flux(*light.profile) : 4 * std::numbers::pi;
}
/// Between the angles of a spot the intensity is t^2 (3 - 2 t), t linear in the cosine: a half in the mean.
double flux(const SpotLight& light) {
  if (light.profile) return profile_flux(*light.profile);
  const double inner = portable::cos(light.inner_angle * kDegree);
  const double outer = portable::cos(light.outer_angle * kDegree);
  return 2 * std::numbers::pi * (1 - (inner + outer) / 2);
}

/// A file of a light profile.
struct ProfileFile {
  std::shared_ptr<const LightProfile>& profile;
};
void read_value(SceneLoad& load, const YamlNode& node, const Range&, ProfileFile& file) {
  file.profile = std::make_shared<const LightProfile>(read_light_profile(load.values.existing_file(node)));
}
std::string schema_of(Schema&, const Range&, const ProfileFile&) { return Schema::file(); }

// What lights of several kinds have.
constexpr const char* kWhite = "of a white surface that faces the light";
void describe_group(auto& p, std::string& group) {
  p.optional("light_group", LightGroupName{group}, "the layer that gets the light, too");
}
void describe_shared(auto& p, LightTraits& traits) {
  describe_group(p, traits.group);
  p.optional("only", LightListNames{traits.list, false}, "names of the objects that it lights");
  p.optional("except", LightListNames{traits.list, true}, "names of the objects that it does not light");
  p.not_both("only", "except");
}
void describe_traits(auto& p, LightTraits& traits) {
  p.optional("motion", traits.motion, "transforms of the light");
  describe_shared(p, traits);
}
/// Of lights that are points or parallel.
void describe_shadows(auto& p, LightTraits& traits) {
  p.field("shadows", traits.shadows, "`whitted`: whether things are in its way");
  p.field("highlights", traits.highlights, "`whitted`: whether it shows highlights");
  p.field("dimmed_by_fog", traits.dimmed_by_fog, "`whitted`: whether fog on its way takes light");
}
/// Warns where these mean nothing.
void check_shadows(SceneLoad& load, const Fields& fields, const LightTraits& traits) {
  const IntegratorKind kind = load.integrator.value_or(load.scene.integrator.kind);
  const bool path = oktett::traits(kind).traces_paths;
  load.warn_if_unused(fields, "shadows", path && !traits.shadows, "all light of 'path' has shadows");
  load.warn_if_unused(fields, "highlights", path && !traits.highlights, "all light of 'path' has highlights");
  load.warn_if_unused(fields, "dimmed_by_fog", path && traits.dimmed_by_fog, "there is no fog in 'path'");
}
void describe_direction(auto& p, const char* key, Vec3d& direction, const char* meaning) {
  p.field(key, direction, meaning);
  p.check(!(direction == Vec3d{0, 0, 0}), key, "the direction must not be zero");
}
/// What points and spots have.
template <class PointOrSpot>
struct EmitterColor {
  Color intensity{1, 1, 1}, power{1, 1, 1};

  void describe_color(auto& p, PointOrSpot& light) {
    p.field("color", light.color, kWhite);
    p.optional("intensity", intensity, "instead of `color`: W/sr");
    p.optional("power", power, "instead of `color`: W of the whole light");
    p.not_both("color", "intensity");
    for (const char* key : {"color", "intensity"})
      p.not_both(key, "power", "expected 'color', 'intensity' or 'power', not two of them");
  }
  void describe_fade(auto& p, PointOrSpot& light) {
    p.optional("fade", light.fade, "instead of `falloff`: how the light fades with the distance");
    for (const char* key : {"falloff", "intensity", "power"}) p.not_both("fade", key);
  }
  void describe_profile(auto& p, PointOrSpot& light) {
    p.optional("profile", ProfileFile{light.profile},
               "an IES file; its brightest direction has the intensity");
    p.field("rotate", light.rotation, "degrees by which the profile is turned about its axis");
  }
  /// For a light whose profile and angles have been read.
  void finish(const Fields& fields, PointOrSpot& light) const {
    if (fields["rotate"] && !fields["profile"])
      throw Error(fields["rotate"]->where(), "'rotate' turns a 'profile', which is missing");
    if (fields["intensity"]) light.color = color_of_unit(intensity);
    if (!fields["power"]) return;
    light.color = power;
    light.color *= static_cast<float>(1 / (std::numbers::pi * flux(light)));
  }
};

/// Throws Error if the light does not fall off, but has what only light has that does.
void check_falloff(const Fields& fields, const auto& light) {
  if (light.falloff || (!fields["intensity"] && !fields["power"])) return;
  throw Error(fields["falloff"]->where(),
              fmt::format("'{}' is that of a light that falls off; expected 'falloff: true', or 'color'",
                          fields["power"] ? "power" : "intensity"));
}

struct PointKeys {
  PointLight light{};
  EmitterColor<PointLight> color{};
  LightTraits traits{};

  static constexpr const char* kMap = "a point light";
  void describe(auto& p) {
    p.required("position", light.position, "where it stands");
    color.describe_color(p, light);
    p.field("falloff", light.falloff,
            "divides by the squared distance; `intensity`, `power` and `profile` set it");
    color.describe_fade(p, light);
    color.describe_profile(p, light);
    describe_shadows(p, traits);
    describe_traits(p, traits);
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode&, PointKeys& keys) {
  PointLight& light = keys.light;
  keys.color.finish(fields, light);
  // An intensity means light that falls off.
  const bool falls_off = fields["intensity"] || fields["power"];
  if (!fields["falloff"]) light.falloff = falls_off || (fields["profile"] && !fields["fade"]);
  check_falloff(fields, light);
  check_shadows(load, fields, keys.traits);
  add_light(load, light, keys.traits);
}

struct SpotKeys {
  SpotLight light{};
  Vec3d at{0, 0, 0};
  EmitterColor<SpotLight> color{};
  LightTraits traits{};

  static constexpr const char* kMap = "a spot light";
  void describe(auto& p) {
    p.required("position", light.position, "where it stands");
    describe_direction(p, "direction", light.direction, "along the middle of the cone");
    p.optional("at", at, "instead of `direction`: a point there");
    color.describe_color(p, light);
    p.field("falloff", light.falloff, "divides by the squared distance");
    color.describe_fade(p, light);
    p.optional("inner_angle", light.inner_angle, Range{0, 180},
               "where light begins to fade; 3/4 of the outer one if left out");
    p.field("outer_angle", light.outer_angle, Range{0, 180, true},
            "degrees from the middle where light ends");
    p.field("tightness", light.tightness, kNonNegative,
            "power of the cosine to the middle that multiplies the light");
    color.describe_profile(p, light);
    describe_shadows(p, traits);
    describe_traits(p, traits);
    p.not_both("direction", "at");
    p.not_both("tightness", "power");
    for (const char* key : {"inner_angle", "outer_angle", "tightness"})
      p.not_both("profile", key, "expected 'profile' or angles, not both");
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode& node, SpotKeys& keys) {
  SpotLight& light = keys.light;
  if (const YamlNode* at = fields["at"]) {
    light.direction = keys.at - light.position;
    if (light.direction == Vec3d{0, 0, 0}) throw Error(at->where(), "the light stands where it points to");
  }
  if (!fields["inner_angle"]) light.inner_angle = 0.75 * light.outer_angle;
  if (light.inner_angle > light.outer_angle)
    throw Error(node.where(), "'inner_angle' is greater than 'outer_angle'");
  if (fields["fade"]) light.falloff = false;
  check_falloff(fields, light);
  check_shadows(load, fields, keys.traits);
  keys.color.finish(fields, light);
  add_light(load, light, keys.traits);
}

struct DirectionalKeys {
  DirectionalLight light{};
  Vec3d from{0, 0, 0};
  Color irradiance{1, 1, 1};
  LightTraits traits{};

  static constexpr const char* kMap = "a directional light";
  void describe(auto& p) {
    describe_direction(p, "direction", light.direction, "of travel");
    p.field("color", light.color, kWhite);
    p.optional("irradiance", irradiance, "instead of `color`: W/m²");
    p.not_both("color", "irradiance");
    p.field("angle", light.angle, Range{0, 180}, "angular diameter in degrees");
    p.optional("from", from,
               "`whitted`: what lies behind the plane across the light through this point casts no shadow");
    p.optional("fade", light.fade, "`whitted`: how the light fades with the distance from that plane");
    p.optional("beam", light.beam, "`whitted`: how wide the light is about the line through `from`");
    describe_shadows(p, traits);
    describe_traits(p, traits);
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode&, DirectionalKeys& keys) {
  if (fields["irradiance"]) keys.light.color = color_of_unit(keys.irradiance);
  check_shadows(load, fields, keys.traits);
  if (fields["from"]) keys.light.from = keys.from;
  for (const char* key : {"fade", "beam"})
    if (fields[key] && !fields["from"])
      throw Error(fields[key]->where(), fmt::format("'{}' counts from a place: 'from' is missing", key));
  const bool path = traits(load.integrator.value_or(load.scene.integrator.kind)).traces_paths;
  for (const char* key : {"from", "fade", "beam"})
    load.warn_if_unused(fields, key, path, "parallel light of 'path' has no ends");
  add_light(load, keys.light, keys.traits);
}

/// An image of all directions.
struct EnvironmentFile {
  std::shared_ptr<const EnvironmentPicture>& picture;
};
void read_value(SceneLoad& load, const YamlNode& node, const Range&, EnvironmentFile& file) {
  file.picture =
      std::make_shared<const EnvironmentPicture>(read_named_file(load, node, read_environment_image));
}
std::string schema_of(Schema&, const Range&, const EnvironmentFile&) { return Schema::file(); }

struct EnvironmentKeys {
  EnvironmentLight light{};
  LightTraits traits{};

  static constexpr const char* kMap = "an environment";
  void describe(auto& p) {
    p.required("file", EnvironmentFile{light.picture}, "an image of all directions");
    p.field("color", light.color, "multiplies the image");
    p.field("rotate", light.rotation, "degrees about the y axis");
    describe_shared(p, traits);
  }
};

struct SkyKeys {
  SkyLight light{};
  LightTraits traits{};

  static constexpr const char* kMap = "a sky";
  void describe(auto& p) {
    describe_direction(p, "sun", light.sun, "towards the sun");
    p.field("turbidity", light.turbidity, Range{2, 10}, "from very clear to hazy");
    p.field("ground", light.ground, "colour below the horizon");
    p.field("color", light.color, "multiplies radiance in kcd/m²");
    describe_shared(p, traits);
  }
};

/// Of lights that need no more than they say.
template <class Keys>
void finish(SceneLoad& load, const Fields&, const YamlNode&, Keys& keys) {
  add_light(load, std::move(keys.light), keys.traits);
}

/// The radiance of a diffuse emitter of `area` that gives off the power `color`, given at `node`: power / (pi
/// * area). Throws Error if single precision has no such number, or if the emitter is so small that the solid
/// angle in which it is seen from 10 000 away has none.
Color radiance_of_power(Color color, const YamlNode& node, double area) {
  constexpr double kLeastArea = 1e-28;
  for (int k = 0; k < 3; ++k) {
    if (!(color[k] > 0)) continue;
    if (area < kLeastArea)
      throw Error(
          node.where(),
          fmt::format("the light is too small: its area is {:.2g}, and at least {:.0g} is expected with "
                      "a power; a 'point' light may have a power, too",
                      area, kLeastArea));
    const float radiance = color[k] * static_cast<float>(1 / (std::numbers::pi * area));
    if (!(radiance >= std::numeric_limits<float>::min() && radiance <= std::numeric_limits<float>::max()))
      throw Error(node.where(),
                  fmt::format("a power of {:.3g} over an area of {:.3g} is a radiance of {:.4g}; "
                              "expected one from {:.4g} to {:.4g}",
                              color[k], area, double(color[k]) / (std::numbers::pi * area),
                              std::numeric_limits<float>::min(), std::numeric_limits<float>::max()));
    color[k] = radiance;
  }
  return color;
}

/// Warns of a light that is seen but lights no other surface.
void warn_of_idle_emitter(SceneLoad& load, const YamlNode& node) {
  const IntegratorSettings& s = load.scene.integrator;
  const IntegratorKind kind = load.integrator.value_or(s.kind);
  if (traits(kind).light_from_points && s.light_samples == 0)
    load.warn(node.where(),
              "the light lights nothing: 'whitted' needs 'light_samples' for lights of some size");
}

/// What lights that are objects have.
struct Glow {
  Color radiance{1, 1, 1}, power{1, 1, 1};
  LightTraits traits{};
  std::uint8_t visible_to = kAllRays;

  void describe(auto& p) {
    p.field("radiance", radiance, "W/(m² sr)");
    p.optional("power", power, "instead of `radiance`: W of the whole light");
    p.not_both("radiance", "power");
    describe_traits(p, traits);
    p.optional("visible_to", RayKindSet{visible_to}, "the rays that meet it; all if left out");
  }
};

/// Adds an object that glows, of `area`.
void add_glowing(SceneLoad& load, const Fields& fields, const YamlNode& node, Glow& glow, Shape shape,
                 double area) {
  warn_of_idle_emitter(load, node);
  Material m;
  m.color = {0, 0, 0}, m.ambient = m.diffuse = 0;
  m.emission = glow.radiance;
  m.emits_behind = false;
  m.light_group = glow.traits.group;
  if (const YamlNode* power = fields["power"]) m.emission = radiance_of_power(glow.power, *power, area);
  load.scene.materials.push_back(std::move(m));
  Object object;
  object.shape = std::move(shape);
  object.material = static_cast<std::uint32_t>(load.scene.materials.size() - 1);
  object.where = node.where();
  object.visible_to = glow.visible_to, object.light_list = glow.traits.list;
  if (const MotionPointer& motion = glow.traits.motion) {
    object.transform = motion->at(0);
    if (motion->moves()) object.motion = motion;
  }
  load.scene.objects.push_back(std::move(object));
}

struct SphereLightKeys {
  SphereShape sphere{};
  Glow glow{};

  static constexpr const char* kMap = "a sphere light";
  void describe(auto& p) {
    p.required("center", sphere.center, "the centre");
    p.field("radius", sphere.radius, kPositive, "of the ball");
    glow.describe(p);
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode& node, SphereLightKeys& keys) {
  const SphereShape& sphere = keys.sphere;
  add_glowing(load, fields, node, keys.glow, sphere, 4 * std::numbers::pi * sphere.radius * sphere.radius);
}

struct DiskLightKeys {
  DiskShape disk{.normal = {0, -1, 0}};
  Glow glow{};

  static constexpr const char* kMap = "a disk light";
  void describe(auto& p) {
    p.required("center", disk.center, "the centre");
    describe_direction(p, "normal", disk.normal, "to the side that glows");
    p.field("radius", disk.radius, kPositive, "of the disk");
    glow.describe(p);
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode& node, DiskLightKeys& keys) {
  const DiskShape& disk = keys.disk;
  add_glowing(load, fields, node, keys.glow, disk, std::numbers::pi * disk.radius * disk.radius);
}

struct RectangleLightKeys {
  Vec3d corner{0, 0, 0}, u{1, 0, 0}, v{0, 1, 0};
  Glow glow{};

  static constexpr const char* kMap = "a rectangle light";
  void describe(auto& p) {
    p.required("corner", corner, "a corner");
    p.required("u", u, "an edge from there");
    p.required("v", v, "the other edge, perpendicular; the side to which u x v points glows");
    const double area = length(u) * length(v);
    p.check(area > 0, nullptr, "the edges 'u' and 'v' must not be zero");
    p.check(!(std::abs(dot(u, v)) > 1e-6 * area), nullptr, "the edges 'u' and 'v' must be perpendicular");
    glow.describe(p);
  }
};

void finish(SceneLoad& load, const Fields& fields, const YamlNode& node, RectangleLightKeys& keys) {
  const Vec3d &corner = keys.corner, &u = keys.u, &v = keys.v;
  add_glowing(load, fields, node, keys.glow, PolygonShape{{corner, corner + u, corner + u + v, corner + v}},
              length(u) * length(v));
}

template <class Keys>
void read_light(SceneLoad& load, const YamlNode& node) {
  Keys keys;
  const Fields fields = read_described(load, node, Keys::kMap, keys);
  finish(load, fields, node, keys);
}
template <class Keys>
std::string light_schema(Schema& schema) {
  return schema.map(Keys::kMap, Keys{});
}

struct LightKind {
  const char *key, *meaning;
  void (*read)(SceneLoad&, const YamlNode&);
  std::string (*schema)(Schema&);
};
template <class Keys>
constexpr LightKind light_kind(const char* key, const char* meaning) {
  return {key, meaning, read_light<Keys>, light_schema<Keys>};
}
constexpr LightKind kLightKinds[] = {light_kind<PointKeys>("point", "a point that shines in all directions"),
                                     light_kind<SpotKeys>("spot", "a point that shines into a cone"),
                                     light_kind<DirectionalKeys>("directional", "parallel light"),
                                     light_kind<EnvironmentKeys>("environment", "an image of all directions"),
                                     light_kind<SkyKeys>("sky", "the clear sky by day"),
                                     light_kind<SphereLightKeys>("sphere", "a ball that glows"),
                                     light_kind<DiskLightKeys>("disk", "a disk that glows"),
                                     light_kind<RectangleLightKeys>("rectangle", "a rectangle that glows")};

}  // namespace

// A layer is called light_NAME.R; EXR files hold names of up to 255 characters.
static constexpr std::size_t kLongestLightGroup = 247;

std::string schema_of(Schema&, const Range&, const LightGroupName&) {
  return Schema::matching(fmt::format("^[A-Za-z0-9_-]{{1,{}}}$", kLongestLightGroup));
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, LightGroupName& group) {
  const std::string name = load.values.text(node);
  if (!is_light_group_name(name))
    throw Error(node.where(),
                "a light group's name has letters, digits, '_' and '-' only, because layers of "
                "the picture are named after it; found " +
                    quote(name));
  if (name.size() > kLongestLightGroup)
    throw Error(node.where(),
                fmt::format("a light group's name has at most {} characters, because layers of the "
                            "picture are named after it; found {}",
                            kLongestLightGroup, name.size()));
  if (name == kDefaultLightGroup) {
    group.name.clear();
    return;
  }
  load.light_groups.insert(name);
  // The default group is one more.
  if (load.light_groups.size() >= kMostLightGroups)
    throw Error(node.where(), fmt::format("there are more than {} light groups", kMostLightGroups - 1));
  group.name = name;
}

void read_lights(SceneLoad& load, const YamlNode& node) {
  load.scene.lights_given = true;
  std::vector<const char*> keys;
  for (const LightKind& kind : kLightKinds) keys.push_back(kind.key);
  for (const YamlNode* item : list_items(node, "lights"))
    attempt(*item, [&] {
      const Fields fields(*item, "a light", keys);
      const std::vector<MapEntry> entries = map_entries(*item, "a light");
      if (entries.size() != 1)
        throw Error(item->where(),
                    "expected one of point, spot, directional, environment, sky, sphere, disk and rectangle");
      for (const LightKind& kind : kLightKinds)
        if (entries[0].key->text == kind.key) kind.read(load, *entries[0].value);
    });
}

std::string lights_schema(Schema& schema) { return Schema::list(schema.one_of("a light", kLightKinds)); }

}  // namespace oktett
