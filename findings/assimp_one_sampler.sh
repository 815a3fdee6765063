#!/usr/bin/env bash
# Of two textures of one image Assimp keeps the filters of the first.
#
# One would guess: two textures of glTF that share an image and differ in their samplers, one NEAREST and clamped, the other LINEAR
# and repeated by mirroring, are still two after the file was converted to glTF.
# What happens: Assimp 5.2.5 (Debian 12) and 5.4.3 (Debian 13) write one texture with the sampler of the material that comes first, for both
# materials. With the materials in the other order it is the other sampler. There is no error.
# Why a user of a ray tracer meets it: one atlas serves tiled floors and signs. A floor that repeats its image becomes a stripe of its
# last texels, or crisp pixels become blurred.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1. Debian 13: assimp-utils 5.4.3+ds-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

# scene FIRST SECOND: two triangles of 9 floats, with the textures of these numbers; the image is one pixel.
scene() {
  cat <<GLTF
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"mesh": 1}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]},
  {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 1}]}],
"materials": [{"name": "first", "pbrMetallicRoughness": {"baseColorTexture": {"index": $1}}},
  {"name": "second", "pbrMetallicRoughness": {"baseColorTexture": {"index": $2}}}],
"textures": [{"source": 0, "sampler": 0}, {"source": 0, "sampler": 1}],
"samplers": [{"magFilter": 9728, "minFilter": 9728, "wrapS": 33071, "wrapT": 33071},
  {"magFilter": 9729, "minFilter": 9987, "wrapS": 33648, "wrapT": 33648}],
"images": [{"uri": "pixel.png"}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
  {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
"buffers": [{"byteLength": 60, "uri": "triangle.bin"}]}
GLTF
}
scene 0 1 >nearest_first.gltf
scene 1 0 >linear_first.gltf
{
  zero='\0\0\0\0' one='\0\0\200\77'
  printf "$zero$zero$zero$one$zero$zero$zero$one$zero" # the corners
  printf "$zero$zero$one$zero$zero$one"                # u and v
} >triangle.bin
base64 -d >pixel.png <<<iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==

# samplers FILE: how many textures a glTF file has, and the filters and kinds of wrapping.
samplers() {
  local text
  text=$(tr -d ' \n' <"$1")
  echo "$(grep -o '"source":' <<<"$text" | wc -l) textures, magFilter $(grep -o '"magFilter":[0-9]*' <<<"$text" | cut -d: -f2 | paste -sd' ')," \
    "wrapS $(grep -o '"wrapS":[0-9]*' <<<"$text" | cut -d: -f2 | paste -sd' ')"
}

guess "2 textures, magFilter 9728 9729, wrapS 33071 33648"
seen "what is read" "2 textures, magFilter 9728 9729, wrapS 33071 33648" "$(samplers nearest_first.gltf)"
for release in "bookworm 5.2.5~ds0-1+b1" "trixie 5.4.3+ds-2"; do
  read -r suite version <<<"$release"
  unpack "$suite" amd64 assimp-utils="$version"
  for file in nearest_first linear_first; do run "$root/usr/bin/assimp" export $file.gltf $file.out.gltf -fgltf2 >log; done
  seen "what $version writes, with NEAREST first" "1 textures, magFilter 9728, wrapS 33071" "$(samplers nearest_first.out.gltf)"
  seen "with LINEAR first" "1 textures, magFilter 9729, wrapS 33648" "$(samplers linear_first.out.gltf)"
done
finish
