#include <algorithm>
#include <cmath>

#include "kernels/exact/superquadric.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

using Form = SuperquadricShape::Form;

/// |x|^p or g_p(|x|).
template <class Real>
Real power(Real x, double p, bool ratio) {
  x = std::abs(x);
  if (!ratio) return std::pow(x, static_cast<Real>(p));
  const Real below = p + (1 - static_cast<Real>(p)) * x;
  return below > 0 ? x / below : HUGE_VALL;
}

template <class Real>
Real equation(const SuperquadricShape& s, const Vec3<Real>& p) {
  const Real x = p.x / s.radii.x, y = p.y / s.radii.y, z = p.z / s.radii.z;
  Real f = 0;
  switch (s.form) {
    case Form::ellipsoid:
      f = power(x, s.p, s.ratio) + power(y, s.q, s.ratio) + power(z, s.r, s.ratio) - 1;
      break;
    case Form::hyperboloid:
      f = power(x, s.p, s.ratio) + power(y, s.q, s.ratio) - power(z, s.r, s.ratio) - 1;
      // Beyond a pole nothing is inside.
      if (s.ratio && s.r > 1) f = std::max(f, std::abs(z) - static_cast<Real>(s.r) / (s.r - 1));
      if (!std::isfinite(f)) f = HUGE_VALL;
      for (int k = 0; k < 3; ++k)
        f = std::max({f, static_cast<Real>(s.lo[k]) - p[k], p[k] - static_cast<Real>(s.hi[k])});
      break;
    case Form::toroid: {
      const Real w = power(power(x, s.m, s.ratio) + power(y, s.n, s.ratio), s.q, s.ratio);
      f = power(static_cast<Real>(s.d) - w, s.r, s.ratio) + power(z, s.p, s.ratio) -
          static_cast<Real>(s.e) * s.e;
      break;
    }
  }
  return std::isnan(f) ? HUGE_VALL : f;
}

/// In `long double` where `double` might not tell the sign: the steepest power, of exponent 0.3, makes 1e-17
/// some 1e-5.
long double equation_value(const SuperquadricShape& s, const Vec3l& p) {
  const double rough = equation<double>(s, {double(p.x), double(p.y), double(p.z)});
  return std::abs(rough) > 0x1p-13 ? rough : equation<long double>(s, p);
}

double exponent(CaseRandom& random) {
  const double kind = random.unit();
  if (kind < 0.3) return 1 + std::floor(random.unit() * 7);
  return kind < 0.6 ? 1 + 7 * random.unit() : 0.4 + random.unit();
}

SuperquadricShape draw(CaseRandom& random, Form form, bool ratio) {
  SuperquadricShape s;
  s.form = form, s.ratio = ratio;
  s.radii = {0.5 + random.unit(), 0.5 + random.unit(), 0.5 + random.unit()};
  s.p = exponent(random), s.q = exponent(random), s.r = exponent(random);
  if (random.unit() < 0.4) s.q = s.r = s.p;
  return s;
}

template <Form kForm, bool kRatio>
ExactOracle oracle(CaseRandom& random) {
  SuperquadricShape s = draw(random, kForm, kRatio);
  Vec3d lo = -s.radii, hi = s.radii;
  if (kForm == Form::hyperboloid) {
    s.lo = Vec3d{-1, -1, -1} * (1 + random.unit()), s.hi = Vec3d{1, 1, 1} * (1 + random.unit());
    lo = s.lo, hi = s.hi;
  }
  if (kForm == Form::toroid) {
    s.m = exponent(random), s.n = exponent(random);
    s.q = kRatio ? 0.5 + random.unit() : 0.3 + 0.7 * random.unit(), s.r = 1 + 2 * random.unit();
    s.d = 0.5 + 0.4 * random.unit(), s.e = 0.2 + 0.3 * random.unit();
    // Where the equation has no bound there is nothing to compare.
    while (!std::isfinite(Superquadric::reach(s).x + Superquadric::reach(s).y + Superquadric::reach(s).z))
      s.m = 1 + random.unit(), s.n = 1 + random.unit(), s.q = 1, s.p = 1 + random.unit();
    hi = Superquadric::reach(s), lo = -hi;
  }
  static constexpr const char* kNames[2][3] = {{"superellipsoid", "superhyperboloid", "supertoroid"},
                                               {"ratioellipsoid", "ratiohyperboloid", "ratiotoroid"}};
  return {kNames[kRatio][static_cast<int>(kForm)],
          {s},
          [s](const Vec3l& p) { return equation_value(s, p); },
          lo,
          hi,
          {}};
}

}  // namespace

std::vector<DrawExact> superquadric_oracles() {
  return {oracle<Form::ellipsoid, false>, oracle<Form::hyperboloid, false>, oracle<Form::toroid, false>,
          oracle<Form::ellipsoid, true>,  oracle<Form::hyperboloid, true>,  oracle<Form::toroid, true>};
}

}  // namespace oktett
