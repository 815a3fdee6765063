#!/usr/bin/env bash
# POV-Ray does not cut Bezier patches by `clipped_by`.
#
# One would guess: `clipped_by` cuts whatever it stands in, as it cuts a mesh of the same form.
# What happens: in POV-Ray 3.7.0.10 a ray meets a bicubic_patch of either type also where the clipping plane takes it away. Triangles, meshes,
# discs and polygons are cut. There is no warning.
# Why a user of a ray tracer meets it: models made of patches are cut open to show what is inside, or to have a hole.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#macro Patch(Type)
  bicubic_patch {
    type Type flatness 0 u_steps 3 v_steps 3
    #for (Row, 0, 3) #for (Column, 0, 3) <Column, Row, 0> #end #end
    clipped_by { plane { x, 1 } }
  }
#end
#declare Sheet = mesh { triangle { <0, 0, 0>, <3, 0, 0>, <0, 3, 0> } clipped_by { plane { x, 1 } } }
#macro Meets(Object, X)
  #local N = <0, 0, 0>;
  #local P = trace(Object, <X, 0.5, -5>, z, N);
  #if (vlength(N) > 0) "hit" #else "none" #end
#end
#declare A = object { Patch(0) }
#declare B = object { Patch(1) }
#debug concat("RESULT ", Meets(A, 2), " ", Meets(B, 2), " ", Meets(Sheet, 0.5), " ", Meets(Sheet, 2), "\n")
POV
))
guess "no ray meets what lies behind the plane"
seen "patch of type 0, behind the plane" hit "${result[0]}"
seen "patch of type 1, behind the plane" hit "${result[1]}"
seen "mesh, before the plane" hit "${result[2]}"
seen "mesh, behind the plane" none "${result[3]}"
finish
