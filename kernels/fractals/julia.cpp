#include "kernels/fractals/julia.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <type_traits>

namespace oktett {
namespace {

/// Halvings of the box that is looked at for bounds.
constexpr int kBoundLevels = 6;

/// An iteration of squares makes fewer than eight roundings of half of T's epsilon, one of cubes fewer than
/// 32, and one more where c is rounded to T.
template <class T>
JuliaNumbers<T> numbers_of(const JuliaElement& e) {
  const double u = std::numeric_limits<T>::epsilon() * (e.power == 2 ? 8 : 32);
  const double c = std::abs(e.c[0]) + std::abs(e.c[1]) + std::abs(e.c[2]) + std::abs(e.c[3]);
  const double k = e.product() * (1 + 4 * u);
  JuliaNumbers<T> n;
  for (int i = 0; i < 4; ++i) n.c[i] = static_cast<T>(e.c[i]);
  n.slice = static_cast<T>(e.slice), n.limit = static_cast<T>(e.radius * e.radius);
  n.outside = static_cast<T>(e.radius * (std::is_same_v<T, float> ? 1 + 0x1p-18 : 1 + 0x1p-40));
  n.round = static_cast<T>(u), n.product = static_cast<T>(e.power == 2 ? k : k * e.product());
  n.c_rounding = static_cast<T>(u * c);
  return n;
}

/// Whether all in the ball about p surely leaves the radius R.
bool escapes(const JuliaElement& e, const Vec3d& p, double radius) {
  JuliaNumber<double> z{p.x, p.y, p.z, e.slice};
  double eps = radius * (1 + 0x1p-40);
  for (int n = 0;; ++n) {
    const double zz = z.norm2(), length = std::sqrt(zz);
    if (length - eps > e.radius * (1 + 0x1p-40)) return true;
    if (n == e.iterations || !(eps < 1e6)) return false;
    const double factor = e.product(),
                 of_power = e.power == 2 ? factor * (2 * length + eps)
                                         : factor * factor * (3 * zz + 3 * length * eps + eps * eps);
    eps = of_power * eps + 0x1p-45 * (e.power == 2 ? zz + e.radius : zz * length + e.radius);
    z = z.next(e, e.c);
  }
}

/// Makes the box hold all of the smallest cubes that may hold points of the set.
void grow_bounds(const JuliaElement& e, const Vec3d& middle, double half, int levels, Vec3d& lo, Vec3d& hi) {
  bool known = true;
  for (int k = 0; k < 3; ++k) known &= lo[k] <= middle[k] - half && middle[k] + half <= hi[k];
  if (known || escapes(e, middle, half * std::sqrt(3.0))) return;
  if (levels == 0) {
    for (int k = 0; k < 3; ++k)
      lo[k] = std::min(lo[k], middle[k] - half), hi[k] = std::max(hi[k], middle[k] + half);
    return;
  }
  for (int k = 0; k < 8; ++k)
    grow_bounds(e, middle + Vec3d{k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half} * 0.5,
                half / 2, levels - 1, lo, hi);
}

/// Whether some of the balls about the smallest of these cubes does not surely escape.
bool may_stay(const JuliaElement& e, const Vec3d& middle, double half, int levels) {
  if (escapes(e, middle, half * std::sqrt(3.0))) return false;
  if (levels == 0) return true;
  for (int k = 0; k < 8; ++k)
    if (may_stay(e, middle + Vec3d{k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half} * 0.5,
                 half / 2, levels - 1))
      return true;
  return false;
}

/// Half of the cube about zero that holds all.
double half_of(const JuliaElement& e) { return e.radius * (1 + 0x1p-20); }

/// The element without its size; nothing if it is not as it must be.
std::optional<JuliaElement> element_of(const JuliaShape& s) {
  const double size = std::sqrt(s.c[0] * s.c[0] + s.c[1] * s.c[1] + s.c[2] * s.c[2] + s.c[3] * s.c[3]);
  if (!(size <= 2) || !std::isfinite(s.slice) || s.iterations < 1 || s.iterations > kMaxJuliaIterations)
    return std::nullopt;
  if (s.power != 2 && s.power != 3) return std::nullopt;
  const double radius = 0.5 * (1 + std::sqrt(1 + 4 * size));
  // A radius that is too small, too great or no number leaves that of the formula.
  const double escape = s.escape > radius && s.escape <= JuliaShape::kMostEscape ? s.escape : radius;
  JuliaElement e;
  std::copy_n(s.c, 4, e.c);
  e.slice = s.slice, e.radius = escape;
  e.iterations = static_cast<int>(s.iterations), e.power = static_cast<int>(s.power);
  e.hypercomplex = s.algebra == JuliaShape::Algebra::hypercomplex;
  e.in_doubles = numbers_of<double>(e), e.in_floats = numbers_of<float>(e);
  e.size = 0;
  return e;
}

}  // namespace

bool is_empty(const JuliaShape& shape) {
  const std::optional<JuliaElement> e = element_of(shape);
  return !e || !may_stay(*e, {0, 0, 0}, half_of(*e), kBoundLevels);
}

void Julia::add(Pool& pool, const JuliaShape& s, const ExactPlace& place) {
  const std::optional<JuliaElement> found = element_of(s);
  if (!found) return;
  JuliaElement e = *found;
  const double inf = std::numeric_limits<double>::infinity();
  Vec3d lo{inf, inf, inf}, hi{-inf, -inf, -inf};
  grow_bounds(e, {0, 0, 0}, half_of(e), kBoundLevels, lo, hi);
  if (!(lo.x < hi.x)) return;
  e.size = max_component(hi - lo);
  add_element(pool, e, place.to_world, place);
  const Vec3d room = Vec3d{1, 1, 1} * (e.size * 0x1p-30);
  add_cell(pool, lo - room, hi + room);
}

}  // namespace oktett
