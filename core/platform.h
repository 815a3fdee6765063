#pragma once
/// \file The project's few macros, and which instruction sets this translation unit is compiled for.
///
/// Public functions that compute are always inlined. An ordinary inline function is a weak symbol: a program
/// whose multiplications and additions fuse would bring copies that replace the library's own, and hits would
/// depend on who links it.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define OKTETT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define OKTETT_SANITIZED 1
#endif
#endif

/// For functions on the hot path that must always be inlined.
#if defined(OKTETT_SANITIZED)
// Instrumented code is many times larger; with forced inlining it would take minutes to compile.
#define OKTETT_INLINE inline
#else
#define OKTETT_INLINE inline __attribute__((always_inline))
#endif
#define OKTETT_NOINLINE __attribute__((noinline))

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
