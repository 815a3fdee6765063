#!/usr/bin/env bash
# In POV-Ray's language `1 | 0 & 0` is 0 in an expression and 1 in a function.
#
# One would guess: "and" binds tighter than "or", as in C, and a function computes what the same text does elsewhere.
# What happens: POV-Ray 3.7.0.10 takes them from left to right in #if, #while and #declare, so that 1 | 0 & 0 is (1 | 0) & 0. In
# `function { }` & comes before |.
# Why a user of a ray tracer meets it: isosurfaces and patterns are tried as expressions first, and conditions of loops are moved
# into functions. A reader of the language has to do both.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare F = function(x) { 1 | 0 & x }
#declare G = function(x) { x & 0 | 1 }
#debug concat("RESULT ", str((1 | 0 & 0), 0, 0), " ", str(F(0), 0, 0), " ", str((0 & 0 | 1), 0, 0), " ", str(G(0), 0, 0), "\n")
POV
))
guess "1 and 1, then 1 and 1"
seen "1 | 0 & 0 in an expression" 0 "${result[0]}"
seen "1 | 0 & 0 in a function" 1 "${result[1]}"
seen "0 & 0 | 1 in an expression" 1 "${result[2]}"
seen "0 & 0 | 1 in a function" 1 "${result[3]}"
finish
