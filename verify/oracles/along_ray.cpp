#include "verify/oracles/along_ray.h"

#include <algorithm>
#include <cmath>

namespace oktett {

namespace {

/// Stretches between samples along a ray, and more where an oracle spares most of them.
constexpr int kStretches = 768, kManyStretches = 8 * kStretches;
/// Samples within the rounding of a hit at which three do not show a crossing.
constexpr int kFineSamples = 1024;
/// How far off a crossing may be, in units of its slack.
constexpr long double kSharpness = 0x1p-14L;

/// The greatest sum of magnitudes that a component of m p is made of.
long double greatest_sum(const Affine& m, const Vec3l& p) {
  long double most = 0;
  for (const auto& row : m.m) {
    long double sum = std::abs(row[3]);
    for (int k = 0; k < 3; ++k) sum += std::abs(row[k] * p[k]);
    most = std::max(most, sum);
  }
  return most;
}

}  // namespace

AlongRay::AlongRay(const ExactOracle& oracle, const Affine& to_own, const Ray& ray, bool rounded)
    : f_(oracle.f),
      where_(oracle.where),
      clear_(oracle.clear),
      stretches_(oracle.clear ? kManyStretches : kStretches),
      o_(mapped(to_own, Vec3l(ray.origin))),
      d_(mapped(to_own, Vec3l(ray.direction), 0)),
      rounding_(rounded ? 0x1p-24L : 0),
      placing_(0x1p-50L * greatest_sum(to_own, Vec3l(ray.origin))) {
  // The sphere around the box, a little larger.
  const Vec3l c = (Vec3l(oracle.lo) + Vec3l(oracle.hi)) * 0.5L, m = o_ - c;
  const Vec3l half = (Vec3l(oracle.hi) - Vec3l(oracle.lo)) * 0.5L;
  const long double dd = dot(d_, d_), b = dot(m, d_) / dd;
  const long double h = dot(half, half) * 1.02L - (dot(m, m) - b * b * dd);
  size_ = std::sqrt(dot(half, half) / dd), off_ = std::sqrt(dot(o_, o_) / dd);
  if (h < 0) return;
  const long double w = std::sqrt(h / dd);
  begin = std::max(-b - w, static_cast<long double>(ray.tmin));
  end = std::min(-b + w, static_cast<long double>(ray.tmax));
}

long double AlongRay::slack(long double t) const {
  const long double far = std::abs(t) + off_;
  return 0x1p-24L * 1.01L * std::abs(t) + (0x1p-44L + 2 * rounding_) * far + 0x1p-36L * size_;
}

/// Whether f has another sign where rounding the ray may move its point at t.
bool AlongRay::may_turn(long double t) const {
  // A component is rounded by at most 2^-24 of the way; that is 1.8 times as much along the diagonal.
  const long double way = std::sqrt(dot(o_, o_)) + std::abs(t) * std::sqrt(dot(d_, d_));
  const long double reach = 2 * rounding_ * way + placing_;
  const Vec3l p = o_ + d_ * t;
  const bool negative = f_(p) < 0;
  for (int k = 0; k < 6; ++k) {
    Vec3l q = p;
    q[k / 2] += k % 2 == 0 ? reach : -reach;
    if ((f_(q) < 0) != negative) return true;
  }
  return false;
}

long double AlongRay::room(long double t) const {
  const long double s = slack(t);
  if (rounding_ == 0 && !may_turn(t - s) && !may_turn(t + s)) return s;
  for (long double r = s; r < size_; r *= 2) {
    const bool crosses = ((*this)(t - r) < 0) != ((*this)(t + r) < 0);
    if (crosses && !may_turn(t - r) && !may_turn(t + r)) return r;
  }
  return HUGE_VALL;
}

std::vector<long double> AlongRay::crossings() const {
  std::vector<long double> found;
  Sample known;
  if (begin < end) search(0, stretches_, known, found);
  // Two that are nearer to each other than they are known may be a touch: a wall without thickness.
  for (std::size_t i = 1; i < found.size();)
    if (found[i] - found[i - 1] <= 2 * kSharpness * slack(found[i]))
      found.erase(found.begin() + static_cast<std::ptrdiff_t>(i) - 1,
                  found.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    else
      ++i;
  return found;
}

long double AlongRay::place(int sample) const { return begin + (end - begin) * sample / stretches_; }

/// Adds the crossings between two samples. `known` is the last sample that was taken.
void AlongRay::search(int first, int last, Sample& known, std::vector<long double>& found) const {
  const long double t0 = place(first), t1 = place(last);
  if (clear_ && clear_(Vec3d(o_ + d_ * t0), Vec3d(o_ + d_ * t1))) return;
  if (last - first > 1) {
    const int middle = first + (last - first) / 2;
    search(first, middle, known, found);
    search(middle, last, known, found);
    return;
  }
  const long double f0 = known.at == first ? known.f : (*this)(t0), f1 = (*this)(t1);
  known = {last, f1};
  if ((f0 < 0) == (f1 < 0)) return;
  if (const long double t = between(t0, f0, t1, f1); ends(t) < 0) found.push_back(t);
}

/// Where f changes its sign between t0 and t1, where it is f0 and f1, by ITP (Oliveira 2020):
/// secants that are drawn towards the middle, at most one step more than bisection.
long double AlongRay::between(long double t0, long double f0, long double t1, long double f1) const {
  const bool negative = f0 < 0;
  const long double enough = kSharpness * slack(t0), whole = t1 - t0;
  // How far from the middle a step may be, so that bisection could still end in time.
  long double reach = enough * std::exp2(std::ceil(std::log2(std::max(whole / enough, 1.0L))) + 1);
  while (t1 - t0 > enough) {
    const long double middle = t0 + (t1 - t0) / 2, secant = (f1 * t0 - f0 * t1) / (f1 - f0);
    const long double towards = middle < secant ? -1 : 1, draw = 0.2L / whole * (t1 - t0) * (t1 - t0);
    long double t = middle;
    if (draw < std::abs(middle - secant)) t = secant + towards * draw;
    reach /= 2;
    const long double most = std::max(reach - (t1 - t0) / 2, 0.0L);
    if (!(std::abs(t - middle) <= most)) t = middle - towards * most;
    if (!(t > t0 && t < t1)) t = middle;
    if (!(t > t0 && t < t1)) break;
    const long double f = (*this)(t);
    ((f < 0) == negative ? t0 : t1) = t, ((f < 0) == negative ? f0 : f1) = f;
  }
  return t0 + (t1 - t0) / 2;
}

int AlongRay::ends(long double t) const {
  if (!where_) return -1;
  const long double s = slack(t), a = where_(o_ + d_ * (t - s)), b = where_(o_ + d_ * (t + s));
  const long double rounding = std::abs(a - b) + 0x1p-36L * size_ * std::sqrt(dot(d_, d_));
  return a < -rounding && b < -rounding ? -1 : a > rounding && b > rounding ? 1 : 0;
}

AlongRay::Crossing AlongRay::crosses(long double t) const {
  const long double s = slack(t), before = (*this)(t - s), here = (*this)(t), after = (*this)(t + s);
  if (ends(t) > 0) return Crossing::no;
  if ((before < 0) != (after < 0) || (before < 0) != (here < 0)) return Crossing::yes;
  if (may_turn(t)) return Crossing::nearly;
  // Cusps may be thinner than what rounding to float moves t by.
  const long double step = 2 * s / kFineSamples;
  long double l = t - s, fl = before, steepest = 0, cliff = l, least = HUGE_VALL, tip = l;
  for (int i = 1; i < kFineSamples; ++i) {
    const long double r = t - s + step * i, fr = (*this)(r);
    if ((fr < 0) != (before < 0)) return Crossing::nearly;
    if (std::abs(fr - fl) > steepest) steepest = std::abs(fr - fl), cliff = l;
    if (std::abs(fr) < least) least = std::abs(fr), tip = r;
    l = r, fl = fr;
  }
  if (hides_at_cliff(cliff, cliff + step) || hides_at_tip(tip - step, tip + step)) return Crossing::nearly;
  // Touching: |f| has its least value hereabouts, small against what it is a little farther off. As t is
  // rounded to float, that may be beside it.
  const long double off = 0x1p-14L * size_,
                    rim = std::min(std::abs((*this)(t - off)), std::abs((*this)(t + off)));
  return std::min(least, std::abs(here)) <= 0x1p-8L * rim ? Crossing::nearly : Crossing::no;
}

/// Whether f, of one sign at l and r, has the other one next to where it is steepest.
bool AlongRay::hides_at_cliff(long double l, long double r) const {
  long double fl = (*this)(l), fr = (*this)(r);
  for (int k = 0; k < 64; ++k) {
    const long double mid = l + (r - l) / 2, f = (*this)(mid);
    if ((f < 0) != (fl < 0)) return true;
    if (std::abs(f - fl) > std::abs(fr - f))
      r = mid, fr = f;
    else
      l = mid, fl = f;
  }
  return false;
}

/// Whether f has the other sign where it comes nearest to zero between l and r.
bool AlongRay::hides_at_tip(long double l, long double r) const {
  const bool negative = (*this)(l) < 0;
  for (int k = 0; k < 128; ++k) {
    const long double a = l + (r - l) * 0.4L, b = l + (r - l) * 0.6L;
    const long double fa = (*this)(a), fb = (*this)(b);
    if ((fa < 0) != negative || (fb < 0) != negative) return true;
    if (std::abs(fa) < std::abs(fb))
      r = b;
    else
      l = a;
  }
  return false;
}

}  // namespace oktett
