#pragma once
/// \file Oracle for root finders: real roots counted exactly, by Sturm chains over the integers (GMP).
/// Coefficients and points are doubles, taken as what they are.

#include <gmp.h>

#include <memory>
#include <string>
#include <vector>

#include "kernels/roots/roots.h"

namespace oktett::test {

/// An integer of any size.
class Integer {
 public:
  Integer() { mpz_init(z_); }
  explicit Integer(long v) { mpz_init_set_si(z_, v); }
  Integer(const Integer& o) { mpz_init_set(z_, o.z_); }
  Integer(Integer&& o) noexcept {
    mpz_init(z_);
    mpz_swap(z_, o.z_);
  }
  Integer& operator=(Integer o) noexcept {
    mpz_swap(z_, o.z_);
    return *this;
  }
  ~Integer() { mpz_clear(z_); }
  mpz_ptr get() { return z_; }
  mpz_srcptr get() const { return z_; }
  int sign() const { return mpz_sgn(z_); }

 private:
  mpz_t z_;
};

/// A polynomial up to a positive factor and a power of two in its variable, with its Sturm chain.
class ExactPolynomial {
 public:
  /// Coefficients must be finite; the polynomial must not be zero.
  explicit ExactPolynomial(const roots::Polynomial& p);

  /// Exact sign of the value at x.
  int sign_at(double x) const;
  /// Number of different roots in [l, r].
  int count_distinct(double l, double r) const;
  /// Number of roots in [l, r] with their multiplicities.
  int count(double l, double r) const;
  /// Whether |p(x)| <= 2^-bits times the sum of |c[i] x^i|.
  bool nearly_zero(double x, int bits) const;

 private:
  using Coefficients = std::vector<Integer>;
  explicit ExactPolynomial(Coefficients p, int shift);
  void build_chain();
  int changes_at(double x) const;

  std::vector<Coefficients> chain_;
  /// The chain's variable is x 2^-shift_.
  int shift_ = 0;
  /// The greatest common divisor with the derivative, if it is not constant.
  std::unique_ptr<ExactPolynomial> repeated_;
};

/// How an answer compares with the truth.
struct Judgement {
  int missed = 0;
  /// Reported roots without a real one in their interval, or with another number than they may hold.
  int invented = 0;
  /// Greatest distance of a simple root from the true one, rounded up to a power of two times 2^-53 of the
  /// interval's greater end.
  double worst_error = 0;
  int clusters = 0;
  std::string what;
};

/// Checks an answer for [a, b], finite, by what docs/roots.md promises. Errors below `floor` times the
/// greater end count as `floor`: for methods that give no sure bound.
Judgement judge(const roots::Polynomial& p, double a, double b, const roots::Roots& answer, double floor = 0);

}  // namespace oktett::test
