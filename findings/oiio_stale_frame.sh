#!/usr/bin/env bash
# A picture that is written twice within a second is read back as the first one.
#
# One would guess: opening a file after it was written and closed gives what is in it.
# What happens: oiio.ImageBuf of OpenImageIO 2.4.7 reads through a cache that all of a program's ImageBufs share. A file counts as new only
# if its time of change differs in whole seconds. ImageInput reads the file anew, so the two disagree in the same line.
# Why a user of a ray tracer meets it: a script that renders previews or steps of an optimisation into one file name, and
# measures each with ImageBuf, sees the first picture again and again as long as a frame takes less than a second.
#
# Needs Debian 12 and its network. Debian 12: openimageio 2.4.7.1+dfsg-2. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

cat >frames.py <<'PYTHON'
import os

import numpy as np
import OpenImageIO as oiio


def write(value, moment):
    output = oiio.ImageOutput.create("frame.exr")
    assert output.open("frame.exr", oiio.ImageSpec(8, 8, 3, "float"))
    assert output.write_image(np.full((8, 8, 3), value, np.float32)) and output.close()
    os.utime("frame.exr", (moment, moment))


def both():
    buffer, plain = oiio.ImageBuf("frame.exr").getpixel(0, 0)[0], oiio.ImageInput.open("frame.exr").read_image("float")[0, 0, 0]
    print("%g %g" % (buffer, plain))


# The time of change is set to what it would be on a machine of any speed.
for value, moment in (1, 1000000000.1), (2, 1000000000.4), (3, 1000000000.8), (4, 1000000001.2):
    write(value, moment)
    both()
PYTHON
python frames.py >out

guess "ImageBuf and ImageInput both give 1, 2, 3, 4"
seen "frame 1, ImageBuf and ImageInput" "1 1" "$(sed -n 1p out)"
seen "frame 2 at once" "1 2" "$(sed -n 2p out)"
seen "frame 3 at once" "1 3" "$(sed -n 3p out)"
seen "frame 4 in a later second" "4 4" "$(sed -n 4p out)"
finish
