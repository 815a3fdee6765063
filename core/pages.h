#pragma once
/// \file Memory in pages, which large arrays take from the system themselves.

#include <cstddef>

namespace oktett {

/// Columns of at least so many bytes have pages of their own.
inline constexpr std::size_t kLargePiece = std::size_t{4} << 20;
inline constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// Rounds up to whole pages: to a huge page where the rest fills at least half of one, else to pages of 4 kB.
/// Sizes near the greatest number, for which there is no memory, are returned unchanged.
std::size_t whole_pages(std::size_t bytes);

/// Address space for so many bytes, which read as zero. Pages are allocated when they are first written.
/// Whole huge pages are asked for: rays read nodes and triangles in random order, and with small pages, most
/// reads of a large tree miss the processor's table of addresses (TLB). Throws std::bad_alloc.
void* reserve_pages(std::size_t bytes);

/// Gives back address space of reserve_pages, from a page boundary on; a piece of it may be given back before
/// the rest.
void release_pages(void* begin, std::size_t bytes);

/// Gives back the memory of the whole pages among these bytes. Their contents are lost; the address space
/// remains and may be written again.
void discard_pages(void* begin, std::size_t bytes);

/// Whether the system would give so many more bytes of address space now.
bool can_reserve(std::size_t bytes);

}  // namespace oktett
