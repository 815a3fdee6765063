#include "core/pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

namespace oktett {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kLargePage = std::size_t{2} << 20;

/// Null if the system refuses.
char* map_pages(std::size_t bytes) {
  void* const p =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return p == MAP_FAILED ? nullptr : static_cast<char*>(p);
}

/// Address space that begins at a multiple of kLargePage, or null.
char* map_large_pages(std::size_t bytes) {
  const std::size_t all = (bytes + kPage - 1) / kPage * kPage + kLargePage;
  char* const reserved = all > bytes ? map_pages(all) : nullptr;
  if (reserved == nullptr) return nullptr;
  // What lies around it is given back.
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(reserved) % kLargePage;
  const std::size_t after = kLargePage - before;
  if (before > 0) release_pages(reserved, before);
  if (after > 0) release_pages(reserved + all - after, after);
  return reserved + before;
}

}  // namespace

void* reserve_pages(std::size_t bytes) {
  const bool large = bytes >= kLargePiece;
  char* const pages = large ? map_large_pages(bytes) : map_pages(bytes);
  if (pages == nullptr) throw std::bad_alloc();
  // A request: where the system has no large pages left, it takes small ones.
  if (large) madvise(pages, bytes, MADV_HUGEPAGE);
  return pages;
}

void release_pages(void* begin, std::size_t bytes) { munmap(begin, bytes); }

bool can_reserve(std::size_t bytes) {
  char* const p = map_pages(bytes);
  if (p != nullptr) release_pages(p, bytes);
  return p != nullptr;
}

}  // namespace oktett
