#!/usr/bin/env bash
# Faces with five and more corners of a PLY file are left out by two readers, without a word.
#
# One would guess: a face is a list of any length in PLY, so a house with two gables of five corners is closed: 16 triangles, volume 5. A
# reader of triangles divides the gables, as it does in OBJ files, or says that it cannot.
# What happens: three.js 0.187.0 and loaders.gl 4.4.5 keep faces of three and four corners. The house has 10 triangles and no gables, in text
# and in binary files, and its volume by the sum over the triangles is 3.33. A dodecahedron, all of whose faces are pentagons, has no faces:
# three.js gives a geometry without an index, which means that each three vertices in the file are a triangle, here six with a volume of 0.46 for
# 14.47. Nothing is logged. The OBJ reader of three.js divides the gables, and vtk.js 37.4.3 reads all corners of the same PLY files.
# Why a user of a ray tracer meets it: Blender and programs for buildings write polygons. Light falls in where the gables were.
#
# Needs npm, node 20 or later and the network. npm: three 0.187.0, @loaders.gl/core and @loaders.gl/ply 4.4.5, @kitware/vtk.js 37.4.3. About
# half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" --prefix "$work" three@0.187.0 @loaders.gl/core@4.4.5 \
  @loaders.gl/ply@4.4.5 @kitware/vtk.js@37.4.3 >log

cat >read.mjs <<'JAVASCRIPT'
import { parseSync } from '@loaders.gl/core';
import { PLYLoader as LoadersPly } from '@loaders.gl/ply';
import vtkPLYReader from '@kitware/vtk.js/IO/Geometry/PLYReader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';

// A house: two gables, the floor, two walls and two roofs.
const house = {
  points: [[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 3, 0], [0, 2, 0], [0, 0, 1], [2, 0, 1], [2, 2, 1], [1, 3, 1], [0, 2, 1]],
  faces: [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], [0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 8, 7], [3, 4, 9, 8], [4, 0, 5, 9]],
};
// A dodecahedron: to each corner of an icosahedron belongs the pentagon of the corners next to it.
const g = (1 + Math.sqrt(5)) / 2;
const axes = [];
for (const a of [-1, 1]) for (const b of [-g, g]) axes.push([0, a, b], [a, b, 0], [b, 0, a]);
const points = [];
for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1]) points.push([x, y, z]);
for (const a of [-1 / g, 1 / g]) for (const b of [-g, g]) points.push([0, b, a], [b, a, 0], [a, 0, b]);
const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
const solid = { points, faces: axes.map(axis => {
  const most = Math.max(...points.map(point => dot(point, axis)));
  const corners = points.map((_, i) => i).filter(i => dot(points[i], axis) > most - 1e-9);
  const middle = [0, 1, 2].map(k => corners.reduce((sum, i) => sum + points[i][k], 0) / corners.length);
  const out = i => points[i].map((value, k) => value - middle[k]);
  const first = out(corners[0]);
  const second = cross(middle, first);
  const angle = i => Math.atan2(dot(out(i), second) / Math.sqrt(dot(middle, middle)), dot(out(i), first));
  return corners.sort((i, j) => angle(i) - angle(j));
}) };

function ply({ points, faces }, format) {
  const head = `ply\nformat ${format} 1.0\nelement vertex ${points.length}\nproperty float x\nproperty float y\nproperty float z\n`
    + `element face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n`;
  if (format === 'ascii') {
    return head + [...points, ...faces.map(face => [face.length, ...face])].map(row => row.join(' ')).join('\n') + '\n';
  }
  const numbers = points.length * 12 + faces.reduce((sum, face) => sum + 1 + 4 * face.length, 0);
  const data = new DataView(new ArrayBuffer(numbers));
  let at = 0;
  for (const value of points.flat()) data.setFloat32((at += 4) - 4, value, true);
  for (const face of faces) {
    data.setUint8(at++, face.length);
    for (const corner of face) data.setInt32((at += 4) - 4, corner, true);
  }
  return new Uint8Array([...new TextEncoder().encode(head), ...new Uint8Array(data.buffer)]).buffer;
}
// Triangles and volume; without an index each three points are a triangle.
function show(places, index) {
  const list = index?.length ? [...index] : index ? [] : [...Array(places.length / 3 - places.length / 3 % 3).keys()];
  const corner = i => [...places.slice(3 * list[i], 3 * list[i] + 3)];
  let volume = 0;
  for (let i = 0; i < list.length; i += 3) volume += dot(corner(i), cross(corner(i + 1), corner(i + 2))) / 6;
  console.log(`${list.length / 3} triangles, volume ${volume.toFixed(2)}`);
}
const byThree = data => {
  const geometry = new PLYLoader().parse(data);
  console.log(geometry.index ? 'an index' : 'no index');
  show(geometry.attributes.position.array, geometry.index?.array);
};
const byLoaders = data => {
  const mesh = parseSync(data, LoadersPly, { worker: false });
  show(mesh.attributes.POSITION.value, mesh.indices.value);
};
for (const format of ['ascii', 'binary_little_endian']) {
  byThree(ply(house, format));
  byLoaders(ply(house, format));
}
byThree(ply(solid, 'ascii'));
byLoaders(ply(solid, 'ascii'));
const obj = new OBJLoader().parse([...house.points.map(point => `v ${point.join(' ')}`),
  ...house.faces.map(face => `f ${face.map(i => i + 1).join(' ')}`)].join('\n') + '\n');
show(obj.children[0].geometry.attributes.position.array);
const reader = vtkPLYReader.newInstance();
reader.parseAsText(ply(house, 'ascii'));
const polygons = reader.getOutputData(0).getPolys().getData();
const sizes = [];
for (let i = 0; i < polygons.length; i += 1 + polygons[i]) sizes.push(polygons[i]);
console.log(sizes.join(' '));
// The volume by dividing the faces.
for (const { points, faces } of [house, solid]) {
  show(points.flat(), faces.flatMap(face => face.slice(2).flatMap((_, i) => [face[0], face[i + 1], face[i + 2]])));
}
JAVASCRIPT
node read.mjs 2>log >out

guess "16 triangles with a volume of 5, 36 with 14.47, or an error"
line=0
expect() {
  line=$((line + 1))
  seen "$1" "$2" "$(sed -n ${line}p out)"
}
for format in text binary; do
  expect "house, $format, three.js" "an index"
  expect "its geometry" "10 triangles, volume 3.33"
  expect "loaders.gl" "10 triangles, volume 3.33"
done
expect "dodecahedron, three.js" "no index"
expect "its geometry" "6 triangles, volume 0.46"
expect "loaders.gl" "0 triangles, volume 0.00"
expect "house as OBJ, three.js" "16 triangles, volume 5.00"
expect "house as PLY, vtk.js, corners of faces" "5 5 4 4 4 4 4"
expect "house, divided here" "16 triangles, volume 5.00"
expect "dodecahedron, divided here" "36 triangles, volume 14.47"
seen "words in the log of the readers" "0" "$(grep -ci 'polygon\|face\|corner' log)"
finish
