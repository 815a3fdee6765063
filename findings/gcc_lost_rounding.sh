#!/usr/bin/env bash
# GCC 12 leaves out the rounding to float where numbers go from double to float and back.
#
# One would guess: three doubles that are copied into a struct of floats, and from there into a struct of doubles, are rounded to
# float, at every level of optimisation; the language leaves no choice without -ffast-math.
# What happens: from -O2 on GCC 12.2 converts the first two numbers as one vector, takes both conversions together for none, and returns
# these two unrounded; the third one is rounded. With -fno-tree-slp-vectorize all three are. GCC 14.2 of Debian 13 rounds them.
# Why a user of a ray tracer meets it: vertices are floats, and places are computed in double. What checks whether floats hold a
# number, or computes with the corners that a tree has, does so by such a copy.
#
# Needs Debian 12 with g++-12 12.2.0-14+deb12u1 on x86-64. A second.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
seen "g++-12" 12.2.0-14+deb12u1 "$(dpkg-query -f '${Version}' -W g++-12)"
cd "$work"

cat >round.cpp <<'CPP'
#include <cstdio>
struct Doubles {
  double x, y, z;
};
struct Floats {
  float x, y, z;
};
__attribute__((noinline)) Doubles rounded(const Doubles& v) {
  const Floats f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  return {f.x, f.y, f.z};
}
int main(int count, char**) {
  const Doubles v{0.1 * count, 0.2 * count, 0.3 * count}, r = rounded(v);
  std::printf("%s %s %s", r.x == v.x ? "not" : "rounded", r.y == v.y ? "not" : "rounded", r.z == v.z ? "not" : "rounded");
}
CPP
result() {
  g++-12 "$@" round.cpp -o program
  ./program
}
guess "rounded rounded rounded, each time"
seen "-O1" "rounded rounded rounded" "$(result -O1)"
seen "-O2" "not not rounded" "$(result -O2)"
seen "-O3 -ffp-contract=off" "not not rounded" "$(result -O3 -ffp-contract=off)"
seen "-O2 -fno-tree-slp-vectorize" "rounded rounded rounded" "$(result -O2 -fno-tree-slp-vectorize)"
finish
