#include "verify/oracles/closed.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numbers>

namespace oktett {
namespace {

#if LDBL_MANT_DIG >= 64
using Extended = long double;
#else
__extension__ typedef __float128 Extended;
#endif

using Vec = Vec3<Extended>;

constexpr double kTolerance = 0x1p-48;

Extended magnitude(Extended x) { return x < 0 ? -x : x; }
Extended norm1(const Vec& v) { return magnitude(v.x) + magnitude(v.y) + magnitude(v.z); }
Extended square_root(Extended x) {
  const Extended r = static_cast<Extended>(std::sqrt(static_cast<long double>(x)));
  // One Newton step, for an Extended that is wider than the library's.
  return r > 0 ? (r + x / r) / 2 : r;
}

/// A possible hit and the uncertainty of its place.
struct Root {
  Extended t, error;
};

/// The first root that surely lies in the ray's range; undecided if an earlier one may.
OracleAnswer first_root(const Ray& ray, const Root* roots, int count) {
  for (int i = 0; i < count; ++i) {
    const Extended t = roots[i].t, e = roots[i].error + magnitude(t) * 0x1p-23 + 0x1p-148;
    if (!(t + e > ray.tmin && t - e <= ray.tmax && t - e <= FLT_MAX)) continue;
    const bool sure = t - e > ray.tmin && t + e <= ray.tmax && t + e <= FLT_MAX;
    return {.verdict = sure ? OracleVerdict::hit : OracleVerdict::undecided,
            .t = static_cast<double>(t),
            .t_error = static_cast<double>(roots[i].error)};
  }
  return {};
}

OracleAnswer undecided() { return {OracleVerdict::undecided}; }

/// False for rays that hit nothing by definition.
bool is_usable(const Ray& r) {
  return is_finite(r.origin) && is_finite(r.direction) && r.tmin >= 0 && r.tmin < r.tmax &&
         (r.direction.x != 0 || r.direction.y != 0 || r.direction.z != 0);
}

}  // namespace

OracleAnswer oracle_triangle(const Ray& ray, const Vec3f (&corner)[3], const TriangleTolerance& tolerance) {
  if (!is_usable(ray)) return {};
  const Vec d(ray.direction), o(ray.origin);
  Vec p[3];
  Extended far = 0, edge = 0;
  for (int k = 0; k < 3; ++k) {
    p[k] = Vec(corner[k]) - o;
    far = std::max(far, norm1(p[k]));
    edge = std::max(edge, norm1(Vec(corner[(k + 1) % 3]) - Vec(corner[k])));
  }
  Extended volume[3], slack[3], sum = 0, slack_sum = 0;
  for (int k = 0; k < 3; ++k) {
    volume[k] = dot(d, cross(p[(k + 1) % 3], p[(k + 2) % 3]));
    sum += volume[k];
  }
  const Extended spread = edge * far * norm1(d);
  for (int k = 0; k < 3; ++k) {
    slack[k] =
        tolerance.vertex * norm1(d) * norm1(p[(k + 1) % 3]) * norm1(p[(k + 2) % 3]) + tolerance.edge * spread;
    if (tolerance.conditioned > 0)
      slack[k] +=
          sum == 0 ? spread : tolerance.conditioned * spread * (edge * edge * norm1(d) / magnitude(sum));
    slack_sum += slack[k];
  }
  int positive = 0, negative = 0;
  for (int k = 0; k < 3; ++k) positive += volume[k] > slack[k], negative += volume[k] < -slack[k];
  if (positive > 0 && negative > 0) return {};
  const bool sure = positive == 3 || negative == 3;
  if (sum == 0 || magnitude(sum) <= slack_sum) return undecided();
  const Extended t = dot(p[0], cross(p[1], p[2])) / sum;
  // Displacing the corners moves the hit along the triangle, and each corner's own depth is uncertain too.
  const Extended reach = far / norm1(d);
  const Root root{
      t, slack_sum / magnitude(sum) * (magnitude(t) + reach) + (tolerance.vertex + tolerance.edge) * reach};
  OracleAnswer answer = first_root(ray, &root, 1);
  if (answer.verdict == OracleVerdict::hit && !sure) answer.verdict = OracleVerdict::undecided;
  answer.u = static_cast<double>(volume[1] / sum), answer.v = static_cast<double>(volume[2] / sum);
  answer.uv_error = static_cast<double>(2 * slack_sum / magnitude(sum));
  return answer;
}

OracleAnswer oracle_sphere(const Ray& ray, const SphereShape& sphere) {
  if (!is_usable(ray)) return {};
  const Vec d(ray.direction), m = Vec(sphere.center) - Vec(ray.origin);
  const Extended dd = dot(d, d), r = sphere.radius, distance = square_root(dot(m, m)),
                 speed = square_root(dd);
  const Vec moment = cross(m, d);
  const Extended h = r * r - dot(moment, moment) / dd;
  const Extended slack = kTolerance * (r * r + distance * (distance + r));
  if (h < -slack) return {};
  if (h <= slack) return undecided();
  const Extended half = square_root(h) / speed, closest = dot(m, d) / dd;
  const Extended error = kTolerance * (distance + r) / speed + slack / (square_root(h) * speed);
  const Root roots[] = {{closest - half, error}, {closest + half, error}};
  return first_root(ray, roots, 2);
}

OracleAnswer oracle_plane(const Ray& ray, const PlaneShape& plane) {
  if (!is_usable(ray)) return {};
  const Vec d(ray.direction), o(ray.origin), n(plane.normal);
  const Extended speed = dot(n, d), height = plane.offset - dot(n, o);
  if (speed == 0) return {};
  const Extended slack = kTolerance * (magnitude(plane.offset) + norm1(o));
  if (magnitude(speed) <= kTolerance * norm1(d)) return undecided();
  const Extended t = height / speed;
  const Root root{t, (slack + kTolerance * norm1(d) * magnitude(t)) / magnitude(speed)};
  return first_root(ray, &root, 1);
}

OracleAnswer oracle_disk(const Ray& ray, const DiskShape& disk) {
  const Vec n(disk.normal), c(disk.center), o(ray.origin), d(ray.direction);
  if (!is_usable(ray)) return {};
  const Extended speed = dot(n, d), height = dot(n, c - o);
  if (speed == 0) return {};
  if (magnitude(speed) <= kTolerance * norm1(d)) return undecided();
  const Extended t = height / speed;
  const Extended error =
      (kTolerance * (norm1(c) + norm1(o)) + kTolerance * norm1(d) * magnitude(t)) / magnitude(speed);
  const Vec q = o + d * t - c;
  const Extended distance = square_root(dot(q, q)),
                 slack = error * norm1(d) + kTolerance * (norm1(c) + norm1(o));
  if (distance > disk.radius + slack || distance < disk.inner_radius - slack) return {};
  const Root root{t, error};
  OracleAnswer answer = first_root(ray, &root, 1);
  if (answer.verdict == OracleVerdict::hit &&
      (distance >= disk.radius - slack || distance <= disk.inner_radius + slack))
    answer.verdict = OracleVerdict::undecided;
  return answer;
}

OracleAnswer oracle_box(const Ray& ray, const Affine& to_cube) {
  if (!is_usable(ray)) return {};
  Root near{-FLT_MAX, 0}, far{FLT_MAX, 0};
  near.t *= FLT_MAX, far.t *= FLT_MAX;
  bool doubtful = false;
  for (const auto& row : to_cube.m) {
    Extended o = row[3], d = 0, o_size = 1 + magnitude(row[3]), d_size = 0;
    for (int j = 0; j < 3; ++j) {
      o += Extended(row[j]) * ray.origin[j], d += Extended(row[j]) * ray.direction[j];
      o_size += magnitude(Extended(row[j]) * ray.origin[j]),
          d_size += magnitude(Extended(row[j]) * ray.direction[j]);
    }
    const Extended slack = kTolerance * o_size;
    if (magnitude(d) <= kTolerance * d_size) {
      if (d_size == 0 && magnitude(o) > 1 + slack) return {};
      doubtful |= d_size > 0 || magnitude(o) >= 1 - slack;
      continue;
    }
    const Extended speed = magnitude(d), entry = ((d > 0 ? -1 : 1) - o) / d,
                   exit = ((d > 0 ? 1 : -1) - o) / d;
    const auto error = [&](Extended t) { return (slack + kTolerance * d_size * magnitude(t)) / speed; };
    // Of two planes that may come first either may decide, so the errors add up.
    const Extended ne = error(entry), fe = error(exit);
    near = {std::max(near.t, entry), std::max(near.error, near.t > entry + ne ? near.error : ne)};
    far = {std::min(far.t, exit), std::max(far.error, far.t < exit - fe ? far.error : fe)};
  }
  const Extended gap = far.t - near.t;
  if (gap < -(near.error + far.error)) return {};
  const Root roots[] = {near, far};
  OracleAnswer answer = first_root(ray, roots, 2);
  if (answer.verdict == OracleVerdict::hit && (doubtful || gap <= near.error + far.error))
    answer.verdict = OracleVerdict::undecided;
  return answer;
}

OracleAnswer oracle_slab(const Ray& ray, const Box& box) {
  if (!is_usable(ray)) return {};
  Extended near = ray.tmin, far = ray.tmax;
  for (int k = 0; k < 3; ++k) {
    const Extended lo = Extended(box.lo[k]) - ray.origin[k], hi = Extended(box.hi[k]) - ray.origin[k];
    const Extended d = ray.direction[k];
    if (d == 0) {
      if (lo > 0 || hi < 0) return {};
      continue;
    }
    near = std::max(near, (d > 0 ? lo : hi) / d), far = std::min(far, (d > 0 ? hi : lo) / d);
  }
  return {near <= far ? OracleVerdict::hit : OracleVerdict::miss, static_cast<double>(near)};
}

OracleAnswer oracle_polygon(const Ray& ray, const PolygonShape& polygon) {
  const std::vector<Vec3d>& p = polygon.vertices;
  Vec n{}, center{};
  Extended size = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    n += cross(Vec(p[i]) - Vec(p[0]), Vec(p[(i + 1) % p.size()]) - Vec(p[0]));
    center += Vec(p[i]) / static_cast<Extended>(p.size());
    size = std::max(size, norm1(Vec(p[i]) - Vec(p[0])));
  }
  n = n / square_root(dot(n, n));
  const Vec o(ray.origin), d(ray.direction);
  const Extended speed = dot(n, d);
  if (!is_usable(ray) || speed == 0) return {};
  if (magnitude(speed) <= kTolerance * norm1(d)) return undecided();
  const Extended t = dot(n, center - o) / speed;
  const Extended error =
      (kTolerance * (norm1(center) + norm1(o) + size) + kTolerance * norm1(d) * magnitude(t)) /
      magnitude(speed);
  const Vec hit = o + d * t;
  const Extended slack = 4 * (error * norm1(d) + kTolerance * (norm1(center) + size));
  double winding = 0;
  bool close = false;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec a = Vec(p[i]) - hit, b = Vec(p[(i + 1) % p.size()]) - hit, e = b - a;
    const Extended along = std::clamp<Extended>(-dot(a, e) / dot(e, e), 0, 1);
    const Vec nearest = a + e * along;
    close |= dot(nearest, nearest) <= slack * slack;
    winding += std::atan2(static_cast<double>(dot(n, cross(a, b))), static_cast<double>(dot(a, b)));
  }
  const Root root{t, error};
  OracleAnswer answer = first_root(ray, &root, 1);
  if (answer.verdict == OracleVerdict::miss) return answer;
  if (close) return undecided();
  return std::lround(winding / (2 * std::numbers::pi)) % 2 == 0 ? OracleAnswer{} : answer;
}

}  // namespace oktett
