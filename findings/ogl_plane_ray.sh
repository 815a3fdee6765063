#!/usr/bin/env bash
# A ray of OGL is elsewhere after it was intersected with a plane: it begins at the hit, and its direction is as long as the way there.
#
# One would guess: intersectPlane() of a Raycast answers where the ray meets the plane and leaves the ray as it was, as intersectSphere(),
# intersectBox() and intersectTriangle() do. Three planes give three places.
# What happens: ogl 1.0.11 of npm makes the ray's own origin the answer. For a ray from (0, 10, 0) downwards and the ground at height 1 it is
# (0, 1, 0), the origin is the same object, and the direction is (0, -9, 0). A ball at height 5, which is 4 away before the call, is missed after it.
# A ball at height -5 is hit at 0.33 for 5, since the next function takes the direction to be 1 long. Planes at heights 8, 6 and 4 give the
# place at height 4 three times. An origin and a direction that are passed as arguments are changed as well. Only a plane that is not hit leaves
# the ray alone.
# Why a user of a ray tracer meets it: the ground is a plane, and things on it are tried with the same ray, for a click or for a shadow.
#
# Needs npm, node 18 or later and the network. npm: ogl 1.0.11. About ten seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" ogl@1.0.11 >log

cat >ray.mjs <<'JAVASCRIPT'
import { Raycast, Vec3 } from 'ogl';

const text = vector => [...vector].map(value => +value.toFixed(3) + 0).join(' ');
const plane = height => ({ origin: new Vec3(0, height, 0), normal: new Vec3(0, 1, 0) });
const ball = height => ({ center: new Vec3(0, height, 0), radius: 1 });
function rayFrom(x) {
  const ray = new Raycast();
  ray.origin.set(x, 10, 0);
  ray.direction.set(0, -1, 0);
  return ray;
}
const state = ray => `origin ${text(ray.origin)}, direction ${text(ray.direction)}`;

const ray = rayFrom(0);
console.log(state(ray));
const box = { min: new Vec3(-1, 4, -1), max: new Vec3(1, 6, 1) };
const corners = [[-9, 5, -9], [0, 5, 9], [9, 5, -9]].map(corner => new Vec3(...corner));
console.log([ray.intersectSphere(ball(5)), ray.intersectSphere(ball(-5)), ray.intersectBox(box), ray.intersectTriangle(...corners)].join(' '));
console.log(state(ray));
ray.intersectPlane({ origin: new Vec3(0, 20, 0), normal: new Vec3(0, 1, 0) });
console.log(state(ray));

const hit = ray.intersectPlane(plane(1));
console.log(`${text(hit)}, the same object as the origin: ${hit === ray.origin}`);
console.log(state(ray));
console.log([ray.intersectSphere(ball(5)), ray.intersectBox(box), ray.intersectTriangle(...corners)].join(' '));
console.log(ray.intersectSphere(ball(-5)).toFixed(2));

const other = rayFrom(3);
console.log([8, 6, 4].map(height => other.intersectPlane(plane(height))).map(text).join(', '));
console.log([8, 6, 4].map(height => text(rayFrom(3).intersectPlane(plane(height)))).join(', '));

const origin = new Vec3(0, 10, 0), direction = new Vec3(0, -1, 0);
new Raycast().intersectPlane(plane(1), origin, direction);
console.log(`${text(origin)}, ${text(direction)}`);
JAVASCRIPT
node ray.mjs 2>log >out

guess "the ray is from 0 10 0 along 0 -1 0 all the time; distances 4 and 14 of the balls before and after; three places for three planes"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "ray" "origin 0 10 0, direction 0 -1 0"
expect "ball at 5, ball at -5, box and triangle at 5" "4 14 4 5"
expect "ray after these" "origin 0 10 0, direction 0 -1 0"
expect "ray after a plane behind it" "origin 0 10 0, direction 0 -1 0"
expect "plane at 1" "0 1 0, the same object as the origin: true"
expect "ray after the plane" "origin 0 1 0, direction 0 -9 0"
expect "ball, box and triangle at 5 after the plane" "0 0 0"
expect "ball at -5 after the plane, 5 away" "0.33"
expect "planes at 8, 6 and 4, one ray" "3 4 0, 3 4 0, 3 4 0"
expect "planes at 8, 6 and 4, a new ray for each" "3 8 0, 3 6 0, 3 4 0"
expect "origin and direction given as arguments" "0 1 0, 0 -9 0"
finish
