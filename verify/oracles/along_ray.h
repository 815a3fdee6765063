#pragma once
/// \file What an oracle's function does along a ray: dense sampling wherever it is not known to keep its
/// sign, then a search between samples of different signs.

#include <vector>

#include "core/ray.h"
#include "verify/oracles/exact.h"

namespace oktett {

/// The function along a ray, in the space of the shape's description. What is thinner than one of its samples
/// may escape it, never the tracer.
class AlongRay {
 public:
  /// `to_own` maps to that space. `rounded`: the tracer rounds the ray to float there, as it does inside of
  /// instances. The oracle must outlive this object.
  AlongRay(const ExactOracle& oracle, const Affine& to_own, const Ray& ray, bool rounded = false);

  long double operator()(long double t) const { return f_(o_ + d_ * t); }
  /// Where t may be off: what rounding to float and the ray's way into the own space allow.
  long double slack(long double t) const;
  /// How far from a crossing at t the tracer's hit may be: the slack, or more where rounding displaces a ray
  /// that meets the surface at a slant, as it does in instances and far from the origin. Infinite if rounding
  /// may leave the crossing out.
  long double room(long double t) const;
  /// Crossings, each off by at most 2^-14 of its slack; none where two are within twice that of each other.
  std::vector<long double> crossings() const;
  /// Whether an open surface is there: -1 surely, 1 surely not, 0 if rounding may decide.
  int ends(long double t) const;
  /// Whether f changes its sign near t, or comes so near to zero that rounding the ray decides.
  enum class Crossing { yes, nearly, no };
  Crossing crosses(long double t) const;

  /// The part of the ray that may meet the surface; empty if begin >= end.
  long double begin = 0, end = -1;

 private:
  /// A sample's number and value.
  struct Sample {
    int at = -1;
    long double f = 0;
  };
  long double place(int sample) const;
  void search(int first, int last, Sample& known, std::vector<long double>& found) const;
  long double between(long double t0, long double f0, long double t1, long double f1) const;
  bool may_turn(long double t) const;
  bool hides_at_cliff(long double l, long double r) const;
  bool hides_at_tip(long double l, long double r) const;

  const SurfaceFunction &f_, &where_;
  const ClearWay& clear_;
  int stretches_;  ///< that the ray is cut into
  Vec3l o_, d_;
  long double size_ = 0, rounding_ = 0;
  long double off_;  ///< how far the ray's origin is from that of the own space, in lengths of the direction
  long double placing_;  ///< by how much the map of an origin far from zero may round, in the own space
};

}  // namespace oktett
