// obj2gltf.
import obj2gltf from 'obj2gltf';
import { BACK, HOUSE, attempt, write } from './house_json.mjs';

const glb = async (path) => obj2gltf(path, { binary: true });
await attempt('glb', async () => write('house.glb', await glb(HOUSE + 'house.obj')));
await attempt('gltf', async () => write('house.gltf', JSON.stringify(await obj2gltf(HOUSE + 'house.obj'))));
await attempt('read', async () => write('read_obj.glb', await glb(BACK + 'house.obj')));
