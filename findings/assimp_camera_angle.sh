#!/usr/bin/env bash
# Cameras of glTF get too wide an angle in Assimp, and a panorama one of more than half a turn.
#
# One would guess: glTF has the angle from bottom to top, Collada that from left to right; a converter goes by the tangents, so 1 with
# an aspect of 2.4 becomes 2 atan(2.4 tan 0.5) = 105.3 degrees.
# What happens: assimp 5.2.5 (Debian 12) multiplies the angle by the aspect and writes 137.5 degrees; 1.4 with 2.4 becomes 192.5, where no
# perspective is left. 5.4.3 (Debian 13) has 105.3 and 127.4. Where glTF has no aspect, which it allows, both write the vertical angle as
# the horizontal one, and the aspect 0. Neither writes cameras to glTF at all.
# Why a user of a ray tracer meets it: the picture of a converted scene shows more than that of the first program.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1. Debian 13: assimp-utils 5.4.3+ds-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >cameras.gltf <<'GLTF'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
"nodes": [{"name": "a", "camera": 0}, {"name": "b", "camera": 1}, {"name": "c", "camera": 2}, {"mesh": 0}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2.4, "znear": 0.1, "zfar": 100}},
  {"type": "perspective", "perspective": {"yfov": 1.4, "aspectRatio": 2.4, "znear": 0.1, "zfar": 100}},
  {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "zfar": 100}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "triangle.bin"}]}
GLTF
zero='\0\0\0\0' one='\0\0\200\77'
printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >triangle.bin

# cameras SUITE VERSION ANGLES: the angles and aspects in Collada, and how often glTF has a camera.
cameras() {
  unpack "$1" amd64 assimp-utils="$2"
  run "$root/usr/bin/assimp" export cameras.gltf out.dae >log
  run "$root/usr/bin/assimp" export cameras.gltf out.gltf -fgltf2 >log
  seen "xfov in Collada by $2" "$3" "$(sed -n 's/.*<xfov[^>]*>\([0-9.]*\)<.*/\1/p' out.dae | awk '{ printf "%s%.1f", space, $1; space = " " }')"
  seen "aspect_ratio" "2.4 2.4 0.0" "$(sed -n 's/.*<aspect_ratio>\([0-9.]*\)<.*/\1/p' out.dae | awk '{ printf "%s%.1f", space, $1; space = " " }')"
  seen "cameras in glTF" 0 "$(grep -c '"camera' out.gltf || true)"
}

guess "105.3 127.4, and no xfov or aspect_ratio for the third; 3 cameras in glTF"
cameras bookworm 5.2.5~ds0-1+b1 "137.5 192.5 57.3"
cameras trixie 5.4.3+ds-2 "105.3 127.4 57.3"
finish
