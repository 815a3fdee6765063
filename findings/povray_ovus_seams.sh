#!/usr/bin/env bash
# POV-Ray's ovus is not hit by rays in the two planes in which its pieces meet, though such points are inside.
#
# One would guess: level rays at any height between bottom and top of an egg hit it if they pass near enough to its axis.
# What happens: POV-Ray 3.7.0.10 finds no hit for level rays at exactly the heights at which the balls pass into the piece between
# them, of an egg with the radii 1 and 0.5 those of 0.125 and 1.375; a ten-millionth above and below they hit. Its own `inside` says
# that the rays pass through the egg.
# Why a user of a ray tracer meets it: views from the side in an orthographic camera show a line of background across the egg.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare Egg = ovus { 1, 0.5 }
#macro Hits(Y)
  #local Count = 0;
  #local X = 0;
  #while (X < 0.325)
    #local N = <0, 0, 0>;
    #local P = trace(Egg, <X, Y, -5>, z, N);
    #if (vlength(N) > 0) #local Count = Count + 1; #end
    #local X = X + 0.01;
  #end
  Count
#end
#declare Lower = Hits(0.125);
#declare Upper = Hits(1.375);
#declare Above = Hits(1.3750001);
#debug concat("RESULT ", str(Lower, 0, 0), " ", str(Upper, 0, 0), " ", str(Above, 0, 0), " ",
              str(inside(Egg, <0.1, 1.375, 0>), 0, 0), "\n")
POV
))
guess "all 33 rays hit at each height, and a point on one of them is inside: 33 33 33 1"
seen "rays at the lower seam that hit" 0 "${result[0]}"
seen "rays at the upper seam that hit" 0 "${result[1]}"
seen "rays a ten-millionth above it that hit" 33 "${result[2]}"
seen "point on a ray at the upper seam inside" 1 "${result[3]}"
finish
