#pragma once
/// \file A function as a list of values, each computed once from values before it: the form in which a tape
/// is made and cut down. It has no registers, so that a value may be left out without moving others.

#include <span>

#include "core/mesh.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

/// A value, and the numbers in the list of the values that it is computed from. The first three values of a
/// list are x, y and z, which are not computed. A sine and a cosine are values of their own; sin_cos does not
/// occur.
struct TapeValue {
  TapeOp op = TapeOp::constant;
  std::uint32_t a = kNoId, b = kNoId;
  int n = 0;
  double c = 0;
};

/// A tape that computes value number `root`, without the values that it does not need. Throws Error if it is
/// too long or needs too many registers.
FunctionTape write_tape(std::span<const TapeValue> values, std::uint32_t root);

/// The values of a tape, one or two for each step.
struct TapeValues {
  std::vector<TapeValue> list;
  std::uint32_t root = 0;
};
TapeValues values_of(const FunctionTape& tape);

}  // namespace oktett
