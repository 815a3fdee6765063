#!/usr/bin/env bash
# An OBJ file with colours is a mesh in six dimensions for meshio.
#
# One would guess: the three numbers behind a position are the vertex's colour, as MeshLab, Blender and ZBrush write it, or are skipped.
# What happens: meshio (of Debian 12 and 13) has points of six coordinates. Copied to OBJ the file looks as it did; lengths and
# areas that are computed from the points mix metres and colours.
# Why a user of a ray tracer meets it: coloured scans are OBJ files of that kind.
#
# Needs Debian 12 and its network. Debian 12: python3-meshio 7.0.0-3. Debian 13: python3-meshio 7.0.0-really-5.3.5-6+deb13u1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

printf '%s\n' 'v 0 0 0 1 0 0' 'v 1 0 0 0 1 0' 'v 0 1 0 0 0 1' 'f 1 2 3' >triangle.obj
cat >points.py <<'PYTHON'
import meshio
import numpy as np

mesh = meshio.read("triangle.obj")
print("%d coordinates, %.2f apart" % (mesh.points.shape[1], np.linalg.norm(mesh.points[0] - mesh.points[1])))
PYTHON
unpack bookworm amd64 python3-meshio=7.0.0-3
python points.py >old 2>log
unpack trixie amd64 python3-meshio=7.0.0-really-5.3.5-6+deb13u1
PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" points.py >new 2>log

guess "3 coordinates, 1.00 apart"
seen "points of Debian 12" "6 coordinates, 1.73 apart" "$(cat old)"
seen "points of Debian 13" "6 coordinates, 1.73 apart" "$(cat new)"
finish
