#!/usr/bin/env bash
# In POV-Ray a point far outside of what bounds a surface is hit along one ray and not along another.
#
# One would guess: `bounded_by` only saves time, and where its shape is too small for the surface it cuts that off.
# What happens: POV-Ray 3.7.0.10 asks for each ray whether it meets the bounding shape, and if so looks for hits anywhere on it. The plane
# y = -2, written as a quadric and bounded by a ball of radius 0.5 around the origin, is hit 10 units away from the ball by a ray through the
# ball; a ray straight up through the same point does not hit. So the camera sees places that throw no shadow on what lies below them.
# Why a user of a ray tracer meets it: three of POV-Ray's own scenes bound quartics that have no end by balls.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare Floor = quadric { <0, 0, 0>, <0, 0, 0>, <0, 1, 0>, 2 bounded_by { sphere { 0, 0.5 } } }
#macro Height(From, Along)
  #local N = <0, 0, 0>;
  #local P = trace(Floor, From, Along, N);
  #if (vlength(N) > 0) concat("(", vstr(3, P, ",", 0, 3), ")") #else "none" #end
#end
#debug concat("RESULT ", Height(<0, 1, -5>, <0, -1, 5>), " ", Height(<0, -3, 10>, y), " ", Height(<0, -3, 0>, y), "\n")
POV
))
guess "all three rays hit, or, if the ball cuts the plane, none: the plane does not meet it"
seen "ray down through the ball" "(0.000,-2.000,10.000)" "${result[0]}"
seen "ray up through the same point" none "${result[1]}"
seen "ray up through the ball" "(0.000,-2.000,0.000)" "${result[2]}"
finish
