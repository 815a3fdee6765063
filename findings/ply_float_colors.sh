#!/usr/bin/env bash
# A colour of 0.5 in a PLY file is 0, 0.002, 0.5 or an error.
#
# One would guess: `property float red` holds parts of 1, as there is no other range for floats; at worst it is skipped.
# What happens: Open3D 0.16.1 divides by 255, as it does with bytes; VTK 9.1.0 converts 0.5 to a byte, which is 0; Assimp 5.2.5 and
# meshio take it as it is; Draco 1.5.5 refuses the file. None says a word but Draco. three.js and Blender, which are not run
# here, decode 0.5 by the sRGB curve.
# Why a user of a ray tracer meets it: colours in floats keep what bytes lose, but black or white scans are what others see. Bytes by the
# sRGB curve are the only colours that all of them read alike.
#
# Needs Debian 12 and its network. Debian 12: python3-open3d 0.16.1+ds-2+b4, python3-vtk9 9.1.0+really9.1.0+dfsg2-5+deb12u1, assimp-utils
# 5.2.5~ds0-1+b1, python3-meshio 7.0.0-3, draco 1.5.5+dfsg-2. About three minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 python3-open3d=0.16.1+ds-2+b4 python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1 assimp-utils=5.2.5~ds0-1+b1 \
  python3-meshio=7.0.0-3 draco=1.5.5+dfsg-2
cd "$work"

# triangle TYPE COLOUR: a triangle whose vertices are of this grey.
triangle() {
  printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' "property $1 red" \
    "property $1 green" "property $1 blue" 'element face 1' 'property list uchar int vertex_indices' end_header \
    "0 0 0 $2 $2 $2" "1 0 0 $2 $2 $2" "0 1 0 $2 $2 $2" '3 0 1 2' >$1.ply
}
triangle uchar 128
triangle float 0.5
cat >with_open3d.py <<'PYTHON'
import sys

import open3d as o3d

print("%.3f" % o3d.io.read_triangle_mesh(sys.argv[1]).vertex_colors[0][0])
PYTHON
cat >with_vtk.py <<'PYTHON'
import sys

import vtk

reader = vtk.vtkPLYReader()
reader.SetFileName(sys.argv[1])
reader.Update()
colors = reader.GetOutput().GetPointData().GetScalars()
print("%.3f" % (colors.GetTuple(0)[0] / 255))
PYTHON
cat >with_meshio.py <<'PYTHON'
import sys

import meshio

red = meshio.read(sys.argv[1]).point_data["red"]
print("%.3f" % (red[0] / (255 if red.dtype == "u1" else 1)))
PYTHON
cat >red_of_glb.py <<'PYTHON'
import json
import struct
import sys

data = open(sys.argv[1], "rb").read()
size = struct.unpack_from("<I", data, 12)[0]
head = json.loads(data[20 : 20 + size])
accessor = head["accessors"][head["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
view = head["bufferViews"][accessor["bufferView"]]
print("%.3f" % struct.unpack_from("<f", data, 28 + size + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)))
PYTHON
for kind in uchar float; do
  for program in open3d vtk meshio; do python with_$program.py $kind.ply >$program.$kind 2>log; done
  run "$root/usr/bin/assimp" export $kind.ply $kind.glb -fglb2 >/dev/null
  python red_of_glb.py $kind.glb >assimp.$kind
  run "$root/usr/bin/draco_encoder" -i $kind.ply -o $kind.drc >draco.$kind 2>&1 && echo encoded >draco.$kind
done

guess "0.502 of bytes and 0.500 of floats, by all"
for program in open3d vtk meshio assimp; do seen "bytes by $program" 0.502 "$(cat $program.uchar)"; done
seen "floats by open3d" 0.002 "$(cat open3d.float)"
seen "floats by vtk" 0.000 "$(cat vtk.float)"
seen "floats by meshio" 0.500 "$(cat meshio.float)"
seen "floats by assimp" 0.500 "$(cat assimp.float)"
seen "bytes by draco" encoded "$(cat draco.uchar)"
seen "floats by draco" "Failed loading the input mesh: Type of 'red' property must be uint8." "$(head -n 1 draco.float)"
finish
