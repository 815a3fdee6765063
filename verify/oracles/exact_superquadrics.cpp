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
  Real f;
  if (s.form == Form::toroid) {
    const Real w = power(power(x, s.m, s.ratio) + power(y, s.n, s.ratio), s.q, s.ratio);
    f = power(static_cast<Real>(s.d) - w, s.r, s.ratio) + power(z, s.p, s.ratio) -
        static_cast<Real>(s.e) * s.e;
  } else {
    const Real zr = power(z, s.r, s.ratio), xy = power(x, s.p, s.ratio) + power(y, s.q, s.ratio);
    f = s.form == Form::ellipsoid ? xy + zr - 1 : xy - zr - 1;
    // Beyond a pole nothing is inside.
    if (s.form == Form::hyperboloid && s.ratio && s.r > 1)
      f = std::max(f, std::abs(z) - static_cast<Real>(s.r) / (s.r - 1));
  }
  return std::isfinite(f) ? f : HUGE_VALL;
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

template <Form kForm, bool kRatio>
ExactOracle draw(CaseRandom& random) {
  SuperquadricShape s;
  s.form = kForm, s.ratio = kRatio;
  s.radii = {0.5 + random.unit(), 0.5 + random.unit(), 0.5 + random.unit()};
  s.p = exponent(random), s.q = exponent(random), s.r = exponent(random);
  if (random.unit() < 0.4) s.q = s.r = s.p;
  if (kForm == Form::hyperboloid)
    s.lo = Vec3d{-1, -1, -1} * (1 + random.unit()), s.hi = Vec3d{1, 1, 1} * (1 + random.unit());
  if (kForm == Form::toroid) {
    s.m = exponent(random), s.n = exponent(random);
    s.q = kRatio ? 0.5 + random.unit() : 0.3 + 0.7 * random.unit(), s.r = 1 + 2 * random.unit();
    s.d = 0.5 + 0.4 * random.unit(), s.e = 0.2 + 0.3 * random.unit();
    // Where the equation has no bound there is nothing to compare.
    while (!is_finite(Superquadric::reach(s)))
      s.m = 1 + random.unit(), s.n = 1 + random.unit(), s.q = 1, s.p = 1 + random.unit();
  }
  return oracle_of(s);
}

}  // namespace

ExactOracle oracle_of(const SuperquadricShape& s) {
  const Vec3d reach = s.form == Form::toroid ? Superquadric::reach(s) : s.radii;
  ExactOracle oracle{{s}, [s](const Vec3l& p) { return equation_value(s, p); }, -reach, reach};
  if (s.form == Form::hyperboloid) cut_by_box(oracle, s.lo, s.hi, false);
  return oracle;
}

std::vector<ExactCase> superquadric_cases() {
  return {{"superellipsoid", draw<Form::ellipsoid, false>},
          {"superhyperboloid", draw<Form::hyperboloid, false>},
          {"supertoroid", draw<Form::toroid, false>},
          {"ratioellipsoid", draw<Form::ellipsoid, true>},
          {"ratiohyperboloid", draw<Form::hyperboloid, true>},
          {"ratiotoroid", draw<Form::toroid, true>}};
}

}  // namespace oktett
