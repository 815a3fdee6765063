#!/usr/bin/env bash
# The gradient of vtk.js's sphere does not point outwards, and a cylinder with an axis longer than 1 is a hyperboloid.
#
# One would guess: evaluateGradient() of an implicit function is the gradient of evaluateFunction(), as in VTK: (6, 0, 0) at (3, 0, 0) for a
# sphere about the origin, whose function is x*x + y*y + z*z - r*r. A cylinder about the axis (1, 1, 0) is the one about (2, 2, 0), since an
# axis is a direction; VTK makes it 1 long.
# What happens: vtk.js 37.4.3 subtracts the place from 2, and says (-1, 2, 2). The gradient of a cone and of a cylinder about y is right.
# A cylinder's axis is used at the length it has: at (3, 3, 0) on the axis (1, 1, 0), where -4 is right for a radius of 2, the function is -22,
# and at (3, 3, 2) on the surface it is -18 for 0. About (0, 2, 0) it is -142 for 5 at a place outside: the radius grows with the distance.
# Why a user of a ray tracer meets it: the gradient is the normal of an implicit surface, and tells a solver the way to it.
#
# Needs npm, node 18 or later and the network. npm: @kitware/vtk.js 37.4.3. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" @kitware/vtk.js@37.4.3 >log

cat >gradient.mjs <<'JAVASCRIPT'
import vtkCone from '@kitware/vtk.js/Common/DataModel/Cone.js';
import vtkCylinder from '@kitware/vtk.js/Common/DataModel/Cylinder.js';
import vtkSphere from '@kitware/vtk.js/Common/DataModel/Sphere.js';

// The gradient by the library, and by differences of the function.
function gradients(shape, place) {
  const exact = shape.evaluateGradient(place);
  const step = 1e-4;
  const measured = [0, 1, 2].map(axis => {
    const at = sign => shape.evaluateFunction(place.map((value, i) => value + (i === axis ? sign * step : 0)));
    return (at(1) - at(-1)) / (2 * step);
  });
  const text = vector => vector.map(value => +value.toFixed(2) + 0).join(' ');
  return `${text([...exact])}, by differences ${text(measured)}`;
}
const sphere = vtkSphere.newInstance({ radius: 2 });
console.log(gradients(sphere, [3, 0, 0]));
console.log(gradients(sphere, [0, -1, 4]));
console.log(gradients(vtkCone.newInstance({ angle: 45 }), [3, 1, 0]));
console.log(gradients(vtkCylinder.newInstance({ radius: 2, axis: [0, 1, 0] }), [3, 7, 0]));
for (const axis of [[0, 1, 0], [0, 2, 0]]) console.log(vtkCylinder.newInstance({ radius: 2, axis }).evaluateFunction([3, 7, 0]).toFixed(2));
for (const axis of [[Math.SQRT1_2, Math.SQRT1_2, 0], [1, 1, 0]]) {
  const cylinder = vtkCylinder.newInstance({ radius: 2, axis });
  console.log([0, 2].map(z => Math.round(100 * cylinder.evaluateFunction([3, 3, z])) / 100 + 0).map(value => value.toFixed(2)).join(', '));
}
JAVASCRIPT
node gradient.mjs 2>log >out

guess "the gradient is the one by differences; the function of a cylinder does not depend on the length of its axis"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
expect "sphere, at 3 0 0" "-1 2 2, by differences 6 0 0"
expect "sphere, at 0 -1 4" "2 3 -2, by differences 0 -2 8"
expect "cone, at 3 1 0" "-6 2 0, by differences -6 2 0"
expect "cylinder about y, at 3 7 0" "6 0 0, by differences 6 0 0"
expect "its function, axis 0 1 0" "5.00"
expect "axis 0 2 0" "-142.00"
expect "on the axis and on the surface, axis 0.707 0.707 0" "-4.00, 0.00"
expect "axis 1 1 0" "-22.00, -18.00"
finish
