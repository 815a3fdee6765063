#include <algorithm>

#include "accel/hit_place.h"
#include "accel/isa/table.h"
#include "accel/mesh_surfaces.h"

namespace oktett {
namespace {

void set_column(float (&column)[3][MeshSurfaces::kMost], std::size_t i, const Vec3f& v) {
  for (int k = 0; k < 3; ++k) column[k][i] = v[k];
}

Vec3f get_column(const float (&column)[3][MeshSurfaces::kMost], std::size_t i) {
  return {column[0][i], column[1][i], column[2][i]};
}

/// Puts a hit of triangle `triangle` into place `i` of the columns.
void gather(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v, MeshSurfaces& s,
            std::size_t i) {
  const std::uint32_t* index = &mesh.indices[3 * std::size_t{triangle}];
  for (int k = 0; k < 3; ++k) set_column(s.corner[k], i, mesh.positions[index[k]]);
  s.u[i] = u, s.v[i] = v;
  if (!s.smooth) return;
  index = &mesh.normal_indices[3 * std::size_t{triangle}];
  const bool known = index[0] != kNoId && index[1] != kNoId && index[2] != kNoId;
  for (int k = 0; k < 3; ++k) set_column(s.normal[k], i, known ? mesh.normals[index[k]] : Vec3f{});
}

/// Hits of one mesh that wait for their surfaces.
class MeshRun {
 public:
  MeshRun(const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which, Isa isa, Surface* out)
      : rays_(rays), hits_(hits), which_(which), table_(*isa_table(isa)), out_(out) {}

  /// Takes entry `i`, a hit of the mesh `named`; its names stand in the result already.
  void add(const HitPlace& place, const NamedHit& named, std::size_t i) {
    if (columns_.count == MeshSurfaces::kMost || geometry_ != named.geometry) begin(place, named);
    const Hit hit = hits_[which_[i]];
    gather(*std::get<MeshGeometry>(named.geometry->shape).mesh, named.surface.primitive, hit.u, hit.v,
           columns_, columns_.count);
    entry_[columns_.count++] = i;
  }

  /// Must be called before `place` changes, and in the end.
  void finish(const HitPlace& place) {
    if (columns_.count == 0) return;
    repeat_last();
    table_.mesh_surfaces(columns_);
    for (std::size_t k = 0; k < columns_.count; ++k) {
      Surface& s = out_[entry_[k]];
      s.position = get_column(columns_.position, k);
      s.position_error = get_column(columns_.position_error, k);
      s.geometric_normal = get_column(columns_.geometric_normal, k);
      s.shading_normal = get_column(columns_.shading_normal, k);
      const std::uint32_t ray = which_[entry_[k]];
      if (place.moved) move_surface(place, rays_[ray], hits_.t[ray], s);
    }
    columns_.count = 0;
    geometry_ = nullptr;
  }

 private:
  void begin(const HitPlace& place, const NamedHit& named) {
    finish(place);
    geometry_ = named.geometry;
    const auto& shape = std::get<MeshGeometry>(geometry_->shape);
    const GeometryFrame& frame = place.accel->frames[named.surface.geometry];
    columns_.smooth = shape.smooth && !shape.mesh->normal_indices.empty();
    columns_.to_world = frame.identity ? nullptr : &geometry_->transform;
    columns_.inverse = frame.identity ? nullptr : &frame.inverse;
    columns_.mirrored = frame.mirrored;
  }

  /// Fills the last group of lanes.
  void repeat_last() {
    const std::size_t last = columns_.count - 1, end = (columns_.count + 7) / 8 * 8;
    for (std::size_t i = last + 1; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        set_column(columns_.corner[k], i, get_column(columns_.corner[k], last));
        if (columns_.smooth) set_column(columns_.normal[k], i, get_column(columns_.normal[k], last));
      }
      columns_.u[i] = columns_.u[last], columns_.v[i] = columns_.v[last];
    }
  }

  const RaySpan& rays_;
  const HitSpan& hits_;
  const std::uint32_t* which_;
  const IsaTable& table_;
  Surface* out_;
  const Geometry* geometry_ = nullptr;
  std::size_t entry_[MeshSurfaces::kMost];
  MeshSurfaces columns_;
};

}  // namespace

void surfaces(const Accel& accel, const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which,
              std::size_t count, Isa isa, Surface* out) {
  MeshRun run(rays, hits, which, isa, out);
  HitPlace place;
  std::uint32_t path = kNoId;
  for (std::size_t i = 0; i < count; ++i) {
    const Hit hit = hits[which[i]];
    if (place.accel == nullptr || hit.instance != path) {
      run.finish(place);
      place = follow_path(accel, hit.instance);
      path = hit.instance;
    }
    const NamedHit named = identify_in(place, hit);
    if (std::holds_alternative<MeshGeometry>(named.geometry->shape)) {
      out[i] = named.surface;
      run.add(place, named, i);
    } else {
      surface_at(place, named, rays[which[i]], hit, false, out[i]);
    }
  }
  run.finish(place);
}

}  // namespace oktett
