#pragma once
/// \file Crossings of rays with explicit lists of balls and boxes, in long double: the oracle of fractals
/// that are written down in full.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/ray.h"
#include "core/vec3.h"

namespace oktett::test {

using Vec3l = Vec3<long double>;

/// Where a line is inside of something.
struct LineSpan {
  long double in, out;
};

struct ConvexUnion {
  struct Ball {
    Vec3l center;
    long double radius;
  };
  struct Cuboid {
    Vec3l lo, hi;
  };
  std::vector<Ball> balls;
  std::vector<Cuboid> boxes;

  /// The spans of the ray's whole line, in order and apart.
  std::vector<LineSpan> spans(const Ray& ray) const {
    const Vec3l o(ray.origin), d(ray.direction);
    std::vector<LineSpan> all;
    for (const Ball& b : balls) {
      const Vec3l m = o - b.center;
      const long double dd = dot(d, d), at = -dot(m, d) / dd;
      const Vec3l p = m + d * at;
      const long double h2 = b.radius * b.radius - dot(p, p);
      if (h2 > 0) all.push_back({at - std::sqrt(h2 / dd), at + std::sqrt(h2 / dd)});
    }
    for (const Cuboid& b : boxes) {
      long double in = -HUGE_VALL, out = HUGE_VALL;
      for (int k = 0; k < 3; ++k) {
        if (d[k] == 0) {
          if (!(b.lo[k] <= o[k] && o[k] < b.hi[k])) in = HUGE_VALL;
          continue;
        }
        const long double p = (b.lo[k] - o[k]) / d[k], q = (b.hi[k] - o[k]) / d[k];
        in = std::max(in, std::min(p, q)), out = std::min(out, std::max(p, q));
      }
      if (in < out) all.push_back({in, out});
    }
    std::sort(all.begin(), all.end(), [](const LineSpan& a, const LineSpan& b) { return a.in < b.in; });
    std::vector<LineSpan> merged;
    for (const LineSpan& s : all) {
      // Boxes that share a face are one.
      if (!merged.empty() && s.in <= merged.back().out + 1e-15L * (1 + std::abs(s.in)))
        merged.back().out = std::max(merged.back().out, s.out);
      else
        merged.push_back(s);
    }
    return merged;
  }

  bool holds(const Vec3l& p) const {
    for (const Ball& b : balls)
      if (dot(p - b.center, p - b.center) < b.radius * b.radius) return true;
    for (const Cuboid& b : boxes) {
      bool in = true;
      for (int k = 0; k < 3; ++k) in &= b.lo[k] <= p[k] && p[k] < b.hi[k];
      if (in) return true;
    }
    return false;
  }
};

/// Without spans and gaps shorter than `least`, which rounding may hide or show; crossings behind the ray's
/// origin are dropped too.
inline std::vector<long double> sure_crossings(const std::vector<LineSpan>& spans, long double least) {
  std::vector<LineSpan> kept;
  for (const LineSpan& s : spans) {
    if (!kept.empty() && s.in - kept.back().out < least)
      kept.back().out = s.out;
    else
      kept.push_back(s);
  }
  std::vector<long double> all;
  for (const LineSpan& s : kept) {
    if (s.out - s.in < least) continue;
    if (s.in > 0) all.push_back(s.in);
    if (s.out > 0) all.push_back(s.out);
  }
  return all;
}

}  // namespace oktett::test
