#!/usr/bin/env bash
# A picture that is saved as Radiance .hdr is darker by 0.36 % on average.
#
# One would guess: numbers are rounded to the nearest that the format has, so that errors cancel over many pixels.
# What happens: OpenImageIO 2.4.7 cuts the digits off when it writes, and adds nothing when it reads. stb_image_write does the
# same. The loss happens once: saving the picture that was read again changes nothing.
# Channels much weaker than the strongest of their pixel become 0: (100, 0.35, 0.05) comes back as (100, 0, 0).
# Why a user of a ray tracer meets it: environment pictures are .hdr files. A white furnace lit by one, or energy compared
# before and after a conversion, is wrong by several tenths of a per cent, far more than the noise of a good render.
#
# Needs Debian 12, g++ and the network. Debian 12: openimageio 2.4.7.1+dfsg-2, libstb-dev 0.0~git20220908.8b5f1f3+ds-1. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openimageio-tools=2.4.7.1+dfsg-2 python3-openimageio=2.4.7.1+dfsg-2 libopenexr-3-1-30=3.1.5-5 python3-numpy=1:1.24.2-1+deb12u1
cd "$work"

cat >trip.py <<'PYTHON'
import numpy as np
import OpenImageIO as oiio


def trip(pixels, name):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float")
    output = oiio.ImageOutput.create(name)
    assert output.open(name, spec) and output.write_image(pixels) and output.close()
    return oiio.ImageInput.open(name).read_image(oiio.FLOAT)


noise = np.random.default_rng(2).uniform(0.1, 4, (256, 256, 3)).astype(np.float32)
first = trip(noise, "first.hdr")
second = trip(first, "second.hdr")
print("%.4f" % (first.mean(dtype=float) / noise.mean(dtype=float)))
print("%d brighter, %d darker" % ((first > noise).sum(), (first < noise).sum()))
print("%.4f" % (second.mean(dtype=float) / first.mean(dtype=float)))
weak = np.empty((8, 8, 3), np.float32)
weak[:] = 100, 0.35, 0.05
print(*("%g" % x for x in trip(weak, "weak.hdr")[0, 0]))
PYTHON
python trip.py >out

guess "the mean of 65536 pixels is kept to 0.0001; about as many numbers become brighter as darker"
seen "mean after a trip through .hdr" 0.9964 "$(sed -n 1p out)"
seen "numbers" "0 brighter, 196605 darker" "$(sed -n 2p out)"
seen "mean after a second trip, of the first" 1.0000 "$(sed -n 3p out)"
seen "(100, 0.35, 0.05)" "100 0 0" "$(sed -n 4p out)"

unpack bookworm amd64 libstb-dev=0.0~git20220908.8b5f1f3+ds-1
cat >trip.cpp <<'CPP'
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#include <cstdio>
#include <vector>
int main() {
  std::vector<float> noise(256 * 256 * 3);
  unsigned state = 1;
  double before = 0, after = 0;
  for (float& x : noise) {
    state = state * 1664525u + 1013904223u;
    x = .1f + 3.9f * (state >> 8) / 16777216.f;
    before += x;
  }
  stbi_write_hdr("stb.hdr", 256, 256, 3, noise.data());
  int width, height, channels;
  const float* read = stbi_loadf("stb.hdr", &width, &height, &channels, 3);
  for (int i = 0; i < width * height * 3; ++i) after += read[i];
  std::printf("%.4f\n", after / before);
}
CPP
g++ -O1 -I"$root/usr/include" trip.cpp -o trip
seen "mean after a trip by stb_image_write and stb_image" 0.9964 "$(./trip)"
finish
