#include "io/pov/translate/media.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/pov/translate/pattern_node.h"
#include "io/yaml/write_yaml.h"

namespace oktett::pov {
namespace {

/// How POV-Ray scatters light, against a phase function whose mean over all directions is 1.
struct ScatteringKind {
  const char* phase;  ///< that of scene files
  double strength;    ///< measured in 3.7.0.10
};
constexpr ScatteringKind kScatterings[] = {{"", 1},
                                           {"haze", 2 * 0.576655},
                                           {"murk", (1 + 50.0 / 33) * 0.495715},
                                           {"rayleigh", 4.0 / 3 * 0.799372},
                                           {"", 1}};

void read_scattering(Context& context, const Block& block, PovMedia& media) {
  Arguments a(context, block);
  media.type = static_cast<int>(std::clamp(a.number("a kind of scattering"), 1.0, 5.0));
  while (!a.at_end()) {
    if (a.take_word("eccentricity"))
      media.eccentricity = a.number("a number");
    else if (a.take_word("extinction"))
      media.extinction = a.number("a number");
    else if (a.is_numbers())
      media.scattering = a.color("a colour").rgb;
    else
      a.take();
  }
}

void move_densities(PovMedia& media, const Moves& moves) {
  for (Pigment& density : media.densities) density.pattern.move(moves);
}

}  // namespace

void read_media(Context& context, const Block& block, PovMedia& media) {
  Arguments a(context, block);
  media.where = block.where;
  while (!a.at_end()) {
    Moves moves;
    if (take_moves(context, a, moves)) {
      move_densities(media, moves);
    } else if (const Block* const inner = a.peek_block()) {
      a.take();
      if (inner->keyword == "media")
        read_media(context, *inner, media);
      else if (inner->keyword == "scattering")
        read_scattering(context, *inner, media);
      else if (inner->keyword == "density")
        read_pigment(context, *inner, media.densities.emplace_back());
    } else if (a.take_word("absorption")) {
      media.absorption = a.color("a colour").rgb;
    } else if (a.take_word("emission")) {
      media.emission = a.color("a colour").rgb;
    } else {
      a.take();
    }
  }
}

void read_interior(Context& context, const Block& block, Interior& interior) {
  Arguments a(context, block);
  interior.where = block.where;
  while (!a.at_end()) {
    const Place where = a.where();
    Moves moves;
    if (take_moves(context, a, moves)) {
      for (PovMedia& media : interior.media) move_densities(media, moves);
    } else if (const Block* const inner = a.peek_block()) {
      a.take();
      if (inner->keyword == "interior")
        read_interior(context, *inner, interior);
      else if (inner->keyword == "media")
        read_media(context, *inner, interior.media.emplace_back());
      else
        context.tell(fmt::format("interior {}", inner->keyword), inner->where,
                     fmt::format("'{}' in an interior has no meaning here, and is left out", inner->keyword));
    } else if (a.take_word("ior")) {
      interior.ior = a.number("a number");
    } else if (a.take_word("fade_distance")) {
      interior.fade_distance = a.number("a number");
    } else if (a.take_word("fade_power")) {
      interior.fade_power = a.number("a number");
    } else if (a.take_word("fade_color") || a.take_word("fade_colour")) {
      interior.fade_color = a.color("a colour").rgb;
    } else {
      const std::string word(a.peek_word());
      a.take();
      const bool changes = a.is_numbers() && a.vector("a number").x != 0;
      if (changes && word == "caustics")
        context.tell("interior caustics", where,
                     "'caustics' of an interior, brighter shadows of glass, are left out");
      else if (changes && word != "dispersion_samples")
        context.tell("interior " + word, where, fmt::format("'{}' of an interior has no meaning here", word));
    }
  }
}

namespace {

/// One medium of several.
PovMedia joined(Context& context, const std::vector<PovMedia>& all) {
  PovMedia one;
  bool has_density = false;
  for (const PovMedia& media : all) {
    const bool differs = !media.densities.empty() || has_density ||
                         (one.scattering != Vec3d{0, 0, 0} && !(media.scattering == Vec3d{0, 0, 0}));
    if (&media != &all[0] && differs) {
      context.tell("several media", media.where,
                   "of several media in one place those before this one are shown; it is left out");
      continue;
    }
    has_density = !media.densities.empty();
    one.where = media.where;
    one.absorption = one.absorption + media.absorption, one.emission = one.emission + media.emission;
    if (!(media.scattering == Vec3d{0, 0, 0}))
      one.scattering = media.scattering, one.type = media.type, one.eccentricity = media.eccentricity,
      one.extinction = media.extinction;
    one.densities.insert(one.densities.end(), media.densities.begin(), media.densities.end());
  }
  return one;
}

/// Writes one medium.
class MediumNode {
 public:
  MediumNode(Context& context, const Place& where)
      : tree_(context.tree), context_(context), where_(where), node_(tree_.map(where)) {}

  void put_media(const PovMedia& media, const Affine& to_world) {
    Vec3d factor{1, 1, 1};
    Node map = nullptr;
    for (const Pigment& density : media.densities) {
      if (is_solid(density)) {
        factor = factor * density.solid.rgb;
        continue;
      }
      const Node one = pigment_node(context_, where_, density, {[](const PovColor& c) { return c.rgb; }});
      if (one->kind == YamlKind::map) map = map == nullptr ? one : product(map, one);
    }
    absorption_ = absorption_ + media.absorption * factor;
    put_color("emission", media.emission * factor);
    put_scattering(media, factor);
    if (map == nullptr) return;
    tree_.put(node_, "map_density", map);
    if (to_world == Affine{}) return;
    Moves moves;
    moves.add({Move::Kind::matrix, {}, to_world, where_});
    tree_.put(node_, "transform", moves_node(tree_, where_, moves));
  }

  /// By powers from 1000 on light falls exponentially.
  void put_fade(const Interior& interior) {
    if (!(interior.fade_distance > 0 && interior.fade_power > 0)) return;
    if (interior.fade_power >= 1000) {
      absorption_ = absorption_ + (Vec3d{1, 1, 1} - interior.fade_color) / interior.fade_distance;
      return;
    }
    const Node fade = tree_.map(where_);
    tree_.put(fade, "distance", tree_.number(where_, interior.fade_distance));
    tree_.put(fade, "power", tree_.number(where_, interior.fade_power));
    if (!(interior.fade_color == Vec3d{0, 0, 0}))
      tree_.put(fade, "color", color_node(tree_, where_, interior.fade_color));
    tree_.put(node_, "fade", fade);
  }

  Node finish() {
    put_color("absorption", absorption_);
    return node_;
  }

 private:
  /// Two textures that multiply each other.
  Node product(Node a, Node b) {
    return over_node(tree_, where_, color_node(tree_, where_, {0, 0, 0}), a, b);
  }

  void put_color(const char* key, const Vec3d& rgb) {
    if (!(rgb == Vec3d{0, 0, 0})) tree_.put(node_, key, color_node(tree_, where_, rgb));
  }

  /// In POV-Ray a place shows the light that arrives there times the scattering, whatever the direction; here
  /// it is spread over all directions.
  void put_scattering(const PovMedia& media, const Vec3d& factor) {
    if (media.scattering == Vec3d{0, 0, 0}) return;
    const ScatteringKind& kind = kScatterings[media.type - 1];
    const double strength = 4 * kind.strength;
    put_color("scattering", media.scattering * factor * strength);
    if (*kind.phase != 0) tree_.put(node_, "phase", tree_.word(where_, kind.phase));
    if (media.type == 5 && media.eccentricity != 0)
      tree_.put(node_, "anisotropy", tree_.number(where_, std::clamp(media.eccentricity, -0.999, 0.999)));
    tree_.put(node_, "extinction", tree_.number(where_, std::max(0.0, media.extinction) / strength));
  }

  Tree& tree_;
  Context& context_;
  Place where_;
  Node node_;
  Vec3d absorption_{0, 0, 0};
};

}  // namespace

std::string MediaWriter::name(const Interior& interior, const Affine& to_world, bool shows_media) {
  MediumNode medium(context_, interior.where);
  if (shows_media && !interior.media.empty()) medium.put_media(joined(context_, interior.media), to_world);
  medium.put_fade(interior);
  const Node node = medium.finish();
  if (node->items.empty()) return "";
  const auto [entry, is_new] = names_.try_emplace(flow_text(*node), "");
  if (is_new) {
    entry->second = context_.unique(taken_, "medium");
    context_.tree.put(context_.media, entry->second, node);
  }
  return entry->second;
}

}  // namespace oktett::pov
