#!/usr/bin/env bash
# The normal of a point at the end of a long box is that of its sides in Yuka, and at the middle of the end it is zero.
#
# One would guess: getNormalFromSurfacePoint() of an AABB returns "the normal for a given point on this AABB's surface": (1, 0, 0) at (10, 0.5, 0.2),
# which is at the end of a beam from (-10, -1, -1) to (10, 1, 1).
# What happens: yuka 0.7.8 of npm returns (0, 1, 0) there, (0, 0, 1) at (10, 0.2, 0.5), and (0, 0, 0) at (10, 0, 0). It compares the distance of
# the point from the centre with the whole size of the box, not with half of it, so the shortest side of the box wins. All hits of rays at
# both ends of the beam have a wrong normal, at its four sides none; at a plate of 4 * 3 * 0.2 all four narrow sides are wrong. A cube is right,
# and so is a sphere. The places where the rays hit are right.
# Why a user of a ray tracer meets it: walls, floors, beams and steps are boxes. Their normal is wanted where a ray hit, for light,
# for reflections, or to stop a walker.
#
# Needs npm, node 18 or later and the network. npm: yuka 0.7.8. About ten seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" yuka@0.7.8 >log

cat >box.mjs <<'JAVASCRIPT'
import { AABB, BoundingSphere, Ray, Vector3 } from 'yuka';

const text = vector => [vector.x, vector.y, vector.z].map(value => +value.toFixed(3) + 0).join(' ');
const boxOf = half => new AABB(new Vector3(...half.map(value => -value)), new Vector3(...half));
const normalAt = (shape, place) => text(shape.getNormalFromSurfacePoint(new Vector3(...place), new Vector3()));

// 200 rays at right angles onto the two faces across each axis: hits that are off the face, and normals that are not the face's.
function count(half) {
  const box = boxOf(half);
  const result = [0, 1, 2].map(axis => {
    let wrongPlaces = 0, wrongNormals = 0;
    const others = [0, 1, 2].filter(i => i !== axis);
    for (const side of [-1, 1])
      for (let k = 0; k < 100; k++) {
        const place = [0, 0, 0], direction = [0, 0, 0];
        place[axis] = side * half[axis];
        place[others[0]] = half[others[0]] * (k % 10 - 4.5) / 5;
        place[others[1]] = half[others[1]] * (Math.floor(k / 10) - 4.5) / 5;
        direction[axis] = -side;
        const origin = place.map((value, i) => value - 3 * direction[i]);
        const hit = new Ray(new Vector3(...origin), new Vector3(...direction)).intersectAABB(box, new Vector3());
        if (hit.distanceTo(new Vector3(...place)) > 1e-9) wrongPlaces++;
        const normal = box.getNormalFromSurfacePoint(hit, new Vector3());
        if (normal.distanceTo(new Vector3(...direction.map(value => -value))) > 1e-9) wrongNormals++;
      }
    return [wrongPlaces, wrongNormals];
  });
  return `places ${result.map(pair => pair[0]).join(' ')}, normals ${result.map(pair => pair[1]).join(' ')}`;
}

const beam = boxOf([10, 1, 1]);
console.log([[10, 0.5, 0.2], [10, 0.2, 0.5], [10, 0, 0], [-10, -0.5, 0]].map(place => normalAt(beam, place)).join(', '));
console.log([[9, 1, 0], [0, -1, 0.5], [9, 0.5, 1]].map(place => normalAt(beam, place)).join(', '));
console.log([[1, 0.5, 0.2], [1, 0.2, 0.5], [1, 0, 0], [-1, -0.5, 0]].map(place => normalAt(boxOf([1, 1, 1]), place)).join(', '));
console.log(normalAt(new BoundingSphere(new Vector3(8, 0, 0), 2), [10, 0, 0]));
for (const half of [[1, 1, 1], [10, 1, 1], [2, 1, 1], [2, 1.5, 0.1]]) console.log(count(half));
JAVASCRIPT
node box.mjs 2>log >out

guess "1 0 0 at three places at one end of the beam, -1 0 0 at the other end; no wrong normals at any box"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "ends of the beam" "0 1 0, 0 0 1, 0 0 0, 0 -1 0"
expect "sides of the beam" "0 1 0, 0 -1 0, 0 0 1"
expect "cube" "1 0 0, 1 0 0, 1 0 0, -1 0 0"
expect "sphere" "1 0 0"
expect "cube, wrong of 200 across x, y and z" "places 0 0 0, normals 0 0 0"
expect "beam of 20 * 2 * 2" "places 0 0 0, normals 200 0 0"
expect "box of 4 * 2 * 2" "places 0 0 0, normals 200 0 0"
expect "plate of 4 * 3 * 0.2" "places 0 0 0, normals 200 200 0"
finish
