#include "io/pov/translate/pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "io/pov/formula_text.h"
#include "io/pov/noise_functions.h"
#include "io/pov/translate/extent.h"
#include "io/pov/translate/functions.h"
#include "io/pov/translate/inside_text.h"
#include "io/pov/translate/pattern_node.h"

namespace oktett::pov {
namespace {

/// What a pattern is called in scene files; nothing if they have none.
struct PatternName {
  std::string_view word, key;
};
constexpr PatternName kNames[] = {
    {"agate", "agate"},
    {"average", ""},
    {"boxed", "boxed"},
    {"bozo", "noise"},
    {"brick", "brick"},
    {"bumps", "bumps"},
    {"cells", "cells"},
    {"checker", "checker"},
    {"crackle", "crackle"},
    {"cubic", "cubic"},
    {"cylindrical", "cylindrical"},
    {"density_file", "voxels"},
    {"dents", "dents"},
    {"facets", ""},
    {"gradient", "linear"},
    {"granite", "granite"},
    {"hexagon", "hexagon"},
    {"julia", "fractal"},
    {"leopard", "leopard"},
    {"mandel", "fractal"},
    {"marble", "layers"},
    {"onion", "onion"},
    {"pavement", ""},
    {"planar", "planar"},
    {"proximity", ""},
    {"quilted", "quilted"},
    {"radial", "angular"},
    {"ripples", "ripples"},
    {"slope", "slope"},
    {"spherical", "spherical"},
    {"spiral1", "spiral"},
    {"spiral2", "double_spiral"},
    {"spotted", "noise"},
    {"square", "function"},
    {"tiling", ""},
    {"triangular", "function"},
    {"waves", "waves"},
    {"wood", "rings"},
    {"wrinkles", "wrinkles"},
    {"aoi", "incidence"},
};
constexpr std::array<std::string_view, 7> kLists{"brick",  "checker",    "cubic", "hexagon",
                                                 "square", "triangular", "object"};
/// What stands before one value that changes nothing here.
constexpr std::array<std::string_view, 4> kIgnored{"quick_color", "quick_colour", "interpolate", "accuracy"};
constexpr std::pair<std::string_view, std::string_view> kWaves[] = {
    {"ramp_wave", "ramp"},       {"triangle_wave", "triangle"}, {"sine_wave", "sine"},
    {"scallop_wave", "scallop"}, {"cubic_wave", "cubic"},       {"poly_wave", "poly"}};
constexpr std::array<std::string_view, 4> kMappings{"planar", "cylindrical", "spherical", "toroidal"};

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::ranges::find(words, word) != words.end();
}

/// The file of an image, whose name may lack its ending.
std::string find_image(const Context& context, const Place& where, const std::string& name) {
  for (const char* ending :
       {"", ".png", ".jpg", ".jpeg", ".gif", ".tga", ".ppm", ".pgm", ".tif", ".tiff", ".exr"}) {
    try {
      return find_file(context, where, name + ending);
    } catch (const Error&) {}
  }
  return find_file(context, where, name);
}

/// The triangles with edges of length 1, one of them from the origin along x: a sheared grid of (floor(a),
/// floor(b)) whose cells have an upright triangle and one on its tip. Three cells in a row repeat.
std::string triangle_number(const std::string& x, const std::string& z) {
  const std::string b = filled("$0 / sqrt(0.75)", {z}), a = filled("$0 - $1 / 2", {x, b});
  const std::string d = filled("floor($0) - floor($1)", {a, b});
  const std::string row = filled("$0 - 3 * floor($0 / 3)", {d});
  const std::string on_tip = filled("max(0, sign($0 - floor($0) + $1 - floor($1) - 1))", {a, b});
  // 0, 4 and 2; on their tips 3, 5 and 1.
  const std::string number = filled("$0 * (3 + 2 * $1) + (1 - $0) * (6 - 2 * $1)", {on_tip, row});
  return filled("$0 - 6 * floor($0 / 6)", {number});
}

/// Whether a block `object` is a pattern, not an object.
bool block_holds_object(const Block& block) {
  return std::ranges::any_of(block.elements, [](const Element& e) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    return inner != nullptr && *inner != nullptr && is_object((*inner)->keyword);
  });
}

}  // namespace

void PovPattern::move(const Moves& moves) {
  if (moves.empty()) return;
  if (modifiers.empty() || !std::holds_alternative<Moves>(modifiers.back())) modifiers.emplace_back(Moves{});
  std::get<Moves>(modifiers.back()).add(moves);
}

std::string number_formula(std::string_view pattern, const std::array<std::string, 3>& p) {
  if (pattern == "checker")
    return filled("$0 - 2 * floor($0 / 2)",
                  {filled("floor($0) + floor($1) + floor($2)", {p[0], p[1], p[2]})});
  if (pattern == "triangular") return triangle_number(p[0], p[2]);
  if (pattern != "square") return "";
  // In columns of even numbers 0 and 1 in turn, in the others 3 and 2.
  const std::string column = filled("floor($0) - 2 * floor($0 / 2)", {p[0]}),
                    row = filled("floor($0) - 2 * floor($0 / 2)", {p[2]});
  return filled("3 * $0 + (1 - 2 * $0) * $1", {column, row});
}

std::vector<PovColor> default_colors(const PovPattern& pattern) {
  const PovColor red{{1, 0, 0}}, green{{0, 1, 0}}, blue{{0, 0, 1}};
  if (pattern.word == "brick") return {{{0.5, 0.5, 0.5}}, {{0.6, 0.15, 0.15}}};
  if (pattern.word == "object") return {{{0, 0, 0}}, {{1, 1, 1}}};
  const PovColor yellow{{1, 1, 0}}, cyan{{0, 1, 1}}, magenta{{1, 0, 1}};
  if (pattern.word == "hexagon") return {blue, green, red};
  if (pattern.word == "square") return {red, green, blue, yellow};
  if (pattern.word == "triangular") return {red, green, blue, yellow, cyan, magenta};
  if (pattern.word == "cubic") return {red, yellow, green, cyan, blue, magenta};
  return {blue, green};
}

// ---- Reading.

void PatternReader::set(Node map, std::string_view key, Node value) {
  if (const YamlNode** const old = find_value(*map, key))
    *old = value;
  else
    context_.tree.put(map, key, value);
}

void PatternReader::put_vector(PovPattern& p, std::string_view key, const Vec3d& value) {
  set(p.own, key, context_.tree.vector(p.where, value));
}

void PatternReader::put(PovPattern& p, std::string_view key, double value) {
  set(p.own, key, context_.tree.number(p.where, value));
}

bool PatternReader::take(Arguments& a, PovPattern& p) {
  Moves moves;
  if (take_moves(context_, a, moves)) {
    p.move(moves);
    return true;
  }
  return take_block(a, p) || take_function(a, p) || take_pattern(a, p) || take_modifier(a, p);
}

Node PatternReader::texture_of(const Block& pigment) {
  const Node node = pigment_texture_(pigment);
  return node != nullptr && node->kind == YamlKind::map ? node : nullptr;
}

bool PatternReader::take_block(Arguments& a, PovPattern& p) {
  const Block* const block = a.peek_block();
  if (block == nullptr) return false;
  const std::string_view k = block->keyword;
  if (k == "warp") {
    a.take();
    if (const Node node = warp(*block)) p.modifiers.emplace_back(node);
    return true;
  }
  const bool is_image = k == "image_pattern";
  if (k == "slope") {
    // In braces.
    a.take();
    p.word = k, p.where = block->where, p.key = k, p.own = context_.tree.map(block->where), p.is_list = false;
    Arguments inner(context_, *block);
    if (inner.is_numbers()) take_slope(inner, p);
    return true;
  }
  if (k == "object" && block_holds_object(*block)) {
    a.take();
    take_object(*block, p);
    return true;
  }
  if (!is_image && k != "pigment_pattern") return false;
  a.take();
  p.word = k, p.where = block->where, p.key = "brightness", p.own = context_.tree.map(block->where);
  p.is_list = false;
  Node of = nullptr;
  if (is_image) {
    PovPattern image;
    take_image(*block, image);
    if (image.has_alpha && has_word(*block, "use_alpha")) {
      // The value is what passes through.
      image = alpha_of(context_.tree, image);
      for (const auto& [key, value] : {std::pair{"gain", -1.0}, {"base", 1.0}})
        context_.tree.put(image.image, key, context_.tree.number(p.where, value));
    }
    if (!image.key.empty()) of = pattern_node(context_, image, nullptr);
  } else {
    of = texture_of(*block);
  }
  if (of != nullptr)
    context_.tree.put(p.own, "of", of);
  else
    p.key = "";
  return true;
}

/// A pattern `object`: its first colour is outside, its second inside. What they are stands in the block,
/// too, and is read by whoever asked for the pattern.
void PatternReader::take_object(const Block& block, PovPattern& p) {
  p.word = "object", p.where = block.where, p.key = "", p.own = context_.tree.map(block.where);
  p.is_list = true;
  for (const Element& e : block.elements) {
    const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
    if (inner == nullptr || *inner == nullptr || !is_object((*inner)->keyword)) continue;
    if (const auto text = inside_text(context_, **inner)) {
      // 1 inside and on the surface, 0 outside.
      set(p.own, "f", context_.tree.text(p.where, "0.5-0.5*sign(" + *text + "-1e-9)"));
      p.key = "function";
    }
    return;
  }
}

bool PatternReader::take_function(Arguments& a, PovPattern& p) {
  const auto* const function =
      a.at_end() ? nullptr : std::get_if<std::shared_ptr<const Function>>(&a.peek().value);
  if (function == nullptr || *function == nullptr) return false;
  p.word = "function", p.where = a.where(), p.key = "function", p.own = context_.tree.map(p.where);
  p.is_list = false;
  const std::shared_ptr<const Function> f = *function;
  a.take();
  if (const std::optional<ColorFunction> of = function_of_pigment(context_, *f)) {
    if (const Node texture = texture_of(*of->pigment)) {
      context_.tree.put(p.own, "f", context_.tree.text(p.where, of->text));
      context_.tree.put(p.own, "of", texture);
      return true;
    }
  }
  if (const auto text = function_text(context_, *f, p.where))
    context_.tree.put(p.own, "f", context_.tree.text(p.where, *text));
  else
    p.key = "";
  return true;
}

bool PatternReader::take_pattern(Arguments& a, PovPattern& p) {
  if (a.peek_word() == "magnet") {
    const Place where = a.where();
    a.take();
    const bool second = a.is_numbers() && a.number("1 or 2") == 2;
    if (a.peek_word() != "mandel" && a.peek_word() != "julia") return true;
    take_pattern(a, p);
    set(p.own, "formula", context_.tree.word(where, second ? "magnet2" : "magnet1"));
    p.word = "magnet";
    return true;
  }
  const std::string_view word = a.peek_word();
  const auto* const name = std::ranges::find(kNames, word, &PatternName::word);
  if (word.empty() || name == std::end(kNames)) return false;
  p.word = word, p.where = a.where(), p.key = name->key, p.own = context_.tree.map(p.where);
  p.is_list = is_one_of(word, kLists);
  a.take();
  take_own_keys(a, p);
  return true;
}

void PatternReader::take_own_keys(Arguments& a, PovPattern& p) {
  Tree& tree = context_.tree;
  if (p.key == "noise") {
    put(p, "octaves", 1);
  } else if (p.word == "gradient") {
    const Vec3d direction = a.vector("a vector");
    tree.put(p.own, "direction", tree.vector(p.where, direction));
    p.direction = direction;
    if (!(length(direction) > 0)) p.key = "";
  } else if (p.word == "spiral1" || p.word == "spiral2") {
    put(p, "arms", std::clamp(std::trunc(a.number("the number of arms")), -1000.0, 1000.0));
  } else if (p.word == "julia" || p.word == "mandel") {
    take_fractal(a, p);
  } else if (p.word == "slope" && a.is_numbers()) {
    take_slope(a, p);
  } else if (p.word == "density_file") {
    take_density(a, p);
  } else if (p.key == "function") {
    const std::string last = std::to_string(default_colors(p).size() - 1);
    set(p.own, "f", tree.text(p.where, number_formula(p.word, {"x", "y", "z"}) + " / " + last));
  }
}

/// A direction with what counts as 0 and 1, and a height likewise; in braces or not.
void PatternReader::take_slope(Arguments& a, PovPattern& p) {
  const auto take = [&](const char* what) {
    const Vec3d direction = a.vector("a direction");
    const std::string key(what);
    put_vector(p, key, direction);
    const std::string prefix = key == "direction" ? "" : "altitude_";
    if (!a.is_numbers() || a.is_vector()) return length(direction) > 0;
    const double low = a.number("a number"), high = a.is_numbers() ? a.number("a number") : 0;
    if (low == high) return length(direction) > 0;
    put(p, prefix + "low", low), put(p, prefix + "high", high);
    return length(direction) > 0;
  };
  if (!take("direction")) p.key = "";
  if (a.take_word("altitude") && a.is_numbers()) take("altitude");
}

/// `df3 "FILE"`, with `interpolate` behind.
void PatternReader::take_density(Arguments& a, PovPattern& p) {
  a.take_word("df3");
  const Place where = a.where();
  const std::string name = a.text("the name of a file");
  try {
    set(p.own, "file", context_.tree.text(where, find_file(context_, where, name)));
  } catch (const Error& e) {
    context_.tell("density_file", where, e.what());
    p.key = "";
  }
  set(p.own, "smooth", context_.tree.flag(where, false));
}

void PatternReader::take_fractal(Arguments& a, PovPattern& p) {
  Tree& tree = context_.tree;
  if (p.word == "julia") {
    set(p.own, "set", tree.word(p.where, "julia"));
    const Vec3d constant = a.vector("a complex number");
    put(p, "real", std::clamp(constant.x, -1e3, 1e3)), put(p, "imaginary", std::clamp(constant.y, -1e3, 1e3));
  }
  if (a.is_numbers()) put(p, "iterations", std::clamp(std::trunc(a.number("a number")), 1.0, 1e5));
}

/// What may stand anywhere behind some patterns.
bool PatternReader::take_later_key(Arguments& a, PovPattern& p) {
  Tree& tree = context_.tree;
  const Place where = a.where();
  const auto is = [&](std::string_view pattern, std::string_view word) {
    return p.word == pattern && a.take_word(word);
  };
  if (is("agate", "agate_turb")) {
    put(p, "folding", std::clamp(a.number("a number"), 0.0, 100.0));
  } else if (is("brick", "brick_size")) {
    set(p.own, "brick", tree.vector(where, a.vector("a size")));
  } else if (is("brick", "mortar")) {
    put(p, "mortar", std::max(0.0, a.number("a size")));
  } else if (is("quilted", "control0")) {
    put(p, "control0", std::clamp(a.number("a number"), -10.0, 10.0));
  } else if (is("quilted", "control1")) {
    put(p, "control1", std::clamp(a.number("a number"), -10.0, 10.0));
  } else if (is("crackle", "form")) {
    set(p.own, "form", tree.vector(where, a.vector("a vector")));
  } else if (is("crackle", "metric")) {
    put(p, "metric", std::clamp(a.number("a number"), 0.1, 100.0));
  } else if (is("crackle", "offset")) {
    put(p, "offset", std::max(0.0, a.number("a number")));
  } else if (is("crackle", "solid")) {
    set(p.own, "solid", tree.flag(where, a.flag()));
  } else if (p.key == "voxels" && a.take_word("interpolate")) {
    const double kind = a.number("a kind");
    if (kind > 1)
      context_.tell("density interpolation", where, "densities are interpolated linearly, not by cubes");
    set(p.own, "smooth", tree.flag(where, kind != 0));
  } else if (p.key == "fractal" && a.take_word("exponent")) {
    put(p, "power", std::clamp(std::trunc(a.number("a number")), 2.0, 33.0));
  } else if (p.key == "fractal" && (a.peek_word() == "interior" || a.peek_word() == "exterior")) {
    constexpr std::string_view kOutside[] = {"constant",         "steps", "real", "imaginary", "real_square",
                                             "imaginary_square", "size"};
    constexpr std::string_view kInside[] = {"constant",    "least_size",       "real",  "imaginary",
                                            "real_square", "imaginary_square", "square"};
    const bool inside = a.peek_word() == "interior";
    a.take();
    const auto kind = static_cast<std::size_t>(std::clamp(a.number("a kind"), 0.0, 100.0));
    const double factor = a.is_numbers() ? a.number("a factor") : 1;
    const std::string_view key = inside ? "interior" : "exterior";
    if (kind > 6) {
      context_.tell("fractal exterior", where, fmt::format("'{}' of the kind {} is read as 1", key, kind));
      return true;
    }
    set(p.own, key, tree.word(where, inside ? kInside[kind] : kOutside[kind]));
    put(p, inside ? "interior_factor" : "exterior_factor", factor);
  } else {
    return false;
  }
  return true;
}

bool PatternReader::take_modifier(Arguments& a, PovPattern& p) {
  if (take_later_key(a, p)) return true;
  const std::string_view word = a.peek_word();
  for (const auto& [wave, name] : kWaves) {
    if (word != wave) continue;
    a.take();
    p.wave = name;
    if (name == "poly" && a.is_numbers()) p.exponent = std::clamp(a.number("an exponent"), 1e-3, 1e3);
    return true;
  }
  if (a.take_word("turbulence"))
    p.turbulence = a.vector("a number");
  else if (a.take_word("octaves"))
    p.octaves = std::clamp(std::trunc(a.number("a number")), 1.0, 16.0);
  else if (a.take_word("lambda"))
    p.lambda = std::clamp(a.number("a number"), 0.01, 100.0);
  else if (a.take_word("omega"))
    p.omega = std::clamp(a.number("a number"), 0.0, 10.0);
  else if (a.take_word("frequency"))
    p.frequency = std::clamp(a.number("a number"), -1e9, 1e9);
  else if (a.take_word("phase"))
    p.phase = std::clamp(a.number("a number"), -1e9, 1e9);
  else if (a.take_word("uv_mapping"))
    p.uses_uv = a.flag();
  else if (a.take_word("noise_generator"))
    p.noise_generator = noise_generator_named(a.number("a number"));
  else if (is_one_of(word, kIgnored)) {
    a.take();
    if (a.is_numbers()) a.take();
  } else {
    return false;
  }
  return true;
}

/// An item of `warps`; null, after a warning, for warps that scene files do not have.
Node PatternReader::warp(const Block& block) {
  Arguments a(context_, block);
  Tree& tree = context_.tree;
  const Place where = a.where();
  const std::string_view kind = a.peek_word();
  if (!a.at_end()) a.take();
  const Node keys = tree.map(where);
  if (kind == "repeat") {
    const Vec3d width = a.vector("a vector");
    tree.put(keys, "width", tree.vector(where, width));
    while (!a.at_end()) {
      if (a.take_word("offset"))
        set(keys, "offset", tree.vector(where, a.vector("a vector")));
      else if (a.take_word("flip"))
        set(keys, "flip", tree.vector(where, a.vector("a vector")));
      else
        a.take();
    }
    if ((width.x != 0) + (width.y != 0) + (width.z != 0) != 1) return nullptr;
    return tree.map(where, "repeat", keys);
  }
  if (kind == "black_hole") {
    tree.put(keys, "center", tree.vector(where, a.vector("a point")));
    const double radius = a.number("a radius");
    tree.put(keys, "radius", tree.number(where, radius));
    while (!a.at_end()) {
      const std::string_view word = a.peek_word();
      a.take();
      if (word == "strength" || word == "falloff")
        set(keys, word, tree.number(where, std::max(word == "falloff" ? 0.0 : -1e9, a.number("a number"))));
      else if (word == "inverse")
        set(keys, "inverse", tree.flag(where, a.flag()));
      else if (word == "repeat" || word == "turbulence")
        context_.tell("black holes", where, fmt::format("'{}' of a black hole is left out", word));
    }
    return radius > 0 ? tree.map(where, "black_hole", keys) : nullptr;
  }
  if (kind == "turbulence") {
    PovPattern p;
    p.turbulence = a.vector("a number");
    while (!a.at_end())
      if (!take_modifier(a, p)) a.take();
    return tree.map(where, "turbulence", turbulence_node(tree, where, p));
  }
  if (is_one_of(kind, kMappings)) {
    bool has_direction = true;
    const auto orientation = [&](const Vec3d& v) {
      has_direction = length(v) > 0;
      set(keys, "orientation", tree.vector(where, v));
    };
    if (kind == "planar" && a.is_numbers()) {
      orientation(a.vector("a vector"));
      if (a.is_numbers()) set(keys, "distance", tree.number(where, a.number("a distance")));
    }
    while (!a.at_end()) {
      if (a.take_word("orientation"))
        orientation(a.vector("a vector"));
      else if (a.take_word("dist_exp"))
        set(keys, "exponent", tree.number(where, a.number("a number")));
      else if (a.take_word("major_radius"))
        set(keys, "major_radius", tree.number(where, a.number("a radius")));
      else
        a.take();
    }
    return has_direction ? tree.map(where, kind, keys) : nullptr;
  }
  context_.tell("warp", where, fmt::format("a warp '{}' has no meaning here, and is left out", kind));
  return nullptr;
}

void PatternReader::take_image(const Block& block, PovPattern& p) {
  Arguments a(context_, block);
  Tree& tree = context_.tree;
  p.word = "image_map", p.where = block.where, p.key = "", p.own = tree.map(block.where), p.is_list = false;
  std::string_view onto = "planar";
  bool once = false;
  // Numbers of some kinds of files are taken as they are, and so are all in scenes of before 3.7.
  bool decoded = context_.document.version >= 3.7;
  // Heights are blended always, as what is between them tilts the surface.
  bool blended = block.keyword == "bump_map";
  while (!a.at_end()) {
    const Place where = a.where();
    const Element& element = a.take();
    if (const auto* const path = std::get_if<std::string>(&element.value)) {
      const Node image = tree.map(where, "file", tree.text(where, find_image(context_, where, *path)));
      set(p.own, "of", image);
      p.image = image;
      p.key = "projected";
    }
    const auto* const word = std::get_if<Word>(&element.value);
    if (word == nullptr) continue;
    if (word->text == "map_type" && a.is_numbers()) {
      const double type = a.number("a kind");
      onto = type == 1 ? "spherical" : type == 2 ? "cylindrical" : type == 5 ? "toroidal" : "planar";
    } else if (word->text == "once") {
      once = true;
    } else if (word->text == "interpolate") {
      blended = true;
    } else if (word->text == "ppm" || word->text == "pgm" || word->text == "tiff") {
      decoded = false;
    } else if (word->text == "gamma") {
      decoded = !a.is_numbers() || a.number("a gamma") > 1.5;
    }
  }
  if (p.image != nullptr && block.keyword != "bump_map")
    p.has_alpha = context_.has_alpha((*find_value(*p.image, "file"))->text);
  // Where light is computed in the screen's gamma, decoded numbers are those of the file, too.
  if (p.image != nullptr && (!decoded || context_.gamma.is_encoded()))
    tree.put(p.image, "color_space", tree.word(p.where, "linear"));
  if (p.image != nullptr && !blended) tree.put(p.image, "filter", tree.word(p.where, "nearest"));
  // Around the axis an image has no end.
  p.once = once && (onto == "planar" || onto == "cylindrical");
  p.is_around = onto != "planar", p.is_ring = onto == "toroidal";
  if (onto != "planar") set(p.own, "onto", tree.word(block.where, onto));
}

}  // namespace oktett::pov
