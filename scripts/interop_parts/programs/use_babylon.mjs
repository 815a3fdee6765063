// Babylon.js without a window.
import { NullEngine, Scene, Mesh, VertexData, StandardMaterial, PBRMaterial, Color3 } from '@babylonjs/core';
import { OBJExport } from '@babylonjs/serializers/OBJ/index.js';
import { STLExport } from '@babylonjs/serializers/stl/index.js';
import { GLTF2Export } from '@babylonjs/serializers/glTF/index.js';
import { attempt, house, part, write } from './house_json.mjs';

const engine = new NullEngine(), scene = new Scene(engine);  // left-handed, as they are by default
const mirrored = (values) => values.map((x, k) => k % 3 === 2 ? -x : x);
const meshes = house.materials.map((m, i) => {
  const p = part(i), mesh = new Mesh(m.name, scene), data = new VertexData();
  const colors = p.color.flatMap((x, k) => k % 3 === 2 ? [x, 1] : [x]);
  Object.assign(data, { positions: mirrored(p.position), normals: mirrored(p.normal), uvs: p.uv, indices: p.index, colors });
  data.applyToMesh(mesh);
  mesh.material = new PBRMaterial(m.name, scene);
  mesh.material.albedoColor = new Color3(...m.color);
  mesh.material.metallic = 0;
  mesh.material.roughness = 1;
  return mesh;
});
await attempt('glb', async () => {
  const files = (await GLTF2Export.GLBAsync(scene, 'house')).files;
  write('house.glb', new Uint8Array(await files['house.glb'].arrayBuffer()));
});
await attempt('stl', () => write('house.stl', STLExport.CreateSTL(meshes, false, 'house', true, true)));
await attempt('text', () => write('text.stl', STLExport.CreateSTL(meshes, false, 'house', false)));
for (const [i, m] of house.materials.entries()) {
  meshes[i].material = new StandardMaterial(m.name, scene);
  meshes[i].material.diffuseColor = new Color3(...m.color);
}
await attempt('obj', () => {
  write('house.obj', OBJExport.OBJ(meshes, true, 'house'));
  write('house.mtl', OBJExport.MTL(meshes[0]) + '\n' + OBJExport.MTL(meshes[1]));
});
