#!/usr/bin/env bash
# A box around the origin of a ray is hit in PlayCanvas, unless one asks where.
#
# One would guess: intersectsRay(ray, point) of a box returns the same with and without its second argument, into which the place of the hit is
# written. From within it is the place where the ray leaves, as for a sphere.
# What happens: PlayCanvas 2.23.3 says true for a ray from within, and false for the same ray if a point is passed, for BoundingBox and
# OrientedBox. A ray along the face at +1 is hit both ways, one along the face at -1 only without a point. BoundingSphere answers alike, and
# with the place of leaving from within.
# Why a user of a ray tracer meets it: boxes bound rooms and clusters, where cameras and points to be lit are inside. A traversal that asks for
# the place skips all that surrounds it, and one that does not ask finds it.
#
# Needs npm, node 18 or later and the network. npm: playcanvas 2.23.3. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" playcanvas@2.23.3 >log

cat >box.mjs <<'JAVASCRIPT'
import { BoundingBox, BoundingSphere, Mat4, OrientedBox, Ray, Vec3 } from 'playcanvas';

const shapes = [
  new BoundingBox(new Vec3(0, 0, 0), new Vec3(1, 1, 1)),
  new OrientedBox(new Mat4(), new Vec3(1, 1, 1)),
  new BoundingSphere(new Vec3(0, 0, 0), 1),
];
const rays = [
  [[0, 0.6, 5], [0, 0, -1]],
  [[0, 0.6, 5], [0, 0, 1]],
  [[0, 0.6, 0], [0, 0, -1]],
  [[0, 1, 5], [0, 0, -1]],
  [[0, -1, 5], [0, 0, -1]],
];
for (const [origin, direction] of rays) {
  const ray = new Ray(new Vec3(...origin), new Vec3(...direction));
  for (const shape of shapes) {
    const point = new Vec3(NaN, NaN, NaN);
    const plain = shape.intersectsRay(ray);
    const asked = shape.intersectsRay(ray, point);
    console.log(`${plain}, ${asked ? [point.x, point.y, point.z].map(value => +value.toFixed(3)).join(' ') : 'false'}`);
  }
}
JAVASCRIPT
node box.mjs 2>log >out

guess "true and a place, or false twice"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "from outside, box" "true, 0 0.6 1"
expect "oriented box" "true, 0 0.6 1"
expect "sphere" "true, 0 0.6 0.8"
expect "away from it, box" "false, false"
expect "oriented box" "false, false"
expect "sphere" "false, false"
expect "from within, box" "true, false"
expect "oriented box" "true, false"
expect "sphere" "true, 0 0.6 -0.8"
expect "along the face at +1, box" "true, 0 1 1"
expect "oriented box" "true, 0 1 1"
expect "sphere, which it touches" "true, 0 1 0"
expect "along the face at -1, box" "true, false"
expect "oriented box" "true, false"
expect "sphere, which it touches" "true, 0 -1 0"
finish
