#include "accel/time/instance_motion.h"

#include <algorithm>
#include <cmath>

namespace oktett {

namespace {

using Quaternion = std::array<double, 4>;

double dot(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Quaternion unit(const double (&q)[4]) {
  Quaternion u{q[0], q[1], q[2], q[3]};
  const double size = std::sqrt(dot(u, u));
  for (double& x : u) x /= size;
  return u;
}

Affine rotation_of(const Quaternion& q) {
  const double r = q[0], i = q[1], j = q[2], k = q[3];
  Affine a;
  a.m = {{{r * r + i * i - j * j - k * k, 2 * (i * j - r * k), 2 * (i * k + r * j), 0},
          {2 * (i * j + r * k), r * r - i * i + j * j - k * k, 2 * (j * k - r * i), 0},
          {2 * (i * k - r * j), 2 * (j * k + r * i), r * r - i * i - j * j + k * k, 0}}};
  return a;
}

/// Half the angle between two rotations, at most a right angle.
double half_angle(const Quaternion& a, const Quaternion& b) {
  return std::acos(std::min(1.0, std::abs(dot(a, b))));
}

/// The rotation between two, of which the part f is gone.
Quaternion slerp(const Quaternion& a, const Quaternion& b, double f) {
  const double sign = dot(a, b) < 0 ? -1 : 1, angle = half_angle(a, b);
  Quaternion q;
  if (angle < 1e-7) {
    for (std::size_t i = 0; i < 4; ++i) q[i] = (1 - f) * a[i] + f * sign * b[i];
  } else {
    const double wa = std::sin((1 - f) * angle) / std::sin(angle), wb = std::sin(f * angle) / std::sin(angle);
    for (std::size_t i = 0; i < 4; ++i) q[i] = wa * a[i] + wb * sign * b[i];
  }
  return q;
}

Affine between(const Affine& a, const Affine& b, double f) {
  Affine m;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) m.m[r][c] = (1 - f) * a.m[r][c] + f * b.m[r][c];
  return m;
}

Affine map_of(const TurningMap& a, const TurningMap& b, double f) {
  Affine map = rotation_of(slerp(unit(a.quaternion), unit(b.quaternion), f)) * between(a.inner, b.inner, f);
  const Vec3d shift = a.outer * (1 - f) + b.outer * f;
  for (std::size_t k = 0; k < 3; ++k) map.m[k][3] += shift[static_cast<int>(k)];
  return map;
}

/// How far the image of a point of `box` may be from the straight line between its images at two keys.
///
/// With R turning by the angle w between the keys and q moving from q0 to q1 along a line, the second
/// derivative of R q is R'' q + 2 R' q', at most w^2 max |q| + 2 w |q1 - q0|; a function deviates from its
/// chord by at most an eighth of it.
double bulge(const TurningMap& a, const TurningMap& b, const Box& box) {
  const double w = 2 * half_angle(unit(a.quaternion), unit(b.quaternion));
  double farthest = 0, way = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                  corner & 4 ? box.hi.z : box.lo.z};
    const Vec3d qa = a.inner.point(p), qb = b.inner.point(p);
    farthest = std::max({farthest, length(qa), length(qb)}), way = std::max(way, length(qb - qa));
  }
  return (w * w * farthest + 2 * w * way) / 8;
}

Box grown(Box box, double by) {
  const Vec3d more{by, by, by};
  return {round_down(Vec3d(box.lo) - more), round_up(Vec3d(box.hi) + more)};
}

/// The keys of an instance: `transform(k)`, or `turning(k)` if they turn.
template <class Transform, class Turning>
struct Keys {
  std::uint32_t count;
  bool turn;
  Transform transform;
  Turning turning;

  // Clang 14 deduces the types of no aggregate.
  Keys(std::uint32_t keys, bool turns, Transform transform_of, Turning turning_of)
      : count(keys), turn(turns), transform(transform_of), turning(turning_of) {}

  Affine at(const KeyTime& time) const {
    const std::uint32_t next = std::min(time.key + 1, count - 1);
    const double f = static_cast<double>(time.f);
    if (turn) return map_of(turning(time.key), turning(next), f);
    if (next == time.key) return transform(time.key);
    return between(transform(time.key), transform(next), f);
  }

  Box bounds(const Box& box, std::uint32_t key) const {
    if (box.empty()) return {};
    const Box image = transform_bounds(at({key, 0}), box);
    if (image.empty()) return {};
    const Vec3f e = image.extent();
    const float size = std::max({e.x, e.y, e.z, max_component(abs(image.lo)), max_component(abs(image.hi))});
    const Box moved = grown(image, 0x1p-20 * static_cast<double>(size));
    if (!turn) return moved;
    double most = 0;
    if (key > 0) most = bulge(turning(key - 1), turning(key), box);
    if (key + 1 < count) most = std::max(most, bulge(turning(key), turning(key + 1), box));
    return grown(moved, most * (1 + 0x1p-20));
  }
};

auto keys_of(const SceneInstance& one) {
  return Keys{key_count(one), !one.turning.empty(),
              [&one](std::uint32_t k) -> const Affine& { return one.transforms[k]; },
              [&one](std::uint32_t k) -> const TurningMap& { return one.turning[k]; }};
}

auto keys_of(const SceneInstances& many, std::uint32_t i) {
  return Keys{key_count(many), !many.turning.empty(),
              [&many, i](std::uint32_t k) -> const Affine& {
                return k == 0 ? many.places[i].transform : many.later_transforms[k - 1][i];
              },
              [&many, i](std::uint32_t k) -> const TurningMap& { return many.turning[k][i]; }};
}

}  // namespace

std::uint32_t key_count(const SceneInstance& instance) {
  return static_cast<std::uint32_t>(instance.turning.empty() ? instance.transforms.size()
                                                             : instance.turning.size());
}

std::uint32_t key_count(const SceneInstances& instances) {
  return static_cast<std::uint32_t>(instances.turning.empty() ? 1 + instances.later_transforms.size()
                                                              : instances.turning.size());
}

Affine map_at(const SceneInstance& instance, const KeyTime& time) { return keys_of(instance).at(time); }

Affine map_at(const SceneInstances& instances, std::uint32_t index, const KeyTime& time) {
  return keys_of(instances, index).at(time);
}

Affine map_at(const SceneGeometry& geometry, std::uint32_t index, float own_time) {
  if (const auto* const one = std::get_if<SceneInstance>(&geometry.shape))
    return map_at(*one, KeyTime::of(own_time, key_count(*one)));
  const auto& many = std::get<SceneInstances>(geometry.shape);
  return map_at(many, index, KeyTime::of(own_time, key_count(many)));
}

Box moved_bounds(const SceneInstance& instance, const Box& box, std::uint32_t key) {
  return keys_of(instance).bounds(box, key);
}

Box moved_bounds(const SceneInstances& instances, std::uint32_t index, const Box& box, std::uint32_t key) {
  return keys_of(instances, index).bounds(box, key);
}

}  // namespace oktett
