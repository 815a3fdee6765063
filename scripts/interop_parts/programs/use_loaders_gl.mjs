// loaders.gl, which reads only.
import { parse } from '@loaders.gl/core';
import { OBJLoader } from '@loaders.gl/obj';
import { PLYLoader } from '@loaders.gl/ply';
import { asArrayBuffer, attempt, read, told } from './house_json.mjs';

for (const [form, loader] of [['obj', OBJLoader], ['ply', PLYLoader]])
  await attempt('read ' + form, async () => {
    const mesh = await parse(asArrayBuffer(read('house.' + form)), loader, { worker: false }), a = mesh.attributes;
    const get = (n) => a[n] && Array.from(a[n].value, (x) => a[n].value instanceof Uint8Array ? x / 255 : x);
    const index = mesh.indices && Array.from(mesh.indices.value);
    told(form, [{ position: get('POSITION'), normal: get('NORMAL'), uv: get('TEXCOORD_0'), color: get('COLOR_0'), index }]);
  });
