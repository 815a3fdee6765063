#include "core/isa.h"

#include <cstdlib>

#include "core/error.h"

namespace oktett {

static constexpr Isa kAll[] = {Isa::scalar, Isa::sse42, Isa::avx2, Isa::avx512, Isa::neon};

const char* to_string(Isa isa) {
  constexpr const char* kNames[] = {"scalar", "sse4.2", "avx2", "avx512", "neon"};
  return kNames[static_cast<int>(isa)];
}

std::optional<Isa> parse_isa(std::string_view name) {
  for (Isa isa : kAll)
    if (name == to_string(isa)) return isa;
  return std::nullopt;
}

/// True if this build has code for the set (see OKTETT_INSTRUCTION_SETS) and this processor can run it.
static bool is_available(Isa isa) {
  switch (isa) {
    case Isa::scalar:
      return true;
#if defined(OKTETT_WITH_SSE42)
    case Isa::sse42:
      return __builtin_cpu_supports("sse4.2");
#endif
#if defined(OKTETT_WITH_AVX2)
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
             __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
             __builtin_cpu_supports("popcnt");
#endif
#if defined(OKTETT_WITH_AVX512)
    case Isa::avx512:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
             __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
             __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
#if defined(OKTETT_WITH_NEON)
    case Isa::neon:
      return true;  // Every 64-bit ARM processor that runs Linux has it.
#endif
    default:
      return false;
  }
}

std::vector<Isa> available_isas() {
  std::vector<Isa> isas;
  for (Isa isa : kAll)
    if (is_available(isa)) isas.push_back(isa);
  return isas;
}

static std::string available_names() {
  std::string names;
  for (Isa isa : available_isas()) names += std::string(names.empty() ? "" : ", ") + to_string(isa);
  return names;
}

static Isa require(const std::string& name, const std::string& source) {
  const std::optional<Isa> isa = parse_isa(name);
  if (!isa) {
    std::vector<std::string> known{"auto"};
    for (const Isa available : available_isas()) known.emplace_back(to_string(available));
    throw Error(source + ": unknown instruction set '" + name + "'" +
                did_you_mean(name, known, "this machine has " + available_names()));
  }
  if (!is_available(*isa))
    throw Error(source + ": this machine does not have '" + name + "'; it has " + available_names());
  return *isa;
}

static bool is_automatic(std::string_view name) { return name.empty() || name == "auto"; }

Isa choose_isa(const std::string& name) {
  if (!is_automatic(name)) return require(name, "--isa");
  const char* variable = std::getenv("OKTETT_ISA");
  if (variable != nullptr && !is_automatic(variable)) return require(variable, "OKTETT_ISA");
  return available_isas().back();
}

Isa default_isa() {
  static const Isa isa = choose_isa("auto");
  return isa;
}

}  // namespace oktett
