#!/usr/bin/env bash
# The normal of a picked point leans the wrong way in Coin, if the shape is stretched, and is longer than 1.
#
# One would guess: SoPickedPoint::getNormal() is the normal of the surface in the scene, as getPoint() is its place: for a sphere that is
# stretched threefold along the ray, (0.914, 0, 0.406) at the place (0.6, 0, 2.4).
# What happens: Coin 4.0.0 gives the right place, and (0.6, 0, 2.4) as normal: 52 degrees from it. It multiplies the normal as if it were a direction,
# so it turns to where the shape is stretched, while the true one turns away. For a slope of a triangle that is stretched threefold it gives
# (-0.707, 0, 2.121) for (-0.949, 0, 0.316). Turned, moved and mirrored shapes have right ones.
# Why a user of a ray tracer meets it: SoRayPickAction is a ray caster for scenes of Inventor and VRML. Shades, reflections and things
# that are placed on what was hit are wrong, where ellipsoids are spheres with a scale.
#
# Needs Debian 12, g++ and the network. Debian 12: libcoin-dev 4.0.0+ds-3. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libcoin-dev=4.0.0+ds-3
cd "$work"

cat >pick.cpp <<'CPP'
#include <Inventor/SbViewportRegion.h>
#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/SoPickedPoint.h>
#include <Inventor/actions/SoRayPickAction.h>
#include <Inventor/nodes/SoSeparator.h>

#include <cstdio>
#include <string>

// A ray along -z through (x, y).
static void pick(const std::string& nodes, float x, float y) {
  const std::string scene = "#Inventor V2.1 ascii\nSeparator { " + nodes + " }\n";
  SoInput input;
  input.setBuffer(scene.data(), scene.size());
  SoSeparator* root = SoDB::readAll(&input);
  root->ref();
  SoRayPickAction action(SbViewportRegion(100, 100));
  action.setRay(SbVec3f(x, y, 9), SbVec3f(0, 0, -1));
  action.apply(root);
  const SbVec3f p = action.getPickedPoint()->getPoint(), n = action.getPickedPoint()->getNormal();
  std::printf("z %.3f, normal %.3f %.3f %.3f\n", p[2], n[0], n[1] + 0, n[2]);
  root->unref();
}

int main() {
  SoDB::init();
  const std::string slope = "Coordinate3 { point [0 0 0, 1 0 1, 0 1 0] } FaceSet { numVertices 3 }";
  pick("Sphere { }", .6f, 0);
  pick("Scale { scaleFactor 1 1 3 } Sphere { }", .6f, 0);
  pick(slope, .2f, .2f);
  pick("Scale { scaleFactor 1 1 3 } " + slope, .2f, .2f);
  pick("Coordinate3 { point [0 0 0, 1 0 3, 0 1 0] } FaceSet { numVertices 3 }", .2f, .2f);
  pick("Scale { scaleFactor -1 1 1 } " + slope, -.2f, .2f);
}
CPP
g++ -O1 -I"$root/usr/include" pick.cpp -o pick -L"$libraries" -lCoin -Wl,-rpath-link,"$libraries"
run "$work/pick" >out

guess "normals 0.6 0 0.8 of the sphere, 0.914 0 0.406 if it is stretched; -0.949 0 0.316 of the stretched slope"
seen "sphere" "z 0.800, normal 0.600 0.000 0.800" "$(sed -n 1p out)"
seen "sphere, scale 3 in z" "z 2.400, normal 0.600 0.000 2.400" "$(sed -n 2p out)"
seen "slope" "z 0.200, normal -0.707 0.000 0.707" "$(sed -n 3p out)"
seen "slope, scale 3 in z" "z 0.600, normal -0.707 0.000 2.121" "$(sed -n 4p out)"
seen "slope, coordinates multiplied by 3 in z" "z 0.600, normal -0.949 0.000 0.316" "$(sed -n 5p out)"
seen "slope, scale -1 in x" "z 0.200, normal 0.707 0.000 0.707" "$(sed -n 6p out)"
finish
