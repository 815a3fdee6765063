#!/usr/bin/env bash
# Object ids in an EXR file become tiny fractions, and cannot be got back, once OpenImageIO's tools touch the file.
#
# One would guess: a channel of whole numbers (EXR type uint) beside channels of floats stays what it is, or its numbers
# become floats of the same value: id 7000 is 7000.
# What happens: OpenImageIO 2.4.7 keeps one type for all channels of a picture in memory, float, and treats whole numbers as
# fractions of the largest one: 7000 becomes 7000 / 4294967295 = 1.63e-6. oiiotool prints that, and what it writes has a
# float channel with it. In a file whose only channel is uint a
# copy keeps the numbers, but whoever reads them as floats gets fractions, too.
# Why a user of a ray tracer meets it: ids of objects and triangles are written beside depth. Cropping or joining pictures
# with oiiotool makes masks by id empty. Ids above 2^24 also lose their last digits.
#
# Needs Debian 12 and its network. Debian 12: openimageio-tools 2.4.7.1+dfsg-2. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

# An EXR file of 4x2 pixels without compression, with a float channel Z (all 2.5) and a uint channel id (all 7000); and one with id alone.
cat >write.py <<'PYTHON'
import struct


def write(name, channels):
    def attribute(key, kind, value):
        return key + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    box = struct.pack("<4i", 0, 0, 3, 1)
    kinds = b"".join(key + b"\0" + struct.pack("<iB3xii", kind, 0, 1, 1) for key, kind, _ in channels) + b"\0"
    header = b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", kinds)
    header += attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", box)
    header += attribute(b"displayWindow", b"box2i", box) + attribute(b"lineOrder", b"lineOrder", b"\0")
    header += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    row = b"".join(value * 4 for _, _, value in channels)
    size = 8 + len(row)
    start = len(header) + 16
    offsets = struct.pack("<2Q", start, start + size)
    rows = b"".join(struct.pack("<ii", y, len(row)) + row for y in range(2))
    open(name, "wb").write(header + offsets + rows)


depth = (b"Z", 2, struct.pack("<f", 2.5))
ids = (b"id", 0, struct.pack("<I", 7000))
write("mixed.exr", [depth, ids])
write("alone.exr", [ids])
PYTHON
cat >read.py <<'PYTHON'
import sys

import OpenImageIO as oiio

print("%.9g" % oiio.ImageInput.open(sys.argv[1]).read_image(oiio.FLOAT)[0, 0, -1])
PYTHON
python write.py
oiiotool() { run "$root/usr/bin/oiiotool" "$@"; }
oiiotool mixed.exr -o copy.exr
oiiotool alone.exr -o alone_copy.exr

guess "the id is read as 7000, and a copy has the id 7000"
seen "channels of the file" "Z (float), id (uint)" "$(oiiotool --info -v mixed.exr | sed -n 's/.*channel list: //p')"
seen "id beside depth, read as float" "1.62981451e-06" "$(python read.py mixed.exr)"
seen "oiiotool --printstats, the largest Z and id" "2.500000 0.000002 (float)" "$(oiiotool mixed.exr --printstats | sed -n 's/.*Stats Max: //p')"
seen "channels of a copy" "Z, id" "$(oiiotool --info -v copy.exr | sed -n 's/.*channel list: //p')"
seen "type of a copy" "float" "$(oiiotool --info copy.exr | sed -n 's/.* channel, \([a-z]*\) openexr/\1/p')"
seen "id in the copy" "1.62981451e-06" "$(python read.py copy.exr)"
seen "type of a copy of the file with id alone" "uint" "$(oiiotool --info alone_copy.exr | sed -n 's/.* channel, \([a-z]*\) openexr/\1/p')"
seen "id in it, read as float" "1.62981451e-06" "$(python read.py alone_copy.exr)"
finish
