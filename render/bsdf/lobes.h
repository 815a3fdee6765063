#pragma once
/// \file What the lobes of all materials share: results, choice of a lobe, directions of cosines.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/math.h"
#include "core/vec3.h"
#include "render/sampling/warp.h"

namespace oktett {

/// Scattering from one direction.
struct BsdfValue {
  Color value;    ///< f |cos(wi)|, the sum of all lobes that are not delta
  float pdf = 0;  ///< density per solid angle of `sample` choosing wi by those lobes
};

/// A sampled direction.
struct BsdfSample {
  Vec3f direction;
  Color weight;              ///< value / pdf; for delta lobes their coefficient / probability
  float pdf = 0;             ///< as in BsdfValue; 0 for delta lobes
  bool delta = false;        ///< the direction is one of finitely many
  bool transmitted = false;  ///< the direction leads below the surface
};

inline constexpr double kBelowOne = 1 - 0x1p-53;

/// `x` within [least, most]; `least` for NaN.
inline double limited(double x, double least, double most) { return x > least ? std::min(x, most) : least; }
inline Vec3d limited(const Color& c, double least, double most) {
  return {limited(c.x, least, most), limited(c.y, least, most), limited(c.z, least, most)};
}

/// The direction to a viewer, of unit length in double and not below or along the surface.
inline Vec3d direction_above(const Vec3f& wo) {
  const Vec3d w{wo.x, wo.y, std::max(1e-6, static_cast<double>(wo.z))};
  return normalize(w);
}

/// A direction above the surface with density cos / pi.
inline Vec3d cosine_above(const SquareSample& u) { return Vec3d(cosine_direction({0, 0, 1}, u)); }

/// The sample of a direction whose value and density are those of `lobes.evaluate`; nothing if that is black.
/// `evaluate` must not be inlined: GCC 12 leaves out the rounding of vectors to float and back (-O2 and
/// more).
template <class Lobes>
std::optional<BsdfSample> sample_of(const Lobes& lobes, const Vec3d& direction) {
  const Vec3f wi(direction);
  const BsdfValue at = lobes.evaluate(wi);
  if (!(at.pdf > 0)) return std::nullopt;
  return BsdfSample{wi, at.value / at.pdf, at.pdf, false, wi.z < 0};
}

/// The sample of a delta lobe of the coefficient and probability given.
inline std::optional<BsdfSample> delta_sample(const Vec3d& direction, const Vec3d& coefficient,
                                              double probability) {
  if (!(max_component(coefficient) > 0 && probability > 0)) return std::nullopt;
  return BsdfSample{Vec3f(direction), Color(coefficient / probability), 0, true, direction.z < 0};
}

/// Probabilities of N lobes.
template <int N>
class LobeChoice {
 public:
  double& operator[](int lobe) { return probability_[lobe]; }
  double operator[](int lobe) const { return probability_[lobe]; }

  /// Scales weights >= 0 to probabilities.
  void normalize() {
    double sum = 0;
    for (const double p : probability_) sum += p;
    for (double& p : probability_) p = sum > 0 ? p / sum : 0;
  }

  /// The lobe at place `u` in [0, 1); `u` becomes the place within that lobe, [0, 1). -1 if there is none.
  int pick(double& u) const {
    int chosen = -1;
    double begin = 0, end = 0;
    for (int i = 0; i < N; ++i) {
      if (!(probability_[i] > 0)) continue;
      chosen = i, begin = end, end += probability_[i];
      if (u < end) break;
    }
    if (chosen >= 0) u = std::clamp((u - begin) / probability_[chosen], 0.0, kBelowOne);
    return chosen;
  }

 private:
  double probability_[N] = {};
};

}  // namespace oktett
