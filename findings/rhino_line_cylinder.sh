#!/usr/bin/env bash
# A line far above a cylinder meets it in Rhino's library, at two places that are not on the line.
#
# One would guess: Intersection.lineCylinder() of a cylinder of height 2 answers "None" for a line 8 above its top, as it does for one beside
# it, and for a line through the top and the side the two places there.
# What happens: rhino3dm 8.35.0 answers "Multiple" for every line that meets the cylinder without ends, and moves places beyond an end along the
# axis onto its rim: the line at z = 10 meets the cylinder at z = 2. Of a line that enters the top at (0.75, 0, 2) and leaves the side at
# (1, 0, 1), the first place is (-1, 0, 2). Along the axis it answers "Single" and a place at the middle of the bottom. Lines that meet the side
# twice are right, and so is "None" beside it, with the nearest places.
# Why a user of a ray tracer meets it: pipes, pins and columns of Rhino models are picked and measured with it. A hit must be looked
# up on the line before it is believed.
#
# Needs npm, node 18 or later and the network. npm: rhino3dm 8.35.0. About a quarter of a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" rhino3dm@8.35.0 >log

cat >cylinder.mjs <<'JAVASCRIPT'
import rhino3dm from 'rhino3dm';

const rhino = await rhino3dm();
const kinds = rhino.LineCylinderIntersection;
// The cylinder of radius 1 about the z axis, from z = 0 to 2.
const cylinder = new rhino.Cylinder(new rhino.Circle([0, 0, 0], 1), 2);
const lines = [
  [[5, 0.6, 1], [-5, 0.6, 1]],
  [[5, 3, 1], [-5, 3, 1]],
  [[5, 0.6, 10], [-5, 0.6, 10]],
  [[0, 0.6, 5], [5, 0.6, -5]],
  [[0, 0, 5], [1.5, 0, -1]],
  [[0, 0, 5], [0, 0, -5]],
];
for (const [from, to] of lines) {
  const [kind, ...places] = rhino.Intersection.lineCylinder(new rhino.Line(from, to), cylinder);
  const name = Object.keys(kinds).find(key => kinds[key] === kind);
  console.log(`${name}, ${places.map(place => place.map(value => +value.toFixed(3) + 0).join(' ')).join(' and ')}`);
}
JAVASCRIPT
node cylinder.mjs 2>log >out

guess "Multiple with two places of the line on the cylinder, None where it passes by"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "across at half of the height" "Multiple, 0.8 0.6 1 and -0.8 0.6 1"
expect "3 beside the axis" "None, 0 3 1 and 0 1 1"
expect "across at z = 10, 8 above the top" "Multiple, 0.8 0.6 2 and -0.8 0.6 2"
expect "slanted, past the rim" "Multiple, -0.8 0.6 2 and 0.8 0.6 2"
expect "through the top at 0.75 0 2 and the side at 1 0 1" "Multiple, -1 0 2 and 1 0 1"
expect "along the axis" "Single, 0 0 0 and 0 0 0"
finish
