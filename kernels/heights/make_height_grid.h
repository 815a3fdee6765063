#pragma once
/// \file Samples for height fields.

#include <cstdint>
#include <memory>

#include "core/soa.h"
#include "kernels/heights/height_field_data.h"

namespace oktett {

/// The grid of a HeightFieldShape from columns x rows samples, row by row. Sample (i, j) has the value
/// samples[i + j * columns], or that / 65535 if the samples are whole numbers. Throws Error unless there are
/// 2 to 32768 columns and rows, at most 2^28 samples in all and as many as columns x rows, all of them
/// finite.
std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<float> samples, HeightInterpolation interpolation);
std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<std::uint16_t> samples,
                                                   HeightInterpolation interpolation);

}  // namespace oktett
