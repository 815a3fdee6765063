#include "core/pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <new>

#include "core/soa.h"

namespace oktett {

namespace {

std::size_t round_up(std::size_t x, std::size_t unit) { return (x + unit - 1) / unit * unit; }

/// Null if the system refuses.
char* map_pages(std::size_t bytes) {
  void* const p =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return p == MAP_FAILED ? nullptr : static_cast<char*>(p);
}

/// Address space that begins at a multiple of kHugePage, or null. What was reserved around it is given back.
char* map_huge_pages(std::size_t bytes) {
  const std::size_t all = round_up(bytes, page_size()) + kHugePage;
  char* const reserved = all > bytes ? map_pages(all) : nullptr;
  if (reserved == nullptr) return nullptr;
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(reserved) % kHugePage;
  const std::size_t after = kHugePage - before;  // at least a page, as `before` is below kHugePage
  if (before > 0) release_pages(reserved, before);
  release_pages(reserved + all - after, after);
  return reserved + before;
}

}  // namespace

std::size_t page_size() {
  static const auto size = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return size;
}

PageRange pages_within(std::uintptr_t begin, std::size_t bytes, std::size_t page) {
  const std::uintptr_t first = round_up(begin, page), end = (begin + bytes) / page * page;
  return {first, first < end ? end - first : 0};
}

PageRange pages_around(std::uintptr_t begin, std::size_t bytes, std::size_t page) {
  const std::uintptr_t first = begin / page * page;
  return {first, bytes > 0 ? round_up(begin + bytes - first, page) : 0};
}

std::size_t whole_pages(std::size_t bytes) { return whole_pages(bytes, page_size()); }

std::size_t whole_pages(std::size_t bytes, std::size_t page) {
  if (bytes > ~kHugePage) return bytes;
  const std::size_t huge = bytes / kHugePage * kHugePage, rest = bytes - huge;
  if (rest >= kHugePage / 2) return huge + kHugePage;
  return huge + round_up(rest, page);
}

void* reserve_pages(std::size_t bytes) {
  const bool huge = bytes >= kHugePage;
  char* const pages = huge ? map_huge_pages(bytes) : map_pages(bytes);
  if (pages == nullptr) throw std::bad_alloc();
  // Only a request: the system takes small pages where it has no huge ones.
  if (huge) madvise(pages, bytes, MADV_HUGEPAGE);
  return pages;
}

void release_pages(void* begin, std::size_t bytes) { munmap(begin, bytes); }

void discard_pages(void* begin, std::size_t bytes) {
  const PageRange range = pages_within(reinterpret_cast<std::uintptr_t>(begin), bytes, page_size());
  if (range.bytes > 0) madvise(reinterpret_cast<void*>(range.first), range.bytes, MADV_DONTNEED);
}

void populate_pages(void* begin, std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  const PageRange range = pages_around(reinterpret_cast<std::uintptr_t>(begin), bytes, page_size());
  if (range.bytes > 0) madvise(reinterpret_cast<void*>(range.first), range.bytes, MADV_POPULATE_WRITE);
#else
  static_cast<void>(begin);
  static_cast<void>(bytes);
#endif
}

bool can_reserve(std::size_t bytes) {
  char* const p = map_pages(bytes);
  if (p != nullptr) release_pages(p, bytes);
  return p != nullptr;
}

void* allocate_column(std::size_t bytes) {
  if (bytes >= kLargePiece) return reserve_pages(whole_pages(bytes));
  return ::operator new (bytes, std::align_val_t{kAlignment});
}

void free_column(void* storage, std::size_t bytes) {
  if (storage == nullptr) return;
  if (bytes >= kLargePiece) return release_pages(storage, whole_pages(bytes));
  ::operator delete (storage, std::align_val_t{kAlignment});
}

}  // namespace oktett
