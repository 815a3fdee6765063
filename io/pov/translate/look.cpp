#include "io/pov/translate/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "io/pov/translate/pattern_node.h"
#include "io/pov/translate/texture.h"
#include "io/yaml/write_yaml.h"

namespace oktett::pov {
namespace {

bool is_grey(const Vec3d& c) { return c.x == c.y && c.y == c.z; }

double left_of(const PovColor& c) { return 1 - std::clamp(c.filter + c.transmit, 0.0, 1.0); }

/// What passes through, of white light.
Vec3d through_of(const PovColor& c) { return c.rgb * c.filter + Vec3d{1, 1, 1} * c.transmit; }

/// The colour of highlights or mirrors of a metal.
Vec3d tint(double metallic, const Vec3d& rgb) {
  const double m = std::clamp(metallic, 0.0, 1.0);
  return rgb * m + Vec3d{1, 1, 1} * (1 - m);
}

bool is_transparent(const Look& look) {
  bool any = false;
  for_each_plain(look, [&](const Look& plain) { any = any || is_transparent(plain.pigment); });
  return any;
}

/// Writes a look as a material. What differs between the textures of a pattern is a texture in it.
class MaterialWriter {
 public:
  /// `lit_behind`: lamps light both sides alike.
  MaterialWriter(Context& context, const Place& where, bool lit_behind = false)
      : context_(context), tree_(context.tree), where_(where), lit_behind_(lit_behind) {}

  /// `medium`: the name of what fills solids; empty: nothing does.
  Node write(const Look& look, const Interior& interior, const std::string& medium) {
    const Node map = tree_.map(where_);
    passes_straight_ = passes_straight(look, interior, medium);
    const bool transparent = is_transparent(look) && !passes_straight_;
    const bool is_solid_glass = transparent && look.is_plain() && is_solid(look.pigment);
    most_diffuse_ = 0;
    for_each_plain(look, [&](const Look& l) { most_diffuse_ = std::max(most_diffuse_, l.finish.diffuse); });
    ambient_glows_ = has_layers(look) && !has_even_ambient(look);
    tree_.put(map, "color", scattered(look));
    tree_.put(map, "ambient", weight(look, [this](const Finish& f) { return ambient_of(f); }));
    if (any(look, [this](const Finish& f) { return !(glow_of(f) == Vec3d{0, 0, 0}); }))
      tree_.put(map, "emission", glow(look));
    tree_.put(map, "diffuse",
              has_layers(look) ? tree_.number(where_, most_diffuse_)
                               : weight(look, [](const Finish& f) { return f.diffuse; }));
    const auto back_of = [this](const Finish& f) { return lit_behind_ ? f.diffuse : f.diffuse_back; };
    if (any(look, [&](const Finish& f) { return back_of(f) > 0; }))
      tree_.put(map, "diffuse_back", weight(look, back_of));
    put_unevenness(map, look);
    put_highlight(map, look);
    put_reflection(map, look);
    put_film(map, look);
    double ior = interior.ior;
    for_each_plain(look, [&](const Look& l) { ior = l.finish.ior.value_or(ior); });
    if (!(ior > 0)) ior = 1;
    if (transparent) {
      if (is_solid_glass)
        put_solid_glass(map, look.pigment.solid);
      else
        tree_.put(map, "transparency", tree_.number(where_, 1)), tree_.put(map, "filter", filter(look));
      // Light is not split: what is mirrored is stated.
      if (ior != 1) tree_.put(map, "fresnel", tree_.flag(where_, false));
      if (!medium.empty()) tree_.put(map, "interior", tree_.text(where_, medium));
    }
    if (transparent || any(look, [](const Finish& f) { return f.varies && f.fresnel; }))
      tree_.put(map, "ior", tree_.number(where_, ior));
    if (const Node bump = heights(look)) tree_.put(map, "map_bump", bump);
    if (passes_straight_) tree_.put(map, "opacity", opacity(look));
    return map;
  }

  /// The colours of a look; of layers less what passes through.
  Node color(const Look& look) {
    if (!has_layers(look)) return colors(look, {[](const PovColor& c) { return c.rgb; }}, true);
    return colors(look, {[](const PovColor& c) { return c.rgb * left_of(c); }}, true);
  }

 private:
  /// Whether light passes a surface that neither bends nor colours it, so that it counts as no bounce. Not of
  /// what mirrors or shines, too, as that does not get less by what passes, nor of layers.
  static bool passes_straight(const Look& look, const Interior& interior, const std::string& medium) {
    if (!medium.empty() || has_layers(look) || !is_transparent(look)) return false;
    bool all = true;
    for_each_plain(look, [&](const Look& plain) {
      const Finish& f = plain.finish;
      const bool is_dull = f.irid <= 0 && f.phong <= 0 && f.specular <= 0 && !mirrors(f);
      all = all && is_dull && f.ior.value_or(interior.ior) == 1 && !filters(plain.pigment);
    });
    return all;
  }

  using PlainNode = std::function<Node(const Look&)>;

  double ambient_of(const Finish& f) const {
    return is_grey(f.ambient) && !ambient_glows_ ? std::max(0.0, f.ambient.x) : 0;
  }
  /// What a surface shows without lamps, where that is not its ambient light.
  Vec3d glow_of(const Finish& f) const {
    return is_grey(f.ambient) && !ambient_glows_ ? f.emission : f.emission + f.ambient;
  }
  /// Whether all layers have as much ambient light as the share of diffuse light that they have.
  bool has_even_ambient(const Look& look) const {
    std::optional<double> ambient;
    bool even = true;
    for_each_plain(look, [&](const Look& l) {
      const double share = diffuse_share(l.finish);
      const double own = share > 0 ? l.finish.ambient.x / share : -1;
      even = even && (!ambient || std::abs(own - *ambient) < 1e-9), ambient = own;
    });
    return even;
  }

  static bool has_layers(const Look& look) {
    return !look.layers.empty() || std::ranges::any_of(look.entries, [](const TextureEntry& entry) {
      return has_layers(entry.look);
    });
  }

  template <class Asked>
  static bool any(const Look& look, Asked&& asked) {
    bool found = false;
    for_each_plain(look, [&](const Look& plain) { found = found || asked(plain.finish); });
    return found;
  }

  /// Unless it is 0, as it is where nothing is said. Returns whether it is not.
  bool put_unless_zero(Node map, std::string_view key, Node value) {
    const bool is_seen = value->text != "0" || value->kind != YamlKind::scalar;
    if (is_seen) tree_.put(map, key, value);
    return is_seen;
  }

  void put_unless_white(Node map, std::string_view key, Node color) {
    if (flow_text(*color) != "[1, 1, 1]") tree_.put(map, key, color);
  }

  // ---- Values of a look that may be in a pattern.

  /// `of` for a plain look; a texture of these in the pattern of a look if they differ.
  Node in_pattern(const Look& look, const PlainNode& of, const PlainNode& of_layers) {
    if (look.is_plain()) return of(look);
    if (!look.layers.empty()) return of_layers(look);
    const PovPattern& pattern = look.pattern;
    std::vector<Node> values;
    for (const TextureEntry& entry : look.entries) values.push_back(in_pattern(entry.look, of, of_layers));
    if (const Node only = only_value(values)) return only;
    if (pattern.word == "average") {
      std::vector<WeightedNode> all;
      for (std::size_t i = 0; i < values.size(); ++i) all.push_back({look.entries[i].at, values[i]});
      if (const Node mean = mean_node(context_, pattern, all)) return mean;
    }
    if (pattern.key.empty() || pattern.key == "projected") {
      context_.tell(fmt::format("texture pattern {}", pattern.word), pattern.where,
                    fmt::format("of the textures in a pattern '{}' the first is shown", pattern.word));
      return values[0];
    }
    const Node list = tree_.list(where_);
    double before = 0;
    for (std::size_t i = 0; i < values.size() && i < (pattern.is_list ? 6u : 256u); ++i) {
      if (pattern.is_list) {
        Tree::push(list, values[i]);
        continue;
      }
      before = std::clamp(look.entries[i].at, before, 1.0);
      push_entry(tree_, where_, list, before, values[i]);
    }
    return pattern_node(context_, pattern, list);
  }

  /// Of layers the one that is seen most.
  static std::size_t shown_layer(const Look& look) {
    double left = 1, most = -1;
    std::size_t shown = 0;
    for (std::size_t i = look.layers.size(); i-- > 0;) {
      double opaque = 1;
      int count = 0;
      for_each_plain(look.layers[i], [&](const Look& plain) {
        opaque = (opaque * count + left_of(mean_of(plain.pigment))) / (count + 1), ++count;
      });
      if (left * opaque > most) most = left * opaque, shown = i;
      left *= 1 - opaque;
    }
    return shown;
  }

  /// Which plain looks have what is asked for.
  using Asked = std::function<bool(const Finish&)>;
  static bool asks_nothing(const Finish&) { return false; }

  /// Of layers the uppermost that has what is asked for; else the one that is seen most.
  static std::size_t asked_layer(const Look& look, const Asked& asked) {
    for (std::size_t i = look.layers.size(); i-- > 0;)
      if (any(look.layers[i], asked)) return i;
    return shown_layer(look);
  }

  /// A value of the layers that have what is asked for.
  Node of_asked_layer(const Look& look, const PlainNode& plain, const Asked& asked) {
    PlainNode layers;
    layers = [&](const Look& l) { return in_pattern(l.layers[asked_layer(l, asked)], plain, layers); };
    return in_pattern(look, plain, layers);
  }
  Node number(const Look& look, const std::function<double(const Look&)>& of, const Asked& asked) {
    return of_asked_layer(
        look, [&](const Look& l) { return tree_.number(where_, of(l)); }, asked);
  }
  /// The colour of what such layers send, as the layers above let it pass.
  Node sent_color(const Look& look, const std::function<Vec3d(const Finish&, const Vec3d&)>& of,
                  const Asked& asked) {
    const PlainNode plain = [&](const Look& l) {
      return pigment_node(context_, where_, l.pigment,
                          {[&](const PovColor& c) { return of(l.finish, c.rgb); }});
    };
    PlainNode layers;
    layers = [&](const Look& l) {
      const std::size_t from = asked_layer(l, asked);
      Node color = in_pattern(l.layers[from], plain, layers);
      for (std::size_t i = from + 1; i < l.layers.size(); ++i)
        color = over_node(tree_, where_, color_node(tree_, where_, {0, 0, 0}),
                          colors(l.layers[i], {through_of}, false), color);
      return color;
    };
    return in_pattern(look, plain, layers);
  }

  Node number(const Look& look, const std::function<double(const Look&)>& of) {
    return number(look, of, asks_nothing);
  }

  /// Colours of layers above each other: each is seen through what those above it let pass.
  Node colors(const Look& look, const ColorPart& part, bool is_sum) {
    return colors_by_finish(
        look, [&](const Finish&) { return part; }, is_sum);
  }
  Node colors_by_finish(const Look& look, const std::function<ColorPart(const Finish&)>& part, bool is_sum) {
    const PlainNode plain = [&](const Look& l) {
      return pigment_node(context_, where_, l.pigment, part(l.finish));
    };
    const PlainNode layers = [&](const Look& l) -> Node {
      Node below = colors_by_finish(l.layers.front(), part, is_sum);
      for (std::size_t i = 1; i < l.layers.size(); ++i) {
        if (!is_transparent(l.layers[i])) {
          below = colors_by_finish(l.layers[i], part, is_sum);
          continue;
        }
        const Node color =
            is_sum ? colors_by_finish(l.layers[i], part, true) : color_node(tree_, where_, {0, 0, 0});
        const Node filter = colors(l.layers[i], {through_of}, false);
        below = over_node(tree_, where_, color, filter, below);
      }
      return below;
    };
    return in_pattern(look, plain, layers);
  }

  /// What a layer scatters of the light of lamps, of the most that one does.
  double diffuse_share(const Finish& f) const { return most_diffuse_ > 0 ? f.diffuse / most_diffuse_ : 1; }

  /// The colours of a look that scatters light; of layers less what passes through, and by their share.
  Node scattered(const Look& look) {
    if (!has_layers(look)) return color(look);
    const auto part = [this](const Finish& f) -> ColorPart {
      return {[share = diffuse_share(f)](const PovColor& c) { return c.rgb * (left_of(c) * share); }};
    };
    return colors_by_finish(look, part, true);
  }

  /// A weight of the light that a surface scatters: of its colour, as far as no light passes. Colours of
  /// layers are less that part already, and have their share.
  Node weight(const Look& look, const std::function<double(const Finish&)>& of) {
    if (has_layers(look))
      return number(look, [&](const Look& l) {
        const double share = diffuse_share(l.finish);
        return share > 0 ? of(l.finish) / share : of(l.finish);
      });
    return of_shown_layer(look, [&](const Look& l) {
      const double all = of(l.finish);
      if (passes_straight_ || !is_transparent(l.pigment)) return tree_.number(where_, all);
      const auto left = [&](const PovColor& c) { return Vec3d{1, 1, 1} * (all * left_of(c)); };
      return pigment_node(context_, where_, l.pigment, {left, true});
    });
  }

  Node opacity(const Look& look) {
    const auto left = [](const PovColor& c) { return Vec3d{1, 1, 1} * left_of(c); };
    return of_shown_layer(look, [&](const Look& l) {
      return pigment_node(context_, where_, l.pigment, {left, true});
    });
  }

  Node filter(const Look& look) { return colors(look, {through_of}, false); }

  Node glow(const Look& look) {
    const auto part = [this](const Finish& f) -> ColorPart {
      return {[glow = glow_of(f), whole = passes_straight_](const PovColor& c) {
        return glow * c.rgb * (whole ? 1 : left_of(c));
      }};
    };
    return colors_by_finish(look, part, true);
  }

  Node of_shown_layer(const Look& look, const PlainNode& plain) {
    return of_asked_layer(look, plain, asks_nothing);
  }

  Node heights(const Look& look) {
    bool any = false;
    for_each_plain(look, [&](const Look& plain) { any = any || !plain.normal.pattern.is_none(); });
    if (!any) return nullptr;
    const Node node = of_shown_layer(look, [&](const Look& l) {
      const Node normal = normal_node(context_, l.normal);
      return normal != nullptr ? normal : tree_.number(where_, 0);
    });
    return node->kind == YamlKind::map ? node : nullptr;
  }

  // ---- Light that is mirrored or passes.

  void put_solid_glass(Node map, const PovColor& c) {
    tree_.put(map, "transparency", tree_.number(where_, std::clamp(c.filter + c.transmit, 0.0, 1.0)));
    tree_.put(map, "filter", color_node(tree_, where_, through_of(c) / (c.filter + c.transmit)));
  }

  void put_highlight(Node map, const Look& look) {
    const auto has_phong = [](const Finish& f) { return f.phong > 0; };
    if (any(look, has_phong)) {
      put_unless_zero(map, "specular",
                      number(
                          look, [](const Look& l) { return std::max(0.0, l.finish.phong); }, has_phong));
      tree_.put(map, "phong",
                number(
                    look, [](const Look& l) { return std::max(0.0, l.finish.phong_size); }, has_phong));
    }
    const auto has_specular = [](const Finish& f) { return f.specular > 0; };
    if (any(look, has_specular)) {
      const bool is_seen = put_unless_zero(
          map, "specular_blinn",
          number(
              look, [](const Look& l) { return std::max(0.0, l.finish.specular); }, has_specular));
      if (is_seen)
        tree_.put(
            map, "blinn",
            number(
                look, [](const Look& l) { return 1 / std::max(l.finish.roughness, 1e-6); }, has_specular));
    }
    const auto shines = [](const Finish& f) { return f.phong > 0 || f.specular > 0; };
    if (!any(look, shines)) return;
    const auto color = [](const Finish& f, const Vec3d& rgb) { return tint(f.metallic, rgb); };
    put_unless_white(map, "specular_color", sent_color(look, color, shines));
    if (any(look, [&](const Finish& f) { return f.metallic > 0 && shines(f); }))
      tree_.put(map, "specular_fades", tree_.flag(where_, true));
  }

  /// The colours of a thin film.
  void put_film(Node map, const Look& look) {
    const auto has_film = [](const Finish& f) { return f.irid > 0; };
    if (!any(look, has_film)) return;
    if (!put_unless_zero(map, "film",
                         number(
                             look, [](const Look& l) { return l.finish.irid; }, has_film)))
      return;
    tree_.put(map, "film_thickness",
              of_asked_layer(
                  look, [&](const Look& l) { return thickness(l.finish); }, has_film));
  }

  /// That of a film in nanometres, which turbulence changes from place to place.
  Node thickness(const Finish& f) {
    const double mean = f.film_thickness * context_.film_scale * 1000;
    if (!(f.film_turbulence > 0)) return tree_.number(where_, mean);
    const Node noise = tree_.map(where_), list = tree_.list(where_);
    tree_.put(noise, "octaves", tree_.number(where_, 5));
    for (const double at : {0.0, 1.0})
      push_entry(tree_, where_, list, at,
                 tree_.number(where_, mean * (1 + (2 * at - 1) * f.film_turbulence)));
    tree_.put(noise, "map", list);
    return tree_.map(where_, "noise", noise);
  }

  /// How light of lamps falls off and is grained.
  void put_unevenness(Node map, const Look& look) {
    if (any(look, [](const Finish& f) { return f.brilliance != 1; }))
      tree_.put(map, "brilliance", number(look, [](const Look& l) { return l.finish.brilliance; }));
    if (any(look, [](const Finish& f) { return f.crand > 0; }))
      put_unless_zero(map, "grain", number(look, [](const Look& l) { return l.finish.crand; }));
  }

  static bool mirrors(const Finish& f) {
    return max_component(f.reflection) > 0 || max_component(f.reflection_max) > 0;
  }

  static double weight_of(const Vec3d& reflection) { return std::clamp(max_component(reflection), 0.0, 1.0); }

  /// The colour of what is mirrored, `rgb` being that of the pigment. One that changes with the angle is the
  /// mean of both.
  static Vec3d hue_of(const Finish& f, const Vec3d& rgb) {
    const auto own = [](const Vec3d& reflection) {
      const double weight = max_component(reflection);
      return weight > 0 ? reflection / weight : Vec3d{1, 1, 1};
    };
    Vec3d hue = own(f.reflection_max);
    if (max_component(f.reflection) > 0) hue = (hue + own(f.reflection)) * 0.5;
    return hue * tint(f.reflection_metallic, rgb);
  }

  void put_reflection(Node map, const Look& look) {
    if (!any(look, mirrors)) return;
    const bool is_seen =
        put_unless_zero(map, "reflection",
                        number(
                            look, [](const Look& l) { return weight_of(l.finish.reflection); }, mirrors));
    const bool grows = any(look, [](const Finish& f) { return f.varies; });
    if (!is_seen && !grows) return;
    put_growth(map, look);
    if (any(look, [](const Finish& f) { return f.conserves; }))
      tree_.put(map, "conserve_energy", tree_.flag(where_, true));
    if (any(look, [](const Finish& f) { return f.reflection_metallic > 0; }))
      tree_.put(map, "reflection_fades", tree_.flag(where_, true));
    const Node color = sent_color(look, hue_of, mirrors);
    // Without a colour of its own, mirrored light has that of highlights.
    if (has_key(*map, "specular_color"))
      tree_.put(map, "reflection_color", color);
    else
      put_unless_white(map, "reflection_color", color);
  }

  /// How reflection grows with the angle.
  void put_growth(Node map, const Look& look) {
    if (!any(look, [](const Finish& f) { return f.varies; })) return;
    tree_.put(map, "reflection_grazing",
              number(
                  look, [](const Look& l) { return weight_of(l.finish.reflection_max); }, mirrors));
    Finish first;
    bool found = false;
    for_each_plain(look, [&](const Look& l) {
      if (l.finish.varies && !found) first = l.finish, found = true;
    });
    if (first.fresnel)
      tree_.put(map, "reflection_falloff", tree_.word(where_, "fresnel"));
    else if (first.falloff != 1)
      tree_.put(map, "reflection_falloff", tree_.number(where_, std::clamp(first.falloff, 1e-3, 1000.0)));
  }

  Context& context_;
  Tree& tree_;
  Place where_;
  bool lit_behind_;
  double most_diffuse_ = 0;       ///< of the look that is written
  bool passes_straight_ = false;  ///< it has `opacity` in place of `transparency`
  bool ambient_glows_ = false;    ///< its ambient light is that of each layer, as emission
};

}  // namespace

static void read_sky(Context& context, const Block& block, Look& look) {
  Arguments a(context, block);
  while (!a.at_end()) {
    Moves moves;
    const Block* const inner = a.peek_block();
    if (inner != nullptr && inner->keyword == "sky_sphere") {
      read_sky(context, *inner, look);
      a.take();
    } else if (inner != nullptr && inner->keyword == "pigment") {
      read_look(context, *inner, look.layers.emplace_back());
      a.take();
    } else if (take_moves(context, a, moves)) {
      look.move(moves);
    } else {
      a.take();
    }
  }
}

Node sky_node(Context& context, const Block& block, const Vec3d& background) {
  Look look;
  read_sky(context, block, look);
  if (look.layers.empty()) return nullptr;
  if (!(background == Vec3d{0, 0, 0}) && is_transparent(look.layers.front())) {
    Look below;
    below.pigment.solid = {background};
    look.layers.insert(look.layers.begin(), std::move(below));
  }
  return MaterialWriter(context, block.where).color(look);
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

namespace {

/// Shapes whose u and v are not Oktett's.
struct UvShape {
  std::string_view word;
  UvLayout uv;
};
constexpr UvShape kUvShapes[] = {{"sphere", {{1, 1}, {0.5, 0}}},
                                 {"torus", {{-1, -1}, {1, 1}}},
                                 {"lathe", {{-1, 1}, {0.75, 0}}},
                                 {"sor", {{-1, 1}, {0.75, 0}}},
                                 {"ovus", {{-1, 1}, {0.75, 0}}}};

/// That of a keyword; others have no word.
UvShape uv_shape(std::string_view keyword) {
  const auto* const found = std::ranges::find(kUvShapes, keyword, &UvShape::word);
  return found == std::end(kUvShapes) ? UvShape{} : *found;
}

}  // namespace

Node Wardrobe::material(const Dress& dress, const std::shared_ptr<const Block>& default_texture,
                        const Place& where) {
  std::vector<const Block*> blocks;
  bool is_moved = false;
  for (const LookItem& item : dress.items) {
    blocks.push_back(item.block.get()), blocks.push_back(item.default_texture.get());
    is_moved |= !(item.to_texture == Affine{}) || item.by_uv;
  }
  const auto key = std::tuple(blocks, static_cast<const Block*>(dress.interior.get()),
                              static_cast<const Block*>(default_texture.get()), uv_shape(dress.shape).word,
                              dress.lit_behind);
  Interior interior;
  if (dress.interior) read_interior(context_, *dress.interior, interior);
  const bool is_placed = is_moved || interior.fills() || !dress.back.empty();
  if (!is_placed)
    if (const auto found = known_.find(key); found != known_.end()) return name_node(where, found->second);
  Look look = look_of(context_, dress.items, default_texture);
  look.lay(uv_shape(dress.shape).uv);
  const std::string medium = dress.solid ? media_.name(interior, dress.interior_to_world, dress.hollow) : "";
  const Node node = MaterialWriter(context_, where, dress.lit_behind).write(look, interior, medium);
  if (!dress.back.empty()) {
    Dress back;
    back.items = dress.back, back.interior = dress.interior;
    back.solid = false, back.shape = dress.shape;
    context_.tree.put(node, "back", material(back, default_texture, where));
  }
  const auto [entry, is_new] = names_.try_emplace(flow_text(*node), "");
  if (is_new) {
    std::string wanted = look.name;
    for_each_plain(look, [&](const Look& plain) {
      for (const std::string& name : {plain.name, plain.pigment.name})
        if (wanted.empty()) wanted = name;
    });
    entry->second = context_.unique(taken_, wanted.empty() ? "material" : wanted);
    context_.tree.put(context_.materials, entry->second, node);
  }
  if (!is_placed) known_.emplace(key, entry->second);
  return name_node(where, entry->second);
}

}  // namespace oktett::pov
