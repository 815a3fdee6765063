/// \file Cylinders, cones, polyhedra, quadrics, superquadrics and ratioquadrics.

#include <algorithm>
#include <cmath>

#include "kernels/exact/superquadric.h"
#include "verify/cases/random_parameters.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

// ---- Quadrics.

namespace {

/// Height above `from` along the axis, and the distance from the axis.
struct AxisPosition {
  Real height, radius, length;
};
AxisPosition along(const Vec3d& from, const Vec3d& to, const Vec3l& p) {
  const Vec3l a = Vec3l(to) - Vec3l(from), q = p - Vec3l(from), off = cross(q, a);
  const Real l = std::sqrt(dot(a, a));
  return {dot(q, a) / l, std::sqrt(dot(off, off)) / l, l};
}

/// Moves the ends of an axis, so that it is parallel to one of the world now and then and not too short.
void draw_axis(CaseRandom& random, const Vec3d& from, Vec3d& to) {
  if (random.unit() < 0.3) {
    const int axis = static_cast<int>(random.unit() * 3);
    const double end = to[axis];
    to = from, to[axis] = end;
  }
  if (length(to - from) < 0.1) to = from + Vec3d{0.5, 0.25, -0.5};
}

ExactOracle frustum(ExactForm form, const Vec3d& from, const Vec3d& to, double r0, double r1, bool open) {
  ExactOracle oracle{{std::move(form)}, [=](const Vec3l& p) {
                       const AxisPosition at = along(from, to, p);
                       return at.radius - (r0 + (static_cast<Real>(r1) - r0) * (at.height / at.length));
                     }};
  const auto ends = [=](const Vec3l& p) {
    const AxisPosition at = along(from, to, p);
    return std::max(-at.height, at.height - at.length);
  };
  cut(oracle, ends, open);
  oracle.grow(from, r0), oracle.grow(to, r1);
  return oracle;
}

template <bool kOpen>
ExactOracle cylinder(CaseRandom& random) {
  auto s = draw_shape<CylinderShape>(random);
  draw_axis(random, s.from, s.to);
  s.open = kOpen;
  return oracle_of(s);
}

template <bool kOpen>
ExactOracle cone(CaseRandom& random) {
  auto s = draw_shape<ConeShape>(random);
  draw_axis(random, s.from, s.to);
  const double kind = random.unit();
  if (kind < 0.3) s.to_radius = 0;
  if (kind > 0.8) s.from_radius = 0;
  s.open = kOpen;
  return oracle_of(s);
}

ExactOracle polyhedron(CaseRandom& random) {
  PolyhedronShape s;
  const Vec3d center = random.vector();
  // A box around it all, and planes that cut it anywhere.
  for (int k = 0; k < 6; ++k) {
    Vec3d n{0, 0, 0};
    n[k / 2] = k % 2 == 0 ? 1 : -2;
    s.planes.push_back({n, dot(n, center) + length(n)});
  }
  const int count = static_cast<int>(random.unit() * random.unit() * 60);
  for (int k = 0; k < count; ++k) {
    const Vec3d n = random.vector();
    s.planes.push_back({n, dot(n, center) + length(n) * (0.4 + random.unit())});
  }
  ExactOracle oracle = oracle_of(s);
  oracle.grow(center, 1);
  return oracle;
}

/// A box about the origin, or none at all.
void draw_clip(CaseRandom& random, QuadricShape& s) {
  s.clipped = random.unit() < 0.8;
  s.lo = Vec3d{-1, -1, -1} * (0.5 + 1.5 * random.unit()), s.hi = Vec3d{1, 1, 1} * (0.5 + 1.5 * random.unit());
  s.lo.z *= 0.5 + random.unit(), s.hi.y *= 0.5 + random.unit();
}

template <bool kOpen>
ExactOracle quadric(CaseRandom& random) {
  QuadricShape s;
  for (double& c : s.coefficients) c = random.sign();
  const double kind = random.unit();
  // Without mixed terms; without some squares; planes.
  if (kind < 0.4) s.coefficients[3] = s.coefficients[4] = s.coefficients[5] = 0;
  if (kind < 0.2) s.coefficients[static_cast<int>(random.unit() * 3)] = 0;
  if (kind < 0.05) s.coefficients[0] = s.coefficients[1] = s.coefficients[2] = 0;
  // An ellipsoid, which needs no box.
  if (kind > 0.8)
    for (int k = 0; k < 3; ++k)
      s.coefficients[k] = 1.2 + random.unit(), s.coefficients[9] = -random.unit() - 0.1;
  draw_clip(random, s);
  s.open = kOpen;
  return oracle_of(s);
}

ExactOracle named_quadric(CaseRandom& random, const std::array<double, 10>& coefficients, double size = 1) {
  QuadricShape s{coefficients};
  draw_clip(random, s);
  s.lo *= size, s.hi *= size;
  return oracle_of(s);
}
ExactOracle infinite_cylinder(CaseRandom& random) {
  return named_quadric(random, {1, 1, 0, 0, 0, 0, 0, 0, 0, -1});
}
ExactOracle paraboloid(CaseRandom& random) { return named_quadric(random, {1, 1, 0, 0, 0, 0, 0, 0, -1, 0}); }
ExactOracle hyperboloid(CaseRandom& random) {
  return named_quadric(random, {1, 1, -1, 0, 0, 0, 0, 0, 0, random.unit() < 0.5 ? 1.0 : -1.0}, 1.5);
}

}  // namespace

ExactOracle oracle_of(const CylinderShape& s) { return frustum(s, s.from, s.to, s.radius, s.radius, s.open); }

ExactOracle oracle_of(const ConeShape& s) {
  return frustum(s, s.from, s.to, s.from_radius, s.to_radius, s.open);
}

ExactOracle oracle_of(const PolyhedronShape& s) {
  return {{s}, [s](const Vec3l& p) {
            Real f = -HUGE_VALL;
            for (const HalfSpace& h : s.planes) {
              const Vec3l n(h.normal);
              f = std::max(f, (dot(n, p) - h.offset) / std::sqrt(dot(n, n)));
            }
            return f;
          }};
}

/// The equation as it is written, within the box if there is one.
ExactOracle oracle_of(const QuadricShape& s) {
  const auto f = [c = s.coefficients](const Vec3l& p) {
    return c[0] * p.x * p.x + c[1] * p.y * p.y + c[2] * p.z * p.z + c[3] * p.x * p.y + c[4] * p.x * p.z +
           c[5] * p.y * p.z + c[6] * p.x + c[7] * p.y + c[8] * p.z + c[9];
  };
  ExactOracle oracle{{s}, f, s.lo, s.hi};
  if (s.clipped) cut_by_box(oracle, s.lo, s.hi, s.open);
  return oracle;
}

std::vector<ExactCase> quadric_cases() {
  return {{"cylinder", cylinder<false>},   {"cylinder_open", cylinder<true>},
          {"cone", cone<false>},           {"cone_open", cone<true>},
          {"polyhedron", polyhedron},      {"quadric", quadric<false>},
          {"quadric_open", quadric<true>}, {"infinite_cylinder", infinite_cylinder},
          {"paraboloid", paraboloid},      {"hyperboloid", hyperboloid}};
}

// ---- Superquadrics and ratioquadrics.

namespace {

using std::abs, std::max;

using Form = SuperquadricShape::Form;

/// |x|^p or g_p(|x|).
template <class Real>
Real power(Real x, double p, bool ratio) {
  x = std::abs(x);
  if (!ratio) return std::pow(x, static_cast<Real>(p));
  const Real below = p + (1 - static_cast<Real>(p)) * x;
  return below > 0 ? x / below : HUGE_VALL;
}

/// Both rise.
Enclosure power(const Enclosure& x, double p, bool ratio) {
  return Enclosure::of_rising(abs(x), 0, [&](double at) { return power(at, p, ratio); });
}

template <class Real>
bool is_infinite(Real x) {
  return std::isinf(x);
}
bool is_infinite(const Enclosure& x) { return std::isinf(x.lo); }

/// The value, or infinity where it is none.
template <class Real>
Real finite(Real f) {
  return std::isfinite(f) ? f : HUGE_VALL;
}
Enclosure finite(const Enclosure& f) { return f; }

template <class Real>
Real equation(const SuperquadricShape& s, const Vec3<Real>& p) {
  const bool toroid = s.form == Form::toroid;
  const Real z = p.z / s.radii.z, px = power(p.x / s.radii.x, toroid ? s.m : s.p, s.ratio),
             py = power(p.y / s.radii.y, toroid ? s.n : s.q, s.ratio),
             pz = power(z, toroid ? s.p : s.r, s.ratio);
  if (is_infinite(px) || is_infinite(py) || is_infinite(pz)) return HUGE_VALL;
  if (toroid) {
    const Real w = power(px + py, s.q, s.ratio), e = s.e;
    return finite(power(s.d - w, s.r, s.ratio) + pz - e * e);
  }
  Real f = s.form == Form::ellipsoid ? px + py + pz - 1 : px + py - pz - 1;
  // Beyond a pole nothing is inside.
  if (s.form == Form::hyperboloid && s.ratio && s.r > 1)
    f = max(f, abs(z) - static_cast<Real>(s.r) / (s.r - 1));
  return finite(f);
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
    // A ring that is a point, as POV-Ray's superellipsoids have it.
    if (!kRatio && random.unit() < 0.4) {
      const double e = 2 / exponent(random), n = 2 / exponent(random);
      s.m = s.n = 2 / e, s.q = e / n, s.p = 2 / n, s.r = 1, s.d = 0, s.e = random.unit() < 0.5 ? 1 : s.e;
    }
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
  oracle.clear = clear_by([s](const Vec3<Enclosure>& p) { return equation(s, p); });
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
