#pragma once
/// \file The instruction sets a program can choose among at run time.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oktett {

/// Instruction sets that hot code is compiled for, those of one processor from the narrowest to the widest.
/// Every query gives the same bits with each of them; only the speed differs.
enum class Isa {
  scalar,  ///< no vector instructions
  sse42,   ///< SSE4.2, 4 floats at a time
  avx2,    ///< AVX2 with FMA, 8 floats at a time
  avx512,  ///< AVX-512 F, CD, DQ, BW and VL, 16 floats at a time
  neon,    ///< NEON of 64-bit ARM, 4 floats at a time, with fused multiply-add
};

/// "scalar", "sse4.2", "avx2", "avx512", "neon".
const char* to_string(Isa isa);
/// The instruction set called `name` (as printed by to_string), or nothing.
std::optional<Isa> parse_isa(std::string_view name);
/// Those that this processor has and this build holds code for, narrowest first; `scalar` is always among
/// them.
std::vector<Isa> available_isas();
/// The instruction set that queries use unless told otherwise: choose_isa("auto"). It is determined by the
/// first call and stays the same from then on. Throws Error as choose_isa does.
Isa default_isa();
/// The set called `name`. For "auto" and "" it is the set that the environment variable OKTETT_ISA names, or,
/// if that is not set, empty or "auto", the widest available. Throws Error for an unknown or unavailable set.
Isa choose_isa(const std::string& name);

}  // namespace oktett
