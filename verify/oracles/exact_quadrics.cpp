#include <algorithm>
#include <cmath>

#include "verify/cases/random_parameters.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

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

}  // namespace oktett
