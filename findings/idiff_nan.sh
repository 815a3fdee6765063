#!/usr/bin/env bash
# idiff passes a picture with a pixel that is NaN or infinite, where the other picture has an ordinary number.
#
# One would guess: idiff fails when a pixel is 1 in one picture and NaN or infinity in the other, above all with -fail 0.
# What happens: idiff of OpenImageIO 2.4.7 prints PASS and exits 0. `oiiotool --diff` says FAILURE for the same files. Plus
# infinity against minus infinity passes in both: all that is not finite counts as equal to each other.
# Why a user of a ray tracer meets it: a picture is compared with a reference to find regressions. The commonest regression
# is a NaN, and depth is infinite where a ray misses. The comparison stays green.
#
# Needs Debian 12 and its network. Debian 12: openimageio-tools 2.4.7.1+dfsg-2. About 40 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

cat >write.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio

for name, value in (("one", 1), ("two", 2), ("nan", np.nan), ("plus", np.inf), ("minus", -np.inf)):
    depth = np.ones((8, 8, 1), np.float32)
    depth[3, 4] = value
    spec = oiio.ImageSpec(8, 8, 1, "float")
    spec.channelnames = ("Z",)
    output = oiio.ImageOutput.create(name + ".exr")
    output.open(name + ".exr", spec)
    output.write_image(depth)
    output.close()
PYTHON
python write.py

# result COMMAND...: its exit status and the last line that it prints.
result() {
  local status=0
  run "$@" >out 2>&1 || status=$?
  echo "exit $status, $(tail -1 out)"
}
idiff() { result "$root/usr/bin/idiff" -fail 0 -failpercent 0 -warn 0 "$@"; }
oiiotool() { result "$root/usr/bin/oiiotool" "$@" --fail 0 --failpercent 0 --warn 0 --diff; }
guess "idiff fails for all of these pairs, as oiiotool --diff does"
seen "idiff, 2 against 1" "exit 2, FAILURE" "$(idiff two.exr one.exr)"
seen "idiff, NaN against 1" "exit 0, PASS" "$(idiff nan.exr one.exr)"
seen "idiff, infinity against 1" "exit 0, PASS" "$(idiff plus.exr one.exr)"
seen "idiff, infinity against minus infinity" "exit 0, PASS" "$(idiff plus.exr minus.exr)"
seen "oiiotool --diff, NaN against 1" "exit 1, FAILURE" "$(oiiotool nan.exr one.exr)"
seen "oiiotool --diff, infinity against minus infinity" "exit 0, PASS" "$(oiiotool plus.exr minus.exr)"
seen "oiiotool --diff, infinity against NaN" "exit 1, FAILURE" "$(oiiotool plus.exr nan.exr)"
finish
