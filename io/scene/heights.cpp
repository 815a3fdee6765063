/// \file Height fields in scene files.

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

#include "io/image/heights.h"
#include "io/scene/exact.h"
#include "io/scene/utf8.h"
#include "kernels/functions/function_tape.h"
#include "kernels/heights/height_grid.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

/// Greatest magnitude of a float that is still a length.
constexpr double kMostHeight = kMaxCoordinate;

std::shared_ptr<const HeightGrid> read_file(SceneLoad& load, const YamlNode& node,
                                            HeightInterpolation interpolation) {
  const std::string path = load.values.existing_file(node);
  try {
    HeightImage image = read_heights(path, kMaxHeightSide, kMaxHeightSamples);
    return image.words.empty()
               ? HeightGrid::from_floats(image.columns, image.rows, std::move(image.floats), interpolation)
               : HeightGrid::from_words(image.columns, image.rows, std::move(image.words), interpolation);
  } catch (const Error& e) {
    // An image has no lines: what names it is the place to look at.
    const std::string what = e.what();
    throw Error(node.where(), quote(path, 1000) + what.substr(what.find(path) == 0 ? path.size() : 0));
  }
}

bool depends_on_y(const FunctionTape& f) {
  constexpr std::uint8_t kY = 1;
  if (f.result == kY) return true;
  for (const TapeStep& step : f.steps)
    if (step.op != TapeOp::constant && (step.a == kY || step.b == kY)) return true;
  return false;
}

/// The function of x and z at the places of the samples, several at a time; the number of the first sample
/// that has no finite value goes to `bad`.
Column<float> sample(const FunctionTape& f, std::uint32_t columns, std::uint32_t rows, const Vec3d& size,
                     std::size_t& bad) {
  constexpr std::uint32_t W = 8;
  using D = Simd<double, W, ScalarIsa>;
  using G = Gradient<D>;
  const std::size_t count = std::size_t{columns} * rows;
  Column<float> samples(count);
  std::atomic<std::size_t> first_bad = count;
  const D zero(0.0);
  const Vec3<D> flat{zero, zero, zero};
  tbb::parallel_for(std::uint32_t{0}, rows, [&](std::uint32_t row) {
    const D z((row / (rows - 1.0) - 0.5) * size.z);
    for (std::uint32_t column = 0; column < columns; column += W) {
      double x[W], y[W];
      for (std::uint32_t k = 0; k < W; ++k)
        x[k] = (std::min(column + k, columns - 1) / (columns - 1.0) - 0.5) * size.x;
      run_tape(f, G{D::load(x), flat}, G{zero, flat}, G{z, flat}).v.store(y);
      for (std::uint32_t k = 0; k < W && column + k < columns; ++k) {
        const std::size_t i = std::size_t{row} * columns + column + k;
        samples[i] = static_cast<float>(y[k]);
        if (std::abs(y[k]) <= kMostHeight) continue;
        for (std::size_t before = first_bad; i < before && !first_bad.compare_exchange_weak(before, i);) {}
      }
    }
  });
  bad = first_bad;
  return samples;
}

std::shared_ptr<const HeightGrid> read_function(SceneLoad& load, const YamlNode& node, const YamlNode* counts,
                                                const Vec3d& size, HeightInterpolation interpolation) {
  const std::string text = load.values.text(node);
  FunctionTape f;
  try {
    f = compile_function(text);
  } catch (const Error& e) {
    fail_in_text("function", node, text, e);
  }
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

MaybeForm read_height_field(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "height_field",
                      {"file", "function", "samples", "size", "interpolation", "base", "walk", "normals"});
  HeightFieldShape shape;
  load.values.read(fields["size"], shape.size);
  for (int k = 0; k < 3; ++k)
    if (shape.size[k] < 0) throw Error(fields["size"]->where(), "the size must not be negative");
  HeightInterpolation interpolation = HeightInterpolation::bilinear;
  if (const YamlNode* choice = fields["interpolation"])
    interpolation =
        load.values.choice<HeightInterpolation>(*choice, {{"nearest", HeightInterpolation::nearest},
                                                          {"triangles", HeightInterpolation::triangles},
                                                          {"bilinear", HeightInterpolation::bilinear}});
  if (const YamlNode* walk = fields["walk"])
    shape.walk = load.values.choice<HeightWalk>(
        *walk,
        {{"pyramid", HeightWalk::pyramid}, {"cells", HeightWalk::cells}, {"spans", HeightWalk::spans}});
  const YamlNode *file = fields["file"], *function = fields["function"];
  if (!file && !function) throw Error(key.where(), "height_field needs 'file' or 'function'");
  if (file && function) throw Error(function->where(), "height_field has either 'file' or 'function'");
  if (file && fields["samples"])
    throw Error(fields["samples"]->where(), "a height field from a file has no 'samples'");
  shape.grid = file ? read_file(load, *file, interpolation)
                    : read_function(load, *function, fields["samples"], shape.size, interpolation);
  const double unit = shape.size.y * shape.grid->unit();
  const double least = shape.grid->least() * unit, greatest = shape.grid->greatest() * unit;
  if (!(std::max(std::abs(least), std::abs(greatest)) <= kMostHeight))
    throw Error(key.where(), fmt::format("the heights are from {:g} to {:g}; expected a magnitude of at most "
                                         "{:g}",
                                         least, greatest, kMostHeight));
  if (const YamlNode* base = fields["base"]) {
    shape.open = false;
    shape.base = load.values.number(*base);
    if (shape.size.y > 0 && !(shape.base < least))
      throw Error(base->where(),
                  fmt::format("the base must be below all heights, of which the least is {:g}", least));
  }
  for (int k = 0; k < 3; ++k)
    if (shape.size[k] == 0)
      return skip_exact(load, key, fmt::format("the size of the height field is zero along {}", "xyz"[k]));
  return shape;
}

constexpr ExactReader kReaders[] = {{"height_field", read_height_field}};

}  // namespace

std::span<const ExactReader> height_readers() { return kReaders; }

}  // namespace oktett
