/// \file Patterns of the kinds of POV-Ray by values of POV-Ray 3.7.0.10, and by their definitions where noise
/// is in them. Values of `function { pattern { ... } }` were written out by `#write` at each point; patterns
/// of ours and theirs are: angular (radial), layers (marble), linear (gradient), rings (wood), spiral and
/// double_spiral (spiral1 and spiral2), others of the same name.

#include "render/pattern_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "kernels/functions/tape_data.h"
#include "render/pattern.h"
#include "tests/render/light_checks.h"

namespace oktett::pattern_kinds_test {
namespace {

using light_checks::Random;

Vec3d random_point(Random& random, double reach) {
  return {random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach)};
}

struct Known {
  Pattern pattern;
  Vec3d at;
  double value;
};

TEST(PatternKinds, FiguresHaveTheValuesOfPovRay) {
  const Known all[] = {
      {AngularPattern{}, {-0.29, 0.36, 2.55}, 0.731977458},
      {AngularPattern{}, {-0.21, 0.05, 0.52}, 0.688913528},
      {AngularPattern{}, {-1.89, 0.07, 0.78}, 0.5622940609},
      {AngularPattern{}, {1.76, -2.44, -1.18}, 0.09399015593},
      {AngularPattern{}, {-2.46, 1.86, 1.16}, 0.5701277043},
      {AngularPattern{}, {-2.75, 2.89, 2.79}, 0.6261491132},
      {BoxedPattern{}, {0.22, 0.16, -0.48}, 0.52},
      {BoxedPattern{}, {-0.68, 0.04, -0.62}, 0.32},
      {BoxedPattern{}, {-0.43, -0.36, -0.66}, 0.34},
      {BoxedPattern{}, {-0.05, -0.08, 0.48}, 0.52},
      {BoxedPattern{}, {0.03, 0.2, -0}, 0.8},
      {BoxedPattern{}, {0.23, -0.06, -0.31}, 0.69},
      {BrickPattern{}, {11.03, 6.33, -8.97}, 1},
      {BrickPattern{}, {-6.97, 7.43, -0.47}, 1},
      {BrickPattern{}, {11.53, -1.77, -7.67}, 0},
      {BrickPattern{}, {3.13, 5.03, -4.07}, 1},
      {BrickPattern{}, {-9.87, -2.97, 8.43}, 1},
      {BrickPattern{}, {6.23, -6.87, -4.57}, 0},
      {BrickPattern{}, {-9.57, -7.87, 5.33}, 1},
      {BrickPattern{}, {-7.67, 1.13, -0.87}, 1},
      {BrickPattern{}, {-7.37, 4.23, -6.57}, 1},
      {BrickPattern{}, {3.43, -6.87, -1.37}, 1},
      {BrickPattern{}, {-6.87, -4.07, 8.53}, 1},
      {BrickPattern{}, {7.33, -3.47, 6.93}, 0},
      {BrickPattern{{2, 1, 3}, 0.2}, {11.03, 6.33, -8.97}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-6.97, 7.43, -0.47}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {11.53, -1.77, -7.67}, 0},
      {BrickPattern{{2, 1, 3}, 0.2}, {3.13, 5.03, -4.07}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-9.87, -2.97, 8.43}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {6.23, -6.87, -4.57}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-9.57, -7.87, 5.33}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-7.67, 1.13, -0.87}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-7.37, 4.23, -6.57}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {3.43, -6.87, -1.37}, 1},
      {BrickPattern{{2, 1, 3}, 0.2}, {-6.87, -4.07, 8.53}, 0},
      {BrickPattern{{2, 1, 3}, 0.2}, {7.33, -3.47, 6.93}, 1},
      {CylindricalPattern{}, {0.22, 0.16, -0.48}, 0.4719848487},
      {CylindricalPattern{}, {-0.68, 0.04, -0.62}, 0.07978263437},
      {CylindricalPattern{}, {-0.43, -0.36, -0.66}, 0.2122817763},
      {CylindricalPattern{}, {-0.05, -0.08, 0.48}, 0.5174028595},
      {CylindricalPattern{}, {0.03, 0.2, -0}, 0.97},
      {CylindricalPattern{}, {0.23, -0.06, -0.31}, 0.6139948187},
      {LayersPattern{}, {-0.29, 0.36, 2.55}, 0.58},
      {LayersPattern{}, {-0.21, 0.05, 0.52}, 0.42},
      {LayersPattern{}, {-1.89, 0.07, 0.78}, 0.22002},
      {LayersPattern{}, {1.76, -2.44, -1.18}, 0.48002},
      {LayersPattern{}, {-2.46, 1.86, 1.16}, 0.91996},
      {LayersPattern{}, {-2.75, 2.89, 2.79}, 0.50004},
      {LeopardPattern{}, {-0.29, 0.36, 2.55}, 0.04326479395},
      {LeopardPattern{}, {-0.21, 0.05, 0.52}, 0.01272379543},
      {LeopardPattern{}, {-1.89, 0.07, 0.78}, 0.003452085329},
      {LeopardPattern{}, {1.76, -2.44, -1.18}, 0.03840119606},
      {LeopardPattern{}, {-2.46, 1.86, 1.16}, 0.1722924474},
      {LeopardPattern{}, {-2.75, 2.89, 2.79}, 0.004978678879},
      {LinearPattern{}, {-0.29, 0.36, 2.55}, 0.71},
      {LinearPattern{}, {-0.21, 0.05, 0.52}, 0.79},
      {LinearPattern{}, {-1.89, 0.07, 0.78}, 0.11001},
      {LinearPattern{}, {1.76, -2.44, -1.18}, 0.76},
      {LinearPattern{}, {-2.46, 1.86, 1.16}, 0.54002},
      {LinearPattern{}, {-2.75, 2.89, 2.79}, 0.25002},
      {LinearPattern{{1, -2, 3}}, {-0.29, 0.36, 2.55}, 0.7746146463},
      {LinearPattern{{1, -2, 3}}, {-0.21, 0.05, 0.52}, 0.3340765524},
      {LinearPattern{{1, -2, 3}}, {-1.89, 0.07, 0.78}, 0.08285098499},
      {LinearPattern{{1, -2, 3}}, {1.76, -2.44, -1.18}, 0.8285098499},
      {LinearPattern{{1, -2, 3}}, {-2.46, 1.86, 1.16}, 0.2783946468},
      {LinearPattern{{1, -2, 3}}, {-2.75, 2.89, 2.79}, 0.9572382013},
      {OnionPattern{}, {-0.29, 0.36, 2.55}, 0.5915632348},
      {OnionPattern{}, {-0.21, 0.05, 0.52}, 0.5630275304},
      {OnionPattern{}, {-1.89, 0.07, 0.78}, 0.04582501695},
      {OnionPattern{}, {1.76, -2.44, -1.18}, 0.2316559223},
      {OnionPattern{}, {-2.46, 1.86, 1.16}, 0.2949658572},
      {OnionPattern{}, {-2.75, 2.89, 2.79}, 0.8681310582},
      {PlanarPattern{}, {0.22, 0.16, -0.48}, 0.84},
      {PlanarPattern{}, {-0.68, 0.04, -0.62}, 0.96},
      {PlanarPattern{}, {-0.43, -0.36, -0.66}, 0.64},
      {PlanarPattern{}, {-0.05, -0.08, 0.48}, 0.92},
      {PlanarPattern{}, {0.03, 0.2, -0}, 0.8},
      {PlanarPattern{}, {0.23, -0.06, -0.31}, 0.94},
      {QuiltedPattern{}, {-0.29, 0.36, 2.55}, 0.09088473291},
      {QuiltedPattern{}, {-0.21, 0.05, 0.52}, 0.2632495381},
      {QuiltedPattern{}, {-1.89, 0.07, 0.78}, 0.4043705062},
      {QuiltedPattern{}, {1.76, -2.44, -1.18}, 0.1974361834},
      {QuiltedPattern{}, {-2.46, 1.86, 1.16}, 0.2485326692},
      {QuiltedPattern{}, {-2.75, 2.89, 2.79}, 0.3245789055},
      {QuiltedPattern{0.5, 0.25}, {-0.29, 0.36, 2.55}, 0.04107621985},
      {QuiltedPattern{0.5, 0.25}, {-0.21, 0.05, 0.52}, 0.1248794306},
      {QuiltedPattern{0.5, 0.25}, {-1.89, 0.07, 0.78}, 0.21197174},
      {QuiltedPattern{0.5, 0.25}, {1.76, -2.44, -1.18}, 0.08891730719},
      {QuiltedPattern{0.5, 0.25}, {-2.46, 1.86, 1.16}, 0.1151973625},
      {QuiltedPattern{0.5, 0.25}, {-2.75, 2.89, 2.79}, 0.1551436729},
      {RingsPattern{}, {-0.29, 0.36, 2.55}, 0.9245539465},
      {RingsPattern{}, {-0.21, 0.05, 0.52}, 0.4317406629},
      {RingsPattern{}, {-1.89, 0.07, 0.78}, 0.2174282959},
      {RingsPattern{}, {1.76, -2.44, -1.18}, 0.01698246287},
      {RingsPattern{}, {-2.46, 1.86, 1.16}, 0.1679866924},
      {RingsPattern{}, {-2.75, 2.89, 2.79}, 0.02143856519},
      {SphericalPattern{}, {0.22, 0.16, -0.48}, 0.448275431},
      {SphericalPattern{}, {-0.68, 0.04, -0.62}, 0.07891368483},
      {SphericalPattern{}, {-0.43, -0.36, -0.66}, 0.1339168631},
      {SphericalPattern{}, {-0.05, -0.08, 0.48}, 0.5108170077},
      {SphericalPattern{}, {0.03, 0.2, -0}, 0.7977625158},
      {SphericalPattern{}, {0.23, -0.06, -0.31}, 0.6093595003},
      {SpiralPattern{3}, {-0.29, 0.36, 2.55}, 0.3279698145},
      {SpiralPattern{3}, {-0.21, 0.05, 0.52}, 0.251507633},
      {SpiralPattern{3}, {-1.89, 0.07, 0.78}, 0.1928399025},
      {SpiralPattern{3}, {1.76, -2.44, -1.18}, 0.2537248647},
      {SpiralPattern{3}, {-2.46, 1.86, 1.16}, 0.3697127375},
      {SpiralPattern{3}, {-2.75, 2.89, 2.79}, 0.7152376262},
      {SpiralPattern{-2}, {-0.29, 0.36, 2.55}, 0.4071702128},
      {SpiralPattern{-2}, {-0.21, 0.05, 0.52}, 0.6205461935},
      {SpiralPattern{-2}, {-1.89, 0.07, 0.78}, 0.3661394419},
      {SpiralPattern{-2}, {1.76, -2.44, -1.18}, 0.7407924717},
      {SpiralPattern{-2}, {-2.46, 1.86, 1.16}, 0.09985067094},
      {SpiralPattern{-2}, {-2.75, 2.89, 2.79}, 0.9256791912},
      {DoubleSpiralPattern{2}, {-0.29, 0.36, 2.55}, 0.7616041047},
      {DoubleSpiralPattern{2}, {-0.21, 0.05, 0.52}, 0.4906484096},
      {DoubleSpiralPattern{2}, {-1.89, 0.07, 0.78}, 0.9271354755},
      {DoubleSpiralPattern{2}, {1.76, -2.44, -1.18}, 0.1437997206},
      {DoubleSpiralPattern{2}, {-2.46, 1.86, 1.16}, 0.1842652733},
      {DoubleSpiralPattern{2}, {-2.75, 2.89, 2.79}, 0.128401252},
      {AgatePattern{0}, {-0.29, 0.36, 2.55}, 0.06644129082},
      {AgatePattern{0}, {-0.21, 0.05, 0.52}, 0.376729473},
      {AgatePattern{0}, {-1.89, 0.07, 0.78}, 0.1837391004},
      {AgatePattern{0}, {1.76, -2.44, -1.18}, 0.05397412747},
      {AgatePattern{0}, {-2.46, 1.86, 1.16}, 0.9948701536},
      {AgatePattern{0}, {-2.75, 2.89, 2.79}, 0.768226204},
  };
  for (const Known& known : all)
    EXPECT_NEAR(pattern_value(known.pattern, known.at), known.value, 1e-8)
        << known.pattern.index() << " at " << known.at.x << " " << known.at.y << " " << known.at.z;
}

TEST(PatternKinds, BlocksHaveTheNumbersOfPovRay) {
  const Known all[] = {
      {CubicPattern{}, {-0.29, 0.36, 2.55}, 2},   {CubicPattern{}, {-0.21, 0.05, 0.52}, 2},
      {CubicPattern{}, {-1.89, 0.07, 0.78}, 3},   {CubicPattern{}, {1.76, -2.44, -1.18}, 4},
      {CubicPattern{}, {-2.46, 1.86, 1.16}, 3},   {CubicPattern{}, {-2.75, 2.89, 2.79}, 1},
      {CubicPattern{}, {0.22, 0.16, -0.48}, 5},   {CubicPattern{}, {-0.68, 0.04, -0.62}, 3},
      {CubicPattern{}, {-0.43, -0.36, -0.66}, 5}, {CubicPattern{}, {-0.05, -0.08, 0.48}, 2},
      {CubicPattern{}, {0.03, 0.2, -0}, 1},       {CubicPattern{}, {0.23, -0.06, -0.31}, 5},
      {HexagonPattern{}, {-2.31, 0.3, -0.85}, 1}, {HexagonPattern{}, {2.84, 0.3, 1.13}, 1},
      {HexagonPattern{}, {-3.2, 0.3, 3.91}, 2},   {HexagonPattern{}, {-2.29, 0.3, -1.93}, 2},
      {HexagonPattern{}, {2.18, 0.3, -1.37}, 1},  {HexagonPattern{}, {-1.63, 0.3, -3.41}, 0},
      {HexagonPattern{}, {-3.28, 0.3, 0.66}, 0},  {HexagonPattern{}, {-2.06, 0.3, 0.81}, 2},
      {HexagonPattern{}, {-1.03, 0.3, -0.37}, 1}, {HexagonPattern{}, {3.67, 0.3, -0.13}, 0},
      {HexagonPattern{}, {0.6, 0.3, 2.93}, 2},    {HexagonPattern{}, {-2.54, 0.3, -2.77}, 1},
      {HexagonPattern{}, {3.27, 0.3, 2.54}, 1},   {HexagonPattern{}, {-2, 0.3, -2.48}, 0},
      {HexagonPattern{}, {1.92, 0.3, 3.52}, 1},   {HexagonPattern{}, {-2.43, 0.3, 3.6}, 2},
  };
  for (const Known& known : all) {
    const double last = std::holds_alternative<CubicPattern>(known.pattern) ? 5 : 2;
    EXPECT_EQ(pattern_value(known.pattern, known.at), known.value / last)
        << known.pattern.index() << " at " << known.at.x << " " << known.at.y << " " << known.at.z;
  }
}

using Set = FractalPattern::Set;
using Formula = FractalPattern::Formula;
using Outside = FractalPattern::Outside;
using Inside = FractalPattern::Inside;

FractalPattern fractal(Set set, Formula formula, std::uint32_t iterations, std::uint32_t power = 2) {
  FractalPattern f;
  f.set = set, f.formula = formula, f.iterations = iterations, f.power = power;
  return f;
}

FractalPattern julia(Formula formula, double real, double imaginary, std::uint32_t iterations,
                     std::uint32_t power = 2) {
  FractalPattern f = fractal(Set::julia, formula, iterations, power);
  f.real = real, f.imaginary = imaginary;
  return f;
}

FractalPattern colored(Outside exterior, double factor, Inside interior, double inner = 0.5) {
  FractalPattern f;
  f.exterior = exterior, f.exterior_factor = factor, f.interior = interior, f.interior_factor = inner;
  return f;
}

TEST(PatternKinds, FractalsHaveTheValuesOfPovRay) {
  const Vec3d places[] = {{0.59, 1.09, 0},   {0.22, 0.46, 0},  {-1.04, -0.59, 0},
                          {-1.11, -0.95, 0}, {0.04, -0.22, 0}, {0.23, -0.25, 0}};
  const struct {
    FractalPattern pattern;
    double values[6];
  } all[] = {
      {fractal(Set::mandel, Formula::power, 50), {0, 1, 0.04, 0.02, 1, 1}},
      {fractal(Set::mandel, Formula::power, 50, 3), {0.02, 1, 0, 0, 1, 1}},
      {julia(Formula::power, 0.353, 0.288, 30), {0.0333333333, 1, 0.0333333333, 0, 1, 1}},
      {julia(Formula::power, 0.353, 0.288, 30, 4), {0.0333333333, 1, 0, 0, 1, 1}},
      {fractal(Set::mandel, Formula::magnet1, 40), {1, 1, 0.1, 0.075, 1, 1}},
      {fractal(Set::mandel, Formula::magnet2, 40), {1, 1, 0.05, 0.025, 1, 1}},
      {julia(Formula::magnet1, 1.5, 0.2, 40), {0.55, 0.075, 0.2, 0.25, 0.075, 1}},
      {julia(Formula::magnet2, 0.3, 0.2, 40), {1, 1, 1, 1, 1, 1}},
      {colored(Outside::real, 0.1, Inside::real),
       {0.975, 0.999903428, 0.982654121, 0.815574316, 0.996490107, 0.0660167305}},
      {colored(Outside::imaginary, 0.1, Inside::imaginary),
       {0.23762, 0.233872194, 0.206171215, 0.72410328, 0.891522971, 0.830147586}},
      {colored(Outside::real_square, 0.1, Inside::real_square),
       {0.00625, 1.8652e-08, 0.00300879533, 0.340128329, 2.4638697e-05, 0.00871641742}},
      {colored(Outside::imaginary_square, 0.1, Inside::imaginary_square),
       {0.564632644, 0.109392406, 0.425065699, 0.761190001, 0.0235345316, 0.0576996849}},
      {colored(Outside::size, 0.1, Inside::square, 1),
       {0.238931506, 0.218784849, 0.206899612, 0.331861165, 0.0471183407, 0.132832205}},
      {colored(Outside::constant, 0.3, Inside::least_size),
       {0.3, 0.115065169, 0.3, 0.3, 0.106496373, 0.163292203}},
  };
  for (const auto& known : all)
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(pattern_value(known.pattern, places[i]), known.values[i], 1e-7)
          << &known - all << " at " << places[i].x;
}

// ---- Noise.

/// The noise that patterns are made of, in [0, 1].
double noise(const Vec3d& p) { return pattern_value(NoisePattern{1, {1, 0.5}}, p); }

double steep(const Vec3d& p) { return std::clamp(2 * noise(p) - 0.5, 0.0, 1.0); }

// POV-Ray's noise at 4000 random points has the mean 0.507 and the deviation 0.125, and at most 0.868.
TEST(PatternKinds, NoiseIsOfTheKindOfPovRay) {
  Random random(1);
  double mean = 0, square = 0;
  for (int i = 0; i < 20000; ++i) {
    const double value = noise(random_point(random, 50));
    mean += value / 20000, square += value * value / 20000;
  }
  EXPECT_NEAR(mean, 0.507, 0.02);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 0.125, 0.02);
}

TEST(PatternKinds, NoiseIsCombinedAsInPovRay) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Vec3d p = random_point(random, 3);
    EXPECT_NEAR(pattern_value(DentsPattern{}, p), std::pow(noise(p), 3), 1e-12);
    double granite = 0, wrinkles = 0, folds = 0;
    for (int octave = 0; octave < 10; ++octave) {
      const double scale = std::pow(2.0, octave);
      if (octave < 6) granite += std::abs(1 - 2 * noise(p * (4 * scale))) / scale;
      if (octave < 6) folds += steep(p * scale) / scale;
      wrinkles += steep(p * scale) / (2 * scale);
    }
    EXPECT_NEAR(pattern_value(GranitePattern{}, p), std::min(granite, 1.0), 1e-12);
    EXPECT_NEAR(pattern_value(WrinklesPattern{}, p), wrinkles, 1e-12);
    const double bands = std::sin(2 * std::numbers::pi * (1.3 * 0.7 * folds + 1.1 * p.z));
    EXPECT_NEAR(pattern_value(AgatePattern{0.7}, p), std::pow(0.5 + 0.5 * bands, 0.77), 1e-10);
  }
}

/// The random point in a cube, from the bits of its corner.
Vec3d point_of_cell(const long long (&cell)[3]) {
  std::uint64_t bits = 0;
  for (const long long c : cell) bits = mix_bits(bits + static_cast<std::uint64_t>(c) + kGoldenBits);
  Vec3d p;
  for (int k = 0; k < 3; ++k, bits = mix_bits(bits + kGoldenBits))
    p[k] = static_cast<double>(cell[k]) + static_cast<double>(bits >> 11) * 0x1p-53;
  return p;
}

TEST(PatternKinds, CrackleIsMadeOfDistancesFromAllPoints) {
  Random random(3);
  for (const double metric : {2.0, 1.0, 3.0})
    for (int i = 0; i < 40; ++i) {
      const Vec3d p = random_point(random, 2);
      std::vector<double> distances;
      double least = 1e9;
      Vec3d first;
      long long cell[3];
      for (cell[0] = -5; cell[0] < 5; ++cell[0])
        for (cell[1] = -5; cell[1] < 5; ++cell[1])
          for (cell[2] = -5; cell[2] < 5; ++cell[2]) {
            const Vec3d point = point_of_cell(cell), d = p - point;
            double sum = 0;
            for (int k = 0; k < 3; ++k) sum += std::pow(std::abs(d[k]), metric);
            distances.push_back(std::pow(sum, 1 / metric));
            if (distances.back() > least) continue;
            least = distances.back(), first = point;
          }
      std::sort(distances.begin(), distances.end());
      EXPECT_NEAR(pattern_value(CracklePattern{{-1, 1, 0}, metric}, p),
                  std::min(1.0, distances[1] - distances[0]), 1e-9);
      EXPECT_NEAR(pattern_value(CracklePattern{{0.1, 0.1, 0.2}, metric}, p),
                  std::min(1.0, 0.1 * distances[0] + 0.1 * distances[1] + 0.2 * distances[2]), 1e-9);
      // POV-Ray: the second distances 0.7958 and 0.4928 become 0.8568 and 0.6255 for metric 3 and offset 0.5.
      const double moved = std::pow(std::pow(distances[1], metric) + std::pow(0.5, metric), 1 / metric);
      EXPECT_NEAR(pattern_value(CracklePattern{{0, 0.2, 0}, metric, 0.5}, p), std::min(1.0, 0.2 * moved),
                  1e-9);
      EXPECT_EQ(pattern_value(CracklePattern{{-1, 1, 0}, metric, 0, true}, p), noise(first));
    }
}

TEST(PatternKinds, CellsAreRandom) {
  Random random(4);
  std::vector<double> counts(10), expected(10, 500);
  for (int i = 0; i < 5000; ++i) {
    Vec3d p = random_point(random, 40);
    const double value = pattern_value(CellsPattern{}, p);
    for (int k = 0; k < 3; ++k) p[k] = std::floor(p[k]) + random.between(0, 1);
    EXPECT_EQ(pattern_value(CellsPattern{}, p), value);
    ++counts[static_cast<std::size_t>(value * 10)];
  }
  EXPECT_LT(light_checks::chi_squared(expected, counts), 60);
}

// As in POV-Ray all points lie at the distance 1 from the origin, and frequency and phase count twice: for
// each wave, and for the mean. POV-Ray shows there 0.5, and for a phase of 0.1 0.893892631.
TEST(PatternKinds, RipplesAreMeansOfWaves) {
  PatternTexture texture;
  texture.pattern = RipplesPattern{};
  EXPECT_NEAR(double{pattern_color(texture, {0, 0, 0}).x}, 0.5, 1e-6);
  texture.wave.phase = 0.1;
  EXPECT_NEAR(double{pattern_color(texture, {0, 0, 0}).x}, 0.893892631, 1e-6);
  Random random(5);
  for (const Pattern& pattern : {Pattern(RipplesPattern{1}), Pattern(WavesPattern{1})}) {
    double mean = 0;
    for (int i = 0; i < 4000; ++i) mean += pattern_value(pattern, random_point(random, 30)) / 4000;
    EXPECT_NEAR(mean, 0.5, 0.03);
  }
  // A mean of ten waves deviates by 1 / sqrt(80).
  double square = 0;
  for (int i = 0; i < 4000; ++i)
    square += std::pow(pattern_value(RipplesPattern{}, random_point(random, 30)) - 0.5, 2) / 4000;
  EXPECT_NEAR(std::sqrt(square), 0.107, 0.02);
}

TEST(PatternKinds, FunctionsRepeatAndAreZeroWhereTheyAreNotDefined) {
  const FunctionPattern f{compile_function("x + y^2")}, root{compile_function("sqrt(x)")};
  EXPECT_NEAR(pattern_value(f, {0.25, 0.5, 7}), 0.5, 1e-12);
  EXPECT_NEAR(pattern_value(f, {1.25, 0, 7}), 0.25 - 0.00001, 1e-9);
  EXPECT_EQ(pattern_value(root, {-1, 0, 0}), 0);
  EXPECT_EQ(f, FunctionPattern{compile_function("x + y^2")});
  EXPECT_FALSE(f == FunctionPattern{compile_function("x + y^3")});
}

// All values lie in [0, 1], whatever the place.
TEST(PatternKinds, ValuesAreInRange) {
  Random random(6);
  const Pattern all[] = {AgatePattern{},
                         AngularPattern{},
                         BoxedPattern{},
                         BrickPattern{},
                         CellsPattern{},
                         CracklePattern{},
                         CubicPattern{},
                         CylindricalPattern{},
                         DentsPattern{},
                         DoubleSpiralPattern{},
                         FractalPattern{},
                         GranitePattern{},
                         HexagonPattern{},
                         LayersPattern{},
                         LeopardPattern{},
                         LinearPattern{},
                         OnionPattern{},
                         PlanarPattern{},
                         QuiltedPattern{},
                         RingsPattern{},
                         RipplesPattern{},
                         SphericalPattern{},
                         SpiralPattern{},
                         WavesPattern{},
                         WrinklesPattern{},
                         TexturePattern{},
                         OverPattern{},
                         ProjectedPattern{},
                         FractalPattern{Set::mandel, Formula::magnet2}};
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pattern& pattern : all) {
    for (const double reach : {1.0, 100.0, 1e9, 1e300})
      for (int i = 0; i < 50; ++i) {
        const double value = pattern_value(pattern, random_point(random, reach));
        EXPECT_TRUE(value >= 0 && value <= 1) << pattern.index() << " within " << reach;
      }
    for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{nan, 0, 0}, Vec3d{0, -inf, inf}}) {
      const double value = pattern_value(pattern, p);
      EXPECT_TRUE(value >= 0 && value <= 1) << pattern.index();
    }
  }
}

}  // namespace
}  // namespace oktett::pattern_kinds_test
