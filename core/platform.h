#pragma once
/// \file The project's few macros, and which instruction sets this translation unit is compiled for.

#include "core/inline.h"

#define OKTETT_LIKELY(x) __builtin_expect(!!(x), 1)
#define OKTETT_UNLIKELY(x) __builtin_expect(!!(x), 0)

#if defined(__aarch64__) && defined(__ARM_NEON)
#define OKTETT_COMPILED_NEON 1
#endif
#if defined(__SSE4_2__)
#define OKTETT_COMPILED_SSE42 1
#endif
#if defined(__AVX2__) && defined(__FMA__)
#define OKTETT_COMPILED_AVX2 1
#endif
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define OKTETT_COMPILED_AVX512 1
#endif
