#include "io/pov/translate/atmosphere.h"

#include <algorithm>
#include <cmath>

#include "io/pov/translate/look.h"
#include "io/pov/translate/pattern_node.h"

namespace oktett::pov {
namespace {

struct PovFog {
  double type = 1, distance = 0, offset = 0, altitude = 0;
  PovColor color;
  Vec3d up{0, 1, 0}, turbulence{0, 0, 0};
  double turb_depth = 0.5, octaves = 6, lambda = 2, omega = 0.5;
  Moves moves;
};

void read_fog(Context& context, const Block& block, PovFog& fog) {
  Arguments a(context, block);
  while (!a.at_end()) {
    if (take_moves(context, a, fog.moves)) continue;
    if (const Block* const inner = a.peek_block()) {
      if (inner->keyword == "fog") read_fog(context, *inner, fog);
      a.take();
    } else if (a.take_word("fog_type")) {
      fog.type = a.number("a kind of fog");
    } else if (a.take_word("distance")) {
      fog.distance = a.number("a distance");
    } else if (a.take_word("fog_offset")) {
      fog.offset = a.number("a height");
    } else if (a.take_word("fog_alt")) {
      fog.altitude = a.number("a height");
    } else if (a.take_word("up")) {
      fog.up = a.vector("a direction");
    } else if (a.take_word("turbulence")) {
      fog.turbulence = a.vector("a number");
    } else if (a.take_word("turb_depth")) {
      fog.turb_depth = a.number("a number");
    } else if (a.take_word("octaves")) {
      fog.octaves = a.number("a number");
    } else if (a.take_word("lambda")) {
      fog.lambda = a.number("a number");
    } else if (a.take_word("omega")) {
      fog.omega = a.number("a number");
    } else if (a.is_numbers()) {
      fog.color = a.color("a colour");
    } else {
      a.take();
    }
  }
}

struct PovRainbow {
  Vec3d direction{0, 0, 0}, up{0, 1, 0};
  double angle = 0, width = 0, distance = 0, arc = 360, falloff = 360;
  Pigment colors;
};

void read_rainbow(Context& context, const Block& block, PovRainbow& bow) {
  Arguments a(context, block);
  while (!a.at_end()) {
    if (const Block* const inner = a.peek_block()) {
      if (inner->keyword == "rainbow") {
        read_rainbow(context, *inner, bow);
      } else if (inner->keyword == "color_map" || inner->keyword == "colour_map") {
        Block pigment;
        pigment.keyword = "pigment", pigment.where = inner->where, pigment.elements = {a.peek()};
        bow.colors = Pigment{};
        read_pigment(context, pigment, bow.colors);
      }
      a.take();
    } else if (a.take_word("direction")) {
      bow.direction = a.vector("a direction");
    } else if (a.take_word("up")) {
      bow.up = a.vector("a direction");
    } else if (a.take_word("angle")) {
      bow.angle = a.number("an angle");
    } else if (a.take_word("width")) {
      bow.width = a.number("an angle");
    } else if (a.take_word("distance")) {
      bow.distance = a.number("a distance");
    } else if (a.take_word("arc_angle")) {
      bow.arc = a.number("an angle");
    } else if (a.take_word("falloff_angle")) {
      bow.falloff = a.number("an angle");
    } else {
      a.take();
    }
  }
}

}  // namespace

Node rainbow_node(Context& context, const Block& block) {
  PovRainbow bow;
  read_rainbow(context, block, bow);
  const Place& where = block.where;
  if (!(bow.distance > 0) || !(bow.width > 0) || !(length(bow.direction) > 0) || !(length(bow.up) > 0) ||
      bow.colors.entries.empty()) {
    context.tell("rainbow", where,
                 "a rainbow without 'direction', 'up', 'color_map', or a 'width' and 'distance' greater than "
                 "0 is left out");
    return nullptr;
  }
  Tree& tree = context.tree;
  const Node node = tree.map(where), colors = tree.list(where);
  const auto put = [&](Node map, const char* key, double value) {
    tree.put(map, key, tree.number(where, value));
  };
  tree.put(node, "direction", tree.vector(where, bow.direction));
  put(node, "angle", std::clamp(bow.angle, 0.0, 180.0)), put(node, "width", std::min(bow.width, 360.0));
  put(node, "distance", bow.distance);
  tree.put(node, "up", tree.vector(where, bow.up));
  if (bow.arc < 360) put(node, "arc", std::max(bow.arc, 0.0));
  // Bows fade from the middle between both angles on.
  if (bow.falloff < 360)
    put(node, "falloff_arc", (std::max(bow.falloff, 0.0) + std::clamp(bow.arc, 0.0, 360.0)) / 2);
  for (const PigmentEntry& entry : bow.colors.entries) {
    const Node color = tree.map(where);
    put(color, "at", std::clamp(entry.at, 0.0, 1.0));
    tree.put(color, "color", color_node(tree, where, entry.color.rgb));
    if (entry.color.transmit != 0) put(color, "transmit", std::clamp(entry.color.transmit, 0.0, 1.0));
    if (entry.color.filter != 0) put(color, "filter", std::clamp(entry.color.filter, 0.0, 1.0));
    Tree::push(colors, color);
  }
  tree.put(node, "colors", colors);
  return node;
}

Node fog_node(Context& context, const Block& block) {
  PovFog fog;
  read_fog(context, block, fog);
  const Place& where = block.where;
  if (!(fog.distance > 0)) {
    context.tell("fog distance", where, "a fog without a 'distance' greater than 0 is left out");
    return nullptr;
  }
  Tree& tree = context.tree;
  const Node node = tree.map(where);
  tree.put(node, "distance", tree.number(where, fog.distance));
  tree.put(node, "color", color_node(tree, where, fog.color.rgb));
  const auto put_part = [&](const char* key, double part) {
    if (part != 0) tree.put(node, key, tree.number(where, std::clamp(part, 0.0, 1.0)));
  };
  put_part("filter", fog.color.filter), put_part("transmit", fog.color.transmit);
  if (!(fog.turbulence == Vec3d{0, 0, 0})) {
    tree.put(node, "turbulence", tree.vector(where, fog.turbulence));
    const auto put = [&](const char* key, double value, double usual, double least, double most) {
      if (value != usual) tree.put(node, key, tree.number(where, std::clamp(value, least, most)));
    };
    tree.put(node, "noise_generator", tree.word(where, generator_name(context.noise_generator)));
    put("turbulence_depth", fog.turb_depth, 0.5, 0, 1);
    put("octaves", std::trunc(fog.octaves), 6, 1, 16), put("lambda", fog.lambda, 2, 0.01, 100);
    put("omega", fog.omega, 0.5, 0, 10);
  }
  if (fog.type != 2) return node;
  // At the altitude 0 fog ends sharply.
  tree.put(node, "altitude", tree.number(where, std::max(std::abs(fog.altitude), 1e-6)));
  if (fog.offset != 0) tree.put(node, "offset", tree.number(where, fog.offset));
  // Only directions are moved: offset and altitude stay as they are.
  const Vec3d up = fog.moves.all.vector(fog.up);
  if (!(up == Vec3d{0, 1, 0}) && length(up) > 0) tree.put(node, "up", tree.vector(where, up));
  return node;
}

}  // namespace oktett::pov
