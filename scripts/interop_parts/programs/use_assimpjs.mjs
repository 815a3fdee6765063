// assimpjs.
import assimpjs from 'assimpjs';
import fs from 'node:fs';
import { BACK, HOUSE, attempt, write } from './house_json.mjs';

const assimp = await assimpjs();
function convert(folder, names, to, target) {
  const files = new assimp.FileList();
  for (const name of names) files.AddFile(name, new Uint8Array(fs.readFileSync(folder + name)));
  const result = assimp.ConvertFileList(files, to);
  if (!result.IsSuccess()) throw new Error(result.GetErrorCode());
  write(target, result.GetFile(0).GetContent());
}
for (const [from, names] of [['obj', ['house.obj', 'house.mtl', 'corners.png']], ['ply', ['house.ply']], ['glb', ['house.glb']]])
  await attempt(from, () => convert(HOUSE, names, 'glb2', `from_${from}.glb`));
for (const [from, names] of [['obj', ['house.obj', 'house.mtl']], ['ply', ['house.ply']], ['stl', ['house.stl']], ['glb', ['house.glb']]])
  await attempt('read ' + from, () => convert(BACK, names, 'glb2', `read_${from}.glb`));
