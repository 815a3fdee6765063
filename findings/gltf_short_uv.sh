#!/usr/bin/env bash
# Textures of glTF files slip off when u and v are whole numbers.
#
# One would guess: u and v as bytes or shorts with `normalized`, which glTF 2.0 itself allows, without an extension, are the fractions of
# 255 or 65535 that the standard says.
# What happens: Assimp 5.2.5 (Debian 12) and 5.4.3 (Debian 13) take both shorts together for the bits of one float, and so does Open3D 0.16.1,
# which reads with Assimp: u is 9e-41 in place of 1, or -107059608 in place of 0.2, v is 0. trimesh 4.5.1 (Debian 13) says 65535 and 13107.
# VTK 9.1.0 reads them right. There is no error.
# Why a user of a ray tracer meets it: packers store u and v so, as half the bytes suffice. The geometry is right, and each wall shows
# one texel.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1, python3-open3d 0.16.1+ds-2+b4, python3-vtk9
# 9.1.0+really9.1.0+dfsg2-5+deb12u1. Debian 13: assimp-utils 5.4.3+ds-2, python3-trimesh 4.5.1-3. About five minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >write.py <<'PYTHON'
import json
import struct

corners = ((0, 0), (1, 0), (0.2, 0.8))


def write(name, kind, form, scale):
    positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    uv = b"".join(struct.pack(form, *(round(scale * c) if scale > 1 else c for c in corner)) for corner in corners)
    blob = positions + uv + struct.pack("<3H2x", 0, 1, 2)
    views = [(0, 36, 34962), (36, len(uv), 34962), (36 + len(uv), 6, 34963)]
    head = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": kind, "count": 3, "type": "VEC2", "normalized": scale > 1},
            {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size, "target": target} for at, size, target in views],
        "buffers": [{"byteLength": len(blob)}],
    }
    head["bufferViews"][1]["byteStride"] = len(uv) // 3
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    open(name, "wb").write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


write("floats.glb", 5126, "<2f", 1)
write("shorts.glb", 5123, "<2H", 65535)
write("bytes.glb", 5121, "<2B2x", 255)
PYTHON
cat >with_open3d.py <<'PYTHON'
import sys

import open3d as o3d

print(*("%.3g" % u for u, _ in o3d.io.read_triangle_mesh(sys.argv[1]).triangle_uvs))
PYTHON
cat >with_vtk.py <<'PYTHON'
import sys

import vtk

reader = vtk.vtkGLTFReader()
reader.SetFileName(sys.argv[1])
reader.Update()
uv = reader.GetOutput().NewIterator().GetCurrentDataObject().GetPointData().GetTCoords()
print(*("%.3g" % uv.GetTuple(i)[0] for i in range(3)))
PYTHON
cat >with_trimesh.py <<'PYTHON'
import sys

import trimesh

mesh = list(trimesh.load(sys.argv[1]).geometry.values())[0]
print(*("%.6g" % u for u, _ in mesh.visual.uv))
PYTHON
# with_assimp FILE: u of the three vertices.
with_assimp() {
  run "$root/usr/bin/assimp" export "$1" out.obj >log
  awk '$1 == "vt" { printf "%s%.3g", space, $2; space = " " }' out.obj
}

unpack bookworm amd64 python3-open3d=0.16.1+ds-2+b4 python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1 assimp-utils=5.2.5~ds0-1+b1
python write.py
guess "0 1 0.2 each time"
seen "u from floats, Assimp 5.2.5" "0 1 0.2" "$(with_assimp floats.glb)"
seen "u from shorts, Assimp 5.2.5" "0 9.18e-41 -1.07e+08" "$(with_assimp shorts.glb)"
seen "u from bytes, Assimp 5.2.5" "0 3.57e-43 7.33e-41" "$(with_assimp bytes.glb)"
seen "u from floats, Open3D 0.16.1" "0 1 0.2" "$(python with_open3d.py floats.glb)"
seen "u from shorts, Open3D 0.16.1" "0 9.18e-41 -1.07e+08" "$(python with_open3d.py shorts.glb)"
seen "u from bytes, Open3D 0.16.1" "0 3.57e-43 7.33e-41" "$(python with_open3d.py bytes.glb)"
for kind in floats shorts bytes; do seen "u from $kind, VTK 9.1.0" "0 1 0.2" "$(python with_vtk.py $kind.glb)"; done
unpack trixie amd64 assimp-utils=5.4.3+ds-2
seen "u from shorts, Assimp 5.4.3" "0 9.18e-41 -1.07e+08" "$(with_assimp shorts.glb)"
unpack trixie amd64 python3-trimesh=4.5.1-3
with_trimesh() { PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" with_trimesh.py "$1"; }
seen "u from floats, trimesh 4.5.1" "0 1 0.2" "$(with_trimesh floats.glb)"
seen "u from shorts, trimesh 4.5.1" "0 65535 13107" "$(with_trimesh shorts.glb)"
seen "u from bytes, trimesh 4.5.1" "0 255 51" "$(with_trimesh bytes.glb)"
finish
