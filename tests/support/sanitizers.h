#pragma once
/// \file Whether a sanitizer watches the tests.

namespace oktett::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

/// How many of `all` random cases a slow test tries: under sanitizers, which take ten times as long, an
/// eighth.
constexpr unsigned cases(unsigned all) { return kSanitized ? (all + 7) / 8 : all; }

}  // namespace oktett::test
