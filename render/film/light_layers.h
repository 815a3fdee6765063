#pragma once
/// \file Layers of light groups in a picture: what the lights of one group alone would show. Their sum is the
/// picture's colour, but for rounding.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/picture.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// Adds the planes light_NAME.R, light_NAME.G and light_NAME.B of each group, black, to a picture.
void add_light_planes(const std::vector<std::string>& names, Picture& picture);

/// The first of these planes; the number of all planes if there is none.
std::size_t first_light_plane(const Picture& picture);

/// Adds sample `i`, which is finite, to the sums of a pixel: red, green and blue of each group.
void add_to_layers(const SampleBatch& samples, std::size_t i, double* sums);

/// Writes the means over `samples` samples of a pixel to the planes from `first` on at place `at`.
void write_layers(Picture& picture, std::size_t first, std::size_t at, std::span<const double> sums,
                  std::uint32_t samples);

}  // namespace oktett
