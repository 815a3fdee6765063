#!/usr/bin/env bash
# POV-Ray's `normal { wrinkles }` leans the whole surface to one side, and does not only roughen it.
#
# One would guess: bumps tilt a plane this way and that, so that its mean normal stays that of the plane, and it is about as bright
# under a light from the left as under one from the right. So it is with `bumps`, `dents` and `waves`.
# What happens: POV-Ray 3.7.0.10 adds a vector of noise to the normal that is positive along each axis nearly everywhere for
# `wrinkles`. Under lights at 45 degrees the mean brightness of a white plane is 0.83 from one side and 0.46 from the other with
# the usual amount of 0.5; both are 0.71 for a smooth plane, and 0.68 and 0.71 with `bumps 0.5`.
# Why a user of a ray tracer meets it: paper and cloth in such scenes, made of wrinkles, are lit as if their objects were turned; in a
# program that bends the normal by the slope of the same noise they are darker or brighter all over.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2 python3.11-minimal libpython3.11-minimal
cd "$work"

# brightness SIDE NORMAL: the mean of the plane z = 0 in a square of 40 by 40 under a light from x = SIDE at 45 degrees.
brightness() {
  cat >scene.pov <<POV
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location -10*z right 40*x up 40*y }
light_source { <$1 * 1000, 0, -1000>, rgb 1 parallel point_at 0 }
plane { -z, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } normal { $2 } }
POV
  run "$root/usr/bin/povray" +Iscene.pov +Oout.ppm +FP16 File_Gamma=1.0 +W160 +H160 -A -D +WT1 >log 2>&1
  python -c 'import sys; data = open("out.ppm", "rb").read()[-160 * 160 * 6:]; values = [data[i] / 255 for i in range(0, len(data), 6)]
print("%.2f" % (sum(values) / len(values)))'
}

guess "about 0.7 from both sides, with each of them"
seen "smooth, from the right" 0.71 "$(brightness 1 'bumps 0')"
seen "bumps, from the right" 0.68 "$(brightness 1 'bumps 0.5')"
seen "bumps, from the left" 0.71 "$(brightness -1 'bumps 0.5')"
seen "wrinkles, from the right" 0.83 "$(brightness 1 'wrinkles 0.5')"
seen "wrinkles, from the left" 0.46 "$(brightness -1 'wrinkles 0.5')"
finish
