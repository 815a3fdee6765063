#pragma once
/// \file The ways of building a tree that the comparison measures.

#include <string>
#include <vector>

#include "accel/accel.h"

namespace oktett::bench {

struct BuildVariant {
  std::string name;
  BuildOptions options;
};

/// The first is Oktett's default.
const std::vector<BuildVariant>& build_variants();

/// The variant called `name`, the first for an empty name. Throws Error if there is none.
const BuildVariant& find_variant(const std::string& name);

}  // namespace oktett::bench
