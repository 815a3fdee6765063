#!/usr/bin/env bash
# ezdxf takes the normals of an OBJ file for vertices.
#
# One would guess: a line `vn` is a normal, and a loader that has no use for it skips it.
# What happens: ezdxf 0.18.1 (Debian 12) and 1.4.1 (Debian 13) take every line that begins with v for a vertex. Where normals stand
# between the vertices, as Open3D and MeshLab write them, or before those of a second object, the faces get normals for corners, without an
# error. `vt` with two numbers stops it with "OBJ vertex parsing error".
# Why a user of a ray tracer meets it: meshes go to drawings and back by way of OBJ.
#
# Needs Debian 12 and its network. Debian 12: python3-ezdxf 0.18.1-1. Debian 13: python3-ezdxf 1.4.1-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >triangle.obj <<'OBJ'
vn 0 0 1
v 10 0 0
vn 0 0 1
v 20 0 0
vn 0 0 1
v 10 20 0
f 1//1 2//2 3//3
OBJ
cat >corners.py <<'PYTHON'
from ezdxf.addons import meshex

mesh = meshex.obj_readfile("triangle.obj")[0]
print(" ".join("(%g, %g, %g)" % tuple(mesh.vertices[i]) for i in mesh.faces[0]))
PYTHON
unpack bookworm amd64 python3-ezdxf=0.18.1-1
python corners.py >old
unpack trixie amd64 python3-ezdxf=1.4.1-1
PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" corners.py >new

guess "(10, 0, 0) (20, 0, 0) (10, 20, 0)"
seen "corners by ezdxf 0.18.1" "(0, 0, 1) (10, 0, 0) (0, 0, 1)" "$(cat old)"
seen "corners by ezdxf 1.4.1" "(0, 0, 1) (10, 0, 0) (0, 0, 1)" "$(cat new)"
finish
