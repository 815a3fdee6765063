// glTF-Transform: the house plain, and as integers (KHR_mesh_quantization).
import { Document, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { quantize, weld } from '@gltf-transform/functions';
import { BACK, OUT, attempt, house, image, part, told } from './house_json.mjs';

function build() {
  const document = new Document(), buffer = document.createBuffer(), mesh = document.createMesh('house');
  const texture = document.createTexture('corners').setImage(image).setMimeType('image/png').setURI('corners2.png');
  house.materials.forEach((m, i) => {
    const p = part(i), make = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
    const uv = p.uv.map((x, k) => k % 2 ? 1 - x : x);
    const material = document.createMaterial(m.name).setBaseColorFactor([...m.color, 1]).setMetallicFactor(0);
    if (m.texture) material.setBaseColorTexture(texture);
    mesh.addPrimitive(document.createPrimitive().setMaterial(material)
      .setIndices(make('SCALAR', new Uint16Array(p.index))).setAttribute('POSITION', make('VEC3', new Float32Array(p.position)))
      .setAttribute('NORMAL', make('VEC3', new Float32Array(p.normal))).setAttribute('TEXCOORD_0', make('VEC2', new Float32Array(uv)))
      .setAttribute('COLOR_0', make('VEC3', new Float32Array(p.color))));
  });
  document.createScene().addChild(document.createNode('house').setMesh(mesh));
  return document;
}
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
await attempt('glb', async () => io.write(OUT + 'house.glb', build()));
await attempt('gltf', async () => io.write(OUT + 'house.gltf', build()));
await attempt('integers', async () => {
  const document = build();
  await document.transform(weld(), quantize({ quantizePosition: 16, quantizeNormal: 10, quantizeTexcoord: 14, quantizeColor: 12 }));
  await io.write(OUT + 'integers.glb', document);
});
await attempt('separate', async () => new NodeIO().setVertexLayout('separate').write(OUT + 'separate.glb', build()));
await attempt('read', async () => {
  const document = await io.read(BACK + 'house.glb'), meshes = [];
  for (const mesh of document.getRoot().listMeshes()) for (const p of mesh.listPrimitives()) {
    const get = (n) => {
      const a = p.getAttribute(n);
      return a && Array.from({ length: a.getCount() }, (_, i) => a.getElement(i, [])).flat();
    };
    const uv = get('TEXCOORD_0')?.map((x, k) => k % 2 ? 1 - x : x), m = p.getMaterial();
    const index = p.getIndices() && Array.from(p.getIndices().getArray());
    meshes.push({ position: get('POSITION'), normal: get('NORMAL'), uv, color: get('COLOR_0'), index,
      material: m && [m.getName(), m.getBaseColorFactor().slice(0, 3), !!m.getBaseColorTexture()] });
  }
  told('glb', meshes);
});
