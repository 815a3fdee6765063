#!/usr/bin/env bash
# A ray from the Earth's surface leaves the Earth at its centre in Cesium, at a third of all places, and a box behind a ray is hit.
#
# One would guess: rayEllipsoid() gives the distances at which a ray enters and leaves, for a ray from the surface 0 and the whole chord.
# rayAxisAlignedBoundingBox() does so for a box, and gives undefined for a box behind the ray, as raySphere() and rayEllipsoid() do.
# What happens: in @cesium/engine 24.0.0 a ray that begins exactly on the ellipsoid leaves it after half the chord. Of rays to the Earth's centre
# from 612 places of height 0, every 10 degrees, 216 leave it at the centre and 396 on the other side; from one millimetre higher or lower all
# leave it there. It depends on the last bit. A box that lies behind the ray is hit at -6 and -4, and a ray along a face of a box leaves
# it at NaN.
# Why a user of a ray tracer meets it: a place on the ellipsoid is what fromDegrees() returns. Views through the ground, lengths of light
# in an atmosphere or in an ellipsoidal lens are halved there, and what lies behind a camera is picked.
#
# Needs npm, node 20 or later and the network. npm: @cesium/engine 24.0.0. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" @cesium/engine@24.0.0 >log

cat >ray.mjs <<'JAVASCRIPT'
import { AxisAlignedBoundingBox, BoundingSphere, Cartesian3, Ellipsoid, IntersectionTests, Ray } from '@cesium/engine';

const show = interval => console.log(interval ? `${+interval.start.toFixed(3)} to ${+interval.stop.toFixed(3)}` : `${interval}`);
const ray = (origin, direction) => new Ray(new Cartesian3(...origin), new Cartesian3(...direction));

// Rays from all over the Earth to its centre: how many leave it there, and how many on the other side.
for (const height of [0.001, 0, -0.001]) {
  let centre = 0;
  let opposite = 0;
  for (let latitude = -80; latitude <= 80; latitude += 10) {
    for (let longitude = -180; longitude < 180; longitude += 10) {
      const place = Cartesian3.fromDegrees(longitude, latitude, height);
      const radius = Cartesian3.magnitude(place);
      const down = Cartesian3.divideByScalar(place, -radius, new Cartesian3());
      const { stop } = IntersectionTests.rayEllipsoid(new Ray(place, down), Ellipsoid.WGS84);
      if (Math.abs(stop - radius) < 1) centre++;
      if (Math.abs(stop - 2 * radius) < 1) opposite++;
    }
  }
  console.log(`${centre} and ${opposite}`);
}
// A chord that is not through the middle, of the unit sphere: 1.6 long.
for (const origin of [[1.000001, 0, 0], [1, 0, 0], [0.999999, 0, 0]]) {
  show(IntersectionTests.rayEllipsoid(ray(origin, [-0.8, 0.6, 0]), Ellipsoid.UNIT_SPHERE));
}
const box = new AxisAlignedBoundingBox(new Cartesian3(-1, -1, -1), new Cartesian3(1, 1, 1));
show(IntersectionTests.rayAxisAlignedBoundingBox(ray([5, 0, 0], [-1, 0, 0]), box));
show(IntersectionTests.rayAxisAlignedBoundingBox(ray([5, 0, 0], [1, 0, 0]), box));
show(IntersectionTests.raySphere(ray([5, 0, 0], [1, 0, 0]), new BoundingSphere(Cartesian3.ZERO, 1)));
show(IntersectionTests.rayEllipsoid(ray([5, 0, 0], [1, 0, 0]), Ellipsoid.UNIT_SPHERE));
show(IntersectionTests.rayAxisAlignedBoundingBox(ray([5, 0.999, 0], [-1, 0, 0]), box));
show(IntersectionTests.rayAxisAlignedBoundingBox(ray([5, 1, 0], [-1, 0, 0]), box));
JAVASCRIPT
node ray.mjs 2>log >out

guess "none leave at the centre and 612 on the other side; 0 to 1.6 in the unit sphere; undefined behind; 4 to 6 along a face, or undefined"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "at the centre and on the other side, from 1 millimetre above the Earth" "0 and 612"
expect "from its surface" "216 and 396"
expect "from 1 millimetre below" "0 and 612"
expect "chord of 1.6, from 0.000001 outside" "0 to 1.6"
expect "from the sphere" "0 to 0.8"
expect "from 0.000001 inside" "0 to 1.6"
expect "box in front" "4 to 6"
expect "box behind" "-6 to -4"
expect "sphere behind" "undefined"
expect "ellipsoid behind" "undefined"
expect "along a face, 0.001 within" "4 to 6"
expect "along a face" "4 to NaN"
finish
