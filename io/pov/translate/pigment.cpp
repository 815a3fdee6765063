#include "io/pov/translate/pigment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/pov/translate/pattern_node.h"
#include "io/yaml/write_yaml.h"
#include "render/pattern.h"

namespace oktett::pov {
namespace {

/// Pigments within each other that are read; deeper ones are their mean colour.
constexpr unsigned kMostNested = kMostNestedTextures - 4;
/// Most places of a map in a scene file.
constexpr std::size_t kMostPlaces = 256;

PovColor blend(const PovColor& a, const PovColor& b, double t) {
  return {a.rgb * (1 - t) + b.rgb * t, a.filter * (1 - t) + b.filter * t,
          a.transmit * (1 - t) + b.transmit * t};
}

PovColor color_of(const PigmentEntry& entry) {
  return entry.pigment != nullptr ? mean_of(*entry.pigment) : entry.color;
}

PovColor color_at(const std::vector<PigmentEntry>& map, double at) {
  if (at <= map.front().at) return color_of(map.front());
  for (std::size_t i = 1; i < map.size(); ++i) {
    if (at > map[i].at) continue;
    const double width = map[i].at - map[i - 1].at;
    return width > 0 ? blend(color_of(map[i - 1]), color_of(map[i]), (at - map[i - 1].at) / width)
                     : color_of(map[i]);
  }
  return color_of(map.back());
}

/// An entry of a map between two others.
PigmentEntry entry_at(double at, PigmentEntry before, const PigmentEntry& after) {
  if (before.pigment == nullptr && after.pigment == nullptr && after.at > before.at)
    before.color = blend(before.color, after.color, (at - before.at) / (after.at - before.at));
  before.at = at;
  return before;
}

/// The colours of a pattern without a map: greys, but for some. As seen in 3.7.0.10.
std::vector<PigmentEntry> default_map(const PovPattern& p) {
  const std::string_view pattern = p.word;
  struct Stop {
    double at;
    Vec3d color;
  };
  std::vector<Stop> stops{{0, {0, 0, 0}}, {1, {1, 1, 1}}};
  const Vec3d black{0, 0, 0}, white{1, 1, 1}, red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1}, cyan{0, 1, 1},
      magenta{1, 0, 1}, yellow{1, 1, 0}, light{0.666, 0.312, 0.2}, dark{0.4, 0.1333, 0.066};
  if (pattern == "agate")
    stops = {{0, white},           {0.5, {0.95, 0.75, 0.5}}, {0.5, {0.9, 0.7, 0.5}}, {0.6, {0.9, 0.7, 0.4}},
             {0.6, {1, 0.7, 0.4}}, {1, {0.6, 0.3, 0}}};
  if (pattern == "bozo")
    stops = {{0, white},  {0.4, white}, {0.4, green}, {0.6, green},
             {0.6, blue}, {0.8, blue},  {0.8, red},   {1, red}};
  if (pattern == "marble") stops = {{0, {0.9, 0.8, 0.8}}, {0.9, {0.9, 0.08, 0.08}}, {0.9, black}, {1, black}};
  if (pattern == "wood") stops = {{0, light}, {0.6, light}, {0.6, dark}, {1, dark}};
  if (pattern == "radial") stops = {{0, cyan}, {0.333, yellow}, {0.666, magenta}, {1, cyan}};
  // With an exponent it is grey.
  if (pattern == "mandel" && !has_key(*p.own, "power"))
    stops = {{0, black},       {0.001, black}, {0.001, cyan}, {0.012, yellow},
             {0.015, magenta}, {0.1, cyan},    {1, cyan}};
  std::vector<PigmentEntry> map;
  for (const Stop& stop : stops) map.push_back({stop.at, {stop.color}, nullptr});
  return map;
}

/// Null if it has one colour.
Node colors_of(Context& context, const Place& where, const Pigment& p) {
  if (is_solid(p)) return nullptr;
  return pigment_node(context, where, p, {[](const PovColor& c) { return c.rgb; }});
}

/// Reads pigments.
class PigmentReader {
 public:
  explicit PigmentReader(Context& context)
      : context_(context), patterns_(context, [this](const Block& block) { return texture_of(block); }) {}

  void read(Arguments& a, Pigment& p) {
    while (!a.at_end()) step(a, p);
  }

  void read(const Block& block, Pigment& p) {
    if (!block.name.empty() && p.name.empty()) p.name = block.name;
    Arguments a(context_, block);
    read(a, p);
  }

 private:
  void step(Arguments& a, Pigment& p) {
    const std::string_view word = a.peek_word();
    if (word == "average") {
      p.is_average = p.is_stated = true, p.pattern = {}, p.entries.clear();
      p.pattern.word = a.take_word(word) ? "average" : "", p.pattern.where = a.where();
      return;
    }
    const Node before = p.pattern.own;
    const Block* const object = a.peek_block();
    if (patterns_.take(a, p.pattern)) {
      if (p.pattern.own != before) p.is_average = false, p.is_stated = true, p.entries.clear();
      if (p.pattern.own != before && p.pattern.word == "object") read_sides(*object, p);
      return;
    }
    if (const Block* const block = a.peek_block()) {
      inner(*block, p);
      a.take();
    } else if (a.is_numbers()) {
      const PovColor color = a.color("a colour");
      p.is_stated = true, p.is_black = false;
      if (p.pattern.is_list)
        p.entries.push_back({0, color, nullptr});
      else
        p.solid = color, p.pattern.word = {};
    } else if (word == "filter" || word == "transmit") {
      a.take();
      const bool all = a.take_word("all");
      const double part = a.is_numbers() ? a.number("a number") : 0;
      // Without a colour before them these make a black one.
      if (!all && !p.is_black) p.solid = {}, p.pattern.word = {}, p.is_black = true;
      p.is_stated = true;
      (word == "filter" ? p.solid.filter : p.solid.transmit) = part;
    } else {
      a.take();
    }
  }

  void inner(const Block& block, Pigment& p) {
    const std::string_view k = block.keyword;
    if (k == "pigment" || k == "texture" || k == "density") {
      if (p.pattern.is_list)
        p.entries.push_back(nested(block)), p.lists_pigments = true;
      else
        read(block, p);
    } else if (k == "color_map" || k == "colour_map" || k == "pigment_map" || k == "texture_map" ||
               k == "density_map") {
      p.entries.clear();
      read_map(block, p);
      if (!p.is_average) p.entries = in_order(p.entries, entry_at);
    } else if (k == "image_map") {
      p.is_average = false, p.is_stated = true, p.entries.clear();
      patterns_.take_image(block, p.pattern);
      image_opacity(block, p);
    }
  }

  /// The colours or pigments of a pattern `object`, outside and inside.
  void read_sides(const Block& block, Pigment& p) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const Block* const inner = a.peek_block();
      if (inner != nullptr && inner->keyword == "pigment") p.entries.push_back(nested(*inner));
      if (inner == nullptr && a.is_numbers())
        p.entries.push_back({0, a.color("a colour"), nullptr});
      else
        a.take();
    }
  }

  /// `filter all` and `transmit all` of an image; of single colours of its palette the mean is not known.
  void image_opacity(const Block& block, Pigment& p) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const std::string_view word = a.peek_word();
      const Place where = a.where();
      a.take();
      if (word != "filter" && word != "transmit") continue;
      if (a.take_word("all"))
        (word == "filter" ? p.filter_all : p.transmit_all) = a.number("a number");
      else
        context_.tell("palette", where, "what passes through single colours of an image is left out");
    }
  }

  PigmentEntry nested(const Block& block) {
    Arguments a(context_, block);
    return nested(a, block);
  }

  /// A pigment whose words stand next.
  PigmentEntry nested(Arguments& a, const Block& block) {
    auto inner = std::make_shared<Pigment>();
    ++depth_;
    read(a, *inner);
    --depth_;
    if (is_solid(*inner)) return {0, inner->solid, nullptr};
    if (depth_ < kMostNested) return {0, {}, std::move(inner)};
    context_.tell(
        "nested pigments", block.where,
        fmt::format("pigments within each other deeper than {} levels show their mean colour", kMostNested));
    return {0, mean_of(*inner), nullptr};
  }

  void read_map(const Block& block, Pigment& p) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const Block* const entry = a.peek_block();
      a.take();
      if (entry == nullptr) continue;
      if (entry->keyword == "[")
        read_entry(*entry, p);
      else
        read_map(*entry, p);  // one that was declared
    }
  }

  /// `[at color]`, `[from to color color]` or `[at pigment]`.
  void read_entry(const Block& block, Pigment& p) {
    Arguments a(context_, block);
    const double from = a.number("a number");
    std::size_t numbers = 0;
    for (const Element& e : block.elements) numbers += std::holds_alternative<Numbers>(e.value);
    if (numbers == 4 && numbers_alone(block)) {
      const double to = a.number("a number");
      take_color_words(a);
      p.entries.push_back({from, a.color("a colour"), nullptr});
      take_color_words(a);
      p.entries.push_back({to, a.color("a colour"), nullptr});
      return;
    }
    PigmentEntry entry = nested(a, block);
    entry.at = from;
    p.entries.push_back(std::move(entry));
  }

  /// Whether an entry has numbers and names of colours alone, so that it has no pattern.
  static bool numbers_alone(const Block& block) {
    return std::ranges::all_of(block.elements, [](const Element& e) {
      const auto* const word = std::get_if<Word>(&e.value);
      return std::holds_alternative<Numbers>(e.value) || (word != nullptr && is_color_word(word->text));
    });
  }
  static bool is_color_word(std::string_view word) { return word == "color" || word == "colour"; }
  void take_color_words(Arguments& a) {
    while (a.take_word("color") || a.take_word("colour")) {}
  }

  Node texture_of(const Block& block) {
    Pigment p;
    ++depth_;
    read(block, p);
    --depth_;
    return depth_ < kMostNested ? colors_of(context_, block.where, p) : nullptr;
  }

  Context& context_;
  PatternReader patterns_;
  unsigned depth_ = 0;
};

// ---- Writing.

Node part_node(Tree& tree, const Place& where, const ColorPart& part, const Vec3d& value) {
  if (part.is_number)
    return tree.word(where, fmt::format("{}", static_cast<float>(std::max(0.0, value.x)) + 0.0f));
  return color_node(tree, where, value);
}

/// What an entry of a map shows.
Node entry_node(Context& context, const Place& where, const PigmentEntry& entry, const ColorPart& part) {
  return entry.pigment != nullptr ? pigment_node(context, where, *entry.pigment, part)
                                  : part_node(context.tree, where, part, part(entry.color));
}

/// The entries of a map within [0, 1], with further ones where `part` is not linear.
std::vector<PigmentEntry> even_map(const std::vector<PigmentEntry>& map) {
  std::vector<PigmentEntry> all;
  const auto add = [&](double at, const PigmentEntry& entry) {
    all.push_back(entry);
    all.back().at = at;
  };
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (i > 0) {
      const PigmentEntry &a = map[i - 1], &b = map[i];
      const bool colors = a.pigment == nullptr && b.pigment == nullptr && b.at > a.at;
      const auto at = [&](double place) { return blend(a.color, b.color, (place - a.at) / (b.at - a.at)); };
      if (colors && a.at < 0 && b.at > 0) add(0, {0, at(0), nullptr});
      const bool passes = a.color.filter != b.color.filter || a.color.transmit != b.color.transmit;
      constexpr int kSteps = 8;
      if (colors && passes && !(a.color.rgb == b.color.rgb) && map.size() * kSteps < kMostPlaces)
        for (int k = 1; k < kSteps; ++k) {
          const double place = a.at + (b.at - a.at) * k / kSteps;
          if (place > 0 && place < 1) add(place, {0, at(place), nullptr});
        }
      if (colors && a.at < 1 && b.at > 1) add(1, {0, at(1), nullptr});
    }
    if (map[i].at >= 0 && map[i].at <= 1) add(map[i].at, map[i]);
  }
  if (all.empty()) add(0, map.front().at > 1 ? map.front() : map.back());
  if (all.size() > kMostPlaces) all.resize(kMostPlaces);
  return all;
}

/// The mean of the entries.
Node average_node(Context& context, const Place& where, const Pigment& p, const ColorPart& part) {
  std::vector<WeightedNode> all;
  for (const PigmentEntry& entry : p.entries)
    all.push_back({entry.at, entry_node(context, where, entry, part)});
  return mean_node(context, p.pattern, all);
}

/// A value of a material times a number.
Node scaled(Tree& tree, const Place& where, const YamlNode& value, double factor) {
  const auto number = [&](const YamlNode& node) {
    return tree.word(where, fmt::format("{}", static_cast<float>(std::stod(node.text) * factor) + 0.0f));
  };
  if (value.kind == YamlKind::scalar) return number(value);
  const bool is_color = value.kind == YamlKind::sequence;
  const Node all = is_color ? tree.list(where) : tree.map(where);
  if (is_color) {
    for (const YamlNode* part : value.items) Tree::push(all, number(*part));
    return all;
  }
  for (std::size_t i = 0; i + 1 < value.items.size(); i += 2) {
    if (value.items[i]->text == "gain")
      factor *= std::stod(value.items[i + 1]->text);
    else
      all->items.push_back(value.items[i]), all->items.push_back(value.items[i + 1]);
  }
  tree.put(all, "gain", tree.number(where, factor));
  return all;
}

Node image_node(Context& context, const Pigment& p, const ColorPart& part);

/// An image with alpha: by it from what the image would show if all light passed to what it shows itself.
Node seen_through(Context& context, const Pigment& p, const ColorPart& part) {
  Pigment opaque = p;
  opaque.pattern.has_alpha = false;
  const auto at_alpha = [&](double alpha) {
    Pigment pigment = opaque;
    pigment.transmit_all += 1 - alpha;
    return image_node(context, pigment, part);
  };
  Tree& tree = context.tree;
  PovPattern mask;
  mask.word = "image_pattern", mask.key = "brightness", mask.where = p.pattern.where;
  mask.own = tree.map(mask.where, "of", pattern_node(context, alpha_of(tree, opaque.pattern), nullptr));
  std::vector<double> alphas{0, 1};
  // What is left of the colour is 0 up to the alpha at which all light passes.
  const double clear = p.filter_all + p.transmit_all;
  if (clear > 0 && clear < 1) alphas.insert(alphas.begin() + 1, clear);
  const Node values = tree.list(mask.where), itself = at_alpha(1);
  bool differ = false;
  for (const double alpha : alphas) {
    const Node shown = alpha < 1 ? at_alpha(alpha) : itself;
    differ = differ || flow_text(*shown) != flow_text(*itself);
    push_entry(tree, mask.where, values, alpha, shown);
  }
  return differ ? pattern_node(context, mask, values) : itself;
}

Node image_node(Context& context, const Pigment& p, const ColorPart& part) {
  const PovColor white{{1, 1, 1}, p.filter_all, p.transmit_all},
      black{{0, 0, 0}, p.filter_all, p.transmit_all};
  const double base = part(black).x, gain = part(white).x - base;
  Tree& tree = context.tree;
  if (p.pattern.once) {
    Pigment repeated = p;
    repeated.pattern = repeated_image(p.pattern);
    // Beyond its edges light passes as if nothing were there.
    return once_node(context, p.pattern, image_node(context, repeated, part),
                     part_node(tree, p.pattern.where, part, part({{0, 0, 0}, 0, 1})));
  }
  if (p.pattern.has_alpha) return seen_through(context, p, part);
  if (gain == 0) return part_node(tree, p.pattern.where, part, part(black));
  const Node node = pattern_node(context, p.pattern, nullptr);
  if (gain == 1 && base == 0) return node;
  // Other places may show the same node, so gain and base stand in a copy.
  const Node copy = tree.map(p.pattern.where);
  copy->items = node->items;
  tree.put(copy, "gain", tree.number(p.pattern.where, gain));
  if (base != 0) tree.put(copy, "base", tree.number(p.pattern.where, base));
  return copy;
}

}  // namespace

Node mean_node(Context& context, const PovPattern& average, const std::vector<WeightedNode>& nodes) {
  Tree& tree = context.tree;
  const Place& where = average.where;
  double sum = 0;
  for (const WeightedNode& node : nodes) sum += node.weight;
  if (!(sum > 0)) return nullptr;
  Node all = nullptr;
  for (const WeightedNode& node : nodes) {
    const Node part = scaled(tree, where, *node.value, node.weight / sum);
    if (all != nullptr) {
      const Node keys = over_keys(tree, where, part, tree.number(where, 1), all);
      if (average.has_generator) put_generator(context, average, keys);
      all = tree.map(where, "over", keys);
    } else {
      all = part;
    }
  }
  if (all->kind != YamlKind::map || !(average.is_moved() || average.uses_uv)) return all;
  const Node zero = tree.number(where, 0);
  if (nodes.size() == 1) all = over_node(tree, where, all, zero, zero);
  PovPattern moved = average;
  moved.key = "over", moved.own = tree.map(where);
  moved.own->items = all->items[1]->items;
  return pattern_node(context, moved, nullptr);
}

void read_pigment(Context& context, const Block& block, Pigment& pigment) {
  PigmentReader(context).read(block, pigment);
}

void read_pigment(Context& context, Arguments& arguments, Pigment& pigment) {
  PigmentReader(context).read(arguments, pigment);
}

Node pigment_texture(Context& context, const Block& block) {
  Pigment p;
  read_pigment(context, block, p);
  return colors_of(context, block.where, p);
}

Node only_value(const std::vector<Node>& values) {
  for (const Node node : values)
    if (node->kind == YamlKind::map || flow_text(*node) != flow_text(*values[0])) return nullptr;
  return values.empty() ? nullptr : values[0];
}

std::vector<PigmentEntry> entries_of(const Pigment& p) {
  if (!p.pattern.is_list) return p.entries.empty() ? default_map(p.pattern) : p.entries;
  std::vector<PigmentEntry> list = p.entries;
  const std::vector<PovColor> usual = default_colors(p.pattern);
  list.resize(std::min(list.size(), usual.size()));
  // Behind pigments black follows, behind colours what is usual.
  for (std::size_t i = list.size(); i < usual.size(); ++i)
    list.push_back({0, p.lists_pigments ? PovColor{} : usual[i], nullptr});
  return list;
}

bool is_solid(const Pigment& p) { return p.pattern.is_none(); }

PovColor mean_of(const Pigment& p) {
  if (is_solid(p)) return p.solid;
  std::vector<PovColor> colors;
  if (p.is_average || p.pattern.is_list)
    for (const PigmentEntry& entry : p.entries) colors.push_back(color_of(entry));
  else if (!p.entries.empty())
    for (int i = 0; i < 64; ++i) colors.push_back(color_at(p.entries, (i + 0.5) / 64));
  if (colors.empty() && p.pattern.is_list) colors = default_colors(p.pattern);
  if (colors.empty())
    return {{0.5, 0.5, 0.5}, p.filter_all, p.transmit_all + (p.pattern.has_alpha ? 0.5 : 0)};
  PovColor sum;
  for (const PovColor& c : colors)
    sum.rgb = sum.rgb + c.rgb, sum.filter += c.filter, sum.transmit += c.transmit;
  const auto count = static_cast<double>(colors.size());
  return {sum.rgb / count, sum.filter / count, sum.transmit / count};
}

/// Whether `asked` holds of one of its colours; of images of what passes everywhere and somewhere.
template <class Asked>
static bool any_color(const Pigment& p, const Asked& asked) {
  if (is_solid(p)) return asked(p.solid);
  if (p.pattern.key == "projected") {
    const bool is_clear_somewhere = p.pattern.once || p.pattern.has_alpha;
    return asked({{}, p.filter_all, p.transmit_all}) || (is_clear_somewhere && asked({{}, 0, 1}));
  }
  return std::ranges::any_of(p.entries, [&](const PigmentEntry& entry) {
    return entry.pigment != nullptr ? any_color(*entry.pigment, asked) : asked(entry.color);
  });
}

bool is_transparent(const Pigment& p) {
  return any_color(p, [](const PovColor& c) { return c.filter + c.transmit > 0; });
}

bool filters(const Pigment& p) {
  return any_color(p, [](const PovColor& c) { return c.filter != 0; });
}

Node pigment_node(Context& context, const Place& where, const Pigment& p, const ColorPart& part) {
  Tree& tree = context.tree;
  const auto mean = [&] { return part_node(tree, where, part, part(mean_of(p))); };
  if (is_solid(p)) return part_node(tree, where, part, part(p.solid));
  if (p.is_average) {
    const Node node = p.entries.empty() ? nullptr : average_node(context, where, p, part);
    return node != nullptr ? node : mean();
  }
  const PovPattern& pattern = p.pattern;
  if (pattern.key.empty()) {
    context.tell(fmt::format("pattern {}", pattern.word), pattern.where,
                 fmt::format("pattern '{}' has no meaning here; one colour stands for it", pattern.word));
    return mean();
  }
  if (pattern.key == "projected") return image_node(context, p, part);
  const Node values = tree.list(where);
  if (pattern.is_list) {
    std::vector<Node> shown;
    for (const PigmentEntry& entry : entries_of(p)) shown.push_back(entry_node(context, where, entry, part));
    if (const Node only = only_value(shown)) return only;
    for (const Node node : shown) Tree::push(values, node);
    return pattern_node(context, pattern, values);
  }
  const std::vector<PigmentEntry> map = even_map(entries_of(p));
  std::vector<Node> shown;
  for (const PigmentEntry& entry : map) shown.push_back(entry_node(context, where, entry, part));
  if (const Node only = only_value(shown)) return only;
  for (std::size_t i = 0; i < map.size(); ++i) push_entry(tree, where, values, map[i].at, shown[i]);
  return pattern_node(context, pattern, values);
}

Node color_node(Tree& tree, const Place& where, const Vec3d& rgb) {
  // Single precision is what a colour has; its shortest text reads better.
  const Node node = tree.list(where);
  for (int k = 0; k < 3; ++k)
    Tree::push(node, tree.word(where, fmt::format("{}", static_cast<float>(std::max(0.0, rgb[k])) + 0.0f)));
  return node;
}

}  // namespace oktett::pov
