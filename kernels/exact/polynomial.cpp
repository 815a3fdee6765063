#include "kernels/exact/polynomial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/double_double.h"

namespace oktett {
namespace {

using Step = PolynomialElement::Step;

int exponent_of(const Monomial& m, int axis) { return axis == 0 ? m.i : axis == 1 ? m.j : m.k; }

int degree_of(const std::vector<Monomial>& terms) {
  int degree = 0;
  for (const Monomial& m : terms) degree = std::max(degree, m.i + m.j + m.k);
  return degree;
}

/// Without the even powers of x, y and z that all terms have in common: they never change the sign, and a
/// root that is there many times would be known to few digits only.
std::vector<Monomial> without_even_factors(std::vector<Monomial> terms) {
  if (terms.empty()) return terms;
  Monomial least = terms[0];
  for (const Monomial& m : terms)
    least.i = std::min(least.i, m.i), least.j = std::min(least.j, m.j), least.k = std::min(least.k, m.k);
  const auto take = [](std::uint8_t& n, int common) { n = static_cast<std::uint8_t>(n - common / 2 * 2); };
  for (Monomial& m : terms) take(m.i, least.i), take(m.j, least.j), take(m.k, least.k);
  return terms;
}

/// The terms for coordinates that count lengths of 2^shift, times a power of two that makes the greatest
/// coefficient about 1. Nothing overflows on the way, and what underflows does not matter.
std::vector<Monomial> scaled(std::vector<Monomial> terms, int shift) {
  int greatest = -1000000;
  for (const Monomial& m : terms)
    if (m.c != 0) greatest = std::max(greatest, std::ilogb(m.c) + shift * (m.i + m.j + m.k));
  for (Monomial& m : terms) m.c = std::ldexp(m.c, shift * (m.i + m.j + m.k) - greatest);
  std::erase_if(terms, [](const Monomial& m) { return std::abs(m.c) < 0x1p-300; });
  return terms;
}

/// The terms for coordinates that count from `center`, in double-double until the end.
std::vector<Monomial> moved(const std::vector<Monomial>& terms, const Vec3d& center) {
  const int n = degree_of(terms), size = n + 1;
  std::vector<DoubleDouble> c(static_cast<std::size_t>(size) * size * size, DoubleDouble(0));
  const auto at = [&](int i, int j, int k) -> DoubleDouble& { return c[(i * size + j) * size + k]; };
  for (const Monomial& m : terms) at(m.i, m.j, m.k) = m.c;
  // Repeated synthetic division, along one axis after the other.
  for (int axis = 0; axis < 3; ++axis) {
    for (int u = 0; u <= n; ++u) {
      for (int v = 0; u + v <= n; ++v) {
        const auto line = [&](int w) -> DoubleDouble& {
          return axis == 0 ? at(w, u, v) : axis == 1 ? at(u, w, v) : at(u, v, w);
        };
        const int top = n - u - v;
        for (int k = 0; k < top; ++k)
          for (int w = top - 1; w >= k; --w) line(w) = line(w) + line(w + 1) * DoubleDouble(center[axis]);
      }
    }
  }
  std::vector<Monomial> out;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      for (int k = 0; i + j + k <= n; ++k)
        if (at(i, j, k).hi != 0)
          out.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j),
                         static_cast<std::uint8_t>(k), at(i, j, k).hi});
  return out;
}

/// Makes the steps for one order of the coordinates.
class Nesting {
 public:
  explicit Nesting(const std::array<int, 3>& axes) : axes_(axes) {}

  /// Steps that leave the sum of `terms`, which the axes of lower levels have been taken from, in the
  /// accumulator of `level`. Returns its degree.
  int sum(std::vector<Monomial> terms, int level) {
    const int axis = axes_[level];
    std::sort(terms.begin(), terms.end(), [&](const Monomial& a, const Monomial& b) {
      return exponent_of(a, axis) > exponent_of(b, axis);
    });
    int degree = -1;
    for (std::size_t i = 0; i < terms.size();) {
      const int exponent = exponent_of(terms[i], axis);
      std::size_t end = i;
      while (end < terms.size() && exponent_of(terms[end], axis) == exponent) ++end;
      degree = append({terms.begin() + i, terms.begin() + end}, level, degree);
      const int next = end < terms.size() ? exponent_of(terms[end], axis) : 0;
      for (int left = exponent - next; left > 0;) {
        const bool square = left >= 2;
        push(square ? Step::Op::square : Step::Op::times, level, degree, axis);
        cost_ += (square ? 5 : 3) * (degree + 1);
        degree += square ? 2 : 1, left -= square ? 2 : 1;
      }
      i = end;
    }
    return degree;
  }

  std::vector<Step> steps;
  int cost() const { return cost_ + 4 * static_cast<int>(steps.size()); }

 private:
  /// Adds terms with one exponent of the level's axis to an accumulator of `degree`, -1 if it is unused.
  int append(const std::vector<Monomial>& terms, int level, int degree) {
    bool constant = terms.size() == 1;
    for (int inner = level + 1; inner < 3; ++inner)
      constant = constant && exponent_of(terms[0], axes_[inner]) == 0;
    if (constant) {
      push(degree < 0 ? Step::Op::start : Step::Op::add, level, degree, 0, terms[0].c);
      return std::max(degree, 0);
    }
    const int inner = sum(terms, level + 1);
    push(degree < 0 ? Step::Op::take : Step::Op::merge, level, degree, inner);
    cost_ += inner + 1;
    return std::max(degree, inner);
  }
  void push(Step::Op op, int level, int degree, int other, double c = 0) {
    steps.push_back({op, static_cast<std::uint8_t>(level), static_cast<std::uint8_t>(std::max(degree, 0)),
                     static_cast<std::uint8_t>(other), c});
  }

  std::array<int, 3> axes_;
  int cost_ = 0;
};

std::vector<Step> cheapest_steps(const std::vector<Monomial>& terms) {
  std::array<int, 3> axes{0, 1, 2};
  std::vector<Step> best;
  int least = 0;
  do {
    Nesting nesting(axes);
    nesting.sum(terms, 0);
    if (best.empty() || nesting.cost() < least) least = nesting.cost(), best = std::move(nesting.steps);
  } while (std::next_permutation(axes.begin(), axes.end()));
  return best;
}

}  // namespace

void Polynomial::add(Pool& pool, const PolynomialShape& s, const ExactPlace& place) {
  const Vec3d half = (s.hi - s.lo) * 0.5, middle = (s.lo + s.hi) * 0.5;
  const double extent = max_component(half);
  double off = 0;
  for (int k = 0; k < 3; ++k) off = std::max(off, std::abs(middle[k]));
  if (!(half.x > 0 && half.y > 0 && half.z > 0 && std::isfinite(off + extent))) return;
  // Near the box, the origin stays where it is: that keeps coefficients zero that are.
  const bool move = off > 4 * extent;
  int shift = 0;
  std::frexp(move ? extent : off + extent, &shift);
  const double size = std::ldexp(1.0, shift), per_size = std::ldexp(1.0, -shift);
  const Vec3d center = move ? middle * per_size : Vec3d{0, 0, 0};
  PolynomialElement e;
  e.terms = scaled(without_even_factors(s.terms), shift);
  if (move) e.terms = scaled(moved(e.terms, center), 0);
  e.degree = degree_of(e.terms);
  if (e.terms.empty() || e.degree > roots::kMaxDegree) return;
  // What never changes its sign, as -x^2, fills the box or has nothing in it.
  if (e.degree == 0 && (s.open || e.terms[0].c > 0)) return;
  for (const Monomial& m : e.terms)
    if (!std::isfinite(m.c)) return;
  e.steps = cheapest_steps(e.terms);
  e.root_finder = s.root_finder;
  e.open = s.open;
  e.lo = s.lo * per_size - center, e.hi = s.hi * per_size - center;
  const Affine own = Affine::scaling({size, size, size}) * Affine::translation(center);
  add_element(pool, e, place.to_world * own, place);
  add_cell(pool, e.lo, e.hi);
}

}  // namespace oktett
