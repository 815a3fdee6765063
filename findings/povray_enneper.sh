#!/usr/bin/env bash
# POV-Ray's function `f_enneper` is not zero on Enneper's surface.
#
# One would guess: an isosurface of f_enneper of functions.inc shows the minimal surface x = u - u³/3 + u v², y = -v - u² v + v³/3,
# z = u² - v², on which ((y² - x²)/(2z) + 2z²/9 + 2/3)³ - 6 ((y² - x²)/(4z) - (x² + y² + 8z²/9)/4 + 2/9)² is zero.
# What happens: the function of POV-Ray 3.7.0.10 has two of these terms alone, 6 ((y² - x²)/(4z))² - ((y² - x²)/(2z) + 2z²/9)³, and where
# |z| is at most 0.2 a z of 0.2 below both lines. At the point of u = 1/2, v = 1/4 it is 0.243, where the whole expression is 0.
# Why a user of a ray tracer meets it: pictures of "Enneper's surface" by this function show another one, which no choice of the threshold
# mends, and a program that writes the equation out shows something else than POV-Ray.
#
# Needs Debian 12 and its network. Debian 12: povray 1:3.7.0.10-2+b2. Half a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 povray=1:3.7.0.10-2+b2
cd "$work"

result=($(povray_says <<'POV'
#declare F = function { internal(18) }
#declare G = function(x, y, z) {
  pow((y*y - x*x)/(2*z) + 2*z*z/9 + 2/3, 3) - 6*pow((y*y - x*x)/(4*z) - (x*x + y*y + 8*z*z/9)/4 + 2/9, 2) }
#declare H = function(x, y, z) { 6*pow((y*y - x*x)/(4*z), 2) - pow((y*y - x*x)/(2*z) + 2*z*z/9, 3) }
#declare U = 1/2; #declare V = 1/4;
#declare X = U - U*U*U/3 + U*V*V; #declare Y = -V - U*U*V + V*V*V/3; #declare Z = U*U - V*V;
#debug concat("RESULT ", str(abs(G(X, Y, Z)), 0, 3), " ", str(F(X, Y, Z, 1), 0, 3), " ", str(F(0.7, 0.4, 0.5, 1) - H(0.7, 0.4, 0.5), 0, 6), "\n")
POV
))
guess "0 on the surface"
seen "the equation at a point of the surface" 0.000 "${result[0]}"
seen "f_enneper there" 0.243 "${result[1]}"
seen "f_enneper less its two terms, elsewhere" 0.000000 "${result[2]#-}"
finish
