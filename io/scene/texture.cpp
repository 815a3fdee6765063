/// \file The textures of scene files: images, patterns (pattern.cpp), and attributes of meshes.

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"

namespace oktett {
namespace {

/// [u, v] or [u, v, w], and for a scale also one number for all axes.
struct Layout {
  Vec3f& value;
  bool single_number;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Layout& layout) {
  Vec3f& out = layout.value;
  double v[3] = {out.x, out.y, out.z};
  if (layout.single_number && node.kind == YamlKind::scalar)
    v[0] = v[1] = v[2] = load.values.number(node);
  else
    load.values.numbers(node, {v, node.kind == YamlKind::sequence && node.items.size() == 3 ? 3u : 2u});
  out = static_cast<Vec3f>(Vec3d{v[0], v[1], v[2]});
}

std::string schema_of(Schema&, const Range&, const Layout& layout) {
  std::vector<std::string> forms{Schema::numbers(2), Schema::vector()};
  if (layout.single_number) forms.insert(forms.begin(), Schema::number(kAnyNumber));
  return Schema::any_of(forms);
}

/// What a texture has besides its pattern or image.
struct TexelKeys {
  float &gain, &base;

  void describe(auto& p) {
    p.field("gain", gain, "multiplies the texel");
    p.field("base", base, "is added to it then");
  }
};

/// What images and attributes have.
struct ChannelKeys {
  ImageChannel& channel;

  void describe(auto& p) {
    p.choice("channel", channel,
             {{"red", ImageChannel::red},
              {"green", ImageChannel::green},
              {"blue", ImageChannel::blue},
              {"alpha", ImageChannel::alpha},
              {"luminance", ImageChannel::luminance}},
             "what a number is taken from");
  }
};

constexpr const char* kAttributeMeaning = "instead of an image: numbers of the mesh, such as `color`";

struct ImageKeys {
  Texture& texture;
  bool clamp = false, mirror = false;
  double rotate = 0;

  void describe(auto& p) {
    p.optional("file", FilePath{texture.path}, "the image");
    p.optional("scale", Layout{texture.scale, true}, "multiplies texture coordinates");
    p.optional("offset", Layout{texture.offset, false}, "added to them then");
    p.field("rotate", rotate, kAngle, "degrees by which they are turned before that, counter-clockwise");
    p.field("clamp", clamp, "extends the edge instead of repeating");
    p.field("mirror", mirror, "repeats the image and its mirror image in turn");
    p.not_both("clamp", "mirror", "an image is either clamped or mirrored", "mirror");
    p.choice("filter", texture.lookup.magnified,
             {{"linear", TextureFilter::linear}, {"nearest", TextureFilter::nearest}},
             "close up: blends its pixels, or shows each as a square");
    ChannelKeys{texture.channel}.describe(p);
    p.choice(
        "color_space", texture.color_space,
        {{"auto", TextureColors::of_file}, {"srgb", TextureColors::srgb}, {"linear", TextureColors::linear}},
        "how colours are encoded, whatever the file says");
  }
  /// Sets what is not read in place.
  void finish() {
    const TextureWrap wrap = clamp ? TextureWrap::clamp : mirror ? TextureWrap::mirror : TextureWrap::repeat;
    texture.lookup.u = texture.lookup.v = wrap;
    texture.rotation = static_cast<float>(rotate * (std::numbers::pi / 180));
  }
};

/// The index of the texture, which is added if it is new; `place`: where it is named.
std::uint32_t add_texture(SceneLoad& load, const Texture& texture, const Location& place) {
  const std::uint32_t index = load.textures.add(texture);
  std::vector<Location>& places = load.scene.texture_places;
  if (index >= places.size()) {
    places.resize(index);
    places.push_back(place);
  }
  return index;
}

std::string attribute_name(SceneLoad& load, const YamlNode& node) {
  std::string name = load.values.text(node);
  if (name.empty()) throw Error(node.where(), "expected the name of an attribute of meshes, found nothing");
  return name;
}

}  // namespace

std::uint32_t read_texture(SceneLoad& load, const YamlNode& node) {
  Texture texture;
  if (node.kind != YamlKind::map) {
    texture.path = load.values.existing_file(node);
    return add_texture(load, texture, node.where());
  }
  ImageKeys image{texture};
  TexelKeys texel{texture.gain, texture.base};
  std::vector<const char*> keys = KeyList(image).keys;
  keys.push_back("attribute");
  visit_patterns([&]<class P>(const P&) { keys.push_back(P::kShapeInfo.key); });
  std::ranges::copy(KeyList(texel).keys, std::back_inserter(keys));
  const Fields fields(node, "a texture", keys);
  // A pattern stands alone but for gain and base, an attribute but for these and a channel.
  const std::vector<MapEntry> entries = map_entries(node, "a texture");
  for (const MapEntry& entry : entries) {
    texture.pattern = read_pattern(load, entry.key->text, *entry.value);
    if (entry.key->text == "attribute") texture.attribute = attribute_name(load, *entry.value);
    const bool is_attribute = !texture.attribute.empty();
    if (!texture.pattern && !is_attribute) continue;
    for (const MapEntry& other : entries)
      if (&other != &entry && other.key->text != "gain" && other.key->text != "base" &&
          !(is_attribute && other.key->text == "channel"))
        throw Error(other.key->where(),
                    quote(other.key->text) + " has no meaning beside " + quote(entry.key->text));
    break;
  }
  ParameterReader reader(load, node, fields);
  const bool is_image = !texture.pattern && texture.attribute.empty();
  const Location place = is_image ? fields.require("file").where() : node.where();
  if (is_image) image.describe(reader), image.finish();
  if (!texture.attribute.empty()) ChannelKeys{texture.channel}.describe(reader);
  texel.describe(reader);
  const std::uint32_t index = add_texture(load, texture, place);
  if (texture.pattern) check_nesting(load, index, node.where());
  return index;
}

std::string texture_schema(Schema& schema) {
  return schema.define("a texture", typeid(Texture), [&] {
    SchemaMap map(schema);
    Texture usual;
    ImageKeys{usual}.describe(map);
    map.one_of({"file"});
    map.add_one_of("attribute", kAttributeMeaning, Schema::text());
    visit_pattern_schemas(schema, [&](const ShapeInfo& info, const std::string& text) {
      map.add_one_of(info.key, info.meaning, text);
    });
    TexelKeys{usual.gain, usual.base}.describe(map);
    return map.text();
  });
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, FilePath& file) {
  file.path = load.values.existing_file(node);
}
std::string schema_of(Schema&, const Range&, const FilePath&) { return Schema::file(); }

// A map is a texture, and so is a file where no other value may stand.
void read_value(SceneLoad& load, const YamlNode& node, const Range&, TextureMap& map) {
  if (map.multiplies && map.texture != kNoId)
    throw Error(node.where(),
                "this texture multiplies a value that is a texture itself; expected one of them");
  map.texture = read_texture(load, node);
}
std::string schema_of(Schema& schema, const Range&, const TextureMap&) {
  return Schema::any_of({Schema::file(), texture_schema(schema)});
}

// Within patterns.
void read_value(SceneLoad& load, const YamlNode& node, const Range&, TextureIndex& texture) {
  texture.index = read_texture(load, node);
}
std::string schema_of(Schema& schema, const Range&, const TextureIndex&) {
  return Schema::any_of({Schema::file(), texture_schema(schema)});
}

void read_value(SceneLoad& load, const YamlNode& node, const Range& range, Textured<float>& number) {
  if (node.kind != YamlKind::map) {
    number.value = load.values.single(node, range);
    return;
  }
  number.value = 1;
  number.texture = read_texture(load, node);
}
std::string schema_of(Schema& schema, const Range& range, const Textured<float>&) {
  return Schema::any_of({Schema::number(range), texture_schema(schema)});
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Textured<Color>& color) {
  if (node.kind != YamlKind::map) {
    color.value = load.values.color(node);
    return;
  }
  color.value = {1, 1, 1};
  color.texture = read_texture(load, node);
}
std::string schema_of(Schema& schema, const Range& range, const Textured<Color>& color) {
  return Schema::any_of({schema_of(schema, range, color.value), texture_schema(schema)});
}

}  // namespace oktett
