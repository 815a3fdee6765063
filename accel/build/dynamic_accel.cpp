#include "accel/dynamic_accel.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>
#include <utility>

#include "accel/accel_data.h"
#include "accel/batch_pieces.h"
#include "accel/build/refit.h"
#include "core/error.h"

namespace oktett {

/// A geometry, and its tree if it has one of its own.
struct DynamicAccel::Entry {
  enum class Stale : std::uint8_t {
    none,
    positions,  ///< those of the mesh have changed since the tree was built or refitted
    all         ///< there is no tree yet
  };

  Geometry geometry;
  Affine inverse;  ///< of its transform
  bool enabled = true;
  std::shared_ptr<const TriangleMesh> mesh;  ///< kept alive; null: the caller does
  std::shared_ptr<TriangleMesh> changed;     ///< `mesh`, if its positions have changed
  FollowingTree following;
  Stale stale = Stale::all;
  bool was_refitted = false;

  bool has_tree() const {
    if (std::holds_alternative<MeshGeometry>(geometry.shape) ||
        std::holds_alternative<InstanceList>(geometry.shape) ||
        std::holds_alternative<CsgGeometry>(geometry.shape))
      return true;
    const auto* const spheres = std::get_if<SpheresShape>(&geometry.shape);
    return spheres != nullptr && spheres->spheres.size() > 1;
  }
};

/// Whether SurfaceInteraction::user is that of the geometry itself.
static bool has_own_user(const Geometry& geometry) {
  return !std::holds_alternative<InstanceGeometry>(geometry.shape) &&
         !std::holds_alternative<InstanceList>(geometry.shape) &&
         !std::holds_alternative<CsgGeometry>(geometry.shape);
}

/// A structure with what it refers to.
struct DynamicAccel::Snapshot {
  std::shared_ptr<const Accel> accel;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;
  std::vector<std::uint32_t> shown;  ///< the geometries in it
  double built_cost = 0;             ///< of the tree when it was built
};

DynamicAccel::DynamicAccel(const BuildOptions& options) : options_(options) { options_.mask = ~0u; }
DynamicAccel::~DynamicAccel() = default;

// ---- Changes.

std::uint32_t DynamicAccel::add(Geometry geometry) {
  if (entries_.size() >= kNoId) throw Error("more than 2^32 - 2 geometries were added");
  const auto number = static_cast<std::uint32_t>(entries_.size());
  if (geometry.user == kNoId && has_own_user(geometry)) geometry.user = number;
  entries_.push_back(std::make_unique<Entry>());
  entries_.back()->geometry = std::move(geometry);
  entries_.back()->inverse = entries_.back()->geometry.transform.inverse();
  snapshots_.clear();
  return number;
}

void DynamicAccel::replace(std::uint32_t number, Geometry geometry) {
  find(number);
  if (geometry.user == kNoId && has_own_user(geometry)) geometry.user = number;
  auto entry = std::make_unique<Entry>();
  entry->geometry = std::move(geometry), entry->enabled = entries_[number]->enabled;
  entry->inverse = entry->geometry.transform.inverse();
  // The same mesh is kept alive on.
  const auto* const shape = std::get_if<MeshGeometry>(&entry->geometry.shape);
  if (shape != nullptr && shape->mesh == entries_[number]->mesh.get()) entry->mesh = entries_[number]->mesh;
  entries_[number] = std::move(entry);
  snapshots_.clear();
}

/// Makes `mesh` that of the geometry. Throws Error if it is of another kind, or without a mesh.
static void set_mesh(const std::shared_ptr<const TriangleMesh>& mesh, Geometry& geometry) {
  auto* const shape = std::get_if<MeshGeometry>(&geometry.shape);
  if (shape == nullptr || mesh == nullptr) throw Error("expected a mesh and a geometry that is one");
  shape->mesh = mesh.get();
}

std::uint32_t DynamicAccel::add(std::shared_ptr<const TriangleMesh> mesh, Geometry geometry) {
  set_mesh(mesh, geometry);
  const std::uint32_t number = add(std::move(geometry));
  entries_.back()->mesh = std::move(mesh);
  return number;
}

void DynamicAccel::replace(std::uint32_t number, std::shared_ptr<const TriangleMesh> mesh,
                           Geometry geometry) {
  set_mesh(mesh, geometry);
  replace(number, std::move(geometry));
  entries_[number]->mesh = std::move(mesh);
}

const DynamicAccel::Entry& DynamicAccel::find(std::uint32_t number) const {
  if (number >= entries_.size() || entries_[number] == nullptr)
    throw Error("there is no geometry " + std::to_string(number) +
                (number < entries_.size() ? ": it was removed" : ""));
  return *entries_[number];
}
DynamicAccel::Entry& DynamicAccel::find(std::uint32_t number) {
  return const_cast<Entry&>(std::as_const(*this).find(number));
}

void DynamicAccel::remove(std::uint32_t number) {
  find(number);
  entries_[number].reset();
  snapshots_.clear();
}

void DynamicAccel::set_enabled(std::uint32_t number, bool enabled) {
  Entry& entry = find(number);
  if (entry.enabled == enabled) return;
  entry.enabled = enabled;
  snapshots_.clear();
}

void DynamicAccel::set_transform(std::uint32_t number, const Affine& transform) {
  Entry& entry = find(number);
  const Affine inverse = transform.inverse();
  if (!transform.is_invertible(inverse))
    throw Error("the transform of geometry " + std::to_string(number) + " has no inverse");
  entry.geometry.transform = transform, entry.inverse = inverse;
  moved_ = true;
}

void DynamicAccel::set_mask(std::uint32_t number, std::uint32_t mask) {
  Entry& entry = find(number);
  if (entry.geometry.mask == mask) return;
  entry.geometry.mask = mask;
  snapshots_.clear();
}

void DynamicAccel::set_vertices(std::uint32_t number, std::span<const Vec3f> positions, std::size_t first,
                                std::span<const Vec3f> normals) {
  Entry& entry = find(number);
  auto* const shape = std::get_if<MeshGeometry>(&entry.geometry.shape);
  if (shape == nullptr) throw Error("geometry " + std::to_string(number) + " is no mesh: it has no vertices");
  const auto check = [&](std::size_t size, std::size_t given, const char* what) {
    if (first > size || given > size - first)
      throw Error("geometry " + std::to_string(number) + " has " + std::to_string(size) + ' ' + what + "; " +
                  std::to_string(given) + " from number " + std::to_string(first) + " on were given");
  };
  check(shape->mesh->positions.size(), positions.size(), "vertices");
  if (!normals.empty()) check(shape->mesh->normals.size(), normals.size(), "normals");
  snapshots_.clear();
  // What is given may be the mesh's own.
  const std::shared_ptr<const TriangleMesh> before = entry.mesh;
  // A structure that somebody still holds refers to the mesh as it was. Three hold it here.
  if (entry.changed == nullptr || !is_unshared(entry.changed, 3)) {
    entry.changed = std::make_shared<TriangleMesh>(*shape->mesh);
    entry.mesh = entry.changed;
    shape->mesh = entry.changed.get();
  }
  const auto write = [&](std::span<const Vec3f> from, Column<Vec3f>& to) {
    if (!from.empty()) std::memmove(to.data() + first, from.data(), from.size_bytes());
  };
  write(positions, entry.changed->positions), write(normals, entry.changed->normals);
  if (entry.stale == Entry::Stale::none) entry.stale = Entry::Stale::positions;
}

const Geometry& DynamicAccel::geometry(std::uint32_t number) const { return find(number).geometry; }
std::shared_ptr<const TriangleMesh> DynamicAccel::mesh(std::uint32_t number) const {
  return find(number).mesh;
}
bool DynamicAccel::is_enabled(std::uint32_t number) const { return find(number).enabled; }

std::vector<std::uint32_t> DynamicAccel::numbers() const {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < entries_.size(); ++i)
    if (entries_[i] != nullptr) all.push_back(i);
  return all;
}

// ---- The structure.

/// Brings the tree of a geometry up to date.
void DynamicAccel::update(Entry& entry) {
  if (entry.stale == Entry::Stale::none) return;
  const bool moves = entry.stale == Entry::Stale::positions;
  // Until there is a tree again.
  entry.stale = Entry::Stale::all;
  if (moves && entry.following.follow(*entry.changed, options_.parallel)) {
    entry.was_refitted = true, entry.stale = Entry::Stale::none;
    return;
  }
  Geometry own;
  own.shape = entry.geometry.shape, own.user = entry.geometry.user;
  BuildOptions options = options_;
  if (moves) options.quality = BuildQuality::fast;
  entry.following.set(std::const_pointer_cast<Accel>(build_accel({std::move(own)}, options)));
  entry.was_refitted = false, entry.stale = Entry::Stale::none;
}

/// Brings all trees up to date that rays may enter.
void DynamicAccel::update() {
  used_masks_ = 0;
  for (const auto& entry : entries_)
    if (entry != nullptr && entry->enabled && entry->geometry.mask != ~0u)
      used_masks_ |= entry->geometry.mask;
  std::vector<Entry*> stale;
  for (const auto& entry : entries_)
    if (entry != nullptr && entry->enabled && entry->has_tree() && entry->stale != Entry::Stale::none)
      stale.push_back(entry.get());
  const auto one = [&](std::size_t i) { update(*stale[i]); };
  if (options_.parallel)
    tbb::parallel_for(std::size_t{0}, stale.size(), one);
  else
    for (std::size_t i = 0; i < stale.size(); ++i) one(i);
  for (const Entry* entry : stale) ++(entry->was_refitted ? work_.refits : work_.builds);
}

std::shared_ptr<DynamicAccel::Snapshot> DynamicAccel::snapshot_of(std::uint32_t mask) const {
  auto snapshot = std::make_shared<Snapshot>();
  for (std::uint32_t i = 0; i < entries_.size(); ++i)
    if (entries_[i] != nullptr && entries_[i]->enabled && (entries_[i]->geometry.mask & mask) != 0)
      snapshot->shown.push_back(i);
  for (const auto& [other, kept] : snapshots_)
    if (kept->shown == snapshot->shown) return kept;
  std::vector<Geometry> geometries;
  geometries.reserve(entries_.size());
  for (const auto& entry : entries_) {
    if (entry == nullptr || !entry->enabled) continue;
    const Geometry& own = entry->geometry;
    Geometry& shown = geometries.emplace_back();
    shown.transform = own.transform, shown.user = own.user, shown.mask = own.mask;
    if (entry->has_tree())
      shown.shape = InstanceGeometry{entry->following.tree()};
    else
      shown.shape = own.shape;
    if (entry->mesh != nullptr) snapshot->meshes.push_back(entry->mesh);
  }
  if (geometries.size() == 1 && snapshot->shown.size() == 1 && geometries[0].transform.is_identity() &&
      entries_[snapshot->shown[0]]->following.tree() != nullptr) {
    snapshot->accel = entries_[snapshot->shown[0]]->following.tree();
    return snapshot;
  }
  BuildOptions options = options_;
  options.mask = mask, options.quality = BuildQuality::fast;
  snapshot->accel = build_accel(std::move(geometries), options);
  snapshot->built_cost = stats(*snapshot->accel).sah_cost;
  return snapshot;
}

bool DynamicAccel::move(Snapshot& snapshot, std::uint32_t mask) const {
  std::vector<Placement> places;
  places.reserve(entries_.size());
  bool is_tree = false;  // the last one has a tree and is not moved
  for (const auto& entry : entries_) {
    if (entry == nullptr || !entry->enabled) continue;
    if (snapshot.accel == entry->following.tree()) return false;
    const Geometry& before = snapshot.accel->geometries[places.size()];
    const bool is_seen = (entry->geometry.mask & mask) != 0;
    const bool is_instance =
        entry->has_tree() || std::holds_alternative<InstanceGeometry>(entry->geometry.shape);
    if (is_seen && !is_instance && !(before.transform == entry->geometry.transform)) return false;
    // Also what is not seen is numbered.
    if (!is_instance && std::holds_alternative<InstanceGeometry>(before.shape) != is_wrapped(entry->geometry))
      return false;
    places.push_back(is_seen && is_instance ? Placement{&entry->geometry.transform, &entry->inverse}
                                            : Placement{});
    is_tree = entry->has_tree() && entry->geometry.transform.is_identity();
  }
  // One that is alone is its tree itself.
  if (places.size() == 1 && is_tree) return false;
  // Nobody else sees it.
  Accel& accel = const_cast<Accel&>(*snapshot.accel);
  return move_instances(accel, places, options_.parallel) &&
         accel.stats.sah_cost <= kMostGrowth * snapshot.built_cost;
}

std::shared_ptr<const Accel> DynamicAccel::accel() { return accel(~0u); }

std::shared_ptr<const Accel> DynamicAccel::accel(std::uint32_t mask) {
  if (std::exchange(moved_, false)) {
    // None is left if this throws.
    auto kept = std::exchange(snapshots_, {});
    if (kept.size() == 1 && is_unshared(kept.begin()->second) &&
        move(*kept.begin()->second, kept.begin()->first))
      snapshots_ = std::move(kept);
  }
  if (snapshots_.empty()) update();
  mask = least_mask(mask, used_masks_);
  auto found = snapshots_.find(mask);
  if (found == snapshots_.end()) found = snapshots_.emplace(mask, snapshot_of(mask)).first;
  return {found->second, found->second->accel.get()};
}

// ---- Rays with masks of their own.

/// Calls trace(structure, rays, numbers) for the rays of each structure, which have these numbers.
template <class Trace>
static void trace_by_mask(DynamicAccel& scene, const RaySpan& rays, std::span<const std::uint32_t> masks,
                          std::size_t results, const char* query, const Trace& trace) {
  require_same_size(rays.size, masks.size(), query);
  require_same_size(rays.size, results, query);
  std::map<std::uint32_t, std::shared_ptr<const Accel>> of_mask;
  std::map<const Accel*, std::vector<std::uint32_t>> numbers;
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    std::shared_ptr<const Accel>& accel = of_mask[masks[i]];
    if (accel == nullptr) accel = scene.accel(masks[i]);
    numbers[accel.get()].push_back(i);
  }
  RayBatch batch;
  for (const auto& [accel, own] : numbers) {
    batch.resize_uninitialized(own.size());
    for (std::size_t k = 0; k < own.size(); ++k) batch.set(k, rays[own[k]]);
    trace(*accel, batch, own);
  }
}

void closest_hit(DynamicAccel& scene, const RaySpan& rays, std::span<const std::uint32_t> masks,
                 const HitSpan& hits, Isa isa) {
  HitBatch found;
  trace_by_mask(scene, rays, masks, hits.size, "closest_hit",
                [&](const Accel& accel, const RayBatch& batch, const std::vector<std::uint32_t>& numbers) {
                  found.resize_uninitialized(batch.size());
                  closest_hit(accel, batch.span(), found.span(), isa);
                  for (std::size_t k = 0; k < numbers.size(); ++k) hits.set(numbers[k], found[k]);
                });
}

void any_hit(DynamicAccel& scene, const RaySpan& rays, std::span<const std::uint32_t> masks,
             std::span<std::uint8_t> occluded, Isa isa) {
  std::vector<std::uint8_t> found;
  trace_by_mask(scene, rays, masks, occluded.size(), "any_hit",
                [&](const Accel& accel, const RayBatch& batch, const std::vector<std::uint32_t>& numbers) {
                  found.resize(batch.size());
                  any_hit(accel, batch.span(), found, isa);
                  for (std::size_t k = 0; k < numbers.size(); ++k) occluded[numbers[k]] = found[k];
                });
}

}  // namespace oktett
