#!/usr/bin/env bash
# Most of POV-Ray's random points "inside an object" lie outside of it if the object is thin and slanted.
#
# One would guess: VRand_In_Obj of rand.inc "returns a random point that is inside", and takes long for an object that fills little of its
# box, as the manual warns.
# What happens: the macro of POV-Ray 3.7.0.10 gives up after 1000 points of the box and returns the last one, without a word. Of 200 points
# for a rod along the diagonal of a cube 172 are somewhere else in the cube. For a rod along an axis all are right.
# Why a user of a ray tracer meets it: leaves on twigs, sparks along a wire and drops on grass float beside them, the more of them the
# thinner the object is.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2, povray-includes 1:3.7.0.10-2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2 povray-includes=1:3.7.0.10-2
cd "$work"
cp "$root"/usr/share/povray-3.7/include/{consts,rand}.inc .

result=($(povray_says <<'POV'
#include "rand.inc"
#declare S = seed(1);
#macro Right(Thing)
  #local Sum = 0;
  #for (K, 1, 200) #local Sum = Sum + inside(Thing, VRand_In_Obj(Thing, S)); #end
  Sum
#end
#declare Straight = cylinder { <0, 0, 0>, <17, 0, 0>, 0.05 }
#declare Slanted = cylinder { <0, 0, 0>, <10, 10, 10>, 0.05 }
#declare Ring = torus { 1, 0.02 rotate <45, 0, 45> }
#debug concat("RESULT ", str(Right(Straight), 0, 0), " ", str(Right(Slanted), 0, 0), " ", str(Right(Ring), 0, 0), "\n")
POV
))
guess "200 of 200 for each"
seen "inside of a rod along x" 200 "${result[0]}"
seen "inside of a rod along the diagonal" 28 "${result[1]}"
seen "inside of a slanted ring of wire" 118 "${result[2]}"
finish
