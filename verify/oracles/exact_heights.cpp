#include <algorithm>
#include <cmath>

#include "kernels/heights/height_grid.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

/// A small field and what it means, sample by sample.
struct Samples {
  std::uint32_t columns, rows;
  std::vector<Real> value;  ///< times size.y is the height
  Vec3d size;
  HeightInterpolation interpolation;

  Real at(std::uint32_t i, std::uint32_t j) const { return value[i + std::size_t{j} * columns]; }

  /// The height over a place in the field; beyond it that of its border.
  Real height(Real x, Real z) const {
    const auto find = [](Real p, std::uint32_t samples, std::uint32_t& cell) {
      p = std::clamp(p, Real(0), Real(samples) - 1);
      cell = std::min(static_cast<std::uint32_t>(p), samples - 2);
      return p - cell;
    };
    std::uint32_t i, j;
    const Real u = find((x / size.x + 0.5L) * (Real(columns) - 1), columns, i);
    const Real v = find((z / size.z + 0.5L) * (Real(rows) - 1), rows, j);
    const Real a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
    if (interpolation == HeightInterpolation::nearest) return (a + b + c + d) / 4 * size.y;
    if (interpolation == HeightInterpolation::bilinear)
      return ((1 - u) * (1 - v) * a + u * (1 - v) * b + (1 - u) * v * c + u * v * d) * size.y;
    return (u + v < 1 ? a + (b - a) * u + (c - a) * v : d + (c - d) * (1 - u) + (b - d) * (1 - v)) * size.y;
  }
};

/// Rolling, jagged, or of few levels.
double draw_value(CaseRandom& random, int kind, double i, double j) {
  if (kind == 0) return 0.5 + 0.25 * std::sin(0.9 * i) + 0.25 * std::cos(0.7 * j + 0.3 * i);
  return kind == 1 ? random.unit() : std::floor(random.unit() * 3) / 2;
}

template <HeightInterpolation kInterpolation, bool kSolid>
ExactOracle oracle(CaseRandom& random) {
  Samples s;
  s.columns = 2 + static_cast<std::uint32_t>(random.unit() * 14);
  s.rows = 2 + static_cast<std::uint32_t>(random.unit() * 14);
  s.size = {1 + random.unit(), 0.2 + random.unit(), 1 + random.unit()};
  s.interpolation = kInterpolation;
  const int kind = static_cast<int>(random.unit() * 3);
  const bool words = random.unit() < 0.5;
  Column<std::uint16_t> w(words ? std::size_t{s.columns} * s.rows : 0);
  Column<float> f(words ? 0 : std::size_t{s.columns} * s.rows);
  for (std::uint32_t j = 0; j < s.rows; ++j)
    for (std::uint32_t i = 0; i < s.columns; ++i) {
      const std::size_t k = i + std::size_t{j} * s.columns;
      const double value = draw_value(random, kind, i, j);
      if (words)
        w[k] = static_cast<std::uint16_t>(value * 65535), s.value.push_back(w[k] / 65535.0L);
      else
        f[k] = static_cast<float>(value), s.value.push_back(f[k]);
    }
  HeightFieldShape shape;
  shape.size = s.size, shape.open = !kSolid;
  const auto [least, greatest] = std::minmax_element(s.value.begin(), s.value.end());
  const double low = static_cast<double>(*least) * s.size.y, high = static_cast<double>(*greatest) * s.size.y;
  shape.base = low - 0.1 - random.unit() * 0.5;
  shape.walk = static_cast<HeightWalk>(static_cast<int>(random.unit() * 3));
  shape.grid = words ? HeightGrid::from_words(s.columns, s.rows, std::move(w), kInterpolation)
                     : HeightGrid::from_floats(s.columns, s.rows, std::move(f), kInterpolation);
  const Vec3d half = s.size * 0.5;
  ExactOracle o{{shape}, [s](const Vec3l& p) { return p.y - s.height(p.x, p.z); }};
  const double room = 0.02;
  cut_by_box(o, {-half.x, kSolid ? shape.base : low - room, -half.z}, {half.x, high + room, half.z}, !kSolid);
  return o;
}

}  // namespace

std::vector<ExactCase> height_cases() {
  using enum HeightInterpolation;
  return {{"heightfield", oracle<bilinear, false>},
          {"heightfield_triangles", oracle<triangles, false>},
          {"heightfield_nearest", oracle<nearest, false>},
          {"heightfield_solid", oracle<bilinear, true>},
          {"heightfield_solid_triangles", oracle<triangles, true>},
          {"heightfield_solid_nearest", oracle<nearest, true>}};
}

}  // namespace oktett
