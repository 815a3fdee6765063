#!/usr/bin/env bash
# Under qemu-user the reciprocal estimate of x86 processors is no estimate.
#
# One would guess: rcpps and rsqrtps have about 12 bits under an emulator, as on every processor.
# What happens: qemu-user 7.2 divides. All 65536 reciprocals of numbers from 1 to 2 are correctly rounded, where hardware is
# right to 11 or 12 bits and hits a few dozen of them. The estimate of a square root is right to about 2^-23.
# Also 1 / 3e38 is a denormal number, where hardware gives 0.
# Why a user of a ray tracer meets it: ray tracers start Newton's method at these estimates. A missing step, too few steps or an
# error bound that is too tight passes all tests in an emulator, and pictures differ from those of hardware.
#
# Needs Debian 12, gcc and the network. Debian 12: qemu-user 1:7.2+dfsg-7+deb12u18+b3. About 20 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 qemu-user=1:7.2+dfsg-7+deb12u18+b3
cd "$work"

cat >estimates.c <<'C'
#include <immintrin.h>
#include <math.h>
#include <stdio.h>
static const char* bits(double error) { return error > 0x1p-13 && error < 0x1p-11 ? "11 to 13 bits" : error < 0x1p-22 ? "more than 22 bits" : "other"; }
int main(void) {
  double reciprocal = 0, root = 0;
  int exact = 0, count = 0;
  for (float x = 1; x < 2; x += 1.f / 65536, ++count) {
    const volatile float hidden = x;
    const float a = _mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(hidden))), b = _mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(hidden)));
    exact += a == 1 / hidden;
    reciprocal = fmax(reciprocal, fabs((double)a * x - 1));
    root = fmax(root, fabs((double)b * sqrt((double)x) - 1));
  }
  const volatile float large = 3e38f;
  printf("%s of %d exact\n", exact == count ? "all" : exact < 1000 ? "few" : "many", count);
  printf("%s\n%s\n", bits(reciprocal), bits(root));
  printf("%s\n", _mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(large))) == 0 ? "0" : "denormal");
}
C
gcc -O1 -static estimates.c -o estimates -lm
./estimates >hardware
run "$root/usr/bin/qemu-x86_64" ./estimates >emulated

guess "both lines of each pair are alike"
seen "rcpps, this processor" "few of 65536 exact" "$(sed -n 1p hardware)"
seen "rcpps, qemu" "all of 65536 exact" "$(sed -n 1p emulated)"
seen "smallest accuracy of rcpps, this processor" "11 to 13 bits" "$(sed -n 2p hardware)"
seen "smallest accuracy of rcpps, qemu" "more than 22 bits" "$(sed -n 2p emulated)"
seen "smallest accuracy of rsqrtps, this processor" "11 to 13 bits" "$(sed -n 3p hardware)"
seen "smallest accuracy of rsqrtps, qemu" "more than 22 bits" "$(sed -n 3p emulated)"
seen "rcpps of 3e38, this processor" 0 "$(sed -n 4p hardware)"
seen "rcpps of 3e38, qemu" denormal "$(sed -n 4p emulated)"
finish
