#!/usr/bin/env bash
# A ray through the edge that two triangles share hits both in ODE from above, and neither from below.
#
# One would guess: one hit or two from each side, or in the worst case none from each side. The edge and the middle of it are
# exact numbers here.
# What happens: ODE 0.16.2 counts 2 hits for the ray downwards through the diagonal of a square and 0
# for the same ray upwards. Beside the edge each ray has one hit.
# Why a user of a ray tracer meets it: robots and games cast rays at height fields and floors made of squares, from the middles of
# cells: every such ray lies on a diagonal. A hit count that is compared with another caster is wrong both ways.
#
# Needs Debian 12, g++ and the network. Debian 12: libode-dev 2:0.16.2-1. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libode-dev=2:0.16.2-1 libode8=2:0.16.2-1
cd "$work"

cat >edge.cpp <<'CPP'
#include <ode/ode.h>

#include <cstdio>

int main() {
  dInitODE();
  const float vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const dTriIndex triangles[] = {0, 1, 2, 0, 2, 3};
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, vertices, 3 * sizeof(float), 4, triangles, 6, 3 * sizeof(dTriIndex));
  const dGeomID mesh = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  const auto hits = [&](double x, double y, double z) {
    const dGeomID ray = dCreateRay(nullptr, 5);
    dGeomRaySet(ray, x, y, z, 0, 0, -z);
    dContactGeom contacts[32];
    std::printf("%d\n", dCollide(ray, mesh, 32, contacts, sizeof(dContactGeom)));
  };
  hits(.75, .25, 1);
  hits(.75, .25, -1);
  hits(.5, .5, 1);
  hits(.5, .5, -1);
  hits(.25, .25, 1);
  hits(.25, .25, -1);
}
CPP
g++ -O1 -I"$root/usr/include" edge.cpp -o edge -L"$libraries" -lode -Wl,-rpath-link,"$libraries"
run "$work/edge" >out

guess "the same number of hits from both sides"
seen "within a triangle, downwards" 1 "$(sed -n 1p out)"
seen "within a triangle, upwards" 1 "$(sed -n 2p out)"
seen "middle of the shared edge, downwards" 2 "$(sed -n 3p out)"
seen "middle of the shared edge, upwards" 0 "$(sed -n 4p out)"
seen "a quarter along the shared edge, downwards" 2 "$(sed -n 5p out)"
seen "a quarter along the shared edge, upwards" 0 "$(sed -n 6p out)"
finish
