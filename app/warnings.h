#pragma once
/// \file Warnings on stderr.

#include <cstddef>
#include <vector>

#include "core/error.h"

namespace oktett {

/// Prints the first `most` warnings to stderr, and the number of the others.
void print_warnings(const std::vector<Warning>& warnings, std::size_t most = 20);

}  // namespace oktett
