#include "verify/checks/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "accel/accel.h"
#include "core/parallel.h"
#include "core/random.h"
#include "verify/checks/compare_mode.h"

namespace oktett {

std::vector<MeshPlacement> mesh_placements() {
  return {{"as is", 0, {0, 0, 0}},          {"far", 1000, {148376, 1234, -223423}},
          {"huge 1e15", 1e15, {0, 0, 0}},   {"huge 1e20", 1e20, {0, 0, 0}},
          {"huge 1e30", 1e30, {0, 0, 0}},   {"tiny 1e-15", 1e-15, {0, 0, 0}},
          {"tiny 1e-20", 1e-20, {0, 0, 0}}, {"tiny 1e-25", 1e-25, {0, 0, 0}}};
}

void MeshTally::add(const MeshTally& o) {
  rays += o.rays, hits += o.hits, leaks += o.leaks, parity += o.parity, doubled += o.doubled;
  differing += o.differing, inconsistent += o.inconsistent;
  fail(o.first_failure, o.failure);
}

namespace {

constexpr std::size_t kRaysTogether = 2048;

/// A point that rays start at, and how often the mesh winds around it.
struct Viewpoint {
  Vec3f point;
  int winding = 0;
};

struct Subject {
  TriangleMesh mesh;
  std::shared_ptr<const Accel> accel, plain;
  std::vector<Viewpoint> viewpoints;
  bool closed = false, convex = false;
};

/// Points in and around the bounds that are clearly on one side of the surface.
std::vector<Viewpoint> find_viewpoints(const TriangleMesh& mesh, const Box& box, std::uint64_t key) {
  constexpr int kWanted = 48, kTries = 400;
  std::vector<Viewpoint> found;
  CaseRandom random(key);
  const Vec3d center(box.center()), half = Vec3d(box.extent()) * 0.5;
  const double size = max_component(half), reach = max_component(abs(center)) + size;
  for (int i = 0; i < kTries && found.size() < kWanted; ++i) {
    const double spread = i % 4 == 0 ? 2.5 : i % 4 == 1 ? 1 : 0.6;
    const Vec3f p(center + half * random.vector() * spread);
    if (near_surface(mesh, Vec3d(p), 1e-6 * size + 4e-7 * reach)) continue;
    const double winding = winding_number(mesh, Vec3d(p)), whole = std::round(winding);
    if (std::abs(winding - whole) < 1e-3) found.push_back({p, static_cast<int>(whole)});
  }
  return found;
}

Ray aimed_ray(const Subject& s, const Viewpoint& from, CaseRandom& random) {
  const std::size_t triangle = random.bits() % s.mesh.triangle_count(), k = random.bits() % 3;
  const auto corner = [&](std::size_t j) {
    return Vec3d(s.mesh.positions[s.mesh.indices[3 * triangle + j % 3]]);
  };
  const double u = random.unit();
  Ray ray;
  ray.origin = from.point;
  const auto kind = random.bits() % 4;
  // The middle of an edge is often a float, so that the ray passes it exactly.
  const Vec3d target =
      kind == 0   ? corner(k)
      : kind == 1 ? (corner(k) + corner(k + 1)) * 0.5
      : kind == 2 ? corner(k) * (1 - u) + corner(k + 1) * u
                  : Vec3d(from.point) + random.vector() * double(max_component(bounds(*s.accel).extent()));
  ray.direction = Vec3f(target - Vec3d(from.point));
  const float length = max_component(abs(ray.direction));
  if (random.bits() & 1 && length > 0) ray.direction = ray.direction / length;
  return ray;
}

class ChunkCheck {
 public:
  ChunkCheck(const Subject& subject, std::uint64_t first) : subject_(subject), first_(first) {}

  MeshTally run(std::size_t count, const std::vector<Isa>& isas, std::uint64_t key) {
    tally_.rays = count;
    for (std::size_t i = 0; i < count; ++i) {
      CaseRandom random(pixel_key(static_cast<std::uint32_t>(key), first_ + i));
      views_.push_back(&subject_.viewpoints[random.bits() % subject_.viewpoints.size()]);
      // Runs of rays from one point exercise the packets for a common origin.
      if (i % 64 != 0 && (i / 64) % 2 == 0) views_.back() = views_[i - 1];
      rays_.push_back(aimed_ray(subject_, *views_.back(), random));
    }
    reference_.resize_uninitialized(count);
    closest_hit(*subject_.plain, rays_.span(), reference_.span(), Isa::scalar, TraceMode::single);
    for (std::size_t i = 0; i < count; ++i) tally_.hits += reference_[i].valid();
    for (const Isa isa : isas) {
      for (const TraceMode mode : kTraceModes) compare(isa, mode);
      all_hits(*subject_.accel, rays_, lists_, isa);
      for (std::size_t i = 0; i < count; ++i) check_crossings(i, isa);
    }
    return tally_;
  }

 private:
  void compare(Isa isa, TraceMode mode) {
    if (isa == Isa::scalar && mode != TraceMode::automatic) return;
    compare_mode(*subject_.accel, rays_, reference_, isa, mode, [&](std::size_t i, bool closest, bool any) {
      if (closest)
        complain(tally_.differing, i,
                 fmt::format("{} mode {} differs from scalar", to_string(isa), int(mode)));
      if (any) complain(tally_.inconsistent, i, fmt::format("any_hit {} mode {}", to_string(isa), int(mode)));
    });
  }

  void check_crossings(std::size_t i, Isa isa) {
    all_hits(*subject_.accel, rays_[i], crossings_, isa);
    const Hit& closest = reference_[i];
    const bool agrees =
        crossings_.empty() ? !closest.valid() : closest.valid() && same_bits(crossings_[0], closest);
    if (!agrees)
      complain(tally_.inconsistent, i, fmt::format("all_hits of {} against closest_hit", to_string(isa)));
    if (!std::ranges::equal(crossings_, lists_.of_ray(i),
                            [](const Hit& a, const Hit& b) { return same_bits(a, b); }))
      complain(tally_.inconsistent, i,
               fmt::format("all_hits of {}: a batch against one ray", to_string(isa)));
    if (!subject_.closed || max_component(abs(rays_[i].direction)) == 0) return;
    const bool inside = views_[i]->winding % 2 != 0;
    if (inside && !closest.valid()) complain(tally_.leaks, i, "leak");
    if ((crossings_.size() % 2 != 0) != inside)
      complain(tally_.parity, i,
               fmt::format("{} crossings from {}", crossings_.size(), inside ? "inside" : "outside"));
    if (subject_.convex && crossings_.size() > (inside ? 1u : 2u))
      complain(tally_.doubled, i, fmt::format("{} crossings of a convex mesh", crossings_.size()));
  }

  void complain(std::uint64_t& count, std::size_t i, const std::string& text) {
    ++count;
    tally_.fail(first_ + i, text + ": " + exact_text(rays_[i]));
  }

  const Subject& subject_;
  std::uint64_t first_;
  MeshTally tally_;
  RayBatch rays_;
  std::vector<const Viewpoint*> views_;
  HitBatch reference_;
  std::vector<Hit> crossings_;
  HitLists lists_;
};

}  // namespace

TriangleMesh placed_as(const TriangleMesh& mesh, const MeshPlacement& placement) {
  Box box;
  for (const Vec3f& p : mesh.positions)
    if (is_finite(p)) box.grow(p);
  const double extent = max_component(box.extent());
  return placed(mesh, placement.size > 0 && extent > 0 ? placement.size / extent : 1, placement.offset);
}

MeshTally verify_mesh(const OracleMesh& mesh, const MeshPlacement& placement, std::uint64_t rays,
                      const std::vector<Isa>& isas, const BuildOptions& build, std::uint64_t first_ray) {
  Subject subject;
  subject.mesh = placed_as(mesh.mesh, placement);
  subject.accel = build_accel({{MeshGeometry{&subject.mesh}, {}, kNoId}}, build);
  const bool plain = build.quality == BuildQuality::balanced;
  subject.plain = plain ? subject.accel : build_accel({{MeshGeometry{&subject.mesh}, {}, kNoId}});
  MeshTally total;
  total.open_edges = open_edge_count(mesh.mesh);
  subject.closed = total.open_edges == 0, subject.convex = mesh.convex;
  const Box bounds_box = bounds(*subject.accel);
  if (bounds_box.empty()) return total;
  std::uint64_t key = 1;
  for (const char* c = placement.name; *c != 0; ++c) key = mix_bits(key + static_cast<unsigned char>(*c));
  if (subject.closed) subject.viewpoints = find_viewpoints(subject.mesh, bounds_box, key);
  // An open mesh has no inside; its rays may start anywhere.
  CaseRandom random(key);
  if (!subject.closed)
    for (int i = 0; i < 48; ++i)
      subject.viewpoints.push_back(
          {Vec3f(Vec3d(bounds_box.center()) + Vec3d(bounds_box.extent()) * random.vector() * 1.2), 0});
  if (subject.viewpoints.empty()) return total;
  const Chunks chunks(rays, kRaysTogether);
  std::vector<MeshTally> parts(chunks.count);
  chunks.each(true, [&](std::size_t k, std::size_t begin, std::size_t end) {
    parts[k] = ChunkCheck(subject, first_ray + begin).run(end - begin, isas, key);
  });
  for (const MeshTally& part : parts) total.add(part);
  return total;
}

}  // namespace oktett
