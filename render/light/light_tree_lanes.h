#pragma once
/// \file How a LightTree chooses: the importances of the children of quads, in lanes for one or several
/// points at once, and the choice among them. See light_tree.h for the method.
///
/// Four lanes belong to a point and its quad, one to each child. The functions are templates, so that code of
/// different instruction sets has its own; all give the same bits.

#include <cstddef>
#include <cstdint>

#include "core/lanes.h"
#include "core/platform.h"
#include "core/simd.h"
#include "core/vec3.h"
#include "render/light/light_sample.h"
#include "render/light/light_tree.h"

namespace oktett {

/// Light leaves and arrives up to this much, in cosines, beyond what the bounds say. It covers rounding.
inline constexpr float kLeastCosine = 1e-3f;

/// The part of the greatest cosine in the estimate of a mean cosine, and the part of the square of the radius
/// that the square of the distance is at least. Chosen for small variance in rows, clouds and clusters of
/// emitters.
inline constexpr float kPartOfGreatest = 0.1f;
inline constexpr float kPartOfRadius = 0.125f;

/// Squares of distances are at least this large, so that divisions do not overflow.
inline constexpr float kLeastSquare = 1e-30f;

/// Importances are at least this large where they are not 0, and at least this part of their sum.
inline constexpr float kLeastImportance = 1e-37f;
inline constexpr float kLeastPart = 0x1p-30f;

/// Points, each in the lanes of its quad.
template <class F>
struct LightPointLanes {
  F position[3], normal[3];
  typename F::M front_only, has_normal;
};

/// The columns of quads, each with the lanes of its point.
template <class F>
struct LightQuadLanes {
  F center[3], radius, axis[3], cos_spread, sin_spread, cos_limit, power;

  /// `load(column)` loads a column of all quads: column(quad) is where that of a quad begins.
  template <class Load>
  OKTETT_INLINE explicit LightQuadLanes(const Load& load) {
    const auto of = [&](auto member) { return load([=](const LightQuad& q) { return q.*member; }); };
    const auto axis_of = [&](auto member, int i) {
      return load([=](const LightQuad& q) { return (q.*member)[i]; });
    };
    for (int i = 0; i < 3; ++i)
      center[i] = axis_of(&LightQuad::center, i), axis[i] = axis_of(&LightQuad::axis, i);
    radius = of(&LightQuad::radius), power = of(&LightQuad::power);
    cos_spread = of(&LightQuad::cos_spread), sin_spread = of(&LightQuad::sin_spread);
    cos_limit = of(&LightQuad::cos_limit);
  }
};

/// The mean of max(0, x) for x uniform in [mean - width, mean + width].
template <class F>
OKTETT_INLINE F positive_part(const F& mean, const F& width) {
  const F wide = max(width, F(1e-6f)), above = min(max(mean + wide, F(0.0f)), F(2.0f) * wide);
  return above * above / (F(4.0f) * wide) + max(mean - wide, F(0.0f));
}

/// True where an angle of cosine `cosine` is surely greater than the sum of an angle of cosine `limit` and an
/// acute one of sine `ball`; 1 stands for any angle. cos(a + b) = cos(a) cos(b) - sin(a) sin(b) is not below
/// this bound.
template <class F>
OKTETT_INLINE typename F::M is_beyond(const F& cosine, const F& limit, const F& ball) {
  const F bound = min(limit, limit * (F(1.0f) - ball * ball)) - ball - F(kLeastCosine);
  return (ball < F(1.0f)) & (cosine < bound);
}

/// About the mean of the cosines of a set of angles, none taken below 0, whose cosines are `mean` plus or
/// minus `width`. `middle` is the cosine of the angle in their middle. The part of their greatest cosine
/// keeps the mean from being far too low where the few emitters that face the point are the strongest.
template <class F>
OKTETT_INLINE F mean_cosine(const F& mean, const F& width, const F& middle) {
  const F sum = min(max(middle + width, F(kLeastCosine)), F(1.0f));
  const F greatest = select(width < F(1.0f), sum, F(1.0f));
  return positive_part(mean, width) * F(1 - kPartOfGreatest) + greatest * F(kPartOfGreatest);
}

/// About the irradiance that each child may bring to its point; 0 for children that cannot light it.
template <class F>
OKTETT_INLINE F light_importances(const LightQuadLanes<F>& quad, const LightPointLanes<F>& point) {
  const F zero(0.0f), one(1.0f);
  const F x = quad.center[0] - point.position[0], y = quad.center[1] - point.position[1];
  const F z = quad.center[2] - point.position[2];
  const F square = max(x * x + y * y + z * z, F(kLeastSquare)), scale = one / sqrt(square);
  // The sine of half the angle that the sphere fills; from inside, light may come from all directions.
  const F ball = min(quad.radius * scale, one);

  const F cosine = -(quad.axis[0] * x + quad.axis[1] * y + quad.axis[2] * z) * scale;
  const F width = min(quad.sin_spread + ball, one);
  const auto back = quad.power < zero;
  const bool any_back = any(back);
  const F power = abs(quad.power), leaving = any_back ? select(back, abs(cosine), cosine) : cosine;
  const F mean = leaving * (one + quad.cos_spread) * F(0.5f);
  F leaving_part = mean_cosine(mean, width, leaving);
  if (any_back) leaving_part = leaving_part + select(back, positive_part(-mean, width), zero);
  const F nearest = max(square, F(kPartOfRadius) * quad.radius * quad.radius);
  const F facing = power / nearest * leaving_part;

  const F incidence = (point.normal[0] * x + point.normal[1] * y + point.normal[2] * z) * scale;
  const F arriving = select(point.front_only, incidence, abs(incidence));
  const F behind = select(point.front_only, zero, positive_part(-arriving, ball));
  const F cosines = mean_cosine(arriving, ball, arriving) + behind;
  const F importance = select(point.has_normal, facing * cosines, facing);

  const auto lit = (power > zero) & ~is_beyond(leaving, quad.cos_limit, ball) &
                   ~(point.has_normal & is_beyond(arriving, zero, ball));
  return select(lit, max(importance, F(kLeastImportance)), zero);
}

/// What a choice among the children of a quad goes by, of which `Q` holds four: their importances, such that
/// the sum is > 0 and finite, and no part of it but 0 is very small. Where no child can light the point, and
/// where floats overflow, their powers.
template <class Q>
struct LightWeights {
  float lane[LightQuad::kLanes];

  OKTETT_INLINE LightWeights(const LightQuad& quad, const Q& importances) {
    importances.store(lane);
    const float sum = (lane[0] + lane[1]) + (lane[2] + lane[3]);
    if (OKTETT_LIKELY(sum > 0 && sum < kInfinite)) {
      select(importances > Q(0.0f), max(importances, Q(sum * kLeastPart)), Q(0.0f)).store(lane);
      return;
    }
    for (std::uint32_t k = 0; k < LightQuad::kLanes; ++k)
      lane[k] = quad.power[k] < 0 ? -quad.power[k] : quad.power[k];
    // Powers of quads may be infinite sums.
    if (!((lane[0] + lane[1]) + (lane[2] + lane[3]) < kInfinite))
      for (float& x : lane) x = x > 0 ? 1.0f : 0.0f;
  }

  OKTETT_INLINE double sum() const { return ((double{lane[0]} + lane[1]) + lane[2]) + lane[3]; }

 private:
  static constexpr float kInfinite = __builtin_inff();
};

/// N choices on their way down, in columns.
template <std::size_t N>
struct LightWalks {
  double u[2][N];          ///< random numbers in [0, 1), uniform again after each step
  double probability[N];   ///< 1 at first
  std::uint32_t child[N];  ///< as in a LightQuad; at first the number 0 of the root

  // What the next step goes by.
  float weight[LightQuad::kLanes][N];
  float boundary[LightQuad::kDecisions][N], dimension[LightQuad::kDecisions][N];

  float chosen[N];  ///< the child, by number

  OKTETT_INLINE void begin(std::size_t i, double x, double y) {
    u[0][i] = x, u[1][i] = y, probability[i] = 1, child[i] = 0;
  }

  template <class Q>
  OKTETT_INLINE void look_at(std::size_t i, const LightQuad& quad, const LightWeights<Q>& weights) {
    for (std::uint32_t k = 0; k < LightQuad::kLanes; ++k) weight[k][i] = weights.lane[k];
    for (std::uint32_t k = 0; k < LightQuad::kDecisions; ++k) {
      boundary[k][i] = static_cast<float>(static_cast<std::int32_t>(quad.boundary(k)));
      dimension[k][i] = static_cast<float>(static_cast<std::int32_t>(quad.dimension(k)));
    }
  }
};

/// Chooses children for the walks from number `i` on, W at once, without branches, as no processor
/// can predict them.
template <int W, class A, std::size_t N>
OKTETT_INLINE void choose_children(LightWalks<N>& walks, std::size_t i) {
  constexpr std::uint32_t kLanes = LightQuad::kLanes;
  using D = Simd<double, W, A>;
  using F = Simd<float, W, A>;
  const D zero(0.0);
  D weight[kLanes], end[kLanes];
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    weight[k] = to_double(F::load(walks.weight[k] + i));
    end[k] = k == 0 ? weight[k] : end[k - 1] + weight[k];
  }
  // The children that are left are those from `first` to before `last`, whose weights are those in between.
  D first = zero, last(double{kLanes}), before = zero, after = end[kLanes - 1];
  D u[2] = {D::load(walks.u[0] + i), D::load(walks.u[1] + i)};
  for (std::uint32_t k = 0; k < LightQuad::kDecisions; ++k) {
    const D boundary = to_double(F::load(walks.boundary[k] + i));
    const auto other = to_double(F::load(walks.dimension[k] + i)) > zero;
    const D middle = select(boundary < D(2.0), end[0], select(boundary < D(3.0), end[1], end[2]));
    const D left = middle - before, right = after - middle;
    const D place = select(other, u[1], u[0]) * (after - before);
    // A part of weight 0 is never taken.
    const auto second = (left <= place) & (zero < right), asked = (first < boundary) & (boundary < last);
    const D rest = select(second, place - left, place) / select(second, right, left);
    // Rounding may give 1.
    const D within = min(rest, D(1 - 0x1p-53));
    u[0] = select(asked & ~other, within, u[0]), u[1] = select(asked & other, within, u[1]);
    const auto up = asked & second, down = asked & ~second;
    first = select(up, boundary, first), before = select(up, middle, before);
    last = select(down, boundary, last), after = select(down, middle, after);
  }
  const D chosen = select(first < D(1.0), weight[0],
                          select(first < D(2.0), weight[1], select(first < D(3.0), weight[2], weight[3])));
  (D::load(walks.probability + i) * (chosen / end[kLanes - 1])).store(walks.probability + i);
  u[0].store(walks.u[0] + i), u[1].store(walks.u[1] + i);
  to_float(first).store(walks.chosen + i);
}

}  // namespace oktett
