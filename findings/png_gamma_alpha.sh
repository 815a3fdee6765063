#!/usr/bin/env bash
# The colours of a PNG with alpha are multiplied by another number when the file says which gamma it has.
#
# One would guess: gAMA = 1/2.2, which nearly every PNG without an sRGB chunk means anyhow, changes the colour of a half
# transparent pixel by a step or two. Alpha multiplies light: 188 at half alpha is light 0.25, which is 137 of 255.
# What happens: OpenImageIO 2.4.7 multiplies encoded numbers. Without the chunk 188 becomes 94 (light 0.11 in place of 0.25). With gAMA 45455
# it becomes 41 (light 0.02): the factor is alpha^2.2, the right one is alpha^(1/2.2). sRGB and gAMA together give 94 again.
# Why a user of a ray tracer meets it: leaves and decals are PNG pictures with soft edges. Their rims turn dark, and darker
# still when a tool such as an old exporter added a gAMA chunk, though all viewers show the two files alike.
#
# Needs Debian 12 and its network. Debian 12: openimageio 2.4.7.1+dfsg-2. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

cat >read.py <<'PYTHON'
import struct
import zlib

import OpenImageIO as oiio


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


gamma, srgb = chunk(b"gAMA", struct.pack(">I", 45455)), chunk(b"sRGB", b"\0")
rows = (b"\0" + bytes([188, 188, 188, 128]) * 4) * 4
keep = oiio.ImageSpec()
keep.attribute("oiio:UnassociatedAlpha", 1)
for name, extra in (("none", b""), ("gAMA", gamma), ("sRGB", srgb), ("gAMA and sRGB", gamma + srgb)):
    with open("a.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 6, 0, 0, 0)))
        file.write(extra + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    read = oiio.ImageInput.open("a.png")
    plain = oiio.ImageInput.open("a.png", keep)
    print(read.read_image(oiio.UINT8)[0, 0, 0], "of", plain.read_image(oiio.UINT8)[0, 0, 0])
PYTHON
python read.py >out

guess "137, or 94 where a library does not care; the same with all chunks"
seen "188 at alpha 128, no chunk" "94 of 188" "$(sed -n 1p out)"
seen "the same with gAMA" "41 of 188" "$(sed -n 2p out)"
seen "the same with sRGB" "94 of 188" "$(sed -n 3p out)"
seen "the same with both" "94 of 188" "$(sed -n 4p out)"
finish
