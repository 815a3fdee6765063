#pragma once
/// \file The kinds of reconstruction filters.

#include "core/description.h"

namespace oktett {

/// How much light counts for a pixel by its distance from the pixel's centre, in x and in y alike: the weight
/// of a point is the product of both. All weights are positive, so that they can be densities.
enum class FilterKind {
  box,              ///< all the same
  tent,             ///< falls in a straight line
  gaussian,         ///< a normal distribution whose standard deviation is a third of the radius, cut there
  blackman_harris,  ///< Blackman-Harris window of four terms (Harris 1978): nearly a bell, smooth at its end
};
/// Their names.
inline constexpr Choice<FilterKind> kFilterKinds[] = {{"box", FilterKind::box},
                                                      {"tent", FilterKind::tent},
                                                      {"gaussian", FilterKind::gaussian},
                                                      {"blackman_harris", FilterKind::blackman_harris}};

/// Radii that a filter may have, in pixels.
inline constexpr Range kFilterRadii{0, 16, true};

/// The radius that a filter has if none is given, in pixels.
constexpr double usual_radius(FilterKind kind) {
  return kind == FilterKind::box ? 0.5 : kind == FilterKind::tent ? 1 : 1.5;
}

}  // namespace oktett
