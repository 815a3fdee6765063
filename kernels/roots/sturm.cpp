#include "kernels/roots/methods.h"

#include <algorithm>
#include <cmath>

namespace oktett::roots {
namespace {

constexpr double kSturmRoundUp = 1 + 0x1p-45;

/// A number with a bound on its error.
struct Ball {
  DoubleDouble x;
  double error;
};
Ball operator+(const Ball& a, const Ball& b) {
  const DoubleDouble d = a.x + b.x;
  return {d, (a.error + b.error + kUnit<DoubleDouble> * std::abs(d.hi)) * kSturmRoundUp + kUnderflow};
}
Ball operator-(const Ball& a, const Ball& b) { return a + Ball{-b.x, b.error}; }
Ball operator*(const Ball& a, const Ball& b) {
  const DoubleDouble p = a.x * b.x;
  return {p, (std::abs(a.x.hi) * b.error + a.error * (std::abs(b.x.hi) + b.error) +
              kUnit<DoubleDouble> * std::abs(p.hi)) *
                     kSturmRoundUp +
                 kUnderflow};
}
/// b must surely differ from 0.
Ball operator/(const Ball& a, const Ball& b) {
  const DoubleDouble q = a.x / b.x;
  const double least = std::abs(b.x.hi) * (1 - 0x1p-50) - b.error;
  return {q, ((a.error + std::abs(q.hi) * b.error) / least + 8 * kUnit<DoubleDouble> * std::abs(q.hi)) *
                     kSturmRoundUp +
                 kUnderflow};
}
int sign_of(const Ball& a) { return std::abs(a.x.hi) * (1 - 0x1p-50) > a.error ? (a.x.hi > 0 ? 1 : -1) : 0; }

struct BallPolynomial {
  int degree;
  Ball c[kMaxDegree + 1];
};

struct Chain {
  int length = 0;
  /// False if it ends because the next remainder is too near zero to tell its degree.
  bool sure = true;
  BallPolynomial p[kMaxDegree + 1];
};

/// Scales by a power of two so that no remainder grows or vanishes; drops leading coefficients that are
/// surely 0. False if nothing is left or the degree is in doubt.
bool tidy(BallPolynomial& p, bool& sure) {
  double size = 0;
  for (int i = 0; i <= p.degree; ++i) size = std::max(size, std::abs(p.c[i].x.hi));
  while (p.degree >= 0 && p.c[p.degree].x.hi == 0 && p.c[p.degree].error < 0x1p-800) --p.degree;
  if (p.degree < 0 || size == 0 || sign_of(p.c[p.degree]) == 0) {
    sure = false;
    return false;
  }
  int e;
  std::frexp(size, &e);
  const double factor = scale_by_power(1, -e);
  for (int i = 0; i <= p.degree; ++i) {
    Ball& c = p.c[i];
    c = {DoubleDouble(c.x.hi * factor, c.x.lo * factor), c.error * factor};
  }
  return true;
}

void build(const Polynomial& p, Chain& chain) {
  const int n = p.degree;
  chain.p[0].degree = n;
  chain.p[1].degree = n - 1;
  for (int i = 0; i <= n; ++i) chain.p[0].c[i] = {p.c[i], kUnderflow};
  for (int i = 1; i <= n; ++i) {
    chain.p[1].c[i - 1] = Ball{p.c[i], kUnderflow} * Ball{static_cast<double>(i), 0};
  }
  chain.length = 1;
  if (!tidy(chain.p[1], chain.sure)) return;
  chain.length = 2;
  while (chain.p[chain.length - 1].degree > 0) {
    const BallPolynomial& a = chain.p[chain.length - 2];
    const BallPolynomial& b = chain.p[chain.length - 1];
    BallPolynomial& r = chain.p[chain.length];
    r = a;
    for (int k = a.degree - b.degree; k >= 0; --k) {
      const Ball q = r.c[b.degree + k] / b.c[b.degree];
      for (int i = 0; i < b.degree; ++i) r.c[i + k] = r.c[i + k] - q * b.c[i];
    }
    r.degree = b.degree - 1;
    for (int i = 0; i <= r.degree; ++i) r.c[i].x = -r.c[i].x;
    if (!tidy(r, chain.sure)) return;
    ++chain.length;
  }
}

Ball value_at(const BallPolynomial& p, double x) {
  Ball y = p.c[p.degree];
  for (int i = p.degree - 1; i >= 0; --i) y = y * Ball{x, 0} + p.c[i];
  return y;
}

/// Changes of sign along the chain at x, and the sign of its first member. Not sure if an unknown sign could
/// matter.
struct Changes {
  int count = 0, sign = 0;
  bool sure = true;
};
Changes changes_at(const Chain& chain, const Polynomial& p, double x) {
  Changes out;
  out.sign = sign_at(p, x);
  int last = out.sign, unknown = 0;
  out.sure = out.sign != 0;
  for (int i = 1; i < chain.length; ++i) {
    const int s = sign_of(value_at(chain.p[i], x));
    if (s == 0) {
      ++unknown;
      continue;
    }
    // An unknown sign between opposite signs makes one change, whichever it is.
    if (unknown) out.sure &= unknown == 1 && s == -last;
    unknown = 0;
    out.count += s != last && last != 0;
    last = s;
  }
  out.sure &= unknown == 0;
  return out;
}

}  // namespace

Roots solve_sturm(const Normalized& n) {
  struct Interval {
    double l, r;
    Changes at_l, at_r;
  };
  constexpr int kDepth = 80;
  Chain chain;
  build(n.p, chain);
  Roots out;
  out.certified = chain.sure;
  Interval stack[kDepth];
  int top = 0;
  stack[0] = {n.a, n.b, changes_at(chain, n.p, n.a), changes_at(chain, n.p, n.b)};
  while (top >= 0) {
    const Interval now = stack[top--];
    const int roots = now.at_l.count - now.at_r.count;
    out.certified &= now.at_l.sure && now.at_r.sure;
    if (roots <= 0) continue;
    const double middle = now.l + 0.5 * (now.r - now.l), width = now.r - now.l;
    if (roots == 1 && now.at_l.sign && now.at_r.sign == -now.at_l.sign) {
      out.add(refine_newton(n.p, now.l, now.r, now.at_l.sign, middle));
      continue;
    }
    if (!(width > 0x1p-50) || top + 3 > kDepth) {
      out.certified = false;
      out.add({middle, 0.5 * width + 0x1p-53,
               roots > 1 || now.at_l.sign == now.at_r.sign ? std::max(2, roots) : 1});
      continue;
    }
    double cut = middle;
    Changes at = changes_at(chain, n.p, cut);
    for (const double part : {0.4375, 0.5625}) {
      if (at.sure) break;
      cut = now.l + part * width;
      at = changes_at(chain, n.p, cut);
    }
    stack[++top] = {cut, now.r, at, now.at_r};
    stack[++top] = {now.l, cut, now.at_l, at};
  }
  return out;
}

}  // namespace oktett::roots
