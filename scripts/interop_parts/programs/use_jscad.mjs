// JSCAD's modelling with its serializers.
import modeling from '@jscad/modeling';
import obj from '@jscad/obj-serializer';
import stl from '@jscad/stl-serializer';
import { attempt, house, write } from './house_json.mjs';

const { geom3, poly3 } = modeling.geometries;
const triangles = geom3.create(house.triangle_vertices.map((f) => poly3.create(f.map((v) => house.positions[v]))));
await attempt('obj', () => write('house.obj', obj.serialize({}, triangles).join('')));
await attempt('stl', () => write('text.stl', stl.serialize({ binary: false }, triangles).join('')));
await attempt('stl', () => write('house.stl', Buffer.concat(stl.serialize({ binary: true }, triangles).map((b) => Buffer.from(b)))));
