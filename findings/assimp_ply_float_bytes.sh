#!/usr/bin/env bash
# Assimp's binary PLY files with colours are no PLY files.
#
# One would guess: text and bytes hold the same mesh, and what is `uchar red` in the header takes a byte.
# What happens: assimp 5.2.5 (Debian 12) announces a byte for each of red, green, blue and alpha and writes a float, so
# that 12 bytes too many follow each vertex. Readers take the rest of the colours for the next vertex. The text is right, and so is
# 5.4.3 (Debian 13).
# Why a user of a ray tracer meets it: scans are converted to bytes to make them smaller. The file is refused, or read as noise.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1. Debian 13: assimp-utils 5.4.3+ds-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >triangle.ply <<'PLY'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
0 1 0 0 0 255
3 0 1 2
PLY
# body SUITE VERSION BYTES: what follows the header, which announces 3 times 3 floats and 4 bytes, and a face of a byte and three indices.
body() {
  unpack "$1" amd64 assimp-utils="$2"
  run "$root/usr/bin/assimp" export triangle.ply "$1.ply" -fplyb >/dev/null
  seen "colours in the header of $1" "4 of uchar" "$(sed '/^end_header/q' "$1.ply" | grep -ac 'property uchar') of uchar"
  seen "bytes behind it" "$3" "$(($(stat -c %s "$1.ply") - $(sed '/^end_header/q' "$1.ply" | wc -c)))"
}

guess "3 * (3 * 4 + 4) + 1 + 3 * 4 = 61 bytes"
body bookworm 5.2.5~ds0-1+b1 97
body trixie 5.4.3+ds-2 61
finish
