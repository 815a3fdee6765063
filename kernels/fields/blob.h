#pragma once
/// \file Blobs of inverse squares (Melcher, "Blobs, Typ I"): 1/p_1 + ... + 1/p_n = I, with p_i the squared
/// distance from a point, a line or a plane.
///
/// Along a ray each p_i is a quadratic in s, and the equation is multiplied by all of them there, not in x, y
/// and z: I p_1 ... p_n - (p_2 ... p_n + p_1 p_3 ... p_n + ...) = 0.

#include <array>
#include <optional>

#include "kernels/exact/ray_polynomial.h"
#include "kernels/fields/blob_data.h"

namespace oktett {

/// The corners of the box that a blob lies in or is cut by; nothing if it has no bounds, or no surface.
std::optional<std::array<Vec3d, 2>> blob_box(const BlobShape& shape);

struct BlobElement {
  /// p = |A (x - at)|^2, where A leaves a vector as it is, takes away its part along `axis`, or leaves only
  /// that.
  struct Source {
    BlobSource::Kind kind;
    Vec3d at, axis;
    double weight;
  };
  Source sources[kMaxBlobSources];
  int count;
  double iso;
  bool open;
  roots::Method root_finder;
  Vec3d lo, hi;
};

/// Parts: 0 the surface, 1 to 6 the faces of the box.
struct Blob {
  using Data = BlobShape;
  using Pool = ExactPool<BlobElement>;
  static constexpr int kMaxCrossings = roots::kMaxDegree + 2;
  /// Products of more quadratics than this are made in parts of the ray: at the distance d from a source they
  /// lose a factor of (1 + length / d)^2 each.
  static constexpr int kWholeSources = 4;

  static void add(Pool& pool, const BlobShape& shape, const ExactPlace& place);

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const BlobElement& e = pool.elements[cell.element];
    const RaySegment<D> segment(line, range);
    const int degree = 2 * e.count;
    D s[K], turn[K], sign;
    if (e.count <= kWholeSources) {
      D c[kMaxRayDegree + 1];
      multiply_out(e, segment, c);
      sign_changes<K>(c, degree, e.root_finder, active, s, turn);
      sign = common_sign(c, degree);
    } else {
      sign_changes_in_parts<K>(
          e.count, segment, degree, e.root_finder, active,
          [&](const RaySegment<D>& part, D* c) { multiply_out(e, part, c); }, s, turn, sign);
      for (int k = 0; k < K; ++k) polish(e, segment, s[k]);
    }
    list_sign_changes(s, turn, sign, !e.open, segment, range, active, out);
  }

  /// The function is I minus the sum.
  static Slope slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p);

 private:
  template <class D>
  OKTETT_INLINE static void squared_distance(const BlobElement::Source& source, const RaySegment<D>& segment,
                                             D (&q)[3]) {
    const Vec3<D> m = sub_lanes(segment.m, broadcast<D>(source.at));
    const Vec3<D>& h = segment.h;
    const Vec3<D> axis = broadcast<D>(source.axis);
    Vec3<D> a = m, b = h;
    if (source.kind == BlobSource::Kind::plane) {
      const D u = dot_lanes(m, axis), v = dot_lanes(h, axis);
      q[0] = u * u, q[1] = D(2.0) * u * v, q[2] = v * v;
      return;
    }
    if (source.kind == BlobSource::Kind::line) a = cross_lanes(m, axis), b = cross_lanes(h, axis);
    q[0] = dot_lanes(a, a), q[1] = D(2.0) * dot_lanes(a, b), q[2] = dot_lanes(b, b);
  }

  /// Newton's method on the sum itself, which is better conditioned than what it is multiplied out to.
  template <class D>
  OKTETT_NOINLINE static void polish(const BlobElement& e, const RaySegment<D>& segment, D& s) {
    const auto there = s < D(roots::kNoRoot);
    if (none(there)) return;
    D x = select(there, s, D(0.0));
    for (int step = 0; step < 2; ++step) {
      D value(e.iso), slope(0.0);
      for (int n = 0; n < e.count; ++n) {
        D q[3];
        squared_distance(e.sources[n], segment, q);
        const D p = (q[2] * x + q[1]) * x + q[0], inverse = D(1.0) / p;
        const D term = D(e.sources[n].weight) * inverse;
        value = value - term;
        slope = slope + term * inverse * (D(2.0) * q[2] * x + q[1]);
      }
      const D change = value / slope;
      x = select(abs(change) < D(0x1p-12), x - change, x);
    }
    s = select(there, min(max(x, D(-1.0)), D(1.0)), s);
  }

  template <class D>
  OKTETT_NOINLINE static void multiply_out(const BlobElement& e, const RaySegment<D>& segment, D* c) {
    // The product of the first sources, and the sum of products that each leave one out.
    D product[kMaxRayDegree + 1];
    product[0] = D(1.0);
    for (int n = 0; n < e.count; ++n) {
      D q[3];
      squared_distance(e.sources[n], segment, q);
      const D w(e.sources[n].weight);
      const int degree = 2 * n;
      if (n == 0) {
        c[0] = w;
      } else {
        times_quadratic(c, degree - 2, q);
        for (int k = 0; k <= degree; ++k) c[k] = c[k] + w * product[k];
      }
      times_quadratic(product, degree, q);
    }
    const int degree = 2 * e.count;
    const D iso(e.iso);
    c[degree] = c[degree - 1] = D(0.0);
    for (int k = 0; k <= degree; ++k) c[k] = iso * product[k] - c[k];
  }
};

}  // namespace oktett
