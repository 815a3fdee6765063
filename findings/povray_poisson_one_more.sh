#!/usr/bin/env bash
# POV-Ray's macro `Rand_Poisson` never gives 0, and its mean is one more than asked for.
#
# One would guess: the macros of rand.inc have the distributions of their names: Rand_Poisson(2, ...) the mean 2, and 0 in 14 of 100 cases;
# Rand_Chi_Square(10, ...) the variance 20; Rand_Erlang(2, 3, ...), whose Mu is the "Mean" in the manual, the mean 2.
# What happens: the one of POV-Ray 3.7.0.10 counts the factor that ends its loop, too, so that the mean is 3 and nothing is 0. Shape
# and scale of the chi-square are exchanged: its mean is right, its variance 50. For Erlang's distribution Mu is the mean of one of its
# three terms, and the mean 6.
# Why a user of a ray tracer meets it: flowers, stars and stones are counted by it for each tile of a ground. No tile is empty, and
# sparse ones, with a mean of 0.1, hold eleven times as many.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2, povray-includes 1:3.7.0.10-2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2 povray-includes=1:3.7.0.10-2
cd "$work"
cp "$root"/usr/share/povray-3.7/include/{consts,rand}.inc .

result=($(povray_says <<'POV'
#include "rand.inc"
#declare S = seed(1);
#declare Count = 4000; #declare Sum = 0; #declare Least = 100;
#for (K, 1, Count) #declare V = Rand_Poisson(2, S); #declare Sum = Sum + V; #declare Least = min(Least, V); #end
#declare Few = 0;
#for (K, 1, Count) #declare Few = Few + Rand_Poisson(0.1, S); #end
#declare A = 0; #declare B = 0;
#for (K, 1, Count) #declare V = Rand_Chi_Square(10, S); #declare A = A + V; #declare B = B + V*V; #end
#declare E = 0;
#for (K, 1, Count) #declare E = E + Rand_Erlang(2, 3, S); #end
#debug concat("RESULT ", str(Sum/Count, 0, 1), " ", str(Least, 0, 0), " ", str(Few/Count, 0, 1), " ", str(A/Count, 0, 0), " ",
  str(B/Count - pow(A/Count, 2), 0, 0), " ", str(E/Count, 0, 1), "\n")
POV
))
guess "2.0, 0 and 0.1; 10 and 20; 2.0"
seen "mean of Rand_Poisson(2)" 3.0 "${result[0]}"
seen "least of 4000 of them" 1 "${result[1]}"
seen "mean of Rand_Poisson(0.1)" 1.1 "${result[2]}"
seen "mean of Rand_Chi_Square(10)" 10 "${result[3]}"
seen "its variance" 50 "${result[4]}"
seen "mean of Rand_Erlang(2, 3)" 6.0 "${result[5]}"
finish
