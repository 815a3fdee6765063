#include "io/pov/noise_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/precise_math.h"
#include "io/pov/formula_text.h"
#include "kernels/functions/expression.h"

namespace oktett::pov {
namespace {

using Operands = std::vector<std::string>;
using Text = std::optional<std::string>;

constexpr int kMostOctaves = 30;

Text unit_noise(const Operands& o, NoiseGenerator generator) {
  return noise_formula(generator, o[0], o[1], o[2]);
}

/// How the octaves of a sum differ. Nothing if a number that says so is none here.
struct Octaves {
  int count = 1;
  double finer = 2;  ///< of each to the one before

  static std::optional<Octaves> of(const std::string& count, const std::string& finer) {
    const std::optional<double> number = constant(count), factor = constant(finer);
    if (!number || !factor || !(*factor > 0) || !(std::abs(*number) < kMostOctaves)) return std::nullopt;
    return Octaves{std::max(1, static_cast<int>(*number)), *factor};
  }
};

/// Noise from 0 to 1 at the place, which is `scale` times as far from the origin.
std::string noise_at(const Operands& o, double scale, NoiseGenerator generator) {
  const auto finer = [&](const std::string& x) { return filled("$0 * $1", {x, fmt::format("{}", scale)}); };
  return noise_formula(generator, finer(o[0]), finer(o[1]), finer(o[2]));
}
/// The same from -1 to 1.
std::string signed_noise_at(const Operands& o, double scale, NoiseGenerator generator) {
  return filled("2 * $0 - 1", {noise_at(o, scale, generator)});
}

/// f_ridged_mf: a ridged multifractal (F. K. Musgrave in D. Ebert et al.: Texturing and modeling), of the
/// exponent $3, the lacunarity $4, $5 octaves, the offset $6 and the gain $7.
Text ridged(const Operands& o, NoiseGenerator generator) {
  const std::optional<Octaves> octaves = Octaves::of(o[5], o[4]);
  const std::optional<double> exponent = constant(o[3]);
  if (!octaves || !exponent) return std::nullopt;
  std::string sum, signal;
  double scale = 1;
  for (int k = 0; k < octaves->count; ++k, scale *= octaves->finer) {
    const std::string own = filled("($0 - abs($1))^2", {o[6], signed_noise_at(o, scale, generator)});
    // Where the octave before is low, so is this one.
    signal = k == 0 ? own : filled("$0 * max(0, min(1, $1 * $2))", {own, signal, o[7]});
    const double weight = precise::pow(scale, -*exponent);
    if (!std::isfinite(weight) || !std::isfinite(scale)) return std::nullopt;
    sum += fmt::format("{}{} * {}", k == 0 ? "" : " + ", signal, weight);
    // Texts that are too long are refused in any case.
    if (sum.size() > kMaxExpressionLength) return sum;
  }
  return '(' + sum + ')';
}

/// f_ridge: octaves, each $3 times finer and $5 times as strong as the one before, of which there are $4, of
/// how far noise between 0 and 1 is from $7, brought into 0 to 1, and then how far that is from $6, brought
/// into -1 to 1.
Text ridge(const Operands& o, NoiseGenerator generator) {
  const std::optional<Octaves> octaves = Octaves::of(o[4], o[3]);
  const std::optional<double> omega = constant(o[5]);
  if (!octaves || !omega) return std::nullopt;
  std::string sum;
  double scale = 1, weight = 1, weights = 0;
  for (int k = 0; k < octaves->count; ++k, scale *= octaves->finer, weight *= *omega) {
    const std::string far = filled("abs($0 - $1) / max($1, 1 - $1)", {noise_at(o, scale, generator), o[7]});
    sum += fmt::format("{}{} * {}", k == 0 ? "" : " + ", filled("($0 - $1) / max($1, 1 - $1)", {far, o[6]}),
                       filled("$0", {fmt::format("{}", weight)}));
    weights += weight;
    if (!std::isfinite(scale) || !(weights > 0)) return std::nullopt;
    if (sum.size() > kMaxExpressionLength) return sum;
  }
  return fmt::format("(({}) / {})", sum, weights);
}

/// f_hetero_mf: a heterogeneous multifractal (Musgrave, as above) of the exponent $3, the lacunarity $4, $5
/// octaves and the offset $6: each octave counts times the power $7 of the sum before it.
Text hetero(const Operands& o, NoiseGenerator generator) {
  const std::optional<Octaves> octaves = Octaves::of(o[5], o[4]);
  const std::optional<double> exponent = constant(o[3]), power = constant(o[7]);
  if (!octaves || !exponent || !power) return std::nullopt;
  std::string sum = filled("$0 + $1", {signed_noise_at(o, 1, generator), o[6]});
  double scale = octaves->finer;
  for (int k = 1; k < octaves->count; ++k, scale *= octaves->finer) {
    const double weight = precise::pow(scale, -*exponent);
    if (!std::isfinite(weight) || !std::isfinite(scale)) return std::nullopt;
    const std::string more =
        filled("($0 + $1) * $2", {signed_noise_at(o, scale, generator), o[6], fmt::format("{}", weight)});
    const double whole = std::trunc(*power);
    if (whole < 1)
      sum = filled("$0 + $1", {sum, more});
    else if (whole < 2)
      sum = filled("$0 * (1 + $1)", {sum, more});
    else
      sum = filled("$0 + $1 * ($0)^$2", {sum, more, fmt::format("{}", whole)});
    if (sum.size() > kMaxExpressionLength) return sum;
  }
  return sum;
}

}  // namespace

std::string noise_formula(NoiseGenerator generator, const std::string& x, const std::string& y,
                          const std::string& z) {
  if (generator == NoiseGenerator::povray_1)
    return filled("max(0, min(1, 0.5 + povray_noise($0, $1, $2)))", {x, y, z});
  if (generator == NoiseGenerator::povray_2)
    return filled("max(0, min(1, 0.48985582 * (1.05242 + povray_noise($0, $1, $2))))", {x, y, z});
  return filled("0.5 + 0.5 * noise($0, $1, $2)", {x, y, z});
}

std::optional<std::string> noise_text(std::uint32_t number, const std::vector<std::string>& operands,
                                      NoiseGenerator generator) {
  struct Noise {
    std::uint32_t number;
    std::size_t operands;
    Text (*text)(const Operands&, NoiseGenerator);
  };
  constexpr Noise kNoises[] = {{29, 9, hetero},
                               {58, 9, ridge},
                               {59, 9, ridged},
                               {kNoiseFunction, 3, unit_noise},
                               {kNoiseGeneratorFunction, 4, unit_noise}};
  for (const Noise& noise : kNoises) {
    if (noise.number != number) continue;
    if (operands.size() < noise.operands) return std::nullopt;
    // The last operand of all but f_noise3d chooses the generator.
    if (number != kNoiseFunction) {
      const std::optional<double> chosen = constant(operands[noise.operands - 1]);
      if (!chosen) return std::nullopt;
      generator = noise_generator_named(*chosen);
    }
    return noise.text(operands, generator);
  }
  return std::nullopt;
}

}  // namespace oktett::pov
