#pragma once
/// \file Adaptive sampling: how many samples a pixel needs for a stated error.
///
/// Each pixel first gets `samples` samples. How many it gets in all is computed from the first samples of its
/// neighbours alone. If its own were asked, pixels that happen to miss what is bright and rare would end
/// early, and the picture would be too dark: the mean of samples whose number depends on them is biased (Kirk
/// and Arvo 1991). The samples of neighbours are independent of those of the pixel, so its mean stays
/// unbiased, and none of its samples is thrown away. For this, pixels must share nothing random. They do
/// share photons (caustics.h) and points of lamps (area_lights.h), so each pixel begins with a random one of
/// these. For the same reason nothing is decided a second time when more samples are there.

#include <cstdint>

#include "core/vec3.h"
#include "render/scene.h"

namespace oktett {

/// Neighbours up to this many pixels away, in x and in y, decide.
inline constexpr std::uint32_t kNeighbourhood = 2;
/// The error of pixels darker than this counts as if they were as bright: what is nearly black need not be
/// known to a part of itself.
inline constexpr double kDarkestLight = 0.02;

/// Luminance of the samples of a pixel.
struct LuminanceSums {
  double sum = 0, square = 0;
  std::uint32_t count = 0;

  /// Adds a sample, which is finite.
  void add(const Color& c);
};

/// What the neighbours of a pixel say about it.
class ErrorEstimate {
 public:
  void add_neighbour(const LuminanceSums& sums);
  /// The number of samples for which the standard deviation of a pixel's mean is settings.error times its
  /// light: one of 1, 2, 3, 4, 6, 8, 12, ... times settings.samples, at most settings.max_samples rounded
  /// down to a multiple of settings.samples.
  std::uint32_t samples_wanted(const IntegratorSettings& settings) const;

 private:
  double variance_ = 0, mean_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace oktett
