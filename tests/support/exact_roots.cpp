#include "tests/support/exact_roots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/math.h"

namespace oktett::test {
namespace {

/// x = mantissa 2^exponent with a 53-bit integer.
std::pair<long, int> split_double(double x) {
  if (x == 0) return {0, 0};
  int e;
  long m = static_cast<long>(std::ldexp(std::frexp(x, &e), 53));
  e -= 53;
  const int even = __builtin_ctzl(static_cast<unsigned long>(m));
  return {m >> even, e + even};
}

/// Value at m 2^e up to a positive factor; with absolute values of the terms if `absolute`.
void evaluate(const std::vector<Integer>& p, long m, int e, Integer& y, bool absolute = false) {
  const int n = static_cast<int>(p.size()) - 1;
  Integer term;
  mpz_set(y.get(), p[n].get());
  if (absolute) mpz_abs(y.get(), y.get()), m = std::labs(m);
  for (int i = n - 1; i >= 0; --i) {
    mpz_mul_si(y.get(), y.get(), m);
    if (e >= 0) {
      mpz_mul_2exp(y.get(), y.get(), e);
      mpz_set(term.get(), p[i].get());
    } else {
      mpz_mul_2exp(term.get(), p[i].get(), static_cast<mp_bitcnt_t>(-e) * (n - i));
    }
    if (absolute) mpz_abs(term.get(), term.get());
    mpz_add(y.get(), y.get(), term.get());
  }
}

/// a times a power of |lead(b)|, modulo b.
void pseudo_remainder(std::vector<Integer>& a, const std::vector<Integer>& b) {
  const int m = static_cast<int>(b.size()) - 1;
  Integer lead;
  mpz_abs(lead.get(), b[m].get());
  Integer q;
  for (int k = static_cast<int>(a.size()) - 1; k >= m; --k) {
    mpz_set(q.get(), a[k].get());
    if (b[m].sign() < 0) mpz_neg(q.get(), q.get());
    for (int i = 0; i < k; ++i) mpz_mul(a[i].get(), a[i].get(), lead.get());
    for (int i = 0; i < m; ++i) mpz_submul(a[k - m + i].get(), q.get(), b[i].get());
    a.pop_back();
  }
}

void trim(std::vector<Integer>& p) {
  while (!p.empty() && p.back().sign() == 0) p.pop_back();
}

}  // namespace

ExactPolynomial::ExactPolynomial(const roots::Polynomial& p) {
  int n = p.degree;
  while (p.c[n] == 0) --n;
  int low = 0;
  while (p.c[low] == 0) ++low;
  std::vector<std::pair<long, int>> c;
  for (int i = 0; i <= n; ++i) c.push_back(split_double(p.c[i]));
  // A power of two in the variable evens out the exponents and keeps the integers short.
  if (n > low) shift_ = (c[low].second - c[n].second) / (n - low);
  int least = 1 << 30;
  for (int i = 0; i <= n; ++i) {
    if (c[i].first) least = std::min(least, c[i].second + i * shift_);
  }
  Coefficients q(n + 1);
  for (int i = 0; i <= n; ++i) {
    mpz_set_si(q[i].get(), c[i].first);
    if (c[i].first) mpz_mul_2exp(q[i].get(), q[i].get(), c[i].second + i * shift_ - least);
  }
  chain_.push_back(std::move(q));
  build_chain();
}

ExactPolynomial::ExactPolynomial(Coefficients p, int shift) : shift_(shift) {
  chain_.push_back(std::move(p));
  build_chain();
}

// Subresultant remainders (W. S. Brown 1978) by absolute values, with the signs of Sturm's chain.
void ExactPolynomial::build_chain() {
  const int n = static_cast<int>(chain_[0].size()) - 1;
  if (n < 1) return;
  Coefficients d(n);
  for (int i = 1; i <= n; ++i) mpz_mul_si(d[i - 1].get(), chain_[0][i].get(), i);
  chain_.push_back(std::move(d));
  Integer psi(1), beta(1), t;
  for (bool first = true;; first = false) {
    const Coefficients& a = chain_[chain_.size() - 2];
    const Coefficients& b = chain_.back();
    if (b.size() < 2) break;
    const unsigned delta = static_cast<unsigned>(a.size() - b.size());
    if (!first) {
      mpz_pow_ui(t.get(), psi.get(), delta);
      mpz_mul(beta.get(), t.get(), a.back().get());
      mpz_abs(beta.get(), beta.get());
    }
    Coefficients r = a;
    pseudo_remainder(r, b);
    trim(r);
    if (r.empty()) break;
    for (Integer& c : r) {
      mpz_divexact(c.get(), c.get(), beta.get());
      mpz_neg(c.get(), c.get());
    }
    // psi for the next step: |lead(b)|^delta / psi^(delta-1)
    mpz_pow_ui(t.get(), b.back().get(), delta);
    mpz_abs(t.get(), t.get());
    if (delta >= 1) {
      Integer below;
      mpz_pow_ui(below.get(), psi.get(), delta - 1);
      mpz_divexact(psi.get(), t.get(), below.get());
    }
    chain_.push_back(std::move(r));
  }
  if (chain_.back().size() >= 2) {
    // The last remainder is the greatest common divisor; without its content it is small.
    Coefficients g = chain_.back();
    Integer content;
    for (const Integer& c : g) mpz_gcd(content.get(), content.get(), c.get());
    for (Integer& c : g) mpz_divexact(c.get(), c.get(), content.get());
    repeated_.reset(new ExactPolynomial(std::move(g), shift_));
  }
}

int ExactPolynomial::sign_at(double x) const {
  const auto [m, e] = split_double(x);
  Integer y;
  evaluate(chain_[0], m, e - shift_, y);
  return y.sign();
}

int ExactPolynomial::changes_at(double x) const {
  int last = 0, changes = 0;
  Integer y;
  const auto [m, e] = std::isfinite(x) ? split_double(x) : std::pair<long, int>(0, 0);
  for (const Coefficients& p : chain_) {
    int s;
    if (std::isfinite(x)) {
      evaluate(p, m, e - shift_, y);
      s = y.sign();
    } else {
      s = p.back().sign() * (x < 0 && p.size() % 2 == 0 ? -1 : 1);
    }
    if (s == 0) continue;
    changes += last != 0 && s != last;
    last = s;
  }
  return changes;
}

// Where p(l) = 0 and l is a multiple root the whole chain vanishes: the chain is a multiple of that of the
// square-free part, whose signs just beside l are the same on either side of the count.
int ExactPolynomial::count_distinct(double l, double r) const {
  if (!(l <= r) || chain_[0].size() < 2) return 0;
  if (repeated_) {
    // Nudging the ends off common zeros: the count over (l', r'] with l' just below l, r' just above r.
    double left = l, right = r;
    while (std::isfinite(left) && repeated_->sign_at(left) == 0) left = std::nextafter(left, -kInfinity);
    while (std::isfinite(right) && repeated_->sign_at(right) == 0) right = std::nextafter(right, kInfinity);
    return changes_at(left) - changes_at(right) + (std::isfinite(left) && sign_at(left) == 0);
  }
  return changes_at(l) - changes_at(r) + (std::isfinite(l) && sign_at(l) == 0);
}

int ExactPolynomial::count(double l, double r) const {
  return count_distinct(l, r) + (repeated_ ? repeated_->count(l, r) : 0);
}

bool ExactPolynomial::nearly_zero(double x, int bits) const {
  const auto [m, e] = split_double(x);
  Integer y, size;
  evaluate(chain_[0], m, e - shift_, y);
  evaluate(chain_[0], m, e - shift_, size, true);
  mpz_mul_2exp(y.get(), y.get(), bits);
  return mpz_cmpabs(y.get(), size.get()) <= 0;
}

namespace {

/// Reported intervals that overlap, as one.
struct Group {
  double lo, hi;
  int most = 0, odd = 0, size = 0;
  double x = 0;
};

std::vector<Group> group(const roots::Roots& answer, double floor) {
  std::vector<Group> groups;
  for (int i = 0; i < answer.count; ++i) {
    const roots::Root& r = answer.root[i];
    const double e = std::max(r.error, floor);
    const double lo = e == 0 ? r.x : std::nextafter(r.x - e, -kInfinity);
    const double hi = e == 0 ? r.x : std::nextafter(r.x + e, kInfinity);
    if (groups.empty() || lo > groups.back().hi) groups.push_back({lo, hi});
    Group& g = groups.back();
    g.lo = std::min(g.lo, lo), g.hi = std::max(g.hi, hi);
    g.most += r.multiplicity, g.odd += r.multiplicity % 2, g.x = r.x, ++g.size;
  }
  return groups;
}

double true_error(const ExactPolynomial& p, double x, double most, double scale) {
  for (double e = 0x1p-53 * scale; e < most; e *= 2) {
    if (p.sign_at(x - e) * p.sign_at(x + e) <= 0) return e / scale;
  }
  return most / scale;
}

}  // namespace

Judgement judge(const roots::Polynomial& p, double a, double b, const roots::Roots& answer, double floor) {
  Judgement out;
  const double scale = std::max(std::abs(a), std::abs(b));
  const ExactPolynomial exact(p);
  const std::vector<Group> groups = group(answer, floor * scale);
  char line[200];
  int inside = 0;
  bool plain = true;
  for (const Group& g : groups) {
    inside += g.lo >= a && g.hi <= b;
    bool fine = g.most == 1 && exact.sign_at(g.lo) * exact.sign_at(g.hi) < 0;
    plain &= fine && g.lo >= a && g.hi <= b;
    if (!fine || g.most > 1) {
      const int n = exact.count(g.lo, g.hi);
      fine = n <= g.most && n % 2 == g.most % 2 && n >= g.odd;
      if (n == 0) fine = fine && exact.nearly_zero(g.x, 80);
      out.clusters += g.most > 1;
      if (!fine) {
        std::snprintf(line, sizeof line, "[%.17g, %.17g] holds %d roots, reported %d; ", g.lo, g.hi, n,
                      g.most);
        out.what += line;
        ++out.invented;
      }
    } else {
      out.worst_error = std::max(out.worst_error, true_error(exact, g.x, g.hi - g.lo, scale));
    }
  }
  if (plain && exact.count_distinct(a, b) == inside) return out;
  double from = a;
  for (std::size_t i = 0; i <= groups.size(); ++i) {
    const double to = i < groups.size() ? std::nextafter(groups[i].lo, -kInfinity) : b;
    const int n = exact.count(from, to);
    if (n > 0) {
      std::snprintf(line, sizeof line, "%d roots in [%.17g, %.17g] not reported; ", n, from, to);
      out.what += line;
      out.missed += n;
    }
    if (i < groups.size()) from = std::max(from, std::nextafter(groups[i].hi, kInfinity));
  }
  return out;
}

}  // namespace oktett::test
