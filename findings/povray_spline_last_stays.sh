#!/usr/bin/env bash
# In POV-Ray the last point of a spline cannot be replaced, though all others can.
#
# One would guess: "If two points have the same parameter value, the second point will replace the first", as the manual says, for all points
# alike, and `spline { S 1, <5, 0> }` is S with another point at 1.
# What happens: POV-Ray 3.7.0.10 replaces a point if one of a greater value is there already. A point at the greatest value so far is
# dropped without a word. Of 0, 1, 1, 2 in this order the first point at 1 counts, of 0, 1, 2, 1 the second.
# Why a user of a ray tracer meets it: keys of a path are listed in order of time, with a key twice where it jumps or was changed, and paths
# are taken over with another end. A renderer that does what is written moves the camera elsewhere.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare Start = spline { linear_spline 0, <0, 0> 0, <5, 0> 1, <1, 0> }
#declare Later = spline { linear_spline 0, <0, 0> 1, <1, 0> 2, <2, 0> 1, <5, 0> }
#declare Order = spline { linear_spline 0, <0, 0> 1, <1, 0> 1, <5, 0> 2, <2, 0> }
#declare Ended = spline { linear_spline 0, <0, 0> 1, <1, 0> }
#declare Other = spline { Ended 1, <5, 0> }
#debug concat("RESULT ", str(Start(0).x, 0, 1), " ", str(Later(1).x, 0, 1), " ", str(Order(1).x, 0, 1), " ", str(Order(1.5).x, 0, 1), " ",
  str(Other(1).x, 0, 1), "\n")
POV
))
guess "5, 5, 5, 3.5 and 5"
seen "first point given twice" 5.0 "${result[0]}"
seen "the same value after a greater one" 5.0 "${result[1]}"
seen "the same value at once" 1.0 "${result[2]}"
seen "half a step after it" 1.5 "${result[3]}"
seen "a copy with another end" 1.0 "${result[4]}"
finish
