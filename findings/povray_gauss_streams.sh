#!/usr/bin/env bash
# POV-Ray's macro `Rand_Gauss` gives a number of one stream to whoever asks next, from whichever stream.
#
# One would guess: streams are independent, as the manual says of `rand` and its streams: what is asked of stream B changes nothing in
# stream A, and B's numbers are those of its own seed.
# What happens: the macro of rand.inc in POV-Ray 3.7.0.10 makes two numbers at a time and keeps the second one in a single variable for
# all streams. A call for B after one for A returns A's second number, whatever the seed of B, and A goes on with its third. `Rand_Lognormal`
# and `Rand_Student`, which use it, do the same. `Rand_Normal` keeps the streams apart.
# Why a user of a ray tracer meets it: trees are given a stream of their own so that they stay when something else is added to the scene.
# They jump, and objects of two streams are at places that belong together.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2, povray-includes 1:3.7.0.10-2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2 povray-includes=1:3.7.0.10-2
cd "$work"
cp "$root"/usr/share/povray-3.7/include/{consts,rand}.inc .

# numbers STATEMENT: after one number of stream A and this statement, the next number of A.
numbers() {
  povray_says <<POV
#include "rand.inc"
#declare A = seed(1); #declare B = seed(7); #declare C = seed(12345); #declare Other = 0;
#declare First = $1(0, 1, A);
$2
#debug concat("RESULT ", str($1(0, 1, A), 0, 3), " ", str(Other, 0, 3), "\n")
POV
}

alone=($(numbers Rand_Gauss ''))
with_b=($(numbers Rand_Gauss '#declare Other = Rand_Gauss(0, 1, B);'))
with_c=($(numbers Rand_Gauss '#declare Other = Rand_Gauss(0, 1, C);'))
normal_alone=($(numbers Rand_Normal ''))
normal_with_b=($(numbers Rand_Normal '#declare Other = Rand_Normal(0, 1, B);'))
guess "A's second number is the same with and without a call for B, and those of B and C differ"
seen "A's second number" 0.544 "${alone[0]}"
seen "the same after a call for B" -1.375 "${with_b[0]}"
seen "what B gave" 0.544 "${with_b[1]}"
seen "what C gave in its place" 0.544 "${with_c[1]}"
seen "A's second number with Rand_Normal, with and without B" "${normal_alone[0]}" "${normal_with_b[0]}"
finish
