#include "core/pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

namespace oktett {
namespace {

constexpr std::size_t kPage = 4096;

/// Null if the system refuses.
char* map_pages(std::size_t bytes) {
  void* const p =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return p == MAP_FAILED ? nullptr : static_cast<char*>(p);
}

/// Address space that begins at a multiple of kHugePage, or null. What was reserved around it is given back.
char* map_huge_pages(std::size_t bytes) {
  const std::size_t all = (bytes + kPage - 1) / kPage * kPage + kHugePage;
  char* const reserved = all > bytes ? map_pages(all) : nullptr;
  if (reserved == nullptr) return nullptr;
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(reserved) % kHugePage;
  const std::size_t after = kHugePage - before;  // at least a page, as `before` is below kHugePage
  if (before > 0) release_pages(reserved, before);
  release_pages(reserved + all - after, after);
  return reserved + before;
}

}  // namespace

std::size_t whole_pages(std::size_t bytes) {
  if (bytes > ~kHugePage) return bytes;
  const std::size_t huge = bytes / kHugePage * kHugePage, rest = bytes - huge;
  if (rest >= kHugePage / 2) return huge + kHugePage;
  return huge + (rest + kPage - 1) / kPage * kPage;
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
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + kPage - 1) / kPage * kPage, end = (address + bytes) / kPage * kPage;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

bool can_reserve(std::size_t bytes) {
  char* const p = map_pages(bytes);
  if (p != nullptr) release_pages(p, bytes);
  return p != nullptr;
}

}  // namespace oktett
