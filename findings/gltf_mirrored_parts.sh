#!/usr/bin/env bash
# Mirrored parts of glTF scenes are inside out, and in one reader not mirrored and not moved at all.
#
# One would guess: a node with scale -1 along x mirrors a solid. By glTF 2.0 the sign of the determinant then decides which side of a
# triangle is in front, so that a program without nodes turns the triangles over, and the solid keeps its outside: its signed volume is 1/6.
# What happens: Assimp 5.2.5 (Debian 12) and 5.4.3 (Debian 13) write STL of volume -1/6, and so OBJ and PLY; VTK 9.1.0 reads -1/6. Normals
# that Assimp writes in OBJ point outwards. trimesh 4.5.1 (Debian 13) reads 1/6. read_triangle_mesh of Open3D 0.16.1 reads 1/6, since it leaves
# out the places of all nodes: of two solids 10 apart, one mesh in two nodes, it returns one, at the origin. read_triangle_model has both.
# Exporters of three.js 0.187.0 of npm for STL, OBJ and PLY write -1/6, too.
# Why a user of a ray tracer meets it: wheels, doors and hands are mirrored. Inside-out glass refracts wrongly, back faces are culled, and
# insides and outsides of combinations change places.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1, python3-open3d 0.16.1+ds-2+b4, python3-vtk9
# 9.1.0+really9.1.0+dfsg2-5+deb12u1. Debian 13: assimp-utils 5.4.3+ds-2, python3-trimesh 4.5.1-3. About five minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >write.py <<'PYTHON'
import json
import struct

corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
blob = b"".join(struct.pack("<3f", *corner) for corner in corners) + struct.pack("<12H", 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3)


def write(name, nodes):
    head = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": [dict(node, mesh=0) for node in nodes],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48, "target": 34962},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24, "target": 34963},
        ],
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    open(name, "wb").write(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


write("plain.glb", [{}])
write("mirrored.glb", [{"scale": [-1, 1, 1]}])
write("apart.glb", [{}, {"translation": [10, 0, 0]}])
PYTHON
cat >volume.py <<'PYTHON'
# The signed volume of triangles, and how far they reach along x.
def tell(triangles):
    volume = 0
    for a, b, c in triangles:
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
    xs = [corner[0] for triangle in triangles for corner in triangle]
    print("%.3f from %g to %g" % (volume, min(xs) + 0.0, max(xs) + 0.0))
PYTHON
cat >with_open3d.py <<'PYTHON'
import sys

import open3d as o3d

sys.path.insert(0, ".")
import volume

mesh = o3d.io.read_triangle_mesh(sys.argv[1])
volume.tell([[mesh.vertices[i] for i in triangle] for triangle in mesh.triangles])
PYTHON
cat >model_with_open3d.py <<'PYTHON'
import sys

import open3d as o3d

sys.path.insert(0, ".")
import volume

meshes = [part.mesh for part in o3d.io.read_triangle_model(sys.argv[1]).meshes]
volume.tell([[mesh.vertices[i] for i in triangle] for mesh in meshes for triangle in mesh.triangles])
PYTHON
cat >with_vtk.py <<'PYTHON'
import sys

import vtk

sys.path.insert(0, ".")
import volume

reader = vtk.vtkGLTFReader()
reader.SetFileName(sys.argv[1])
reader.Update()
part = reader.GetOutput().NewIterator().GetCurrentDataObject()
count = part.GetNumberOfCells()
volume.tell([[part.GetPoint(part.GetCell(i).GetPointId(k)) for k in range(3)] for i in range(count)])
PYTHON
cat >with_trimesh.py <<'PYTHON'
import sys

import trimesh

sys.path.insert(0, ".")
import volume

volume.tell(trimesh.load(sys.argv[1]).to_geometry().triangles.tolist())
PYTHON
# with_assimp FILE: what Assimp writes as STL, as text.
with_assimp() {
  run "$root/usr/bin/assimp" export "$1" out.stl -fstl >log
  awk '$1 == "vertex" {
      for (i = 0; i < 3; ++i) v[n % 3, i] = $(2 + i)
      if (n == 0 || $2 < low) low = $2
      if (n == 0 || $2 > high) high = $2
      if (++n % 3 == 0) {
        sum += v[0, 0] * (v[1, 1] * v[2, 2] - v[1, 2] * v[2, 1]) / 6
        sum += v[0, 1] * (v[1, 2] * v[2, 0] - v[1, 0] * v[2, 2]) / 6
        sum += v[0, 2] * (v[1, 0] * v[2, 1] - v[1, 1] * v[2, 0]) / 6
      }
    }
    END { printf "%.3f from %g to %g", sum, low, high }' out.stl
}

guess "0.167 from 0 to 1, mirrored 0.167 from -1 to 0, two 10 apart 0.333 from 0 to 11"
unpack bookworm amd64 python3-open3d=0.16.1+ds-2+b4 python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1 assimp-utils=5.2.5~ds0-1+b1
python write.py
seen "volume of the solid, Assimp 5.2.5" "0.167 from 0 to 1" "$(with_assimp plain.glb)"
seen "mirrored" "-0.167 from -1 to 0" "$(with_assimp mirrored.glb)"
seen "volume of the solid, VTK 9.1.0" "0.167 from 0 to 1" "$(python with_vtk.py plain.glb)"
seen "mirrored" "-0.167 from -1 to 0" "$(python with_vtk.py mirrored.glb)"
seen "volume of the solid, Open3D 0.16.1" "0.167 from 0 to 1" "$(python with_open3d.py plain.glb)"
seen "mirrored" "0.167 from 0 to 1" "$(python with_open3d.py mirrored.glb)"
seen "two of them 10 apart" "0.167 from 0 to 1" "$(python with_open3d.py apart.glb)"
seen "by read_triangle_model" "0.333 from 0 to 11" "$(python model_with_open3d.py apart.glb)"
unpack trixie amd64 assimp-utils=5.4.3+ds-2
seen "mirrored, Assimp 5.4.3" "-0.167 from -1 to 0" "$(with_assimp mirrored.glb)"
unpack trixie amd64 python3-trimesh=4.5.1-3
seen "mirrored, trimesh 4.5.1" "0.167 from -1 to 0" "$(PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" with_trimesh.py mirrored.glb)"
finish
