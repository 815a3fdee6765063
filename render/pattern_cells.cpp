/// \file Patterns of cells, and of noise. Forms that are not random are those of POV-Ray, found by asking it
/// for values.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/random.h"
#include "render/pattern_noise.h"
#include "render/pattern_values.h"

namespace oktett {
namespace {

/// The random point of a cube of edge 1.
Vec3d cell_point(std::int64_t x, std::int64_t y, std::int64_t z, NoiseGenerator generator) {
  if (generator != NoiseGenerator::own)
    return {static_cast<double>(x) + povray_cell_number(x, y, z, 0),
            static_cast<double>(y) + povray_cell_number(x, y, z, 1),
            static_cast<double>(z) + povray_cell_number(x, y, z, 2)};
  const std::uint64_t a = lattice_bits(x, y, z), b = mix_bits(a + kGoldenBits), c = mix_bits(b + kGoldenBits);
  return {static_cast<double>(x) + unit_of(a), static_cast<double>(y) + unit_of(b),
          static_cast<double>(z) + unit_of(c)};
}

/// Distances to a power, of which no root is taken.
class Metric {
 public:
  explicit Metric(double power) : power_(power) {}

  double sum(const Vec3d& d) const {
    if (power_ == 2) return dot(d, d);
    return term(d.x) + term(d.y) + term(d.z);
  }
  double term(double x) const {
    if (power_ == 2) return x * x;
    return power_ == 1 ? std::abs(x) : x == 0 ? 0 : portable::pow(std::abs(x), power_);
  }
  double root(double sum) const {
    if (power_ == 2) return std::sqrt(sum);
    return power_ == 1 ? sum : sum == 0 ? 0 : portable::pow(sum, 1 / power_);
  }

 private:
  double power_;
};

/// The three nearest of the random points.
struct NearestPoints {
  std::array<double, 3> sums{kInfinity, kInfinity, kInfinity};
  Vec3d first{0, 0, 0};

  void add(double sum, const Vec3d& point) {
    if (sum < sums[0]) {
      sums = {sum, sums[0], sums[1]}, first = point;
    } else if (sum < sums[1]) {
      sums = {sums[0], sum, sums[1]};
    } else if (sum < sums[2]) {
      sums[2] = sum;
    }
  }
};

NearestPoints nearest_points(const Metric& metric, const Vec3d& p, NoiseGenerator generator) {
  const std::int64_t cell[3] = {cell_of(p.x), cell_of(p.y), cell_of(p.z)};
  NearestPoints nearest;
  // The cubes around the place first, then those around these, unless they are too far away.
  for (int ring = 1; ring <= 2; ++ring)
    for (std::int64_t i = -ring; i <= ring; ++i)
      for (std::int64_t j = -ring; j <= ring; ++j)
        for (std::int64_t k = -ring; k <= ring; ++k) {
          const std::int64_t step[3] = {i, j, k};
          if (ring == 2) {
            if (std::max({std::abs(i), std::abs(j), std::abs(k)}) < 2) continue;
            Vec3d gap;
            for (int a = 0; a < 3; ++a) {
              const double at = fraction_of(p[a]), s = static_cast<double>(step[a]);
              gap[a] = s > 0 ? s - at : s < 0 ? at - s - 1 : 0;
            }
            if (metric.sum(gap) >= nearest.sums[2]) continue;
          }
          const Vec3d point = cell_point(cell[0] + i, cell[1] + j, cell[2] + k, generator);
          nearest.add(metric.sum(p - point), point);
        }
  return nearest;
}

/// Where `x` lies in a period of the length `size`.
double remainder_of(double x, double size) { return x - std::floor(x / size) * size; }

}  // namespace

double raw_value(const AgatePattern& a, const Vec3d& p, const PatternFrame& frame) {
  const double noise = a.folding == 0 ? 0 : a.folding * value_turbulence(frame.turbulence, p);
  const double sine = portable::sin(2 * std::numbers::pi * fraction_of(1.3 * noise + 1.1 * p.z));
  return portable::pow(std::max(0.5 + 0.5 * sine, 0.0), 0.77);
}

double raw_value(const BrickPattern& b, const Vec3d& p, const PatternFrame&) {
  if (remainder_of(p.y, b.brick.y) >= b.brick.y - b.mortar) return 0;
  // Every second layer is moved by a half brick along x, and the others along z.
  const bool odd = std::fmod(std::floor(p.y / b.brick.y), 2) != 0;
  const double x = remainder_of(odd ? p.x + b.brick.x / 2 : p.x, b.brick.x);
  const double z = remainder_of(odd ? p.z : p.z + b.brick.z / 2, b.brick.z);
  return x >= b.brick.x - b.mortar || z >= b.brick.z - b.mortar ? 0 : 1;
}

double raw_value(const BumpsPattern&, const Vec3d& p, const PatternFrame& frame) {
  return unit_noise(p, frame.turbulence.generator);
}

double raw_value(const CellsPattern&, const Vec3d& p, const PatternFrame& frame) {
  if (frame.turbulence.generator != NoiseGenerator::own)
    return povray_cell_number(cell_of(p.x), cell_of(p.y), cell_of(p.z), 0);
  return unit_of(lattice_bits(cell_of(p.x), cell_of(p.y), cell_of(p.z)));
}

double raw_value(const CracklePattern& c, const Vec3d& p, const PatternFrame& frame) {
  const NoiseGenerator generator = frame.turbulence.generator;
  const Metric metric(c.metric);
  const NearestPoints nearest = nearest_points(metric, p, generator);
  if (c.solid) return unit_noise(nearest.first, generator);
  const double offset = metric.term(c.offset);
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    if (c.form[k] != 0) sum += c.form[k] * metric.root(nearest.sums[static_cast<std::size_t>(k)] + offset);
  return std::clamp(sum, 0.0, 1.0);
}

double raw_value(const CubicPattern&, const Vec3d& p, const PatternFrame&) {
  const double x = std::abs(p.x), y = std::abs(p.y), z = std::abs(p.z);
  const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  return p[axis] < 0 ? axis + 3 : axis;
}

double raw_value(const DentsPattern&, const Vec3d& p, const PatternFrame& frame) {
  const double noise = unit_noise(p, frame.turbulence.generator);
  return noise * noise * noise;
}

double raw_value(const GranitePattern&, const Vec3d& p, const PatternFrame& frame) {
  double sum = 0, scale = 4, weight = 1;
  const NoiseGenerator generator = frame.turbulence.generator;
  // What one octave may be at most; of POV-Ray's first generator noise itself counts, which is half as much.
  const double steep = generator == NoiseGenerator::povray_1 ? 0.5 : 1;
  const double most = generator == NoiseGenerator::own ? kInfinity : 0.5;
  for_each_octave<1>(
      6, generator, [&](Vec3d(&place)[1]) { place[0] = p * scale, scale *= 2; },
      [&](const double(&noise)[1]) {
        sum += weight * std::min(steep * std::abs(noise[0]), most), weight *= 0.5;
      });
  return std::min(sum, 1.0);
}

double raw_value(const HexagonPattern&, const Vec3d& p, const PatternFrame&) {
  // Hexagons are the cells around sums of whole numbers of the steps (0, sqrt(3)) and (3, sqrt(3)) / 2. With
  // a third number, so that all three add up to 0, the nearest sum is that of the rounded numbers, but for
  // the one that is rounded most.
  const double b = p.x / 1.5, a = p.z / std::numbers::sqrt3 - b / 2, c = -a - b;
  double i = std::round(a), j = std::round(b);
  const double k = std::round(c);
  const double by_i = std::abs(i - a), by_j = std::abs(j - b), by_k = std::abs(k - c);
  if (by_i > by_j && by_i > by_k)
    i = -j - k;
  else if (by_j > by_k)
    j = -i - k;
  const double number = i + 2 * j;
  return number - 3 * std::floor(number / 3);
}

double raw_value(const WrinklesPattern&, const Vec3d& p, const PatternFrame& frame) {
  double sum = 0, scale = 1, weight = 0.5;
  const NoiseGenerator generator = frame.turbulence.generator;
  const double steep = generator == NoiseGenerator::povray_1 ? 0.5 : 1;
  for_each_octave<1>(
      10, generator, [&](Vec3d(&place)[1]) { place[0] = p * scale, scale *= 2; },
      [&](const double(&noise)[1]) { sum += weight * steep_noise(steep * noise[0]), weight *= 0.5; });
  return sum;
}

}  // namespace oktett
