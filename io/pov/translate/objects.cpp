#include "io/pov/translate/objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "io/pov/translate/shapes.h"
#include "io/pov/translate/skins.h"
#include "io/pov/translate/view.h"

namespace oktett::pov {

/// A declared object of so many shapes stands once if it is used more than once; in combinations, where
/// instances cost more, one of that many.
static constexpr int kInstanceWeight = 4, kOperandWeight = 100;
/// Scene files have 16 lists of what lights light, one of which is that of lights outside of groups.
static constexpr int kMostLightGroups = 15;

struct ObjectWriter::Modifiers {
  Moves moves;
  struct Clip {
    std::shared_ptr<const Block> block;
    std::size_t moves_before;
  };
  std::vector<Clip> clips, bounds;
  Dress own;
  bool no_shadow = false, no_image = false, no_reflection = false, inverse = false;
  bool hollow = false, lit_behind = false;
  bool lit_by_all = false;  ///< of a light_group: by the lights outside, too
  Affine before_interior;   ///< transforms that stand before the interior
  bool changes_look() const { return own.has_texture() || own.interior != nullptr; }
  bool hides() const { return no_shadow || no_image || no_reflection; }
};

ObjectWriter::ObjectWriter(Context& context) : ObjectWriter(context, context.document.statements) {}

ObjectWriter::ObjectWriter(Context& context, std::span<const Element> shown)
    : context_(context), wardrobe_(context) {
  for (const Element& statement : shown)
    if (const auto* const block = std::get_if<std::shared_ptr<const Block>>(&statement.value))
      count_uses(*block);
}

void ObjectWriter::count_uses(const std::shared_ptr<const Block>& block) {
  if (!block) return;
  const bool is_named = is_object(block->keyword) && !block->name.empty();
  if (is_named && ++uses_[block.get()] > 1) return;
  for (const Element& e : block->elements)
    if (const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value))
      if (*inner && (is_object((*inner)->keyword) || (*inner)->keyword == "clipped_by")) count_uses(*inner);
}

int ObjectWriter::weight(const Block& block) {
  const auto [entry, is_new] = weights_.try_emplace(&block, 0);
  if (!is_new) return entry->second;
  constexpr std::array<std::string_view, 14> kHeavy{
      "mesh",  "mesh2", "height_field", "isosurface", "blob",          "poly",          "quartic",
      "cubic", "lathe", "sor",          "prism",      "bicubic_patch", "julia_fractal", "parametric"};
  int sum = std::ranges::find(kHeavy, block.keyword) != kHeavy.end() ? kOperandWeight : 0;
  bool has_children = false;
  for (const Element& e : block.elements)
    if (const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value))
      if (*inner && is_object((*inner)->keyword))
        sum = std::min(1000, sum + weight(**inner)), has_children = true;
  if (!has_children) sum = std::max(sum, 1);
  return weights_[&block] = sum;
}

bool ObjectWriter::is_dressed(const Block& block) {
  if (const auto known = dressed_.find(&block); known != dressed_.end()) return known->second;
  bool any_child = false, all = true;
  for (const Element& e : block.elements) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    if (inner == nullptr || *inner == nullptr) continue;
    const std::string_view k = (*inner)->keyword;
    if (is_look(k) || k == "material") return true;
    if (is_object(k)) any_child = true, all &= is_dressed(**inner);
  }
  if (!block.name.empty()) dressed_[&block] = any_child && all;
  return any_child && all;
}

bool ObjectWriter::holds(std::map<const Block*, bool>& known, const Block& block, std::string_view keyword) {
  if (const auto found = known.find(&block); found != known.end()) return found->second;
  const bool has = std::ranges::any_of(block.elements, [&](const Element& e) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    if (inner == nullptr || *inner == nullptr) return false;
    const std::string_view k = (*inner)->keyword;
    const bool goes_on = is_object(k) || k == "interior" || k == "material";
    return k == keyword || (goes_on && holds(known, **inner, keyword));
  });
  if (!block.name.empty()) known[&block] = has;
  return has;
}

void ObjectWriter::add(const std::shared_ptr<const Block>& block, const Moves& moves, bool casts_shadow) {
  Outer outer;
  outer.to_world = moves.all, outer.default_texture = block->default_texture;
  const Maybe built = build(block, outer);
  if (!built || built->node == nullptr) return;
  Node node = built->node;
  Tree& tree = context_.tree;
  const Place& where = block->where;
  if (!moves.empty() || !casts_shadow) {
    const Node list = tree.list(where);
    Tree::push(list, node);
    node = tree.map(where, "group", list);
    if (const Node transform = moves_node(tree, where, moves)) tree.put(node, "transform", transform);
    if (!casts_shadow) {
      const Node rays = tree.list(where);
      for (const char* ray : {"camera", "diffuse", "glossy", "transmission", "volume"})
        Tree::push(rays, tree.word(where, ray));
      tree.put(node, "visible_to", rays);
    }
  }
  std::string name = block->name;
  if (name.empty() && block->keyword == "object" && !block->elements.empty())
    if (const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&block->elements[0].value);
        inner != nullptr && *inner != nullptr)
      name = (*inner)->name;
  if (!name.empty() && !has_key(*node, "name"))
    tree.put(node, "name", tree.text(where, context_.unique(object_names_, name)));
  Tree::push(context_.objects, node);
}

ObjectWriter::Asked ObjectWriter::add_asked(const std::shared_ptr<const Block>& block, bool as_solid) {
  Outer outer;
  outer.operand = as_solid;
  asked_ = true;
  const Maybe built = build(block, outer);
  asked_ = false;
  if (!built || built->node == nullptr || (as_solid && !built->solid)) return {};
  Tree::push(context_.objects, built->node);
  return {true, built->solid, built->negative};
}

void ObjectWriter::add_light(const std::shared_ptr<const Block>& block, const Affine& to_world) {
  const std::vector<std::shared_ptr<const Block>> inner = objects_in(*block);
  if (!inner.empty()) {
    // One of a union of lights is that union.
    Moves moves = moves_in(context_, *block);
    if (!(to_world == Affine{})) moves.add({Move::Kind::matrix, {}, to_world, block->where});
    return add(inner[0], moves);
  }
  const LightBody body = pov::add_light(context_, *block, to_world);
  if (!body.object) return;
  Moves moves = body.moves;
  if (!(to_world == Affine{})) moves.add({Move::Kind::matrix, {}, to_world, block->where});
  add(body.object, moves, false);
}

// ---- One object.

ObjectWriter::Maybe ObjectWriter::build(const std::shared_ptr<const Block>& block, const Outer& outer) {
  const bool is_shared =
      !hidden_ && !block->name.empty() && uses_.contains(block.get()) && uses_.at(block.get()) > 1;
  if (is_shared && !holds(lit_, *block, "light_source")) {
    const bool keeps_look =
        asked_ || is_dressed(*block) || (!outer.dress.has_texture() && outer.dress.interior == nullptr);
    const int least = outer.operand ? kOperandWeight : kInstanceWeight;
    // The patterns of media have a place in the world.
    if (keeps_look && weight(*block) >= least && !holds(media_in_, *block, "media"))
      return build_instance(block, outer);
  }
  return build_object(*block, outer);
}

ObjectWriter::Maybe ObjectWriter::build_instance(const std::shared_ptr<const Block>& block,
                                                 const Outer& outer) {
  auto found = prototypes_.find(block.get());
  if (found == prototypes_.end()) {
    Outer inside;
    inside.default_texture = outer.default_texture;
    inside.prototype = true;
    const Maybe built = build_object(*block, inside);
    Prototype prototype;
    if (built && built->node && !built->negative) {
      prototype = {context_.unique(prototype_names_, block->name), built->solid};
      context_.tree.put(context_.define, prototype.name, built->node);
    }
    found = prototypes_.emplace(block.get(), prototype).first;
  }
  const Prototype& prototype = found->second;
  if (prototype.name.empty()) return std::nullopt;
  const Node node =
      context_.tree.map(block->where, "instance", context_.tree.text(block->where, prototype.name));
  return Built{node, prototype.solid, false};
}

/// Whether an object, or the only one that it is a copy of, has a texture or a part of one.
static bool has_own_look(const Block& block) {
  const Block* only = nullptr;
  std::size_t objects = 0;
  for (const Element& e : block.elements) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    if (inner == nullptr || *inner == nullptr) continue;
    if (is_look((*inner)->keyword) || (*inner)->keyword == "material") return true;
    if (is_object((*inner)->keyword)) only = inner->get(), ++objects;
  }
  return block.keyword == "object" && objects == 1 && has_own_look(*only);
}

/// What stands behind an object in a block `object` goes on with it, but for what bounds it.
static Block continued(const Block& object, const Block& behind) {
  Block whole = object;
  std::ranges::copy_if(behind.elements, std::back_inserter(whole.elements), [](const Element& e) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    return inner == nullptr || *inner == nullptr || (*inner)->keyword != "bounded_by";
  });
  if (!has_own_look(object)) whole.default_texture = behind.default_texture;
  return whole;
}

ObjectWriter::Maybe ObjectWriter::build_object(const Block& block, const Outer& outer) {
  const std::string_view k = block.keyword;
  Arguments arguments(context_, block);
  const bool is_union = k == "union" || k == "merge" || k == "light_group";
  const bool is_combination = is_union || k == "intersection" || k == "difference";
  if (!is_combination && k != "object") return build_shape(block, outer, arguments);
  std::vector<std::shared_ptr<const Block>> children;
  // Objects may stand behind modifiers, too.
  Block rest = block;
  rest.elements.clear();
  for (const Element& e : block.elements) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    const bool is_child = inner != nullptr && *inner != nullptr &&
                          (is_object((*inner)->keyword) || (*inner)->keyword == "light_source");
    if (is_child)
      children.push_back(*inner);
    else
      rest.elements.push_back(e);
  }
  Arguments behind(context_, rest);
  const Modifiers m = read_modifiers(block, behind);
  if (children.empty()) {
    context_.warn(block.where, fmt::format("'{}' contains no object, and is left out", k));
    return std::nullopt;
  }
  if (k == "object" && children.size() == 1 && children[0]->keyword != "light_source" && m.changes_look() &&
      !hidden_ && !asked_) {
    Outer around = outer;
    around.within = outer.within.meet(limits_of(context_, block, "bounded_by").moved(m.moves.all));
    return build_object(continued(*children[0], rest), around);
  }
  if (k == "light_group") return build_light_group(block, children, m, outer);
  return build_children(block, children, m, outer);
}

/// Whether all that bounds an object is a shape that scene files can look through.
static bool is_bounded_by_windows(const Block& block) {
  constexpr std::array<std::string_view, 6> kWindows{"sphere", "box", "cylinder", "cone", "plane", "torus"};
  return std::ranges::all_of(block.elements, [&](const Element& e) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    if (inner == nullptr || *inner == nullptr || (*inner)->keyword != "bounded_by") return true;
    return std::ranges::all_of(objects_in(**inner), [&](const std::shared_ptr<const Block>& object) {
      return std::ranges::find(kWindows, object->keyword) != kWindows.end() && !has_word(*object, "inverse");
    });
  });
}

/// What stands in a block `interior_texture`, as a texture.
static std::shared_ptr<const Block> texture_of_back(const Block& block) {
  auto texture = std::make_shared<Block>(block);
  texture->keyword = "texture";
  return texture;
}

ObjectWriter::Modifiers ObjectWriter::read_modifiers(const Block& block, Arguments& a) {
  Modifiers m;
  bool by_uv = false;
  while (!a.at_end()) {
    const Place where = a.where();
    if (take_moves(context_, a, m.moves)) continue;
    if (const std::shared_ptr<const Block> inner = a.peek_shared_block()) {
      a.take();
      const std::string_view k = inner->keyword;
      if (is_look(k)) {
        m.own.items.push_back({inner, block.default_texture, m.moves.all, by_uv});
      } else if (k == "interior") {
        m.own.interior = inner, m.before_interior = m.moves.all;
      } else if (k == "material") {
        read_material(*inner, block.default_texture, m);
      } else if (k == "clipped_by") {
        m.clips.push_back({inner, m.moves.list.size()});
      } else if (k == "interior_texture") {
        m.own.back.push_back({texture_of_back(*inner), block.default_texture, m.moves.all});
      } else if (k == "bounded_by") {
        m.bounds.push_back({inner, m.moves.list.size()});
      } else if (k != "photons" && k != "radiosity" && k != "uv_mapping") {
        context_.tell(fmt::format("modifier {}", k), where,
                      fmt::format("'{}' of an object has no meaning here, and is left out", k));
      }
      continue;
    }
    if (a.take_word("no_shadow"))
      m.no_shadow = a.flag();
    else if (a.take_word("no_image"))
      m.no_image = a.flag();
    else if (a.take_word("no_reflection"))
      m.no_reflection = a.flag();
    else if (a.take_word("inverse"))
      m.inverse = !m.inverse;
    else if (a.take_word("hollow"))
      m.hollow = a.flag();
    else if (a.take_word("uv_mapping"))
      by_uv = a.flag();
    else if (a.take_word("double_illuminate"))
      m.lit_behind = a.flag();
    else if (a.take_word("global_lights"))
      m.lit_by_all = a.flag();
    else if (a.take_word("sturm") || a.take_word("hierarchy") || a.take_word("open") ||
             a.take_word("no_radiosity") || a.take_word("split_union") || a.take_word("cutaway_textures"))
      a.flag();
    else
      a.take();
  }
  return m;
}

/// The textures and the interior of a block `material`, whose transforms move these alone.
void ObjectWriter::read_material(const Block& block, const std::shared_ptr<const Block>& default_texture,
                                 Modifiers& m) {
  Arguments a(context_, block);
  while (!a.at_end()) {
    Moves moves;
    if (take_moves(context_, a, moves)) {
      if (!moves.all.is_invertible()) continue;
      const Affine back = moves.all.inverse();
      for (LookItem& item : m.own.items) item.to_texture = back * item.to_texture;
      for (LookItem& item : m.own.back) item.to_texture = back * item.to_texture;
      m.before_interior = back * m.before_interior;
      continue;
    }
    const std::shared_ptr<const Block> inner = a.peek_shared_block();
    a.take();
    if (inner == nullptr) continue;
    if (inner->keyword == "texture") m.own.items.push_back({inner, default_texture, m.moves.all});
    if (inner->keyword == "interior_texture")
      m.own.back.push_back({texture_of_back(*inner), default_texture, m.moves.all});
    if (inner->keyword == "interior") m.own.interior = inner, m.before_interior = m.moves.all;
    if (inner->keyword == "material") read_material(*inner, default_texture, m);
  }
}

/// The look of an object with these modifiers, as seen from its space before its transforms.
Dress ObjectWriter::dress_of(const Modifiers& m, const Outer& outer) const {
  Dress dress = outer.dress;
  dress.put_before(m.moves.all);
  if (m.own.has_texture()) dress.items = m.own.items, dress.back = m.own.back;
  if (!m.own.back.empty()) dress.back = m.own.back;
  if (m.hollow) dress.hollow = true;
  if (m.lit_behind) dress.lit_behind = true;
  if (!m.own.interior) return dress;
  dress.interior = m.own.interior;
  const Affine whole = outer.to_world * m.moves.all;
  dress.interior_to_world = m.before_interior.is_invertible() ? whole * m.before_interior.inverse() : whole;
  return dress;
}

ObjectWriter::Maybe ObjectWriter::build_shape(const Block& block, const Outer& outer, Arguments& arguments) {
  ShapeLimits limits{limits_of(context_, block, "clipped_by"), limits_of(context_, block, "bounded_by"),
                     is_bounded_by_windows(block)};
  // What encloses it, seen from its space.
  const Moves moves = moves_in(context_, block);
  if (moves.all.is_invertible()) limits.within = limits.within.meet(outer.within.moved(moves.all.inverse()));
  const bool is_clipped = std::ranges::any_of(block.elements, [](const Element& e) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    return inner != nullptr && *inner != nullptr && (*inner)->keyword == "clipped_by";
  });
  std::optional<Shapes> shapes = make_shapes(context_, arguments, limits, {outer.operand, is_clipped});
  const Modifiers m = read_modifiers(block, arguments);
  if (!shapes || shapes->parts.empty()) return std::nullopt;
  Tree& tree = context_.tree;
  Dress dress = dress_of(m, outer);
  dress.shape = block.keyword;
  std::vector<Built> parts;
  const bool single = shapes->parts.size() == 1;
  for (Shape& shape : shapes->parts) {
    Dress own = dress;
    if (shape.texture) own.items = {{shape.texture, block.default_texture, {}}};
    own.put_before(shape.first.all), own.solid = shapes->solid;
    const Node node = tree.map(block.where, shape.key, shape.value);
    // What only cuts has no surface; that of what is asked has no look.
    if (hidden_ || shape.invisible)
      tree.put(node, "material", wardrobe_.invisible(block.where));
    else if (!asked_)
      tree.put(node, "material", wardrobe_.material(own, outer.default_texture, block.where));
    Moves all = shape.first;
    if (single && m.clips.empty()) all.add(m.moves);
    if (const Node transform = moves_node(tree, block.where, all)) tree.put(node, "transform", transform);
    parts.push_back({node, shapes->solid, false});
  }
  if (single) return finish(block, m, outer, parts[0], m.clips.empty());
  Built whole;
  if (shapes->meet || (shapes->solid && (outer.operand || is_clipped))) {
    whole = combine(block.where, shapes->meet ? "intersection" : "union", parts);
    whole.solid = shapes->solid;
  } else {
    std::vector<Node> nodes;
    for (const Built& part : parts) nodes.push_back(part.node);
    whole = {list_node(block.where, "group", nodes), shapes->solid, false};
  }
  if (shapes->beyond_bounds)
    return finish(block, m, outer, seen_through_bounds(block, m, outer, whole), true);
  return finish(block, m, outer, whole, false);
}

ObjectWriter::Built ObjectWriter::seen_through_bounds(const Block& block, const Modifiers& m,
                                                      const Outer& outer, Built built) {
  Tree& tree = context_.tree;
  Outer inside;
  inside.operand = true, inside.default_texture = outer.default_texture;
  std::vector<Node> windows;
  const bool was_asked = std::exchange(asked_, true);
  for (const Modifiers::Clip& bound : m.bounds) {
    Moves moves = moves_in(context_, *bound.block);
    for (std::size_t k = bound.moves_before; k < m.moves.list.size(); ++k) moves.add(m.moves.list[k]);
    for (const Built& part : build_all(objects_in(*bound.block), inside)) {
      if (!part.node || part.negative) continue;
      windows.push_back(part.node);
      add_moves(part.node, moves, block.where);
    }
  }
  asked_ = was_asked;
  add_moves(built.node, m.moves, block.where);
  if (windows.empty()) return built;
  built.node = list_node(block.where, "union", {built.node});
  const Node list = tree.list(block.where);
  for (const Node window : windows) Tree::push(list, window);
  tree.put(built.node, "seen_through", list);
  return built;
}

std::vector<ObjectWriter::Built> ObjectWriter::build_all(
    const std::vector<std::shared_ptr<const Block>>& children, const Outer& outer) {
  std::vector<Built> built;
  for (const auto& child : children) {
    if (child->keyword == "light_source") {
      if (!asked_) add_light(child, outer.to_world);
      continue;
    }
    Maybe part = build(child, outer);
    if (part && outer.operand && !part->solid) {
      *part = surfaces_of(child->where, *part);
      // A box without thickness has the opposite of nothing.
      if (child->keyword == "box") part->surfaces = false;
    }
    built.push_back(part ? *part : Built{});
  }
  return built;
}

ObjectWriter::Maybe ObjectWriter::build_children(const Block& block,
                                                 const std::vector<std::shared_ptr<const Block>>& children,
                                                 const Modifiers& m, const Outer& outer) {
  const std::string_view k = block.keyword;
  Outer inner = outer;
  inner.dress = dress_of(m, outer);
  inner.to_world = outer.to_world * m.moves.all;
  inner.operand =
      outer.operand || !m.clips.empty() || k == "intersection" || k == "difference" || k == "merge";
  inner.within = limits_of(context_, block, "clipped_by").meet(limits_of(context_, block, "bounded_by"));
  if (m.moves.all.is_invertible())
    inner.within = inner.within.meet(outer.within.moved(m.moves.all.inverse()));
  if (k == "intersection")
    for (const auto& child : children) inner.within = inner.within.meet(extent_of(context_, *child));
  if (k == "difference") inner.within = inner.within.meet(extent_of(context_, *children[0]));
  std::vector<Built> parts = build_all(children, inner);
  // Without one of these nothing is left, or nobody knows what.
  const bool lost = (k == "intersection" || k == "object") &&
                    std::ranges::any_of(parts, [](const Built& b) { return !b.node; });
  if (lost || parts.empty() || (k == "difference" && !parts[0].node)) return std::nullopt;
  if (k == "difference") leave_skins(children, parts);
  std::erase_if(parts, [](const Built& b) { return !b.node; });
  if (parts.empty()) return std::nullopt;
  if (k == "object") {
    if (parts.size() == 1) {
      Built only = parts[0];
      // Its transforms join those of the only object in it, unless it is cut.
      return finish(block, m, outer, only, false);
    }
    context_.tell("object", block.where, "an 'object' of several objects counts as a union");
  }
  if (inner.operand)
    return finish(block, m, outer, combine(block.where, k == "merge" || k == "object" ? "union" : k, parts),
                  false);
  std::vector<Node> nodes;
  bool solid = true;
  for (const Built& part : parts) nodes.push_back(part.node), solid &= part.solid;
  return finish(block, m, outer,
                {nodes.size() == 1 ? nodes[0] : list_node(block.where, "group", nodes), solid, false}, false);
}

void ObjectWriter::leave_skins(const std::vector<std::shared_ptr<const Block>>& children,
                               std::vector<Built>& parts) {
  std::vector<std::shared_ptr<const Block>> solids;
  std::ranges::copy_if(children, std::back_inserter(solids),
                       [](const auto& child) { return child->keyword != "light_source"; });
  std::vector<bool> counts;
  for (const Built& part : parts) counts.push_back(part.node && !part.negative && !part.surfaces);
  const std::vector<Moves> moves = room_for_skins(context_, solids, counts);
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (parts[i].node) add_moves(parts[i].node, moves[i], solids[i]->where);
}

ObjectWriter::Maybe ObjectWriter::build_light_group(const Block& block,
                                                    const std::vector<std::shared_ptr<const Block>>& children,
                                                    const Modifiers& m, const Outer& outer) {
  Tree& tree = context_.tree;
  const std::size_t before = context_.light_keys.size();
  const Maybe built = build_children(block, children, m, outer);
  if (asked_) return built;
  if (!built) {
    context_.lights->items.resize(before), context_.light_keys.resize(before);
    return built;
  }
  if (outer.operand || context_.light_groups == kMostLightGroups) {
    context_.tell("light_group", block.where,
                  fmt::format("in combinations, and beyond {} of them, lights of a 'light_group' light all "
                              "objects",
                              kMostLightGroups));
    return built;
  }
  ++context_.light_groups;
  const std::string name = context_.unique(object_names_, "light_group");
  for (std::size_t i = before; i < context_.light_keys.size(); ++i) {
    const Node keys = context_.light_keys[i], list = tree.list(block.where);
    if (has_key(*keys, "only")) continue;
    Tree::push(list, tree.text(block.where, name));
    tree.put(keys, "only", list);
  }
  if (!m.lit_by_all) context_.lit_alone.push_back(name);
  Built group{list_node(block.where, "group", {built->node}), built->solid, built->negative};
  tree.put(group.node, "name", tree.text(block.where, name));
  return group;
}

/// Adds transforms behind those that an object of scene files has.
void ObjectWriter::add_moves(Node object, const Moves& moves, const Place& where) {
  if (moves.empty()) return;
  if (has_key(*object, "transform"))
    extend_transform(object, moves);
  else
    context_.tree.put(object, "transform", moves_node(context_.tree, where, moves));
}

/// Adds transforms, unless they are there already, and what cuts or hides the object.
ObjectWriter::Built ObjectWriter::finish(const Block& block, const Modifiers& m, const Outer& outer,
                                         Built built, bool moved) {
  Tree& tree = context_.tree;
  const Place& where = block.where;
  const auto move = [&](const Moves& moves) { add_moves(built.node, moves, where); };
  std::size_t done = 0;
  const auto moves_until = [&](std::size_t end) {
    Moves some;
    for (; done < end; ++done) some.add(m.moves.list[done]);
    return some;
  };
  for (const Modifiers::Clip& clip : m.clips) {
    if (!moved) move(moves_until(clip.moves_before));
    if (!built.solid) built = surfaces_of(where, built);
    Outer inside;
    inside.operand = true, inside.default_texture = outer.default_texture;
    const bool was_hidden = std::exchange(hidden_, true);
    std::vector<Built> parts = build_all(objects_in(*clip.block), inside);
    hidden_ = was_hidden;
    std::erase_if(parts, [](const Built& b) { return !b.node; });
    if (parts.empty()) continue;
    Built cutter = parts.size() == 1 ? parts[0] : combine(clip.block->where, "intersection", parts);
    add_moves(cutter.node, moves_in(context_, *clip.block), clip.block->where);
    built = combine(where, "intersection", {built, cutter});
  }
  if (!moved) move(moves_until(m.moves.list.size()));
  if (m.inverse && !built.surfaces) built.negative = !built.negative;
  if (m.hollow && context_.has_fog && !outer.operand) set_hollow(built.node, where);
  if (m.hides()) {
    if (outer.operand) {
      context_.tell("hidden operand", where,
                    "in combinations 'no_shadow', 'no_image' and 'no_reflection' are left out");
    } else {
      const Node rays = tree.list(where);
      for (const auto& [ray, hidden] : {std::pair{"camera", m.no_image},
                                        {"diffuse", false},
                                        {"glossy", m.no_reflection},
                                        {"transmission", false},
                                        {"volume", false},
                                        {"shadow", m.no_shadow}})
        if (!hidden) Tree::push(rays, tree.word(where, ray));
      // One object has one list: what is around it hides the rest.
      built.node = list_node(where, "group", {built.node});
      tree.put(built.node, "visible_to", rays);
    }
  }
  return built;
}

/// Fog is in all that the node shows.
void ObjectWriter::set_hollow(Node object, const Place& where) {
  if (has_key(*object, "hollow")) return;
  context_.tree.put(object, "hollow", context_.tree.flag(where, true));
}

/// Appends operations to the transform that an object has.
void ObjectWriter::extend_transform(Node object, const Moves& moves) {
  Tree& tree = context_.tree;
  const YamlNode** const old = find_value(*object, "transform");
  if (old == nullptr) return;
  const Node list = tree.list(moves.list[0].where);
  if ((*old)->kind == YamlKind::sequence)
    list->items = (*old)->items;
  else
    list->items = {*old};
  const Node more = moves_node(tree, moves.list[0].where, moves);
  if (more->kind == YamlKind::sequence)
    list->items.insert(list->items.end(), more->items.begin(), more->items.end());
  else
    list->items.push_back(more);
  *old = list;
}

// ---- Combinations.

/// What has no inside, as an operand.
ObjectWriter::Built ObjectWriter::surfaces_of(const Place& where, const Built& built) {
  return {list_node(where, "surfaces", {built.node}), true, false, true};
}

Node ObjectWriter::list_node(const Place& where, std::string_view key, const std::vector<Node>& items) {
  const Node list = context_.tree.list(where);
  for (const Node item : items) Tree::push(list, item);
  return context_.tree.map(where, key, list);
}

/// A combination whose parts may be negative: scene files have none that are, but differences.
ObjectWriter::Built ObjectWriter::combine(const Place& where, std::string_view op, std::vector<Built> parts) {
  if (op == "difference") {
    for (std::size_t i = 1; i < parts.size(); ++i) parts[i].negative ^= !parts[i].surfaces;
    op = "intersection";
  }
  std::vector<Node> positive, negative;
  for (const Built& part : parts) (part.negative ? negative : positive).push_back(part.node);
  const auto several = [&](std::string_view key, const std::vector<Node>& nodes) {
    return nodes.size() == 1 ? nodes[0] : list_node(where, key, nodes);
  };
  const auto without = [&](const Node first, const std::vector<Node>& rest) {
    if (rest.empty()) return first;
    std::vector<Node> all{first};
    all.insert(all.end(), rest.begin(), rest.end());
    return list_node(where, "difference", all);
  };
  // By De Morgan's laws.
  if (op == "intersection") {
    if (positive.empty()) return {several("union", negative), true, true};
    return {without(several("intersection", positive), negative), true, false};
  }
  if (negative.empty()) return {several("union", positive), true, false};
  return {without(several("intersection", negative), positive), true, true};
}

}  // namespace oktett::pov
