/// \file Height fields in scene files.

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

#include "io/image/heights.h"
#include "io/scene/exact.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"
#include "kernels/functions/tape_data.h"
#include "kernels/heights/height_grid.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

std::shared_ptr<const HeightGrid> read_file(SceneLoad& load, const YamlNode& node, bool palette,
                                            HeightInterpolation interpolation) {
  return read_named_file(load, node, [&](const std::string& path) {
    HeightImage image =
        (palette ? read_palette_heights : read_heights)(path, kMaxHeightSide, kMaxHeightSamples);
    return image.words.empty()
               ? HeightGrid::from_floats(image.columns, image.rows, std::move(image.floats), interpolation)
               : HeightGrid::from_words(image.columns, image.rows, std::move(image.words), interpolation);
  });
}

bool depends_on_y(const FunctionTape& f) {
  constexpr std::uint8_t kY = 1;
  if (f.result == kY) return true;
  for (const TapeStep& step : f.steps)
    if (reads(step, kY)) return true;
  return false;
}

/// The function of x and z at the places of the samples. The number of the first sample that has no finite
/// value goes to `bad`.
Column<float> sample(const FunctionTape& f, std::uint32_t columns, std::uint32_t rows, const Vec3d& size,
                     std::size_t& bad) {
  const std::size_t count = std::size_t{columns} * rows;
  Column<float> samples(count);
  std::atomic<std::size_t> first_bad = count;
  tbb::parallel_for(std::uint32_t{0}, rows, [&](std::uint32_t row) {
    const double z = (row / (rows - 1.0) - 0.5) * size.z;
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double x = (column / (columns - 1.0) - 0.5) * size.x, y = value_at(f, x, 0, z);
      const std::size_t i = std::size_t{row} * columns + column;
      samples[i] = static_cast<float>(y);
      if (std::abs(y) <= kMaxCoordinate) continue;
      for (std::size_t before = first_bad; i < before && !first_bad.compare_exchange_weak(before, i);) {}
    }
  });
  bad = first_bad;
  return samples;
}

std::shared_ptr<const HeightGrid> sample_function(SceneLoad& load, const YamlNode& node,
                                                  const YamlNode* counts, const Vec3d& size,
                                                  HeightInterpolation interpolation) {
  const FunctionTape f = read_function(load, node);
  if (depends_on_y(f))
    throw Error(node.where(), "the function of a height field is one of x and z, not of y");
  std::uint32_t columns = 512, rows = 512;
  if (counts && counts->kind == YamlKind::sequence) {
    const auto items = list_items(*counts, "samples");
    if (items.size() != 2)
      throw Error(counts->where(), fmt::format("expected 2 numbers, found {}", items.size()));
    columns = load.values.integer(*items[0], 2, kMaxHeightSide);
    rows = load.values.integer(*items[1], 2, kMaxHeightSide);
  } else if (counts) {
    columns = rows = load.values.integer(*counts, 2, kMaxHeightSide);
  }
  if (std::size_t{columns} * rows > kMaxHeightSamples)
    throw Error(counts->where(), fmt::format("expected at most {} samples in all", kMaxHeightSamples));
  std::size_t bad = 0;
  Column<float> samples = sample(f, columns, rows, size, bad);
  if (bad < samples.size())
    throw Error(node.where(),
                fmt::format("the function has no finite value at x = {:g}, z = {:g}",
                            (static_cast<double>(bad % columns) / (columns - 1.0) - 0.5) * size.x,
                            (static_cast<double>(bad / columns) / (rows - 1.0) - 0.5) * size.z));
  return HeightGrid::from_floats(columns, rows, std::move(samples), interpolation);
}

}  // namespace

MaybeForm finish(const ShapeNode& at, HeightFieldShape& shape) {
  const Fields& fields = at.fields;
  const YamlNode *file = fields["file"], *function = fields["function"];
  if (!file && !function) throw Error(at.key.where(), "height_field needs 'file' or 'function'");
  if (function && shape.palette)
    throw Error(fields.require("palette").where(), "a height field from a function has no 'palette'");
  if (file && function) throw Error(function->where(), "height_field has either 'file' or 'function'");
  shape.grid = file ? read_file(at.load, *file, shape.palette, shape.interpolation)
                    : sample_function(at.load, *function, fields["samples"], shape.size, shape.interpolation);
  // The grid holds the heights themselves from here on.
  shape.palette = false;
  const double unit = shape.size.y * shape.grid->unit();
  const double least = shape.grid->least() * unit, greatest = shape.grid->greatest() * unit;
  if (!(std::max(std::abs(least), std::abs(greatest)) <= kMaxCoordinate))
    throw Error(at.key.where(), fmt::format("the heights are from {:g} to {:g}; expected a magnitude of at "
                                            "most {:g}",
                                            least, greatest, kMaxCoordinate));
  if (!shape.open && shape.size.y > 0 && !(shape.base < least))
    throw Error(fields.require("base").where(),
                fmt::format("the base must be below all heights, of which the least is {:g}", least));
  for (int k = 0; k < 3; ++k)
    if (shape.size[k] == 0)
      return at.skip(fmt::format("the size of the height field is zero along {}", "xyz"[k]));
  return shape;
}

}  // namespace oktett
