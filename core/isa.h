#pragma once
/// \file The instruction sets a program can choose among at run time.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oktett {

/// Ordered from the narrowest to the widest.
enum class Isa { scalar, sse42, avx2, avx512 };

/// "scalar", "sse4.2", "avx2", "avx512".
const char* to_string(Isa isa);
/// The instruction set called `name` (as printed by to_string), or nothing.
std::optional<Isa> parse_isa(std::string_view name);
/// Those that this processor has and this build holds code for, narrowest first; `scalar` is always among
/// them.
std::vector<Isa> available_isas();
/// The choice of the environment variable OKTETT_ISA if it is set ("auto" or empty count as not set), else
/// the widest available. Throws Error if the variable names an unknown or unavailable set.
Isa default_isa();
/// Resolves a user's word: "auto" or "" gives default_isa(). Throws Error for an unknown or unavailable set.
Isa choose_isa(const std::string& name);

}  // namespace oktett
