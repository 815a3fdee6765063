#include <algorithm>
#include <cmath>

#include "verify/cases/random_parameters.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

Vec3l widen(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Height above `from` along the axis, and the distance from the axis.
struct AxisPosition {
  long double height, radius, length;
};
AxisPosition along(const Vec3d& from, const Vec3d& to, const Vec3l& p) {
  const Vec3l a = widen(to) - widen(from), q = p - widen(from);
  const long double l = std::sqrt(dot(a, a)), h = dot(q, a) / l;
  const Vec3l off = cross(q, a);
  return {h, std::sqrt(dot(off, off)) / l, l};
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

/// The box of two balls.
void bound(ExactOracle& oracle, const Vec3d& a, double ra, const Vec3d& b, double rb) {
  oracle.lo = min(a - Vec3d{ra, ra, ra}, b - Vec3d{rb, rb, rb});
  oracle.hi = max(a + Vec3d{ra, ra, ra}, b + Vec3d{rb, rb, rb});
}

ExactOracle frustum(std::string name, ExactForm form, const Vec3d& from, const Vec3d& to, double r0,
                    double r1, bool open) {
  ExactOracle oracle;
  oracle.name = std::move(name), oracle.shape = {std::move(form)};
  const auto side = [=](const Vec3l& p) {
    const AxisPosition at = along(from, to, p);
    return at.radius - (r0 + (static_cast<long double>(r1) - r0) * (at.height / at.length));
  };
  const auto ends = [=](const Vec3l& p) {
    const AxisPosition at = along(from, to, p);
    return std::max(-at.height, at.height - at.length);
  };
  if (open) {
    oracle.f = side, oracle.where = ends;
  } else {
    oracle.f = [=](const Vec3l& p) { return std::max(side(p), ends(p)); };
  }
  bound(oracle, from, r0, to, r1);
  return oracle;
}

ExactOracle draw_cylinder(CaseRandom& random, const char* name, bool open) {
  auto s = draw_shape<CylinderShape>(random);
  draw_axis(random, s.from, s.to);
  s.open = open;
  return frustum(name, s, s.from, s.to, s.radius, s.radius, open);
}
ExactOracle cylinder(CaseRandom& random) { return draw_cylinder(random, "cylinder", false); }
ExactOracle open_cylinder(CaseRandom& random) { return draw_cylinder(random, "cylinder_open", true); }

ExactOracle draw_cone(CaseRandom& random, const char* name, bool open) {
  auto s = draw_shape<ConeShape>(random);
  draw_axis(random, s.from, s.to);
  const double kind = random.unit();
  if (kind < 0.3) s.to_radius = 0;
  if (kind > 0.8) s.from_radius = 0;
  s.open = open;
  return frustum(name, s, s.from, s.to, s.from_radius, s.to_radius, open);
}
ExactOracle cone(CaseRandom& random) { return draw_cone(random, "cone", false); }
ExactOracle open_cone(CaseRandom& random) { return draw_cone(random, "cone_open", true); }

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
  ExactOracle oracle;
  oracle.name = "polyhedron";
  oracle.shape = {s};
  oracle.f = [s](const Vec3l& p) {
    long double f = -1e30L;
    for (const HalfSpace& h : s.planes) {
      const Vec3l n = widen(h.normal);
      f = std::max(f, (dot(n, p) - h.offset) / std::sqrt(dot(n, n)));
    }
    return f;
  };
  oracle.lo = center - Vec3d{1, 1, 1}, oracle.hi = center + Vec3d{1, 1, 1};
  return oracle;
}

/// The equation as it is written, within the box if there is one.
ExactOracle quadric_oracle(const char* name, const QuadricShape& s) {
  ExactOracle oracle;
  oracle.name = name;
  oracle.shape = {s};
  const auto f = [s](const Vec3l& p) {
    const auto& c = s.coefficients;
    return c[0] * p.x * p.x + c[1] * p.y * p.y + c[2] * p.z * p.z + c[3] * p.x * p.y + c[4] * p.x * p.z +
           c[5] * p.y * p.z + c[6] * p.x + c[7] * p.y + c[8] * p.z + c[9];
  };
  const auto box = [s](const Vec3l& p) {
    long double outside = -1e30L;
    for (int k = 0; k < 3; ++k) outside = std::max({outside, s.lo[k] - p[k], p[k] - s.hi[k]});
    return outside;
  };
  oracle.f = f;
  if (s.clipped && s.open) oracle.where = box;
  if (s.clipped && !s.open) oracle.f = [=](const Vec3l& p) { return std::max(f(p), box(p)); };
  oracle.lo = s.lo, oracle.hi = s.hi;
  return oracle;
}

/// A box about the origin, or none at all.
void draw_clip(CaseRandom& random, QuadricShape& s) {
  s.clipped = random.unit() < 0.8;
  s.lo = Vec3d{-1, -1, -1} * (0.5 + 1.5 * random.unit()), s.hi = Vec3d{1, 1, 1} * (0.5 + 1.5 * random.unit());
  s.lo.z *= 0.5 + random.unit(), s.hi.y *= 0.5 + random.unit();
}

QuadricShape draw_quadric(CaseRandom& random) {
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
  return s;
}

ExactOracle quadric(CaseRandom& random) { return quadric_oracle("quadric", draw_quadric(random)); }
ExactOracle open_quadric(CaseRandom& random) {
  QuadricShape s = draw_quadric(random);
  s.open = true;
  return quadric_oracle("quadric_open", s);
}
ExactOracle infinite_cylinder(CaseRandom& random) {
  QuadricShape s;
  s.coefficients = {1, 1, 0, 0, 0, 0, 0, 0, 0, -1};
  draw_clip(random, s);
  return quadric_oracle("infinite_cylinder", s);
}
ExactOracle paraboloid(CaseRandom& random) {
  QuadricShape s;
  s.coefficients = {1, 1, 0, 0, 0, 0, 0, 0, -1, 0};
  draw_clip(random, s);
  return quadric_oracle("paraboloid", s);
}
ExactOracle hyperboloid(CaseRandom& random) {
  QuadricShape s;
  s.coefficients = {1, 1, -1, 0, 0, 0, 0, 0, 0, random.unit() < 0.5 ? 1.0 : -1.0};
  draw_clip(random, s);
  s.lo = s.lo * 1.5, s.hi = s.hi * 1.5;
  return quadric_oracle("hyperboloid", s);
}

}  // namespace

std::vector<DrawExact> quadric_oracles() {
  return {cylinder,     open_cylinder,     cone,       open_cone,  polyhedron, quadric,
          open_quadric, infinite_cylinder, paraboloid, hyperboloid};
}

}  // namespace oktett
