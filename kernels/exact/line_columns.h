#pragma once
/// \file Lines in columns of numbers, for surfaces that look for crossings one lane after the other.

#include "kernels/exact/exact.h"

namespace oktett {

/// The lines in lanes of D, and where on each to look.
template <class D>
class LineColumns {
 public:
  OKTETT_INLINE LineColumns(const Line<D>& line, const LineRange<D>& range) {
    const D* from[6] = {&line.o.x, &line.o.y, &line.o.z, &line.d.x, &line.d.y, &line.d.z};
    for (int i = 0; i < 6; ++i) from[i]->store(line_[i]);
    range.a.store(a_), range.b.store(b_);
    select(range.enter_face == D(0.0), range.a, D(-roots::kNoRoot)).store(begin_);
  }

  Vec3d o(int lane) const { return {line_[0][lane], line_[1][lane], line_[2][lane]}; }
  Vec3d d(int lane) const { return {line_[3][lane], line_[4][lane], line_[5][lane]}; }
  double a(int lane) const { return a_[lane]; }
  double b(int lane) const { return b_[lane]; }
  /// Where the ray begins if that is inside of the cell, else before everything: crossings count from there
  /// on.
  double begin(int lane) const { return begin_[lane]; }

 private:
  double line_[6][D::kWidth], a_[D::kWidth], b_[D::kWidth], begin_[D::kWidth];
};

}  // namespace oktett
