#include "io/pov/translate/pattern_node.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <variant>

namespace oktett::pov {

std::string_view generator_name(NoiseGenerator generator) {
  return generator == NoiseGenerator::povray_1   ? "povray_1"
         : generator == NoiseGenerator::povray_2 ? "povray_2"
                                                 : "povray_3";
}

/// Whether noise or random numbers have to do with what the pattern shows.
static bool is_random(const PovPattern& p) {
  constexpr std::array<std::string_view, 10> kRandom{"agate",   "bumps", "cells",   "crackle", "dents",
                                                     "granite", "noise", "ripples", "waves",   "wrinkles"};
  return !(p.turbulence == Vec3d{0, 0, 0}) || std::ranges::find(kRandom, p.key) != kRandom.end() ||
         std::ranges::any_of(p.modifiers, [](const auto& modifier) {
           const Node* const warp = std::get_if<Node>(&modifier);
           return warp != nullptr && has_key(**warp, "turbulence");
         });
}

Node turbulence_node(Tree& tree, const Place& where, const PovPattern& p) {
  const Vec3d& t = p.turbulence;
  const Node amount = t.x == t.y && t.x == t.z ? tree.number(where, t.x) : tree.vector(where, t);
  if (p.octaves == 6 && p.lambda == 2 && p.omega == 0.5) return amount;
  const Node map = tree.map(where, "amount", amount);
  if (p.octaves != 6) tree.put(map, "octaves", tree.number(where, p.octaves));
  if (p.lambda != 2) tree.put(map, "lambda", tree.number(where, p.lambda));
  if (p.omega != 0.5) tree.put(map, "omega", tree.number(where, p.omega));
  return map;
}

void push_entry(Tree& tree, const Place& where, Node map, double at, Node value) {
  const Node item = tree.list(where);
  Tree::push(item, tree.number(where, at));
  Tree::push(item, value);
  Tree::push(map, item);
}

void put_generator(Context& context, const PovPattern& p, Node keys) {
  if (has_key(*keys, "noise_generator") || (!p.has_generator && !is_random(p))) return;
  const NoiseGenerator generator = p.noise_generator.value_or(context.noise_generator);
  context.tree.put(keys, "noise_generator", context.tree.word(p.where, generator_name(generator)));
}

Node over_keys(Tree& tree, const Place& where, Node color, Node filter, Node under) {
  const Node keys = tree.map(where);
  tree.put(keys, "color", color), tree.put(keys, "filter", filter), tree.put(keys, "under", under);
  return keys;
}

Node over_node(Tree& tree, const Place& where, Node color, Node filter, Node under) {
  return tree.map(where, "over", over_keys(tree, where, color, filter, under));
}

double scale_of(const PovPattern& pattern) {
  double volume = 1;
  for (const auto& modifier : pattern.modifiers)
    if (const auto* const moves = std::get_if<Moves>(&modifier)) volume *= std::abs(moves->all.determinant());
  const double scale = std::cbrt(volume);
  return std::isfinite(scale) ? scale : 1;
}

/// Its image by the u and v of the shape.
static Node laid_image(Tree& tree, const PovPattern& p) {
  if (p.uv == UvLayout{}) return p.image;
  const auto pair = [&](const std::array<double, 2>& x) {
    const Node list = tree.list(p.where);
    for (const double number : x) Tree::push(list, tree.number(p.where, number));
    return list;
  };
  const Node image = tree.map(p.where);
  image->items = p.image->items;
  tree.put(image, "scale", pair(p.uv.scale)), tree.put(image, "offset", pair(p.uv.first));
  return image;
}

/// Lays an image around a ring from its inside on, as in POV-Ray; here it is from the outside.
static void from_inside(Tree& tree, Node keys) {
  const YamlNode** const shown = find_value(*keys, "of");
  if (shown == nullptr || (*shown)->kind != YamlKind::map) return;
  const Place top;
  const Node image = tree.map(top), offset = tree.list(top);
  image->items = (*shown)->items;
  for (const double number : {0.0, 0.5}) Tree::push(offset, tree.number(top, number));
  tree.put(image, "offset", offset);
  *shown = image;
}

/// The same pattern by Oktett's u and v.
static PovPattern laid_pattern(Tree& tree, const PovPattern& p) {
  PovPattern laid = p;
  laid.uv = {};
  const Node width = tree.map(p.where, "width", tree.vector(p.where, {1, 0, 0}));
  laid.modifiers.emplace_back(tree.map(p.where, "repeat", width));
  const auto [scale, first] = p.uv;
  const Affine to_pov =
      Affine::translation({first[0], first[1], 0}) * Affine::scaling({scale[0], scale[1], 1});
  Moves moves;
  moves.add({Move::Kind::matrix, {}, to_pov.inverse(), p.where});
  laid.move(moves);
  return laid;
}

PovPattern alpha_of(Tree& tree, const PovPattern& image) {
  PovPattern alpha = image;
  alpha.image = tree.map(image.where), alpha.own = tree.map(image.where);
  alpha.image->items = image.image->items, alpha.own->items = image.own->items;
  tree.put(alpha.image, "channel", tree.word(image.where, "alpha"));
  *find_value(*alpha.own, "of") = alpha.image;
  return alpha;
}

PovPattern repeated_image(const PovPattern& p) {
  PovPattern repeated = p;
  repeated.once = false;
  // A texture that lies by u and v itself needs no place.
  if (p.uses_uv && !p.is_moved()) return repeated;
  repeated.is_ring &= !p.uses_uv;
  repeated.modifiers.clear(), repeated.turbulence = {0, 0, 0}, repeated.uses_uv = false, repeated.uv = {};
  return repeated;
}

Node once_node(Context& context, const PovPattern& p, Node inside, Node outside) {
  Tree& tree = context.tree;
  PovPattern mask = p;
  mask.key = "function", mask.own = tree.map(p.where), mask.image = nullptr, mask.once = false;
  const std::string above = "max(0, sign(abs(y - 0.5) - 0.5))";
  tree.put(
      mask.own, "f",
      tree.text(p.where,
                p.is_around && !p.uses_uv ? above : "max(max(0, sign(abs(x - 0.5) - 0.5)), " + above + ")"));
  const Node values = tree.list(p.where);
  push_entry(tree, p.where, values, 0, inside), push_entry(tree, p.where, values, 1, outside);
  return pattern_node(context, mask, values);
}

Node pattern_node(Context& context, const PovPattern& p, Node values) {
  Tree& tree = context.tree;
  const Place& where = p.where;
  if (p.once)
    return once_node(context, p, pattern_node(context, repeated_image(p), values), tree.number(where, 0));
  if (p.image != nullptr && p.uses_uv && !p.is_moved()) return laid_image(tree, p);
  if (p.uses_uv && !(p.uv == UvLayout{})) return pattern_node(context, laid_pattern(tree, p), values);
  const Node keys = tree.map(where);
  if (p.own != nullptr) keys->items = p.own->items;
  if (p.is_ring && !p.uses_uv) from_inside(tree, keys);
  if (values != nullptr) tree.put(keys, p.is_list ? "colors" : "map", values);
  const bool has_values = p.key != "projected" && p.key != "over";
  if (has_values) {
    if (!p.wave.empty()) tree.put(keys, "wave", tree.word(where, p.wave));
    if (p.exponent != 1) tree.put(keys, "exponent", tree.number(where, p.exponent));
    if (p.frequency != 1) tree.put(keys, "frequency", tree.number(where, p.frequency));
    if (p.phase != 0) tree.put(keys, "phase", tree.number(where, p.phase));
  }
  if (!(p.turbulence == Vec3d{0, 0, 0})) tree.put(keys, "turbulence", turbulence_node(tree, where, p));
  put_generator(context, p, keys);
  // The last moves are the transform; what is nearer to the pattern stands among the warps.
  std::size_t count = p.modifiers.size();
  Node transform = nullptr;
  if (count > 0)
    if (const auto* const last = std::get_if<Moves>(&p.modifiers.back())) {
      transform = moves_node(tree, where, *last);
      --count;
    }
  if (count > 0) {
    const Node warps = tree.list(where);
    for (std::size_t i = 0; i < count; ++i) {
      if (const auto* const moves = std::get_if<Moves>(&p.modifiers[i])) {
        if (const Node node = moves_node(tree, where, *moves))
          Tree::push(warps, tree.map(where, "transform", node));
      } else {
        Tree::push(warps, std::get<Node>(p.modifiers[i]));
      }
    }
    tree.put(keys, "warps", warps);
  }
  if (transform != nullptr) tree.put(keys, "transform", transform);
  if (p.uses_uv) tree.put(keys, "by_uv", tree.flag(where, true));
  return tree.map(where, p.key, keys);
}

}  // namespace oktett::pov
