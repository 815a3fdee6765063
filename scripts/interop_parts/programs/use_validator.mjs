// The official validator of glTF: what it has to say of Oktett's file stands in the log, and what is valid counts as read.
import fs from 'node:fs';
import validator from 'gltf-validator';
import { BACK, OUT, read } from './house_json.mjs';

const report = await validator.validateBytes(new Uint8Array(read('house.glb')));
for (const m of report.issues.messages) console.log('FAILED', m.code, m.message, m.pointer);
if (report.issues.numErrors + report.issues.numWarnings === 0) fs.copyFileSync(BACK + 'house.glb', OUT + 'read_glb.glb');
