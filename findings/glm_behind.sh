#!/usr/bin/env bash
# GLM's ray hits triangles behind its origin; its spheres and planes are not hit there.
#
# One would guess: intersectRayTriangle() is false for a triangle behind the origin, as intersectRaySphere() and intersectRayPlane() are.
# The third function for triangles, intersectLineTriangle(), tells the place of a hit in the parameter that is named position.
# What happens: GLM 0.9.9.8 says true for the triangle behind, with the distance -1. For spheres and planes behind
# it says false. "position" is the distance and the two barycentric coordinates, not a place.
# Why a user of a ray tracer meets it: a loop that keeps the hit of the least distance keeps the triangle that is farthest behind the camera,
# and all that is behind a point shadows it.
#
# Needs Debian 12, g++ and the network. Debian 12: libglm-dev 0.9.9.8+ds-6. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >behind.cpp <<'CPP'
#define GLM_ENABLE_EXPERIMENTAL
#include <cstdio>
#include <initializer_list>

#include <glm/glm.hpp>
#include <glm/gtx/intersect.hpp>

int main() {
  const glm::vec3 eye(.25f, .25f, 0), a(0, 0, -1), b(1, 0, -1), c(0, 1, -1);
  for (const float z : {-1.f, 1.f}) {
    const glm::vec3 direction(0, 0, z);
    glm::vec2 uv(0);
    float distance = 0;
    if (glm::intersectRayTriangle(eye, direction, a, b, c, uv, distance)) std::printf("hit, distance %g\n", distance);
    else std::puts("no hit");
    if (glm::intersectRaySphere(eye, direction, glm::vec3(.25f, .25f, -3), 1.f, distance)) std::printf("hit, distance %g\n", distance);
    else std::puts("no hit");
    if (glm::intersectRayPlane(eye, direction, a, glm::vec3(0, 0, 1), distance)) std::printf("hit, distance %g\n", distance);
    else std::puts("no hit");
  }
  glm::vec3 position(0);
  glm::intersectLineTriangle(glm::vec3(.125f, .5f, 1), glm::vec3(0, 0, -1), a, b, c, position);
  std::printf("%g %g %g\n", position.x, position.y, position.z);
}
CPP

guess "no hit behind the origin; position .125 .5 -1"
unpack bookworm amd64 libglm-dev=0.9.9.8+ds-6
g++ -O1 -I"$root/usr/include" behind.cpp -o behind
./behind >out
seen "triangle in front" "hit, distance 1" "$(sed -n 1p out)"
seen "sphere in front" "hit, distance 2" "$(sed -n 2p out)"
seen "plane in front" "hit, distance 1" "$(sed -n 3p out)"
seen "triangle behind" "hit, distance -1" "$(sed -n 4p out)"
seen "sphere behind" "no hit" "$(sed -n 5p out)"
seen "plane behind" "no hit" "$(sed -n 6p out)"
seen "position, of a line through .125 .5 -1" "2 0.125 0.5" "$(sed -n 7p out)"
finish
