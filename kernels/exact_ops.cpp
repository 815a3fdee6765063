#include "kernels/exact_ops.h"

#include <cstdlib>

namespace oktett {

// Each is defined in a source file that the build makes of kernels/exact_surface.cpp.in.
#define SURFACE(Type, name) extern const ExactOps name##_ops;
#include "kernels/exact/surfaces.def"
#undef SURFACE

// Here, so that no unit of a wider instruction set defines it.
ExactPoolBase::~ExactPoolBase() = default;

const ExactOps& exact_ops(Kind kind) {
  switch (kind) {
#define SURFACE(Type, name) \
  case Kind::name:          \
    return name##_ops;
#include "kernels/exact/surfaces.def"
#undef SURFACE
    default:
      std::abort();
  }
}

Kind kind_of(const ExactForm& form) {
  static constexpr Kind kinds[] = {
#define SURFACE(Type, name) Kind::name,
#include "kernels/exact/surfaces.def"
#undef SURFACE
  };
  return kinds[form.index()];
}

}  // namespace oktett
