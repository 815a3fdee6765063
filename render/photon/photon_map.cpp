#include "render/photon/photon_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "core/random.h"

namespace oktett {

// ---- A photon that has arrived at a surface, as it is kept in memory and in files.

static double sign_of(double x) { return x < 0 ? -1 : 1; }

static std::uint32_t to_bits(double x) {
  return static_cast<std::uint32_t>(std::clamp(x * 32767 + 32768.5, 1.0, 65535.0));
}

static double from_bits(std::uint32_t bits) { return (std::max(bits, 1u) - 32768.0) / 32767; }

std::uint32_t pack_direction(const Vec3f& direction) {
  const Vec3d d(direction);
  const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  double x = d.x / sum, y = d.y / sum;
  if (d.z < 0) {
    const double folded = (1 - std::abs(y)) * sign_of(x);
    y = (1 - std::abs(x)) * sign_of(y), x = folded;
  }
  return to_bits(x) << 16 | to_bits(y);
}

Vec3f unpack_direction(std::uint32_t packed) {
  const double x = from_bits(packed >> 16), y = from_bits(packed & 0xffff);
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z >= 0) return Vec3f(normalize(Vec3d{x, y, z}));
  return Vec3f(normalize(Vec3d{(1 - std::abs(y)) * sign_of(x), (1 - std::abs(x)) * sign_of(y), z}));
}

PhotonPass::PhotonPass(Column<Photon> photons, float radius) : radius_(radius), per_cell_(0.499 / radius) {
  const auto count = static_cast<std::uint32_t>(photons.size());
  const std::uint32_t buckets = std::bit_ceil(std::max(count, 1u));
  mask_ = buckets - 1;
  const auto bucket_of = [&](const Photon& p) {
    return bucket(cell(p.position.x), cell(p.position.y), cell(p.position.z));
  };
  // Sorting by counting keeps the order within a bucket.
  start_ = Column<std::uint32_t>(std::size_t{buckets} + 1, 0u);
  for (const Photon& p : photons) ++start_[bucket_of(p) + 1];
  for (std::uint32_t b = 0; b < buckets; ++b) start_[b + 1] += start_[b];
  Column<std::uint32_t> next = start_;
  photons_.resize_uninitialized(count);
  for (const Photon& p : photons) photons_[next[bucket_of(p)]++] = p;
}

std::uint32_t PhotonPass::bucket(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const auto bits = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
  const std::uint64_t key = mix_bits(mix_bits(mix_bits(bits(x)) + bits(y)) + bits(z));
  return static_cast<std::uint32_t>(key) & mask_;
}

int PhotonPass::buckets_near(const Vec3f& p, std::uint32_t (&buckets)[8]) const {
  std::int64_t lo[3], hi[3];
  for (int k = 0; k < 3; ++k) {
    lo[k] = cell(double{p[k]} - radius_);
    hi[k] = std::min(cell(double{p[k]} + radius_), lo[k] + 1);
  }
  int count = 0;
  for (std::int64_t z = lo[2]; z <= hi[2]; ++z)
    for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
      for (std::int64_t x = lo[0]; x <= hi[0]; ++x) {
        const std::uint32_t b = bucket(x, y, z);
        if (std::find(buckets, buckets + count, b) == buckets + count) buckets[count++] = b;
      }
  return count;
}

double pass_radius(double first, std::uint32_t pass) {
  double square = first * first;
  for (std::uint32_t i = 1; i <= pass; ++i) square *= (i + 2.0 / 3) / (i + 1.0);
  return std::sqrt(square);
}

double usual_radius(const Column<Photon>& photons) {
  constexpr std::size_t kAsked = 129, kNeighbours = 32;
  if (photons.size() < 2) return 0;
  const std::size_t asked = std::min(kAsked, photons.size());
  const std::size_t neighbours = std::min(kNeighbours, photons.size() - 1);
  std::vector<float> squares(photons.size()), found;
  for (std::size_t k = 0; k < asked; ++k) {
    const Vec3f& from = photons[k * photons.size() / asked].position;
    for (std::size_t i = 0; i < photons.size(); ++i) {
      const Vec3f to = photons[i].position - from;
      squares[i] = dot(to, to);
    }
    const auto place = squares.begin() + static_cast<std::ptrdiff_t>(neighbours);
    std::nth_element(squares.begin(), place, squares.end());
    found.push_back(*place);
  }
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::nth_element(found.begin(), middle, found.end());
  return std::sqrt(double{*middle});
}

}  // namespace oktett
