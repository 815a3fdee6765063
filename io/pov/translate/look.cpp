#include "io/pov/translate/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "io/yaml/write_yaml.h"

namespace oktett::pov {
namespace {

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::ranges::find(words, word) != words.end();
}

/// A colour from a map, and where it stands there.
struct MapColor {
  double at;
  PovColor color;
};

/// What blocks `pigment` say, one after the other.
struct Pigment {
  PovColor solid;
  std::string pattern;  ///< empty: one colour
  Place pattern_place;
  Vec3d axis{0, 0, 0};           ///< of `gradient`
  std::vector<PovColor> colors;  ///< of patterns with a list of colours
  std::vector<MapColor> map;
  std::string image;
  bool uv = false;
  double frequency = 1, turbulence = 0;
  Moves moves;
  std::string name;
};

constexpr std::array<std::string_view, 4> kListPatterns{"checker", "hexagon", "brick", "object"};
constexpr std::array<std::string_view, 44> kPatterns{
    "agate",         "average",         "boxed",   "bozo",      "bumps",    "cells",     "crackle",
    "cylindrical",   "density_file",    "dents",   "facets",    "function", "gradient",  "granite",
    "image_pattern", "julia",           "leopard", "magnet",    "mandel",   "marble",    "onion",
    "pavement",      "pigment_pattern", "planar",  "potential", "quilted",  "radial",    "ripples",
    "slope",         "spherical",       "spiral1", "spiral2",   "spotted",  "square",    "tiling",
    "triangular",    "waves",           "wood",    "wrinkles",  "aoi",      "proximity", "hexagon",
    "brick",         "checker"};
/// What stands before one value that changes nothing here.
constexpr std::array<std::string_view, 15> kIgnoredNumbers{
    "octaves",     "omega",      "lambda",      "phase",        "noise_generator",
    "control0",    "control1",   "quick_color", "quick_colour", "map_type",
    "interpolate", "agate_turb", "form",        "metric",       "offset"};

PovColor blend(const PovColor& a, const PovColor& b, double t) {
  return {a.rgb * (1 - t) + b.rgb * t, a.filter * (1 - t) + b.filter * t,
          a.transmit * (1 - t) + b.transmit * t};
}

PovColor color_at(const std::vector<MapColor>& map, double at) {
  if (map.empty()) return {};
  if (at <= map.front().at) return map.front().color;
  for (std::size_t i = 1; i < map.size(); ++i) {
    if (at > map[i].at) continue;
    const double width = map[i].at - map[i - 1].at;
    return width > 0 ? blend(map[i - 1].color, map[i].color, (at - map[i - 1].at) / width) : map[i].color;
  }
  return map.back().color;
}

PovColor mean_of(const Pigment& p) {
  if (p.pattern.empty()) return p.solid;
  PovColor sum;
  int count = 0;
  const auto add = [&](const PovColor& c) {
    sum.rgb = sum.rgb + c.rgb, sum.filter += c.filter, sum.transmit += c.transmit, ++count;
  };
  for (const PovColor& c : p.colors) add(c);
  if (p.colors.empty() && !p.map.empty())
    for (int i = 0; i < 64; ++i) add(color_at(p.map, (i + 0.5) / 64));
  if (count == 0) return {{0.5, 0.5, 0.5}};
  return {sum.rgb / count, sum.filter / count, sum.transmit / count};
}

/// Reads pigments.
class PigmentReader {
 public:
  explicit PigmentReader(Context& context) : context_(context) {}

  void read(const Block& block, Pigment& p) {
    if (!block.name.empty() && p.name.empty()) p.name = block.name;
    Arguments a(context_, block);
    while (!a.at_end()) step(a, p);
  }

 private:
  void step(Arguments& a, Pigment& p) {
    const Place where = a.where();
    if (const Block* const block = a.peek_block(); block != nullptr && block->keyword != "transform") {
      inner(*block, p);
      a.take();
      return;
    }
    if (take_moves(context_, a, p.moves)) return;
    if (a.is_numbers()) {
      const PovColor color = a.color("a colour");
      if (is_one_of(p.pattern, kListPatterns))
        p.colors.push_back(color);
      else
        p.solid = color, p.pattern.clear();
      return;
    }
    const std::string_view word = a.peek_word();
    a.take();
    if (word == "gradient") p.axis = a.vector("a vector");
    if (is_one_of(word, kPatterns)) {
      p.pattern = word, p.pattern_place = where, p.colors.clear();
      if (word != "gradient")
        while (a.is_numbers() && !is_one_of(word, kListPatterns)) a.take();
    } else if (word == "uv_mapping") {
      p.uv = a.flag();
    } else if (word == "frequency") {
      p.frequency = a.number("a number");
    } else if (word == "turbulence") {
      p.turbulence = max_component(abs(a.vector("a number")));
    } else if (word == "filter" || word == "transmit") {
      if (word == "filter")
        p.solid.filter = a.number("a number");
      else
        p.solid.transmit = a.number("a number");
    } else if (is_one_of(word, kIgnoredNumbers)) {
      if (a.is_numbers()) a.take();
    }
  }

  void inner(const Block& block, Pigment& p) {
    const std::string_view k = block.keyword;
    if (k == "pigment" || k == "texture") {
      if (is_one_of(p.pattern, kListPatterns) && p.pattern != "object")
        p.colors.push_back(mean_color(context_, block));
      else
        read(block, p);
    } else if (k == "color_map" || k == "colour_map" || k == "pigment_map" || k == "texture_map") {
      p.map.clear();
      read_map(block, p);
      std::ranges::stable_sort(p.map, {}, &MapColor::at);
    } else if (k == "image_map") {
      p.pattern = "image_map", p.pattern_place = block.where;
      Arguments a(context_, block);
      while (!a.at_end()) {
        const Element& element = a.take();
        if (const auto* const path = std::get_if<std::string>(&element.value))
          p.image = *path, p.pattern_place = element.where;
      }
    } else if (k == "warp") {
      context_.tell("warp", block.where, "'warp' has no meaning here, and is left out");
    }
  }

  void read_map(const Block& block, Pigment& p) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const Block* const entry = a.peek_block();
      if (entry == nullptr) {
        a.take();
        continue;
      }
      a.take();
      if (entry->keyword != "[") {
        // A map that was declared.
        read_map(*entry, p);
        continue;
      }
      read_entry(*entry, p);
    }
  }

  /// `[at color]`, `[from to color color]` or `[at pigment]`.
  void read_entry(const Block& entry, Pigment& p) {
    Arguments a(context_, entry);
    const double from = a.number("a number");
    double to = from;
    bool is_range = false;
    if (a.is_numbers() && !a.is_vector() && a.block().elements.size() > 3)
      to = a.number("a number"), is_range = true;
    std::vector<PovColor> colors;
    while (!a.at_end()) {
      if (a.is_numbers())
        colors.push_back(a.color("a colour"));
      else if (const Block* const block = a.peek_block())
        colors.push_back(mean_color(context_, *block)), a.take();
      else
        a.take();
    }
    if (colors.empty()) context_.fail(entry.where, "expected a colour in this entry of a map");
    p.map.push_back({from, colors[0]});
    if (is_range) p.map.push_back({to, colors.back()});
  }

  Context& context_;
};

/// What blocks `finish` say.
struct Finish {
  Vec3d ambient{0.1, 0.1, 0.1}, emission{0, 0, 0};
  double diffuse = 0.6, phong = 0, phong_size = 40, specular = 0, roughness = 0.05, metallic = 0;
  Vec3d reflection{0, 0, 0}, reflection_max{0, 0, 0};
  bool varies = false, fresnel = false;  ///< of the reflection
  double reflection_metallic = 0;
  std::optional<double> ior;  ///< as in old scenes
};

class FinishReader {
 public:
  explicit FinishReader(Context& context) : context_(context) {}

  void read(const Block& block, Finish& f) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      if (const Block* const inner = a.peek_block()) {
        if (inner->keyword == "finish")
          read(*inner, f);
        else if (inner->keyword == "reflection")
          read_reflection(*inner, f);
        else
          tell(inner->keyword, inner->where);
        a.take();
        continue;
      }
      const Place where = a.where();
      const std::string_view word = a.peek_word();
      a.take();
      read_word(word, where, a, f);
    }
  }

 private:
  void tell(std::string_view what, const Place& where) {
    context_.tell(fmt::format("finish {}", what), where,
                  fmt::format("'{}' of a finish has no meaning here, and is left out", what));
  }

  void read_word(std::string_view word, const Place& where, Arguments& a, Finish& f) {
    if (word == "ambient")
      f.ambient = a.vector("a colour");
    else if (word == "emission")
      f.emission = a.vector("a colour");
    else if (word == "diffuse") {
      a.take_word("albedo");
      f.diffuse = a.number("a number");
      if (a.is_numbers())
        a.take(), context_.tell("diffuse back", where, "light on the back of surfaces is left out");
    } else if (word == "phong")
      a.take_word("albedo"), f.phong = a.number("a number");
    else if (word == "phong_size")
      f.phong_size = a.number("a number");
    else if (word == "specular")
      a.take_word("albedo"), f.specular = a.number("a number");
    else if (word == "roughness")
      f.roughness = a.number("a number");
    else if (word == "metallic")
      f.metallic = a.is_numbers() ? a.number("a number") : 1;
    else if (word == "reflection")
      f.reflection = f.reflection_max = a.vector("a colour"), f.varies = false;
    else if (word == "ior")
      f.ior = a.number("a number");
    else if (word == "refraction" || word == "caustics" || word == "fade_power" || word == "fade_distance" ||
             word == "use_alpha") {
      if (a.is_numbers()) a.take();
    } else if (word == "conserve_energy")
      a.flag();
    else if (word == "brilliance" || word == "crand" || word == "reflection_exponent") {
      if (a.number("a number") != (word == "crand" ? 0 : 1)) tell(word, where);
    } else if (is_filler(word)) {
    } else {
      tell(word, where);
      while (a.is_numbers()) a.take();
    }
  }

  static bool is_filler(std::string_view word) {
    return word.empty() || word == "color" || word == "colour" || word == "rgb";
  }

  void read_reflection(const Block& block, Finish& f) {
    Arguments a(context_, block);
    std::vector<Vec3d> colors;
    while (!a.at_end()) {
      const Place where = a.where();
      if (a.is_numbers()) {
        colors.push_back(a.vector("a colour"));
      } else if (a.take_word("fresnel")) {
        f.fresnel = a.flag();
      } else if (a.take_word("metallic")) {
        f.reflection_metallic = a.is_numbers() ? a.number("a number") : 1;
      } else if (a.take_word("falloff") || a.take_word("exponent")) {
        a.number("a number");
        tell("falloff of reflection", where);
      } else {
        a.take();
      }
    }
    if (colors.empty()) return;
    f.reflection = colors[0], f.reflection_max = colors.back();
    f.varies = colors.size() > 1;
  }

  Context& context_;
};

struct Look {
  Pigment pigment;
  Finish finish;
  std::string name;
  bool has_pigment = false;
};

/// Reads textures.
class TextureReader {
 public:
  explicit TextureReader(Context& context) : context_(context) {}

  void read(const Block& block, Look& look) {
    if (block.keyword == "pigment") return pigment(block, look);
    if (block.keyword == "finish") return FinishReader(context_).read(block, look.finish);
    if (block.keyword == "normal") return tell_normal(block);
    if (!block.name.empty() && look.name.empty()) look.name = block.name;
    Arguments a(context_, block);
    const Block* const layer = shown_layer(block);
    std::string_view pattern;
    while (!a.at_end()) {
      const Place where = a.where();
      const Block* const inner = a.peek_block();
      if (inner == nullptr || inner->keyword == "transform") {
        Moves moves;
        if (take_moves(context_, a, moves)) {
          look.pigment.moves.add(moves);
          continue;
        }
        const std::string_view word = a.peek_word();
        a.take();
        if (is_one_of(word, kPatterns)) {
          pattern = word;
          context_.tell("texture pattern", where,
                        "a texture of several textures in a pattern shows the first of them only");
        }
        continue;
      }
      a.take();
      if (inner->keyword == "texture" || inner->keyword == "material") {
        const bool is_hidden = layer != nullptr && inner != layer;
        if (!is_hidden && (pattern.empty() || !look.has_pigment)) read(*inner, look);
      } else if (inner->keyword == "pigment") {
        pigment(*inner, look);
      } else if (inner->keyword == "finish") {
        FinishReader(context_).read(*inner, look.finish);
      } else if (inner->keyword == "normal") {
        tell_normal(*inner);
      } else if (inner->keyword == "texture_map" || inner->keyword == "material_map") {
        context_.tell("texture pattern", inner->where,
                      "a texture of several textures in a pattern shows the first of them only");
        first_of_map(*inner, look);
      }
    }
  }

 private:
  void pigment(const Block& block, Look& look) {
    look.pigment = Pigment{};
    PigmentReader(context_).read(block, look.pigment);
    look.has_pigment = true;
  }

  /// Of a texture that is declared in layers, the uppermost that hides those below, else the lowest; null for
  /// others.
  const Block* shown_layer(const Block& block) {
    std::vector<const Block*> layers;
    for (const Element& e : block.elements) {
      const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
      if (inner != nullptr && *inner != nullptr && (*inner)->keyword == "texture")
        layers.push_back(inner->get());
      const auto* const word = std::get_if<Word>(&e.value);
      if (word != nullptr && is_one_of(word->text, kPatterns)) return nullptr;
    }
    if (layers.size() < 2) return nullptr;
    for (std::size_t i = layers.size(); i-- > 0;) {
      Look probe;
      read(*layers[i], probe);
      const PovColor mean = mean_of(probe.pigment);
      if (mean.filter + mean.transmit == 0) return layers[i];
      context_.tell("layers", layers[i]->where,
                    "of a texture in layers one is shown, without those that let light pass above it");
    }
    return layers[0];
  }

  void tell_normal(const Block& block) {
    context_.tell("normal", block.where, "'normal' has no meaning here: surfaces are smooth");
  }

  void first_of_map(const Block& map, Look& look) {
    for (const Element& e : map.elements) {
      const auto* const entry = std::get_if<std::shared_ptr<const Block>>(&e.value);
      if (entry == nullptr || *entry == nullptr) continue;
      if ((*entry)->keyword == "texture") return read(**entry, look);
      for (const Element& inner : (*entry)->elements)
        if (const auto* const texture = std::get_if<std::shared_ptr<const Block>>(&inner.value))
          return read(**texture, look);
    }
  }

  Context& context_;
};

struct Interior {
  double ior = 1;
};

void read_interior(Context& context, const Block& block, Interior& interior) {
  Arguments a(context, block);
  while (!a.at_end()) {
    const Place where = a.where();
    if (const Block* const inner = a.peek_block()) {
      if (inner->keyword == "interior")
        read_interior(context, *inner, interior);
      else
        context.tell(fmt::format("interior {}", inner->keyword), inner->where,
                     fmt::format("'{}' in an interior has no meaning here, and is left out", inner->keyword));
      a.take();
    } else if (a.take_word("ior")) {
      interior.ior = a.number("a number");
    } else {
      const std::string word(a.peek_word());
      a.take();
      const bool changes = a.is_numbers() && a.vector("a number").x != 0;
      if (changes && word != "caustics")
        context.tell("interior " + word, where, fmt::format("'{}' of an interior has no meaning here", word));
    }
  }
}

bool is_grey(const Vec3d& c) { return c.x == c.y && c.y == c.z; }

/// Writes a look as a material.
class MaterialWriter {
 public:
  MaterialWriter(Context& context, const Place& where)
      : context_(context), tree_(context.tree), where_(where) {}

  Node write(const Look& look, const Interior& interior, const Affine& to_texture) {
    const Pigment& p = look.pigment;
    const Finish& f = look.finish;
    const PovColor mean = mean_of(p);
    const double passes = std::clamp(mean.filter + mean.transmit, 0.0, 1.0);
    const Node map = tree_.map(where_);
    tree_.put(map, "color", color(p, 1 - passes, to_texture));
    put_glow(map, f, mean, passes);
    put(map, "diffuse", f.diffuse, -1);
    put_highlight(map, f, mean.rgb);
    put_reflection(map, f, mean.rgb, passes, interior);
    if (passes > 0) {
      const Vec3d through =
          (mean.rgb * mean.filter + Vec3d{1, 1, 1} * mean.transmit) / (mean.filter + mean.transmit);
      put(map, "transparency", passes, -1);
      tree_.put(map, "filter", color_node(tree_, where_, through));
      const double ior = f.ior.value_or(interior.ior);
      put(map, "ior", ior > 0 ? ior : 1, -1);
    }
    return map;
  }

 private:
  /// Unless it is the `usual` value.
  void put(Node map, std::string_view key, double value, double usual) {
    if (value != usual) tree_.put(map, key, tree_.number(where_, value));
  }

  void put_glow(Node map, const Finish& f, const PovColor& mean, double passes) {
    const bool grey = is_grey(f.ambient);
    put(map, "ambient", grey ? std::max(0.0, f.ambient.x) : 0, -1);
    Vec3d glow = f.emission;
    if (!grey) glow = glow + f.ambient;
    if (!grey || max_component(glow) > 0)
      tree_.put(map, "emission", color_node(tree_, where_, glow * mean.rgb * (1 - passes)));
  }

  /// POV-Ray's `specular` is a power of the cosine between the normal and the direction halfway to the light,
  /// whose angle is half of that from the mirrored ray, so the highlight is as wide as that of a fourth of
  /// the exponent.
  void put_highlight(Node map, const Finish& f, const Vec3d& rgb) {
    const bool both = f.phong > 0 && f.specular > 0;
    if (both)
      context_.tell("phong and specular", where_,
                    "of 'phong' and 'specular' in one finish the stronger is shown");
    const bool phong = f.phong >= f.specular;
    const double weight = phong ? f.phong : f.specular;
    if (!(weight > 0)) return;
    put(map, "specular", weight, 0);
    put(map, "phong", phong ? f.phong_size : 1 / (4 * std::max(f.roughness, 1e-6)), -1);
    if (f.metallic > 0 && !(max_component(f.reflection_max) > 0))
      tree_.put(map, "specular_color", color_node(tree_, where_, tint(f.metallic, rgb)));
  }

  Vec3d tint(double metallic, const Vec3d& rgb) const {
    const double m = std::min(metallic, 1.0);
    return rgb * m + Vec3d{1, 1, 1} * (1 - m);
  }

  void put_reflection(Node map, const Finish& f, const Vec3d& rgb, double passes, const Interior& interior) {
    Vec3d r = f.reflection;
    if (f.varies && !(f.reflection == f.reflection_max)) {
      // Clear glass reflects by Fresnel's equations here whatever is asked for.
      const bool is_glass = passes > 0.5 && interior.ior != 1;
      r = is_glass ? f.reflection : f.reflection * (2.0 / 3) + f.reflection_max * (1.0 / 3);
      if (!is_glass)
        context_.tell("varying reflection", where_,
                      "a reflection that grows with the angle is the same at all angles here: 2/3 of the "
                      "least and 1/3 of the greatest");
    }
    const double weight = max_component(r);
    if (!(weight > 0)) return;
    put(map, "reflection", std::min(weight, 1.0), 0);
    const Vec3d hue =
        r / weight * tint(std::max(f.reflection_metallic, f.metallic * (f.phong + f.specular > 0)), rgb);
    if (hue == Vec3d{1, 1, 1}) return;
    tree_.put(map, "specular_color", color_node(tree_, where_, hue));
    if (f.phong > 0 || f.specular > 0)
      context_.tell("coloured reflection", where_, "highlights have the colour of the reflection");
  }

  Node color(const Pigment& p, double left, const Affine& to_texture) {
    const PovColor mean = mean_of(p);
    if (p.pattern.empty()) return color_node(tree_, where_, p.solid.rgb * left);
    if (Node pattern = pattern_node(p, left, to_texture)) return pattern;
    context_.tell("pattern " + p.pattern, p.pattern_place,
                  fmt::format("pattern '{}' has no meaning here; one colour stands for it", p.pattern));
    return color_node(tree_, where_, mean.rgb * left);
  }

  Node pattern_node(const Pigment& p, double left, const Affine& to_texture) {
    const bool transparent = std::ranges::any_of(p.map, [&](const MapColor& m) {
      return m.color.filter != p.map[0].color.filter || m.color.transmit != p.map[0].color.transmit;
    });
    if (transparent)
      context_.tell("transparent map", p.pattern_place,
                    "what passes through a pattern is the same everywhere");
    const auto colors = [&](const std::vector<PovColor>& list) {
      const Node node = tree_.list(where_);
      for (const PovColor& c : list) Tree::push(node, color_node(tree_, where_, c.rgb * left));
      return node;
    };
    const Node keys = tree_.map(where_);
    std::string_view key = p.pattern;
    Moves moves;
    if (p.pattern == "checker") {
      std::vector<PovColor> list = p.colors;
      if (list.empty()) list = {{{0, 0, 1}}, {{0, 1, 0}}};
      if (list.size() < 2) list.push_back({{0, 1, 0}});
      tree_.put(keys, "colors", colors(list));
    } else if (p.pattern == "image_map") {
      return image_node(p);
    } else {
      if (p.map.empty()) return nullptr;
      std::vector<PovColor> list;
      const bool is_plain = p.map.size() == 2 && p.map[0].at == 0 && p.map[1].at == 1;
      const int count = is_plain ? 2 : 64;
      for (int i = 0; i < count; ++i) list.push_back(color_at(p.map, i / (count - 1.0)));
      if (p.pattern == "gradient") {
        context_.tell("gradient", p.pattern_place, "a gradient does not repeat here beyond its first unit");
        tree_.put(keys, "from", tree_.vector(where_, {0, 0, 0}));
        const double size = dot(p.axis, p.axis);
        if (!(size > 0)) return nullptr;
        tree_.put(keys, "to", tree_.vector(where_, p.axis / (std::sqrt(size) * std::max(p.frequency, 1e-6))));
      } else if (p.pattern == "spherical") {
        key = "radial";
        std::ranges::reverse(list);
      } else if (p.pattern == "marble") {
        similar(p);
        tree_.put(keys, "size", tree_.number(where_, 1 / std::max(p.frequency, 1e-6)));
        tree_.put(keys, "distortion", tree_.number(where_, std::min(p.turbulence, 100.0)));
      } else if (p.pattern == "wood") {
        similar(p);
        tree_.put(keys, "size", tree_.number(where_, 1 / std::max(p.frequency, 1e-6)));
        tree_.put(keys, "distortion", tree_.number(where_, std::min(p.turbulence, 100.0)));
        moves.add({Move::Kind::rotate, {90, 0, 0}, {}, where_});
      } else if (p.pattern == "bozo" || p.pattern == "spotted" || p.pattern == "bumps" ||
                 p.pattern == "granite" || p.pattern == "agate" || p.pattern == "wrinkles") {
        similar(p);
        key = "noise";
        const bool fine = p.pattern == "granite";
        tree_.put(keys, "size", tree_.number(where_, (fine ? 0.5 : 1) / std::max(p.frequency, 1e-6)));
        if (p.pattern == "bozo" || p.pattern == "spotted" || p.pattern == "bumps")
          tree_.put(keys, "octaves", tree_.number(where_, p.turbulence > 0 ? 4 : 1));
      } else {
        return nullptr;
      }
      tree_.put(keys, "colors", colors(list));
    }
    moves.add(p.moves);
    if (!(to_texture == Affine{})) {
      if (!to_texture.is_invertible()) return nullptr;
      moves.add({Move::Kind::matrix, {}, to_texture.inverse(), where_});
    }
    if (const Node transform = moves_node(tree_, where_, moves)) tree_.put(keys, "transform", transform);
    return tree_.map(where_, key, keys);
  }

  void similar(const Pigment& p) {
    context_.tell("pattern " + p.pattern, p.pattern_place,
                  fmt::format("pattern '{}' is only similar to POV-Ray's", p.pattern));
  }

  Node image_node(const Pigment& p) {
    if (!p.uv || p.image.empty()) return nullptr;
    const Node image =
        tree_.map(where_, "file", tree_.text(p.pattern_place, find_file(context_, p.pattern_place, p.image)));
    // Its numbers are those of the scene's gamma then.
    if (context_.gamma > 1.6) tree_.put(image, "color_space", tree_.word(where_, "linear"));
    return image;
  }

  Context& context_;
  Tree& tree_;
  Place where_;
};

}  // namespace

Node color_node(Tree& tree, const Place& where, const Vec3d& rgb) {
  // Single precision is what a colour has; its shortest text reads better.
  const Node node = tree.list(where);
  for (int k = 0; k < 3; ++k)
    Tree::push(node, tree.word(where, fmt::format("{}", static_cast<float>(std::max(0.0, rgb[k])) + 0.0f)));
  return node;
}

PovColor mean_color(Context& context, const Block& block) {
  Look look;
  TextureReader(context).read(block, look);
  return mean_of(look.pigment);
}

Node Wardrobe::invisible(const Place& where) {
  constexpr const char* kName = "invisible";
  if (names_.emplace(kName, kName).second) {
    taken_.insert(kName);
    const Node map = context_.tree.map(where);
    context_.tree.put(map, "opacity", context_.tree.number(where, 0));
    context_.tree.put(context_.materials, kName, map);
  }
  return name_node(where, kName);
}

Node Wardrobe::material(const Dress& dress, const std::shared_ptr<const Block>& default_texture,
                        const Place& where) {
  std::vector<const Block*> blocks;
  for (const auto& block : dress.textures) blocks.push_back(block.get());
  for (const auto& block : dress.finishes) blocks.push_back(block.get());
  const auto key = std::tuple(blocks, static_cast<const Block*>(dress.interior.get()),
                              static_cast<const Block*>(default_texture.get()));
  const bool is_placed = !(dress.to_texture == Affine{});
  if (!is_placed)
    if (const auto found = known_.find(key); found != known_.end()) return name_node(where, found->second);
  Look look;
  const auto read_layer = [&](const Block* texture) {
    look = Look{};
    TextureReader reader(context_);
    if (default_texture != nullptr) reader.read(*default_texture, look), look.name.clear();
    if (texture != nullptr) reader.read(*texture, look);
    for (const auto& finish : dress.finishes) reader.read(*finish, look);
  };
  if (dress.textures.empty()) read_layer(nullptr);
  // Of layers, the uppermost that hides those below, else the lowest.
  for (std::size_t i = dress.textures.size(); i-- > 0;) {
    read_layer(dress.textures[i].get());
    const PovColor mean = mean_of(look.pigment);
    if (dress.textures.size() > 1 && i + 1 == dress.textures.size() && mean.filter + mean.transmit > 0)
      context_.tell("layers", dress.textures[i]->where,
                    "of a texture in layers one is shown, without those that let light pass above it");
    if (mean.filter + mean.transmit == 0) break;
  }
  Interior interior;
  if (dress.interior) read_interior(context_, *dress.interior, interior);
  const Node node = MaterialWriter(context_, where).write(look, interior, dress.to_texture);
  const auto [entry, is_new] = names_.try_emplace(flow_text(*node), "");
  if (is_new) {
    const std::string wanted = !look.name.empty() ? look.name : look.pigment.name;
    entry->second = context_.unique(taken_, wanted.empty() ? "material" : wanted);
    context_.tree.put(context_.materials, entry->second, node);
  }
  if (!is_placed) known_.emplace(key, entry->second);
  return name_node(where, entry->second);
}

}  // namespace oktett::pov
