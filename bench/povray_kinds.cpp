#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/povray_scene.h"
#include "kernels/functions/function_tape.h"

namespace oktett::bench {

namespace {

FieldObject torus(const double (&)[6]) {
  return {"torus { 0.7, 0.3 rotate <90, 0, 0> }", ExactShape{TorusShape{0.7, 0.3}}, [](const Vec3l& p) {
            const long double d = std::hypot(p.x, p.y) - 0.7L;
            return d * d + p.z * p.z - 0.3L * 0.3L;
          }};
}

FieldObject sphere(const double (&)[6]) {
  return {"sphere { 0, 0.9 }", SphereShape{{0, 0, 0}, 0.9},
          [](const Vec3l& p) { return dot(p, p) - 0.9L * 0.9L; }};
}

FieldObject cylinder(const double (&)[6]) {
  return {"cylinder { <0, -0.8, 0>, <0, 0.8, 0>, 0.6 }",
          ExactShape{CylinderShape{{0, -0.8, 0}, {0, 0.8, 0}, 0.6}},
          [](const Vec3l& p) { return std::max(std::hypot(p.x, p.z) - 0.6L, std::abs(p.y) - 0.8L); }};
}

FieldObject cone(const double (&)[6]) {
  return {"cone { <0, -0.8, 0>, 0.7, <0, 0.8, 0>, 0.2 }",
          ExactShape{ConeShape{{0, -0.8, 0}, {0, 0.8, 0}, 0.7, 0.2}}, [](const Vec3l& p) {
            return std::max(std::hypot(p.x, p.z) - (0.45L - 0.3125L * p.y), std::abs(p.y) - 0.8L);
          }};
}

FieldObject quadric(const double (&)[6]) {
  return {"intersection { quadric { <1, -1, 1>, <0, 0, 0>, <0, 0, 0>, -0.2 } box { -1, 1 } }",
          ExactShape{QuadricShape{{1, -1, 1, 0, 0, 0, 0, 0, 0, -0.2}, true}}, [](const Vec3l& p) {
            return std::max({p.x * p.x - p.y * p.y + p.z * p.z - 0.2L, std::abs(p.x) - 1, std::abs(p.y) - 1,
                             std::abs(p.z) - 1});
          }};
}

/// A dodecahedron.
FieldObject polyhedron(const double (&)[6]) {
  FieldObject object{"intersection {", ExactShape{}, {}};
  PolyhedronShape shape;
  const double phi = (1 + std::sqrt(5.0)) / 2, inverse = 1 / std::sqrt(1 + phi * phi);
  for (int k = 0; k < 12; ++k) {
    Vec3d n{0, 0, 0};
    n[k / 4] = (k & 1) != 0 ? inverse : -inverse,
          n[(k / 4 + 1) % 3] = (k & 2) != 0 ? phi * inverse : -phi * inverse;
    shape.planes.push_back({n, 0.75});
    object.pov += fmt::format(" plane {{ <{}, {}, {}>, 0.75 }}", n.x, n.y, n.z);
  }
  object.pov += " bounded_by { sphere { 0, 0.95 } } }";
  object.shape = ExactShape{shape};
  object.f = [shape](const Vec3l& p) {
    long double f = -1;
    for (const HalfSpace& h : shape.planes)
      f = std::max(f, h.normal.x * p.x + h.normal.y * p.y + h.normal.z * p.z - h.offset);
    return f;
  };
  return object;
}

FieldObject quartic(const double (&)[6]) {
  PolynomialShape shape;
  shape.terms = {{4, 0, 0, 1},   {0, 4, 0, 1},    {0, 0, 4, 1},    {2, 2, 0, 2.2},  {2, 0, 2, 2.2},
                 {0, 2, 2, 2.2}, {2, 0, 0, -2.3}, {0, 2, 0, -2.3}, {0, 0, 2, -2.3}, {0, 0, 0, 1.3}};
  return {
      "intersection { poly { 4, <1,0,0,0,2.2,0,0,2.2,0,-2.3,0,0,0,0,0,0,0,0,0,0,"
      "1,0,0,2.2,0,-2.3,0,0,0,0,1,0,-2.3,0,1.3> } box { -1, 1 } }",
      ExactShape{shape}, [](const Vec3l& p) {
        const long double x = p.x * p.x, y = p.y * p.y, z = p.z * p.z;
        const long double f =
            x * x + y * y + z * z + 2.2L * (x * y + x * z + y * z) - 2.3L * (x + y + z) + 1.3L;
        return std::max({f, std::abs(p.x) - 1, std::abs(p.y) - 1, std::abs(p.z) - 1});
      }};
}

constexpr ProfilePoint kProfile[] = {{0.2, -1.1}, {0.5, -1.0}, {0.8, -0.4},
                                     {0.3, 0.3},  {0.5, 0.9},  {0.6, 1.2}};

/// The square of the radius is cubic between the points, with the slope between their neighbours.
long double outside_profile(const Vec3l& p) {
  std::size_t k = 1;
  while (k < 3 && p.y > kProfile[k + 1].height) ++k;
  const auto slope = [&](std::size_t i) {
    return 2 * static_cast<long double>(kProfile[i].radius) *
           (kProfile[i + 1].radius - kProfile[i - 1].radius) /
           (kProfile[i + 1].height - kProfile[i - 1].height);
  };
  const auto [r0, y0] = kProfile[k];
  const auto [r1, y1] = kProfile[k + 1];
  const long double h = y1 - y0, u = std::clamp((p.y - y0) / h, 0.0L, 1.0L), w = 1 - u;
  const long double square = r0 * r0 * w * w * (1 + 2 * u) + r1 * r1 * u * u * (1 + 2 * w) +
                             h * u * w * (slope(k) * w - slope(k + 1) * u);
  return std::max({p.x * p.x + p.z * p.z - square, kProfile[1].height - p.y, p.y - kProfile[4].height});
}

FieldObject revolution(const double (&)[6]) {
  RevolutionShape shape;
  shape.profile = RevolutionShape::Profile::sor;
  std::string pov = "sor { 6";
  for (const ProfilePoint& p : kProfile) {
    shape.points.push_back(p);
    pov += fmt::format(", <{}, {}>", p.radius, p.height);
  }
  return {pov + " }", ExactShape{shape}, outside_profile};
}

/// POV-Ray's (|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) = 1 is the same surface as ours if e = n.
FieldObject superellipsoid(const double (&r)[6]) {
  const double e = std::round((0.2 + 1.6 * r[0]) * 1000) / 1000;
  SuperquadricShape shape;
  shape.p = shape.q = shape.r = 2 / e;
  return {fmt::format("superellipsoid {{ <{}, {}> }}", e, e), ExactShape{shape}, [p = 2 / e](const Vec3l& x) {
            return std::pow(std::abs(x.x), p) + std::pow(std::abs(x.y), p) + std::pow(std::abs(x.z), p) - 1;
          }};
}

/// Six balls about the middle.
FieldObject metaballs(const double (&random)[6]) {
  FieldObject object{"blob { threshold 0.5", ExactShape{}, {}};
  MetaballsShape shape{0.5, {}};
  for (int k = 0; k < 6; ++k) {
    const auto at = [&](double step, int axis) { return k * step + random[axis] * 6; };
    const Vec3d c{0.5 * std::cos(at(2.4, 0)), 0.5 * std::cos(at(1.7, 1)), 0.5 * std::sin(at(2.1, 2))};
    shape.balls.push_back({c, 0.75, 1});
    object.pov += fmt::format(" sphere {{ <{}, {}, {}>, 0.75, 1 }}", c.x, c.y, c.z);
  }
  object.pov += " }";
  object.shape = ExactShape{shape};
  object.f = [shape](const Vec3l& p) {
    long double f = shape.iso;
    for (const MetaBall& ball : shape.balls) {
      const Vec3l d = p - Vec3l(ball.center);
      const long double q = 1 - dot(d, d) / (0.75L * 0.75L);
      if (q > 0) f -= q * q;
    }
    return f;
  };
  return object;
}

/// A piece of a gyroid in a box. Its gradient is nowhere longer than 4 sqrt(12).
FieldObject implicit(const double (&random)[6]) {
  const double c = std::round(600 * (random[0] - 0.5)) / 1000;
  const std::string text =
      fmt::format("sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x) - ({:.3f})", c);
  ImplicitShape shape;
  shape.function = compile_function(text);
  shape.lo = {-0.9, -0.9, -0.9}, shape.hi = {0.9, 0.9, 0.9};
  return {"isosurface { function { " + text +
              " } contained_by { box { -0.9, 0.9 } } accuracy 0.0001 max_gradient 13.86 }",
          ExactShape{shape}, [c](const Vec3l& p) {
            const auto wave = [](long double x, long double y) { return std::sin(4 * x) * std::cos(4 * y); };
            const long double f = wave(p.x, p.y) + wave(p.y, p.z) + wave(p.z, p.x) - c;
            return std::max({f, std::abs(p.x) - 0.9L, std::abs(p.y) - 0.9L, std::abs(p.z) - 0.9L});
          }};
}

}  // namespace

std::vector<FieldKind> field_kinds() {
  return {{"sphere", 10000, sphere},
          {"torus", 900, torus},
          {"cylinder", 900, cylinder},
          {"cone", 900, cone},
          {"quadric", 900, quadric},
          {"polyhedron", 900, polyhedron},
          {"quartic", 900, quartic},
          {"revolution", 900, revolution},
          {"superellipsoid", 900, superellipsoid},
          {"metaballs", 225, metaballs},
          {"implicit", 225, implicit},
          {"csg", 900, rounded_cube},
          {"csg_holes", 1, drilled_plate},
          {kTerrainKind, 1, nullptr}};
}

}  // namespace oktett::bench
