#!/usr/bin/env bash
# A ray that comes from 5000 radii away hits a ball of Rapier in its middle, or with a normal across the ray; a capsule is right.
#
# One would guess: numbers of 32 bits cost some digits of the distance, for a ball no more than for a capsule of the same radius, whose
# round side the same ray hits at the same place: 4999 through the middle, 4999.2 for a ray 0.6 beside it.
# What happens: Rapier 0.21.0 answers 5000 for the ball, twice: the middle with a normal that is not a number, and 0.6 beside it a point within
# the ball with a normal at a right angle to the ray. From 3000 away both rays hit at 2999, from 1000 away the second at 999.209 for 999.2. The
# capsule is right to 0.001 at all of these distances. (Squares of the distance to the middle are subtracted.)
# Why a user of a ray tracer meets it: a ball of 1 centimetre seen from 50 metres, a lamp or an atom in a large scene. It becomes a flat disc, and
# what is reflected in it is black or not a number.
#
# Needs npm, node 18 or later and the network. npm: @dimforge/rapier3d-compat 0.21.0. A quarter of a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" @dimforge/rapier3d-compat@0.21.0 >log

cat >ball.mjs <<'JAVASCRIPT'
import RAPIER from '@dimforge/rapier3d-compat';

await RAPIER.init();
// A ray from (distance, 0, beside) towards -x.
function cast(shape, distance, beside) {
  const world = new RAPIER.World({ x: 0, y: 0, z: 0 });
  world.createCollider(shape);
  world.step();
  const ray = new RAPIER.Ray({ x: distance, y: 0, z: beside }, { x: -1, y: 0, z: 0 });
  const hit = world.castRayAndGetNormal(ray, 1e6, true);
  if (!hit) return 'no hit';
  const normal = [hit.normal.x, hit.normal.y, hit.normal.z].map(value => value.toFixed(3));
  return `${hit.timeOfImpact.toFixed(3)}, normal ${normal.join(' ')}`;
}
for (const distance of [10, 1000, 3000, 5000]) {
  for (const beside of [0, 0.6]) {
    console.log(cast(RAPIER.ColliderDesc.ball(1), distance, beside));
    console.log(cast(RAPIER.ColliderDesc.capsule(0.5, 1), distance, beside));
  }
}
JAVASCRIPT
node ball.mjs 2>log >out

guess "the ball and the capsule are hit at the same place, with the same normal, but for the last digits"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "ball, from 10, through the middle" "9.000, normal 1.000 0.000 0.000"
expect "capsule" "9.000, normal 1.000 0.000 0.000"
expect "ball, from 10, 0.6 beside the middle" "9.200, normal 0.800 0.000 0.600"
expect "capsule" "9.200, normal 0.800 0.000 0.600"
expect "ball, from 1000, through the middle" "999.000, normal 1.000 0.000 0.000"
expect "capsule" "999.000, normal 1.000 0.000 0.000"
expect "ball, from 1000, 0.6 beside the middle" "999.209, normal 0.797 0.000 0.605"
expect "capsule" "999.200, normal 0.800 0.000 0.600"
expect "ball, from 3000, through the middle" "2999.000, normal 1.000 0.000 0.000"
expect "capsule" "2999.000, normal 1.000 0.000 0.000"
expect "ball, from 3000, 0.6 beside the middle" "2999.000, normal 0.857 0.000 0.514"
expect "capsule" "2999.200, normal 0.800 0.000 0.600"
expect "ball, from 5000, through the middle" "5000.000, normal NaN NaN NaN"
expect "capsule" "4999.000, normal 1.000 0.000 0.000"
expect "ball, from 5000, 0.6 beside the middle" "5000.000, normal 0.000 0.000 1.000"
expect "capsule" "4999.200, normal 0.800 0.000 0.600"
finish
