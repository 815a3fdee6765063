#pragma once
/// \file The one way from an instruction set chosen at run time to code that was compiled for it.
///
/// A layer compiles such code as templates over the set, in units of its folder `isa/`, and reaches it
/// through a table of functions: `template <class A> const XCode& x_code();` is defined for each set in those
/// units only. `const XCode& x_code(Isa)` is defined in the layer's isa_tables.cpp. Only these files and
/// core/isa.cpp are told which sets the build holds (cmake/instruction_sets.cmake), so that a longer list
/// recompiles nothing else.

#include "core/error.h"
#include "core/isa.h"

namespace oktett {

struct ScalarIsa;
struct Sse42Isa;
struct Avx2Isa;
struct Avx512Isa;
struct NeonIsa;

/// Calls f.operator()<A>() for the set `isa`. Throws Error if this build holds no code for it.
template <class Function>
decltype(auto) with_isa(Isa isa, Function&& f) {
  switch (isa) {
#if defined(OKTETT_WITH_SSE42)
    case Isa::sse42:
      return f.template operator()<Sse42Isa>();
#endif
#if defined(OKTETT_WITH_AVX2)
    case Isa::avx2:
      return f.template operator()<Avx2Isa>();
#endif
#if defined(OKTETT_WITH_AVX512)
    case Isa::avx512:
      return f.template operator()<Avx512Isa>();
#endif
#if defined(OKTETT_WITH_NEON)
    case Isa::neon:
      return f.template operator()<NeonIsa>();
#endif
    case Isa::scalar:
      return f.template operator()<ScalarIsa>();
    default:
      throw Error(std::string("this build holds no code for ") + to_string(isa));
  }
}

}  // namespace oktett
