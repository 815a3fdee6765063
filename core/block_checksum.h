#pragma once
/// \file A checksum of large blocks of memory, computed by several threads.

#include <cstddef>
#include <cstdint>

namespace oktett {

/// Bytes that are summed up as one piece. The checksum depends on this number.
inline constexpr std::size_t kChecksumPiece = std::size_t{1} << 20;

/// The checksum of one piece, at most kChecksumPiece bytes. Any change within eight bytes at a multiple of
/// eight changes it.
std::uint64_t piece_checksum(const void* data, std::size_t bytes);

/// The checksum of `bytes` bytes, the same on every machine and for any number of threads: a hash of the
/// checksums of all pieces and of the size.
std::uint64_t block_checksum(const void* data, std::size_t bytes);

/// Copies `bytes` bytes and returns the checksum of the copy.
std::uint64_t copy_with_checksum(const void* from, void* to, std::size_t bytes);

}  // namespace oktett
