#!/usr/bin/env bash
# A slice of 20 degrees that begins at 350 degrees comes out as the other 340 degrees of the ring in JSCAD.
#
# One would guess: extrudeRotate({ startAngle, angle }) turns the shape by "angle" from "startAngle" on, both in radians: 20 degrees from 350 on
# are the slice from -10 to 10 degrees.
# What happens: @jscad/modeling 2.13.0 of npm makes 10 degrees of the end of 370, exchanges start and end since the end is smaller, and
# turns the shape from 10 to 350 degrees. The volume is 17 times too large, and the slice is the part that is missing. 180 degrees
# from 270 on are the wrong half, of the right volume. From -10 or from 340 on, 20 degrees are right, and so are they from 370 on. extrudeHelical() of
# the same library gives the right slice from 350 on, as does a slice from 0 on that is turned afterwards.
# Why a user of a ray tracer meets it: rings are made of sectors by loops over the start: segments of a dial, spokes, stairs, a cut in a bowl.
# One of them, across the x axis, is nearly the whole ring.
#
# Needs npm, node 18 or later and the network. npm: @jscad/modeling 2.13.0. About ten seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" @jscad/modeling@2.13.0 >log

cat >sector.cjs <<'JAVASCRIPT'
const { extrusions, measurements, primitives, transforms } = require('@jscad/modeling');

// A square of 1 * 1 at a distance of 3 from the axis. A full turn has a volume of nearly 6 pi.
const square = primitives.rectangle({ size: [1, 1], center: [3, 0] });
const radians = degrees => degrees * Math.PI / 180;
const turned = (start, angle) => extrusions.extrudeRotate({ segments: 360, startAngle: radians(start), angle: radians(angle) }, square);

// How many degrees of the ring there are, by volume, and the centre of mass.
function describe(solid) {
  const degrees = measurements.measureVolume(solid) / (6 * Math.PI) * 360;
  const [x, y] = measurements.measureCenterOfMass(solid);
  return `${Math.round(degrees)} degrees about ${[x, y].map(value => +value.toFixed(1) + 0).join(' ')}`;
}
for (const [start, angle] of [[0, 20], [-10, 20], [340, 20], [370, 20], [350, 20], [300, 90], [270, 180]])
  console.log(describe(turned(start, angle)));
const options = { segmentsPerRotation: 360, startAngle: radians(350), angle: radians(20), pitch: 0.001 };
console.log(describe(extrusions.extrudeHelical(options, square)));
console.log(describe(transforms.rotateZ(radians(350), turned(0, 20))));
// A ring of 18 sectors that begin at 10, 30, 50 ... 350 degrees: the sum of their volumes, in full turns.
const sectors = Array.from({ length: 18 }, (_, i) => measurements.measureVolume(turned(10 + 20 * i, 20)) / (6 * Math.PI));
console.log(sectors.reduce((sum, part) => sum + part).toFixed(2));
JAVASCRIPT
node sector.cjs 2>log >out

guess "20 degrees about 3 0 from 350 on; 90 degrees about 2.6 -0.7 from 300 on; 180 degrees about 1.9 0 from 270 on; 18 sectors are 1 turn"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "20 degrees from 0 on" "20 degrees about 3 0.5"
expect "20 degrees from -10 on" "20 degrees about 3 0"
expect "20 degrees from 340 on" "20 degrees about 3 -0.5"
expect "20 degrees from 370 on" "20 degrees about 2.8 1"
expect "20 degrees from 350 on" "340 degrees about -0.2 0"
expect "90 degrees from 300 on" "270 degrees about -0.9 0.2"
expect "180 degrees from 270 on" "180 degrees about -1.9 0"
expect "20 degrees from 350 on by extrudeHelical" "20 degrees about 3 0"
expect "20 degrees from 0 on, turned by 350" "20 degrees about 3 0"
expect "18 sectors, in turns" "1.89"
finish
