#pragma once

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace oktett {

/// The sum of the tallies of `count` numbered cases from `first` on, which run in parallel and are added in
/// their order. `run(tally)` runs the case whose number is `tally.*number`; `add(sum, tally)` adds one. A
/// failure is led by `name` and the number of its case.
template <class Tally, class Run>
Tally run_cases(std::size_t count, std::uint64_t first, std::uint64_t Tally::*number, const char* name,
                const Run& run, void (*add)(Tally&, const Tally&)) {
  std::vector<Tally> tallies(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    Tally& tally = tallies[k];
    tally.*number = first + k;
    run(tally);
    if (!tally.failure.empty()) tally.failure = fmt::format("{} {}: {}", name, tally.*number, tally.failure);
  });
  Tally sum;
  for (const Tally& tally : tallies) add(sum, tally);
  return sum;
}

}  // namespace oktett
