#include "core/povray_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/noise.h"
#include "core/povray_lattice.h"

namespace oktett {
namespace {

/// Numbers of which four in a row are the value of a lattice point and its slopes along x, y and z.
constexpr std::array<double, 267> kNumbers{
    -1,        0.604974,   -0.937102, 0.414115,   0.576226,  -0.0161593, 0.432334,  0.103685,   0.590539,
    0.0286412, 0.46981,    -0.84622,  -0.0734112, -0.304097, -0.40206,   -0.210132, -0.919127,  0.652033,
    -0.83151,  -0.183948,  -0.671107, 0.852476,   0.043595,  -0.404532,  0.75494,   -0.335653,  0.618433,
    0.605707,  0.708583,   -0.477195, 0.899474,   0.490623,  0.221729,   -0.400381, -0.853727,  -0.932586,
    0.659113,  0.961303,   0.325948,  -0.750851,  0.842466,  0.734401,   -0.649866, 0.394491,   -0.466056,
    -0.434073, 0.109026,   0.0847028, -0.738857,  0.241505,  0.16228,    -0.71426,  -0.883665,  -0.150408,
    -0.90396,  -0.686549,  -0.785214, 0.488548,   0.0246433, 0.142473,   -0.602136, 0.375845,   -0.00779736,
    0.498955,  -0.268147,  0.856382,  -0.386007,  -0.596094, -0.867735,  -0.570977, -0.914366,  0.28896,
    0.672206,  -0.233783,  0.94815,   0.895262,   0.343252,  -0.173388,  -0.767971, -0.314748,  0.824308,
    -0.342092, 0.721431,   -0.24004,  -0.63653,   0.553277,  0.376272,   0.158984,  -0.452659,  0.396323,
    -0.420676, -0.454154,  0.122179,  0.295857,   0.0664225, -0.202075,  -0.724788, 0.453513,   0.224567,
    -0.908812, 0.176349,   -0.320516, -0.697139,  0.742702,  -0.900786,  0.471489,  -0.133532,  0.119127,
    -0.889769, -0.23183,   -0.669673, -0.046891,  -0.803433, -0.966735,  0.475578,  -0.652644,  0.0112459,
    -0.730007, 0.128283,   0.145647,  -0.619318,  0.272023,  0.392966,   0.646418,  -0.0207675, -0.315908,
    0.480797,  0.535668,   -0.250172, -0.83093,   -0.653773, -0.443809,  0.119982,  -0.897642,  0.89453,
    0.165789,  0.633875,   -0.886839, 0.930877,   -0.537194, 0.587732,   0.722011,  -0.209461,  -0.0424659,
    -0.814267, -0.919432,  0.280262,  -0.66302,   -0.558099, -0.537469,  -0.598779, 0.929656,   -0.170794,
    -0.537163, 0.312581,   0.959442,  0.722652,   0.499931,  0.175616,   -0.534874, -0.685115,  0.444999,
    0.17171,   0.108202,   -0.768704, -0.463828,  0.254231,  0.546014,   0.869474,  0.875212,   -0.944427,
    0.130724,  -0.110185,  0.312184,  -0.33138,   -0.629206, 0.0606546,  0.722866,  -0.0979477, 0.821561,
    0.0931258, -0.972808,  0.0318151, -0.867033,  -0.387228, 0.280995,   -0.218189, -0.539178,  -0.427359,
    -0.602075, 0.311971,   0.277974,  0.773159,   0.592493,  -0.0331884, -0.630854, -0.269947,  0.339132,
    0.581079,  0.209461,   -0.317433, -0.284993,  0.181323,  0.341634,   0.804959,  -0.229572,  -0.758907,
    -0.336721, 0.605463,   -0.991272, -0.0188754, -0.300191, 0.368307,   -0.176135, -0.3832,    -0.749569,
    0.62356,   -0.573938,  0.278309,  -0.971313,  0.839994,  -0.830686,  0.439078,  0.66128,    0.694514,
    0.0565042, 0.54342,    -0.438804, -0.0228428, -0.687068, 0.857267,   0.301991,  -0.494255,  -0.941039,
    0.775509,  0.410575,   -0.362081, -0.671534,  -0.348379, 0.932433,   0.886442,  0.868681,   -0.225666,
    -0.062211, -0.0976425, -0.641444, -0.848112,  0.724697,  0.473503,   0.998749,  0.174701,   0.559625,
    -0.029099, -0.337392,  -0.958129, -0.659785,  0.236042,  -0.246937,  0.659449,  -0.027512,  0.821897,
    -0.226215, 0.0181735,  0.500481,  -0.420127,  -0.427878, 0.566186};

constexpr std::uint32_t kPeriod = 4096;

/// The generator behind POV-Ray's tables: a linear congruential one, of whose numbers 15 bits count.
class TableRandom {
 public:
  constexpr explicit TableRandom(std::uint32_t seed) : state_(seed) {}
  constexpr std::uint32_t next() {
    state_ = state_ * 1812433253u + 12345u;
    return state_ >> 16 & 0x7fff;
  }

 private:
  std::uint32_t state_;
};

/// A permutation of the first 4096 numbers, twice.
constexpr std::array<std::uint16_t, 2 * kPeriod> make_permutation() {
  std::array<std::uint16_t, 2 * kPeriod> table{};
  for (std::uint32_t i = 0; i < kPeriod; ++i) table[i] = static_cast<std::uint16_t>(i);
  TableRandom random(0);
  for (std::uint32_t i = kPeriod; i-- > 0;) std::swap(table[i], table[random.next() % kPeriod]);
  for (std::uint32_t i = 0; i < kPeriod; ++i) table[kPeriod + i] = table[i];
  return table;
}
constexpr std::array<std::uint16_t, 2 * kPeriod> kPermutation = make_permutation();

using Four [[gnu::vector_size(32)]] = double;

/// The value and the slopes that begin at each of the numbers.
constexpr std::size_t kRows = kNumbers.size() - 3;
struct alignas(32) Rows {
  double at[kRows][4];
};
constexpr Rows make_rows() {
  Rows rows{};
  for (std::size_t i = 0; i < kRows; ++i) {
    rows.at[i][0] = kNumbers[i] * 0.5;
    for (std::size_t k = 1; k < 4; ++k) rows.at[i][k] = kNumbers[i + k];
  }
  return rows;
}
constexpr Rows kSlopes = make_rows();

double cubic_fade(double t) { return t * t * (3 - 2 * t); }

/// A coordinate in the table: POV-Ray moves the lattice by 10000.
std::uint32_t wrapped(std::int64_t cell) { return static_cast<std::uint32_t>(cell + 10000) % kPeriod; }

/// The rows of the corners of a cell.
void corner_rows(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t (&rows)[8]) {
  const std::uint32_t at[3] = {wrapped(x), wrapped(y), wrapped(z)};
  std::uint32_t of_xy[4];
  for (std::uint32_t i = 0; i < 4; ++i)
    of_xy[i] = kPermutation[kPermutation[at[0] + (i & 1)] ^ (at[1] + (i >> 1))];
  for (std::uint32_t i = 0; i < 8; ++i) rows[i] = kPermutation[of_xy[i & 3] ^ (at[2] + (i >> 2))] & 0xff;
}

/// Sums of what kCount noises have at the corners of a cell, each four rows further on than the one before.
template <std::size_t kCount>
void sums_at(const Vec3d& p, double (&sums)[kCount]) {
  std::uint32_t rows[8];
  corner_rows(cell_of(p.x), cell_of(p.y), cell_of(p.z), rows);
  const double f[3] = {fraction_of(p.x), fraction_of(p.y), fraction_of(p.z)};
  double weights[3][2];
  for (int k = 0; k < 3; ++k) weights[k][1] = cubic_fade(f[k]), weights[k][0] = 1 - weights[k][1];
  Four total[kCount]{};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const double weight = weights[0][i & 1] * weights[1][i >> 1 & 1] * weights[2][i >> 2];
    const Four place = Four{1, f[0] - (i & 1), f[1] - (i >> 1 & 1), f[2] - (i >> 2)} * weight;
    for (std::size_t k = 0; k < kCount; ++k) {
      const double* const row = kSlopes.at[rows[i] + 4 * k];
      total[k] += Four{row[0], row[1], row[2], row[3]} * place;
    }
  }
  for (std::size_t k = 0; k < kCount; ++k)
    sums[k] = (total[k][0] + total[k][1]) + (total[k][2] + total[k][3]);
}

/// Generator 3: gradient noise from a table of 2048 unit vectors.
class GradientTable {
 public:
  GradientTable() {
    TableRandom random(1);
    for (Vec3d& slope : slopes_) {
      double square = 0;
      do {
        for (int k = 0; k < 3; ++k)
          slope[k] = (static_cast<double>(random.next() % (2 * kSize)) - double{kSize}) / kSize;
        square = dot(slope, slope);
      } while (square > 1 || square < 1e-5);
      slope = slope * (1 / std::sqrt(square));
    }
    std::array<std::uint32_t, kSize + 1> table{};
    for (std::uint32_t i = 0; i < kSize; ++i) table[i] = i;
    for (std::uint32_t i = kSize; i > 0; i -= 2) std::swap(table[i], table[random.next() % kSize]);
    std::copy_n(table.begin(), kSize, permutation_.begin());
  }

  double at(const Vec3d& p) const {
    std::uint32_t cell[3][2];
    Vec3d f;
    for (int k = 0; k < 3; ++k) {
      const double moved = p[k] + kMove;
      cell[k][0] = static_cast<std::uint32_t>(cell_of(moved)) % kSize, cell[k][1] = (cell[k][0] + 1) % kSize;
      f[k] = fraction_of(moved);
    }
    double along_z[2];
    for (int z = 0; z < 2; ++z) {
      double along_y[2];
      for (int y = 0; y < 2; ++y) {
        double along_x[2];
        for (int x = 0; x < 2; ++x) {
          const Vec3d& slope = slopes_[(permuted(permuted(cell[0][x]) + cell[1][y]) + cell[2][z]) % kSize];
          along_x[x] = dot(slope, f - Vec3d{double(x), double(y), double(z)});
        }
        along_y[y] = mixed(along_x, f[0]);
      }
      along_z[z] = mixed(along_y, f[1]);
    }
    return mixed(along_z, f[2]);
  }

 private:
  static constexpr std::uint32_t kSize = 2048;
  /// What POV-Ray moves the lattice by.
  static constexpr double kMove = 10000000.023157213;

  static double mixed(const double (&ends)[2], double t) {
    return ends[0] + (ends[1] - ends[0]) * cubic_fade(t);
  }
  std::uint32_t permuted(std::uint32_t i) const { return permutation_[i % kSize]; }

  std::array<Vec3d, kSize> slopes_;
  std::array<std::uint32_t, kSize> permutation_;
};

/// The first numbers of the generator of cells.
std::vector<double> make_cell_numbers() {
  std::mt19937 random;
  std::vector<double> numbers(kPeriod + 2);
  for (double& number : numbers) number = static_cast<double>(random()) * 0x1p-32;
  return numbers;
}

std::vector<PovrayWave> make_waves(std::uint32_t count) {
  std::vector<PovrayWave> waves;
  TableRandom random(static_cast<std::uint32_t>(-560851967));
  for (std::uint32_t i = 0; i < count; ++i)
    waves.push_back(
        {normalize(povray_noise_vector({double(i), 0, 0})), random.next() * 0.000030518509476 + 0.01});
  return waves;
}

}  // namespace

void povray_corners(std::int64_t x, std::int64_t y, std::int64_t z, const double* (&corners)[8]) {
  std::uint32_t rows[8];
  corner_rows(x, y, z, rows);
  for (int i = 0; i < 8; ++i) corners[i] = kSlopes.at[rows[i]];
}

double povray_noise(const Vec3d& p, NoiseGenerator generator) {
  if (generator == NoiseGenerator::povray_3) {
    static const GradientTable table;
    return std::clamp(0.5 * (1.59 * table.at(p) + 0.985), 0.0, 1.0);
  }
  double sum[1];
  sums_at(p, sum);
  return std::clamp(generator == NoiseGenerator::povray_1 ? sum[0] + 0.5 : (sum[0] + 1.05242) * 0.48985582,
                    0.0, 1.0);
}

Vec3d povray_noise_vector(const Vec3d& p) {
  double sums[3];
  sums_at(p, sums);
  return {sums[0], sums[1], sums[2]};
}

double povray_cell_number(std::int64_t x, std::int64_t y, std::int64_t z, int which) {
  static const std::vector<double> numbers = make_cell_numbers();
  const auto part = [](std::int64_t cell) { return static_cast<std::uint32_t>(cell) % kPeriod; };
  const std::uint32_t first = kPermutation[kPermutation[kPermutation[part(x)] ^ part(y)] ^ part(z)];
  return numbers[first + static_cast<std::uint32_t>(which)];
}

PovrayWave povray_wave(std::uint32_t number) {
  // As many as patterns of scene files have.
  static const std::vector<PovrayWave> first = make_waves(100);
  return number < first.size() ? first[number] : make_waves(number + 1).back();
}

}  // namespace oktett
