#!/usr/bin/env bash
# A #local variable of a macro in POV-Ray's language changes the variable of the caller if it has a parameter's name.
#
# One would guess: #local makes a variable that ends with the macro, whatever its name.
# What happens: POV-Ray 3.7.0.10 passes variables by reference, and `#local p = p + 1` writes through the parameter p: the caller's
# variable has changed afterwards. An expression as argument, such as `(A)`, makes a copy.
# Why a user of a ray tracer meets it: macros that count, move or scale what they are given, called twice with the same variable.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#macro Grow(p) #local p = p + 1; #end
#macro Other(p) #local q = p + 1; #end
#declare A = 5; Grow(A)
#declare B = 5; Grow((B))
#declare C = 5; Other(C)
#debug concat("RESULT ", str(A, 0, 0), " ", str(B, 0, 0), " ", str(C, 0, 0), "\n")
POV
))
guess "5, 5 and 5"
seen "variable after #local of the parameter's name" 6 "${result[0]}"
seen "the same, passed in parentheses" 5 "${result[1]}"
seen "#local of another name" 5 "${result[2]}"
finish
