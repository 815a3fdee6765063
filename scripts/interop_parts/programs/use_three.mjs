// three.js: exporters and loaders in node, without pictures, for which it needs a browser.
import * as THREE from 'three';
import { OBJExporter } from 'three/examples/jsm/exporters/OBJExporter.js';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import { STLExporter } from 'three/examples/jsm/exporters/STLExporter.js';
import { GLTFExporter } from 'three/examples/jsm/exporters/GLTFExporter.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { asArrayBuffer, attempt, house, part, read, told, write } from './house_json.mjs';

globalThis.FileReader = class {  // what GLTFExporter needs of a browser
  readAsArrayBuffer(blob) { blob.arrayBuffer().then((b) => { this.result = b; this.onloadend(); }); }
  readAsDataURL(blob) { blob.arrayBuffer().then((b) => { this.result = `data:${blob.type};base64,` + Buffer.from(b).toString('base64'); this.onloadend(); }); }
};
globalThis.self ??= globalThis;

const group = new THREE.Group();
house.materials.forEach((m, i) => {
  const p = part(i), geometry = new THREE.BufferGeometry();
  geometry.setIndex(p.index);
  for (const [name, key, size] of [['position', 'position', 3], ['normal', 'normal', 3], ['uv', 'uv', 2], ['color', 'color', 3]])
    geometry.setAttribute(name, new THREE.Float32BufferAttribute(p[key], size));
  const material = new THREE.MeshStandardMaterial({ name: m.name, color: new THREE.Color(...m.color), vertexColors: true, metalness: 0 });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.name = m.name;
  group.add(mesh);
});
await attempt('obj', () => write('house.obj', new OBJExporter().parse(group)));
await attempt('ply', () => write('house.ply', new PLYExporter().parse(group, null, { binary: true })));
await attempt('ply', () => write('text.ply', new PLYExporter().parse(group, null, {})));
await attempt('stl', () => write('house.stl', new STLExporter().parse(group, { binary: true })));
await attempt('stl', () => write('text.stl', new STLExporter().parse(group)));
group.traverse((o) => {  // as pictures for glTF begin above; the exporter turns others around, but needs a browser for that
  if (!o.isMesh) return;
  const uv = o.geometry.getAttribute('uv');
  for (let i = 0; i < uv.count; ++i) uv.setY(i, 1 - uv.getY(i));
});
await attempt('glb', async () => write('house.glb', await new GLTFExporter().parseAsync(group, { binary: true })));
await attempt('gltf', async () => write('house.gltf', JSON.stringify(await new GLTFExporter().parseAsync(group, {}))));

function tell(form, object) {
  const meshes = [];
  object.updateMatrixWorld(true);
  object.traverse((o) => {
    if (!o.isMesh) return;
    const geometry = o.geometry.clone().applyMatrix4(o.matrixWorld), get = (n) => {
      const a = geometry.getAttribute(n);
      return a && Array.from({ length: a.count * a.itemSize }, (_, i) => a.getComponent(Math.floor(i / a.itemSize), i % a.itemSize));
    };
    const m = o.material;
    const uv = get('uv');
    if (uv && form === 'glb') for (let i = 1; i < uv.length; i += 2) uv[i] = 1 - uv[i];
    meshes.push({ position: get('position'), normal: get('normal'), uv, color: get('color'), index: geometry.index && Array.from(geometry.index.array),
      material: form === 'glb' ? [m.name, m.color.toArray(), !!m.map] : undefined });
  });
  told(form, meshes);
}
const one = (geometry) => new THREE.Mesh(geometry);
await attempt('read obj', () => tell('obj', new OBJLoader().parse(read('house.obj').toString())));
await attempt('read ply', () => tell('ply', one(new PLYLoader().parse(asArrayBuffer(read('house.ply'))))));
await attempt('read stl', () => tell('stl', one(new STLLoader().parse(asArrayBuffer(read('house.stl'))))));
await attempt('read glb', async () => tell('glb', (await new GLTFLoader().parseAsync(asArrayBuffer(read('house.glb')), '')).scene));
