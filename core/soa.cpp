#include "core/soa.h"

#include <new>

#include "core/pages.h"

namespace oktett {

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
