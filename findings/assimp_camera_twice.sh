#!/usr/bin/env bash
# Cameras of glTF end up elsewhere in Assimp, mostly twice as far away.
#
# One would guess: a camera of a node that is moved by (3, 1, 5) stands at (3, 1, 5) after a conversion, as a mesh of such a node does.
# What happens: Assimp 5.2.5 (Debian 12) adds the place of the node to it once more. In pbrt the camera stands at (6, 2, 10), while a mesh of
# the same node stays. In Collada, where the second y is taken off, both the camera and the mesh are at (6, 0, 10), without the camera the mesh is
# at (3, 1, 5). There is no error.
# 5.4.3 (Debian 13) has camera and mesh in one place in both formats.
# Why a user of a ray tracer meets it: pbrt is the format of Assimp's that a renderer takes as it is. The picture shows the objects at half
# their size, or the camera stands behind a wall.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1. Debian 13: assimp-utils 5.4.3+ds-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >scene.gltf <<'GLTF'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"name": "tripod", "camera": 0, "mesh": 0, "translation": [3, 1, 5]}],
 "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1, "znear": 0.1, "zfar": 100}}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36, "target": 34962}],
 "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}
GLTF
# with_assimp SCENE FILE: converts a scene.
with_assimp() { run "$root/usr/bin/assimp" export "$1" "$2" >log 2>&1; }
# places: of the camera and of the mesh in pbrt.
places() { awk '$1 == "LookAt" { print $2, $3, $4 } $1 == "Transform" { print $15, $16, $17 }' "$1" | paste -sd,; }
# node: the last column of the matrix of the node in Collada.
node() { sed -nE 's,.*<matrix.*>(.*)</matrix>,\1,p' "$1" | awk '{ print $4, $8, $12 }'; }
sed 's/"camera": 0, //' scene.gltf >without.gltf

unpack bookworm amd64 assimp-utils=5.2.5~ds0-1+b1
guess "3 1 5 everywhere, in 5.4.3, which turns z up, -3 -5 1"
with_assimp scene.gltf scene.pbrt
seen "camera and mesh in pbrt, Assimp 5.2.5" "6 2 10,3 1 5" "$(places scene.pbrt)"
with_assimp scene.gltf scene.dae
seen "node of both in Collada" "6 0 10" "$(node scene.dae)"
with_assimp without.gltf without.dae
seen "node of the mesh alone in Collada" "3 1 5" "$(node without.dae)"
unpack trixie amd64 assimp-utils=5.4.3+ds-2
# This version writes scene.pbrtscene.pbrt.
rm scene.pbrt
with_assimp scene.gltf scene.pbrt
seen "camera and mesh in pbrt, Assimp 5.4.3" "-3 -5 1,-3 -5 1" "$(places scene.pbrt*)"
with_assimp scene.gltf scene.dae
seen "node of both in Collada" "3 1 5" "$(node scene.dae)"
finish
