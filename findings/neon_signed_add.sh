#!/usr/bin/env bash
# GCC's vaddq_s32 does not wrap around: a comparison of unsigned numbers built on it gives the wrong answer from -O1 on.
#
# One would guess: vaddq_s32 is the instruction add, which wraps, as its namesake on x86 does (_mm_add_epi32).
# What happens: GCC 12.2 writes it in arm_neon.h as a sum of vectors of signed numbers, whose overflow is undefined. Adding the
# sign bit to both sides of vcltq_s32, the usual way to compare unsigned numbers, is optimised away. -O0 and -fwrapv give the right answer.
# Why a user of a ray tracer meets it: SIMD code is ported from x86 by replacing intrinsics one by one, or through a header that does
# it. Sorting keys and masks of ids are unsigned. It works in debug builds, and elsewhere as long as numbers are small.
#
# Needs Debian 12 and its network. Debian 12: gcc-12-aarch64-linux-gnu 12.2.0-14cross1, qemu-user 1:7.2+dfsg-7+deb12u18+b3. About a minute.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 gcc-12-aarch64-linux-gnu=12.2.0-14cross1 libc6-dev-arm64-cross=2.36-8cross1 qemu-user=1:7.2+dfsg-7+deb12u18+b3
cd "$work"

cat >below.c <<'C'
#include <arm_neon.h>
#include <limits.h>
#include <stdio.h>
/* a < b as unsigned numbers */
__attribute__((noinline)) static uint32x4_t below(int32x4_t a, int32x4_t b) {
  const int32x4_t sign = vdupq_n_s32(INT_MIN);
  return vcltq_s32(vaddq_s32(a, sign), vaddq_s32(b, sign));
}
int main(void) {
  const uint32x4_t less = below(vdupq_n_s32(1), vdupq_n_s32(-1));
  puts(vgetq_lane_u32(less, 0) ? "yes" : "no");
}
C
below() {
  LD_LIBRARY_PATH=$libraries "$root/usr/bin/aarch64-linux-gnu-gcc-12" -B "$root/usr/aarch64-linux-gnu/bin" -B "$root/usr/aarch64-linux-gnu/lib" \
    -isystem "$root/usr/aarch64-linux-gnu/include" "$@" -S below.c -o below.s
  LD_LIBRARY_PATH=$libraries "$root/usr/bin/aarch64-linux-gnu-as" below.s -o below.o
  LD_LIBRARY_PATH=$libraries "$root/usr/bin/aarch64-linux-gnu-gcc-12" -B "$root/usr/aarch64-linux-gnu/bin" -B "$root/usr/aarch64-linux-gnu/lib" \
    -L "$root/usr/aarch64-linux-gnu/lib" -static below.o -o below
  run "$root/usr/bin/qemu-aarch64" ./below
}
guess "yes, with all options"
seen "1 < 4294967295 with -O0" yes "$(below -O0)"
seen "1 < 4294967295 with -O1" no "$(below -O1)"
seen "1 < 4294967295 with -O2" no "$(below -O2)"
seen "1 < 4294967295 with -O2 -fwrapv" yes "$(below -O2 -fwrapv)"
finish
