#pragma once
/// \file How many doubles code works on at once.

#include <type_traits>

#include "core/simd_native.h"

namespace oktett {

/// Lanes of double for set A; one without vector registers.
template <class A>
inline constexpr int kDoubleLanes = std::is_same_v<A, ScalarIsa> ? 1 : 8;

}  // namespace oktett
