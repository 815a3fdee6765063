#include "render/pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/random.h"

namespace oktett {
namespace {

/// The integer below `x` as a number for hashing; 0 where it does not fit.
std::int64_t cell_of(double x) { return std::abs(x) < 0x1p62 ? static_cast<std::int64_t>(std::floor(x)) : 0; }

/// Random bits of a point of the integer lattice.
std::uint64_t lattice_bits(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t bits = mix_bits(static_cast<std::uint64_t>(x) + kGoldenBits);
  bits = mix_bits(bits + static_cast<std::uint64_t>(y) + kGoldenBits);
  return mix_bits(bits + static_cast<std::uint64_t>(z) + kGoldenBits);
}

/// The scalar product of `d` with the gradient of a lattice point: one of the twelve vectors to the middles
/// of the edges of a cube.
double edge_product(std::uint64_t bits, const Vec3d& d) {
  const double a = bits & 1 ? -1 : 1, b = bits & 2 ? -1 : 1;
  switch ((bits >> 32) % 3) {
    case 0:
      return a * d.x + b * d.y;
    case 1:
      return a * d.y + b * d.z;
    default:
      return a * d.z + b * d.x;
  }
}

/// 0 at 0 and 1 at 1, with first and second derivatives of 0 there.
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double mix(double a, double b, double t) { return a + (b - a) * t; }

/// Gradient noise after Perlin (2002) in [-1, 1]; 0 at the points of the integer lattice.
double gradient_noise(const Vec3d& p) {
  const std::int64_t x = cell_of(p.x), y = cell_of(p.y), z = cell_of(p.z);
  const Vec3d f{p.x - std::floor(p.x), p.y - std::floor(p.y), p.z - std::floor(p.z)};
  double corner[8];
  for (int i = 0; i < 8; ++i) {
    const int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
    corner[i] = edge_product(lattice_bits(x + dx, y + dy, z + dz), f - Vec3d{1.0 * dx, 1.0 * dy, 1.0 * dz});
  }
  const double u = fade(f.x), v = fade(f.y), w = fade(f.z);
  const double low = mix(mix(corner[0], corner[1], u), mix(corner[2], corner[3], u), v);
  const double high = mix(mix(corner[4], corner[5], u), mix(corner[6], corner[7], u), v);
  return mix(low, high, w);
}

/// Noise of all octaves, in [-1, 1].
double turbulence(const Turbulence& t, Vec3d p) {
  double sum = 0, total = 0, weight = 1;
  for (std::uint32_t octave = 0; octave < t.octaves; ++octave) {
    sum += weight * gradient_noise(p);
    total += weight;
    weight *= t.roughness;
    // Moved by a half, so that the zeros of the octaves do not fall together.
    p = p * 2 + Vec3d{0.5, 0.5, 0.5};
  }
  return sum / total;
}

double value_of(const CheckerPattern& c, const Vec3d& p) {
  // Moved a little, so that faces at multiples of the size do not lie where the colours meet.
  constexpr double kAside = 0x1p-12;
  const Vec3d q = p / c.size;
  const std::int64_t sum = cell_of(q.x + kAside) + cell_of(q.y + kAside) + cell_of(q.z + kAside);
  return (sum & 1) != 0 ? 1 : 0;
}

double value_of(const GradientPattern& g, const Vec3d& p) {
  const Vec3d along = g.to - g.from;
  return dot(p - g.from, along) / dot(along, along);
}

double value_of(const RadialPattern& r, const Vec3d& p) {
  return (length(p - r.center) - r.inner) / (r.outer - r.inner);
}

double value_of(const NoisePattern& n, const Vec3d& p) {
  return 0.5 + 0.5 * turbulence(n.turbulence, p / n.size);
}

double value_of(const MarblePattern& m, const Vec3d& p) {
  const Vec3d q = p / m.size;
  const double layer = q.x + m.distortion * turbulence(m.turbulence, q);
  return 0.5 - 0.5 * portable::cos(2 * std::numbers::pi * (layer - std::floor(layer)));
}

double value_of(const WoodPattern& w, const Vec3d& p) {
  const Vec3d q = p / w.size;
  // Noise is drawn out along the trunk.
  const double bend = turbulence(w.turbulence, Vec3d{q.x, q.y * 0.1, q.z} * 0.25);
  const double ring = std::sqrt(q.x * q.x + q.z * q.z) + 4 * w.distortion * bend;
  const double part = ring - std::floor(ring);
  return part * part * (3 - 2 * part);
}

/// What a pattern looks like at this scale is smooth.
double detail_of(const Pattern& pattern) {
  return std::visit(
      [](const auto& kind) -> double {
        if constexpr (requires { kind.turbulence; })
          return kind.size * portable::exp2(-static_cast<double>(kind.turbulence.octaves));
        else if constexpr (requires { kind.size; })
          return kind.size;
        else if constexpr (requires { kind.outer; })
          return kind.outer - kind.inner;
        else
          return length(kind.to - kind.from);
      },
      pattern);
}

}  // namespace

double pattern_value(const Pattern& pattern, const Vec3d& p) {
  const double value = std::visit([&](const auto& kind) { return value_of(kind, p); }, pattern);
  // A NaN becomes 0.
  return value > 0 ? std::min(value, 1.0) : 0;
}

Color pattern_color(const PatternTexture& texture, const Vec3d& p) {
  const std::vector<Color>& colors = texture.colors;
  const std::size_t last = colors.size() - 1;
  const double at = pattern_value(texture.pattern, texture.to_pattern.point(p)) * static_cast<double>(last);
  const auto before = static_cast<std::size_t>(at);
  if (before >= last) return colors[last];
  const auto part = static_cast<float>(at - static_cast<double>(before));
  return colors[before] * (1 - part) + colors[before + 1] * part;
}

Vec3d pattern_slope(const PatternTexture& texture, const Vec3d& p) {
  const std::vector<Color>& colors = texture.colors;
  const auto height = [&](const Vec3d& q) {
    const double at = pattern_value(texture.pattern, q) * static_cast<double>(colors.size() - 1);
    const auto before = std::min(static_cast<std::size_t>(at), colors.size() - 1);
    const auto after = std::min(before + 1, colors.size() - 1);
    const double low = colors[before].x, high = colors[after].x;
    return low + (high - low) * (at - static_cast<double>(before));
  };
  const Vec3d place = texture.to_pattern.point(p);
  const double step = detail_of(texture.pattern) * 0x1p-10;
  Vec3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d before = place, after = place;
    before[axis] -= step, after[axis] += step;
    slope[axis] = (height(after) - height(before)) / (after[axis] - before[axis]);
  }
  return texture.to_pattern.normal_by_inverse(slope);
}

}  // namespace oktett
