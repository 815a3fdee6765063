#include "io/pov/translate/normal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "io/image/image.h"
#include "io/pov/translate/pattern_node.h"
#include "io/pov/translate/pigment.h"

namespace oktett::pov {
namespace {

/// The patterns that POV-Ray bends surfaces by in ways of their own, which a `slope_map` does not change.
constexpr std::array<std::string_view, 6> kBends{"bumps", "dents", "quilted", "ripples", "waves", "wrinkles"};
bool has_own_way(const PovPattern& p) { return std::ranges::find(kBends, p.word) != kBends.end(); }

/// Of all others it takes differences of values: the normal leans by 2/15 of the slope of the pattern.
constexpr double kStrength = 2.0 / 15;

class NormalReader {
 public:
  explicit NormalReader(Context& context)
      : context_(context),
        patterns_(context, [this](const Block& block) { return pigment_texture(context_, block); }) {}

  void read(const Block& block, Normal& n) {
    Arguments a(context_, block);
    read(a, n);
  }

  void read(Arguments& a, Normal& n) {
    while (!a.at_end()) {
      const Node before = n.pattern.own;
      if (patterns_.take(a, n.pattern)) {
        if (n.pattern.own != before) n.slopes.clear(), n.normals.clear();
        if (n.pattern.own != before && a.is_numbers()) n.amount = a.number("a number");
      } else if (const Block* const block = a.peek_block()) {
        inner(*block, n);
        a.take();
      } else if (a.take_word("bump_size")) {
        n.amount = a.number("a number");
      } else {
        a.take();
      }
    }
  }

 private:
  void inner(const Block& block, Normal& n) {
    const std::string_view k = block.keyword;
    if (k == "normal") {
      if (n.pattern.is_list)
        n.normals.push_back({0, 0, 0, nested(block)});
      else
        read(block, n);
    } else if (k == "slope_map" || k == "normal_map") {
      n.slopes.clear(), n.normals.clear();
      read_map(block, n);
      std::ranges::stable_sort(n.slopes, {}, &NormalEntry::at);
      if (n.pattern.word != "average") std::ranges::stable_sort(n.normals, {}, &NormalEntry::at);
    } else if (k == "bump_map") {
      patterns_.take_image(block, n.pattern);
      Arguments a(context_, block);
      while (!a.at_end())
        if (a.take_word("bump_size"))
          n.amount = a.number("a number");
        else
          a.take();
    }
  }

  std::shared_ptr<const Normal> nested(const Block& block) {
    Arguments a(context_, block);
    return nested(a);
  }

  std::shared_ptr<const Normal> nested(Arguments& a) {
    auto inner = std::make_shared<Normal>();
    if (++depth_ < 5) read(a, *inner);
    --depth_;
    return inner;
  }

  void read_map(const Block& block, Normal& n) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const Block* const entry = a.peek_block();
      a.take();
      if (entry == nullptr) continue;
      if (entry->keyword != "[") {
        read_map(*entry, n);  // one that was declared
        continue;
      }
      Arguments e(context_, *entry);
      const double at = e.number("a number");
      if (e.is_numbers()) {
        const auto [height, slope] = e.pair("height and slope");
        n.slopes.push_back({at, height, slope, nullptr});
      } else {
        n.normals.push_back({at, 0, 0, nested(e)});
      }
    }
  }

  Context& context_;
  PatternReader patterns_;
  int depth_ = 0;
};

/// The height of a `slope_map` at a value: between its entries the cubic that has their heights and slopes.
double height_at(const std::vector<NormalEntry>& map, double at) {
  if (at <= map.front().at) return map.front().height;
  for (std::size_t i = 1; i < map.size(); ++i) {
    const NormalEntry &a = map[i - 1], &b = map[i];
    if (at > b.at) continue;
    const double width = b.at - a.at;
    if (!(width > 0)) return b.height;
    const double t = (at - a.at) / width, s = 1 - t;
    return s * s * (1 + 2 * t) * a.height + t * t * (1 + 2 * s) * b.height +
           width * s * t * (s * a.slope - t * b.slope);
  }
  return map.back().height;
}

/// How strong heights of an image are: POV-Ray takes the difference of neighbouring pixels for the slope,
/// however long a pixel is.
double strength_of_image(Context& context, const YamlNode& image) {
  const YamlNode* const file = find_value(image, "file");
  if (file == nullptr) return kStrength;
  const auto [known, is_new] = context.bump_strengths.try_emplace(file->text, kStrength);
  if (!is_new) return known->second;
  try {
    const Picture picture = read_image(file->text);
    known->second = 1 / std::sqrt(static_cast<double>(picture.width) * picture.height);
  } catch (const Error&) {
    // Whoever shows the image says what is wrong with it.
  }
  return known->second;
}

Node slopes_node(Context& context, const Normal& n) {
  Tree& tree = context.tree;
  const Place& where = n.pattern.where;
  const Node values = tree.list(where);
  const auto add = [&](double at) {
    push_entry(tree, where, values, at, tree.number(where, std::max(0.0, height_at(n.slopes, at))));
  };
  constexpr int kSteps = 64;
  std::vector<double> places;
  for (int i = 0; i <= kSteps; ++i) places.push_back(static_cast<double>(i) / kSteps);
  for (const NormalEntry& entry : n.slopes)
    if (entry.at > 0 && entry.at < 1 && places.size() < 250) places.push_back(entry.at);
  std::ranges::sort(places);
  for (const double place : places) add(place);
  return values;
}

Node nested_node(Context& context, const Place& where, const Normal& n, double scale) {
  const Node node = normal_node(context, n, scale);
  return node != nullptr ? node : context.tree.number(where, 0);
}

}  // namespace

void read_normal(Context& context, const Block& block, Normal& normal) {
  NormalReader(context).read(block, normal);
}

Node normal_node(Context& context, const Normal& n, double scale) {
  PovPattern p = n.pattern;
  p.has_generator = p.image == nullptr;
  if (p.is_none() || (n.amount == 0 && n.normals.empty())) return nullptr;
  scale *= scale_of(p);
  if (p.word == "average") {
    std::vector<WeightedNode> all;
    for (const NormalEntry& entry : n.normals)
      all.push_back({entry.at, nested_node(context, p.where, *entry.normal, scale)});
    const Node mean = mean_node(context, p, all);
    return mean != nullptr && mean->kind == YamlKind::map ? mean : nullptr;
  }
  if (p.key.empty()) {
    context.tell(fmt::format("normal {}", p.word), p.where,
                 fmt::format("'{}' in 'normal' has no meaning here: surfaces are smooth", p.word));
    return nullptr;
  }
  Tree& tree = context.tree;
  if (!n.normals.empty()) {
    const Node values = tree.list(p.where);
    for (const NormalEntry& entry : n.normals) {
      const Node inner = nested_node(context, p.where, *entry.normal, scale);
      if (p.is_list)
        Tree::push(values, inner);
      else
        push_entry(tree, p.where, values, std::clamp(entry.at, 0.0, 1.0), inner);
    }
    return pattern_node(context, p, values);
  }
  const bool by_slopes = !n.slopes.empty() && !p.is_list && !has_own_way(p);
  const Node node = pattern_node(context, p, by_slopes ? slopes_node(context, n) : nullptr);
  const Node copy = tree.map(p.where);
  copy->items = node->items;
  const double strength = p.image != nullptr ? strength_of_image(context, *p.image)
                          : has_own_way(p)   ? 1
                                             : kStrength;
  tree.put(copy, "gain", tree.number(p.where, strength * n.amount * scale));
  return copy;
}

}  // namespace oktett::pov
