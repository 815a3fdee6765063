/// \file Media in scene files, and the keys of materials that say what is inside of a solid.

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/math.h"
#include "io/scene/density_file.h"
#include "io/scene/readers.h"
#include "io/scene/utf8.h"
#include "render/medium/density_noise.h"

namespace oktett {
namespace {

/// Greatest absorption, scattering and emission per unit length, after `density`.
constexpr float kMostCoefficient = 1e9f;
constexpr std::uint32_t kMostPriority = 1'000'000;

void read_coefficient(SceneLoad& load, const YamlNode* node, double density, Color& out) {
  load.values.read_color(node, out);
  out = Color(Vec3d(out) * density);
  if (node && max_component(out) > kMostCoefficient)
    throw Error(node->where(), fmt::format("expected numbers that times 'density' are at most {:g}",
                                           static_cast<double>(kMostCoefficient)));
}

DensityNoise read_noise(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "noise", {"size", "scale", "octaves", "threshold", "falloff", "seed"});
  SceneValues& values = load.values;
  DensityNoise noise;
  if (const YamlNode* size = fields["size"]) noise.size = values.integer(*size, 2, 512);
  values.read(fields["scale"], noise.scale, {0, 1e6, true});
  if (const YamlNode* octaves = fields["octaves"]) noise.octaves = values.integer(*octaves, 1, 12);
  values.read(fields["threshold"], noise.threshold, {0, 1, false, true});
  values.read(fields["falloff"], noise.falloff, kUnitInterval);
  if (const YamlNode* seed = fields["seed"])
    noise.seed = values.integer(*seed, 0, std::numeric_limits<std::uint32_t>::max());
  return noise;
}

/// The grid of a medium and where it is.
void read_grid(SceneLoad& load, const Fields& fields, Medium& medium) {
  const YamlNode *file = fields["grid"], *noise = fields["noise"];
  const YamlNode *bounds = fields["bounds"], *transform = fields["transform"];
  if (file && noise) throw Error(noise->where(), "a medium has either a 'grid' or 'noise'");
  if (!file && !noise) {
    if (const YamlNode* place = bounds ? bounds : transform)
      throw Error(place->where(), "only a medium with a 'grid' or 'noise' has a place");
    return;
  }
  medium.grid =
      file ? read_density_file(load.values.existing_file(*file)) : density_of(read_noise(load, *noise));
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};
  if (bounds) {
    const Fields corners(*bounds, "bounds", {"min", "max"});
    load.values.read(corners["min"], lo), load.values.read(corners["max"], hi);
    for (int axis = 0; axis < 3; ++axis)
      if (!(lo[axis] < hi[axis])) throw Error(bounds->where(), "expected 'min' below 'max' along each axis");
  }
  medium.grid_place = Affine::translation(lo) * Affine::scaling(hi - lo);
  if (!transform) return;
  medium.grid_place = read_transform(load.values, *transform) * medium.grid_place;
  if (const std::string reason = why_degenerate(medium.grid_place); !reason.empty())
    throw Error(transform->where(), reason);
}

Medium read_medium(SceneLoad& load, const YamlNode& node, const std::string& name) {
  const Fields fields(node, "a medium",
                      {"absorption", "scattering", "emission", "anisotropy", "density", "grid", "noise",
                       "bounds", "transform"});
  Medium medium;
  medium.name = name;
  double density = 1;
  load.values.read(fields["density"], density, kNonNegative);
  read_coefficient(load, fields["absorption"], density, medium.absorption);
  read_coefficient(load, fields["scattering"], density, medium.scattering);
  read_coefficient(load, fields["emission"], density, medium.emission);
  constexpr double most = 0.999;  // a float turned into a double would be shown with all its digits
  static_assert(static_cast<float>(most) == kMostAnisotropy);
  load.values.read(fields["anisotropy"], medium.anisotropy, {-most, most});
  read_grid(load, fields, medium);
  return medium;
}

std::uint32_t named_medium(SceneLoad& load, const YamlNode& node) {
  if (node.kind != YamlKind::scalar)
    throw Error(node.where(), "expected the name of a medium, found " + node.describe());
  const std::string name = load.values.text(node);
  if (const NameTable::Entry* medium = load.media.find(name)) return medium->index;
  load.media.fail_unknown(name, node.where(), "medium");
}

/// The medium that leaves `attenuation_color` of white light after `attenuation_distance`, as in glTF.
std::uint32_t read_attenuation(SceneLoad& load, const YamlNode* color_node, const YamlNode* distance_node) {
  if (!color_node || !distance_node)
    throw Error((color_node ? color_node : distance_node)->where(),
                "expected both 'attenuation_color' and 'attenuation_distance'");
  const Color color = load.values.color(*color_node);
  for (int c = 0; c < 3; ++c)
    if (!(color[c] > 0 && color[c] <= 1))
      throw Error(color_node->where(), "expected numbers greater than 0 and at most 1");
  const double distance = load.values.number(*distance_node, kPositiveLength);
  Medium medium;
  for (int c = 0; c < 3; ++c)
    medium.absorption[c] = std::min(
        kMostCoefficient, static_cast<float>(-portable::log(static_cast<double>(color[c])) / distance));
  load.scene.media.push_back(medium);
  return static_cast<std::uint32_t>(load.scene.media.size() - 1);
}

/// Throws Error if a material without a surface has keys that describe one.
void refuse_surface_keys(const YamlNode& node) {
  constexpr const char* kAllowed[] = {"surface", "interior", "priority"};
  for (const MapEntry& entry : map_entries(node, "a material"))
    if (std::ranges::find(kAllowed, entry.key->text) == std::end(kAllowed))
      throw Error(entry.key->where(), quote(entry.key->text) + " has no meaning beside 'surface: false'");
}

}  // namespace

void define_media(SceneLoad& load, const YamlNode& media) {
  for (const auto& [key, value] : map_entries(media, "media")) {
    const auto index = static_cast<std::uint32_t>(load.scene.media.size());
    attempt(*key, [&, k = key] { load.media.add(k->text, index, k->where(), "medium"); });
    Medium medium;
    attempt(*value, [&, k = key, v = value] { medium = read_medium(load, *v, k->text); });
    load.scene.media.push_back(std::move(medium));
  }
}

void read_outer_medium(SceneLoad& load, const YamlNode& node) {
  load.scene.medium = named_medium(load, node);
  const Medium& m = load.scene.media[load.scene.medium];
  for (int c = 0; c < 3; ++c)
    if (!m.grid && m.emission[c] > 0 && m.absorption[c] + m.scattering[c] == 0)
      throw Error(node.where(), "medium " + quote(m.name) +
                                    " glows without absorbing or scattering light, so it would be infinitely "
                                    "bright around the whole scene");
}

void read_interior(SceneLoad& load, const Fields& fields, const YamlNode& node, Material& m) {
  load.values.read(fields["surface"], m.surface);
  if (!m.surface) {
    refuse_surface_keys(node);
    m.ambient = m.diffuse = 0, m.transparency = 1, m.ior = 1, m.color = {1, 1, 1};
  }
  const YamlNode *interior = fields["interior"], *priority = fields["priority"];
  const YamlNode *color = fields["attenuation_color"], *distance = fields["attenuation_distance"];
  if (interior && (color || distance))
    throw Error((color ? color : distance)->where(), "a material has either an 'interior' or an attenuation");
  if (interior) m.interior = named_medium(load, *interior);
  if (color || distance) m.interior = read_attenuation(load, color, distance);
  if (priority) m.priority = static_cast<std::int32_t>(load.values.integer(*priority, 0, kMostPriority));
  const YamlNode* given = interior ? interior : color ? color : priority;
  if (given && m.transparency == 0)
    throw Error(given->where(),
                "no light enters this material; expected 'transparency', 'transmission' or 'surface: false' "
                "beside what is inside");
  if (given && m.principled && m.principled->parameters.thin)
    throw Error(given->where(), "thin glass has no inside");
}

}  // namespace oktett
