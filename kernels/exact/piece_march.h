#pragma once
/// \file Crossings of a function along one ray, isolated as in march.h, with pieces of the ray in lanes.
///
/// A piece that tells nothing is divided into eight, whatever the number of lanes, so that each instruction
/// set finds the same bits, and a ray that comes alone fills the lanes. The function is bounded, and over(t)
/// as narrow as the mean value form.

#include <algorithm>

#include "kernels/exact/march.h"

namespace oktett::interval {

/// The crossings of `field`, in lanes of D, with one ray: the first K from a to b. What is not told apart
/// from b may be between b and `limit`. The least piece is 2^-44 of `range`, as in march().
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

  /// Calls f(x, before) for each crossing in order, which is less than `tolerance` from x or where rounding
  /// hides the sign; `before` is the sign on its near side.
  template <class F>
  OKTETT_INLINE void each(double tolerance, F&& f) const {
    for (int i = 0; i < count_; ++i) f(refine(found_[i], tolerance), found_[i].before);
  }

  /// All crossings before this are found.
  double up_to() const { return count_ < K ? roots::kNoRoot : end_; }

 private:
  static constexpr int kPieces = 8, kMaxRounds = 64, W = D::kWidth;
  static_assert(kPieces % W == 0);

  /// What the function says about pieces in lanes.
  struct Answer {
    double sign[W];   ///< -1 or 1 where it is certain
    unsigned turns;   ///< where that is the sign at the end of a piece in which it may turn once
    unsigned passed;  ///< where nothing more can be told, so that the piece is a gap
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
    for (int first = 0; first < kPieces; first += W) {
      const Answer answer = ask(ends + first);
      for (int i = 0; i < W && !done_; ++i) {
        const double l = ends[first + i], r = ends[first + i + 1];
        if (answer.sign[i] != 0)
          know(answer.sign[i], answer.turns >> i & 1 ? r : l, r);
        else if (answer.passed >> i & 1)
          end_ = r;
        else
          divide(l, r);
      }
      if (done_) return;
    }
  }

  OKTETT_INLINE Answer ask(const double* ends) {
    const D zero(0.0), l = D::load(ends), r = D::load(ends + 1), width = r - l, m = l + width * D(0.5);
    const Dual<Interval<D>> f = field_.over({l, r});
    D sign = certain_sign(f.v);
    auto open = sign == zero;
    Answer answer;
    answer.turns = answer.passed = 0;
    if (any(open)) {
      // Where the first piece has one sign, so has its beginning.
      if (sign_ == 0 && ends[0] == begin_ && (bits(open) & 1)) {
        double at_begin[W];
        certain_sign(field_.at(l)).store(at_begin);
        sign_ = at_begin[0];
      }
      // Rounding matters in short pieces alone; for longer ones the middle would tell nothing new.
      const auto asked = open & (width <= D(least_ * 0x1p28));
      auto noise = open & ~open;
      if (any(asked)) {
        const Interval<D> at_m = field_.at(m), mean = at_m + f.d * (Interval<D>(l, r) - Interval<D>(m));
        const Interval<D> value = select(asked & mean.is_bounded(), intersect(f.v, mean), f.v);
        sign = certain_sign(value);
        open = sign == zero;
        noise = open & asked & (certain_sign(at_m) == zero) &
                (value.hi - value.lo <= D(8.0) * (at_m.hi - at_m.lo) + D(kTiny * 16));
      }
      const auto monotone = open & ((zero < f.d.lo) | (f.d.hi < zero));
      if (any(monotone)) {
        const D at_end = certain_sign(field_.at(r));
        sign = select(monotone, at_end, sign);
        answer.turns = bits(monotone);
      }
      answer.passed = bits(noise | monotone | (width <= D(least_)) | ~((l < m) & (m < r)));
    }
    sign.store(answer.sign);
    return answer;
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
      double x[kPieces], sign[kPieces], value[kPieces];
      if (inside) {
        double away = width * 0.25;
        for (int i = 0; i < kPieces / 2; ++i) {
          x[i] = std::max(l, chord - away), x[kPieces - 1 - i] = std::min(chord + away, r);
          away = i == 0 ? width * part : away * part;
        }
      } else {
        for (int i = 0; i < kPieces; ++i) x[i] = l + width * ((i + 1) * (1.0 / (kPieces + 1)));
      }
      for (int first = 0; first < kPieces; first += W) {
        const Interval<D> f = field_.at(D::load(x + first));
        certain_sign(f).store(sign + first), middle(f).store(value + first);
      }
      // The signs at the ends are known, though what is asked there may not tell them.
      int k = 0;
      while (k < kPieces && (x[k] <= l || (x[k] < r && sign[k] == found.before))) ++k;
      const bool within = k < kPieces && x[k] < r;
      if (within && sign[k] == 0) return x[k];
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
