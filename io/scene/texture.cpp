/// \file The textures of scene files: images, and patterns.

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "io/scene/readers.h"
#include "io/scene/shape_reader.h"
#include "io/scene/utf8.h"

namespace oktett {
namespace {

constexpr const char* kImageKeys[] = {"file", "scale", "offset", "clamp", "channel"};
/// Most colours of a pattern.
constexpr std::size_t kMostColors = 64;

/// One number for all axes, [u, v], or [u, v, w].
void read_layout(SceneValues& values, const YamlNode* node, Vec3f& out, bool single_number) {
  if (!node) return;
  double v[3] = {out.x, out.y, out.z};
  if (single_number && node->kind == YamlKind::scalar)
    v[0] = v[1] = v[2] = values.number(*node);
  else
    values.numbers(*node, {v, node->kind == YamlKind::sequence && node->items.size() == 3 ? 3u : 2u});
  out = static_cast<Vec3f>(Vec3d{v[0], v[1], v[2]});
}

std::vector<Color> read_colors(SceneLoad& load, const YamlNode& node) {
  std::vector<Color> colors;
  declare_count(node, {1, kMostColors});
  for (const YamlNode* item : list_items(node, "colors")) colors.push_back(load.values.color(*item));
  if (colors.empty() || colors.size() > kMostColors)
    throw Error(node.where(), fmt::format("expected 1 to {} colors, found {}", kMostColors, colors.size()));
  return colors;
}

template <class P>
PatternTexture read_pattern_of(SceneLoad& load, const YamlNode& node, P pattern) {
  KeyList known(pattern);
  known.keys.insert(known.keys.end(), std::begin(kPatternKeys), std::end(kPatternKeys));
  const Fields fields(node, P::kSurface.key, known.keys);
  ParameterReader reader(load, node, fields);
  pattern.describe(reader);
  PatternTexture texture;
  texture.pattern = pattern;
  if (const YamlNode* colors = fields["colors"]) texture.colors = read_colors(load, *colors);
  if (const YamlNode* transform = fields["transform"]) {
    const Affine to_object = read_transform(load.values, *transform);
    if (!to_object.is_invertible())
      throw Error(transform->where(), "expected a map with an inverse, found a singular one");
    texture.to_pattern = to_object.inverse();
  }
  return texture;
}

/// The pattern of this name, if there is one.
std::optional<PatternTexture> read_pattern(SceneLoad& load, const std::string& name, const YamlNode& node) {
  std::optional<PatternTexture> texture;
  visit_patterns([&](auto pattern) {
    if (name == decltype(pattern)::kSurface.key) texture = read_pattern_of(load, node, pattern);
  });
  return texture;
}

void read_image(SceneLoad& load, const Fields& fields, Texture& texture) {
  SceneValues& values = load.values;
  texture.path = values.existing_file(fields.require("file"));
  read_layout(values, fields["scale"], texture.scale, true);
  read_layout(values, fields["offset"], texture.offset, false);
  values.read(fields["clamp"], texture.clamp);
  if (const YamlNode* channel = fields["channel"])
    texture.channel = values.choice<ImageChannel>(*channel, {{"red", ImageChannel::red},
                                                             {"green", ImageChannel::green},
                                                             {"blue", ImageChannel::blue},
                                                             {"alpha", ImageChannel::alpha}});
}

}  // namespace

/// The index of the texture, which is added if it is new; `place`: where it is named.
static std::uint32_t add_texture(SceneLoad& load, const Texture& texture, const Location& place) {
  const std::uint32_t index = load.textures.add(texture);
  std::vector<Location>& places = load.scene.texture_places;
  if (index >= places.size()) {
    places.resize(index);
    places.push_back(place);
  }
  return index;
}

static std::uint32_t read_texture(SceneLoad& load, const YamlNode& node) {
  SceneValues& values = load.values;
  Texture texture;
  if (node.kind != YamlKind::map) {
    texture.path = values.existing_file(node);
    return add_texture(load, texture, node.where());
  }
  std::vector<const char*> keys(std::begin(kImageKeys), std::end(kImageKeys));
  std::vector<std::string> sources{"file"};
  visit_patterns([&](const auto& pattern) {
    keys.push_back(std::decay_t<decltype(pattern)>::kSurface.key);
    sources.emplace_back(keys.back());
  });
  keys.insert(keys.end(), {"gain", "base"});
  const Fields fields(node, "a texture", keys);
  declare_one_of(node, sources);
  // A pattern stands alone but for gain and base.
  const std::vector<MapEntry> entries = map_entries(node, "a texture");
  for (const MapEntry& entry : entries) {
    texture.pattern = read_pattern(load, entry.key->text, *entry.value);
    if (!texture.pattern) continue;
    for (const MapEntry& other : entries)
      if (&other != &entry && other.key->text != "gain" && other.key->text != "base")
        throw Error(other.key->where(),
                    quote(other.key->text) + " has no meaning beside " + quote(entry.key->text));
    break;
  }
  if (!texture.pattern) read_image(load, fields, texture);
  values.read(fields["gain"], texture.gain, kAnyNumber);
  values.read(fields["base"], texture.base, kAnyNumber);
  return add_texture(load, texture, texture.pattern ? node.where() : fields.require("file").where());
}

void read_texture(SceneLoad& load, const YamlNode* node, std::uint32_t& out) {
  if (node) attempt(*node, [&] { out = read_texture(load, *node); });
}

}  // namespace oktett
