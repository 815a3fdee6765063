#include "kernels/exact/march.h"

#include <atomic>

namespace oktett::interval {

static std::atomic<std::uint64_t> uncertified{0};

void count_uncertified(int rays) { uncertified += static_cast<std::uint64_t>(rays); }
std::uint64_t uncertified_count() { return uncertified; }

}  // namespace oktett::interval
