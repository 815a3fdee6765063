#include "io/pov/translate/patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "io/pov/translate/functions.h"

namespace oktett::pov {
namespace {

Shapes sheet_of(std::string key, Node value) {
  Shapes shapes;
  shapes.parts.push_back({std::move(key), value, nullptr, {}});
  shapes.solid = false;
  return shapes;
}

using FunctionItem = std::shared_ptr<const Function>;

/// The box of what contains an object. That of a sphere is larger than the sphere.
void take_container(Context& context, const Block& block, Vec3d& lo, Vec3d& hi) {
  Arguments container(context, block);
  const Block* const shape = container.peek_block();
  if (shape == nullptr) context.fail(block.where, "expected a box or a sphere");
  Arguments s(context, *shape);
  if (shape->keyword == "sphere") {
    const Vec3d center = s.vector("the centre");
    const double radius = std::abs(s.number("the radius"));
    lo = center - Vec3d{radius, radius, radius}, hi = center + Vec3d{radius, radius, radius};
    context.tell("sphere around parametric", shape->where,
                 "a parametric that is contained by a sphere is cut by the box around it");
  } else {
    const Vec3d p = s.vector("a corner"), q = s.vector("a corner");
    lo = min(p, q), hi = max(p, q);
  }
}

/// What says how POV-Ray finds the surface; here that is proved.
bool take_setting(Arguments& a) {
  for (const std::string_view word : {"max_gradient", "accuracy"})
    if (a.take_word(word)) {
      a.number("a number");
      return true;
    }
  if (!a.take_word("precompute")) return false;
  a.number("a depth");
  while (a.is_numbers()) a.take();
  return true;
}

}  // namespace

std::optional<Shapes> make_patch(Context& context, Arguments& a) {
  Tree& tree = context.tree;
  const Place where = a.block().where;
  std::vector<double> uv;
  // Settings of how fine POV-Ray divides it stand before the points; in old scenes they are mere numbers.
  for (bool has_words = false;;) {
    if (a.at_end()) context.fail(a.where(), "expected 16 points");
    if (a.take_word("uv_vectors")) {
      for (int k = 0; k < 4; ++k) {
        const auto pair = a.pair("a texture coordinate");
        uv.insert(uv.end(), pair.begin(), pair.end());
      }
    } else if (!a.peek_word().empty()) {
      has_words = true;
      a.take();
      if (a.is_numbers() && !a.is_vector()) a.take();
    } else if (a.is_vector() || has_words) {
      break;
    } else {
      a.take();
    }
  }
  const Node keys = tree.map(where), patch = tree.list(where), patches = tree.list(where);
  for (int k = 0; k < 16; ++k) Tree::push(patch, tree.vector(where, a.vector("a point")));
  Tree::push(patches, patch);
  tree.put(keys, "patches", patches);
  if (!uv.empty()) tree.put(keys, "uv", tree.numbers(where, uv));
  return sheet_of("bezier_patch", keys);
}

std::optional<Shapes> make_parametric(Context& context, Arguments& a) {
  Tree& tree = context.tree;
  const Place where = a.block().where;
  const Node keys = tree.map(where);
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (const char* name : kNames) {
    const auto* const f = a.at_end() ? nullptr : std::get_if<FunctionItem>(&a.peek().value);
    if (f == nullptr) context.fail(a.where(), "expected the functions of x, y and z");
    const std::optional<std::string> text = function_text(context, **f, where, 0, kSurfaceVariables);
    if (!text) return std::nullopt;
    tree.put(keys, name, tree.text(where, *text));
    a.take();
  }
  std::array<double, 2> from = a.pair("the least u and v"), to = a.pair("the greatest u and v");
  for (std::size_t k = 0; k < 2; ++k)
    if (from[k] > to[k]) std::swap(from[k], to[k]);
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};
  while (!a.at_end()) {
    const Block* const block = a.peek_block();
    if (block != nullptr && block->keyword == "contained_by") {
      take_container(context, *block, lo, hi);
      a.take();
    } else if (!take_setting(a)) {
      break;
    }
  }
  if (from[0] == to[0] || from[1] == to[1] || !(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z)) {
    context.warn(where, "there is nothing to see of the parametric; the object is left out");
    return std::nullopt;
  }
  tree.put(keys, "from", tree.numbers(where, from)), tree.put(keys, "to", tree.numbers(where, to));
  const Node clip = tree.map(where);
  tree.put(clip, "min", tree.vector(where, lo)), tree.put(clip, "max", tree.vector(where, hi));
  tree.put(keys, "clip", clip);
  return sheet_of("parametric", keys);
}

}  // namespace oktett::pov
