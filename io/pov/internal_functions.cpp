#include "io/pov/internal_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "io/pov/formula_text.h"
#include "io/pov/noise_functions.h"
#include "io/pov/winding_functions.h"
#include "kernels/functions/expression.h"

namespace oktett::pov {
namespace {

/// How a function is written. $0, $1, ... are its operands: x, y and z, and what follows them.
struct Internal {
  std::uint32_t number;
  std::size_t operands;
  const char* text;
  /// Greatest value: of surfaces with a field strength, $3.
  double limit = std::numeric_limits<double>::infinity();
  /// A curve in the plane of x and y. Its last three operands say whether it is turned about the y axis, by
  /// how much it is moved away from it before, and by how many degrees it is turned in its plane.
  bool curve = false;
};

// Curves and surfaces of algebra have the equations under which they are known, such as those of Boy's
// surface after Apery, with the constants and signs that the values of POV-Ray 3.7 show.
constexpr double kField = 10;
constexpr Internal kInternal[] = {
    // f_algbr_cyl1, 2, 3 and 4
    {0, 8, "$3 * ($1^2 + abs($0)^3 - $0^2)", kField, true},
    {1, 8, "-$3 * (2 * $0^4 - 3 * $0^2 * $1 + $1^2 - 2 * $1^3 + $1^4)", kField, true},
    {2, 8, "-$3 * ($0^4 + $0^2 * $1^2 - 2 * $0^2 * $1 - $0 * $1^2 + $1^2)", kField, true},
    {3, 8, "-$3 * (($0^2 + $1^2)^2 + 3 * $0^2 * $1 - $1^3)", kField, true},
    // f_bicorn, f_bifolia, f_blob, f_blob2
    {4, 5, "-$3 * (($0^2 + $2^2 + 2 * $4 * $1 - $4^2)^2 - $1^2 * ($4^2 - $0^2 - $2^2))", kField},
    {5, 5, "-$3 * (($0^2 + $1^2 + $2^2)^2 - $4 * ($0^2 + $2^2) * $1)", kField},
    {6, 8,
     "-$4 * max(0, 1 - $5^2 * (($0 + $3 / 2)^2 + $1^2 + $2^2))^2 - "
     "$6 * max(0, 1 - $7^2 * (($0 - $3 / 2)^2 + $1^2 + $2^2))^2"},
    {7, 7, "$6 - $5 * (exp(-$4 * ($0^2 + $1^2 + $2^2)) + exp(-$4 * (($0 - $3)^2 + $1^2 + $2^2)))"},
    // f_boy_surface
    {8, 5,
     "$3 * $4 * (64 * (1 - $2)^3 * $2^3 - 48 * (1 - $2)^2 * $2^2 * (3 * $0^2 + 3 * $1^2 + 2 * $2^2) + "
     "12 * (1 - $2) * $2 * (27 * ($0^2 + $1^2)^2 - 24 * $2^2 * ($0^2 + $1^2) + "
     "36 * sqrt(2) * $1 * $2 * ($1^2 - 3 * $0^2) + 4 * $2^4) + (9 * $0^2 + 9 * $1^2 - 2 * $2^2) * "
     "(-81 * ($0^2 + $1^2)^2 - 72 * $2^2 * ($0^2 + $1^2) + 108 * sqrt(2) * $0 * $2 * ($0^2 - 3 * $1^2) + "
     "4 * $2^4))",
     kField},
    // f_comma: a ball, and half a ring that becomes thinner
    {9, 4,
     "min(sqrt(($0 - $3 / 2)^2 + $1^2 + $2^2) - $3 / 2, max(hypot(hypot($0 + $3 / 4, $2) - 0.75 * $3, $1) - "
     "$3 / 2 * cos(atan2($2, $0) / 2), -$2))"},
    // f_cross_ellipsoids, whose three ellipsoids are joined
    {10, 7,
     "$6 - $5 * exp(-$4 * min($0^2 + $3 * ($1^2 + $2^2), $1^2 + $3 * ($0^2 + $2^2), "
     "$2^2 + $3 * ($0^2 + $1^2)))"},
    // f_crossed_trough, f_cubic_saddle, f_cushion, f_devils_curve and f_devils_curve_2d
    {11, 4, "$3 * ($0^2 * $2^2 - $1)", kField},
    {12, 4, "-$3 * ($0^3 - $1^3 - $2)", kField},
    {13, 4,
     "$3 * ($2^2 * $0^2 - $2^4 - 2 * $2 * $0^2 + 2 * $2^3 + $0^2 - $2^2 - ($0^2 - $2)^2 - $1^4 - "
     "2 * $0^2 * $1^2 - $1^2 * $2^2 + 2 * $1^2 * $2 + $1^2)",
     kField},
    {14, 4, "-$3 * ($0^4 + 2 * $0^2 * $2^2 - 0.36 * $0^2 - $1^4 + 0.25 * $1^2 + $2^4)", kField},
    {15, 9, "-$3 * ($0^4 - $4^2 * $0^2 - $1^4 + $5^2 * $1^2)", kField, true},
    // f_dupin_cyclid: a torus seen in a sphere about the origin
    {16, 9,
     "-$3 * (($8^4 - 2 * $8^2 * ($6 * $0 + $7 * $1) + ($6^2 + $7^2 + $4^2 - $5^2) * ($0^2 + $1^2 + $2^2))^2 "
     "- "
     "4 * $4^2 * (($8^2 * $0 - $6 * ($0^2 + $1^2 + $2^2))^2 + $8^4 * $2^2))",
     kField},
    // f_ellipsoid
    {17, 6, "sqrt(($3 * $0)^2 + ($4 * $1)^2 + ($5 * $2)^2)"},
    // f_enneper, without its constants, and with a z of at least 0.2 in the denominators
    {18, 4,
     "$3 * (6 * (($1^2 - $0^2) / (4 * (0.2 + ($2 - 0.2) * max(0, sign(abs($2) - 0.2)))))^2 - "
     "(($1^2 - $0^2) / (2 * (0.2 + ($2 - 0.2) * max(0, sign(abs($2) - 0.2)))) + 2 / 9 * $2^2)^3)",
     kField},
    // f_flange_cover
    {19, 7,
     "$6 - $5 * (exp(-$4 * ($0^2 + $3 * ($1^2 + $2^2))) + exp(-$4 * ($1^2 + $3 * ($0^2 + $2^2))) + "
     "exp(-$4 * ($2^2 + $3 * ($0^2 + $1^2))))"},
    // f_folium_surface and f_folium_surface_2d, f_glob, f_heart
    {20, 6, "$3 * (($1^2 + $2^2) * (1 + ($5 - 4 * $4) * $0) + ($5 + 1) * $0^2)", kField},
    {21, 9, "-$3 * ($1^2 * (1 + ($5 - 4 * $4) * $0) + ($5 + 1) * $0^2)", kField, true},
    {22, 4, "$3 * (0.5 * $0^5 + 0.5 * $0^4 - $1^2 - $2^2)", kField},
    {23, 4, "-$3 * ((2 * $0^2 + $1^2 + $2^2 - 1)^3 - 0.1 * $0^2 * $2^3 - $1^2 * $2^3)", kField},
    // f_hunt_surface, f_hyperbolic_torus
    {30, 4, "-$3 * (4 * ($0^2 + $1^2 + $2^2 - 13)^3 + 27 * (3 * $0^2 + $1^2 - 4 * $2^2 - 12)^2)", kField},
    {31, 6,
     "-$3 * ($0^4 + 2 * $0^2 * $1^2 - 2 * $0^2 * $2^2 - 2 * ($4^2 + $5^2) * $0^2 + $1^4 - 2 * $1^2 * $2^2 + "
     "2 * ($4^2 - $5^2) * $1^2 + $2^4 + 2 * ($4^2 + $5^2) * $2^2 + ($4^2 - $5^2)^2)",
     kField},
    // f_isect_ellipsoids, whose three ellipsoids intersect
    {32, 7,
     "$6 - $5 * exp(-$4 * max($0^2 + $3 * ($1^2 + $2^2), $1^2 + $3 * ($0^2 + $2^2), "
     "$2^2 + $3 * ($0^2 + $1^2)))"},
    // f_kampyle_of_eudoxus and f_kampyle_of_eudoxus_2d, f_klein_bottle, f_kummer_surface_v1 and _v2
    {33, 6, "-$3 * ($1^2 + $2^2 - $5^2 * $0^4 + $4^2 * $5^2 * $0^2)", kField},
    {34, 9, "-$3 * ($1^2 - $5^2 * $0^4 + $4 * $5^3 * $0^2)", kField, true},
    {35, 4,
     "-$3 * (($0^2 + $1^2 + $2^2 + 2 * $1 - 1) * (($0^2 + $1^2 + $2^2 - 2 * $1 - 1)^2 - 8 * $2^2) + "
     "16 * $0 * $2 * ($0^2 + $1^2 + $2^2 - 2 * $1 - 1))",
     kField},
    {36, 4, "-$3 * ($0^4 + $1^4 + $2^4 - $0^2 - $1^2 - $2^2 - $0^2 * $1^2 - $0^2 * $2^2 - $1^2 * $2^2 + 1)",
     kField},
    {37, 7,
     "-$3 * ($0^4 + $1^4 + $2^4 - 1 + $4 * ($0^2 + $1^2 + $2^2) + "
     "$5 * ($0^2 * $1^2 + $0^2 * $2^2 + $1^2 * $2^2) + $6 * $0 * $1 * $2)",
     kField},
    // f_lemniscate_of_gerono and f_lemniscate_of_gerono_2d, f_mitre, f_nodal_cubic, f_odd, f_ovals_of_cassini
    {38, 4, "-$3 * ($0^4 - $0^2 + $1^2 + $2^2)", kField},
    {39, 9, "-$3 * ($1^2 + $5^2 * $0^4 - $4^2 * $5^2 * $0^2)", kField, true},
    {41, 4, "-$3 * (4 * $0^2 * ($0^2 + $1^2 + $2^2) - $1^2 * (1 - $1^2 - $2^2))", kField},
    {42, 4, "-$3 * ($1^3 + $2^3 - 6 * $1 * $2)", kField},
    {43, 4,
     "-$3 * ($0^4 + 2 * $0^2 * $1^2 - $0^2 * $2^2 - $0^2 + $1^4 + $1^2 * $2^2 - 2 * $1^2 * $2 - $1^2 + $2^4 "
     "- "
     "2 * $2^3 + 2 * $2^2)",
     kField},
    {44, 7, "-$3 * (($0^2 + $1^2 + $2^2 + $4^2)^2 - $6 * $4^2 * ($0^2 + $2^2) - $5^2)", kField},
    // f_paraboloid, f_parabolic_torus, f_ph, f_pillow, f_piriform and f_piriform_2d, f_poly4
    {45, 4, "-$3 * ($0^2 - $1 + $2^2)", kField},
    {46, 6,
     "-$3 * ($0^4 + 2 * $0^2 * $1^2 - 2 * $0^2 * $2 - ($4^2 + $5^2) * $0^2 + $1^4 - 2 * $1^2 * $2 + "
     "($4^2 - $5^2) * $1^2 + $2^2 + ($4^2 + $5^2) * $2 + ($4^2 - $5^2)^2)",
     kField},
    {47, 3, "atan2(hypot($0, $2), $1)"},
    {48, 4, "$3 * ($0^4 + $1^4 + $2^4 - $0^2 - $1^2 - $2^2)", kField},
    {49, 4, "$3 * ($0^4 - $0^3 + $1^2 + $2^2)", kField},
    {50, 10, "-$3 * ($1^2 - $6^2 * $0^3 * ($4 + $5 * $0))", kField, true},
    {51, 8, "hypot($0, $2) - ($3 + $4 * $1 + $5 * $1^2 + $6 * $1^3 + $7 * $1^4)"},
    // f_quantum: the density of the orbital 3 d z^2 of hydrogen about y
    {53, 3, "1.2 - 1.6 * (2 * $1^2 - $0^2 - $2^2)^2 * exp(-4 / 3 * sqrt($0^2 + $1^2 + $2^2))"},
    // f_quartic_paraboloid, f_quartic_saddle, f_quartic_cylinder
    {54, 4, "-$3 * ($0^4 + $2^4 - $1)", kField},
    {55, 4, "-$3 * ($0^4 - $2^4 - $1)", kField},
    {56, 6, "-$3 * (($0^2 + $2^2) * $1^2 + $5^2 * ($0^2 + $2^2) - $4^2 * $5^2)", kField},
    // f_r, f_rounded_box, f_sphere, f_spikes, f_spikes_2d, f_steiners_roman
    {57, 3, "sqrt($0^2 + $1^2 + $2^2)"},
    {60, 7,
     "sqrt(max(0, abs($0) - $4 + $3)^2 + max(0, abs($1) - $5 + $3)^2 + max(0, abs($2) - $6 + $3)^2) - $3"},
    {61, 4, "sqrt($0^2 + $1^2 + $2^2) - $3"},
    {62, 8,
     "$5 * (exp(-$4 * ($0^2 + $3 * ($1^2 + $2^2))) + exp(-$4 * ($1^2 + $3 * ($0^2 + $2^2))) + "
     "exp(-$4 * ($2^2 + $3 * ($0^2 + $1^2))) - $7 * exp(-$6 * ($0^2 + $1^2 + $2^2)))"},
    {63, 7, "$1 - $3 * cos($4 * $0) * cos($5 * $2) * exp(-$6 * ($0^2 + $2^2))"},
    {65, 4, "-$3 * ($0^2 * $1^2 + $0^2 * $2^2 + $1^2 * $2^2 + $0 * $1 * $2)", kField},
    // f_strophoid and f_strophoid_2d, f_superellipsoid, f_th, f_torus, f_torus2
    {66, 7, "-$3 * (($5 - $0) * ($1^2 + $2^2) - $6^2 * $0^2 * ($4 + $0))", kField},
    {67, 10, "-$3 * (($5 - $0) * $1^2 - $6^2 * $0^2 * ($4 + $0))", kField, true},
    {68, 5,
     "1 - pow(pow(pow(abs($0), 2 / $3) + pow(abs($1), 2 / $3), $3 / $4) + pow(abs($2), 2 / $4), $4 / 2)"},
    {69, 3, "atan2($0, $2)"},
    {70, 5, "hypot(hypot($0, $2) - $3, $1) - $4"},
    {71, 6, "-$3 * (($0^2 + $1^2 + $2^2 + $4^2 - $5^2)^2 - 4 * $4^2 * ($0^2 + $2^2))", kField},
    // f_torus_gumdrop, f_umbrella, f_witch_of_agnesi and f_witch_of_agnesi_2d
    {72, 4,
     "-$3 * (4 * ($0^4 + ($1^2 + $2^2)^2) + 17 * $0^2 * ($1^2 + $2^2) - 20 * ($0^2 + $1^2 + $2^2) + 17)",
     kField},
    {73, 4, "-$3 * ($0^2 - $1 * $2^2)", kField},
    {74, 5, "-$3 * ($4 * ($1 - 1) + ($0^2 + $2^2) * $1)", kField},
    {75, 9, "-$3 * ($0^2 * $1 + $4^2 * $1 - $5)", kField, true},
};

const Internal* find(std::uint32_t number) {
  const auto* const found = std::ranges::find(kInternal, number, &Internal::number);
  return found != std::end(kInternal) ? found : nullptr;
}

}  // namespace

std::optional<std::string> internal_text(std::uint32_t number, const std::vector<std::string>& operands,
                                         NoiseGenerator generator) {
  if (std::optional<std::string> text = winding_text(number, operands)) return text;
  if (std::optional<std::string> text = noise_text(number, operands, generator)) return text;
  const Internal* const known = find(number);
  if (known == nullptr || operands.size() < known->operands) return std::nullopt;
  if (!known->curve) return filled(known->text, operands);
  const std::size_t last = known->operands - 1;
  const std::optional<double> turned = constant(operands[last - 2]);
  if (!turned) return std::nullopt;
  if (*turned == 0) return filled(known->text, operands);
  std::vector<std::string> o = operands;
  const std::string out = filled("hypot($0, $2) - $3", {o[0], o[1], o[2], o[last - 1]}), up = o[1];
  const std::string angle = filled("$0 * pi / 180", {o[last]});
  o[0] = filled("$0 * cos($2) - $1 * sin($2)", {out, up, angle});
  o[1] = filled("$0 * sin($2) + $1 * cos($2)", {out, up, angle});
  return filled(known->text, o);
}

std::optional<double> internal_value(std::uint32_t number, std::span<const double> operands) {
  std::vector<std::string> texts;
  const Internal* const known = find(number);
  for (const double operand : operands) {
    if (!std::isfinite(operand)) return known ? std::optional(std::nan("")) : std::nullopt;
    texts.push_back(fmt::format("{}", operand));
  }
  const std::optional<std::string> text = internal_text(number, texts, NoiseGenerator::povray_2);
  if (!text) return std::nullopt;
  double value = std::nan("");
  try {
    value = oktett::evaluate(parse_expression(*text));
  } catch (const Error&) {
    return std::nullopt;
  }
  if (known != nullptr && std::abs(value) > known->limit) value = std::copysign(known->limit, value);
  // The field of these is bounded by an operand, too.
  if (number <= 3 && !std::isnan(value))
    value = std::clamp(value, -std::abs(operands[4]), std::abs(operands[4]));
  return value;
}

}  // namespace oktett::pov
