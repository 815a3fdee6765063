#!/usr/bin/env bash
# POV-Ray's pattern `density_file` with `interpolate 1` blends its last values into its first ones.
#
# One would guess: the values of a file lie in the middles or at the corners of cells and are interpolated between, and beyond the last
# one it stays, as outside of the unit cube all is 0.
# What happens: POV-Ray 3.7.0.10 places value i of n at i/n, so that none lies at 1, and interpolates from the last one, at 1 - 1/n, back
# to the first. Of the values 0, 1/3, 2/3 and 1 along x the place 0.75 shows 1, and 0.875 shows 1/2.
# Why a user of a ray tracer meets it: a cloud that touches the upper faces of its box fades there, and what stands on its floor shows
# faintly at its ceiling; a renderer that reads such files must do the same to show the same smoke.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

# Three sides of two bytes, most significant first, then a byte for each value.
printf '\0\4\0\1\0\1\0\125\252\377' >ramp.df3
result=($(povray_says <<'POV'
#declare F = function { pattern { density_file df3 "ramp.df3" interpolate 1 } }
#debug concat("RESULT ", str(F(0.5, 0.5, 0.5), 0, 3), " ", str(F(0.75, 0.5, 0.5), 0, 3), " ", str(F(0.875, 0.5, 0.5), 0, 3), "\n")
POV
))
guess "0.667, then 1 and 1, or values by the middles of cells"
seen "at 0.5" 0.667 "${result[0]}"
seen "at 0.75, the last value" 1.000 "${result[1]}"
seen "at 0.875" 0.500 "${result[2]}"
finish
