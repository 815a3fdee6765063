#include "verify/checks/roots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "kernels/roots/solve.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {
namespace {

using roots::Method;

struct KnownRoots {
  roots::Polynomial p;
  double a = 0, b = 0;
  std::vector<double> inside;  ///< roots in [a, b] in ascending order, as often as they count
};

class RootsMaker {
 public:
  RootsMaker(int degree, std::uint64_t number)
      : random_(mix_bits(number) + static_cast<std::uint64_t>(degree)),
        degree_(degree),
        // The integers stay below 2^50.
        bits_(50 / degree - 2) {}

  KnownRoots make() {
    while (std::ssize(c_) <= degree_) add_factor();
    const int shift = below(41) - 20, size = below(201) - 100;
    const double sign = random_.unit() < 0.5 ? -1 : 1;
    KnownRoots known;
    known.p.degree = degree_;
    for (int i = 0; i <= degree_; ++i)
      known.p.c[i] =
          sign * std::ldexp(static_cast<double>(c_[static_cast<std::size_t>(i)]), size + i * (bits_ - shift));
    // Ends lie halfway between points of the grid.
    const double half = std::ldexp(1.0, shift - bits_ - 1);
    double ends[2];
    for (double& end : ends) end = half * static_cast<double>(2 * coordinate() + 1);
    known.a = std::min(ends[0], ends[1]), known.b = std::max(ends[0], ends[1]);
    for (const std::int64_t root : roots_)
      if (const double x = 2 * half * static_cast<double>(root); x > known.a && x < known.b)
        known.inside.push_back(x);
    std::ranges::sort(known.inside);
    return known;
  }

 private:
  int below(int n) { return static_cast<int>(random_.unit() * n); }

  /// A point of the grid, often close to the one before.
  std::int64_t coordinate() {
    const auto most = static_cast<double>(std::int64_t{1} << bits_);
    if (random_.unit() < 0.4) {
      const auto step = static_cast<std::int64_t>(std::pow(most, 0.7 * random_.unit()) - 0.9);
      if (std::abs(last_ - step) < static_cast<std::int64_t>(most)) return last_ -= step;
    }
    return last_ = static_cast<std::int64_t>(random_.sign() * most);
  }

  /// Multiplies by x - k, or by (x - k)^2 + j^2, in units of the grid.
  void add_factor() {
    const std::int64_t k = coordinate();
    if (degree_ + 1 - std::ssize(c_) >= 2 && random_.unit() < 0.25) {
      const auto j =
          static_cast<std::int64_t>(std::pow(static_cast<double>(std::int64_t{1} << bits_), random_.unit()));
      return multiply({k * k + j * j, -2 * k, 1});
    }
    roots_.push_back(k);
    multiply({-k, 1});
  }

  void multiply(const std::vector<std::int64_t>& factor) {
    std::vector<std::int64_t> product(c_.size() + factor.size() - 1);
    for (std::size_t i = 0; i < c_.size(); ++i)
      for (std::size_t k = 0; k < factor.size(); ++k) product[i + k] += c_[i] * factor[k];
    c_ = std::move(product);
  }

  CaseRandom random_;
  int degree_, bits_;
  std::vector<std::int64_t> c_{1}, roots_;
  std::int64_t last_ = 0;
};

/// What is wrong with a certified answer; empty if nothing is.
std::string judge(const KnownRoots& known, const roots::Roots& answer) {
  const auto holds = [](const roots::Root& r, double x) { return std::abs(x - r.x) <= r.error; };
  for (const double x : known.inside)
    if (std::none_of(answer.root, answer.root + answer.count,
                     [&](const roots::Root& r) { return holds(r, x); }))
      return fmt::format("the root {} is missed", x);
  for (int i = 0; i < answer.count; ++i) {
    const roots::Root& r = answer.root[i];
    // Intervals that overlap share their roots.
    const auto apart = [&](const roots::Root& other) {
      return std::abs(r.x - other.x) > r.error + other.error;
    };
    if ((i > 0 && !apart(answer.root[i - 1])) || (i + 1 < answer.count && !apart(answer.root[i + 1])))
      continue;
    const auto held = std::ranges::count_if(known.inside, [&](double x) { return holds(r, x); });
    if (held > r.multiplicity || (r.multiplicity - held) % 2 != 0)
      return fmt::format("{} +- {} should be {} roots, but {} are there", r.x, r.error, r.multiplicity, held);
  }
  return "";
}

}  // namespace

RootsTally verify_roots(int degree, std::uint64_t count, std::uint64_t first) {
  RootsTally tally;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const KnownRoots known = RootsMaker(degree, number).make();
    ++tally.polynomials, tally.roots += known.inside.size();
    for (const Method method : {Method::automatic, Method::bernstein, Method::closed, Method::sturm}) {
      const roots::Roots answer = roots::solve(known.p, known.a, known.b, method);
      const bool must = method == Method::automatic || method == Method::bernstein;
      std::string wrong;
      if (answer.certified)
        wrong = judge(known, answer);
      else if (must)
        wrong = "the answer is not certified";
      else
        ++tally.uncertain;
      if (wrong.empty()) continue;
      if (tally.failure.empty())
        tally.failure = fmt::format("{}, degree {}: {}", to_string(method), degree, wrong),
        tally.first_failure = number;
      ++tally.wrong;
    }
  }
  return tally;
}

}  // namespace oktett
