/// \file The lights of scene files. Lamps that have an area become objects that glow.

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
#include "io/scene/utf8.h"
#include "render/light_groups.h"
#include "render/moments.h"

namespace oktett {
namespace {

constexpr auto kPi = static_cast<float>(std::numbers::pi);

/// The colour of a light: as `color`, or in a radiometric unit under another key, which is pi times as much.
void read_light_color(SceneLoad& load, const Fields& fields, const YamlNode& node, const char* radiometric,
                      Color& out) {
  const YamlNode *color = fields["color"], *unit = fields[radiometric];
  if (color && unit)
    throw Error(node.where(), std::string("expected 'color' or '") + radiometric + "', not both");
  load.values.read_color(color, out);
  if (!unit) return;
  load.values.read_color(unit, out);
  out *= 1 / kPi;
}

Vec3d read_direction(SceneLoad& load, const YamlNode& node) {
  const Vec3d direction = load.values.vector(node);
  if (direction == Vec3d{0, 0, 0}) throw Error(node.where(), "the direction must not be zero");
  return direction;
}

/// What is said of the light that was read last.
LightTraits& traits_of_last(SceneLoad& load) {
  load.scene.light_traits.resize(load.scene.lights.size());
  return load.scene.light_traits.back();
}

/// Adds a light and puts it into its group.
void add_light(SceneLoad& load, const Fields& fields, Light light) {
  load.scene.lights.push_back(std::move(light));
  if (const YamlNode* group = fields["light_group"])
    traits_of_last(load).group = read_light_group(load, *group);
}

/// Moves the light that was read last.
void read_light_motion(SceneLoad& load, const Fields& fields) {
  const YamlNode* node = fields["motion"];
  if (!node) return;
  Motion motion;
  motion.factors.push_back(read_motion(load.values, *node));
  if (!motion.moves()) {
    Light& last = load.scene.lights.back();
    last = moved_light(motion.at(0), last);
    return;
  }
  traits_of_last(load).motion = std::make_shared<const Motion>(std::move(motion));
}

/// The power of a lamp of greatest intensity 1.
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

/// `power` instead of a colour, for a light whose profile and angles have been read.
template <class PointOrSpot>
void read_power(SceneLoad& load, const Fields& fields, const YamlNode& node, PointOrSpot& light) {
  const YamlNode* power = fields["power"];
  if (!power) return;
  if (fields["color"] || fields["intensity"])
    throw Error(node.where(), "expected 'color', 'intensity' or 'power', not two of them");
  load.values.read_color(power, light.color);
  light.color *= static_cast<float>(1 / (std::numbers::pi * flux(light)));
}

/// The file of `profile`, if it is given, and what goes with it.
template <class PointOrSpot>
void read_profile(SceneLoad& load, const Fields& fields, PointOrSpot& light) {
  if (const YamlNode* file = fields["profile"]) {
    attempt(*file, [&] {
      light.profile =
          std::make_shared<const LightProfile>(read_light_profile(load.values.existing_file(*file)));
    });
    load.values.read(fields["rotate"], light.rotation, kAnyNumber);
  } else if (fields["rotate"] != nullptr) {
    throw Error(fields["rotate"]->where(), "'rotate' turns a 'profile', which is missing");
  }
}

void read_point(SceneLoad& load, const YamlNode& node) {
  const Fields fields(
      node, "a point light",
      {"position", "color", "intensity", "power", "falloff", "profile", "rotate", "motion", "light_group"});
  PointLight light;
  light.position = load.values.vector(fields.require("position"));
  read_light_color(load, fields, node, "intensity", light.color);
  read_profile(load, fields, light);
  read_power(load, fields, node, light);
  // An intensity means light that falls off.
  light.falloff = fields["intensity"] || fields["power"] || fields["profile"];
  load.values.read(fields["falloff"], light.falloff);
  if (!light.falloff && (fields["intensity"] || fields["power"]))
    throw Error(fields["falloff"]->where(),
                fmt::format("'{}' is that of a light that falls off; expected 'falloff: true', or 'color'",
                            fields["power"] ? "power" : "intensity"));
  add_light(load, fields, light);
  read_light_motion(load, fields);
}

void read_spot(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a spot light",
                      {"position", "direction", "at", "color", "intensity", "power", "inner_angle",
                       "outer_angle", "profile", "rotate", "motion", "light_group"});
  SpotLight light;
  light.position = load.values.vector(fields.require("position"));
  const YamlNode *direction = fields["direction"], *at = fields["at"];
  if (direction && at) throw Error(node.where(), "expected 'direction' or 'at', not both");
  if (direction) light.direction = read_direction(load, *direction);
  if (at) {
    light.direction = load.values.vector(*at) - light.position;
    if (light.direction == Vec3d{0, 0, 0}) throw Error(at->where(), "the light stands where it points to");
  }
  read_light_color(load, fields, node, "intensity", light.color);
  read_profile(load, fields, light);
  if (light.profile && (fields["inner_angle"] || fields["outer_angle"]))
    throw Error(node.where(), "expected 'profile' or angles, not both");
  load.values.read(fields["outer_angle"], light.outer_angle, {0, 180, true, false});
  light.inner_angle = 0.75 * light.outer_angle;
  load.values.read(fields["inner_angle"], light.inner_angle, {0, 180});
  if (light.inner_angle > light.outer_angle)
    throw Error(node.where(), "'inner_angle' is greater than 'outer_angle'");
  read_power(load, fields, node, light);
  add_light(load, fields, light);
  read_light_motion(load, fields);
}

void read_directional(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a directional light",
                      {"direction", "color", "irradiance", "angle", "motion", "light_group"});
  DirectionalLight light;
  if (const YamlNode* direction = fields["direction"]) light.direction = read_direction(load, *direction);
  read_light_color(load, fields, node, "irradiance", light.color);
  load.values.read(fields["angle"], light.angle, {0, 180});
  add_light(load, fields, light);
  read_light_motion(load, fields);
}

/// The radiance of a picture file of all directions.
std::shared_ptr<const EnvironmentPicture> read_environment_picture(SceneLoad& load, const YamlNode& node) {
  const Picture picture = read_image_file(load, node, [](const std::string& path) {
    Picture read = read_image(path);
    for (const char* plane : {"R", "G", "B"})
      if (read.find(plane) == nullptr) throw Error(path + ": the image has no colours");
    return read;
  });
  const PicturePlane* planes[3] = {picture.find("R"), picture.find("G"), picture.find("B")};
  EnvironmentPicture environment;
  environment.width = picture.width, environment.height = picture.height;
  environment.pixels.resize(std::size_t{picture.width} * picture.height);
  for (std::size_t i = 0; i < environment.pixels.size(); ++i)
    environment.pixels[i] = {planes[0]->values[i], planes[1]->values[i], planes[2]->values[i]};
  return std::make_shared<const EnvironmentPicture>(std::move(environment));
}

void read_environment(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "an environment", {"file", "color", "rotate", "light_group"});
  EnvironmentLight light;
  load.values.read_color(fields["color"], light.color);
  load.values.read(fields["rotate"], light.rotation, kAnyNumber);
  add_light(load, fields, std::move(light));
  const YamlNode& file = fields.require("file");
  attempt(file, [&] {
    std::get<EnvironmentLight>(load.scene.lights.back()).picture = read_environment_picture(load, file);
  });
}

void read_sky(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a sky", {"sun", "turbidity", "ground", "color", "light_group"});
  SkyLight light;
  if (const YamlNode* sun = fields["sun"]) light.sun = read_direction(load, *sun);
  load.values.read(fields["turbidity"], light.turbidity, {2, 10});
  load.values.read_color(fields["ground"], light.ground);
  load.values.read_color(fields["color"], light.color);
  add_light(load, fields, light);
}

/// The radiance of a diffuse lamp of `area` that gives off the power at `node`: power / (pi * area). Throws
/// Error if single precision has no such number, or if the lamp is so small that the solid angle in which it
/// is seen from 10 000 away has none.
Color radiance_of_power(SceneLoad& load, const YamlNode& node, double area) {
  constexpr double kLeastArea = 1e-28;
  Color color;
  load.values.read_color(&node, color);
  for (int k = 0; k < 3; ++k) {
    if (!(color[k] > 0)) continue;
    if (area < kLeastArea)
      throw Error(
          node.where(),
          fmt::format("the lamp is too small: its area is {:.2g}, and at least {:.0g} is expected with "
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

/// Warns of a lamp that is seen, but lights nothing.
void warn_of_idle_lamp(SceneLoad& load, const YamlNode& node) {
  const IntegratorSettings& s = load.scene.integrator;
  const IntegratorKind kind = load.integrator.value_or(s.kind);
  if (traits(kind).light_from_points && s.light_samples == 0)
    load.warn(node.where(),
              "the lamp lights nothing: 'whitted' needs 'light_samples' for lamps of some size");
}

/// Adds an object that glows, of `area`. It is given `radiance`, or `power` in all.
void add_glowing(SceneLoad& load, const Fields& fields, const YamlNode& node, Shape shape, double area) {
  const YamlNode *radiance = fields["radiance"], *power = fields["power"];
  if (radiance && power) throw Error(node.where(), "expected 'radiance' or 'power', not both");
  warn_of_idle_lamp(load, node);
  Material m;
  m.color = {0, 0, 0}, m.ambient = m.diffuse = 0;
  m.emission = {1, 1, 1};
  m.emits_behind = false;
  if (const YamlNode* group = fields["light_group"]) m.light_group = read_light_group(load, *group);
  load.values.read_color(radiance, m.emission);
  if (power) m.emission = radiance_of_power(load, *power, area);
  load.scene.materials.push_back(std::move(m));
  Object object;
  object.shape = std::move(shape);
  object.material = static_cast<std::uint32_t>(load.scene.materials.size() - 1);
  object.where = node.where();
  if (const YamlNode* motion = fields["motion"]) {
    Motion moved;
    moved.factors.push_back(read_motion(load.values, *motion));
    object.transform = moved.at(0);
    if (moved.moves()) object.motion = std::make_shared<const Motion>(std::move(moved));
  }
  load.scene.objects.push_back(std::move(object));
}

void read_sphere_light(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a sphere light",
                      {"center", "radius", "radiance", "power", "motion", "light_group"});
  SphereShape sphere;
  sphere.center = load.values.vector(fields.require("center"));
  load.values.read(fields["radius"], sphere.radius, kPositive);
  add_glowing(load, fields, node, sphere, 4 * std::numbers::pi * sphere.radius * sphere.radius);
}

void read_disk_light(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a disk light",
                      {"center", "normal", "radius", "radiance", "power", "motion", "light_group"});
  DiskShape disk;
  disk.normal = {0, -1, 0};
  disk.center = load.values.vector(fields.require("center"));
  if (const YamlNode* normal = fields["normal"]) disk.normal = read_direction(load, *normal);
  load.values.read(fields["radius"], disk.radius, kPositive);
  add_glowing(load, fields, node, disk, std::numbers::pi * disk.radius * disk.radius);
}

void read_rectangle_light(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "a rectangle light",
                      {"corner", "u", "v", "radiance", "power", "motion", "light_group"});
  const Vec3d corner = load.values.vector(fields.require("corner"));
  const Vec3d u = load.values.vector(fields.require("u")), v = load.values.vector(fields.require("v"));
  const double area = length(u) * length(v);
  if (!(area > 0)) throw Error(node.where(), "the edges 'u' and 'v' must not be zero");
  if (std::abs(dot(u, v)) > 1e-6 * area)
    throw Error(node.where(), "the edges 'u' and 'v' must be perpendicular");
  add_glowing(load, fields, node, PolygonShape{{corner, corner + u, corner + u + v, corner + v}}, area);
}

struct LightKind {
  const char* key;
  void (*read)(SceneLoad&, const YamlNode&);
};
constexpr LightKind kLightKinds[] = {{"point", read_point},
                                     {"spot", read_spot},
                                     {"directional", read_directional},
                                     {"environment", read_environment},
                                     {"sky", read_sky},
                                     {"sphere", read_sphere_light},
                                     {"disk", read_disk_light},
                                     {"rectangle", read_rectangle_light}};

}  // namespace

// A layer is called light_NAME.R; EXR files hold names of up to 255 characters.
static constexpr std::size_t kLongestLightGroup = 247;

std::string read_light_group(SceneLoad& load, const YamlNode& node) {
  std::string name = load.values.text(node, "^[A-Za-z0-9_-]{1,247}$");
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
  if (name == kDefaultLightGroup) return {};
  load.light_groups.insert(name);
  // The default group is one more.
  if (load.light_groups.size() >= kMostLightGroups)
    throw Error(node.where(), fmt::format("there are more than {} light groups", kMostLightGroups - 1));
  return name;
}

void read_lights(SceneLoad& load, const YamlNode& node) {
  load.scene.lights_given = true;
  std::vector<const char*> keys;
  for (const LightKind& kind : kLightKinds) keys.push_back(kind.key);
  for (const YamlNode* item : list_items(node, "lights"))
    attempt(*item, [&] {
      const Fields fields(*item, "a light", keys);
      declare_one_of(*item, {keys.begin(), keys.end()});
      const std::vector<MapEntry> entries = map_entries(*item, "a light");
      if (entries.size() != 1)
        throw Error(item->where(),
                    "expected one of point, spot, directional, environment, sky, sphere, disk and rectangle");
      for (const LightKind& kind : kLightKinds)
        if (entries[0].key->text == kind.key) kind.read(load, *entries[0].value);
    });
}

}  // namespace oktett
