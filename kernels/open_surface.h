#pragma once
/// \file Which exact surfaces are open.

#include "kernels/exact_form.h"

namespace oktett {

/// Whether parts of the surface's boundary are missing, so that it has no inside.
bool is_open(const ExactShape& shape);

}  // namespace oktett
