#include "kernels/exact/exact_pool.h"

namespace oktett {

ExactPoolBase::~ExactPoolBase() = default;

}  // namespace oktett
