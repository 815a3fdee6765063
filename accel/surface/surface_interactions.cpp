#include <algorithm>
#include <span>
#include <string>

#include "accel/csg/csg.h"
#include "accel/hit_place.h"
#include "accel/shape_hits.h"
#include "accel/surface/interaction_code.h"
#include "accel/surface/mesh_hits.h"
#include "core/error.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

void set_column(float (&column)[3][MeshHits::kMost], std::size_t i, const Vec3f& v) {
  for (int k = 0; k < 3; ++k) column[k][i] = v[k];
}

/// Collects consecutive hits of one mesh and finds their surfaces together.
class MeshRun {
 public:
  MeshRun(const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which, const InteractionCode& code,
          InteractionBlock& out)
      : rays_(rays), hits_(hits), which_(which), code_(code), out_(out) {}

  /// Takes entry `i`, a hit of the mesh `names`.
  void add(const HitPlace& place, const HitNames& names, std::size_t i) {
    const Geometry& geometry = place.accel->geometries[names.geometry];
    if (columns_.count == MeshHits::kMost || geometry_ != &geometry) begin(place, geometry, names);
    triangle_ = names.primitive, hit_ = which_[i];
    gather(columns_.count);
    entry_[columns_.count++] = i;
  }

  /// Must be called before `place` changes, and in the end.
  void finish(const HitPlace& place) {
    if (columns_.count == 0) return;
    // Repeats the last hit to the end of its group of lanes.
    for (std::size_t to = columns_.count; to % 8 != 0; ++to) gather(to);
    code_.mesh(columns_);
    for (std::size_t k = 0; k < columns_.count; ++k) {
      const std::size_t i = entry_[k];
      for (int axis = 0; axis < 3; ++axis) {
        out_.position[axis][i] = columns_.position[axis][k];
        out_.position_error[axis][i] = columns_.position_error[axis][k];
        out_.geometric_normal[axis][i] = columns_.geometric_normal[axis][k];
        out_.shading_normal[axis][i] = columns_.shading_normal[axis][k];
      }
      if (!place.changes()) continue;
      SurfaceInteraction s = out_[i];
      move_interaction(place, rays_[which_[i]], hits_.t[which_[i]], s);
      out_.set_shape(i, s);
    }
    columns_.count = 0;
    geometry_ = nullptr;
  }

 private:
  void begin(const HitPlace& place, const Geometry& geometry, const HitNames& names) {
    finish(place);
    geometry_ = &geometry;
    columns_.frame = mesh_frame(geometry, place.accel->frames[names.geometry]);
  }

  /// Puts the latest hit into entry `to` of the columns.
  void gather(std::size_t to) {
    const TriangleMesh& mesh = *std::get<MeshGeometry>(geometry_->shape).mesh;
    for (int k = 0; k < 3; ++k) set_column(columns_.corner[k], to, corner_position(mesh, triangle_, k));
    columns_.u[to] = hits_.u[hit_], columns_.v[to] = hits_.v[hit_];
    if (!columns_.frame.smooth) return;
    Vec3f normals[3];
    corner_normals(mesh, triangle_, normals);
    for (int k = 0; k < 3; ++k) set_column(columns_.normal[k], to, normals[k]);
  }

  const RaySpan& rays_;
  const HitSpan& hits_;
  const std::uint32_t* which_;
  const InteractionCode& code_;
  InteractionBlock& out_;
  const Geometry* geometry_ = nullptr;
  std::uint32_t triangle_ = 0, hit_ = 0;  ///< of the latest hit
  std::size_t entry_[MeshHits::kMost];
  MeshHits columns_;
};

/// Collects hits of closed-form and exact shapes outside instances, also in combinations there, and finds the
/// surfaces of each group together: those of one closed-form kind or of one element of an exact kind.
class ShapeGroups {
 public:
  ShapeGroups(const RaySpan& rays, const HitSpan& hits, const std::uint32_t* which,
              const InteractionCode& code, InteractionBlock& out)
      : rays_(rays), hits_(hits), which_(which), code_(code), out_(out) {}

  /// Takes entry `i`, which is not a hit of a mesh.
  void add(const HitPlace& place, const HitNames& names, std::size_t i) {
    const Accel& accel = *place.accel;
    const std::uint32_t element = accel.pool_index[accel.first_pool_index[names.geometry] + names.primitive];
    const std::uint32_t group = is_exact(names.kind) ? element : 0;
    entry_[count_] = static_cast<std::uint32_t>(i), element_[count_] = element;
    accel_[count_] = &accel;
    group_[count_++] = std::uint64_t{group} << 8 | static_cast<std::uint64_t>(names.kind);
    if (place.combined != nullptr) combined_[combinations_++] = {place.combined, i, place.flipped};
  }

  void finish() {
    for (std::size_t first = 0; first < count_; ++first) {
      const std::uint64_t group = group_[first];
      if (group == kDone) continue;
      const Accel* accel = accel_[first];
      std::uint32_t members[InteractionBlock::kMost];
      columns_.count = 0;
      std::size_t last = first;
      for (std::size_t k = first; k < count_; ++k) {
        if (group_[k] != group || accel_[k] != accel) continue;
        group_[k] = kDone;
        members[columns_.count] = entry_[k];
        gather(k, columns_.count++);
        last = k;
      }
      // Repeats the last hit to the end of its group of lanes.
      for (std::size_t to = columns_.count; to % 8 != 0; ++to) gather(last, to);
      find(*accel, static_cast<Kind>(group & 0xff), members);
    }
    for (std::size_t k = 0; k < combinations_; ++k) {
      const Combined& c = combined_[k];
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
  }

 private:
  static constexpr std::uint64_t kDone = ~std::uint64_t{0};

  void gather(std::size_t k, std::size_t to) {
    const std::uint32_t i = which_[entry_[k]];
    for (int axis = 0; axis < 3; ++axis)
      columns_.origin[axis][to] = rays_.origin[axis][i],
      columns_.direction[axis][to] = rays_.direction[axis][i];
    columns_.t[to] = hits_.t[i], columns_.part[to] = hits_.u[i], columns_.element[to] = element_[k];
  }

  void find(const Accel& accel, Kind kind, const std::uint32_t* members) {
    if (!is_exact(kind)) {
      code_.closed_form(accel, kind, columns_);
    } else if (!code_.exact(kind, accel.exact_pool(kind), columns_)) {
      const ExactOps& ops = exact_ops(kind);
      for (std::size_t k = 0; k < columns_.count; ++k) {
        const std::uint32_t i = which_[members[k]];
        SurfaceInteraction s;
        ops.interaction_without_uv(accel.exact_pool(kind), columns_.element[k], rays_[i], hits_[i], s);
        out_.set_shape(members[k], s);
      }
      return;
    }
    for (std::size_t k = 0; k < columns_.count; ++k) {
      const std::uint32_t i = members[k];
      for (int axis = 0; axis < 3; ++axis) {
        out_.position[axis][i] = columns_.position[axis][k];
        out_.position_error[axis][i] = columns_.position_error[axis][k];
        out_.geometric_normal[axis][i] = out_.shading_normal[axis][i] = columns_.normal[axis][k];
      }
    }
  }

  /// An entry that is seen in a combination.
  struct Combined {
    const Accel* solids;
    std::size_t entry;
    bool flipped;
  };

  const RaySpan& rays_;
  const HitSpan& hits_;
  const std::uint32_t* which_;
  const InteractionCode& code_;
  InteractionBlock& out_;
  std::size_t count_ = 0, combinations_ = 0;
  std::uint32_t entry_[InteractionBlock::kMost], element_[InteractionBlock::kMost];
  std::uint64_t group_[InteractionBlock::kMost];
  const Accel* accel_[InteractionBlock::kMost];
  Combined combined_[InteractionBlock::kMost];
  ShapeHits columns_;
};

}  // namespace

void surface_interactions(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                          std::span<const std::uint32_t> which, InteractionBlock& out, Isa isa) {
  if (which.size() > InteractionBlock::kMost)
    throw Error("surface_interactions: " + std::to_string(which.size()) + " hits, but room for " +
                std::to_string(InteractionBlock::kMost));
  const InteractionCode& code = interaction_code(isa);
  MeshRun run(rays, hits, which.data(), code, out);
  ShapeGroups groups(rays, hits, which.data(), code, out);
  HitPlace place;
  std::uint32_t path = kNoId;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const Hit hit = hits[which[i]];
    if (place.accel == nullptr || hit.instance != path) {
      run.finish(place);
      place = follow_path(accel, hit.instance);
      path = hit.instance;
    }
    const HitNames names = identify_in(place, hit);
    out.geometry[i] = names.geometry, out.primitive[i] = names.primitive;
    out.user[i] = names.user, out.material_slot[i] = names.material_slot;
    if (names.kind == Kind::triangle) {
      run.add(place, names, i);
    } else if (!place.moved) {
      groups.add(place, names, i);
    } else {
      SurfaceInteraction s;
      interaction_at(place, names, rays[which[i]], hit, false, s);
      out.set_shape(i, s);
    }
  }
  run.finish(place);
  groups.finish();
}

}  // namespace oktett
