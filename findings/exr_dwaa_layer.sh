#!/usr/bin/env bash
# EXR's DWAA compression loses digits of the y coordinate of a position layer, and of no other.
#
# One would guess: DWAA, which is lossy, treats the three float channels of a layer of positions alike.
# What happens: OpenEXR 3.1.5 chooses by the last part of a channel's name. R, G, B and Y (luminance) are compressed with loss;
# X and Z are not. So P.X and P.Z come back exactly, and P.Y is off by 0.01 where positions are 0 to 1. With the names P.R, P.G, P.B all three are.
# Why a user of a ray tracer meets it: positions, normals and ids are written as layers beside the colours, and DWAA is chosen
# for the colours' sake. Two of three coordinates look right in every check.
#
# Needs Debian 12 and its network. Debian 12: libopenexr-3-1-30 3.1.5-5, openimageio 2.4.7.1+dfsg-2. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

cat >write.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio

position = np.random.default_rng(1).random((64, 64, 3)).astype(np.float32)
for names in (("P.X", "P.Y", "P.Z"), ("P.R", "P.G", "P.B")):
    spec = oiio.ImageSpec(64, 64, 3, "float")
    spec.channelnames = names
    spec.attribute("compression", "dwaa")
    file = names[1] + ".exr"
    output = oiio.ImageOutput.create(file)
    assert output.open(file, spec) and output.write_image(position) and output.close()
    read = oiio.ImageInput.open(file)
    order = [read.spec().channelnames.index(name) for name in names]
    error = np.abs(read.read_image(oiio.FLOAT)[:, :, order] - position).max((0, 1))
    print(*("%s %s" % (name, "exact" if e == 0 else "off by a hundredth" if 0.005 < e < 0.05 else e) for name, e in zip(names, error)), sep=", ")
PYTHON
python write.py >out

guess "all three channels are exact, or all three are off"
seen "a layer named X, Y, Z" "P.X exact, P.Y off by a hundredth, P.Z exact" "$(sed -n 1p out)"
seen "a layer named R, G, B" "P.R off by a hundredth, P.G off by a hundredth, P.B off by a hundredth" "$(sed -n 2p out)"
finish
