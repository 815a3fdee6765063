/// \file The patterns of scene files: what all kinds have beside their own keys.

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/volume/density_file.h"
#include "io/yaml/utf8.h"

namespace oktett {
namespace {

/// Most colours of a pattern, and most places of a map.
constexpr std::uint32_t kMostColors = 64, kMostPlaces = 256;
constexpr std::uint32_t kMostWarps = 64;
/// Most textures in a pattern, as often as each is shown.
constexpr std::size_t kMostShown = 4096;

/// A map with an inverse, which is what is kept.
struct InverseOf {
  Affine& inverse;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, InverseOf& map) {
  const Affine to_object = read_transform(load, node);
  if (!to_object.is_invertible())
    throw Error(node.where(), "expected a map with an inverse, found a singular one");
  map.inverse = to_object.inverse();
}

std::string schema_of(Schema& schema, const Range& range, const InverseOf&) {
  return schema_of(schema, range, Affine{});
}

// ---- Colours.

/// A colour, a number, which is a grey, or a texture.
template <class ColorOrTexture>
void read_color(SceneLoad& load, const YamlNode& node, ColorOrTexture& entry) {
  if (node.kind == YamlKind::map) {
    entry.texture.index = read_texture(load, node);
  } else if (node.kind == YamlKind::scalar && !load.values.text(node).starts_with('#')) {
    const float grey = load.values.single(node, kNonNegative);
    entry.color = {grey, grey, grey};
  } else {
    entry.color = load.values.color(node);
  }
}

std::string color_schema(Schema& schema) {
  return Schema::any_of({Schema::color(), Schema::number(kNonNegative), texture_schema(schema)});
}

void check_count(const YamlNode& node, std::size_t count, const Range& counts, const char* what) {
  if (counts.contains(static_cast<double>(count))) return;
  throw Error(node.where(), fmt::format("expected {} to {} {}, found {}", counts.lo, counts.hi, what, count));
}

/// Colours or textures in equal steps.
struct EvenColors {
  PatternTexture& texture;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range& counts, EvenColors& colors) {
  const auto items = list_items(node, "colors");
  check_count(node, items.size(), counts, "colors");
  std::vector<PatternEntry> entries(items.size());
  bool all_colors = true;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) entries[i].at = static_cast<double>(i) / static_cast<double>(items.size() - 1);
    attempt(*items[i], [&] { read_color(load, *items[i], entries[i]); });
    all_colors = all_colors && entries[i].texture == TextureIndex{};
  }
  PatternTexture& texture = colors.texture;
  if (!all_colors) {
    texture.map = std::move(entries);
    return;
  }
  texture.colors.clear();
  for (const PatternEntry& entry : entries) texture.colors.push_back(entry.color);
}

std::string schema_of(Schema& schema, const Range& counts, const EvenColors&) {
  return Schema::list(color_schema(schema), counts);
}

/// [place, colour] for ascending places.
struct PlacedColors {
  PatternTexture& texture;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range& counts, PlacedColors& colors) {
  const auto items = list_items(node, "map");
  check_count(node, items.size(), counts, "places");
  std::vector<PatternEntry>& map = colors.texture.map;
  const auto read_entry = [&](const YamlNode& item) {
    const auto parts = list_items(item, "a place of the map");
    if (parts.size() != 2)
      throw Error(item.where(), fmt::format("expected [place, color], found {} items", parts.size()));
    PatternEntry entry;
    entry.at = load.values.number(*parts[0], kUnitInterval);
    if (!map.empty() && entry.at < map.back().at)
      throw Error(parts[0]->where(),
                  fmt::format("the places of a map must ascend: expected at least {:g}", map.back().at));
    read_color(load, *parts[1], entry);
    map.push_back(entry);
  };
  for (const YamlNode* item : items) attempt(*item, [&] { read_entry(*item); });
}

std::string schema_of(Schema& schema, const Range& counts, const PlacedColors&) {
  // The schema of a list says nothing of single items.
  const std::string item = Schema::any_of({Schema::number(kUnitInterval), color_schema(schema)});
  return Schema::list(Schema::list(item, whole(2, 2)), counts);
}

// ---- Turbulence and warps.

/// Three numbers, or one for all axes.
struct Amount {
  Vec3d& value;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Amount& amount) {
  if (node.kind != YamlKind::scalar) {
    amount.value = load.values.vector(node);
    return;
  }
  const double number = load.values.number(node);
  amount.value = {number, number, number};
}

std::string schema_of(Schema&, const Range& range, const Amount&) {
  return Schema::any_of({Schema::number(range), Schema::vector()});
}

struct TurbulenceKeys {
  PatternTurbulence turbulence;

  static constexpr const char* kMap = "turbulence";
  static constexpr ShapeInfo kShapeInfo{"turbulence", "displaces places by noise"};
  void describe(auto& p) {
    p.optional("amount", Amount{turbulence.amount}, "how far, along each axis or along all");
    turbulence.describe(p);
  }
  Warp warp() const { return TurbulenceWarp{turbulence}; }
};

/// The map, or its amount alone.
struct TurbulenceValue {
  PatternTurbulence& turbulence;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range& range, TurbulenceValue& value) {
  if (node.kind != YamlKind::map) {
    Amount amount{value.turbulence.amount};
    read_value(load, node, range, amount);
    return;
  }
  TurbulenceKeys keys;
  read_described(load, node, TurbulenceKeys::kMap, keys);
  value.turbulence = keys.turbulence;
}

std::string schema_of(Schema& schema, const Range& range, const TurbulenceValue& value) {
  return Schema::any_of({schema_of(schema, range, Amount{value.turbulence.amount}),
                         schema.map(TurbulenceKeys::kMap, TurbulenceKeys{})});
}

/// A mapping around a figure, without the keys that only some figures have.
template <MappingWarp::Figure kFigure>
struct MappingKeys {
  MappingWarp mapping{kFigure, {0, 0, 1}, 0, 0, 1};

  using Figure = MappingWarp::Figure;
  static constexpr ShapeInfo kShapeInfo =
      kFigure == Figure::planar        ? ShapeInfo{"planar", "the plane of the pattern at all heights"}
      : kFigure == Figure::cylindrical ? ShapeInfo{"cylindrical", "the pattern around the y axis"}
      : kFigure == Figure::spherical   ? ShapeInfo{"spherical", "the pattern around the origin"}
                                       : ShapeInfo{"toroidal", "the pattern around a ring about the y axis"};
  void describe(auto& p) {
    p.field("orientation", mapping.orientation,
            "the axis of the pattern that points away from the figure, of any length but 0");
    p.check(length(mapping.orientation) > 0, "orientation", "the direction must not be zero");
    if constexpr (kFigure == Figure::planar)
      p.field("distance", mapping.distance, "what that axis shows");
    else
      p.field("exponent", mapping.exponent, Range{-100, 100},
              "multiplies the pattern by this power of the distance");
    if constexpr (kFigure == Figure::toroidal)
      p.field("major_radius", mapping.major_radius, kLength, "of the circle in the middle of the ring");
  }
  Warp warp() const {
    MappingWarp result = mapping;
    result.orientation = normalize(mapping.orientation);
    return result;
  }
};

/// Calls what(keys) for the keys of each kind of warp that has some, with its defaults.
template <class What>
void visit_warps(const What& what) {
  using Figure = MappingWarp::Figure;
  what(BlackHoleWarp{}), what(RepeatWarp{}), what(TurbulenceKeys{});
  what(MappingKeys<Figure::planar>{}), what(MappingKeys<Figure::cylindrical>{});
  what(MappingKeys<Figure::spherical>{}), what(MappingKeys<Figure::toroidal>{});
}

struct WarpList {
  std::vector<Warp>& warps;
};

Warp read_warp(SceneLoad& load, const YamlNode& node) {
  std::vector<const char*> known;
  visit_warps([&]<class W>(const W&) { known.push_back(W::kShapeInfo.key); });
  known.push_back("transform");
  const Fields fields(node, "a warp", known);
  const std::vector<MapEntry> entries = map_entries(node, "a warp");
  if (entries.size() != 1)
    throw Error(node.where(), fmt::format("expected one warp, found {}", entries.size()));
  const YamlNode& value = *entries[0].value;
  if (fields["transform"] != nullptr) {
    TransformWarp transform;
    InverseOf inverse{transform.to_pattern};
    read_value(load, value, kAnyNumber, inverse);
    return transform;
  }
  std::optional<Warp> warp;
  visit_warps([&]<class W>(W keys) {
    if (fields[W::kShapeInfo.key] == nullptr) return;
    if constexpr (std::is_same_v<W, TurbulenceKeys>) {
      TurbulenceValue turbulence{keys.turbulence};
      read_value(load, value, kAnyNumber, turbulence);
    } else {
      read_described(load, value, W::kShapeInfo.key, keys);
    }
    if constexpr (requires { keys.warp(); })
      warp = keys.warp();
    else
      warp = keys;
  });
  if (!warp) throw Error(node.where(), "expected a warp");
  return *warp;
}

void read_value(SceneLoad& load, const YamlNode& node, const Range& counts, WarpList& list) {
  const auto items = list_items(node, "warps");
  check_count(node, items.size(), counts, "warps");
  for (const YamlNode* item : items) attempt(*item, [&] { list.warps.push_back(read_warp(load, *item)); });
}

std::string schema_of(Schema& schema, const Range& counts, const WarpList&) {
  const std::string warp = schema.define("a warp", typeid(Warp), [&] {
    SchemaMap map(schema);
    visit_warps([&]<class W>(W keys) {
      const ShapeInfo& info = W::kShapeInfo;
      if constexpr (std::is_same_v<W, TurbulenceKeys>)
        map.add_one_of(info.key, info.meaning,
                       schema_of(schema, kAnyNumber, TurbulenceValue{keys.turbulence}));
      else
        map.add_one_of(info.key, info.meaning, schema.map(fmt::format("a {} warp", info.key), keys));
    });
    map.add_one_of("transform", "a map between others", schema_of(schema, kAnyNumber, Affine{}));
    return map.text();
  });
  return Schema::list(warp, counts);
}

/// A pattern with what all patterns have.
template <class P>
struct PatternKeys {
  P pattern;
  PatternTexture texture;

  void describe(auto& p) {
    pattern.describe(p);
    if constexpr (!requires { P::kShowsColors; }) describe_values(p);
    p.optional("turbulence", TurbulenceValue{texture.turbulence},
               "displaces places by noise, nearest to the pattern");
    p.optional("warps", WarpList{texture.warps}, whole(1, kMostWarps),
               "between turbulence and transform, the first nearest to the pattern");
    p.optional("transform", InverseOf{texture.to_pattern},
               "from the space of the pattern to that of the object");
    texture.turbulence.describe_generator(p);
    p.field("by_uv", texture.by_uv, "is looked up at [u, v, 0] of the surface instead of the place in space");
  }

 private:
  /// What becomes of its values.
  void describe_values(auto& p) {
    p.optional("colors", EvenColors{texture}, whole(1, kMostColors),
               "or textures, in equal steps; black and white if left out");
    p.optional("map", PlacedColors{texture}, whole(1, kMostPlaces),
               "instead: [value, color or number or texture] for ascending values from 0 to 1");
    p.not_both("colors", "map", "expected 'colors' or 'map', not both", "map");
    texture.wave.describe(p);
  }
};

}  // namespace

void read_value(SceneLoad& load, const YamlNode& node, const Range&, VoxelFile& file) {
  file.grid = read_named_file(load, node, read_density_file);
}
std::string schema_of(Schema&, const Range&, const VoxelFile&) { return Schema::file(); }

void read_value(SceneLoad& load, const YamlNode& node, const Range&, PatternColor& color) {
  read_color(load, node, color);
}
std::string schema_of(Schema& schema, const Range&, const PatternColor&) { return color_schema(schema); }

std::optional<PatternTexture> read_pattern(SceneLoad& load, const std::string& name, const YamlNode& node) {
  std::optional<PatternTexture> texture;
  visit_patterns([&]<class P>(P pattern) {
    if (name != P::kShapeInfo.key) return;
    PatternKeys<P> keys{pattern, {}};
    read_described(load, node, P::kShapeInfo.key, keys);
    texture = std::move(keys.texture);
    texture->pattern = keys.pattern;
    texture->set_noise_generator(texture->turbulence.generator);
  });
  return texture;
}

void visit_pattern_schemas(Schema& schema,
                           const std::function<void(const ShapeInfo&, const std::string&)>& what) {
  visit_patterns([&]<class P>(const P& pattern) {
    what(P::kShapeInfo, schema.map(P::kShapeInfo.key, PatternKeys<P>{pattern, {}}));
  });
}

void check_nesting(SceneLoad& load, std::uint32_t texture, const Location& place) {
  NestedPattern all{1, 1};
  for_each_nested_texture(*load.scene.textures[texture].pattern, [&](std::uint32_t nested) {
    if (nested == kNoId) return;
    const auto found = load.patterns.find(nested);
    const NestedPattern inner = found == load.patterns.end() ? NestedPattern{} : found->second;
    all.depth = std::max(all.depth, inner.depth + 1), all.count += inner.count;
  });
  if (all.depth > kMostNestedTextures)
    throw Error(place, fmt::format("patterns show other patterns, more than {} of them in each other",
                                   kMostNestedTextures));
  if (all.count > kMostShown)
    throw Error(place, fmt::format("a pattern shows {} other textures; at most {} are allowed", all.count - 1,
                                   kMostShown));
  load.patterns.insert_or_assign(texture, all);
}

}  // namespace oktett
