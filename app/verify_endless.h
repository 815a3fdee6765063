#pragma once
/// \file `oktett verify --hours` and `--replay`.

#include <cstdint>
#include <string>
#include <vector>

#include "core/isa.h"

namespace oktett {

struct EndlessArguments {
  std::string hours;   ///< as it was typed; empty: not asked for
  std::string replay;  ///< the file of a finding; empty: not asked for
  std::string findings = ".";
  std::uint64_t seed = 1;
  bool json = false;
};

// Each returns true if all is well. They throw Error for bad arguments, before any work.
bool run_endless(const EndlessArguments& arguments, const std::vector<Isa>& isas);
bool run_replay(const EndlessArguments& arguments, const std::vector<Isa>& isas);

}  // namespace oktett
