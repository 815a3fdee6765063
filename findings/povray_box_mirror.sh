#!/usr/bin/env bash
# POV-Ray does not mirror the image on a mirrored box, unless the box was turned before.
#
# One would guess: an image that lies by `uv_mapping` on a box is mirrored with it by `scale <-1, 1, 1>`, as on a sphere or a mesh.
# What happens: POV-Ray 3.7.0.10 applies `scale` and `translate` to the corners of a box, and computes u and v from these, until another transform
# makes it keep a matrix. So `scale <-1, 1, 1>` leaves the image as it was, and mirrors it if the box was turned before, were it by a thousandth
# of a degree.
# Why a user of a ray tracer meets it: parts of a model are made twice, the second as a mirror image. The text on its boxes stays readable on some
# and is mirrored on others.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

# red_at TRANSFORMS: where on the image the front of a box, left of its middle, lies: u in 255ths.
red_at() {
  cat >scene.pov <<POV
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location <-0.5, 0, -9> look_at <-0.5, 0, 0> right 0.01*x up 0.01*y }
$1
POV
  run "$root/usr/bin/povray" +Iscene.pov +W1 +H1 +FP8 File_Gamma=1.0 +Oscene.ppm -D -A +WT1 >log 2>&1
  tail -c 3 scene.ppm | od -An -tu1 | awk '{ print $1 }'
}
look='pigment { uv_mapping gradient x color_map { [0 rgb 0] [1 rgb 1] } } finish { ambient 1 diffuse 0 }'

guess "a mirror image shows 207 where 239 was, turned or not"
seen "box" 239 "$(red_at "box { -1, 1 $look }")"
seen "box, scale <-1, 1, 1>" 239 "$(red_at "box { -1, 1 $look scale <-1, 1, 1> }")"
seen "box, rotate 0.001*z scale <-1, 1, 1>" 207 "$(red_at "box { -1, 1 $look rotate 0.001*z scale <-1, 1, 1> }")"
seen "box, scale <-1, 1, 1> rotate 0.001*z" 239 "$(red_at "box { -1, 1 $look scale <-1, 1, 1> rotate 0.001*z }")"
seen "box, rotate 0.001*z" 239 "$(red_at "box { -1, 1 $look rotate 0.001*z }")"
sheet="mesh { triangle { <-1, -1, 0>, <1, -1, 0>, <-1, 1, 0> uv_vectors <1, 0>, <0.75, 0>, <1, 1> }
  triangle { <1, 1, 0>, <1, -1, 0>, <-1, 1, 0> uv_vectors <0.75, 1>, <0.75, 0>, <1, 1> } $look"
seen "mesh" 239 "$(red_at "$sheet }")"
seen "mesh, scale <-1, 1, 1>" 207 "$(red_at "$sheet scale <-1, 1, 1> }")"
finish
