#!/usr/bin/env bash
# A coloured scan becomes pale when it is converted to glTF.
#
# One would guess: PLY shows its bytes as they stand, so 128 is a middle grey; COLOR_0 of glTF is linear, so a converter writes
# 0.216, and both show the same.
# What happens: Assimp 5.2.5, Open3D 0.16.1 (Debian 12) and trimesh 4.5.1 (Debian 13) write 0.502, which a viewer that keeps to glTF shows as 188.
# None of them has a switch for it.
# Why a user of a ray tracer meets it: pictures of one scan in two formats differ, though no program warned.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1, python3-open3d 0.16.1+ds-2+b4. Debian 13: python3-trimesh 4.5.1-3.
# About two minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' 'property uchar red' \
  'property uchar green' 'property uchar blue' 'element face 1' 'property list uchar int vertex_indices' end_header \
  '0 0 0 128 128 128' '1 0 0 128 128 128' '0 1 0 128 128 128' '3 0 1 2' >grey.ply
cat >red_of_glb.py <<'PYTHON'
import base64
import json
import struct
import sys

data = open(sys.argv[1], "rb").read()
size = struct.unpack_from("<I", data, 12)[0]
head = json.loads(data[20 : 20 + size])
accessor = head["accessors"][head["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
view = head["bufferViews"][accessor["bufferView"]]
form, scale = {5126: ("<f", 1), 5121: ("<B", 255), 5123: ("<H", 65535)}[accessor["componentType"]]
buffer = head["buffers"][view["buffer"]]
data = base64.b64decode(buffer["uri"].split(",")[1]) if "uri" in buffer else data[28 + size :]
print("%.3f" % (struct.unpack_from(form, data, view.get("byteOffset", 0) + accessor.get("byteOffset", 0))[0] / scale))
PYTHON
unpack bookworm amd64 assimp-utils=5.2.5~ds0-1+b1 python3-open3d=0.16.1+ds-2+b4
run "$root/usr/bin/assimp" export grey.ply assimp.glb -fglb2 >/dev/null
python -c 'import open3d as o3d; o3d.io.write_triangle_mesh("open3d.glb", o3d.io.read_triangle_mesh("grey.ply"))' >log 2>&1
for program in assimp open3d; do python red_of_glb.py $program.glb >$program; done
unpack trixie amd64 python3-trimesh=4.5.1-3
PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" -c 'import trimesh; trimesh.load("grey.ply").export("trimesh.glb")'
PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" red_of_glb.py trimesh.glb >trimesh

guess "0.216, linear, by each"
for program in assimp open3d trimesh; do seen "COLOR_0 by $program" 0.502 "$(cat $program)"; done
finish
