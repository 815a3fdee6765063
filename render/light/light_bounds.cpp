#include "render/light/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

/// Added to each joined cone, for the rounding of its axis.
static constexpr double kSlack = 1e-6;

double lit_part(double spread) {
  const double cosine = portable::cos(spread), mean = (1 + cosine) / 2;
  const double width = cosine > 0 ? portable::sin(spread) : 1;
  return mean >= width ? mean : (mean + width) * (mean + width) / (4 * width);
}

LightBounds join(const LightBounds& a, const LightBounds& b) {
  LightBounds sum = a;
  sum.box.grow(b.box);
  sum.reach = std::max(a.reach, b.reach);
  sum.both_sides = a.both_sides || b.both_sides;
  sum.power = a.power + b.power;
  const Vec3d p = normalize(Vec3d(a.axis));
  Vec3d q = normalize(Vec3d(b.axis));
  if (a.both_sides && b.both_sides && dot(p, q) < 0) q = -q;
  if (p == q) {
    sum.spread = std::max(a.spread, b.spread);
    return sum;
  }
  const Vec3d side = q - p * dot(p, q);
  const double sine = length(side), between = portable::atan2(sine, dot(p, q));
  if (between + b.spread <= a.spread) return sum;
  if (between + a.spread <= b.spread) {
    sum.axis = Vec3f(q), sum.spread = b.spread;
    return sum;
  }
  const double spread = (a.spread + between + b.spread) / 2;
  // Opposite axes leave open where to turn.
  if (spread + kSlack >= std::numbers::pi || (sine < kSlack && dot(p, q) < 0)) {
    sum.spread = static_cast<float>(std::numbers::pi);
    return sum;
  }
  const double turn = spread - a.spread;
  sum.axis = Vec3f(normalize(p * portable::cos(turn) + side * (portable::sin(turn) / std::max(sine, 1e-30))));
  sum.spread = static_cast<float>(spread + kSlack);
  return sum;
}

}  // namespace oktett
