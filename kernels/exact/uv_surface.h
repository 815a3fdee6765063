#pragma once
/// \file What surfaces that are given by two parameters have in common. They are cut into pieces when the
/// tree is built, each a cell; a ray is solved in each piece on its own (kernels/exact/uv_solver.h). The ray
/// is taken to a frame of its own once for the whole surface, so that pieces that share an edge see the same
/// ray.
///
/// Such a surface S is derived from UvSurface and has
/// - `S::search(element, piece, ray, found)`: calls found(UvRoot) for each crossing of the whole line;
/// returns
///   false if it gave up;
/// - `S::point(element, piece, u, v)`: a UvPoint;
/// - `S::is_cut(element, p)`: whether the point p of its own space is cut away.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/closed/surface_points.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/exact_pool.h"
#include "kernels/exact/line_columns.h"
#include "kernels/exact/march.h"
#include "kernels/exact/uv_solver.h"

namespace oktett {

/// A ray in a frame whose z axis it is, in lengths of the own space.
struct UvRay {
  Vec3d p, u, x, y;
  double shift, scale;  ///< t = shift + z scale
  double error;         ///< bounds roundings of points in the frame

  UvRay(const Vec3d& o, const Vec3d& d) {
    const double dd = dot(d, d);
    scale = 1 / std::sqrt(dd), shift = -(dot(o, d) / dd);
    p = o + d * shift, u = d * scale;
    make_basis(u, x, y);
    // Points are about 1 from the origin. The last term is for surfaces that are objects of their own.
    error = 0x1p-48 * (2 + length(p)) + 0x1p-52 * length(o);
  }
  double to_t(double z) const { return shift + z * scale; }
  Vec3d turned(const Vec3d& v) const { return {dot(x, v), dot(y, v), dot(u, v)}; }
  Vec3d framed(const Vec3d& q) const { return turned(q - p); }
};

/// A point of a surface in its own space, its derivatives by the parameters, and its texture coordinates with
/// the derivatives of the point by these.
struct UvPoint {
  Vec3d p, by_u, by_v;
  double texture[2];
  Vec3d tangent, bitangent;
};

struct UvCrossing {
  double t, z, turn;
  double u, v;
};

/// The crossings with one piece in the order of t, each once.
class UvList {
 public:
  static constexpr int kMost = 48;

  int count() const { return count_; }
  const UvCrossing& operator[](int i) const { return list_[i]; }
  void push(const UvCrossing& c) {
    // The same crossing may be found in two halves of a piece.
    for (int i = 0; i < count_; ++i)
      if (list_[i].turn == c.turn && std::abs(list_[i].z - c.z) < 0x1p-36) return;
    if (count_ == kMost) return;
    int at = count_++;
    for (; at > 0 && c.z < list_[at - 1].z; --at) list_[at] = list_[at - 1];
    list_[at] = c;
  }

 private:
  UvCrossing list_[kMost];
  int count_ = 0;
};

/// What elements have in common.
struct UvElement {
  bool is_flipped = false;  ///< the normal is -dP/du x dP/dv
};

/// S is the surface, Shape its data, E its element with a vector `pieces`, which have a box `lo`, `hi` and
/// the rectangle `box` of their parameters.
template <class S, class Shape, class E>
struct UvSurface {
  using Data = Shape;
  using Element = E;
  struct Pool : ExactPool<E> {
    std::size_t bytes() const {
      std::size_t sum = ExactPool<E>::bytes();
      for (const E& e : this->elements) sum += e.pieces.capacity() * sizeof(e.pieces[0]);
      return sum;
    }
  };
  static constexpr int kMaxCrossings = 18;
  /// What goes in need not come out.
  static constexpr bool kSheets = true;

  /// All crossings of a line with a piece.
  static void list(const E& e, std::size_t piece, const UvRay& ray, UvList& out) {
    const bool certain = S::search(e, piece, ray, [&](const UvRoot& root) {
      const Vec3d p = S::point(e, piece, root.u, root.v).p;
      const double z = dot(ray.u, p - ray.p);
      if (!S::is_cut(e, p)) out.push({ray.to_t(z), z, e.is_flipped ? -root.turn : root.turn, root.u, root.v});
    });
    if (!certain) interval::count_uncertified(1);
  }

  template <int K, class D>
  static void crossings(const Pool& pool, const ExactCell& cell, const Line<D>& line,
                        const LineRange<D>& range, const typename D::M& active, Crossings<K, D>& out) {
    const LineColumns<D> rays(line, range);
    CrossingColumns<K, D> lists;
    for (unsigned lanes = bits(active); lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      double t[K], turn[K];
      const int count = S::first_of(pool.elements[cell.element], cell.begin, rays.o(i), rays.d(i),
                                    rays.begin(i), K, t, turn, lists.up_to[i]);
      for (int k = 0; k < count; ++k)
        lists.t[k][i] = t[k], lists.turn[k][i] = turn[k], lists.part[k][i] = static_cast<double>(cell.begin);
    }
    lists.load(out);
  }

  /// Whether p is inside of a surface that is closed: the winding number, as seen along some line.
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p) {
    const E& e = pool.elements[i];
    const UvRay ray(p, {0.53, 0.79, 0.31});
    std::vector<UvCrossing> all;
    for (std::size_t k = 0; k < e.pieces.size(); ++k) {
      if (!meets(e.pieces[k].lo, e.pieces[k].hi, ray)) continue;
      UvList found;
      list(e, k, ray, found);
      for (int c = 0; c < found.count(); ++c)
        if (found[c].t > 0) all.push_back(found[c]);
    }
    std::sort(all.begin(), all.end(), [](const UvCrossing& a, const UvCrossing& b) { return a.z < b.z; });
    double sum = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool again = k > 0 && all[k].turn == all[k - 1].turn && all[k].z - all[k - 1].z < 0x1p-36;
      if (!again) sum += all[k].turn;
    }
    return sum > 0;
  }

  /// Whether two places of a ray are the same but for the rounding of hits.
  static bool is_near(const Ray& ray, double a, double b) {
    const double along = max_component(abs(Vec3d(ray.direction)));
    return std::abs(a - b) * along <= 0x1p-23 * (max_component(abs(Vec3d(ray.origin))) + std::abs(b) * along);
  }

  static SurfaceInteraction interaction(const Pool& pool, std::size_t i, const Ray& ray, const Hit& hit) {
    const E& e = pool.elements[i];
    const ExactFrame& frame = pool.frames[i];
    const UvRay line(frame.to_own.point(Vec3d(ray.origin)), frame.to_own.vector(Vec3d(ray.direction)));
    const auto piece = static_cast<std::size_t>(hit.u);
    UvList found;
    list(e, piece, line, found);
    const UvCrossing* best = nullptr;
    for (int k = 0; k < found.count(); ++k)
      if (found[k].turn == hit.v &&
          (best == nullptr || std::abs(found[k].t - hit.t) < std::abs(best->t - hit.t)))
        best = &found[k];
    SurfaceInteraction s;
    // A hit that is not found again has its point on the ray. Somebody made it up; or it was found by the
    // line in an instance, and next to a fold that of the ray in the world has another crossing.
    const bool is_found = best != nullptr && is_near(ray, best->t, hit.t);
    const double t = is_found ? best->t : hit.t;
    const Vec3d on_ray = line.p + line.u * ((t - line.shift) / line.scale);
    UvPoint at{on_ray, {}, {}, {0, 0}, {}, {}};
    Vec3d n = line.u * static_cast<double>(hit.v);
    if (best != nullptr) {
      at = S::point(e, piece, best->u, best->v);
      const Vec3d own = normal_at(e, piece, best->u, best->v, at);
      if (dot(own, own) > 0) n = e.is_flipped ? -own : own;
      if (!is_found) at.p = on_ray;
    }
    const Vec3d point = frame.to_world.point(at.p);
    set_position(s, point, ray, t, 0x1p-44 * (length(point) + stretch(frame.to_world)));
    n = frame.to_own.normal_by_inverse(n);
    s.geometric_normal = s.shading_normal = Vec3f(n / length(n));
    s.uv = {static_cast<float>(at.texture[0]), static_cast<float>(at.texture[1])};
    s.tangent = Vec3f(frame.to_world.vector(at.tangent));
    s.bitangent = Vec3f(frame.to_world.vector(at.bitangent));
    return s;
  }

  /// Sets is_flipped of a closed surface so that normals point outwards: by the sign of its volume.
  static void turn_outwards(E& e) {
    constexpr int kPoints = 6;
    double volume = 0;
    for (std::size_t k = 0; k < e.pieces.size(); ++k) {
      const UvBox& box = e.pieces[k].box;
      const double wide = box.u1 - box.u0, high = box.v1 - box.v0;
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const UvPoint at = S::point(e, k, box.u0 + wide * (i % kPoints + 0.5) / kPoints,
                                    box.v0 + high * (i / kPoints + 0.5) / kPoints);
        const double part = dot(at.p, cross(at.by_u, at.by_v)) * wide * high;
        if (std::isfinite(part)) volume += part;
      }
    }
    e.is_flipped = volume < 0;
  }

 protected:
  /// The first `room` crossings from `begin` on. All below `up_to` are listed.
  static int first_crossings_of(const E& e, std::size_t piece, const Vec3d& o, const Vec3d& d, double begin,
                                int room, double* t, double* turn, double& up_to) {
    UvList found;
    list(e, piece, UvRay(o, d), found);
    int count = 0;
    for (int k = 0; k < found.count(); ++k) {
      if (found[k].t < begin) continue;
      if (count == room) {
        up_to = found[k].t;
        break;
      }
      t[count] = found[k].t, turn[count] = found[k].turn, ++count;
    }
    return count;
  }

 private:
  /// dP/du x dP/dv; where that vanishes, as at a collapsed edge, what it is a little farther in.
  static Vec3d normal_at(const E& e, std::size_t piece, double u, double v, const UvPoint& at) {
    const Vec3d here = cross(at.by_u, at.by_v);
    const UvBox& box = e.pieces[piece].box;
    const double mu = (box.u0 + box.u1) * 0.5, mv = (box.v0 + box.v1) * 0.5;
    const Vec3d whole = cross(S::point(e, piece, mu, mv).by_u, S::point(e, piece, mu, mv).by_v);
    const auto is_finite = [](const Vec3d& n) { return std::isfinite(n.x + n.y + n.z); };
    if (is_finite(here) && length(here) > 0x1p-34 * length(whole)) return here;
    for (double step = 0x1p-20; step < 1; step *= 0x1p4) {
      const UvPoint in = S::point(e, piece, u + (mu - u) * step, v + (mv - v) * step);
      const Vec3d n = cross(in.by_u, in.by_v);
      if (is_finite(n) && length(n) > 0x1p-34 * length(whole)) return n / length(n);
    }
    return is_finite(whole) ? whole : Vec3d{0, 0, 0};
  }

  static bool meets(const Vec3d& lo, const Vec3d& hi, const UvRay& ray) {
    double near = -HUGE_VAL, far = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      const double a = (lo[k] - ray.p[k]) / ray.u[k], b = (hi[k] - ray.p[k]) / ray.u[k];
      near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }
};

}  // namespace oktett
