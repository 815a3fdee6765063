#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/povray_scene.h"
#include "kernels/exact/polynomial_expression.h"
#include "kernels/functions/function_tape.h"

namespace oktett::bench {

namespace {

/// The equation is that of the shape's oracle.
template <class S>
FieldObject exact_object(std::string pov, const S& shape) {
  return {std::move(pov), ExactShape{shape}, oracle_of(shape).f};
}

FieldObject sphere(const double (&)[6]) {
  return {"sphere { 0, 0.9 }", SphereShape{{0, 0, 0}, 0.9},
          [](const Vec3l& p) { return dot(p, p) - 0.9L * 0.9L; }};
}

FieldObject torus(const double (&)[6]) {
  return exact_object("torus { 0.7, 0.3 rotate <90, 0, 0> }", TorusShape{0.7, 0.3});
}

FieldObject cylinder(const double (&)[6]) {
  return exact_object("cylinder { <0, -0.8, 0>, <0, 0.8, 0>, 0.6 }",
                      CylinderShape{{0, -0.8, 0}, {0, 0.8, 0}, 0.6});
}

FieldObject cone(const double (&)[6]) {
  return exact_object("cone { <0, -0.8, 0>, 0.7, <0, 0.8, 0>, 0.2 }",
                      ConeShape{{0, -0.8, 0}, {0, 0.8, 0}, 0.7, 0.2});
}

FieldObject quadric(const double (&)[6]) {
  return exact_object("intersection { quadric { <1, -1, 1>, <0, 0, 0>, <0, 0, 0>, -0.2 } box { -1, 1 } }",
                      QuadricShape{{1, -1, 1, 0, 0, 0, 0, 0, 0, -0.2}, true});
}

/// A dodecahedron.
FieldObject polyhedron(const double (&)[6]) {
  std::string pov = "intersection {";
  PolyhedronShape shape;
  const double phi = (1 + std::sqrt(5.0)) / 2, inverse = 1 / std::sqrt(1 + phi * phi);
  for (int k = 0; k < 12; ++k) {
    Vec3d n{0, 0, 0};
    n[k / 4] = (k & 1) != 0 ? inverse : -inverse,
          n[(k / 4 + 1) % 3] = (k & 2) != 0 ? phi * inverse : -phi * inverse;
    shape.planes.push_back({n, 0.75});
    pov += fmt::format(" plane {{ <{}, {}, {}>, 0.75 }}", n.x, n.y, n.z);
  }
  return exact_object(pov + " bounded_by { sphere { 0, 0.95 } } }", shape);
}

FieldObject quartic(const double (&)[6]) {
  return exact_object(
      "intersection { poly { 4, <1,0,0,0,2.2,0,0,2.2,0,-2.3,0,0,0,0,0,0,0,0,0,0,"
      "1,0,0,2.2,0,-2.3,0,0,0,0,1,0,-2.3,0,1.3> } box { -1, 1 } }",
      PolynomialShape{expand_polynomial("x^4 + y^4 + z^4 + 2.2*(x^2*y^2 + x^2*z^2 + y^2*z^2)"
                                        " - 2.3*(x^2 + y^2 + z^2) + 1.3")});
}

FieldObject revolution(const double (&)[6]) {
  RevolutionShape shape;
  shape.profile = RevolutionShape::Profile::sor;
  shape.points = {{0.2, -1.1}, {0.5, -1.0}, {0.8, -0.4}, {0.3, 0.3}, {0.5, 0.9}, {0.6, 1.2}};
  std::string pov = "sor { 6";
  for (const ProfilePoint& p : shape.points) pov += fmt::format(", <{}, {}>", p.radius, p.height);
  return exact_object(pov + " }", shape);
}

/// POV-Ray's (|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) = 1 is the same surface as ours if e = n.
FieldObject superellipsoid(const double (&r)[6]) {
  const double e = std::round((0.2 + 1.6 * r[0]) * 1000) / 1000;
  SuperquadricShape shape;
  shape.p = shape.q = shape.r = 2 / e;
  return exact_object(fmt::format("superellipsoid {{ <{}, {}> }}", e, e), shape);
}

/// Six balls about the middle.
FieldObject metaballs(const double (&random)[6]) {
  std::string pov = "blob { threshold 0.5";
  MetaballsShape shape{0.5, {}};
  for (int k = 0; k < 6; ++k) {
    const auto at = [&](double step, int axis) { return k * step + random[axis] * 6; };
    const Vec3d c{0.5 * std::cos(at(2.4, 0)), 0.5 * std::cos(at(1.7, 1)), 0.5 * std::sin(at(2.1, 2))};
    shape.balls.push_back({c, 0.75, 1});
    pov += fmt::format(" sphere {{ <{}, {}, {}>, 0.75, 1 }}", c.x, c.y, c.z);
  }
  return exact_object(pov + " }", shape);
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
