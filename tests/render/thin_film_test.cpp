/// \file Reflection by thin films: against the wave optics of single wavelengths, summed by the tabulated
/// standard observer, and against closed forms for no film and for thick ones.

#include "render/bsdf/thin_film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/optics.h"
#include "tests/render/bsdf_support.h"

namespace oktett::thin_film_test {
namespace {

using Number = std::complex<double>;

/// The reflectance of a film of index `n` and thickness `d` on a base of complex index `base`, for one
/// wavelength: by the characteristic matrix of the film (Abeles), unlike the code.
double by_matrix(double n, double d, Number base, double wavelength, double cosine) {
  const double sine2 = 1 - cosine * cosine;
  const Number inside = std::sqrt(Number(1 - sine2 / (n * n))),
               below = std::sqrt(1.0 - sine2 / (base * base));
  const Number phase = 2 * std::numbers::pi * n * d / wavelength * inside;
  double sum = 0;
  for (const bool parallel : {false, true}) {
    // Admittances.
    const Number first = parallel ? 1 / cosine : cosine, film = parallel ? n / inside : n * inside,
                 last = parallel ? base / below : base * below;
    const Number i(0, 1), cos = std::cos(phase), sin = std::sin(phase);
    // With base n - ik.
    const Number b = cos + i * sin / film * last, c = i * film * sin + cos * last;
    sum += std::norm((first * b - c) / (first * b + c)) / 2;
  }
  return sum;
}

/// The standard observer of 1931 at 400, 420, ... 700 nm, as tabulated by the CIE.
constexpr double kObserver[][3] = {
    {0.0143, 0.0004, 0.0679}, {0.1344, 0.0040, 0.6456}, {0.3483, 0.0230, 1.7471}, {0.2908, 0.0600, 1.6692},
    {0.0956, 0.1390, 0.8130}, {0.0049, 0.3230, 0.2720}, {0.0633, 0.7100, 0.0782}, {0.2904, 0.9540, 0.0203},
    {0.5945, 0.9950, 0.0039}, {0.9163, 0.8700, 0.0017}, {1.0622, 0.6310, 0.0008}, {0.8544, 0.3810, 0.0002},
    {0.4479, 0.1750, 0.0000}, {0.1649, 0.0610, 0.0000}, {0.0468, 0.0170, 0.0000}, {0.0114, 0.0041, 0.0000}};

/// The colour of a reflectance by wavelength, relative to white.
template <class F>
Vec3d color_of(const F& reflectance) {
  Vec3d sum, white;
  for (std::size_t i = 0; i < std::size(kObserver); ++i) {
    const auto& [x, y, z] = kObserver[i];
    const Vec3d rgb{3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                    -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                    0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
    const double r = reflectance(400 + 20 * static_cast<double>(i));
    for (int k = 0; k < 3; ++k) sum[k] += rgb[k] * r, white[k] += rgb[k];
  }
  for (int k = 0; k < 3; ++k) sum[k] = std::clamp(sum[k] / white[k], 0.0, 1.0);
  return sum;
}

TEST(ThinFilm, ColoursAreThoseOfAirysFormula) {
  double most_colorful = 0, squares = 0;
  int count = 0;
  for (const Number base :
       {Number(1.5, 0), Number(2.4, 0), Number(1.1, 0), Number(0.3, 3.2), Number(2.9, 3.0)})
    for (const double ior : {1.3, 1.8, 2.4})
      for (double d = 50; d < 900; d += 50)
        for (const double cosine : {1.0, 0.8, 0.5, 0.25}) {
          const ThinFilm film(ior, d, Vec3d{1, 1, 1} * base.real(), Vec3d{1, 1, 1} * base.imag());
          const Vec3d got = film.reflectance(cosine);
          const Vec3d expected = color_of(
              [&](double wavelength) { return by_matrix(ior, d, std::conj(base), wavelength, cosine); });
          // Steps of 20 nm are coarse for narrow fringes.
          for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(got[k], expected[k], 0.06)
                << base << ' ' << ior << ' ' << d << ' ' << cosine << ' ' << k;
            squares += (got[k] - expected[k]) * (got[k] - expected[k]), ++count;
          }
          most_colorful = std::max(most_colorful, std::abs(got.x - got.y));
        }
  EXPECT_GT(most_colorful, 0.3);
  EXPECT_LT(std::sqrt(squares / count), 0.01);
}

TEST(ThinFilm, WithoutThicknessIsFresnels) {
  for (double cosine = 0.02; cosine <= 1; cosine += 0.07)
    for (const double ior : {1.0, 1.3, 2.4}) {
      const Vec3d eta{1.5, 2.4, 0.3}, k{0, 0, 3.2};
      const Vec3d got = ThinFilm(ior, 0, eta, k).reflectance(cosine);
      EXPECT_NEAR(got.x, fresnel(cosine, 1.5), 1e-9);
      EXPECT_NEAR(got.y, fresnel(cosine, 2.4), 1e-9);
      EXPECT_NEAR(got.z, conductor_fresnel(cosine, 0.3, 3.2), 1e-9);
    }
}

// As is the index of the base, or of air.
TEST(ThinFilm, AsDenseAsItsBaseIsThatOfTheBase) {
  for (double cosine = 0.02; cosine <= 1; cosine += 0.07)
    for (const double ior : {1.0, 1.5}) {
      const Vec3d got = ThinFilm(ior, 350, {1.5, 1.5, 1.5}).reflectance(cosine);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], fresnel(cosine, 1.5), 1e-9);
    }
}

// Light that interfaces reflect to each other adds up without phases: a geometric series.
TEST(ThinFilm, ThickFilmsHaveNoColour) {
  for (const double d : {8e3, 3e4, 1e5})
    for (const double cosine : {1.0, 0.6, 0.3}) {
      const double inside = std::sqrt(1 - (1 - cosine * cosine) / (1.4 * 1.4)),
                   below = std::sqrt(1 - (1 - cosine * cosine) / (2.0 * 2.0));
      double expected = 0;
      for (const bool parallel : {false, true}) {
        const auto part = [&](double n, double c, double m, double e) {
          const double r = parallel ? (m * c - n * e) / (m * c + n * e) : (n * c - m * e) / (n * c + m * e);
          return r * r;
        };
        const double first = part(1, cosine, 1.4, inside), second = part(1.4, inside, 2, below);
        expected += (first + (1 - first) * (1 - first) * second / (1 - first * second)) / 2;
      }
      const Vec3d got = ThinFilm(1.4, d, {2, 2, 2}).reflectance(cosine);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], expected, 2e-3) << d << ' ' << cosine;
    }
}

// --- The material

/// The coefficients of the delta lobes of a smooth surface, above and below.
struct Split {
  Vec3d above, below;
};
Split split(const PrincipledParameters& p, double mu, bool front = true) {
  const Bsdf bsdf = principled_bsdf(p, direction_at(mu, 0.4), front);
  constexpr int kSamples = 20000;
  Split sum;
  for (int i = 0; i < kSamples; ++i)
    if (const auto s = bsdf.sample((i + 0.5f) / kSamples, {0.3, 0.6}); s && s->delta)
      (s->transmitted ? sum.below : sum.above) += Vec3d(s->weight) / kSamples;
  return sum;
}

PrincipledParameters filmed() {
  PrincipledParameters p;
  p.roughness = 0, p.iridescence = 1, p.iridescence_thickness = 420, p.iridescence_ior = 1.8f;
  return p;
}

TEST(ThinFilm, MetalAndPlasticReflectByIt) {
  PrincipledParameters p = filmed();
  p.base_color = {0, 0, 0};
  const double n = double{p.iridescence_ior};
  for (const double mu : {1.0, 0.6, 0.2}) {
    const Vec3d plastic = ThinFilm(n, 420, {1.5, 1.5, 1.5}).reflectance(mu);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(split(p, mu).above[k], plastic[k], 1e-3);
    PrincipledParameters metal = filmed();
    metal.metallic = 1, metal.base_color = {0.9f, 0.5f, 0.25f};
    // Of a base that reflects head-on what its colour says.
    const auto index = [](double r) { return (1 + std::sqrt(r)) / (1 - std::sqrt(r)); };
    const Vec3d shown = ThinFilm(n, 420, {index(0.9), index(0.5), index(0.25)}).reflectance(mu);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(split(metal, mu).above[k], shown[k], 1e-3);
    // Half of it, half of what is without.
    PrincipledParameters half = metal, bare = metal;
    half.iridescence = 0.5f, bare.iridescence = 0;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(split(half, mu).above[k], (shown[k] + split(bare, mu).above[k]) / 2, 1e-3);
  }
}

TEST(ThinFilm, GlassLetsTheRestPassFromBothSides) {
  PrincipledParameters p = filmed();
  p.transmission = 1, p.base_color = {1, 1, 1};
  for (const double mu : {1.0, 0.8, 0.5, 0.2}) {
    const Split outside = split(p, mu);
    const Vec3d film = ThinFilm(double{p.iridescence_ior}, 420, {1.5, 1.5, 1.5}).reflectance(mu);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(outside.above[k], film[k], 2e-3);
      EXPECT_NEAR(outside.above[k] + outside.below[k], 1, 2e-3);
    }
    const Split inside = split(p, std::sqrt(1 - (1 - mu * mu) / 2.25), false);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(inside.above[k], outside.above[k], 2e-3) << mu;
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(split(p, 0.5, false).above[k], 1, 2e-3);
}

TEST(ThinFilm, WhiteSurfacesBelowItGainNoEnergy) {
  for (const int kind : {0, 1, 2, 3})
    for (const float roughness : {0.0f, 0.2f, 0.5f, 1.0f})
      for (const double thickness : {150.0, 420.0})
        for (const double mu : {0.05, 0.3, 0.7, 1.0}) {
          PrincipledParameters p = filmed();
          p.base_color = {1, 1, 1}, p.roughness = roughness,
          p.iridescence_thickness = static_cast<float>(thickness);
          p.metallic = kind == 0 ? 1 : 0, p.transmission = kind > 1 ? 1 : 0, p.thin = kind == 3;
          const Bsdf bsdf = principled_bsdf(p, direction_at(mu, 0.4), true);
          constexpr int kSide = 48;
          Vec3d sum;
          for (int i = 0; i < kSide * kSide; ++i) {
            const auto s = bsdf.sample((i * 1601 % (kSide * kSide) + 0.5f) / (kSide * kSide),
                                       {(i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide});
            if (s) sum += Vec3d(s->weight) / (kSide * kSide);
          }
          for (int k = 0; k < 3; ++k) {
            EXPECT_LT(sum[k], 1.02) << kind << ' ' << roughness << ' ' << thickness << ' ' << mu;
            EXPECT_GT(sum[k], 0.6) << kind << ' ' << roughness << ' ' << thickness << ' ' << mu;
          }
        }
}

}  // namespace
}  // namespace oktett::thin_film_test
