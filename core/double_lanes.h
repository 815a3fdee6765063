#pragma once
/// \file How many doubles code works on at once.

#include "core/simd_native.h"

namespace oktett {

/// Lanes of double for set A. SSE4.2 and NEON have registers of two: with eight lanes most
/// values would live in memory.
template <class A>
inline constexpr int kDoubleLanes = 8;
template <>
inline constexpr int kDoubleLanes<Sse42Isa> = 4;
template <>
inline constexpr int kDoubleLanes<NeonIsa> = 4;
template <>
inline constexpr int kDoubleLanes<ScalarIsa> = 1;

}  // namespace oktett
