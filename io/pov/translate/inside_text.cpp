#include "io/pov/translate/inside_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "io/pov/translate/extent.h"

namespace oktett::pov {
namespace {

using Text = std::optional<std::string>;

/// Coordinate `axis` of the place that a map leads to, as an expression.
std::string coordinate(const Affine& map, std::size_t axis) {
  std::string text;
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    const double factor = map.m[axis][k];
    if (factor != 0) text += fmt::format("{}({})*{}", text.empty() ? "" : "+", factor, kNames[k]);
  }
  const double rest = map.m[axis][3];
  if (rest != 0 || text.empty()) text += fmt::format("{}({})", text.empty() ? "" : "+", rest);
  return "(" + text + ")";
}

/// The map into a space where the way from `from` to `to` is that from the origin to y = 1, and lengths
/// across are divided by `across`. Nothing if both are one point.
std::optional<Affine> to_unit_axis(const Vec3d& from, const Vec3d& to, double across) {
  const Vec3d way = to - from;
  const double size = length(way);
  if (!(size > 0) || !(across > 0)) return std::nullopt;
  const Vec3d up = way / size;
  const Vec3d other = std::abs(up.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  const Vec3d x = normalize(cross(up, other)), z = cross(x, up);
  const double rows[12] = {x.x / across, x.y / across, x.z / across, -dot(x, from) / across,
                           up.x / size,  up.y / size,  up.z / size,  -dot(up, from) / size,
                           z.x / across, z.y / across, z.z / across, -dot(z, from) / across};
  return Affine::from_rows(rows);
}

class InsideWriter {
 public:
  explicit InsideWriter(Context& context) : context_(context) {}

  /// `to_outer`: from the space of the pattern to that in which the object stands.
  Text write(const Block& block, const Affine& to_outer) {
    Moves moves;
    bool inverse = false, cut = false;
    Arguments scan(context_, block);
    while (!scan.at_end()) {
      if (take_moves(context_, scan, moves)) continue;
      if (const Block* const inner = scan.peek_block()) cut = cut || inner->keyword == "clipped_by";
      if (scan.peek_word() == "inverse") inverse = !inverse;
      scan.take();
    }
    if (cut || !moves.all.is_invertible()) return std::nullopt;
    const Affine own = moves.all.inverse() * to_outer;
    Text text = is_combination(block.keyword) ? combination(block, own) : shape(block, own);
    if (text && inverse) *text = "-(" + *text + ")";
    return text;
  }

 private:
  static bool is_combination(std::string_view k) {
    return k == "union" || k == "merge" || k == "intersection" || k == "difference" || k == "object";
  }

  Text combination(const Block& block, const Affine& own) {
    std::string text;
    for (const Element& e : block.elements) {
      const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
      if (inner == nullptr || *inner == nullptr || !is_object((*inner)->keyword)) continue;
      Text part = write(**inner, own);
      if (!part) return std::nullopt;
      if (text.empty()) {
        text = *part;
        continue;
      }
      const bool meets = block.keyword == "intersection" || block.keyword == "difference";
      text = fmt::format("{}({}, {}({}))", meets ? "max" : "min", text,
                         block.keyword == "difference" ? "-" : "", *part);
    }
    return text.empty() ? Text() : Text(text);
  }

  Text shape(const Block& block, const Affine& own) {
    Arguments a(context_, block);
    const std::string_view k = block.keyword;
    if (k == "sphere") {
      const Vec3d center = a.vector("a centre");
      const double radius = std::abs(a.number("a radius"));
      return ball(Affine::translation(center * -1.0) * own, radius);
    }
    if (k == "box") {
      const Vec3d p = a.vector("a corner"), q = a.vector("a corner");
      return box(Affine::translation((p + q) * -0.5) * own, abs(q - p) * 0.5);
    }
    if (k == "plane") {
      const Vec3d n = a.vector("a normal");
      const double offset = a.number("a distance");
      if (!(length(n) > 0)) return std::nullopt;
      const Vec3d u = n / length(n);
      return fmt::format("({})*{}+({})*{}+({})*{}-({})", u.x, coordinate(own, 0), u.y, coordinate(own, 1),
                         u.z, coordinate(own, 2), offset);
    }
    if (k == "cylinder" || k == "cone") return round(k == "cone", a, own);
    if (k == "torus") {
      const double major = a.number("a radius"), minor = a.number("a radius");
      return fmt::format("(sqrt({0}^2+{2}^2)-({3}))^2+{1}^2-({4})", coordinate(own, 0), coordinate(own, 1),
                         coordinate(own, 2), major, minor * minor);
    }
    if (k == "quadric") return quadric(a, own);
    return std::nullopt;
  }

  static std::string ball(const Affine& own, double radius) {
    return fmt::format("{}^2+{}^2+{}^2-({})", coordinate(own, 0), coordinate(own, 1), coordinate(own, 2),
                       radius * radius);
  }

  static std::string box(const Affine& own, const Vec3d& half) {
    return fmt::format("max(abs({})-({}), abs({})-({}), abs({})-({}))", coordinate(own, 0), half.x,
                       coordinate(own, 1), half.y, coordinate(own, 2), half.z);
  }

  static Text round(bool cone, Arguments& a, const Affine& own) {
    const Vec3d from = a.vector("a point");
    const double first = cone ? a.number("a radius") : 0;
    const Vec3d to = a.vector("a point");
    const double second = a.number("a radius"), begin = cone ? first : second;
    const std::optional<Affine> axis = to_unit_axis(from, to, 1);
    if (!axis) return std::nullopt;
    const Affine map = *axis * own;
    const std::string y = coordinate(map, 1);
    return fmt::format("max({}^2+{}^2-({}+({})*{})^2, abs({}-0.5)-0.5)", coordinate(map, 0),
                       coordinate(map, 2), begin, second - begin, y, y);
  }

  static Text quadric(Arguments& a, const Affine& own) {
    const Vec3d squares = a.vector("three numbers"), products = a.vector("three numbers"),
                linear = a.vector("three numbers");
    const double rest = a.number("a number");
    const std::string x = coordinate(own, 0), y = coordinate(own, 1), z = coordinate(own, 2);
    return fmt::format(
        "({})*{}^2+({})*{}^2+({})*{}^2+({})*{}*{}+({})*{}*{}+({})*{}*{}+({})*{}+({})*{}+({})*{}+({})",
        squares.x, x, squares.y, y, squares.z, z, products.x, x, y, products.y, x, z, products.z, y, z,
        linear.x, x, linear.y, y, linear.z, z, rest);
  }

  Context& context_;
};

}  // namespace

std::optional<std::string> inside_text(Context& context, const Block& object) {
  return InsideWriter(context).write(object, {});
}

}  // namespace oktett::pov
