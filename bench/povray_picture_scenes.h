#pragma once
/// \file Scenes of mirrors, glass, lenses and lamps, described for both POV-Ray and Oktett.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "render/scene.h"

namespace oktett::bench {

struct PictureScene {
  std::string name;
  Scene scene;
  std::uint32_t samples = 1;  ///< of Oktett per pixel
  /// POV-Ray's text with so many samples of lens or lamp. Its picture is mirrored from left to right.
  std::function<std::string(std::uint32_t samples)> pov;
  std::uint32_t pov_samples = 1;
  /// For the pictures against which noise is measured; 0: there is no noise.
  std::uint32_t long_samples = 0, pov_long_samples = 0;
  bool mirrors = false;  ///< rays are reflected often enough to compare the speed of later bounces
};

/// `lens_times`: how many times the usual samples are taken through lenses, by both programs.
std::vector<PictureScene> picture_scenes(std::uint32_t width, std::uint32_t height, std::uint32_t lens_times);

}  // namespace oktett::bench
