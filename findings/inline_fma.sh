#!/usr/bin/env bash
# A program compiled for its processor changes the results inside a library that is already compiled.
#
# One would guess: what a static library computes is settled when it is compiled. Compiler options of the program change the
# program's own code only.
# What happens: an inline function of the library's header that is called out of line exists in both. The linker keeps one copy, that of
# the program, since it comes first. With -mfma (part of -march=native) GCC 12.2 fuses a product and a difference in it, and the library now
# computes 2e-16 for the cross product of a vector with itself, which was 0. In the other order of files the library's copy stays.
# Why a user of a ray tracer meets it: vector classes are inline functions, and a renderer's library decides by signs of such
# products. Two programs with one library disagree.
#
# Needs Debian 12 with g++-12 12.2.0-14+deb12u1 and a processor with FMA. A second.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
seen "g++-12" 12.2.0-14+deb12u1 "$(dpkg-query -f '${Version}' -W g++-12)"
cd "$work"

cat >vector.h <<'CPP'
struct Vector {
  double x, y;
};
inline double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
CPP
cat >library.cpp <<'CPP'
#include "vector.h"
double area(Vector a, Vector b) {
  double (*volatile function)(Vector, Vector) = cross;  // stands for a call that the compiler does not inline
  return function(a, b);
}
CPP
cat >program.cpp <<'CPP'
#include "vector.h"

#include <cstdio>
double area(Vector a, Vector b);
double (*volatile use)(Vector, Vector) = cross;
int main() { std::printf("%g\n", area({1.1, 2.3}, {1.1, 2.3})); }
CPP
g++-12 -O2 -c library.cpp
ar rcs library.a library.o
area() {
  g++-12 -O2 "$@" -o program
  ./program
}
guess "0 each time, since the library is not compiled again"
seen "area of two equal vectors, program with -O2" 0 "$(area program.cpp library.a)"
seen "program with -O2 -mfma" 2.04281e-16 "$(area -mfma program.cpp library.a)"
seen "program with -O2 -mfma, library's object first" 0 "$(area -mfma library.o program.cpp)"
finish
