#include "io/pov/translate/extent.h"

#include <algorithm>
#include <array>

namespace oktett::pov {

bool Extent::is_finite() const {
  return std::isfinite(lo.x + lo.y + lo.z + hi.x + hi.y + hi.z) && lo.x <= hi.x && lo.y <= hi.y &&
         lo.z <= hi.z;
}

Extent Extent::meet(const Extent& o) const {
  Extent out;
  for (int k = 0; k < 3; ++k) out.lo[k] = std::max(lo[k], o.lo[k]), out.hi[k] = std::min(hi[k], o.hi[k]);
  return out;
}

Extent Extent::join(const Extent& o) const {
  Extent out;
  for (int k = 0; k < 3; ++k) out.lo[k] = std::min(lo[k], o.lo[k]), out.hi[k] = std::max(hi[k], o.hi[k]);
  return out;
}

Extent Extent::moved_along_axes(const Affine& map) const {
  Extent out;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l)
      if (k != l && map.m[k][l] != 0) return {};
  for (int k = 0; k < 3; ++k) {
    const double a = lo[k] * map.m[k][k] + map.m[k][3], b = hi[k] * map.m[k][k] + map.m[k][3];
    out.lo[k] = std::min(a, b), out.hi[k] = std::max(a, b);
  }
  return out;
}

Extent Extent::moved(const Affine& map) const {
  if (!is_finite()) return moved_along_axes(map);
  Extent out{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p = map.point({corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z});
    out = out.join({p, p});
  }
  return out;
}

bool is_object(std::string_view keyword) {
  constexpr std::array<std::string_view, 36> kObjects{
      "sphere",     "box",           "cylinder",       "cone",       "plane",
      "disc",       "torus",         "quadric",        "cubic",      "quartic",
      "poly",       "polynomial",    "superellipsoid", "blob",       "lathe",
      "sor",        "prism",         "polygon",        "triangle",   "smooth_triangle",
      "mesh",       "mesh2",         "height_field",   "isosurface", "julia_fractal",
      "text",       "bicubic_patch", "sphere_sweep",   "parametric", "object",
      "union",      "merge",         "intersection",   "difference", "ovus",
      "light_group"};
  return std::ranges::find(kObjects, keyword) != kObjects.end();
}

std::vector<std::shared_ptr<const Block>> objects_in(const Block& block) {
  std::vector<std::shared_ptr<const Block>> objects;
  for (const Element& e : block.elements)
    if (const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
        inner != nullptr && *inner != nullptr && is_object((*inner)->keyword))
      objects.push_back(*inner);
  return objects;
}

bool has_word(const Block& block, std::string_view word) {
  return std::ranges::any_of(block.elements, [&](const Element& e) {
    const auto* const found = std::get_if<Word>(&e.value);
    return found != nullptr && found->text == word;
  });
}

namespace {

Extent around(const Vec3d& center, double radius) {
  const Vec3d r{std::abs(radius), std::abs(radius), std::abs(radius)};
  return {center - r, center + r};
}

/// Around a disc across an axis.
Extent disc_around(const Vec3d& center, const Vec3d& axis, double radius) {
  const double whole = dot(axis, axis);
  Vec3d r;
  // Along an axis of space it is flat to the last bit.
  for (int k = 0; k < 3; ++k)
    r[k] = whole > 0 ? std::abs(radius) * std::sqrt(std::max(1 - axis[k] * axis[k] / whole, 0.0))
                     : std::abs(radius);
  return {center - r, center + r};
}

/// What the shape itself says, with its arguments taken.
Extent shape_extent(Context& context, Arguments& a) {
  const std::string_view kind = a.block().keyword;
  const Extent nothing{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  if (kind == "sphere") {
    const Vec3d center = a.vector("a point");
    return around(center, a.number("a radius"));
  }
  if (kind == "box") {
    const Vec3d p = a.vector("a point"), q = a.vector("a point");
    return Extent{p, p}.join({q, q});
  }
  if (kind == "cylinder" || kind == "cone") {
    const Vec3d p = a.vector("a point");
    const double r = kind == "cone" ? a.number("a radius") : 0;
    const Vec3d q = a.vector("a point");
    const double s = a.number("a radius");
    return disc_around(p, q - p, kind == "cone" ? r : s).join(disc_around(q, q - p, s));
  }
  if (kind == "torus") {
    const double major = a.number("a radius"), minor = a.number("a radius"), r = major + minor;
    return {{-r, -minor, -r}, {r, minor, r}};
  }
  if (kind == "ovus") {
    const double bottom = a.number("a radius"), top = a.number("a radius");
    const Extent balls = around({0, 0, 0}, bottom).join(around({0, bottom, 0}, top));
    if (!(0 < top && top < 2 * bottom)) return balls;
    // The centre of the arc lies at the height y, on the other side of the axis.
    const double arc = 2 * std::max(bottom, top), low = arc - bottom, high = arc - top;
    const double y = (low * low - high * high + bottom * bottom) / (2 * bottom);
    const double wide = arc - std::sqrt(std::max(low * low - y * y, 0.0));
    return balls.join({{-wide, y, -wide}, {wide, y, wide}});
  }
  if (kind == "superellipsoid") {
    a.pair("two exponents");
    return {{-1, -1, -1}, {1, 1, 1}};
  }
  if (kind == "plane") {
    const Vec3d n = a.vector("the normal");
    const double d = a.number("the distance");
    Extent all;
    for (int k = 0; k < 3; ++k) {
      const bool along = n[k] != 0 && n[(k + 1) % 3] == 0 && n[(k + 2) % 3] == 0;
      if (along && n[k] > 0) all.hi[k] = d;
      if (along && n[k] < 0) all.lo[k] = -d;
    }
    return all;
  }
  if (kind == "quadric") {
    // Ellipsoids and round columns about the origin.
    const Vec3d squares = a.vector("coefficients"), mixed = a.vector("coefficients"),
                linear = a.vector("coefficients");
    const double rest = a.number("a coefficient");
    Extent all;
    const bool plain = mixed == Vec3d{0, 0, 0} && linear == Vec3d{0, 0, 0} && rest < 0;
    for (int k = 0; k < 3 && plain && std::min({squares.x, squares.y, squares.z}) >= 0; ++k) {
      if (squares[k] == 0) continue;
      all.hi[k] = std::sqrt(-rest / squares[k]), all.lo[k] = -all.hi[k];
    }
    return all;
  }
  if (kind == "height_field") return {{0, 0, 0}, {1, 1, 1}};
  if (kind == "union" || kind == "merge" || kind == "object" || kind == "intersection" ||
      kind == "difference" || kind == "light_group" || kind == "clipped_by" || kind == "bounded_by") {
    // What cuts or bounds is what several objects have in common.
    const bool meets = kind == "intersection" || kind == "clipped_by" || kind == "bounded_by";
    Extent all = meets ? Extent{} : nothing;
    bool first = true;
    while (const Block* const inner = a.peek_block()) {
      if (inner->keyword == "light_source") {
        a.take();
        continue;
      }
      if (!is_object(inner->keyword)) break;
      if (meets)
        all = all.meet(extent_of(context, *inner));
      else if (first || kind != "difference")
        all = all.join(extent_of(context, *inner));
      a.take(), first = false;
    }
    return all;
  }
  return {};
}

}  // namespace

Extent extent_of(Context& context, const Block& block) {
  if (const auto known = context.extents.find(&block); known != context.extents.end())
    return {known->second[0], known->second[1]};
  Arguments a(context, block);
  Extent extent = shape_extent(context, a);
  if (has_word(block, "inverse")) extent = {};
  while (!a.at_end()) {
    Moves move;
    if (take_moves(context, a, move)) {
      extent = extent.moved(move.all);
      continue;
    }
    const Block* const inner = a.peek_block();
    if (inner != nullptr && inner->keyword == "clipped_by") extent = extent.meet(extent_of(context, *inner));
    a.take();
  }
  if (!block.name.empty()) context.extents.emplace(&block, std::array{extent.lo, extent.hi});
  return extent;
}

Extent limits_of(Context& context, const Block& block, std::string_view keyword) {
  Extent limits;
  Arguments a(context, block);
  Moves moves;
  while (!a.at_end()) {
    if (take_moves(context, a, moves)) continue;
    const Block* const inner = a.peek_block();
    a.take();
    if (inner == nullptr || inner->keyword != keyword) continue;
    const Extent e = extent_of(context, *inner);
    if (moves.all.is_invertible()) limits = limits.meet(e.moved(moves.all.inverse()));
  }
  return limits;
}

}  // namespace oktett::pov
