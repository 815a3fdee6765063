/// \file Media in scene files.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/volume/density_file.h"
#include "io/volume/vdb_file.h"
#include "io/yaml/utf8.h"
#include "render/medium/density_noise.h"

namespace oktett {
namespace {

/// The box of a grid.
struct GridBox {
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};

  void describe(auto& p) {
    p.field("min", lo, "the corner of least x, y and z");
    p.field("max", hi, "the corner of greatest x, y and z");
    p.check(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z, nullptr, "expected 'min' below 'max' along each axis");
  }
};

/// The name of a grid in a file.
struct GridName {
  std::string text;
};
void read_value(SceneLoad& load, const YamlNode& node, const Range&, GridName& name) {
  name.text = load.values.text(node);
  if (name.text.empty()) throw Error(node.where(), "expected the name of a grid, found nothing");
}
std::string schema_of(Schema&, const Range&, const GridName&) { return Schema::text(); }

struct MediumKeys {
  Medium medium{};
  double density = 1;
  DensityNoise noise{};
  GridName grid_name{};
  GridBox bounds{};
  Affine transform{};

  static constexpr const char* kMap = "a medium";
  void describe(auto& p) {
    constexpr double most = 0.999;  // a float turned into a double would be shown with all its digits
    static_assert(static_cast<float>(most) == kMostAnisotropy);
    p.field("absorption", medium.absorption, "fraction of light absorbed per unit length");
    p.field("scattering", medium.scattering, "fraction of light scattered per unit length");
    p.field("emission", medium.emission, "radiance given off per unit length");
    p.field("anisotropy", medium.anisotropy, Range{-most, most}, "mean cosine of scattering");
    p.field("density", density, kNonNegative, "multiplies absorption, scattering and emission");
    p.choice("phase", medium.phase, kPhases,
             "`whitted`: which way light is scattered; others than the first have no anisotropy");
    p.field("extinction", medium.extinction, kNonNegative,
            "`whitted`: part of what is scattered that light loses");
    p.field("steps", medium.steps, whole(1, kMostMediumSteps),
            "`whitted`: places on a way where it is asked");
    p.optional("fade", medium.fade, "`whitted`: light that is lost by a power of the way");
    p.optional("map_density", TextureMap{medium.density_texture},
               "`whitted`: a pattern that multiplies them from place to place");
    p.optional("grid", ByHand{"file", "file"}, "densities that multiply them from place to place");
    p.optional("grid_name", grid_name, "which grid of an OpenVDB file");
    p.optional("noise", noise, "such densities, computed");
    p.field("bounds", bounds, "the box that the densities fill");
    p.optional("transform", transform, "of that box");
    for (const char* key : {"grid", "noise"})
      p.not_both("map_density", key, "a medium has either a 'map_density' or a 'grid' or 'noise'", key);
    p.not_both("grid", "noise", "a medium has either a 'grid' or 'noise'", "noise");
  }
};

/// The coefficient under `key`, times the density.
void scale_coefficient(const Fields& fields, const char* key, double density, Color& out) {
  out = Color(Vec3d(out) * density);
  if (fields[key] && max_component(out) > kMostCoefficient)
    throw Error(fields[key]->where(), fmt::format("expected numbers that times 'density' are at most {:g}",
                                                  static_cast<double>(kMostCoefficient)));
}

/// What an OpenVDB file says of a medium: its densities and where they are.
void read_vdb_grid(SceneLoad& load, const Fields& fields, const std::string& path, MediumKeys& keys) {
  if (const YamlNode* const bounds = fields["bounds"])
    throw Error(bounds->where(), "an OpenVDB file says where its grid is; 'transform' moves it");
  std::vector<Warning> warnings;
  PlacedDensities read = read_vdb(path, keys.grid_name.text, warnings);
  for (const Warning& warning : warnings) load.warn(warning.where, warning.message);
  if (const std::string reason = why_degenerate(read.place); !reason.empty())
    throw Error(Location{path}, "the place of the grid: " + reason);
  keys.medium.grid = std::move(read.grid), keys.medium.grid_place = read.place;
}

/// The grid of a medium and where it is.
void finish_grid(SceneLoad& load, const Fields& fields, MediumKeys& keys) {
  const YamlNode *file = fields["grid"], *transform = fields["transform"];
  const std::string path = file ? load.values.existing_file(*file) : std::string();
  const bool is_vdb = file && is_vdb_file(path);
  if (const YamlNode* const name = fields["grid_name"]; name && !is_vdb)
    throw Error(name->where(), "only a 'grid' that is an OpenVDB file (.vdb) has names");
  Medium& medium = keys.medium;
  if (const YamlNode* const map = fields["map_density"]) {
    if (!load.scene.textures[medium.density_texture].pattern)
      throw Error(map->where(), "expected a pattern, which has a value at each place in space");
    if (const YamlNode* const bounds = fields["bounds"])
      throw Error(bounds->where(), "a pattern has no bounds; only a medium with a 'grid' or 'noise' has");
  } else if (!file && !fields["noise"]) {
    if (const YamlNode* place = fields["bounds"] ? fields["bounds"] : transform)
      throw Error(place->where(), "only a medium with a 'grid', 'noise' or 'map_density' has a place");
    return;
  } else if (is_vdb) {
    read_vdb_grid(load, fields, path, keys);
  } else {
    medium.grid = file ? read_density_file(path) : density_of(keys.noise);
    const GridBox& box = keys.bounds;
    medium.grid_place = Affine::translation(box.lo) * Affine::scaling(box.hi - box.lo);
  }
  if (!transform) return;
  medium.grid_place = keys.transform * medium.grid_place;
  if (const std::string reason = why_degenerate(medium.grid_place); !reason.empty())
    throw Error(transform->where(), reason);
}

Medium read_medium(SceneLoad& load, const YamlNode& node, const std::string& name) {
  MediumKeys keys;
  const Fields fields = read_described(load, node, keys.kMap, keys);
  keys.medium.name = name;
  scale_coefficient(fields, "absorption", keys.density, keys.medium.absorption);
  scale_coefficient(fields, "scattering", keys.density, keys.medium.scattering);
  scale_coefficient(fields, "emission", keys.density, keys.medium.emission);
  finish_grid(load, fields, keys);
  return keys.medium;
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
  MediumName name{load.scene.medium};
  read_value(load, node, kAnyNumber, name);
  const Medium& m = load.scene.media[load.scene.medium];
  for (int c = 0; c < 3; ++c)
    if (!m.grid && m.emission[c] > 0 && m.absorption[c] + m.scattering[c] == 0)
      throw Error(node.where(), "medium " + quote(m.name) +
                                    " glows without absorbing or scattering light, so it would be infinitely "
                                    "bright around the whole scene");
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, MediumName& medium) {
  if (node.kind != YamlKind::scalar)
    throw Error(node.where(), "expected the name of a medium, found " + node.describe());
  const std::string name = load.values.text(node);
  const NameTable::Entry* entry = load.media.find(name);
  if (!entry) load.media.fail_unknown(name, node.where(), "medium");
  medium.index = entry->index;
}

std::string schema_of(Schema&, const Range&, const MediumName&) { return Schema::text(); }
std::string medium_schema(Schema&) { return Schema::text(); }
std::string media_schema(Schema& schema) {
  return Schema::entries(schema.map(MediumKeys::kMap, MediumKeys{}));
}

}  // namespace oktett
