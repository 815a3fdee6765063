#pragma once
/// \file The queries of accel/point_query.h as they are compiled for each instruction set, in accel/isa.

#include "accel/closest.h"
#include "core/isa.h"

namespace oktett {

struct PointCode {
  /// The nearest surface of each point.
  void (*closest)(const Accel&, const PointSpan& points, Nearest* nearest);
};

template <class A>
const PointCode& point_code();

/// Throws Error if this build holds no code for the set.
const PointCode& point_code(Isa isa);

}  // namespace oktett
