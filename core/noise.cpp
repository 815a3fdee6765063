#include "core/noise.h"

#include <algorithm>
#include <bit>

#include "core/noise_steps.h"
#include "core/povray_lattice.h"
#include "core/random.h"

namespace oktett {

std::int64_t cell_of(double x) { return std::abs(x) < 0x1p62 ? static_cast<std::int64_t>(std::floor(x)) : 0; }

std::uint64_t lattice_bits(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t bits = mix_bits(static_cast<std::uint64_t>(x) + kGoldenBits);
  bits = mix_bits(bits + static_cast<std::uint64_t>(y) + kGoldenBits);
  return mix_bits(bits + static_cast<std::uint64_t>(z) + kGoldenBits);
}

namespace {

using noise_steps::between, noise_steps::mix;

/// A coordinate as the integer below it and what it is above that; with 0 and NaN where it is not finite.
struct CellCoordinate {
  std::int64_t cell;
  double fraction;
};
CellCoordinate split(double x) {
  if (!(std::abs(x) < 0x1p51)) return {cell_of(x), fraction_of(x)};
  const auto whole = static_cast<std::int64_t>(x);
  const double off = static_cast<double>(whole) > x ? 1 : 0, floor = static_cast<double>(whole) - off;
  // Not -0.
  return {whole - static_cast<std::int64_t>(off), (x - floor) + 0.0};
}

/// Where a corner of a cell lies in the cell: bit k of its number is its coordinate k.
Vec3d corner_place(int i) {
  return {static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)};
}

/// The scalar product of `d` with the gradient of a lattice point: one of the twelve vectors to the middles
/// of the edges of a cube.
double edge_product(std::uint64_t bits, const Vec3d& d) {
  // Without branches, which nothing could predict.
  const double part[4] = {d.x, d.y, d.z, d.x};
  const std::uint64_t k = (bits >> 32) % 3;
  const auto turned = [](double x, std::uint64_t sign) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) ^ sign << 63);
  };
  return turned(part[k], bits & 1) + turned(part[k + 1], bits >> 1 & 1);
}

/// lattice_bits of the corners of a cell; neighbours have their first steps in common.
void corner_bits(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t (&bits)[8]) {
  const auto next = [](std::uint64_t from, std::int64_t coordinate, int step) {
    return mix_bits(from + (static_cast<std::uint64_t>(coordinate) + static_cast<std::uint64_t>(step)) +
                    kGoldenBits);
  };
  std::uint64_t of_x[2], of_xy[4];
  for (int i = 0; i < 2; ++i) of_x[i] = next(0, x, i);
  for (int i = 0; i < 4; ++i) of_xy[i] = next(of_x[i & 1], y, i >> 1);
  for (int i = 0; i < 8; ++i) bits[i] = next(of_xy[i & 3], z, i >> 2);
}

/// That vector itself.
Vec3d edge_vector(std::uint64_t bits) {
  return {edge_product(bits, {1, 0, 0}), edge_product(bits, {0, 1, 0}), edge_product(bits, {0, 0, 1})};
}

/// What a kind of noise has at the corners of cells, and how it goes over from one to the next.
struct GradientLattice {
  using Corner = std::uint64_t;
  static constexpr NoiseKind kKind = NoiseKind::gradient;
  static constexpr double kSteepest = 1.875;  ///< fade_slope at 1/2, where it is greatest
  static void corners(std::int64_t x, std::int64_t y, std::int64_t z, Corner (&c)[8]) {
    corner_bits(x, y, z, c);
  }
  static double at_corner(Corner) { return 0; }
  static double product(Corner c, const Vec3d& d) { return edge_product(c, d); }
  static Vec3d vector(Corner c) { return edge_vector(c); }
  static double fade(double t) { return noise_steps::fade(t); }
  static double fade_slope(double t) { return 30 * (t * t) * ((t - 1) * (t - 1)); }
};
struct PovrayLattice {
  using Corner = const double*;
  static constexpr NoiseKind kKind = NoiseKind::povray;
  static constexpr double kSteepest = 1.5;
  static void corners(std::int64_t x, std::int64_t y, std::int64_t z, Corner (&c)[8]) {
    povray_corners(x, y, z, c);
  }
  static double at_corner(Corner c) { return c[0]; }
  static double product(Corner c, const Vec3d& d) { return c[0] + dot(vector(c), d); }
  static Vec3d vector(Corner c) { return {c[1], c[2], c[3]}; }
  static double fade(double t) { return t * t * (3 - 2 * t); }
  static double fade_slope(double t) { return 6 * t * (1 - t); }
};

/// Calls f with the lattice of a kind.
template <class F>
auto with_lattice(NoiseKind kind, const F& f) {
  return kind == NoiseKind::gradient ? f(GradientLattice{}) : f(PovrayLattice{});
}

/// Between four edges of the cell along one of the axes; rise(i, j) is of the edge from corner i to j.
template <class T, class Rise>
T between_edges(int axis, const T (&t)[3], const Rise& rise) {
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2, step = 1 << axis;
  T edge[4];
  for (int i = 0; i < 4; ++i) {
    const int from = (i & 1) << first | (i >> 1) << second;
    edge[i] = rise(from, from | step);
  }
  return mix(mix(edge[0], edge[1], t[first]), mix(edge[2], edge[3], t[first]), t[second]);
}

/// A point's place in its cell, and what the cell's corners have there.
template <class L>
struct Place {
  explicit Place(const Vec3d& p) {
    const CellCoordinate x = split(p.x), y = split(p.y), z = split(p.z);
    L::corners(x.cell, y.cell, z.cell, lattice);
    f = {x.fraction, y.fraction, z.fraction};
    for (int i = 0; i < 8; ++i) corner[i] = L::product(lattice[i], f - corner_place(i));
    for (int k = 0; k < 3; ++k) t[k] = L::fade(f[k]);
  }

  typename L::Corner lattice[8];
  Vec3d f;
  double corner[8], t[3];
};

}  // namespace

double gradient_noise(const Vec3d& p) { return noise_value(p, NoiseKind::gradient); }

double noise_value(const Vec3d& p, NoiseKind kind) {
  return with_lattice(kind, [&]<class L>(L) {
    const Place<L> at(p);
    return between(at.corner, at.t);
  });
}

NoiseSlope noise_slope(const Vec3d& p, NoiseKind kind) {
  return with_lattice(kind, [&]<class L>(L) {
    const Place<L> at(p);
    NoiseSlope slope{between(at.corner, at.t), {}};
    Vec3d vectors[8];
    for (int i = 0; i < 8; ++i) vectors[i] = L::vector(at.lattice[i]);
    for (int k = 0; k < 3; ++k) {
      const double steep = L::fade_slope(at.f[k]);
      slope.gradient[k] = between_edges(k, at.t, [&](int i, int j) {
        return (at.corner[j] - at.corner[i]) * steep + mix(vectors[i][k], vectors[j][k], at.t[k]);
      });
    }
    return slope;
  });
}

namespace {

/// Computed without rounding outwards: noise_range widens what it returns by all errors.
struct Stretch {
  double lo, hi;
};

Stretch operator+(const Stretch& a, const Stretch& b) { return {a.lo + b.lo, a.hi + b.hi}; }
/// By a range of numbers that are not negative.
Stretch scaled(const Stretch& a, const Stretch& by) {
  return {a.lo * (a.lo < 0 ? by.hi : by.lo), a.hi * (a.hi < 0 ? by.lo : by.hi)};
}
/// Of all means: `t` is in [0, 1], and a mean rises with what it is a mean of.
Stretch mix(const Stretch& a, const Stretch& b, const Stretch& t) {
  const double lo[2] = {mix(a.lo, b.lo, t.lo), mix(a.lo, b.lo, t.hi)};
  const double hi[2] = {mix(a.hi, b.hi, t.lo), mix(a.hi, b.hi, t.hi)};
  return {std::min(lo[0], lo[1]), std::max(hi[0], hi[1])};
}
/// Of the scalar product of `g` with the points of a box.
Stretch product(const Vec3d& g, const Vec3d& lo, const Vec3d& hi) {
  Stretch r{0, 0};
  for (int k = 0; k < 3; ++k)
    r = r + Stretch{g[k] * (g[k] < 0 ? hi[k] : lo[k]), g[k] * (g[k] < 0 ? lo[k] : hi[k])};
  return r;
}

/// Of a box in one cell: of the value, and of the three derivatives.
template <class L>
void range_in_cell(const typename L::Corner (&lattice)[8], const Vec3d& lo, const Vec3d& hi,
                   Stretch (&out)[4]) {
  Vec3d vectors[8];
  Stretch corner[8], t[3];
  for (int i = 0; i < 8; ++i) {
    const Vec3d at = corner_place(i);
    const double value = L::at_corner(lattice[i]);
    vectors[i] = L::vector(lattice[i]);
    corner[i] = product(vectors[i], lo - at, hi - at) + Stretch{value, value};
  }
  for (int k = 0; k < 3; ++k)
    t[k] = {std::clamp(L::fade(lo[k]), 0.0, 1.0), std::clamp(L::fade(hi[k]), 0.0, 1.0)};
  out[0] = between(corner, t);
  for (int k = 0; k < 3; ++k) {
    // It rises up to 1/2 and falls from there.
    const double a = L::fade_slope(lo[k]), b = L::fade_slope(hi[k]);
    const Stretch steep{std::min(a, b), lo[k] <= 0.5 && 0.5 <= hi[k] ? L::kSteepest : std::max(a, b)};
    out[1 + k] = between_edges(k, t, [&](int i, int j) {
      // The difference of two products is one with the difference of the vectors, but for a constant.
      const double apart = dot(vectors[i], corner_place(i)) - dot(vectors[j], corner_place(j)) +
                           (L::at_corner(lattice[j]) - L::at_corner(lattice[i]));
      const Stretch rise = product(vectors[j] - vectors[i], lo, hi) + Stretch{apart, apart};
      const Stretch from{vectors[i][k], vectors[i][k]}, to{vectors[j][k], vectors[j][k]};
      return scaled(rise, steep) + mix(from, to, t[k]);
    });
  }
}

template <class L>
NoiseRange range_of(const Vec3d& lo, const Vec3d& hi) {
  constexpr double kFar = 0x1p50, kMostCells = 8;
  constexpr NoiseBounds kMost = bounds_of(L::kKind);
  const Vec3d steepest{kMost.slope, kMost.slope, kMost.slope};
  const NoiseRange all{-kMost.value, kMost.value, -steepest, steepest};
  std::int64_t first[3], last[3];
  double cells = 1;
  for (int k = 0; k < 3; ++k) {
    if (!(-kFar <= lo[k] && lo[k] <= hi[k] && hi[k] <= kFar)) return all;
    first[k] = cell_of(lo[k]);
    // A border belongs to the cells on both sides, which agree there.
    last[k] = std::max(first[k], static_cast<std::int64_t>(std::ceil(hi[k])) - 1);
    cells *= static_cast<double>(last[k] - first[k] + 1);
  }
  if (cells > kMostCells) return all;
  Stretch whole[4];
  bool is_first = true;
  for (std::int64_t z = first[2]; z <= last[2]; ++z)
    for (std::int64_t y = first[1]; y <= last[1]; ++y)
      for (std::int64_t x = first[0]; x <= last[0]; ++x) {
        typename L::Corner lattice[8];
        L::corners(x, y, z, lattice);
        const double corner[3] = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        Vec3d from, to;
        for (int k = 0; k < 3; ++k)
          from[k] = std::clamp(lo[k] - corner[k], 0.0, 1.0), to[k] = std::clamp(hi[k] - corner[k], 0.0, 1.0);
        Stretch part[4];
        range_in_cell<L>(lattice, from, to, part);
        for (int i = 0; i < 4; ++i)
          whole[i] = is_first ? part[i]
                              : Stretch{std::min(whole[i].lo, part[i].lo), std::max(whole[i].hi, part[i].hi)};
        is_first = false;
      }
  NoiseRange range;
  Vec3d middle;
  double reach = 0;
  for (int k = 0; k < 3; ++k) {
    range.slope_lo[k] = std::max(whole[1 + k].lo - kNoiseSlopeError, -kMost.slope);
    range.slope_hi[k] = std::min(whole[1 + k].hi + kNoiseSlopeError, kMost.slope);
    middle[k] = lo[k] + 0.5 * (hi[k] - lo[k]);
    reach += std::max(-range.slope_lo[k], range.slope_hi[k]) * std::max(middle[k] - lo[k], hi[k] - middle[k]);
  }
  if (reach < 1) {
    // By the mean value theorem, which tells more of small boxes.
    const double at = noise_value(middle, L::kKind);
    whole[0].lo = std::max(whole[0].lo, at - reach), whole[0].hi = std::min(whole[0].hi, at + reach);
  }
  range.lo = std::max(whole[0].lo - kNoiseError, -kMost.value);
  range.hi = std::min(whole[0].hi + kNoiseError, kMost.value);
  return range;
}

}  // namespace

NoiseRange noise_range(const Vec3d& lo, const Vec3d& hi, NoiseKind kind) {
  return with_lattice(kind, [&]<class L>(L) { return range_of<L>(lo, hi); });
}

}  // namespace oktett
