#pragma once
/// \file Several copies of one function.

#include <cstddef>

#include "core/platform.h"

/// For loops outside accel/isa that the compiler turns into vector code: one copy per instruction set, chosen
/// when the program is loaded. Their numbers are the same, since nothing is contracted or reordered.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(OKTETT_SANITIZED)
#define OKTETT_PER_SET __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define OKTETT_PER_SET
#endif
