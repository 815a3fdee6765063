#pragma once
/// \file What the files of one scene may hold, so that none takes long to read.

#include <cstddef>

namespace oktett {

/// Bytes, the included files counted in.
inline constexpr std::size_t kMaxSceneBytes = std::size_t{16} << 20;
/// Keys, scalars, maps and lists, the included files counted in and aliases expanded.
inline constexpr std::size_t kMaxSceneNodes = 1'000'000;

}  // namespace oktett
