#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "accel/accel_data.h"
#include "accel/code.h"
#include "accel/csg/csg.h"
#include "accel/hit_place.h"
#include "accel/surface/offset_origin.h"
#include "accel/surface/surface_lanes.h"
#include "core/error.h"
#include "core/lanes.h"
#include "kernels/exact_ops.h"

namespace oktett {

// ---- Single hits

namespace {

/// uv, dp/du and dp/dv of a mesh hit.
void mesh_uv(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v, const Vec3f (&p)[3],
             SurfaceInteraction& s) {
  const std::array<Vec2f, 3> uv = corner_uvs(mesh, triangle);
  s.uv = weighted_uv(uv, u, v);
  set_uv_tangents(uv, p, s.tangent, s.bitangent);
}

void mesh_interaction(const Geometry& g, const GeometryFrame& g_frame, std::uint32_t triangle, const Hit& hit,
                      SurfaceInteraction& s) {
  using F = Simd<float, 1, ScalarIsa>;
  const TriangleMesh& mesh = *std::get<MeshGeometry>(g.shape).mesh;
  const MeshFrame frame = mesh_frame(g, g_frame);
  Vec3f corners[3], normals[3];
  if (frame.smooth) corner_normals(mesh, triangle, normals);
  Vec3<F> p[3], n[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = place_corner(frame, broadcast<F>(corner_position(mesh, triangle, k)));
    corners[k] = only_lane(p[k]), n[k] = broadcast<F>(normals[k]);
  }
  const MeshSurface<F> surface = mesh_surface(frame, p, n, F(hit.u), F(hit.v));
  s.position = only_lane(surface.position);
  s.position_error = only_lane(surface.position_error);
  s.geometric_normal = only_lane(surface.geometric_normal);
  s.shading_normal = only_lane(surface.shading_normal);
  mesh_uv(mesh, triangle, hit.u, hit.v, corners, s);
}

}  // namespace

void set_uv_tangents(const std::array<Vec2f, 3>& uv, const Vec3f (&p)[3], Vec3f& by_u, Vec3f& by_v) {
  const float du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y, du2 = uv[2].x - uv[0].x,
              dv2 = uv[2].y - uv[0].y;
  const float det = du1 * dv2 - du2 * dv1;
  if (det == 0) return;
  by_u = ((p[1] - p[0]) * dv2 - (p[2] - p[0]) * dv1) / det;
  by_v = ((p[2] - p[0]) * du1 - (p[1] - p[0]) * du2) / det;
}

MeshPoint mesh_point(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const HitNames names = identify_in(place, hit);
  if (names.kind != Kind::triangle) return {};
  const TriangleMesh* mesh = std::get<MeshGeometry>(place.accel->geometries[names.geometry].shape).mesh;
  return {mesh, names.primitive, hit.u, hit.v};
}

SurfaceInteraction identify(const Accel& accel, const Hit& hit) {
  const HitNames names = identify_in(follow_path(accel, hit.instance), hit);
  SurfaceInteraction s;
  s.geometry = names.geometry, s.primitive = names.primitive;
  s.user = names.user, s.material_slot = names.material_slot;
  return s;
}

Affine object_transform(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const std::uint32_t geometry = identify_in(place, hit).geometry;
  const Affine& transform = place.accel->geometries[geometry].transform;
  return place.moved ? place.to_world * transform : transform;
}

/// The surface in the space of the structure that holds the item; `uv` says whether uv and tangents are
/// wanted.
static void interaction_inside(const HitNames& names, const Accel& a, const Ray& inner, const Hit& hit,
                               bool uv, SurfaceInteraction& s) {
  const Geometry& g = a.geometries[names.geometry];
  if (names.kind == Kind::triangle) {
    mesh_interaction(g, a.frames[names.geometry], names.primitive, hit, s);
  } else if (is_exact(names.kind)) {
    const ExactOps& ops = exact_ops(names.kind);
    const std::size_t i = a.index_in_pool(names.geometry, 0);
    (uv ? ops.interaction : ops.interaction_without_uv)(a.exact_pool(names.kind), i, inner, hit, s);
  } else {
    const std::size_t i = a.index_in_pool(names.geometry, names.primitive);
    visit_pool(names.kind, a.pools, [&](auto shape, const auto& pool) {
      closed_interaction<decltype(shape)>(pool, i, inner, hit.t, uv, s);
    });
  }
  s.geometry = names.geometry, s.primitive = names.primitive, s.user = names.user;
  s.material_slot = names.material_slot;
}

/// Brings a surface interaction from the space of the structure that holds the item to the world.
static void move_by_instances(const HitPlace& place, const Ray& ray, float t, SurfaceInteraction& s) {
  const Affine& m = place.to_world;
  const Affine& inverse = place.inverse;
  const Vec3d p = m.point(Vec3d(s.position));
  Vec3f error;
  for (int k = 0; k < 3; ++k) {
    double e = 0x1p-22 * std::abs(p[k]) + 0x1p-22 * std::abs(double(t) * ray.direction[k]);
    for (int j = 0; j < 3; ++j) {
      e += std::abs(m.m[k][j]) * s.position_error[j];
      // The ray's origin and direction were rounded to float inside the instance.
      e += std::abs(m.m[k][j]) * 0x1p-22 * std::abs(s.position[j]);
    }
    error[k] = round_up(e);
  }
  s.position = Vec3f(p);
  s.position_error = error;
  s.geometric_normal = Vec3f(normalize(inverse.normal_by_inverse(Vec3d(s.geometric_normal))));
  s.shading_normal = Vec3f(normalize(inverse.normal_by_inverse(Vec3d(s.shading_normal))));
  s.tangent = Vec3f(m.vector(Vec3d(s.tangent)));
  s.bitangent = Vec3f(m.vector(Vec3d(s.bitangent)));
}

/// Brings a surface interaction found inside instances and combinations to the world.
static void move_interaction(const HitPlace& place, const Ray& ray, float t, SurfaceInteraction& s) {
  if (place.moved) move_by_instances(place, ray, t, s);
  if (place.combined == nullptr) return;
  const float reach = coincidence(t, coincidence_slack(*place.combined, moved_ray(place.to_combined, ray)));
  for (int k = 0; k < 3; ++k)
    s.position_error[k] = widened_error(s.position_error[k], reach, ray.direction[k]);
  if (place.flipped) s.geometric_normal = -s.geometric_normal, s.shading_normal = -s.shading_normal;
}

void interaction_at(const HitPlace& place, const HitNames& names, const Ray& ray, const Hit& hit, bool uv,
                    SurfaceInteraction& s) {
  if (!place.changes()) return interaction_inside(names, *place.accel, ray, hit, uv, s);
  interaction_inside(names, *place.accel, place.moved ? ray_inside(place, ray) : ray, hit, uv, s);
  move_interaction(place, ray, hit.t, s);
}

SurfaceInteraction surface_interaction(const Accel& accel, const Ray& ray, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  SurfaceInteraction s;
  interaction_at(place, identify_in(place, hit), ray, hit, true, s);
  return s;
}

std::optional<std::array<Vec3f, 3>> triangle_corners(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const HitNames names = identify_in(place, hit);
  if (names.kind != Kind::triangle) return std::nullopt;
  const Geometry& g = place.accel->geometries[names.geometry];
  std::array<Vec3f, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = Vec3f(place.to_world.point(g.transform.point(
        Vec3d(corner_position(*std::get<MeshGeometry>(g.shape).mesh, names.primitive, k)))));
  return corners;
}

std::optional<SmoothTriangle> smooth_triangle(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const HitNames names = identify_in(place, hit);
  if (names.kind != Kind::triangle) return std::nullopt;
  const Geometry& g = place.accel->geometries[names.geometry];
  if (!mesh_frame(g, place.accel->frames[names.geometry]).smooth) return std::nullopt;
  const TriangleMesh& mesh = *std::get<MeshGeometry>(g.shape).mesh;
  const Affine to_world = place.moved ? place.to_world * g.transform : g.transform;
  const Affine inverse = to_world.inverse();
  Vec3f normals[3];
  corner_normals(mesh, names.primitive, normals);
  SmoothTriangle triangle;
  for (int k = 0; k < 3; ++k) {
    const Vec3d n = inverse.normal_by_inverse(Vec3d(normals[k]));
    if (!(length(n) > 0)) return std::nullopt;
    triangle.corner[k] = to_world.point(Vec3d(corner_position(mesh, names.primitive, k)));
    triangle.normal[k] = normalize(n);
  }
  return triangle;
}

Vec3f offset_origin(const SurfaceInteraction& s, const Vec3f& direction) {
  Vec3f origin;
  offset_origin(s, direction, origin);
  return origin;
}

// ---- Blocks of hits

namespace {

/// Calls what(k) for each bit k of `entries`, lowest first.
template <class What>
OKTETT_INLINE void for_each_entry(std::uint64_t entries, const What& what) {
  for (; entries != 0; entries &= entries - 1) what(static_cast<std::size_t>(std::countr_zero(entries)));
}

/// Hits of one closed-form kind, of one element of an exact kind, or of one mesh.
struct HitGroup {
  const Accel* accel;
  Kind kind;
  std::uint32_t part;     ///< element of an exact kind, geometry of a mesh, else 0
  std::uint64_t entries;  ///< bit k: entry k of the block
};

/// The groups in the order in which their first hits came.
class HitGroups {
 public:
  HitGroups() { clear(); }
  void clear() {
    count_ = 0;
    std::memset(slots_, 0xff, sizeof(slots_));
  }
  const HitGroup* begin() const { return groups_; }
  const HitGroup* end() const { return groups_ + count_; }

  void add(const Accel& accel, Kind kind, std::uint32_t part, std::uint64_t entries) {
    find(accel, kind, part).entries |= entries;
  }

 private:
  static constexpr std::size_t kMost = InteractionBlock::kMost;
  static_assert(kMost == 64, "an entry is a bit of HitGroup::entries");
  static constexpr std::uint16_t kNone = 0xffff;
  static constexpr std::size_t kSlots = 2 * kMost;

  /// The group of these hits. If it is new, it has no entries.
  HitGroup& find(const Accel& accel, Kind kind, std::uint32_t part) {
    const auto is = [&](const HitGroup& g) { return g.accel == &accel && g.kind == kind && g.part == part; };
    if (count_ > 0 && is(groups_[latest_])) return groups_[latest_];
    const auto name = reinterpret_cast<std::uintptr_t>(&accel) / alignof(Accel) +
                      31 * static_cast<std::uintptr_t>(kind) + std::uintptr_t{part};
    for (std::size_t slot = (name * 0x9e3779b97f4a7c15u) >> 32;; ++slot) {
      std::uint16_t& group = slots_[slot % kSlots];
      if (group == kNone) {
        group = static_cast<std::uint16_t>(count_);
        groups_[count_++] = {&accel, kind, part, 0};
      } else if (!is(groups_[group])) {
        continue;
      }
      latest_ = group;
      return groups_[group];
    }
  }

  std::size_t count_ = 0, latest_ = 0;
  HitGroup groups_[kMost];
  std::uint16_t slots_[kSlots];
};

constexpr std::size_t kMost = InteractionBlock::kMost;

template <class T>
void repeat_last(T (&column)[kMost], std::size_t count) {
  for (std::size_t k = count; k % 8 != 0; ++k) column[k] = column[count - 1];
}

void set_column(float (&column)[3][kMost], std::size_t i, const Vec3f& v) {
  for (int k = 0; k < 3; ++k) column[k][i] = v[k];
}

/// Finds the surfaces of hits, group by group.
class SurfaceFinder {
 public:
  SurfaceFinder(const Accel& accel, const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which,
                const InteractionCode& code, bool with_uv, InteractionBlock& out)
      : accel_(accel), rays_(rays), hits_(hits), which_(which), code_(code), with_uv_(with_uv), out_(out) {
    out.has_uv = with_uv;
  }

  void find(std::size_t count) {
    if (count > 0 && all_outside(count))
      add_outside(count);
    else
      for (std::size_t i = 0; i < count; ++i) add(i);
    find_surfaces(standing_, false);
    find_surfaces(moved_, true);
    for (std::size_t k = 0; k < combinations_; ++k) widen(combined_[k]);
  }

 private:
  /// An entry that is seen in a combination outside instances.
  struct Combined {
    const Accel* solids;
    std::uint16_t entry;
    bool flipped;
  };

  /// Whether all hits are outside instances and combinations.
  bool all_outside(std::size_t count) const {
    std::uint32_t path = kNoId;
    for (std::size_t i = 0; i < count; ++i) path &= hits_.instance[which_[i]];
    return path == kNoId;
  }

  /// Names hits outside instances and combinations, geometry by geometry.
  void add_outside(std::size_t count) {
    std::uint32_t items[kMost];
    for (std::size_t i = 0; i < count; ++i) items[i] = hits_.item[which_[i]];
    for (std::size_t i = count; i % kItemGroup != 0; ++i) items[i] = kNoId;
    for (std::uint64_t left = ~std::uint64_t{0} >> (kMost - count); left != 0;) {
      const std::uint32_t geometry = accel_.geometry_of(items[std::countr_zero(left)]);
      const std::uint32_t first = accel_.first_item[geometry];
      const std::uint64_t entries = code_.name_hits(
          items, count, {geometry, accel_.users[geometry], first, accel_.first_item[geometry + 1] - first},
          out_);
      add_named(accel_, static_cast<Kind>(accel_.kinds[geometry]), geometry, entries, standing_);
      left &= ~entries;
    }
  }

  /// Adds hits of one geometry of `accel`, whose names are known but for the slots of their materials.
  void add_named(const Accel& accel, Kind kind, std::uint32_t geometry, std::uint64_t entries,
                 HitGroups& groups) {
    if (kind == Kind::triangle) {
      const auto& slots = std::get<MeshGeometry>(accel.geometries[geometry].shape).mesh->material_slots;
      if (!slots.empty())
        for_each_entry(entries, [&](std::size_t i) { out_.material_slot[i] = slots[out_.primitive[i]]; });
      groups.add(accel, kind, geometry, entries);
    } else if (is_exact(kind)) {
      for_each_entry(
          entries, [&](std::size_t i) { groups.add(accel, kind, element(accel, i), std::uint64_t{1} << i); });
    } else {
      groups.add(accel, kind, 0, entries);
    }
  }

  /// Index in its pool of the shape at an entry, which is not a triangle.
  std::uint32_t element(const Accel& accel, std::size_t entry) const {
    return accel.index_in_pool(out_.geometry[entry], out_.primitive[entry]);
  }

  void add(std::size_t i) {
    const std::uint32_t ray = which_[i];
    const Hit hit = hits_[ray];
    if (place_.accel == nullptr || hit.instance != path_) {
      // The groups inside an instance share its map.
      if (place_.moved) find_surfaces(moved_, true);
      // The usual place is not copied, because its maps are large.
      if (hit.instance == kNoId && !place_.changes())
        place_.accel = &accel_;
      else
        place_ = follow_path(accel_, hit.instance);
      path_ = hit.instance;
    }
    const HitNames names = identify_in(place_, hit);
    out_.geometry[i] = names.geometry, out_.primitive[i] = names.primitive;
    out_.user[i] = names.user, out_.material_slot[i] = names.material_slot;
    add_named(*place_.accel, names.kind, names.geometry, std::uint64_t{1} << i,
              place_.moved ? moved_ : standing_);
    if (!place_.moved) {
      if (place_.combined != nullptr)
        combined_[combinations_++] = {place_.combined, static_cast<std::uint16_t>(i), place_.flipped};
      return;
    }
    if (names.kind == Kind::triangle) return;
    const Ray inner = ray_inside(place_, rays_[ray]);
    set_column(inner_origin_, i, inner.origin), set_column(inner_direction_, i, inner.direction);
    inner_t_[i] = hit.t, inner_part_[i] = hit.u;
  }

  void find_surfaces(HitGroups& groups, bool moved) {
    for (const HitGroup& group : groups) {
      if (group.kind == Kind::triangle)
        find_mesh(group);
      else
        find_shape(group, moved);
      if (moved) for_each_entry(group.entries, [&](std::size_t i) { move(i); });
    }
    groups.clear();
  }

  void find_mesh(const HitGroup& group) {
    const Geometry& geometry = group.accel->geometries[group.part];
    const TriangleMesh& mesh = *std::get<MeshGeometry>(geometry.shape).mesh;
    mesh_.frame = mesh_frame(geometry, group.accel->frames[group.part]);
    mesh_.count = 0, mesh_.out = &out_;
    std::size_t last = 0;
    const auto gather = [&](std::size_t i, std::size_t to) {
      const std::uint32_t triangle = out_.primitive[i], hit = which_[i];
      for (int k = 0; k < 3; ++k) set_column(mesh_.corner[k], to, corner_position(mesh, triangle, k));
      mesh_.u[to] = hits_.u[hit], mesh_.v[to] = hits_.v[hit];
      mesh_.entry[to] = static_cast<std::uint32_t>(i);
      if (with_uv_) out_.set_uv(i, weighted_uv(corner_uvs(mesh, triangle), hits_.u[hit], hits_.v[hit]));
      if (!mesh_.frame.smooth) return;
      Vec3f normals[3];
      corner_normals(mesh, triangle, normals);
      for (int k = 0; k < 3; ++k) set_column(mesh_.normal[k], to, normals[k]);
    };
    for_each_entry(group.entries, [&](std::size_t i) { gather(last = i, mesh_.count++); });
    for (std::size_t to = mesh_.count; to % 8 != 0; ++to) gather(last, to);
    code_.mesh(mesh_);
  }

  void find_shape(const HitGroup& group, bool moved) {
    ShapeHits& s = shapes_;
    for (int k = 0; k < 3; ++k) {
      s.origin[k] = moved ? inner_origin_[k] : rays_.origin[k];
      s.direction[k] = moved ? inner_direction_[k] : rays_.direction[k];
    }
    s.t = moved ? inner_t_ : hits_.t, s.part = moved ? inner_part_ : hits_.u;
    s.count = 0, s.out = &out_, s.with_uv = with_uv_;
    for_each_entry(group.entries, [&](std::size_t i) {
      const auto entry = static_cast<std::uint32_t>(i);
      s.ray[s.count] = moved ? entry : which_[i];
      s.element[s.count] = element(*group.accel, i), s.entry[s.count++] = entry;
    });
    repeat_last(s.ray, s.count), repeat_last(s.element, s.count), repeat_last(s.entry, s.count);
    if (is_exact(group.kind)) return find_exact(group.kind, group.accel->exact_pool(group.kind));
    code_.closed_form(*group.accel, group.kind, s);
    if (with_uv_)
      visit_pool(group.kind, group.accel->pools,
                 [&](auto shape, const auto& pool) { closed_uvs<decltype(shape)>(pool); });
  }

  /// uv of `shapes_`, closed forms whose points on the surface are known.
  template <class S>
  void closed_uvs(const typename S::Pool& pool) {
    if constexpr (!kHasUvLanes<S>) {
      using D = Simd<double, 1, ScalarIsa>;
      for (std::size_t k = 0; k < shapes_.count; ++k) {
        const Vec3d hit = only_lane(HitPoints<D>(shape_ray(k), shapes_.t[shapes_.ray[k]]).point());
        SurfaceInteraction s;
        s.position = InteractionBlock::get(out_.position, shapes_.entry[k]);
        S::uv(pool, shapes_.element[k], hit, shape_point(k), s);
        out_.set_uv(shapes_.entry[k], s.uv);
      }
    }
  }

  /// Hits of one element of an exact surface, `shapes_`.
  void find_exact(Kind kind, const ExactPoolBase& pool) {
    const ExactOps& ops = exact_ops(kind);
    if (code_.exact(kind, pool, shapes_)) {
      if (with_uv_) exact_uvs(ops, pool);
      return;
    }
    for (std::size_t k = 0; k < shapes_.count; ++k) {
      const std::uint32_t entry = shapes_.entry[k];
      SurfaceInteraction surface;
      (with_uv_ ? ops.interaction : ops.interaction_without_uv)(pool, shapes_.element[k], shape_ray(k),
                                                                hits_[which_[entry]], surface);
      out_.set_shape(entry, surface), out_.set_uv(entry, surface.uv);
    }
  }

  /// uv of `shapes_`, whose points on an exact surface are known.
  void exact_uvs(const ExactOps& ops, const ExactPoolBase& pool) {
    for (std::size_t k = 0; k < shapes_.count; ++k) {
      const std::uint32_t entry = shapes_.entry[k];
      const auto part = static_cast<int>(hits_.u[which_[entry]]);
      out_.set_uv(entry,
                  ops.uv == nullptr ? Vec2f{} : ops.uv(pool, shapes_.element[k], part, shape_point(k)));
    }
  }

  /// The ray of hit `k` of `shapes_`, and its point on the surface.
  Ray shape_ray(std::size_t k) const {
    const std::uint32_t i = shapes_.ray[k];
    const auto at = [i](const float* const(&column)[3]) {
      return Vec3f{column[0][i], column[1][i], column[2][i]};
    };
    return {at(shapes_.origin), 0, at(shapes_.direction)};
  }
  Vec3d shape_point(std::size_t k) const {
    return {shapes_.point[0][k], shapes_.point[1][k], shapes_.point[2][k]};
  }

  /// Brings entry `i` from inside an instance to the world.
  void move(std::size_t i) {
    SurfaceInteraction s = out_[i];
    move_interaction(place_, rays_[which_[i]], hits_.t[which_[i]], s);
    out_.set_shape(i, s);
  }

  void widen(const Combined& c) {
    const std::uint32_t i = which_[c.entry];
    const float reach = coincidence(hits_.t[i], coincidence_slack(*c.solids, rays_[i]));
    for (int axis = 0; axis < 3; ++axis) {
      float& error = out_.position_error[axis][c.entry];
      error = widened_error(error, reach, rays_.direction[axis][i]);
      if (!c.flipped) continue;
      float &n = out_.geometric_normal[axis][c.entry], &shading = out_.shading_normal[axis][c.entry];
      n = -n, shading = -shading;
    }
  }

  const Accel& accel_;
  const RaySpan& rays_;
  const HitSpan& hits_;
  const std::uint32_t* which_;
  const InteractionCode& code_;
  const bool with_uv_;
  InteractionBlock& out_;

  HitPlace place_;  ///< of the latest hit
  std::uint32_t path_ = kNoId;
  HitGroups standing_, moved_;  ///< hits outside instances, and hits in the instance `place_`
  std::size_t combinations_ = 0;
  Combined combined_[kMost];
  float inner_origin_[3][kMost], inner_direction_[3][kMost], inner_t_[kMost], inner_part_[kMost];
  union {
    ShapeHits shapes_;
    MeshHits mesh_;
  };
};

}  // namespace

void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          std::span<const std::uint32_t> which, InteractionBlock& out, Isa isa) {
  surface_interactions(accel, rays, hits, which, out, isa, false);
}

void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          std::span<const std::uint32_t> which, InteractionBlock& out, Isa isa,
                          bool with_uv) {
  if (which.size() > kMost)
    throw Error("surface_interactions: " + std::to_string(which.size()) + " hits, but room for " +
                std::to_string(kMost));
  SurfaceFinder(accel, rays, hits, which.data(), interaction_code(isa), with_uv, out).find(which.size());
}

}  // namespace oktett
