#include "accel/point_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "accel/time/time_tree.h"
#include "core/error.h"

namespace oktett {
namespace {

/// A ray in double.
struct Line {
  Vec3d o, d;
  double tmin, tmax;
  explicit Line(const Ray& ray)
      : o(ray.origin),
        d(ray.direction),
        tmin(static_cast<double>(ray.tmin)),
        tmax(static_cast<double>(ray.tmax)) {}
  /// As floats, in which ranges are told.
  bool holds(double t) const {
    const auto f = static_cast<double>(static_cast<float>(t));
    return tmin < f && f <= tmax;
  }
};

struct RoundPointD {
  Vec3d center;
  double radius;
};

/// The roots of a t^2 + 2 b t + c, ascending; none if they are not real.
struct Roots {
  double t[2];
  int count = 0;
};
Roots quadratic(double a, double b, double c) {
  Roots roots;
  if (a == 0) {
    roots.t[0] = -c / (2 * b);
    roots.count = b != 0 ? 1 : 0;
    return roots;
  }
  const double square = b * b - a * c;
  if (!(square >= 0)) return roots;
  // Neither quotient subtracts numbers that are nearly the same (Press et al., Numerical Recipes, 5.6).
  const double q = -(b + std::copysign(std::sqrt(square), b));
  const double first = q / a, second = q != 0 ? c / q : first;
  roots.t[0] = std::min(first, second), roots.t[1] = std::max(first, second);
  roots.count = 2;
  return roots;
}

/// Points with keys, and what the shapes made of them have in common.
class RoundShape : public UserShape {
 public:
  explicit RoundShape(RoundPointKeys keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw Error("expected points at one key or more");
    for (const auto& points : keys_)
      if (points.size() != keys_[0].size())
        throw Error("one key has " + std::to_string(keys_[0].size()) + " points, another " +
                    std::to_string(points.size()));
  }

  std::uint32_t primitive_count() const override { return static_cast<std::uint32_t>(keys_[0].size()); }
  std::uint32_t key_count() const override { return static_cast<std::uint32_t>(keys_.size()); }
  Box bounds(std::uint32_t primitive, std::uint32_t key) const override {
    return bounds_of(keys_[key][primitive], false);
  }
  bool has_several_hits() const override { return true; }

 protected:
  KeyTime time_of(const RayContext& context) const { return KeyTime::of(context.time, key_count()); }

  RoundPointD point_at(std::uint32_t i, const KeyTime& at) const {
    const RoundPoint& a = keys_[at.key][i];
    const RoundPoint& b = keys_.size() > 1 ? keys_[at.key + 1][i] : a;
    const auto between = [&](float p, float q) {
      return static_cast<double>(keys_.size() > 1 ? at.between(p, q) : p);
    };
    return {
        {between(a.center.x, b.center.x), between(a.center.y, b.center.y), between(a.center.z, b.center.z)},
        between(a.radius, b.radius)};
  }

  /// Empty unless the point has a surface; `may_be_thin`: the radius may be 0.
  static Box bounds_of(const RoundPoint& p, bool may_be_thin) {
    if (!is_finite(p.center) || !(p.radius > 0 || (may_be_thin && p.radius == 0)) || !std::isfinite(p.radius))
      return {};
    const double r = static_cast<double>(p.radius);
    const Vec3d c(p.center), reach{r, r, r};
    // Hits are rounded to floats, and what moves is interpolated in them.
    Box box{round_down(c - reach), round_up(c + reach)};
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = next_down(next_down(box.lo[k])), box.hi[k] = next_up(next_up(box.hi[k]));
    }
    return box;
  }

  const RoundPointKeys keys_;
};

/// The normal, scaled by a power of two if it does not fit into floats.
Vec3f to_normal(const Vec3d& n) {
  const Vec3f f(n);
  if (is_finite(f) && !(f == Vec3f{})) return f;
  const double size = length(n);
  return size > 0 ? Vec3f(n * (1 / size)) : Vec3f{0, 0, 1};
}

class MovingSpheres final : public RoundShape {
 public:
  using RoundShape::RoundShape;
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const RoundPointD p = point_at(primitive, time_of(context));
    const Line line(ray);
    const Vec3d m = line.o - p.center;
    const Roots roots = quadratic(dot(line.d, line.d), dot(m, line.d), dot(m, m) - p.radius * p.radius);
    for (int k = 0; k < roots.count; ++k) {
      if (!line.holds(roots.t[k])) continue;
      hit.t = static_cast<float>(roots.t[k]), hit.u = hit.v = 0;
      hit.normal = to_normal(m + line.d * roots.t[k]);
      return true;
    }
    return false;
  }
};

class FacingDiscs final : public RoundShape {
 public:
  using RoundShape::RoundShape;
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const RoundPointD p = point_at(primitive, time_of(context));
    const Line line(ray);
    const Vec3d to = p.center - line.o;
    const double t = dot(to, line.d) / dot(line.d, line.d);
    const Vec3d off = line.d * t - to;
    if (!(dot(to, to) > p.radius * p.radius) || !line.holds(t) || !(dot(off, off) <= p.radius * p.radius))
      return false;
    hit.t = static_cast<float>(t), hit.u = hit.v = 0;
    hit.normal = -ray.direction;
    return true;
  }
};

class Discs final : public RoundShape {
 public:
  Discs(RoundPointKeys keys, std::vector<std::vector<Vec3f>> normals)
      : RoundShape(std::move(keys)), normals_(std::move(normals)) {
    if (normals_.size() != keys_.size())
      throw Error("expected normals at " + std::to_string(keys_.size()) + " keys, not " +
                  std::to_string(normals_.size()));
    for (const auto& at_key : normals_)
      if (at_key.size() != keys_[0].size())
        throw Error(std::to_string(keys_[0].size()) + " discs have " + std::to_string(at_key.size()) +
                    " normals");
  }
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const KeyTime at = time_of(context);
    const RoundPointD p = point_at(primitive, at);
    const Vec3f& a = normals_[at.key][primitive];
    const Vec3f& b = normals_.size() > 1 ? normals_[at.key + 1][primitive] : a;
    const Vec3f normal =
        normals_.size() > 1 ? Vec3f{at.between(a.x, b.x), at.between(a.y, b.y), at.between(a.z, b.z)} : a;
    const Line line(ray);
    const Vec3d n(normal);
    const double t = dot(p.center - line.o, n) / dot(line.d, n);
    const Vec3d off = line.o + line.d * t - p.center;
    if (!line.holds(t) || !(dot(off, off) <= p.radius * p.radius)) return false;
    hit.t = static_cast<float>(t), hit.u = hit.v = 0;
    hit.normal = normal;
    return true;
  }

 private:
  const std::vector<std::vector<Vec3f>> normals_;
};

class RoundLines final : public RoundShape {
 public:
  RoundLines(RoundPointKeys keys, std::vector<std::uint32_t> first)
      : RoundShape(std::move(keys)), first_(std::move(first)) {
    for (const std::uint32_t i : first_)
      if (i >= keys_[0].size() || i + 1 >= keys_[0].size())
        throw Error("a segment begins at point " + std::to_string(i) + " of " +
                    std::to_string(keys_[0].size()));
  }

  std::uint32_t primitive_count() const override { return static_cast<std::uint32_t>(first_.size()); }
  Box bounds(std::uint32_t primitive, std::uint32_t key) const override {
    const Box a = bounds_of(keys_[key][first_[primitive]], true);
    const Box b = bounds_of(keys_[key][first_[primitive] + 1], true);
    if (a.empty() || b.empty()) return {};
    Box both = a;
    both.grow(b);
    return both;
  }

  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const KeyTime at = time_of(context);
    const RoundPointD a = point_at(first_[primitive], at), b = point_at(first_[primitive] + 1, at);
    const Line line(ray);
    const double way = length(b.center - a.center), difference = a.radius - b.radius;
    Nearest nearest;
    if (way <= std::abs(difference)) {
      // One of the spheres holds the other.
      const bool begin = difference > 0;
      sphere(line, begin ? a : b, {}, 0, begin ? 0 : 1, nearest);
    } else {
      const Vec3d axis = (b.center - a.center) * (1 / way);
      const double sine = difference / way;
      // The spheres beyond the circles where the cone touches them, then the cone between these.
      sphere(line, a, -axis, -a.radius * sine, 0, nearest);
      sphere(line, b, axis, b.radius * sine, 1, nearest);
      cone(line, a, axis, sine, way, a.radius * sine, way + b.radius * sine, nearest);
    }
    if (!std::isfinite(nearest.t)) return false;
    hit.t = static_cast<float>(nearest.t), hit.u = static_cast<float>(nearest.u), hit.v = 0;
    hit.normal = to_normal(nearest.normal);
    return true;
  }

 private:
  struct Nearest {
    double t = std::numeric_limits<double>::infinity(), u = 0;
    Vec3d normal;
  };

  /// The part of a sphere on which (x - centre) . side >= least.
  static void sphere(const Line& line, const RoundPointD& p, const Vec3d& side, double least, double u,
                     Nearest& nearest) {
    const Vec3d m = line.o - p.center;
    const Roots roots = quadratic(dot(line.d, line.d), dot(m, line.d), dot(m, m) - p.radius * p.radius);
    for (int k = 0; k < roots.count; ++k) {
      const double t = roots.t[k];
      const Vec3d x = m + line.d * t;
      if (t < nearest.t && line.holds(t) && dot(x, side) >= least) nearest = {t, u, x};
    }
  }

  /// The cone around an axis from point `a` on, whose normals rise by an angle of this sine: where it is
  /// between `from` and `to` along the axis.
  static void cone(const Line& line, const RoundPointD& a, const Vec3d& axis, double sine, double way,
                   double from, double to, Nearest& nearest) {
    // With h along the axis, |x|^2 - h^2 = ((r - h sin) / cos)^2.
    const double square = 1 - sine * sine;
    const Vec3d m = line.o - a.center;
    const double mh = dot(m, axis), dh = dot(line.d, axis), r = a.radius - mh * sine;
    const Roots roots = quadratic((dot(line.d, line.d) - dh * dh) * square - dh * dh * sine * sine,
                                  (dot(m, line.d) - mh * dh) * square + r * dh * sine,
                                  (dot(m, m) - mh * mh) * square - r * r);
    for (int k = 0; k < roots.count; ++k) {
      const double t = roots.t[k];
      const Vec3d x = m + line.d * t;
      const double h = dot(x, axis);
      if (!(t < nearest.t) || !line.holds(t) || h < from || h > to || a.radius < h * sine) continue;
      const Vec3d radial = x - axis * h;
      const double size = length(radial);
      // The point of the axis that the normal begins at is the part u of the way.
      nearest = {t, std::clamp((h - size * sine / std::sqrt(square)) / way, 0.0, 1.0),
                 size > 0 ? radial * (std::sqrt(square) / size) + axis * sine : axis};
    }
  }

  const std::vector<std::uint32_t> first_;
};

}  // namespace

std::shared_ptr<const UserShape> make_moving_spheres(RoundPointKeys keys) {
  return std::make_shared<MovingSpheres>(std::move(keys));
}
std::shared_ptr<const UserShape> make_facing_discs(RoundPointKeys keys) {
  return std::make_shared<FacingDiscs>(std::move(keys));
}
std::shared_ptr<const UserShape> make_discs(RoundPointKeys keys, std::vector<std::vector<Vec3f>> normals) {
  return std::make_shared<Discs>(std::move(keys), std::move(normals));
}
std::shared_ptr<const UserShape> make_round_lines(RoundPointKeys keys, std::vector<std::uint32_t> first) {
  return std::make_shared<RoundLines>(std::move(keys), std::move(first));
}

}  // namespace oktett
