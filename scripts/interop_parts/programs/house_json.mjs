// What scripts for node share: the house as arrays, and how they say what they have read.
import fs from 'node:fs';

export const OUT = process.env.OUT + '/', BACK = process.env.BACK + '/', HOUSE = process.env.HOUSE + '/';
export const house = JSON.parse(fs.readFileSync(HOUSE + 'house.json'));
export const image = fs.readFileSync(HOUSE + 'corners.png');

export async function attempt(what, call) {
  try { await call(); } catch (error) { console.log('FAILED', what, error); }
}

export const write = (name, data) => fs.writeFileSync(
  OUT + name, typeof data === 'string' ? data : Buffer.from(data.buffer ?? data, data.byteOffset ?? 0, data.byteLength));
export const read = (name) => fs.readFileSync(BACK + name);
export const asArrayBuffer = (b) => b.buffer.slice(b.byteOffset, b.byteOffset + b.byteLength);

/** The corners of the faces of one material: flat arrays, and indices of triangles. */
export function part(material) {
  const at = new Map(), p = { position: [], normal: [], uv: [], color: [], srgb: [], index: [] };
  house.triangles.forEach((triangle, i) => {
    if (material !== null && house.triangle_materials[i] !== material) return;
    for (const v of triangle) {
      if (!at.has(v)) {
        at.set(v, at.size);
        p.position.push(...house.corner_positions[v]);
        p.normal.push(...house.corner_normals[v]);
        p.uv.push(...house.corner_uvs[v]);
        p.color.push(...house.corner_colors[v]);
        p.srgb.push(...house.corner_srgb_colors[v]);
      }
      p.index.push(at.get(v));
    }
  });
  return p;
}

/** Notes what was read: meshes with flat arrays position, normal, uv, color, index, and material [name, color, has texture]. */
export function told(form, meshes) {
  const data = { vertices: 0, polygons: [], slots: [], materials: [] };
  for (const m of meshes) {
    const index = m.index ?? [...Array(m.position.length / 3).keys()];
    const get = (a, n, v) => a ? Array.from(a.slice(n * v, n * v + Math.min(n, 3))) : null;
    const colors = m.color ? m.color.length / (m.position.length / 3) : 3;
    for (let i = 0; i + 2 < index.length; i += 3)
      data.polygons.push(index.slice(i, i + 3).map((v) => [get(m.position, 3, v), get(m.normal, 3, v), get(m.uv, 2, v), get(m.color, colors, v)]));
    for (let i = 0; i + 2 < index.length; i += 3) data.slots.push(m.material ? data.materials.length : -1);
    if (m.material) data.materials.push(m.material);
    data.vertices += m.position.length / 3;
  }
  fs.writeFileSync(OUT + `read_${form}.json`, JSON.stringify(data));
}
