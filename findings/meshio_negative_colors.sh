#!/usr/bin/env bash
# Bright colours of a binary PLY file are negative for meshio.
#
# One would guess: `property uchar red` holds 0 to 255, in text and in bytes.
# What happens: meshio (of Debian 12 and 13) takes uchar for signed bytes in binary files: 200 becomes -56. In text it is 200.
# Why a user of a ray tracer meets it: colours of scans come from binary PLY files, and what is brighter than a middle grey turns dark.
#
# Needs Debian 12 and its network. Debian 12: python3-meshio 7.0.0-3. Debian 13: python3-meshio 7.0.0-really-5.3.5-6+deb13u1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >red.py <<'PYTHON'
import struct

import meshio

head = "ply\nformat %s 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\n"
head += "property list uchar int vertex_indices\nend_header\n"
vertices = [(0, 0, 0, 100), (1, 0, 0, 200), (0, 1, 0, 255)]
with open("text.ply", "w") as file:
    file.write(head % "ascii" + "".join("%g %g %g %d\n" % v for v in vertices) + "3 0 1 2\n")
with open("bytes.ply", "wb") as file:
    file.write((head % "binary_little_endian").encode() + b"".join(struct.pack("<3fB", *v) for v in vertices) + struct.pack("<B3i", 3, 0, 1, 2))
for name in ("text.ply", "bytes.ply"):
    print(" ".join("%d" % red for red in meshio.read(name).point_data["red"]))
PYTHON
unpack bookworm amd64 python3-meshio=7.0.0-3
python red.py >old 2>log
unpack trixie amd64 python3-meshio=7.0.0-really-5.3.5-6+deb13u1
PYTHONHOME=$root/usr run "$root/usr/bin/python3.13" red.py >new 2>log

guess "100 200 255, each time"
for release in old new; do
  seen "red of text, $release" "100 200 255" "$(sed -n 1p $release)"
  seen "red of bytes, $release" "100 -56 -1" "$(sed -n 2p $release)"
done
finish
