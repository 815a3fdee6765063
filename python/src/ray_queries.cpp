#include "python/src/ray_queries.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include "accel/accel.h"
#include "accel/hit_place.h"

namespace oktett::python {
namespace {

/// Turns the rows of `places` into columns.
void set_columns(const RayRows& rays, Places places, RayBatch& columns) {
  columns.resize_uninitialized(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float* const row = rays.rows + 6 * places[i];
    for (int k = 0; k < 3; ++k) columns.origin[k][i] = row[k], columns.direction[k][i] = row[3 + k];
    columns.tmin[i] = rays.tmin[places[i] * rays.tmin_step];
    columns.tmax[i] = rays.tmax[places[i] * rays.tmax_step];
  }
}

/// Fills the columns of `out` for hits of the rays of the same number, which belong to `places`.
class HitDescriber {
 public:
  HitDescriber(const World& world, const RaySpan& rays, const HitSpan& hits, Places places,
               const HitColumns& out)
      : world_(world), accel_(*world.accel), rays_(rays), hits_(hits), places_(places), out_(out) {}

  void describe() {
    if (out_.instance)
      for (std::size_t i = 0; i < hits_.size; ++i)
        out_.instance[places_[i]] = chain_at(world_, hits_.instance[i]);
    std::uint32_t which[InteractionBlock::kMost];
    std::size_t count = 0;
    for (std::size_t i = 0; i < hits_.size; ++i) {
      if (hits_.item[i] == kNoId) {
        set_miss(places_[i]);
        continue;
      }
      name(i);
      if (!out_.normal && !out_.position) continue;
      which[count++] = static_cast<std::uint32_t>(i);
      if (count == InteractionBlock::kMost) flush(which, count), count = 0;
    }
    flush(which, count);
  }

 private:
  void set_miss(std::size_t to) {
    if (out_.object) out_.object[to] = kNoId;
    if (out_.primitive) out_.primitive[to] = kNoId;
    if (out_.uv) out_.uv[2 * to] = out_.uv[2 * to + 1] = 0;
    for (int k = 0; k < 3 && out_.normal; ++k) out_.normal[3 * to + k] = 0;
    if (out_.position) out_.position.set_miss(to);
    set_carried(to, {});
  }

  /// What the mesh carries at a point.
  void set_carried(std::size_t to, const MeshPoint& point) {
    if (!out_.texcoord && out_.attributes.empty()) return;
    if (point.mesh != mesh_ || !mesh_known_) find_attributes(point.mesh);
    if (out_.texcoord) set_texcoord(to, point);
    for (std::size_t i = 0; i < out_.attributes.size(); ++i) {
      const AttributeColumn& column = out_.attributes[i];
      const std::size_t first = column.components * to;
      const MeshAttribute* const attribute = of_mesh_[i];
      AttributeValue value{};
      if (attribute != nullptr) value = attribute_at(point, *attribute);
      for (std::uint32_t k = 0; k < column.components; ++k)
        column.values[first + k] = attribute != nullptr ? value[k] : kNaN;
    }
  }

  void find_attributes(const TriangleMesh* mesh) {
    mesh_ = mesh, mesh_known_ = true;
    of_mesh_.clear();
    for (const AttributeColumn& column : out_.attributes)
      of_mesh_.push_back(mesh == nullptr ? nullptr : find_attribute(*mesh, column.name));
  }

  void set_texcoord(std::size_t to, const MeshPoint& point) {
    out_.texcoord[2 * to] = out_.texcoord[2 * to + 1] = kNaN;
    if (point.mesh == nullptr || point.mesh->uv_indices.empty()) return;
    const std::array<Vec2f, 3> uv = corner_uvs(*point.mesh, point.triangle);
    const double u = point.u, v = point.v, w = 1 - u - v;
    const auto weighted = [=](double a, double b, double c) {
      return static_cast<float>(a * w + b * u + c * v);
    };
    out_.texcoord[2 * to] = weighted(uv[0].x, uv[1].x, uv[2].x);
    out_.texcoord[2 * to + 1] = weighted(uv[0].y, uv[1].y, uv[2].y);
  }

  void name(std::size_t i) {
    const bool carries = out_.texcoord || !out_.attributes.empty();
    if (!out_.object && !out_.primitive && !out_.uv && !out_.normal && !out_.position && !carries) return;
    const Hit hit = hits_[i];
    if (place_.accel == nullptr || hit.instance != path_) {
      place_ = follow_path(accel_, hit.instance);
      path_ = hit.instance;
    }
    const HitNames names = identify_in(place_, hit);
    const std::size_t to = places_[i];
    if (out_.object) out_.object[to] = names.user;
    if (out_.primitive) out_.primitive[to] = names.primitive;
    if (carries) {
      MeshPoint point;
      if (names.kind == Kind::triangle)
        point = {std::get<MeshGeometry>(place_.accel->geometries[names.geometry].shape).mesh, names.primitive,
                 hit.u, hit.v};
      set_carried(to, point);
    }
    if (names.kind == Kind::triangle && (out_.normal || out_.position)) {
      const Geometry& geometry = place_.accel->geometries[names.geometry];
      const TriangleMesh& mesh = *std::get<MeshGeometry>(geometry.shape).mesh;
      corners_[corner_count_++] = {&mesh, &mesh.indices[3 * std::size_t{names.primitive}]};
      __builtin_prefetch(corners_[corner_count_ - 1].indices);
    }
    if (!out_.uv) return;
    // Other shapes keep numbers of their own there.
    const bool triangle = names.kind == Kind::triangle;
    out_.uv[2 * to] = triangle ? hit.u : 0, out_.uv[2 * to + 1] = triangle ? hit.v : 0;
  }

  void flush(const std::uint32_t* which, std::size_t count) {
    // What the corners of all 64 triangles wait for in memory is fetched at the same time.
    for (const Corners& c : std::span(corners_, corner_count_))
      for (int k = 0; k < 3; ++k) __builtin_prefetch(&c.mesh->positions[c.indices[k]]);
    corner_count_ = 0;
    if (count == 0) return;
    static thread_local InteractionBlock block;
    surface_interactions(accel_, rays_, hits_, {which, count}, block);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t to = places_[which[n]];
      for (std::size_t k = 0; k < 3 && out_.normal; ++k)
        out_.normal[3 * to + k] = block.geometric_normal[k][n];
      if (out_.position)
        out_.position.set(to, {block.position[0][n], block.position[1][n], block.position[2][n]});
    }
  }

  /// Where the corners of a triangle are found.
  struct Corners {
    const TriangleMesh* mesh;
    const std::uint32_t* indices;
  };

  const World& world_;
  const Accel& accel_;
  Corners corners_[InteractionBlock::kMost];  ///< of the hits since the last flush
  std::size_t corner_count_ = 0;
  RaySpan rays_;
  HitSpan hits_;
  Places places_;
  HitColumns out_;
  HitPlace place_;
  std::uint32_t path_ = kNoId;
  const TriangleMesh* mesh_ = nullptr;
  bool mesh_known_ = false;
  std::vector<const MeshAttribute*> of_mesh_;  ///< those of mesh_, for each column; null for none
  static constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
};

/// A column of `count` numbers in `values`, or null.
template <class T>
T* sized(std::vector<T>& values, const void* wanted, std::size_t count) {
  if (wanted == nullptr) return nullptr;
  values.resize(count);
  return values.data();
}

}  // namespace

void describe_hits(const World& world, const RaySpan& rays, const HitSpan& hits, Places places,
                   const HitColumns& out) {
  HitDescriber(world, rays, hits, places, out).describe();
}

namespace {

/// Tells the hits with ignored primitives apart.
class IgnoredHits {
 public:
  IgnoredHits(const World& world, const IgnoredPrimitives& ignored)
      : accel_(*world.accel), ignored_(ignored) {}

  bool holds(const Hit& hit) {
    if (!hit.valid()) return false;
    if (place_.accel == nullptr || hit.instance != path_) {
      place_ = follow_path(accel_, hit.instance);
      path_ = hit.instance;
    }
    const HitNames names = identify_in(place_, hit);
    return ignored_.holds(names.user, names.primitive);
  }

 private:
  const Accel& accel_;
  const IgnoredPrimitives& ignored_;
  HitPlace place_;
  std::uint32_t path_ = kNoId;
};

/// The nearest hits, but for those with ignored primitives.
void find_closest(const World& world, const RayBatch& rays, const IgnoredPrimitives& ignored,
                  const HitSpan& hits) {
  closest_hit(*world.accel, rays.span(), hits);
  if (ignored.empty()) return;
  IgnoredHits apart(world, ignored);
  std::vector<Hit> all;
  for (std::size_t i = 0; i < hits.size; ++i) {
    if (!apart.holds(hits[i])) continue;
    oktett::all_hits(*world.accel, rays[i], all);
    const auto seen = std::find_if(all.begin(), all.end(), [&](const Hit& hit) { return !apart.holds(hit); });
    hits.set(i, seen != all.end() ? *seen : Hit{});
  }
}

/// All hits, but for those with ignored primitives.
void find_all(const World& world, const RayBatch& rays, const IgnoredPrimitives& ignored, HitLists& found) {
  oktett::all_hits(*world.accel, rays.span(), found);
  if (ignored.empty()) return;
  IgnoredHits apart(world, ignored);
  std::size_t kept = 0, next = 0;
  for (std::size_t ray = 0; ray + 1 < found.begin.size(); ++ray) {
    for (; next < found.begin[ray + 1]; ++next)
      if (!apart.holds(found.hits[next])) found.hits[kept++] = found.hits[next];
    found.begin[ray + 1] = kept;
  }
  found.hits.resize(kept);
}

}  // namespace

void closest_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
                  const HitColumns& out) {
  static thread_local RayBatch columns;
  static thread_local HitBatch batch;
  set_columns(rays, places, columns);
  batch.resize_uninitialized(places.size());
  const HitSpan hits = batch.span();
  find_closest(world, columns, ignored, hits);
  if (out.t)
    for (std::size_t i = 0; i < places.size(); ++i) out.t[places[i]] = hits.t[i];
  describe_hits(world, columns.span(), hits, places, out);
}

void any_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
              std::uint8_t* occluded) {
  static thread_local RayBatch columns;
  static thread_local HitBatch batch;
  static thread_local std::vector<std::uint8_t> answers;
  set_columns(rays, places, columns);
  answers.resize(places.size());
  if (ignored.empty()) {
    any_hit(*world.accel, columns.span(), answers);
  } else {
    batch.resize_uninitialized(places.size());
    find_closest(world, columns, ignored, batch.span());
    for (std::size_t i = 0; i < places.size(); ++i) answers[i] = batch[i].valid();
  }
  for (std::size_t i = 0; i < places.size(); ++i) occluded[places[i]] = answers[i];
}

void count_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
                std::uint32_t* counts) {
  static thread_local RayBatch columns;
  static thread_local HitLists found;
  static thread_local std::vector<std::uint32_t> answers;
  set_columns(rays, places, columns);
  answers.resize(places.size());
  if (ignored.empty()) {
    oktett::count_hits(*world.accel, columns.span(), answers);
  } else {
    find_all(world, columns, ignored, found);
    for (std::size_t i = 0; i < places.size(); ++i)
      answers[i] = static_cast<std::uint32_t>(found.begin[i + 1] - found.begin[i]);
  }
  for (std::size_t i = 0; i < places.size(); ++i) counts[places[i]] = answers[i];
}

void all_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
              const HitColumns& wanted, FoundHits& lists) {
  static thread_local RayBatch columns, hit_rays;
  static thread_local HitBatch hits;
  static thread_local oktett::HitLists found;
  set_columns(rays, places, columns);
  find_all(world, columns, ignored, found);
  const std::size_t count = found.hits.size();
  lists.begin.assign(found.begin.begin(), found.begin.end());
  hit_rays.resize_uninitialized(count), hits.resize_uninitialized(count);
  for (std::size_t ray = 0; ray + 1 < found.begin.size(); ++ray)
    for (std::size_t k = found.begin[ray]; k < found.begin[ray + 1]; ++k) {
      hit_rays.set(k, columns[ray]);
      hits.span().set(k, found.hits[k]);
    }
  HitColumns out;
  out.t = sized(lists.t, wanted.t, count);
  out.object = sized(lists.object, wanted.object, count);
  out.primitive = sized(lists.primitive, wanted.primitive, count);
  out.instance = sized(lists.instance, wanted.instance, count);
  out.uv = sized(lists.uv, wanted.uv, 2 * count);
  out.normal = sized(lists.normal, wanted.normal, 3 * count);
  out.position.floats = sized(lists.position, wanted.position.floats, 3 * count);
  out.texcoord = sized(lists.texcoord, wanted.texcoord, 2 * count);
  out.attributes = wanted.attributes;
  lists.attributes.resize(out.attributes.size());
  for (std::size_t i = 0; i < out.attributes.size(); ++i) {
    lists.attributes[i].resize(count * out.attributes[i].components);
    out.attributes[i].values = lists.attributes[i].data();
  }
  if (out.t) std::copy_n(hits.t.data(), count, out.t);
  static thread_local std::vector<std::size_t> own_places;
  own_places.resize(count);
  std::iota(own_places.begin(), own_places.end(), std::size_t{0});
  describe_hits(world, hit_rays.span(), hits.span(), own_places, out);
}

}  // namespace oktett::python
