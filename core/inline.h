#pragma once
/// \file Forced inlining, for public functions that compute. An ordinary inline function is a weak symbol: a
/// program whose multiplications and additions fuse would bring copies that replace the library's own, and
/// hits would depend on who links it.

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
