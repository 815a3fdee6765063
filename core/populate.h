#pragma once
/// \file Memory that is about to be written.

#include <cstddef>

namespace oktett {

/// Has the system allocate all pages of these `bytes` bytes, which the caller is going to write. One call for
/// many pages costs a fraction of the page faults that writing them causes. Their contents are kept.
/// Does nothing where the system cannot do so (Linux can since version 5.14).
void populate_pages(void* begin, std::size_t bytes);

}  // namespace oktett
