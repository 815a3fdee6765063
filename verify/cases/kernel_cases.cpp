#include "verify/cases/kernel_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "kernels/closed/box_solid.h"

namespace oktett {

const char* to_string(CaseClass c) {
  constexpr const char* kNames[kCaseClasses] = {"random",  "axis", "vertex", "edge",
                                                "grazing", "far",  "huge",   "tiny"};
  return kNames[static_cast<int>(c)];
}

const char* to_string(KernelId id) {
  constexpr const char* kNames[kKernels] = {"triangle_watertight",
                                            "triangle_moller_trumbore",
                                            "triangle_badouel",
                                            "triangle_segura_feito",
                                            "sphere_geometric",
                                            "sphere_algebraic",
                                            "sphere_in_range",
                                            "plane",
                                            "disk",
                                            "box",
                                            "slab"};
  return kNames[static_cast<int>(id)];
}

std::uint64_t CaseRandom::bits() {
  ++drawn_;
  return random_bits(key_, static_cast<std::uint32_t>(drawn_ >> 32), static_cast<std::uint32_t>(drawn_));
}

Vec3d CaseRandom::vector() {
  const double x = sign(), y = sign(), z = sign();
  return {x, y, z};
}

double CaseRandom::magnitude(double lo, double hi) { return std::pow(10.0, lo + (hi - lo) * unit()); }

namespace {

/// Where rays may aim at a shape: somewhere about it, at a corner, at an edge; and how its surface lies
/// there.
struct Targets {
  Vec3d about, vertex, edge;
  Vec3d normal, tangent;  ///< at `edge`; tangent of about the shape's size
};

struct Frame {
  double scale;
  Vec3d offset;
};

Vec3d perpendicular(const Vec3d& v, CaseRandom& r) {
  const Vec3d p = cross(v, r.vector());
  return length(p) > 0 ? normalize(p) : Vec3d{1, 0, 0};
}

/// The columns of shape i.
void put(KernelCases& cases, std::size_t i, std::initializer_list<double> values) {
  Column<double>* column = cases.shape;
  for (const double value : values) (*column++)[i] = value;
}

Targets make_triangle(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  Vec3d p[3];
  for (Vec3d& q : p) q = r.vector();
  // One triangle in four is a needle or a sliver.
  if (r.bits() % 4 == 0) p[1] = p[0] + (p[1] - p[0]) * r.magnitude(-6, -1);
  if (r.bits() % 4 == 0) {
    const double along = r.sign(), aside = r.magnitude(-6, -1);
    p[2] = p[0] + (p[1] - p[0]) * along + (p[2] - p[0]) * aside;
  }
  for (int k = 0; k < 3; ++k) {
    const Vec3f v(p[k] * f.scale + f.offset);
    p[k] = Vec3d(v);
    for (int axis = 0; axis < 3; ++axis) cases.corner[k][axis][i] = v[axis];
  }
  double u = r.unit() * 1.2 - 0.1, v = r.unit() * 1.2 - 0.1;
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const int k = static_cast<int>(r.bits() % 3);
  const Vec3d e1 = p[1] - p[0], e2 = p[2] - p[0], n = cross(e1, e2);
  const double l = length(n);
  const double on_edge = r.unit(), along = r.sign(), aside = r.sign();
  return {p[0] + e1 * u + e2 * v, p[k], p[k] + (p[(k + 1) % 3] - p[k]) * on_edge,
          l > 0 ? n / l : Vec3d{0, 0, 1}, e1 * along + e2 * aside};
}

Targets make_sphere(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  const Vec3d c = r.vector() * f.scale + f.offset;
  const double radius = (0.05 + r.unit()) * f.scale;
  put(cases, i, {c.x, c.y, c.z, radius});
  const Vec3d n = normalize(r.vector());
  return {c + r.vector() * radius, c, c + n * radius, n, perpendicular(n, r) * radius};
}

Targets make_disk(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  const Vec3d c = r.vector() * f.scale + f.offset, n = normalize(r.vector());
  const double radius = (0.05 + r.unit()) * f.scale;
  const double hole = r.bits() % 2 == 0 ? 0 : radius * r.unit();
  put(cases, i, {c.x, c.y, c.z, n.x, n.y, n.z, radius, hole});
  const Vec3d rim = perpendicular(n, r) * (hole > 0 && r.bits() % 2 == 0 ? hole : radius);
  return {c + rim * (1.4 * r.unit()), c, c + rim, n, rim};
}

Targets make_plane(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  Vec3d n = normalize(r.vector());
  if (r.bits() % 4 == 0) n = {0, 1, 0};
  const Vec3d p = r.vector() * f.scale + f.offset;
  put(cases, i, {n.x, n.y, n.z, dot(n, p)});
  const Vec3d along = perpendicular(n, r) * f.scale;
  return {p + along, p, p - along, n, along};
}

Targets make_oriented_box(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  const Vec3d size = (abs(r.vector()) + Vec3d{0.02, 0.02, 0.02}) * f.scale;
  const Affine rotation = r.bits() % 4 == 0 ? Affine{} : Affine::rotation(r.vector() * 180.0);
  const Affine world =
      Affine::translation(r.vector() * f.scale + f.offset) * rotation * Affine::scaling(size);
  BoxSolid::Pool pool;
  BoxSolid::add(pool, {}, world, 0);
  for (int k = 0; k < 12; ++k) cases.shape[k][i] = pool.number[k][0];
  const auto side = [&] { return r.bits() & 1 ? 1.0 : -1.0; };
  const Vec3d corner{side(), side(), side()};
  Vec3d edge = corner, normal{0, 0, 0};
  const int k = static_cast<int>(r.bits() % 3);
  edge[k] = r.sign();
  normal[(k + 1) % 3] = corner[(k + 1) % 3];
  Vec3d tangent{0, 0, 0};
  tangent[k] = 1, tangent[(k + 2) % 3] = r.sign();
  return {world.point(r.vector() * 1.3), world.point(corner), world.point(edge),
          normalize(world.vector(normal)), world.vector(tangent)};
}

Targets make_slab(CaseRandom& r, const Frame& f, KernelCases& cases, std::size_t i) {
  const Vec3f a(r.vector() * f.scale + f.offset);
  const Vec3d size = r.vector() * f.scale;
  Vec3f b = a + Vec3f(size * (r.bits() % 4 == 0 ? r.magnitude(-6, 0) : 1));
  // Some boxes are flat, as those of axis-aligned triangles are.
  if (r.bits() % 8 == 0) b.y = a.y;
  const Vec3f lo = min(a, b), hi = max(a, b);
  for (int k = 0; k < 3; ++k) {
    cases.corner[0][k][i] = lo[k], cases.corner[1][k][i] = hi[k];
    cases.corner[2][k][i] = 0;
  }
  Vec3d corner, about;
  for (int k = 0; k < 3; ++k) {
    corner[k] = r.bits() & 1 ? lo[k] : hi[k];
    about[k] = lo[k] + (1.4 * r.unit() - 0.2) * (double(hi[k]) - lo[k]);
  }
  const int k = static_cast<int>(r.bits() % 3);
  Vec3d edge = corner, normal{0, 0, 0}, tangent{0, 0, 0};
  edge[k] = lo[k] + r.unit() * (double(hi[k]) - lo[k]);
  normal[(k + 1) % 3] = r.bits() & 1 ? 1 : -1;
  tangent[k] = f.scale, tangent[(k + 2) % 3] = f.scale * r.sign();
  return {about, corner, edge, normal, tangent};
}

/// In the order of KernelId.
constexpr Targets (*kMakers[kKernels])(CaseRandom&, const Frame&, KernelCases&, std::size_t) = {
    make_triangle, make_triangle, make_triangle, make_triangle,     make_sphere, make_sphere,
    make_sphere,   make_plane,    make_disk,     make_oriented_box, make_slab};

Ray make_ray(CaseClass c, CaseRandom& r, const Frame& f, const Targets& at) {
  const int aim = static_cast<int>(r.bits() % 3);
  Vec3d target = c == CaseClass::vertex ? at.vertex : c == CaseClass::edge ? at.edge : at.about;
  if (c >= CaseClass::far) target = aim == 0 ? at.about : aim == 1 ? at.vertex : at.edge;
  Ray ray;
  ray.origin = Vec3f(r.vector() * (3 * f.scale) + f.offset);
  if (c == CaseClass::axis) {
    const int k = static_cast<int>(r.bits() % 3);
    const float side = r.bits() & 1 ? 1.0f : -1.0f;
    if (aim == 1) target = at.vertex;
    if (aim == 2) target = at.edge;
    ray.origin = Vec3f(target);
    ray.origin[k] -= side * static_cast<float>(3 * f.scale * r.unit());
    // The other components are zeros of either sign.
    ray.direction = r.bits() & 1 ? Vec3f{0, 0, 0} : Vec3f{-0.0f, -0.0f, -0.0f};
    ray.direction[k] = side;
  } else {
    if (c == CaseClass::grazing) {
      const double side = r.sign();
      target = at.edge + at.normal * (f.scale * side * r.magnitude(-9, -2));
      ray.origin = Vec3f(target - at.tangent * (1 + 2 * r.unit()));
      if (r.bits() & 1) target = at.about;
    }
    ray.direction = Vec3f(target) - ray.origin;
    const float length = max_component(abs(ray.direction));
    if (r.bits() & 1 && length > 0) ray.direction = ray.direction / length;
  }
  const double reach = f.scale / std::max(1e-30, double(max_component(abs(ray.direction))));
  if (r.bits() % 8 == 0) ray.tmin = static_cast<float>(3 * reach * r.unit());
  if (r.bits() % 8 == 0) ray.tmax = static_cast<float>(4 * reach * r.unit());
  return ray;
}

}  // namespace

void KernelCases::fill(KernelId id, CaseClass c, std::uint64_t first, std::size_t count) {
  rays.resize_uninitialized(count);
  for (auto& vertex : corner)
    for (Column<float>& column : vertex) column.resize_uninitialized(count);
  for (Column<double>& column : shape) column.resize_uninitialized(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t stream = static_cast<std::uint64_t>(c) * 64 + static_cast<std::uint64_t>(id);
    CaseRandom r(pixel_key(static_cast<std::uint32_t>(stream), first + i));
    Frame f{1, {0, 0, 0}};
    if (c == CaseClass::far) f.offset = {148376, 1234, -223423};
    if (c == CaseClass::huge) f.scale = r.magnitude(15, 30);
    if (c == CaseClass::tiny) f.scale = r.magnitude(-25, -15);
    const Targets targets = kMakers[static_cast<int>(id)](r, f, *this, i);
    rays.set(i, make_ray(c, r, f, targets));
  }
}

KernelProbe KernelCases::run(std::size_t begin, std::size_t count) const {
  KernelProbe r;
  r.count = count;
  r.rays = rays.span().part(begin, count);
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) r.corner[k][axis] = corner[k][axis].data() + begin;
  for (int k = 0; k < 12; ++k) r.shape[k] = shape[k].data() + begin;
  return r;
}

}  // namespace oktett
