#!/usr/bin/env bash
# POV-Ray's conic prisms are not hit by rays parallel to their axis, though such points are inside.
#
# One would guess: a ray straight down onto a prism that narrows to a tip meets its slanted side.
# What happens: POV-Ray 3.7.0.10 finds no hit for rays along the axis on a conic sweep of straight lines, whichever end they come
# from; its own `inside` says that the ray passes through the prism. A ray tilted by a thousandth is hit where it should be.
# Why a user of a ray tracer meets it: views from above in an orthographic camera, and parallel light from straight above.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare Tip = prism { conic_sweep linear_spline -1, 1, 4, <1, 0>, <2, 0>, <1, 2>, <1, 0> }
#declare N = <0, 0, 0>;
#declare P = trace(Tip, <0.7, 5, 0.3>, -y, N);
#declare Straight = vlength(N);
#declare P = trace(Tip, <0.7, 5, 0.3>, <0.001, -1, 0>, N);
#declare Tilted = vlength(N);
#debug concat("RESULT ", str(Straight, 0, 0), " ", str(Tilted, 0, 0), " ", str(inside(Tip, <0.7, 0.6, 0.3>), 0, 0), "\n")
POV
))
guess "hit, hit, and a point below the side is inside: 1 1 1"
seen "ray along the axis (1: hit)" 0 "${result[0]}"
seen "ray tilted by a thousandth" 1 "${result[1]}"
seen "point on the first ray inside" 1 "${result[2]}"
finish
