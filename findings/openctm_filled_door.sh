#!/usr/bin/env bash
# A wall with a doorway has no doorway after OpenCTM has read it.
#
# One would guess: a polygon with a notch is cut into triangles that leave the notch open, or refused.
# What happens: ctmconv 1.0.3 cuts every polygon into a fan from its first corner, without a word. Here a wall of area 9.75 gets triangles of
# area 13.8, two of them turned over, which fill the doorway. gltfpack 1.3.0 of npm does the same with OBJ files.
# Why a user of a ray tracer meets it: buildings are polygons, and shadows and light through the door are gone.
#
# Needs Debian 12 and its network. Debian 12: openctm-tools 1.0.3+dfsg1-2.1+b3. About half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 openctm-tools=1.0.3+dfsg1-2.1+b3
cd "$work"

printf '%s\n' 'v 0 0 3' 'v 1.25 0 3' 'v 1.25 1.25 3' 'v 2.25 1.25 3' 'v 2.25 0 3' 'v 4 0 3' 'v 4 2 3' 'v 2 3.5 3' 'v 0 2 3' \
  'f 1 2 3 4 5 6 7 8 9' >wall.obj
run "$root/usr/bin/ctmconv" wall.obj triangles.obj >log 2>&1
# The sum of the triangles' areas, and how many face backwards.
awk '$1 == "v" { ++n; x[n] = $2; y[n] = $3 }
  $1 == "f" { split($2, a, "/"); split($3, b, "/"); split($4, c, "/"); i = a[1]; j = b[1]; k = c[1]
    area = ((x[j] - x[i]) * (y[k] - y[i]) - (x[k] - x[i]) * (y[j] - y[i])) / 2
    sum += area < 0 ? -area : area; back += area < 0 }
  END { printf "%.3f, %d turned over\n", sum, back }' triangles.obj >out

guess "9.750, 0 turned over"
seen "area of the triangles" "13.812, 2 turned over" "$(cat out)"
finish
