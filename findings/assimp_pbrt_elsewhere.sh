#!/usr/bin/env bash
# Assimp writes a pbrt scene to another file than the one that it is given.
#
# One would guess: `assimp export a.gltf scenes/a.pbrt` writes scenes/a.pbrt, as scenes/a.obj, where asked for OBJ.
# What happens: Assimp 5.4.3 (Debian 13) says "wrote output file: scenes/a.pbrt" and exits with 0. The file is scenesa.pbrt, beside the folder.
# Without a folder it is a.pbrta.pbrt. 5.2.5 (Debian 12) writes a.pbrt without a folder, and fails with one: "could not open output
# .pbrt file: a".
# Why a user of a ray tracer meets it: a script that converts scenes and then renders them finds no file, or renders one of an earlier day.
#
# Needs Debian 12 and its network. Debian 12: assimp-utils 5.2.5~ds0-1+b1. Debian 13: assimp-utils 5.4.3+ds-2. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >a.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
OBJ
# written FILE: converts the triangle, and prints the status, what the program says at the end, and the new file of the format.
written() {
  local status=0
  rm -rf scenes* a.pbrt*
  mkdir scenes
  run "$root/usr/bin/assimp" export a.obj "$1" >log 2>&1 || status=$?
  echo "$status, $(tail -n 1 log | sed 's/.*: \(wrote\|could\)/\1/'), $(find . -name "*.${1##*.}" ! -path ./a.obj)"
}

guess "0, wrote output file: scenes/a.pbrt, ./scenes/a.pbrt, and ./a.pbrt where no folder is given"
unpack bookworm amd64 assimp-utils=5.2.5~ds0-1+b1
seen "OBJ in a folder, Assimp 5.2.5" "0, wrote output file: scenes/a.obj, ./scenes/a.obj" "$(written scenes/a.obj)"
seen "pbrt in no folder" "0, wrote output file: a.pbrt, ./a.pbrt" "$(written a.pbrt)"
seen "pbrt in a folder" "11, could not open output .pbrt file: a, " "$(written scenes/a.pbrt)"
unpack trixie amd64 assimp-utils=5.4.3+ds-2
seen "OBJ in a folder, Assimp 5.4.3" "0, wrote output file: scenes/a.obj, ./scenes/a.obj" "$(written scenes/a.obj)"
seen "pbrt in no folder" "0, wrote output file: a.pbrt, ./a.pbrta.pbrt" "$(written a.pbrt)"
seen "pbrt in a folder" "0, wrote output file: scenes/a.pbrt, ./scenesa.pbrt" "$(written scenes/a.pbrt)"
finish
