#include "kernels/roots/methods.h"

#include <algorithm>
#include <cmath>

namespace oktett::roots {
namespace {

/// A part of the interval that is isolated (holds one root) or doubtful.
struct Piece {
  enum Kind { isolated, doubtful } kind;
  double l, r;
  /// If doubtful: the right end of the interval from which it was cut.
  double reach;
  /// If isolated: the sign of p just above l, and an estimate of the root.
  int sign;
  double start;
};

constexpr int kMaxPieces = 8 * kMaxDegree;

/// Lists pieces from left to right and joins adjacent doubtful ones.
struct Pieces {
  int count = 0, isolated = 0;
  bool overflow = false;
  Piece at[kMaxPieces];

  void add(const Piece& piece) {
    if (count && piece.kind == Piece::doubtful && at[count - 1].kind == Piece::doubtful &&
        piece.l <= at[count - 1].r * (1 + 0x1p-50)) {
      at[count - 1].r = std::max(at[count - 1].r, piece.r);
      at[count - 1].reach = std::max(at[count - 1].reach, piece.reach);
    } else if (count < kMaxPieces) {
      at[count++] = piece;
      isolated += piece.kind == Piece::isolated;
    } else {
      overflow = true;
    }
  }
};

/// Bernstein coefficients on the part [u, u + h] of an interval, each off by at most `error`.
template <class T>
struct Part {
  T b[kMaxDegree + 1];
  double u, h, error;
};

/// The fewest and the most changes of sign that the coefficients can have.
struct Count {
  int least, most;
};

template <class T>
int sign_of(const T& b, double error) {
  return to_double(b) > error ? 1 : to_double(b) < -error ? -1 : 0;
}

/// The same with unknown signs: fewest and most changes so far, for either sign of the last coefficient.
template <class T>
Count count_unsure(const T* b, int n, double error) {
  constexpr int kNever = 1000;
  int least[2] = {0, 0}, most[2] = {0, 0};
  for (int i = 0; i <= n; ++i) {
    const int s = sign_of(b[i], error);
    int l[2], m[2];
    for (int now = 0; now < 2; ++now) {
      const bool possible = s == 0 || (s > 0) == (now == 1);
      l[now] = possible ? std::min(least[now], least[1 - now] + (i > 0)) : kNever;
      m[now] = possible ? std::max(most[now], most[1 - now] + (i > 0)) : -kNever;
    }
    least[0] = l[0], least[1] = l[1], most[0] = m[0], most[1] = m[1];
  }
  return {std::min(least[0], least[1]), std::max(most[0], most[1])};
}

template <class T>
Count count_changes(const T* b, int n, double error) {
  int changes = 0, last = sign_of(b[0], error);
  bool sure = last != 0;
  for (int i = 1; i <= n; ++i) {
    const int s = sign_of(b[i], error);
    sure &= s != 0;
    changes += s != last;
    last = s;
  }
  return OKTETT_LIKELY(sure) ? Count{changes, changes} : count_unsure(b, n, error);
}

template <class T>
double greatest(const T* b, int n) {
  double m = 0;
  for (int i = 0; i <= n; ++i) m = std::max(m, std::abs(to_double(b[i])));
  return m;
}

/// Cuts at the fraction `at`: `part` becomes the right part, `left` the left one (de Casteljau).
template <class T>
void split(Part<T>& part, Part<T>& left, int n, double at, double size) {
  T* b = part.b;
  left.b[0] = b[0];
  if (at == 0.5) {
    for (int k = 1; k <= n; ++k) {
      for (int i = 0; i <= n - k; ++i) b[i] = (b[i] + b[i + 1]) * T(0.5);
      left.b[k] = b[0];
    }
  } else {
    for (int k = 1; k <= n; ++k) {
      for (int i = 0; i <= n - k; ++i) b[i] = b[i] * T(1 - at) + b[i + 1] * T(at);
      left.b[k] = b[0];
    }
  }
  // Three roundings at each of n levels; exact convex combinations do not increase errors.
  part.error = left.error = part.error + 3 * n * kUnit<T> * size + kUnderflow;
  left.u = part.u;
  left.h = part.h * at;
  part.u += left.h;
  part.h *= 1 - at;
}

/// Intervals are not divided below this fraction of their original length.
template <class T>
inline constexpr double kFinest = 0x1p-40;
template <>
inline constexpr double kFinest<DoubleDouble> = 0x1p-54;

/// More than the relative error of `point`.
constexpr double kSlack = 0x1p-51;

double point(double l, double w, double u) { return l + w * u; }

/// Divides [l, r], 0 <= l <= r <= 1, until each part is free of roots, has one, or is doubtful in arithmetic
/// of T. Stops after `wanted` isolated roots.
template <class T>
void isolate(const Polynomial& p, double l, double r, int wanted, Pieces& out) {
  constexpr int kDepth = 60;
  const int n = p.degree;
  const double width = r - l;
  Part<T> stack[kDepth];
  int top = 0;
  stack[0].error = to_bernstein(p, T(l), T(r) - T(l), stack[0].b);
  stack[0].u = 0, stack[0].h = 1;
  while (top >= 0) {
    Part<T>& part = stack[top];
    const Count count = count_changes(part.b, n, part.error);
    if (count.most == 0) {
      --top;
      continue;
    }
    const double from = point(l, width, part.u),
                 to = part.u + part.h == 1 ? r : point(l, width, part.u + part.h);
    if (count.least == 1 && count.most == 1) {
      const double first = to_double(part.b[0]), last = to_double(part.b[n]);
      const double start = from + (to - from) * (first / (first - last));
      // Rounding the ends to doubles cannot change a sign that is sure in double, but one in double-double.
      const double slack = kUnit<T> < 0x1p-60 ? kSlack * to : 0.0;
      out.add({Piece::isolated, from - slack, to + slack, 0, first > 0 ? 1 : -1, start});
      --top;
      if (--wanted <= 0) return;
      continue;
    }
    const double size = greatest(part.b, n);
    if (part.h <= kFinest<T> || !(size > 16 * part.error) || top + 1 == kDepth) {
      out.add({Piece::doubtful, from, to, r, 0, 0});
      --top;
      continue;
    }
    // A root at the cut makes both sides doubtful, so another cut is tried.
    Part<T>& left = stack[++top];
    T whole[kMaxDegree + 1];
    std::copy(part.b, part.b + n + 1, whole);
    const double u = part.u, h = part.h, error = part.error;
    split(part, left, n, 0.5, size);
    for (const double at : {0.4375, 0.5625}) {
      if (OKTETT_LIKELY(sign_of(part.b[0], part.error) != 0)) break;
      std::copy(whole, whole + n + 1, part.b);
      part.u = u, part.h = h, part.error = error;
      split(part, left, n, at, size);
    }
  }
}

/// Examines doubtful pieces again, in arithmetic of T: all of them if `all`, else those where converting the
/// polynomial anew may help because its terms are smaller there than in the interval they were cut from.
/// Drops pieces behind `wanted` isolated roots. True if a piece was examined.
template <class T>
bool examine(const Polynomial& p, bool all, int wanted, const Pieces& in, Pieces& out) {
  bool found = false;
  out.count = out.isolated = 0;
  out.overflow = in.overflow;
  for (int i = 0; i < in.count && out.isolated < wanted; ++i) {
    const Piece& piece = in.at[i];
    if (piece.kind == Piece::isolated || !(all || piece.r * (1 + 2.0 / p.degree) < piece.reach)) {
      out.add(piece);
      continue;
    }
    found = true;
    double l = piece.l;
    if (l == 0) {
      // Next to zero p has the sign of its last coefficient; from there it goes up in steps.
      const double last = std::abs(p.c[0]);
      l = piece.r;
      while (l > 0x1p-800 && last < 2 * (absolute_sum(p, l) - last)) l *= 0.0625;
      // The remaining piece is so small that the last coefficient has underflowed.
      if (l <= 0x1p-800) out.add({Piece::doubtful, 0, l, l, 0, 0});
      for (; l * 16 < piece.r && out.isolated < wanted; l *= 16) {
        isolate<T>(p, l, l * 16, wanted - out.isolated, out);
      }
    }
    if (out.isolated < wanted) isolate<T>(p, l, piece.r, wanted - out.isolated, out);
  }
  return found;
}

/// For a piece that is doubtful in double-double: widens it into the gap between `floor` and `ceiling` until
/// the count is sure, and adds the root or cluster. Sets `sure` to false if the count stays unsure.
void settle(const Polynomial& p, Piece piece, double floor, double ceiling, Roots& out, bool& sure) {
  DoubleDouble b[kMaxDegree + 1];
  const int n = p.degree;
  Count count{};
  bool ends = false;
  piece.l = std::max(0.0, piece.l - kSlack * piece.l);
  piece.r += kSlack * piece.r;
  for (int i = 0; i < 12; ++i) {
    const double error =
        to_bernstein(p, DoubleDouble(piece.l), DoubleDouble(piece.r) - DoubleDouble(piece.l), b);
    count = count_changes(b, n, error);
    ends = sign_of(b[0], error) && sign_of(b[n], error);
    if (count.most == 0) return;
    if (ends && count.least == count.most) break;
    const double more = std::max(0.5 * (piece.r - piece.l), 0x1p-52 * piece.r);
    const double l = std::max(floor, piece.l - more), r = std::min(ceiling, piece.r + more);
    if (l == piece.l && r == piece.r) break;
    piece.l = l, piece.r = r;
  }
  if (ends && count.most == 1) {
    out.add(refine_newton(p, piece.l, piece.r, to_double(b[0]) > 0 ? 1 : -1,
                          piece.l + 0.5 * (piece.r - piece.l)));
    return;
  }
  if (!ends) {
    sure = false;
  } else if ((count.most & 1) != ((to_double(b[0]) > 0) != (to_double(b[n]) > 0))) {
    --count.most;
  }
  if (count.most <= 0) return;
  const double x = piece.l + 0.5 * (piece.r - piece.l);
  out.add({x, std::max(x - piece.l, piece.r - x) * (1 + 0x1p-50) + 0x1p-53 * x, count.most});
}

/// Handles pieces that are doubtful in double.
OKTETT_NOINLINE void resolve(const Polynomial& p, double a, int wanted, const Pieces& rough, Roots& out,
                             bool& sure) {
  constexpr int kRounds = 6;
  Pieces pieces[2];
  int now = 0;
  examine<double>(p, false, wanted, rough, pieces[0]);
  for (int i = 0; i < kRounds && examine<double>(p, false, wanted, pieces[now], pieces[1 - now]); ++i)
    now = 1 - now;
  examine<DoubleDouble>(p, true, wanted, pieces[now], pieces[1 - now]);
  now = 1 - now;
  for (int i = 0; i < kRounds && examine<DoubleDouble>(p, false, wanted, pieces[now], pieces[1 - now]); ++i)
    now = 1 - now;
  const Pieces& fine = pieces[now];
  sure &= !fine.overflow;
  for (int i = 0; i < fine.count; ++i) {
    const Piece& piece = fine.at[i];
    if (piece.kind == Piece::isolated) {
      out.add(refine_newton(p, piece.l, piece.r, piece.sign, piece.start));
    } else {
      const double floor = i ? fine.at[i - 1].r : std::max(0.0, a - 0x1p-20);
      const double ceiling = i + 1 < fine.count ? fine.at[i + 1].l : 2.0;
      settle(p, piece, std::min(floor, piece.l), std::max(ceiling, piece.r), out, sure);
    }
  }
}

/// The roots in [a, b] with 0 <= a <= b <= 1, p(0) != 0.
void solve_positive(const Polynomial& p, double a, double b, int wanted, Roots& out, bool& sure) {
  Pieces pieces;
  isolate<double>(p, a, b, wanted, pieces);
  for (int i = 0; i < pieces.count; ++i) {
    if (pieces.at[i].kind == Piece::doubtful) return resolve(p, a, wanted, pieces, out, sure);
  }
  for (int i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.at[i];
    out.add(refine_newton(p, piece.l, piece.r, piece.sign, piece.start));
  }
  sure &= !pieces.overflow;
}

}  // namespace

Roots solve_bernstein(const Normalized& n, int wanted) {
  Roots out;
  out.certified = true;
  if (n.a < 0) {
    // The negative side, mirrored: its roots are found in descending order.
    Roots mirrored;
    solve_positive(reflect(n.p), std::max(0.0, -n.b), -n.a, kMaxDegree, mirrored, out.certified);
    for (int i = mirrored.count; i-- > 0;) {
      const Root& r = mirrored.root[i];
      out.add({-r.x, r.error, r.multiplicity});
    }
  }
  if (n.b > 0 && out.count < wanted) {
    solve_positive(n.p, std::max(0.0, n.a), n.b, wanted - out.count, out, out.certified);
  }
  return out;
}

int most_roots(const Polynomial& p, double a, double b) {
  double c[kMaxDegree + 1];
  int most = 0;
  if (a < 0) {
    const double l = std::max(0.0, -b), error = to_bernstein(reflect(p), l, -a - l, c);
    most += count_changes(c, p.degree, error).most;
  }
  if (b > 0) {
    const double l = std::max(0.0, a), error = to_bernstein(p, l, b - l, c);
    most += count_changes(c, p.degree, error).most;
  }
  return most;
}

}  // namespace oktett::roots
