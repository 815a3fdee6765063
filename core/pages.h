#pragma once
/// \file Memory in pages, which large arrays take from the system themselves.

#include <cstddef>

namespace oktett {

/// Arrays of at least so many bytes ask for huge pages, of 2 MB. Rays read nodes and triangles in random
/// order; with pages of 4 kB, most reads of a large tree miss the processor's table of addresses (TLB).
inline constexpr std::size_t kLargePiece = std::size_t{4} << 20;

/// Address space for so many bytes, which read as zero. Pages are allocated when they are first written.
/// Throws std::bad_alloc.
void* reserve_pages(std::size_t bytes);

/// Gives back address space of reserve_pages, from a page boundary on; a piece of it may be given back before
/// the rest.
void release_pages(void* begin, std::size_t bytes);

/// Whether the system would give so many more bytes of address space now.
bool can_reserve(std::size_t bytes);

}  // namespace oktett
