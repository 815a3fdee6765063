#!/usr/bin/env bash
# The operator / of xsimd is not division on 64-bit ARM, and sqrt is not the square root.
#
# One would guess: a / b and sqrt(a) of batch<float> are the processor's instructions, which IEEE 754 fixes to the last bit.
# What happens: xsimd 8.1.0 (Debian 12) and 13.2.0 (Debian 13) refine an estimate on neon64, though the processor has both instructions. 41 %
# of the quotients and 30 % of the roots of numbers from 1 to 2 are off in the last bit, sqrt(infinity) is NaN and sqrt(-0) is +0. For
# batch<double> they are exact. On x86 both are.
# Why a user of a ray tracer meets it: the same source gives other pictures on ARM, bounds that rest on a rounding of half a bit
# are wrong, and distances of rays that miss, which are infinite, become NaN.
#
# Needs Debian 12 and its network. Debian 12: g++-12-aarch64-linux-gnu 12.2.0-14cross1, qemu-user 1:7.2+dfsg-7+deb12u18+b3, libxsimd-dev 8.1.0-7.
# Debian 13: libxsimd-dev 13.2.0-1. About two minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 g++-12-aarch64-linux-gnu=12.2.0-14cross1 libc6-dev-arm64-cross=2.36-8cross1 qemu-user=1:7.2+dfsg-7+deb12u18+b3 libxsimd-dev=8.1.0-7
cd "$work"

cat >divide.cpp <<'CPP'
#include <cmath>
#include <cstdio>
#include <random>
#include <xsimd/xsimd.hpp>
using Batch = xsimd::batch<float>;
static float root(float x) { return sqrt(Batch(x)).get(0); }
int main() {
  std::mt19937 random(1);
  int quotients = 0, roots = 0;
  for (int i = 0; i < 100000; ++i) {
    const volatile float a = 1 + (random() >> 9) / 8388608.f, b = 1 + (random() >> 9) / 8388608.f;
    quotients += (Batch(a) / Batch(b)).get(0) != a / b;
    roots += root(a) != std::sqrt(a);
  }
  std::printf("%.0f %% of quotients, %.0f %% of roots\n", quotients / 1000., roots / 1000.);
  const volatile float infinity = INFINITY, minus_zero = -0.f;
  std::printf("%g and %g\n", std::fabs(root(infinity)), root(minus_zero));
}
CPP
cross=$root compiler_libraries=$libraries
# divide FOLDER: compiles with xsimd's headers below a folder, and runs the program.
divide() {
  local at=$cross/usr/aarch64-linux-gnu
  LD_LIBRARY_PATH=$compiler_libraries "$cross/usr/bin/aarch64-linux-gnu-g++-12" -O2 -std=c++17 -Wno-psabi -static -B "$at/bin" -B "$at/lib" -L "$at/lib" \
    -isystem "$1" -isystem "$at/include/c++/12" -isystem "$at/include/c++/12/aarch64-linux-gnu" -isystem "$at/include" divide.cpp -o divide
  "$cross/lib64/ld-linux-x86-64.so.2" --library-path "$compiler_libraries" "$cross/usr/bin/qemu-aarch64" ./divide
}
mkdir 8
cp -r "$root/usr/include/xsimd" 8
divide 8 >out8
unpack trixie amd64 libxsimd-dev=13.2.0-1
mkdir 13
cp -r "$root/usr/include/xsimd" 13
divide 13 >out13

guess "0 % of quotients, 0 % of roots; inf and -0"
for version in 8 13; do
  seen "xsimd $version, different from the processor's" "41 % of quotients, 30 % of roots" "$(sed -n 1p out$version)"
  seen "xsimd $version, sqrt of infinity and of -0" "nan and 0" "$(sed -n 2p out$version)"
done
finish
