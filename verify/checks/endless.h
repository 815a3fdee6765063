#pragma once
/// \file Verification for as long as there is time: rounds of new random cases of everything.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/isa.h"

namespace oktett {

struct EndlessOptions {
  double seconds = 60;
  std::uint64_t seed = 1;  ///< all cases of a run follow from it and the instruction sets
  std::vector<Isa> isas;
  std::string folder = ".";        ///< where findings are saved
  std::size_t most_findings = 20;  ///< that are saved
};

/// What of one family has been checked.
struct CoverageRow {
  std::string family;
  std::string unit;  ///< what `covered` counts, e.g. "kernels x classes"
  std::size_t covered = 0, of = 0;
  std::uint64_t cases = 0;  ///< shapes, trees, scenes or polynomials
  std::uint64_t rays = 0;
  std::uint64_t wrong = 0;  ///< checks with a failure
};

struct Coverage {
  double seconds = 0;
  std::uint64_t rounds = 0;  ///< that are complete
  std::vector<CoverageRow> rows;
  std::vector<std::string> findings;  ///< paths of the files

  std::uint64_t rays() const;
  std::uint64_t wrong() const;
};

/// Called about once a minute, and with the path and the text of each finding.
struct EndlessReport {
  std::function<void(const Coverage&)> progress;
  std::function<void(const std::string& path, const std::string& what)> finding;
};

/// Checks rounds of cases until the time is over: single kernels, random scenes, exact surfaces,
/// combinations, changes, scenes with time, closed meshes and root finders. The first round is small and
/// holds something of everything. Which cases come is a function of the seed; how many, of the time. Throws
/// Error if a finding cannot be saved.
Coverage verify_endless(const EndlessOptions& options, const EndlessReport& report);

}  // namespace oktett
