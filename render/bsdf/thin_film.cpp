#include "render/bsdf/thin_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/math.h"

namespace oktett {

namespace {

/// Wavenumbers at even distances, in 1 / micrometre, from a wavelength of 780 to one of 380 nm.
constexpr int kWaves = 48;
constexpr double kFirstWave = 1 / 0.78, kLastWave = 1 / 0.38,
                 kWaveStep = (kLastWave - kFirstWave) / (kWaves - 1);
/// Light of the first reflection and the second has no fixed phase within a channel if its way is longer by
/// this, micrometres.
constexpr double kIncoherent = 12;

/// How much of each channel a wave is; the weights of a channel add to 1. Some are below 0, as Rec.709's
/// primaries are no light of a single wavelength.
using ChannelWeights = std::array<Vec3d, kWaves>;

/// The standard observer's colour matching functions at a wavelength in nm, by Wyman's sums of curves.
Vec3d standard_observer(double wavelength) {
  const auto curve = [&](double height, double middle, double below, double above) {
    const double t = (wavelength - middle) / (wavelength < middle ? below : above);
    return height * portable::exp(-0.5 * t * t);
  };
  return {
      curve(1.056, 599.8, 37.9, 31.0) + curve(0.362, 442.0, 16.0, 26.7) + curve(-0.065, 501.1, 20.4, 26.2),
      curve(0.821, 568.8, 46.9, 40.5) + curve(0.286, 530.9, 16.3, 31.1),
      curve(1.217, 437.0, 11.8, 36.0) + curve(0.681, 459.0, 26.0, 13.8)};
}

ChannelWeights channel_weights() {
  ChannelWeights weights;
  Vec3d sum;
  for (int i = 0; i < kWaves; ++i) {
    const double wave = kFirstWave + i * kWaveStep;
    // Equal steps of wavelength are steps of wavenumber in proportion to its square.
    const Vec3d xyz = standard_observer(1000 / wave) * (1 / (wave * wave));
    const Vec3d rgb = rec709_of(xyz);
    weights[static_cast<std::size_t>(i)] = rgb;
    sum += rgb;
  }
  for (Vec3d& w : weights) w = {w.x / sum.x, w.y / sum.y, w.z / sum.z};
  return weights;
}

struct Complex {
  double re = 0, im = 0;
};
Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
Complex operator*(double s, const Complex& a) { return {s * a.re, s * a.im}; }
double norm(const Complex& a) { return a.re * a.re + a.im * a.im; }
Complex operator/(const Complex& a, const Complex& b) {
  const double n = norm(b);
  return {(a.re * b.re + a.im * b.im) / n, (a.im * b.re - a.re * b.im) / n};
}
/// The root in the first quadrant, of z.im >= 0: waves fade where they cannot go on.
Complex root(const Complex& z) {
  const double size = std::sqrt(norm(z));
  return {std::sqrt(std::max(0.0, (size + z.re) / 2)), std::sqrt(std::max(0.0, (size - z.re) / 2))};
}

/// What a polarisation passes through both interfaces at a phase d: through / (sum + re cos d - im sin d).
struct Passing {
  double through = 0, sum = 1, re = 0, im = 0, mean = 0;

  /// Of the reflected amplitudes `first` at the film and `second` below it, and the mean over all phases.
  Passing(double first, const Complex& second) {
    const double a2 = first * first, b2 = std::min(norm(second), 1.0);
    through = (1 - a2) * (1 - b2), sum = 1 + a2 * b2;
    re = 2 * first * second.re, im = 2 * first * second.im;
    mean = part_of(1 - a2 * b2);
  }
  Passing() = default;
  double at(double cosine, double sine) const { return part_of(sum + re * cosine - im * sine); }
  /// At most 1, also where both are rounded, as along the surface.
  double part_of(double all) const { return through > 0 ? through / std::max(all, through) : 0; }
};

}  // namespace

ThinFilm::ThinFilm(double ior, double thickness, const Vec3d& eta, const Vec3d& k)
    : ior_(ior), thickness_(thickness / 1000), eta_(eta), k_(k) {
  const auto is_even = [](const Vec3d& v) { return v.x == v.y && v.y == v.z; };
  indices_ = is_even(eta) && is_even(k) ? 1 : 3;
}

Vec3d ThinFilm::reflectance(double cosine) const {
  static const ChannelWeights weights = channel_weights();
  const double c = std::clamp(cosine, 0.0, 1.0), sine2 = 1 - c * c;
  // Products of indices and cosines.
  const double film2 = ior_ * ior_, within = std::sqrt(std::max(0.0, film2 - sine2));
  if (within == 0) return {1, 1, 1};
  const double s = (c - within) / (c + within), p = (film2 * c - within) / (film2 * c + within);
  Passing passing[3][2];
  for (int k = 0; k < indices_; ++k) {
    const Complex square{eta_[k] * eta_[k] - k_[k] * k_[k], 2 * eta_[k] * k_[k]};
    const Complex below = root(square - Complex{sine2, 0}), here{within, 0};
    passing[k][0] = {s, (here - below) / (here + below)};
    passing[k][1] = {p, (within * square - film2 * below) / (within * square + film2 * below)};
  }
  const double way = 2 * within * thickness_;
  Vec3d passed;
  if (way >= kIncoherent) {
    for (int k = 0; k < 3; ++k)
      passed[k] = (passing[k % indices_][0].mean + passing[k % indices_][1].mean) / 2;
  } else {
    constexpr double kTurn = 2 * std::numbers::pi;
    // From each wave to the next the phase grows by the same.
    const Complex step{portable::cos(kTurn * way * kWaveStep), portable::sin(kTurn * way * kWaveStep)};
    Complex phase{portable::cos(kTurn * way * kFirstWave), portable::sin(kTurn * way * kFirstWave)};
    for (const Vec3d& weight : weights) {
      double part[3];
      for (int k = 0; k < indices_; ++k)
        part[k] = passing[k][0].at(phase.re, phase.im) + passing[k][1].at(phase.re, phase.im);
      for (int k = 0; k < 3; ++k) passed[k] += weight[k] * part[k % indices_] / 2;
      phase = phase * step;
    }
  }
  Vec3d reflected;
  for (int k = 0; k < 3; ++k) reflected[k] = std::clamp(1 - passed[k], 0.0, 1.0);
  return reflected;
}

double ior_of_head_on(double head_on) {
  const double r = std::sqrt(std::clamp(head_on, 0.0, 0.9999));
  return (1 + r) / (1 - r);
}

}  // namespace oktett
