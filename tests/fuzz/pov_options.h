#pragma once
/// \file How scenes in POV-Ray's language are read where they are fuzzed.

#include "io/pov/read_pov.h"

namespace oktett::test {

/// Without the includes of this system, and with limits that one input reaches in milliseconds.
inline pov::ReadOptions small_pov_options() {
  pov::ReadOptions options;
  options.library_folders.clear();
  options.limits.steps = 20'000;
  options.limits.values = 100'000;
  options.limits.array_elements = 10'000;
  options.limits.string_length = 10'000;
  options.limits.macro_depth = 200;
  options.limits.nesting = 100;
  return options;
}

}  // namespace oktett::test
