#pragma once
/// \file Crossings of a function along one ray, isolated as in march.h, with pieces of the ray in lanes.
///
/// A piece that tells nothing, or two side by side, is divided into eight, in eight lanes of each instruction
/// set, so that all find the same bits, and a ray that comes alone fills the lanes. The function is bounded,
/// and over(t) as narrow as the mean value form. A field may have over_roughly(ends) and at_roughly(places),
/// which enclose the same in eight lanes of floats on pieces with these nine ends and at eight places: they
/// cost less and tell less.

#include <algorithm>

#include "kernels/exact/march.h"

namespace oktett::interval {

/// The crossings of `field`, in eight lanes of D, with one ray: the first K from a to b. What is not told
/// apart from b may be between b and `limit`. The least piece is 2^-44 of `range`, as in march().
template <int K, class Field, class D>
class PieceMarch {
 public:
  struct Found {
    double l, r, before;  ///< as in Bracket
  };

  OKTETT_INLINE PieceMarch(const Field& field, double a, double b, double limit, double range)
      : field_(field), least_(range * 0x1p-44), begin_(a), last_(a), end_(a) {
    if (!(a < b)) return;
    divide(a, b);
    beyond_ = true;
    for (double step = least_; !done_ && last_ < end_ && end_ < limit; step *= 2)
      divide(end_, std::min(end_ + step, limit));
  }

  /// Calls f(x, before) for each crossing in order, which is less than `tolerance` from x as far as rounding
  /// tells; `before` is the sign on its near side.
  template <class F>
  OKTETT_INLINE void each(double tolerance, F&& f) const {
    for (int i = 0; i < count_; ++i) f(refine(found_[i], tolerance), found_[i].before);
  }

  /// All crossings before this are found.
  double up_to() const { return count_ < K ? roots::kNoRoot : end_; }

 private:
  static constexpr int kPieces = D::kWidth, kMaxRounds = 64;
  static constexpr unsigned kAll = (1u << kPieces) - 1;
  static constexpr bool kHasRough = requires(const Field& f, const double* ends) { f.over_roughly(ends); };
  /// Pieces longer than this, in multiples of the least, are asked roughly.
  static constexpr double kLong = 0x1p30;
  static_assert(kPieces == 8);

  /// What the function says about pieces, whose bits are those of their lanes.
  struct Answer {
    unsigned positive, negative;  ///< where it is so for certain
    unsigned turns;               ///< where that is so at the end of a piece in which it may turn once
    unsigned passed;              ///< where nothing more can be told, so that the piece is a gap
  };
  /// The signs at places that are certain.
  struct Signs {
    unsigned positive, negative;
    template <class T>
    explicit OKTETT_INLINE Signs(const Interval<T>& f)
        : positive(bits(T(0) < f.lo)), negative(bits(f.hi < T(0))) {}
    OKTETT_INLINE Signs(unsigned p, unsigned n) : positive(p), negative(n) {}
    OKTETT_INLINE unsigned certain() const { return positive | negative; }
    /// At the ends of pieces, by those of the next ones.
    OKTETT_INLINE Signs of_next() const { return {positive >> 1, negative >> 1}; }
    /// What these tell of `where`.
    OKTETT_INLINE void add(const Signs& s, unsigned where) {
      positive |= s.positive & where, negative |= s.negative & where;
    }
  };

  OKTETT_NOINLINE void divide(double a, double b) {
    if (OKTETT_UNLIKELY(++divided_ > kMaxSteps / kPieces)) {
      count_uncertified(1);
      done_ = true;
      return;
    }
    double ends[kPieces + 1];
    for (int i = 0; i < kPieces; ++i) ends[i] = a + (b - a) * (i * (1.0 / kPieces));
    ends[kPieces] = b;
    Answer answer;
    if constexpr (kHasRough)
      answer = b - a > least_ * (kLong * kPieces) ? ask_roughly(ends) : ask(ends);
    else
      answer = ask(ends);
    const unsigned open = ~(answer.positive | answer.negative | answer.passed) & kAll;
    for (int i = 0; i < kPieces && !done_; ++i) {
      const unsigned piece = 1u << i;
      const double l = ends[i], r = ends[i + 1];
      if (!(open & piece)) {
        if (answer.passed & ~(answer.positive | answer.negative) & piece)
          end_ = r;
        else
          know(answer.positive & piece ? 1 : -1, answer.turns & piece ? r : l, r);
      } else if (open & piece << 1) {
        // The first of two seldom holds what the second seems to hold, too.
        divide(l, ends[++i + 1]);
      } else {
        divide(l, r);
      }
    }
  }

  /// Of long pieces, by what costs less.
  OKTETT_INLINE Answer ask_roughly(const double* ends) {
    const auto f = field_.over_roughly(ends);
    Signs known(f.v);
    const unsigned open = ~known.certain() & kAll;
    if (open == 0) return {known.positive, known.negative, 0, 0};
    if (open & 1) ask_beginning(ends);
    const unsigned turns = open & Signs(f.d).certain();
    if (turns != 0) {
      Signs at_end = known.of_next();
      if (turns & ~at_end.certain()) at_end.add(Signs(field_.at_roughly(ends + 1)), turns);
      ask_ends(ends, turns, at_end, known);
    }
    return {known.positive, known.negative, turns, turns};
  }

  OKTETT_INLINE Answer ask(const double* ends) {
    const D l = D::load(ends), r = D::load(ends + 1), width = r - l, m = l + width * D(0.5);
    const Dual<Interval<D>> f = field_.over({l, r});
    Signs known(f.v);
    unsigned open = ~known.certain() & kAll, noise = 0;
    if (open == 0) return {known.positive, known.negative, 0, 0};
    if (open & 1) ask_beginning(ends);
    // Rounding matters in short pieces alone; for longer ones the middle would tell nothing new.
    const auto asked = D::M::from_bits(open) & (width <= D(least_ * 0x1p28));
    if (any(asked)) {
      const Interval<D> at_m = field_.at(m), mean = at_m + f.d * (Interval<D>(l, r) - Interval<D>(m));
      const Interval<D> value = intersect(f.v, mean);
      known.add(Signs(value), bits(asked & mean.is_bounded()));
      open &= ~known.certain();
      noise = open & ~Signs(at_m).certain() &
              bits(asked & (value.hi - value.lo <= D(8.0) * (at_m.hi - at_m.lo) + D(kTiny * 16)));
    }
    const unsigned turns = open & Signs(f.d).certain();
    if (turns != 0) ask_ends(ends, turns, known.of_next(), known);
    const unsigned passed = noise | turns | bits((width <= D(least_)) | ~((l < m) & (m < r)));
    return {known.positive, known.negative, turns, passed};
  }

  /// Where the first piece has one sign, so has its beginning.
  OKTETT_INLINE void ask_beginning(const double* ends) {
    if (sign_ != 0 || ends[0] != begin_) return;
    const Signs at(field_.at(D::load(ends)));
    sign_ = at.positive & 1 ? 1 : at.negative & 1 ? -1 : 0;
  }
  /// Makes the signs at the ends of the pieces `turns` known, as far as they are not yet.
  OKTETT_INLINE void ask_ends(const double* ends, unsigned turns, Signs at_end, Signs& known) {
    if (turns & ~at_end.certain()) at_end.add(Signs(field_.at(D::load(ends + 1))), turns);
    known.add(at_end, turns);
  }

  /// The crossing in a bracket, which becomes shorter until it is below `tolerance`: eight places are asked
  /// at once, four on each side of the zero of the chord. The farthest is a quarter of the bracket away, each
  /// other one nearer by the factor by which the bracket was shortened last.
  OKTETT_NOINLINE double refine(const Found& found, double tolerance) const {
    double l = found.l, r = found.r, at_l = 0, at_r = 0, part = 0x1p-4;
    for (int round = 0; round < kMaxRounds; ++round) {
      const double width = r - l, chord = l + width * (at_l / (at_l - at_r));
      const bool inside = l < chord && chord < r;
      if (width <= tolerance) return inside ? chord : l + width * 0.5;
      double x[kPieces], value[kPieces];
      if (inside) {
        double away = width * 0.25;
        for (int i = 0; i < kPieces / 2; ++i) {
          x[i] = std::max(l, chord - away), x[kPieces - 1 - i] = std::min(chord + away, r);
          away = i == 0 ? width * part : away * part;
        }
      } else {
        for (int i = 0; i < kPieces; ++i) x[i] = l + width * ((i + 1) * (1.0 / (kPieces + 1)));
      }
      // The signs at the ends are known, though what is asked there may not tell them. Between them the
      // middle is taken: it is known far better than what is proved of it.
      middle(field_.at(D::load(x))).store(value);
      int k = 0;
      while (k < kPieces && (x[k] <= l || (x[k] < r && value[k] * found.before > 0))) ++k;
      const bool within = k < kPieces && x[k] < r;
      if (within && value[k] == 0) return x[k];
      if (k > 0 && x[k - 1] > l) l = x[k - 1], at_l = value[k - 1];
      if (within) r = x[k], at_r = value[k];
      if (!(r - l < width)) break;
      part = std::clamp((r - l) / width, 0x1p-12, 0x1p-3);
    }
    return l + (r - l) * 0.5;
  }

  OKTETT_INLINE void know(double sign, double reached, double to) {
    if (sign_ != 0 && sign != sign_) found_[count_++] = {last_, reached, sign_};
    sign_ = sign, last_ = end_ = to;
    done_ = beyond_ || count_ == K;
  }

  const Field& field_;
  double least_;            ///< pieces shorter than this are not divided
  double begin_;            ///< where the march begins
  double sign_ = 0, last_;  ///< the last certain sign, and the last place that has it
  double end_;              ///< all before it is told or a gap
  bool beyond_ = false, done_ = false;
  int divided_ = 0, count_ = 0;
  Found found_[K];
};

}  // namespace oktett::interval
