#include "io/pov/translate/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/image/heights.h"
#include "io/pov/translate/blobs.h"
#include "io/pov/translate/functions.h"
#include "io/pov/translate/height_meshes.h"
#include "io/pov/translate/meshes.h"
#include "io/pov/translate/patches.h"
#include "io/pov/translate/polynomials.h"
#include "io/pov/translate/sweeps.h"
#include "kernels/exact/lathe.h"
#include "kernels/exact/revolution.h"
#include "kernels/heights/height_grid.h"

namespace oktett::pov {
namespace {

class ShapeMaker {
 public:
  ShapeMaker(Context& context, Arguments& a, const ShapeLimits& limits, const ShapeUse& use)
      : context_(context),
        tree_(context.tree),
        a_(a),
        where_(a.block().where),
        limits_(limits),
        closes_(use.operand),
        operand_(use.operand || use.clipped) {}

  std::optional<Shapes> make() {
    const std::string_view k = a_.block().keyword;
    if (k == "sphere") return sphere();
    if (k == "box") return box();
    if (k == "cylinder") return cylinder();
    if (k == "cone") return cone();
    if (k == "plane") return plane();
    if (k == "disc") return disc();
    if (k == "torus") return torus();
    if (k == "ovus") return ovus();
    if (k == "quadric") return quadric();
    if (k == "cubic") return make_polynomial(context_, a_, 3, limits_, operand_);
    if (k == "quartic") return make_polynomial(context_, a_, 4, limits_, operand_);
    if (k == "poly") return make_polynomial(context_, a_, 0, limits_, operand_);
    if (k == "superellipsoid") return superellipsoid();
    if (k == "blob") return make_blob(context_, a_);
    if (k == "lathe") return lathe();
    if (k == "sor") return sor();
    if (k == "isosurface") return isosurface();
    if (k == "julia_fractal") return julia();
    if (k == "height_field") return height_field();
    if (k == "prism" || k == "text" || k == "sphere_sweep") return make_sweep(context_, a_);
    if (k == "bicubic_patch") return make_patch(context_, a_);
    if (k == "parametric") return make_parametric(context_, a_);
    if (std::optional<MadeMesh> made = make_mesh(context_, a_)) return mesh(std::move(*made));
    constexpr std::array<std::string_view, 4> kMeshes{"mesh", "mesh2", "triangle", "polygon"};
    if (std::ranges::find(kMeshes, k) == kMeshes.end())
      context_.tell(std::string(k), where_,
                    fmt::format("'{}' is not read here; such objects are left out", k));
    return std::nullopt;
  }

 private:
  Node number(double value) { return tree_.number(where_, value); }
  Node vector(const Vec3d& v) { return tree_.vector(where_, v); }
  Node map() { return tree_.map(where_); }

  static Shapes one(std::string key, Node value, bool solid = true) {
    Shapes shapes;
    shapes.parts.push_back({std::move(key), value, nullptr, {}});
    shapes.solid = solid;
    return shapes;
  }

  void put_bounds(Node map, const Vec3d& lo, const Vec3d& hi) {
    const Node bounds = this->map();
    tree_.put(bounds, "min", vector(lo)), tree_.put(bounds, "max", vector(hi));
    tree_.put(map, "bounds", bounds);
  }

  std::optional<Shapes> left_out(const std::string& why) {
    context_.warn(where_, fmt::format("{}; the object is left out", why));
    return std::nullopt;
  }

  /// Of a sor: `open` has no inside; where one is needed, the solid stands for it.
  bool is_open() {
    if (!has_word(a_.block(), "open")) return false;
    if (!closes_) return true;
    context_.tell("open operand", where_, "in combinations a sor that is 'open' is closed");
    return false;
  }

  Shapes sphere() {
    const Vec3d center = a_.vector("the centre");
    return ball(center, std::abs(a_.number("the radius")));
  }

  Shapes ball(const Vec3d& center, double radius) {
    const Node keys = map();
    tree_.put(keys, "center", vector(center)), tree_.put(keys, "radius", number(radius));
    return one("sphere", keys);
  }

  Shapes box() {
    const Vec3d p = a_.vector("a corner"), q = a_.vector("a corner");
    const Node keys = map();
    int flat = 0, across = 0;
    for (int k = 0; k < 3; ++k)
      if (p[k] == q[k]) ++flat, across = k;
    if (flat == 1) {
      // A box without thickness is seen, too.
      Vec3d a = p, b = q;
      a[(across + 1) % 3] = q[(across + 1) % 3], b[(across + 1) % 3] = p[(across + 1) % 3];
      const Node corners = tree_.list(where_);
      for (const Vec3d& corner : {p, a, q, b}) Tree::push(corners, vector(corner));
      tree_.put(keys, "vertices", corners);
      return one("polygon", keys, false);
    }
    if (flat == 0 && looks_by_uv(a_.block())) return unfolded_box(min(p, q), max(p, q));
    tree_.put(keys, "min", vector(min(p, q))), tree_.put(keys, "max", vector(max(p, q)));
    return one("box", keys);
  }

  /// Whether a look in a block lies by u and v.
  static bool looks_by_uv(const Block& block) {
    return has_word(block, "uv_mapping") || std::ranges::any_of(block.elements, [](const Element& e) {
             const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
             return inner != nullptr && *inner != nullptr && looks_by_uv(**inner);
           });
  }

  /// Along which axes a box is mirrored before it is turned: POV-Ray moves its corners until then, and
  /// unfolds what they have become.
  std::array<bool, 3> mirrored_axes() const {
    std::array<bool, 3> axes{};
    for (const Moves moves = moves_in(context_, a_.block()); const Move& move : moves.list) {
      if (move.kind == Move::Kind::rotate || move.kind == Move::Kind::matrix) break;
      for (int k = 0; k < 3 && move.kind == Move::Kind::scale; ++k)
        if (move.v[k] < 0) axes[static_cast<std::size_t>(k)] ^= true;
    }
    return axes;
  }

  /// A box of triangles, whose faces lie side by side in an image as POV-Ray unfolds them: in four columns
  /// the sides of -x, +z, +x and -z, with +y above and -y below the second.
  Shapes unfolded_box(const Vec3d& lo, const Vec3d& hi) {
    MeshMaker maker;
    const std::array<bool, 3> mirrored = mirrored_axes();
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const bool upper : {false, true}) {
        const std::size_t across = (axis + 1) % 3, along = (axis + 2) % 3;
        const auto corner = [&](bool right, bool above) {
          std::array<bool, 3> end{};
          end[axis] = upper, end[across] = right, end[along] = above;
          const auto shown = [&](std::size_t k) { return end[k] != mirrored[k] ? 1.0 : 0.0; };
          return MeshCorner{{end[0] ? hi.x : lo.x, end[1] ? hi.y : lo.y, end[2] ? hi.z : lo.z},
                            std::nullopt,
                            unfolded(axis, shown(axis) > 0, {shown(0), shown(1), shown(2)})};
        };
        // Counterclockwise seen from outside.
        const MeshCorner a = corner(false, false), b = corner(upper, !upper), c = corner(true, true),
                         d = corner(!upper, upper);
        maker.add({a, b, c}), maker.add({a, c, d});
      }
    return mesh({{{std::move(maker), nullptr}}, true});
  }

  /// Where a point of a face of the unit cube lies in an image.
  static std::array<double, 2> unfolded(std::size_t axis, bool upper, const Vec3d& p) {
    constexpr double kColumn = 1.0 / 4, kRow = 1.0 / 3;
    if (axis == 1) return {(1 + p.x) * kColumn, (upper ? 3 - p.z : p.z) * kRow};
    const double column = axis == 0 ? (upper ? 3 - p.z : p.z) : (upper ? 1 + p.x : 4 - p.x);
    return {column * kColumn, (1 + p.y) * kRow};
  }

  Shapes cylinder() {
    const Vec3d from = a_.vector("an end"), to = a_.vector("an end");
    const double radius = std::abs(a_.number("the radius"));
    return tube("cylinder", {from, to}, radius, radius);
  }

  Shapes cone() {
    const Vec3d from = a_.vector("an end");
    const double radius = std::abs(a_.number("a radius"));
    const Vec3d to = a_.vector("an end");
    return tube("cone", {from, to}, radius, std::abs(a_.number("a radius")));
  }

  /// A cylinder or a cone between two ends of these radii.
  Shapes tube(const char* kind, const std::array<Vec3d, 2>& ends, double first, double last) {
    const bool is_cone = std::string_view(kind) == "cone", is_open = has_word(a_.block(), "open");
    const auto node = [&](const std::array<Vec3d, 2>& of, const std::array<double, 2>& radii) {
      const Node keys = map();
      tree_.put(keys, "from", vector(of[0]));
      if (is_cone) tree_.put(keys, "from_radius", number(radii[0]));
      tree_.put(keys, "to", vector(of[1]));
      tree_.put(keys, is_cone ? "to_radius" : "radius", number(radii[1]));
      return keys;
    };
    const Vec3d along = ends[1] - ends[0];
    if (!is_open || !closes_ || !(length(along) > 0)) {
      const Node keys = node(ends, {first, last});
      if (is_open && !closes_) tree_.put(keys, "open", tree_.flag(where_, true));
      return one(kind, keys, !is_open || closes_);
    }
    // Where an inside is needed, a longer one that planes cut off without being seen; a cone up to half of
    // the way to its apex.
    const auto more = [](double here, double there) {
      return here < there ? std::min(0.5, 0.5 * here / (there - here)) : 0.5;
    };
    const double before = more(first, last), behind = more(last, first);
    Shapes shapes = one(kind, node({ends[0] - along * before, ends[1] + along * behind},
                                   {first - (last - first) * before, last + (last - first) * behind}));
    for (const double side : {-1.0, 1.0}) {
      const Vec3d normal = along * (side / length(along));
      const Node plane = map();
      tree_.put(plane, "normal", vector(normal));
      tree_.put(plane, "offset", number(dot(normal, ends[side > 0])));
      shapes.parts.push_back({"plane", plane, nullptr, {}, true});
    }
    shapes.meet = true;
    return shapes;
  }

  Shapes plane() {
    const Node keys = map();
    tree_.put(keys, "normal", vector(a_.vector("the normal")));
    const double offset = a_.number("the distance");
    if (offset != 0) tree_.put(keys, "offset", number(offset));
    return one("plane", keys);
  }

  Shapes disc() {
    const Node keys = map();
    const Vec3d center = a_.vector("the centre"), normal = a_.vector("the normal");
    const double radius = std::abs(a_.number("the radius"));
    const double hole = a_.is_numbers() ? std::abs(a_.number("the radius of the hole")) : 0;
    tree_.put(keys, "center", vector(center)), tree_.put(keys, "normal", vector(normal));
    tree_.put(keys, "radius", number(radius));
    if (hole > 0) tree_.put(keys, "inner_radius", number(hole));
    return one("disk", keys, false);
  }

  /// What lies about the z axis in scene files and about the y axis here.
  static void stand_up(Shapes& shapes, const Place& where) {
    for (Shape& shape : shapes.parts) shape.first.add({Move::Kind::rotate, {90, 0, 0}, {}, where});
  }

  Shapes torus() {
    const Node keys = map();
    tree_.put(keys, "major", number(std::abs(a_.number("the major radius"))));
    tree_.put(keys, "minor", number(std::abs(a_.number("the minor radius"))));
    Shapes shapes = one("torus", keys);
    stand_up(shapes, where_);
    return shapes;
  }

  Shapes ovus() {
    const double bottom = a_.number("the bottom radius"), top = a_.number("the top radius");
    if (bottom < 0 || top < 0) context_.fail(where_, "the radii of an ovus must not be negative");
    // One ball holds the other.
    if (top == 0 || top >= 2 * bottom) {
      if (top > 0)
        context_.warn(where_,
                      "the top radius of this ovus is not less than twice the bottom radius: it is a sphere");
      return ball({0, top == 0 ? 0 : bottom, 0}, top == 0 ? bottom : top);
    }
    const Node keys = map();
    tree_.put(keys, "bottom_radius", number(bottom)), tree_.put(keys, "top_radius", number(top));
    return one("ovus", keys);
  }

  Shapes quadric() {
    const Vec3d squares = a_.vector("three coefficients"), mixed = a_.vector("three coefficients"),
                linear = a_.vector("three coefficients");
    const double c[10] = {squares.x, squares.y, squares.z, mixed.x,  mixed.y,
                          mixed.z,   linear.x,  linear.y,  linear.z, a_.number("a coefficient")};
    return one("quadric", tree_.map(where_, "coefficients", tree_.numbers(where_, c)));
  }

  /// Of a degree, 0: the first argument.
  Shapes superellipsoid() {
    const auto e = a_.pair("two exponents");
    if (e[0] == e[1]) {
      const Node keys = map();
      for (const char* key : {"p", "q", "r"}) tree_.put(keys, key, number(std::min(2 / e[0], 1024.0)));
      return one("superellipsoid", keys);
    }
    // A toroid whose ring has shrunk to the axis: (|x|^m + |y|^m)^q + |z|^p = 1.
    const Node keys = map();
    for (const char* key : {"m", "n"}) tree_.put(keys, key, number(std::min(2 / e[0], 1024.0)));
    tree_.put(keys, "q", number(std::min(e[0] / e[1], 1024.0))), tree_.put(keys, "r", number(1));
    tree_.put(keys, "p", number(std::min(2 / e[1], 1024.0)));
    tree_.put(keys, "d", number(0)), tree_.put(keys, "e", number(1));
    return one("supertoroid", keys);
  }

  // ---- Surfaces of revolution.

  std::vector<ProfilePoint> profile() {
    const auto count = static_cast<std::size_t>(std::max(0.0, a_.number("a count")));
    std::vector<ProfilePoint> points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto p = a_.pair("a point");
      points.push_back({p[0], p[1]});
    }
    return points;
  }

  Node profile_node(std::string_view kind, const std::vector<ProfilePoint>& points, bool open) {
    const Node keys = map(), list = tree_.list(where_);
    tree_.put(keys, "profile", tree_.word(where_, kind));
    for (const ProfilePoint& p : points) {
      const double pair[2] = {p.radius, p.height};
      Tree::push(list, tree_.numbers(where_, pair));
    }
    tree_.put(keys, "points", list);
    if (open) tree_.put(keys, "open", tree_.flag(where_, true));
    return keys;
  }

  std::optional<Shapes> sor() {
    std::vector<ProfilePoint> points = profile();
    if (points.size() < 4) return left_out("a surface of revolution needs 4 points");
    // Points at the ends that only give directions may stand at the height of their neighbours.
    const std::size_t last = points.size() - 1;
    const double nudge = 1e-9 * std::abs(points[last - 1].height - points[1].height);
    if (points[0].height == points[1].height) points[0].height -= nudge;
    if (points[last].height == points[last - 1].height) points[last].height += nudge;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (!(points[i - 1].height < points[i].height)) return left_out("the heights of a sor ascend");
    const bool open = is_open();
    for (ProfilePoint& p : points) p.radius = std::abs(p.radius);
    if (const auto height = profile_crosses_axis({points, RevolutionShape::Profile::sor, open}))
      return left_out(fmt::format("the profile crosses the axis at height {:.6g}", *height));
    return one("revolution", profile_node("sor", points, open), !open);
  }

  std::optional<Shapes> lathe() {
    std::string_view spline = "linear_spline";
    while (!a_.is_numbers() && !a_.at_end()) {
      if (a_.peek_word().ends_with("_spline")) spline = a_.peek_word();
      a_.take();
    }
    const std::vector<ProfilePoint> points = profile();
    Shapes shapes;
    for (const std::vector<ProfilePoint>& piece : bezier_profiles(points, spline)) {
      const bool is_closed = piece.front().radius == 0 && piece.back().radius == 0;
      const bool open = !is_closed && !closes_;
      if (const std::string wrong = why_bad_profile({piece, open}); !wrong.empty()) {
        context_.warn(where_, fmt::format("this lathe is left out: {}", wrong));
        continue;
      }
      shapes.solid &= !open;
      shapes.parts.push_back({"revolution", profile_node("bezier", piece, open), nullptr, {}});
    }
    if (shapes.parts.empty()) return std::nullopt;
    return shapes;
  }

  /// Chains of control points.
  static std::vector<std::vector<ProfilePoint>> bezier_profiles(const std::vector<ProfilePoint>& p,
                                                                std::string_view spline) {
    const auto mix = [](const ProfilePoint& a, double s, const ProfilePoint& b, double t,
                        const ProfilePoint& c, double u) {
      return ProfilePoint{a.radius * s + b.radius * t + c.radius * u,
                          a.height * s + b.height * t + c.height * u};
    };
    std::vector<std::vector<ProfilePoint>> out;
    if (spline == "bezier_spline") {
      for (std::size_t i = 0; i + 3 < p.size(); i += 4) {
        if (out.empty() ||
            !(out.back().back().radius == p[i].radius && out.back().back().height == p[i].height))
          out.push_back({p[i]});
        out.back().insert(out.back().end(), {p[i + 1], p[i + 2], p[i + 3]});
      }
      return out;
    }
    const bool quadratic = spline == "quadratic_spline", cubic = spline == "cubic_spline";
    if (cubic && p.size() >= 4) return {curve_through(p)};
    const std::size_t first = quadratic ? 1 : 0;
    if (cubic || p.size() < first + 2) return out;
    out.push_back({p[first]});
    for (std::size_t i = first; i + 1 < p.size(); ++i) {
      const ProfilePoint &b = p[i], &c = p[i + 1];
      if (quadratic) {
        const ProfilePoint& a = p[i - 1];
        out[0].push_back(mix(b, 1, c, 1.0 / 6, a, -1.0 / 6));
        out[0].push_back(mix(c, 0.5, b, 2.0 / 3, a, -1.0 / 6));
      } else {
        if (b.radius == c.radius && b.height == c.height) continue;
        out[0].push_back(mix(b, 2.0 / 3, c, 1.0 / 3, b, 0)),
            out[0].push_back(mix(b, 1.0 / 3, c, 2.0 / 3, b, 0));
      }
      out[0].push_back(c);
    }
    return out;
  }

  // ---- Functions and images.

  std::optional<Shapes> isosurface() {
    std::shared_ptr<const Function> function;
    double threshold = 0;
    Vec3d lo{-1, -1, -1}, hi{1, 1, 1}, center{0, 0, 0};
    double radius = 0;
    while (!a_.at_end()) {
      if (const auto* const f = std::get_if<std::shared_ptr<const Function>>(&a_.peek().value)) {
        function = *f;
        a_.take();
      } else if (a_.take_word("threshold")) {
        threshold = a_.number("a threshold");
      } else if (const Block* const block = a_.peek_block();
                 block != nullptr && block->keyword == "contained_by") {
        Arguments container(context_, *block);
        const Block* const shape = container.peek_block();
        if (shape == nullptr) context_.fail(block->where, "expected a box or a sphere");
        Arguments s(context_, *shape);
        if (shape->keyword == "sphere") {
          center = s.vector("the centre"), radius = std::abs(s.number("the radius"));
          lo = center - Vec3d{radius, radius, radius}, hi = center + Vec3d{radius, radius, radius};
        } else {
          const Vec3d p = s.vector("a corner"), q = s.vector("a corner");
          lo = min(p, q), hi = max(p, q);
        }
        a_.take();
      } else if (!take_iso_setting()) {
        break;
      }
    }
    if (!function) context_.fail(where_, "an isosurface needs a function");
    const std::optional<std::string> text = function_text(context_, *function, where_, threshold);
    if (!text) return std::nullopt;
    if (!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z))
      return left_out("what contains the isosurface has no volume");
    const bool open = has_word(a_.block(), "open");
    // What an open surface ends at is not seen: a sphere, or a box where an inside is needed.
    const bool cut = open && (radius > 0 || closes_);
    const Vec3d least = lo, greatest = hi;
    if (cut) {
      const Vec3d room = (hi - lo) * 0.005;
      lo = lo - room, hi = hi + room;
    }
    const Node keys = map();
    tree_.put(keys, "function", tree_.text(where_, *text));
    put_bounds(keys, lo, hi);
    if (open && !cut) tree_.put(keys, "open", tree_.flag(where_, true));
    Shapes shapes = one("implicit", keys, !open || cut);
    if (radius > 0) {
      const Node ball = map();
      tree_.put(ball, "center", vector(center)), tree_.put(ball, "radius", number(radius));
      shapes.parts.push_back({"sphere", ball, nullptr, {}, cut});
      shapes.meet = true;
    } else if (cut) {
      const Node box = map();
      tree_.put(box, "min", vector(least)), tree_.put(box, "max", vector(greatest));
      shapes.parts.push_back({"box", box, nullptr, {}, true});
      shapes.meet = true;
    }
    return shapes;
  }

  /// What says how the surface is found.
  bool take_iso_setting() {
    for (const std::string_view word : {"max_gradient", "accuracy", "max_trace"})
      if (a_.take_word(word)) {
        a_.number("a number");
        return true;
      }
    if (a_.take_word("evaluate")) {
      while (a_.is_numbers()) a_.take();
      return true;
    }
    return a_.take_word("all_intersections") || a_.take_word("open");
  }

  std::optional<Shapes> julia() {
    if (!a_.is_numbers()) context_.fail(a_.where(), "expected a vector of 4 numbers in 'julia_fractal'");
    const std::array<double, 5> v = std::get<Numbers>(a_.take().value).v;
    double iterations = 20, slice = 0;
    std::array<double, 5> normal{0, 0, 0, 1};
    bool known = true, hypercomplex = false;
    int power = 2;
    while (!a_.at_end()) {
      if (a_.take_word("max_iteration")) {
        iterations = a_.number("a number");
      } else if (a_.take_word("precision")) {
        a_.number("a number");
      } else if (a_.take_word("slice")) {
        if (a_.is_numbers()) normal = std::get<Numbers>(a_.take().value).v;
        slice = a_.number("a distance");
      } else if (a_.take_word("quaternion") || a_.take_word("sqr")) {
      } else if (a_.take_word("hypercomplex")) {
        hypercomplex = true;
      } else if (a_.take_word("cube")) {
        power = 3;
      } else if (a_.peek_word() == "exp" || a_.peek_word() == "reciprocal" || a_.peek_word() == "sin" ||
                 a_.peek_word() == "cos" || a_.peek_word() == "pwr" || a_.peek_word() == "ln") {
        known = false, a_.take();
      } else {
        break;
      }
    }
    if (!known || normal[0] != 0 || normal[1] != 0 || normal[2] != 0 || normal[3] == 0)
      return left_out("of julia fractals only squares and cubes are read, in slices along the fourth axis");
    if (std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]) > 2)
      return left_out("the fractal is empty");
    const Node keys = map();
    tree_.put(keys, "c", tree_.numbers(where_, std::span(v.data(), 4)));
    if (slice != 0) tree_.put(keys, "slice", number(slice / normal[3]));
    tree_.put(keys, "iterations", number(std::clamp(std::round(iterations), 1.0, 24.0)));
    if (hypercomplex) tree_.put(keys, "algebra", tree_.word(where_, "hypercomplex"));
    if (power != 2) tree_.put(keys, "power", number(power));
    // POV-Ray lets points go from there on.
    tree_.put(keys, "escape", number(4));
    return one("julia", keys);
  }

  std::optional<Shapes> height_field() {
    std::string path;
    Place at = where_;
    bool smooth = false, gif = false;
    double water = 0;
    while (!a_.at_end()) {
      if (const auto* const text = std::get_if<std::string>(&a_.peek().value)) {
        path = *text, at = a_.where();
        a_.take();
      } else if (a_.take_word("smooth")) {
        smooth = a_.flag();
      } else if (a_.take_word("water_level")) {
        water = a_.number("a height");
      } else if (a_.peek_word() == "png" || a_.peek_word() == "jpeg" || a_.peek_word() == "tga" ||
                 a_.peek_word() == "gif" || a_.peek_word() == "pgm" || a_.peek_word() == "ppm" ||
                 a_.peek_word() == "tiff" || a_.peek_word() == "sys" || a_.peek_word() == "pot" ||
                 a_.peek_word() == "exr" || a_.peek_word() == "hdr") {
        gif = a_.peek_word() == "gif";
        a_.take();
      } else {
        break;
      }
    }
    if (a_.take_word("function")) return function_heights();
    if (path.empty()) return left_out("of height fields only those of images and functions are read");
    path = find_file(context_, at, path);
    const bool palette = has_palette(path);
    try {
      (palette ? read_palette_heights : read_heights)(path, kMaxHeightSide, kMaxHeightSamples);
    } catch (const Error& error) {
      if (std::optional<Shapes> shapes = color_heights(path, smooth, water)) return shapes;
      return left_out(error.what());
    }
    if (gif)
      context_.tell("GIF heights", at,
                    "the heights of a GIF image are its grey values, not the numbers of its colours");
    const Node keys = map();
    tree_.put(keys, "file", tree_.text(at, path));
    if (palette) tree_.put(keys, "palette", tree_.word(where_, "true"));
    tree_.put(keys, "size", vector({1, 1, 1}));
    tree_.put(keys, "interpolation", tree_.word(where_, "triangles"));
    if (smooth) tree_.put(keys, "smooth", tree_.flag(where_, true));
    // Only what is cut or combined needs sides and a bottom, which POV-Ray does not show.
    const bool solid = operand_ || water > 0;
    if (solid) tree_.put(keys, "base", number(-1e-4));
    Shapes shapes = one("height_field", keys);
    shapes.solid = solid;
    // The upper edge of the image lies at z = 1, not at the least z.
    shapes.parts[0].first.add({Move::Kind::scale, {1, 1, -1}, {}, where_});
    shapes.parts[0].first.add({Move::Kind::translate, {0.5, 0, 0.5}, {}, where_});
    add_water(shapes, water);
    return shapes;
  }

  /// `function COLUMNS, ROWS { ... }`, which stands before all else.
  std::optional<Shapes> function_heights() {
    const auto side = [&] {
      constexpr double kMostSide = 2048;
      return static_cast<std::uint32_t>(std::clamp(a_.number("a number of places"), 2.0, kMostSide));
    };
    const std::uint32_t columns = side(), rows = side();
    const auto* const given =
        a_.at_end() ? nullptr : std::get_if<std::shared_ptr<const Function>>(&a_.peek().value);
    if (given == nullptr || *given == nullptr) context_.fail(a_.where(), "expected a function");
    const std::shared_ptr<const Function> function = *given;
    a_.take();
    bool smooth = false;
    double water = 0;
    while (!a_.at_end()) {
      if (a_.take_word("smooth"))
        smooth = a_.flag();
      else if (a_.take_word("water_level"))
        water = a_.number("a height");
      else
        break;
    }
    const std::optional<Heights> heights = heights_of_function(context_, *function, columns, rows);
    if (!heights)
      return left_out("the function of a height field has no value somewhere, or takes too many steps");
    return heights_as_mesh(*heights, smooth, water);
  }

  /// Nothing if the image is none in colour.
  std::optional<Shapes> color_heights(const std::string& path, bool smooth, double water) {
    try {
      if (const std::optional<Heights> heights = heights_of_colors(path))
        return heights_as_mesh(*heights, smooth, water);
    } catch (const Error&) {
      // Whoever read the image as a grey one says what is wrong with it.
    }
    return std::nullopt;
  }

  Shapes heights_as_mesh(const Heights& heights, bool smooth, double water) {
    Shapes shapes;
    shapes.parts.push_back(
        mesh_shape(height_mesh(heights, {smooth, operand_, std::min(water, 1.0)}), nullptr));
    shapes.solid = operand_;
    if (operand_) add_water(shapes, water);
    return shapes;
  }

  /// Only what lies above the water is seen of a height field.
  void add_water(Shapes& shapes, double water) {
    if (!(water > 0)) return;
    const Node above = map();
    tree_.put(above, "normal", vector({0, -1, 0})), tree_.put(above, "offset", number(-water));
    shapes.parts.push_back({"plane", above, nullptr, {}});
    shapes.meet = true;
  }

  Shape mesh_shape(std::shared_ptr<const TriangleMesh> made, const std::shared_ptr<const Block>& texture) {
    const Block& block = a_.block();
    const std::string file =
        add_mesh(context_, std::move(made), block.name.empty() ? std::string(block.keyword) : block.name);
    return {"mesh", tree_.map(where_, "file", tree_.text(where_, file)), texture, {}};
  }

  Shapes mesh(MadeMesh made) {
    Shapes shapes;
    bool solid = made.solid;
    std::size_t inside_vectors = 0;
    for (const Element& e : a_.block().elements)
      if (const auto* const word = std::get_if<Word>(&e.value))
        inside_vectors += word->text == "inside_vector";
    solid |= inside_vectors > 0;
    if (operand_ && solid && made.parts.size() > 1) {
      context_.tell("textured mesh operand", where_, "in combinations meshes show their first texture only");
      MeshMaker whole;
      for (MeshPart& part : made.parts) whole.add(part.mesh);
      made.parts = {{std::move(whole), made.parts[0].texture}};
    }
    for (const MeshPart& part : made.parts) {
      if (part.mesh.empty()) continue;
      Shape shape = mesh_shape(part.mesh.finish(), part.texture);
      if (inside_vectors > 0 && operand_) tree_.put(shape.value, "solid", tree_.word(where_, "winding"));
      shapes.parts.push_back(std::move(shape));
    }
    shapes.solid = solid;
    return shapes;
  }

  Context& context_;
  Tree& tree_;
  Arguments& a_;
  Place where_;
  ShapeLimits limits_;
  bool closes_;   ///< what is open is closed
  bool operand_;  ///< its inside counts
};

}  // namespace

std::optional<Shapes> make_shapes(Context& context, Arguments& arguments, const ShapeLimits& limits,
                                  const ShapeUse& use) {
  return ShapeMaker(context, arguments, limits, use).make();
}

}  // namespace oktett::pov
