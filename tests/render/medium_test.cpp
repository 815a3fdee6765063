/// \file The phase function, and tracking through single media.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/math.h"
#include "render/medium/medium_tracker.h"
#include "render/sampling/owen_sobol.h"

namespace oktett::medium_test {
namespace {

constexpr float kAnisotropies[] = {0, 0.0005f, -0.3f, 0.5f, 0.9f, -0.95f, 0.99f, 0.999f};

/// Henyey and Greenstein's formula as it is printed.
double printed(double cosine, double g) {
  return (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

/// The direction at an angle from the unit vector `z`.
Vec3f turned(const Vec3f& z, double cosine, double angle) {
  Vec3d x, y;
  const Vec3d axis = normalize(Vec3d(z));
  make_basis(axis, x, y);
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  return Vec3f(normalize(x * (sine * std::cos(angle)) + y * (sine * std::sin(angle)) + axis * cosine));
}

// The integral over all directions is 1 and the mean cosine is the anisotropy. The cosine is cos(a) with
// a = pi s^3, which puts steps close to the peak.
TEST(Phase, IsADensityWithTheAnisotropyAsItsMeanCosine) {
  const Vec3f direction = normalize(Vec3f{0.3f, -0.5f, 0.8f});
  for (const float g : kAnisotropies) {
    constexpr int kSteps = 40000;
    double sum = 0, mean = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double s = (i + 0.5) / kSteps, angle = std::numbers::pi * s * s * s;
      const double polar = g < 0 ? std::numbers::pi - angle : angle;
      const Vec3f onward = turned(direction, std::cos(polar), 1 + 5 * s);
      const double value = static_cast<double>(phase_value(direction, onward, g));
      const double share =
          value * 2 * std::numbers::pi * std::sin(polar) * 3 * std::numbers::pi * s * s / kSteps;
      sum += share, mean += share * std::cos(polar);
      if (std::abs(g) <= 0.9f) {
        EXPECT_NEAR(value, printed(std::cos(polar), static_cast<double>(g)), 2e-5 * value)
            << g << " " << polar;
      }
    }
    // Directions in float are 1e-7 apart, which the narrowest peak shows.
    const double blur = std::abs(g) > 0.95f ? 2e-3 : 1e-5;
    EXPECT_NEAR(sum, 1, blur) << g;
    EXPECT_NEAR(mean, static_cast<double>(g), blur) << g;
  }
}

// Samples against the density: chi-squared over 32 zones, whose probabilities come from the closed form of
// the integral, times 8 sectors.
TEST(Phase, SamplesFollowTheDensity) {
  const Vec3f direction = normalize(Vec3f{-0.2f, 0.7f, -0.4f});
  Vec3d x, y;
  const Vec3d z = normalize(Vec3d(direction));
  make_basis(z, x, y);
  for (const float anisotropy : kAnisotropies) {
    const auto g = static_cast<double>(anisotropy);
    constexpr int kZones = 32, kSectors = 8, kSamples = 200000;
    // The probability of a cosine below c.
    const auto below = [&](double c) {
      if (std::abs(g) < 1e-2) return (1 + c) / 2 + 3 * g / 4 * (c * c - 1);
      return (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g - 2 * g * c) - 1 / (1 + g));
    };
    std::vector<double> count(kZones * kSectors);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const SquareSample u{random_bits(5, i, 0) * 0x1p-64, random_bits(5, i, 1) * 0x1p-64};
      const Vec3d d(phase_direction(direction, anisotropy, u));
      EXPECT_NEAR(length(d), 1, 1e-6);
      const double cosine = 1 - dot(d - z, d - z) / 2;
      const int zone = std::clamp(static_cast<int>(below(cosine) * kZones), 0, kZones - 1);
      const double turn = std::atan2(dot(d, y), dot(d, x)) / (2 * std::numbers::pi) + 0.5;
      ++count[static_cast<std::size_t>(zone * kSectors + std::min(static_cast<int>(turn * kSectors), 7))];
    }
    const double expected = static_cast<double>(kSamples) / (kZones * kSectors);
    double chi_squared = 0;
    for (const double n : count) chi_squared += (n - expected) * (n - expected) / expected;
    const double freedom = kZones * kSectors - 1;
    EXPECT_LT(chi_squared, freedom + 5 * std::sqrt(2 * freedom)) << anisotropy;
  }
}

TEST(Phase, BoundsItsAnisotropy) {
  const Vec3f z{0, 0, 1};
  EXPECT_EQ(phase_value(z, z, 1), phase_value(z, z, kMostAnisotropy));
  EXPECT_TRUE(std::isfinite(phase_value(z, z, 1)));
  EXPECT_EQ(phase_value(z, -z, NAN), phase_value(z, -z, 0));
  for (const SquareSample u : {SquareSample{0, 0}, SquareSample{1 - 0x1p-32, 0.5}})
    for (const float g : {-2.0f, 1.0f}) EXPECT_NEAR(length(phase_direction(z, g, u)), 1, 1e-6f);
}

/// Means over many passages: of the throughput that leaves the segment, and of that at places of scattering
/// before and behind the middle.
struct Shares {
  Vec3d through, near, far, emitted;
};

Shares shares(const MediumTracker& tracker, const MediumSegment& segment, const Color& throughput,
              int count) {
  Shares s;
  for (int i = 0; i < count; ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    TrackingNumbers numbers(77, number);
    const MediumPassage p = tracker.pass(segment, throughput, sobol_point(number, 1234), numbers);
    const Vec3d value = Vec3d(p.throughput) / count;
    s.emitted += Vec3d(p.emitted) / count;
    if (!p.scattered)
      s.through += value;
    else
      (p.t < segment.length / 2 ? s.near : s.far) += value;
    EXPECT_TRUE(!p.scattered || (p.t >= 0 && p.t < segment.length));
  }
  return s;
}

// What passes, what is scattered in each half, and what glows, against their integrals; also where some
// channels do not scatter or absorb at all, and with unequal throughput.
TEST(MediumTracker, HomogeneousPassagesHaveTheRightMeans) {
  Medium m;
  for (const auto& [absorption, scattering] :
       {std::pair{Color{0.5f, 0.5f, 0.5f}, Color{1, 1, 1}},
        std::pair{Color{0, 0.1f, 3}, Color{0.2f, 2, 0.7f}}, std::pair{Color{0, 1, 0}, Color{2, 0, 0}},
        std::pair{Color{1, 2, 0}, Color{0, 0, 0}}, std::pair{Color{1e-6f, 0, 0}, Color{1e-7f, 0, 1e-3f}}}) {
    m.absorption = absorption, m.scattering = scattering, m.emission = {0.5f, 1, 2};
    const MediumTracker tracker(m);
    const double length = 1.7;
    const Color throughput{1, 0.3f, 0.6f};
    const Shares s = shares(tracker, {{0, 0, 0}, {0, 0, 1}, length}, throughput, 1 << 16);
    TrackingNumbers numbers(0, 0);
    const Color passed = tracker.transmittance({{0, 0, 0}, {0, 0, 1}, length}, numbers);
    for (int c = 0; c < 3; ++c) {
      const double sigma = static_cast<double>(absorption[c]) + static_cast<double>(scattering[c]);
      const double weight = static_cast<double>(throughput[c]);
      const double through = std::exp(-sigma * length), half = std::exp(-sigma * length / 2);
      const double albedo = sigma > 0 ? static_cast<double>(scattering[c]) / sigma : 0;
      const double glow = sigma > 0 ? -std::expm1(-sigma * length) / sigma : length;
      EXPECT_NEAR(static_cast<double>(passed[c]), through, 1e-6);
      EXPECT_NEAR(s.through[c], weight * through, 2e-3);
      EXPECT_NEAR(s.near[c], weight * albedo * (1 - half), 2e-3);
      EXPECT_NEAR(s.far[c], weight * albedo * (half - through), 2e-3);
      EXPECT_NEAR(s.emitted[c], weight * static_cast<double>(m.emission[c]) * glow, 1e-5);
    }
  }
}

// Glow in thin and thick media, where 1 - e^-x cancels and where it does not.
TEST(MediumTracker, GlowIsExactAtEveryThickness) {
  Medium m;
  m.emission = {1, 1, 1};
  for (double sigma = 1e-8; sigma < 100; sigma *= 1.7) {
    m.absorption = {static_cast<float>(sigma), 0, 0};
    TrackingNumbers numbers(1, 0);
    const MediumPassage p = MediumTracker(m).pass({{0, 0, 0}, {0, 0, 1}, 1}, {1, 1, 1}, {0.5, 0.5}, numbers);
    const auto depth = static_cast<double>(m.absorption.x);
    EXPECT_NEAR(p.emitted.x, -std::expm1(-depth) / depth, 2e-7) << sigma;
    EXPECT_EQ(p.emitted.y, 1);
  }
}

TEST(MediumTracker, ExtremeMediaAreDefined) {
  Medium m;
  m.scattering = {1e9f, 1e9f, 1e9f};
  TrackingNumbers numbers(0, 0);
  const MediumSegment endless{{0, 0, 0}, {0, 0, 1}, std::numeric_limits<double>::infinity()};
  MediumPassage p = MediumTracker(m).pass(endless, {1, 1, 1}, {0.5, 0.5}, numbers);
  EXPECT_TRUE(p.scattered);
  EXPECT_LT(p.t, 1e-8);
  EXPECT_EQ(p.throughput, (Color{1, 1, 1}));
  EXPECT_EQ(MediumTracker(m).transmittance(endless, numbers), (Color{0, 0, 0}));
  // Negative and NaN coefficients count as 0: nothing happens on an endless way.
  m.scattering = {-1, NAN, 0}, m.absorption = {NAN, -3, 0}, m.emission = {NAN, -1, 0};
  p = MediumTracker(m).pass(endless, {1, 2, 3}, {0.5, 0.5}, numbers);
  EXPECT_FALSE(p.scattered);
  EXPECT_EQ(p.throughput, (Color{1, 2, 3}));
  EXPECT_EQ(p.emitted, (Color{0, 0, 0}));
  // A path without throughput goes on without any.
  m.scattering = {1, 1, 1};
  p = MediumTracker(m).pass(endless, {0, 0, 0}, {0.5, 0.5}, numbers);
  EXPECT_EQ(p.throughput, (Color{0, 0, 0}));
}

}  // namespace
}  // namespace oktett::medium_test
