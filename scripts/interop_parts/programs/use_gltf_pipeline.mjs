// gltf-pipeline.
import pipeline from 'gltf-pipeline';
import fs from 'node:fs';
import { HOUSE, attempt, read, write } from './house_json.mjs';

await attempt('gltf', async () => write('house.gltf', JSON.stringify((await pipeline.glbToGltf(fs.readFileSync(HOUSE + 'house.glb'))).gltf)));
await attempt('glb', async () => write('house.glb', (await pipeline.processGlb(fs.readFileSync(HOUSE + 'house.glb'), {})).glb));
await attempt('read', async () => write('read_glb.gltf', JSON.stringify((await pipeline.glbToGltf(read('house.glb'))).gltf)));
