/// \file Fractals of the plane as patterns.

#include <algorithm>
#include <cmath>

#include "render/pattern_values.h"

namespace oktett {
namespace {

struct Complex {
  double re = 0, im = 0;

  Complex operator+(const Complex& b) const { return {re + b.re, im + b.im}; }
  Complex operator+(double b) const { return {re + b, im}; }
  Complex operator*(double b) const { return {re * b, im * b}; }
  Complex operator*(const Complex& b) const { return {re * b.re - im * b.im, re * b.im + im * b.re}; }
  Complex operator/(const Complex& b) const {
    const double square = b.re * b.re + b.im * b.im;
    return {(re * b.re + im * b.im) / square, (im * b.re - re * b.im) / square};
  }
  double square() const { return re * re + im * im; }
};

Complex power(const Complex& z, std::uint32_t exponent) {
  Complex product = z;
  for (std::uint32_t i = 1; i < exponent; ++i) product = product * z;
  return product;
}

Complex next(const FractalPattern& f, const Complex& z, const Complex& c) {
  using Formula = FractalPattern::Formula;
  if (f.formula == Formula::power) return power(z, f.power) + c;
  const Complex less = c + -1.0, least = c + -2.0;
  const Complex root = f.formula == Formula::magnet1 ? (z * z + less) / (z * 2 + least)
                                                     : (power(z, 3) + less * z * 3 + less * least) /
                                                           (z * z * 3 + least * z * 3 + less * least + 1);
  return root * root;
}

/// Whether an orbit is at its end: out of reach, or for magnets also where it stays, at 1.
bool is_decided(const FractalPattern& f, const Complex& z) {
  if (f.formula == FractalPattern::Formula::power) return z.square() > 4;
  return z.square() > 1e4 || (z + -1.0).square() < 1e-4;
}

double outside_value(const FractalPattern& f, const Complex& z, std::uint32_t steps) {
  using Outside = FractalPattern::Outside;
  switch (f.exterior) {
    case Outside::constant:
      return f.exterior_factor;
    case Outside::steps:
      return static_cast<double>(steps) / f.iterations;
    case Outside::real:
      return z.re * f.exterior_factor;
    case Outside::imaginary:
      return z.im * f.exterior_factor;
    case Outside::real_square:
      return z.re * z.re * f.exterior_factor;
    case Outside::imaginary_square:
      return z.im * z.im * f.exterior_factor;
    default:
      return std::sqrt(z.square()) * f.exterior_factor;
  }
}

double inside_value(const FractalPattern& f, const Complex& z, double least_square) {
  using Inside = FractalPattern::Inside;
  switch (f.interior) {
    case Inside::constant:
      return f.interior_factor;
    case Inside::least_size:
      return std::sqrt(least_square) * f.interior_factor;
    case Inside::real:
      return z.re * f.interior_factor;
    case Inside::imaginary:
      return z.im * f.interior_factor;
    case Inside::real_square:
      return z.re * z.re * f.interior_factor;
    case Inside::imaginary_square:
      return z.im * z.im * f.interior_factor;
    default:
      return z.square() * f.interior_factor;
  }
}

}  // namespace

double raw_value(const FractalPattern& f, const Vec3d& p, const PatternFrame&) {
  const Complex place{p.x, p.y};
  const bool is_julia = f.set == FractalPattern::Set::julia;
  const Complex c = is_julia ? Complex{f.real, f.imaginary} : place;
  // The Mandelbrot sets of magnets begin at their critical point.
  Complex z = is_julia || f.formula == FractalPattern::Formula::power ? place : Complex{};
  double least_square = z.square();
  for (std::uint32_t step = 0; step < f.iterations; ++step) {
    z = next(f, z, c);
    if (is_decided(f, z)) return outside_value(f, z, step);
    least_square = std::min(least_square, z.square());
  }
  return inside_value(f, z, least_square);
}

}  // namespace oktett
