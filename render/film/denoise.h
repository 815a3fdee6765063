#pragma once
/// \file A denoiser for finished pictures, guided by their data layers.

#include "render/picture.h"

namespace oktett {

/// How strongly noise is removed. The defaults are those of the papers, see denoise.cpp.
struct DenoiseOptions {
  int window = 8;         ///< pixels up to this many away, in x and in y, are averaged
  int patch = 2;          ///< pixels are alike if what lies up to this many pixels around them is
  float strength = 0.6f;  ///< how many standard deviations two colours may differ to count as alike
};

/// Replaces R, G and B by weighted means of pixels that are alike, by non-local means, and adds the planes
/// Noisy.R, Noisy.G and Noisy.B with what was there before. Pixels around which nothing varies from sample to
/// sample keep their bits. The result is biased: it is smoother than the light. It does not depend on the
/// number of threads. Uses the planes Variance, Albedo, N and Z; throws Error if one is missing.
void denoise(Picture& picture, const DenoiseOptions& options = {});

}  // namespace oktett
