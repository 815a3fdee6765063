#include "kernels/heights/make_height_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "kernels/heights/height_grid.h"

namespace oktett {

static void require_size(std::uint32_t columns, std::uint32_t rows, std::size_t samples) {
  const std::string size = std::to_string(columns) + " x " + std::to_string(rows);
  if (std::min(columns, rows) < 2 || std::max(columns, rows) > kMaxHeightSide ||
      std::size_t{columns} * rows > kMaxHeightSamples)
    throw Error("height grid of " + size + " samples; expected 2 to " + std::to_string(kMaxHeightSide) +
                " along a side and at most " + std::to_string(kMaxHeightSamples) + " in all");
  if (samples != std::size_t{columns} * rows)
    throw Error("height grid of " + size + " samples; found " + std::to_string(samples));
}

std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<float> samples, HeightInterpolation interpolation) {
  require_size(columns, rows, samples.size());
  if (!std::all_of(samples.begin(), samples.end(), [](float s) { return std::isfinite(s); }))
    throw Error("height grid with samples that are not finite");
  return HeightGrid::from_floats(columns, rows, std::move(samples), interpolation);
}

std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<std::uint16_t> samples,
                                                   HeightInterpolation interpolation) {
  require_size(columns, rows, samples.size());
  return HeightGrid::from_words(columns, rows, std::move(samples), interpolation);
}

}  // namespace oktett
