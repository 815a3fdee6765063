#include "io/pov/translate/atmosphere.h"

#include <algorithm>
#include <cmath>

#include "io/pov/translate/look.h"

namespace oktett::pov {
namespace {

struct PovFog {
  double type = 1, distance = 0, offset = 0, altitude = 0;
  PovColor color;
  Vec3d up{0, 1, 0};
  Moves moves;
};

void read_fog(Context& context, const Block& block, PovFog& fog) {
  Arguments a(context, block);
  while (!a.at_end()) {
    const Place where = a.where();
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
      if (!(a.vector("a number") == Vec3d{0, 0, 0}))
        context.tell("fog turbulence", where, "'turbulence' of a fog is left out");
    } else if (a.take_word("turb_depth") || a.take_word("octaves") || a.take_word("omega") ||
               a.take_word("lambda")) {
      a.number("a number");
    } else if (a.is_numbers()) {
      fog.color = a.color("a colour");
    } else {
      a.take();
    }
  }
}

}  // namespace

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
