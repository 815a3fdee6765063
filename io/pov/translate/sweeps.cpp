#include "io/pov/translate/sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace oktett::pov {
namespace {

using Point = std::array<double, 2>;

/// The outlines that a list of points makes with a spline, as scene files have them: each with the points
/// before its first and behind its last one that only give directions.
std::vector<std::vector<Point>> split_outlines(const std::vector<Point>& p, std::string_view spline) {
  std::vector<std::vector<Point>> outlines;
  if (spline == "bezier_spline") {
    for (std::size_t i = 0; i + 3 < p.size(); i += 4) {
      if (outlines.empty() || outlines.back().back() != p[i]) outlines.push_back({p[i]});
      outlines.back().insert(outlines.back().end(), {p[i + 1], p[i + 2], p[i + 3]});
    }
    return outlines;
  }
  const std::size_t before = spline == "quadratic_spline" || spline == "cubic_spline" ? 1 : 0;
  const std::size_t behind = spline == "cubic_spline" ? 1 : 0;
  for (std::size_t begin = 0; begin + before + 1 < p.size();) {
    const std::size_t first = begin + before;
    std::size_t last = first + 1;
    while (last < p.size() && p[last] != p[first]) ++last;
    // A loop that is not closed goes on to the end of the list.
    const std::size_t end = last < p.size() ? std::min(last + 1 + behind, p.size()) : p.size();
    if (end - first - behind > 2)
      outlines.emplace_back(p.begin() + static_cast<std::ptrdiff_t>(begin),
                            p.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  return outlines;
}

/// Reads what stands in front of the numbers; returns the kind of spline.
std::string_view spline_of(Context& context, Arguments& a, bool& conic) {
  std::string_view spline = "linear_spline";
  while (!a.is_numbers()) {
    const std::string_view word = a.peek_word();
    if (word.empty()) context.fail(a.where(), fmt::format("expected a number in '{}'", a.block().keyword));
    if (word == "conic_sweep") conic = true;
    if (word.ends_with("_spline")) spline = word;
    a.take();
  }
  return spline;
}

Shapes solid(std::string key, Node value, bool closed = true) {
  Shapes shapes;
  shapes.parts.push_back({std::move(key), value, nullptr, {}});
  shapes.solid = closed;
  return shapes;
}

std::optional<Shapes> make_prism(Context& context, Arguments& a) {
  Tree& tree = context.tree;
  const Place where = a.block().where;
  bool conic = false;
  const std::string_view spline = spline_of(context, a, conic);
  const double low = a.number("a height"), high = a.number("a height");
  const double count = a.number("a count");
  std::vector<Point> points;
  while (static_cast<double>(points.size()) < count) points.push_back(a.pair("a point"));
  bool open = false;
  for (const Element& e : a.block().elements)
    if (const auto* const word = std::get_if<Word>(&e.value)) open |= word->text == "open";
  const auto outlines = split_outlines(points, spline);
  if (outlines.empty() || low == high) {
    context.warn(where, "the prism has no volume; it is left out");
    return std::nullopt;
  }
  const Node keys = tree.map(where), lists = tree.list(where);
  for (const auto& outline : outlines) {
    const Node list = tree.list(where);
    for (const Point& p : outline) Tree::push(list, tree.numbers(where, p));
    Tree::push(lists, list);
  }
  tree.put(keys, "outlines", lists);
  if (spline != "linear_spline")
    tree.put(keys, "curve", tree.word(where, spline.substr(0, spline.find("_spline"))));
  if (conic) tree.put(keys, "sweep", tree.word(where, "conic"));
  tree.put(keys, "from", tree.number(where, std::min(low, high)));
  tree.put(keys, "to", tree.number(where, std::max(low, high)));
  if (open) tree.put(keys, "open", tree.flag(where, true));
  return solid("prism", keys, !open);
}

Shapes make_sphere_sweep(Context& context, Arguments& a) {
  Tree& tree = context.tree;
  const Place where = a.block().where;
  bool conic = false;
  const std::string_view spline = spline_of(context, a, conic);
  const double count = a.number("a count");
  const Node keys = tree.map(where), spheres = tree.list(where);
  for (double i = 0; i < count; ++i) {
    const Vec3d center = a.vector("a centre");
    const std::array<double, 4> sphere{center.x, center.y, center.z, std::abs(a.number("a radius"))};
    Tree::push(spheres, tree.numbers(where, sphere));
  }
  // How exactly POV-Ray looks for roots; here they are proved.
  if (a.take_word("tolerance")) a.number("a number");
  tree.put(keys, "spheres", spheres);
  if (spline != "linear_spline")
    tree.put(keys, "curve",
             tree.word(where, spline == "b_spline" ? spline : spline.substr(0, spline.find("_spline"))));
  return solid("sphere_sweep", keys);
}

std::optional<Shapes> make_text(Context& context, Arguments& a) {
  Tree& tree = context.tree;
  const Place where = a.block().where;
  Place font_place = where;
  std::string font;
  if (a.take_word("internal")) {
    a.number("the number of a font");
    context.tell("internal font", where, "POV-Ray's internal fonts are not read; such a text is left out");
    return std::nullopt;
  }
  while (!a.at_end() && font.empty()) {
    font_place = a.where();
    if (a.take_word("ttf")) continue;
    font = a.text("the file of a font");
  }
  const std::string text = a.text("a text");
  const double thickness = a.number("the thickness");
  Vec3d advance{0, 0, 0};
  if (a.is_numbers()) advance = a.is_vector() ? a.vector("an offset") : Vec3d{a.number("an offset"), 0, 0};
  if (text.empty() || thickness == 0) {
    context.warn(where, "the text has no volume; it is left out");
    return std::nullopt;
  }
  // The name may lack its extension.
  if (font.find('.') == std::string::npos) font += ".ttf";
  const Node keys = tree.map(where);
  tree.put(keys, "font", tree.text(font_place, find_file(context, font_place, font)));
  tree.put(keys, "text", tree.text(where, text));
  tree.put(keys, "thickness", tree.number(where, std::abs(thickness)));
  if (!(advance == Vec3d{0, 0, 0})) tree.put(keys, "advance", tree.vector(where, advance));
  Shapes shapes = solid("text", keys);
  if (thickness < 0) shapes.parts[0].first.add({Move::Kind::translate, {0, 0, thickness}, {}, where});
  return shapes;
}

}  // namespace

std::optional<Shapes> make_sweep(Context& context, Arguments& a) {
  const std::string_view kind = a.block().keyword;
  if (kind == "prism") return make_prism(context, a);
  if (kind == "text") return make_text(context, a);
  return make_sphere_sweep(context, a);
}

}  // namespace oktett::pov
