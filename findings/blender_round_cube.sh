#!/usr/bin/env bash
# Blender's cube is round in PLY.
#
# One would guess: the default cube is shaded flat, so a file of it with normals has those of its faces, as its OBJ file has.
# What happens: Blender 3.4.1 (Debian 12) writes one normal for each vertex, the mean of its faces, along the diagonals, though shading is
# flat and though it writes vertices several times where uv differ. Normals are written by default. So do 4.3.2 (Debian 13) where normals
# are asked for, and both with normals that a user has set.
# Why a user of a ray tracer meets it: buildings and machines look like pillows in PLY, and not in OBJ.
#
# Needs Debian 12 and its network. Debian 12: blender 3.4.1+dfsg-2+b1. Debian 13: blender 4.3.2+dfsg-2. About four minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >cube.py <<'PYTHON'
import bpy

if bpy.app.version < (4, 0):
    bpy.ops.preferences.addon_enable(module="io_mesh_ply")
    bpy.ops.export_mesh.ply(filepath="cube.ply", use_ascii=True)
else:
    bpy.ops.wm.ply_export(filepath="cube.ply", ascii_format=True, export_normals=True)
bpy.ops.wm.obj_export(filepath="cube.obj")
PYTHON
# cube SUITE VERSION: the default cube's first normal in both formats, the signs taken off.
cube() {
  unpack "$1" amd64 blender="$2"
  rm -f cube.ply cube.obj
  local paths=$libraries:$root/usr/lib:$libraries/blas:$libraries/lapack:$libraries/pulseaudio
  HOME=$work PYTHONHOME=$root/usr BLENDER_SYSTEM_RESOURCES=$root/usr/share/blender BLENDER_SYSTEM_SCRIPTS=$root/usr/share/blender/scripts \
    BLENDER_SYSTEM_DATAFILES=$root/usr/share/blender/datafiles \
    "$root/lib64/ld-linux-x86-64.so.2" --library-path "$paths" "$root/usr/bin/blender" --background -noaudio --factory-startup --python-use-system-env \
    --python cube.py >log 2>&1
  seen "a normal in PLY" "0.577 0.577 0.577" "$(sed '1,/end_header/d' cube.ply | awk 'NR == 1 { printf "%.3f %.3f %.3f", $4, $5, $6 }' | tr -d -)"
  seen "a normal in OBJ" "0.000 1.000 0.000" "$(awk '$1 == "vn" { printf "%.3f %.3f %.3f", $2, $3, $4; exit }' cube.obj | tr -d -)"
}

guess "one coordinate of each is 1, the others are 0"
cube bookworm 3.4.1+dfsg-2+b1
cube trixie 4.3.2+dfsg-2
finish
