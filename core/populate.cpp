#include "core/populate.h"

#include <sys/mman.h>

#include <cstdint>

namespace oktett {

void populate_pages(void* begin, std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  constexpr std::uintptr_t kPage = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(begin), end = address + bytes;
  const std::uintptr_t first = address / kPage * kPage;
  if (bytes > 0)
    madvise(reinterpret_cast<void*>(first), (end - first + kPage - 1) / kPage * kPage, MADV_POPULATE_WRITE);
#else
  static_cast<void>(begin), static_cast<void>(bytes);
#endif
}

}  // namespace oktett
