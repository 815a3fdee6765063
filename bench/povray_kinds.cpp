#include <fmt/format.h>

#include <cmath>

#include "bench/povray_scene.h"

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

}  // namespace

std::vector<FieldKind> field_kinds() { return {{"sphere", 10000, sphere}, {"torus", 900, torus}}; }

}  // namespace oktett::bench
