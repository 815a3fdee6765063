#pragma once
/// \file Whether a sanitizer watches the tests, or an emulator of another processor runs them.

#include "core/platform.h"

namespace oktett::test {

#if defined(OKTETT_SANITIZED)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

#if defined(OKTETT_EMULATED)
constexpr bool kEmulated = true;
#else
constexpr bool kEmulated = false;
#endif

/// How many of `all` random cases a slow test tries: under sanitizers, which take ten times as long, an
/// eighth.
constexpr unsigned cases(unsigned all) { return kSanitized ? (all + 7) / 8 : all; }

}  // namespace oktett::test
