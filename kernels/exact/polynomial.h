#pragma once
/// \file Polynomials in x, y and z inside of a box (Zachmann 2010; Melcher).
///
/// A ray turns the polynomial into one in s by Horner's rule, nested over the three coordinates: a list of
/// steps that is made once per surface, in the order of coordinates that takes the fewest operations. Powers
/// that are all even are taken in squares.

#include "kernels/exact/polynomial_data.h"
#include "kernels/exact/ray_polynomial.h"

namespace oktett {

struct PolynomialElement {
  /// One step with the accumulator of `level`, 0 the outermost, which has `degree` before.
  struct Step {
    enum class Op : std::uint8_t {
      start,   ///< becomes `c`
      take,    ///< becomes the accumulator one level further in, of degree `other`
      add,     ///< + `c`
      merge,   ///< + the accumulator one level further in, of degree `other`
      times,   ///< * the coordinate
      square,  ///< * its square
    };
    Op op;
    std::uint8_t level, degree;
    std::uint8_t other;  ///< a degree, or the axis of the coordinate
    double c;
  };
  std::vector<Step> steps;
  std::vector<Monomial> terms;  ///< the same in terms; the greatest coefficient is about 1
  int degree;
  roots::Method root_finder;
  bool open;
  Vec3d lo, hi;
};

/// Parts: 0 the surface, 1 to 6 the faces of the box.
struct Polynomial {
  using Data = PolynomialShape;
  using Pool = ExactPool<PolynomialElement>;
  static constexpr int kMaxCrossings = roots::kMaxDegree + 2;

  static void add(Pool& pool, const PolynomialShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const PolynomialElement& e = pool.elements[cell.element];
    const RaySegment<D> segment(line, range);
    D c[kMaxRayDegree + 3];
    substitute(e, segment, c);
    D s[K], turn[K];
    sign_changes<K>(c, e.degree, e.root_finder, active, s, turn);
    list_sign_changes(s, turn, common_sign(c, e.degree), !e.open, segment, range, active, out);
  }

  template <class D>
  OKTETT_INLINE static void slope(const Pool& pool, std::size_t i, const D& part, const Vec3<D>& p, D& value,
                                  Vec3<D>& gradient) {
    const PolynomialElement& e = pool.elements[i];
    D x[kMaxRayDegree + 1], y[kMaxRayDegree + 1], z[kMaxRayDegree + 1];
    x[0] = y[0] = z[0] = D(1.0);
    for (int k = 1; k <= e.degree; ++k) x[k] = x[k - 1] * p.x, y[k] = y[k - 1] * p.y, z[k] = z[k - 1] * p.z;
    value = D(0.0);
    gradient = {D(0.0), D(0.0), D(0.0)};
    const std::size_t count = e.terms.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Monomial& m = e.terms[k];
      const D yz = y[m.j] * z[m.k], cx = D(m.c) * x[m.i];
      value = value + cx * yz;
      if (m.i > 0) gradient.x = gradient.x + D(m.c * m.i) * (x[m.i - 1] * yz);
      if (m.j > 0) gradient.y = gradient.y + (cx * D(m.j)) * (y[m.j - 1] * z[m.k]);
      if (m.k > 0) gradient.z = gradient.z + (cx * D(m.k)) * (y[m.j] * z[m.k - 1]);
    }
    select_faces(e.lo, e.hi, part, p, value, gradient);
  }

 private:
  template <class D>
  OKTETT_NOINLINE static void substitute(const PolynomialElement& e, const RaySegment<D>& segment, D* c) {
    using Op = PolynomialElement::Step::Op;
    const D m[3] = {segment.m.x, segment.m.y, segment.m.z}, h[3] = {segment.h.x, segment.h.y, segment.h.z};
    D squares[3][3];
    for (int k = 0; k < 3; ++k) {
      squares[k][0] = m[k] * m[k];
      squares[k][1] = D(2.0) * m[k] * h[k];
      squares[k][2] = h[k] * h[k];
    }
    D inner[2][kMaxRayDegree + 3];
    D* const levels[4] = {c, inner[0], inner[1], inner[1]};
    const std::size_t count = e.steps.size();
    for (std::size_t i = 0; i < count; ++i) {
      const PolynomialElement::Step& step = e.steps[i];
      D *const a = levels[step.level], *const b = levels[step.level + 1];
      const int degree = step.degree;
      switch (step.op) {
        case Op::start:
          a[0] = D(step.c);
          break;
        case Op::take:
          for (int k = 0; k <= step.other; ++k) a[k] = b[k];
          break;
        case Op::add:
          a[0] = a[0] + D(step.c);
          break;
        case Op::merge:
          for (int k = 0; k <= (degree < step.other ? degree : step.other); ++k) a[k] = a[k] + b[k];
          for (int k = degree + 1; k <= step.other; ++k) a[k] = b[k];
          break;
        case Op::times:
          times_linear(a, degree, m[step.other], h[step.other]);
          break;
        case Op::square:
          times_quadratic(a, degree, squares[step.other]);
          break;
      }
    }
  }
};

}  // namespace oktett
