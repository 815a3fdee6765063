#include "verify/checks/changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "accel/dynamic_accel.h"
#include "core/random.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/compare_mode.h"
#include "verify/checks/kernels.h"
#include "verify/checks/run_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett {
namespace {

constexpr int kRays = 64;
constexpr TraceMode kModes[] = {TraceMode::automatic, TraceMode::single, TraceMode::packet8};

/// What the structure should hold.
struct Expected {
  std::uint32_t number;
  Geometry geometry;  ///< of a mesh without it; its user counts those added
  std::shared_ptr<TriangleMesh> mesh;
  bool enabled = true;
};

/// A structure that was taken, and what rays met in it then.
struct Kept {
  std::shared_ptr<const Accel> accel;
  RayBatch rays;
  HitBatch hits;
};

class Changes {
 public:
  Changes(std::uint64_t number, const std::vector<Isa>& isas, ChangesTally& tally)
      : random_(mix_bits(number)), isas_(isas), tally_(tally) {}

  void run() {
    ++tally_.sequences;
    for (int i = pick(1, 5); i > 0; --i) add();
    look();
    const DynamicAccel::Work first = dynamic_.work();
    for (int i = pick(4, 12); i > 0; --i) {
      change(), ++tally_.changes;
      if (random_.unit() < 0.6) look();
      if (tally_.wrong() > 0) return;
    }
    look();
    tally_.builds += dynamic_.work().builds - first.builds,
        tally_.refits += dynamic_.work().refits - first.refits;
  }

 private:
  int pick(int lo, int hi) { return lo + static_cast<int>(random_.unit() * (hi - lo + 1)); }

  void fail(std::uint64_t& count, const std::string& what) {
    ++count;
    if (tally_.failure.empty()) tally_.failure = what;
  }

  // ---- Changes.

  std::shared_ptr<TriangleMesh> draw_mesh() {
    static const OracleMesh balls[] = {make_icosphere(0), make_icosphere(2), make_icosphere(3)};
    static const OracleMesh torus = make_torus(20, 12), needles = make_needles(30);
    auto mesh = std::make_shared<TriangleMesh>();
    switch (pick(0, 4)) {
      case 0:
        *mesh = torus.mesh;
        break;
      case 1:
        *mesh = needles.mesh;
        break;
      case 2: {
        for (int i = 3 * pick(1, 60); i > 0; --i) {
          mesh->indices.push_back(static_cast<std::uint32_t>(mesh->positions.size()));
          mesh->positions.push_back(Vec3f(random_.vector()));
        }
        break;
      }
      default:
        *mesh = balls[pick(0, 2)].mesh;
    }
    return mesh;
  }

  Affine draw_map() {
    if (random_.unit() < 0.3) return {};
    Affine map = Affine::translation(random_.vector() * 3.0);
    if (random_.unit() < 0.7) map = map * Affine::rotation(random_.vector() * 180.0);
    if (random_.unit() < 0.3) map = map * Affine::scaling(Vec3d{1, 1, 1} * random_.magnitude(-1, 1));
    if (random_.unit() < 0.2) map = map * Affine::scaling({-1, 0.5, 2});
    return map;
  }

  Geometry draw_geometry() {
    Geometry g;
    g.transform = draw_map();
    const auto sphere = [&] { return SphereShape{random_.vector(), 0.1 + random_.unit()}; };
    switch (pick(0, 6)) {
      case 0:
        g.shape = SpheresShape{{sphere()}};
        break;
      case 1: {
        SpheresShape spheres;
        for (int i = pick(2, 40); i > 0; --i) spheres.spheres.push_back(sphere());
        g.shape = std::move(spheres);
        break;
      }
      case 2:
        g.shape = ExactShape{TorusShape{}};
        break;
      case 3:
        g.shape = ExactShape{CylinderShape{random_.vector(), random_.vector() * 2.0, 0.3, true}};
        break;
      case 4:
        g.shape = BoxShape{};
        break;
      case 5:
        g.shape = PlaneShape{random_.vector(), 2 * random_.sign()};
        break;
      default: {
        InstanceList list{{shared_child()}, {}};
        for (int i = pick(1, 5); i > 0; --i) {
          InstancePlace place{};
          draw_map().to_rows(place.to_list), place.child = 0, place.user = kNoId;
          list.places.push_back(place);
        }
        g.shape = std::move(list);
      }
    }
    return g;
  }

  static std::shared_ptr<const Accel> shared_child() {
    static const OracleMesh ball = make_icosphere(1);
    static const std::shared_ptr<const Accel> child = build_accel({{MeshGeometry{&ball.mesh}, {}, kNoId}});
    return child;
  }

  std::uint32_t draw_mask() {
    return random_.unit() < 0.5 ? ~0u : static_cast<std::uint32_t>(random_.bits() & 7);
  }

  void add() {
    Expected e;
    if (random_.unit() < 0.6) {
      e.mesh = draw_mesh(), e.geometry.shape = MeshGeometry{}, e.geometry.transform = draw_map();
      e.geometry.user = added_++;
      e.number = dynamic_.add(std::make_shared<const TriangleMesh>(*e.mesh), e.geometry);
    } else {
      e.geometry = draw_geometry();
      e.geometry.user = added_++;
      e.number = dynamic_.add(e.geometry);
    }
    expected_.push_back(std::move(e));
  }

  void change() {
    const int what = pick(0, 10);
    if (expected_.empty() || what == 0) return add();
    const auto k = static_cast<std::size_t>(pick(0, static_cast<int>(expected_.size()) - 1));
    Expected& e = expected_[k];
    if (what == 1) {
      dynamic_.remove(e.number);
      expected_.erase(expected_.begin() + static_cast<std::ptrdiff_t>(k));
    } else if (what == 2) {
      e.enabled = !e.enabled;
      dynamic_.set_enabled(e.number, e.enabled);
    } else if (what == 3) {
      e.geometry.mask = draw_mask();
      dynamic_.set_mask(e.number, e.geometry.mask);
    } else if (what <= 5 || e.mesh == nullptr) {
      e.geometry.transform = draw_map();
      dynamic_.set_transform(e.number, e.geometry.transform);
    } else {
      bend(e);
    }
  }

  void bend(Expected& e) {
    const std::size_t size = e.mesh->positions.size();
    std::size_t first = 0, count = size;
    if (random_.unit() < 0.4) {
      first = random_.bits() % size;
      count = 1 + random_.bits() % (size - first);
    }
    std::vector<Vec3f> moved(e.mesh->positions.begin() + first, e.mesh->positions.begin() + first + count);
    const int how = pick(0, 9);
    const Affine map = draw_map();
    const double reach = random_.magnitude(-4, 0);
    for (Vec3f& p : moved) {
      if (how <= 4) p += Vec3f(random_.vector() * reach);
      if (how == 5) p = Vec3f(map.point(Vec3d(p)));
      if (how == 6) p = Vec3f(random_.vector() * 2.0);
      if (how == 7) p = moved[0];
      if (how == 8) p.z = 0.5f;
      if (how == 9 && random_.unit() < 0.1) p.y = std::numeric_limits<float>::quiet_NaN();
    }
    std::ranges::copy(moved, e.mesh->positions.begin() + first);
    dynamic_.set_vertices(e.number, moved, first);
  }

  // ---- What rays meet.

  /// Rays from around towards vertices, faces and anything.
  RayBatch draw_rays() {
    RayBatch rays;
    for (int i = 0; i < kRays; ++i) {
      Vec3d target = random_.vector() * 2.0;
      if (!expected_.empty() && i % 2 == 0) {
        const Expected& e = expected_[random_.bits() % expected_.size()];
        target = e.geometry.transform.point(random_.vector());
        if (e.mesh != nullptr) {
          const Vec3f& p = e.mesh->positions[random_.bits() % e.mesh->positions.size()];
          if (is_finite(p)) target = e.geometry.transform.point(Vec3d(p));
        }
      }
      const Vec3d from = i < kRays / 2 ? Vec3d{4, 5, 6} : random_.vector() * 6.0;
      rays.push_back(
          {Vec3f(from), 0, Vec3f(target - from), i % 5 == 0 ? 1.0f : std::numeric_limits<float>::infinity()});
    }
    return rays;
  }

  /// The structure of another object with what there should be; with a mask, of that only what such rays
  /// meet.
  std::shared_ptr<const Accel> afresh(std::optional<std::uint32_t> mask = {}) const {
    DynamicAccel fresh;
    for (const Expected& e : expected_) {
      if (!e.enabled || (mask && (e.geometry.mask & *mask) == 0)) continue;
      if (e.mesh != nullptr)
        fresh.add(std::make_shared<const TriangleMesh>(*e.mesh), e.geometry);
      else
        fresh.add(e.geometry);
    }
    return fresh.accel();
  }

  /// Rays with a mask meet what they meet where there is nothing else, and hits have the numbers of the
  /// whole.
  void look_through_mask(const RayBatch& rays) {
    const std::uint32_t mask = draw_mask();
    const std::shared_ptr<const Accel> masked = dynamic_.accel(mask), whole = dynamic_.accel(),
                                       fresh = afresh(mask);
    for (std::size_t i = 0; i < rays.size(); i += 5) {
      const Hit hit = closest_hit(*masked, rays[i], isas_.back()),
                other = closest_hit(*fresh, rays[i], Isa::scalar);
      const bool same = same_bits(hit.t, other.t) && same_bits(hit.u, other.u) && same_bits(hit.v, other.v);
      if (!same || hit.valid() != other.valid() ||
          (hit.valid() && identify(*whole, hit).user != identify(*fresh, other).user))
        return fail(tally_.differing,
                    fmt::format("with mask {} the hit differs; ray {}", mask, exact_text(rays[i])));
    }
  }

  /// Rays with masks of their own meet what they meet in the structures for these masks.
  void look_through_masks(const RayBatch& rays) {
    std::vector<std::uint32_t> masks;
    for (std::size_t i = 0; i < rays.size(); ++i) masks.push_back(draw_mask());
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    closest_hit(dynamic_, rays, masks, hits.span(), isas_.back());
    any_hit(dynamic_, rays, masks, occluded, isas_.back());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit expected = closest_hit(*dynamic_.accel(masks[i]), rays[i], Isa::scalar);
      if (!same_bits(hits[i], expected) || (occluded[i] != 0) != expected.valid())
        return fail(tally_.differing, fmt::format("with a mask {} of its own it differs; ray {}", masks[i],
                                                  exact_text(rays[i])));
    }
  }

  void look() {
    const RayBatch rays = draw_rays();
    const std::shared_ptr<const Accel> fresh = afresh(), now = dynamic_.accel();
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    closest_hit(*fresh, rays.span(), hits.span(), Isa::scalar, TraceMode::single);
    tally_.rays += rays.size();
    for (std::size_t i = 0; i < rays.size(); ++i) tally_.hits += hits[i].valid();
    compare(*now, rays, hits, tally_.differing, "a fresh structure");
    for (std::size_t i = 0; i < rays.size() && tally_.wrong() == 0; i += 7) {
      std::vector<Hit> all, others;
      all_hits(*fresh, rays[i], all, Isa::scalar), all_hits(*now, rays[i], others, isas_.back());
      if (!std::ranges::equal(all, others, [](const Hit& a, const Hit& b) { return same_bits(a, b); }))
        fail(tally_.differing, "all hits differ from those in a fresh structure; ray " + exact_text(rays[i]));
    }
    // Structures for several masks are never refitted where geometries move, one alone is.
    if (tally_.wrong() == 0 && random_.unit() < 0.4) look_through_mask(rays);
    if (tally_.wrong() == 0 && random_.unit() < 0.2) look_through_masks(rays);
    if (kept_) compare(*kept_->accel, kept_->rays, kept_->hits, tally_.altered, "what it was");
    // Others are dropped, so that trees are changed in their place.
    if (random_.unit() < 0.3) kept_ = Kept{now, rays, std::move(hits)};
    if (random_.unit() < 0.3) kept_.reset();
  }

  void compare(const Accel& accel, const RayBatch& rays, const HitBatch& hits, std::uint64_t& count,
               const char* what) {
    for (const Isa isa : isas_)
      for (const TraceMode mode : kModes)
        compare_mode(accel, rays, hits, isa, mode, [&](std::size_t i, bool, bool) {
          fail(count, fmt::format("{} differs from {}; ray {}", to_string(isa), what, exact_text(rays[i])));
        });
  }

  CaseRandom random_;
  const std::vector<Isa>& isas_;
  ChangesTally& tally_;
  DynamicAccel dynamic_;
  std::uint32_t added_ = 0;  ///< geometries so far
  std::vector<Expected> expected_;
  std::optional<Kept> kept_;
};

void add(ChangesTally& sum, const ChangesTally& t) {
  sum.sequences += t.sequences, sum.changes += t.changes, sum.rays += t.rays, sum.hits += t.hits;
  sum.builds += t.builds, sum.refits += t.refits;
  sum.differing += t.differing, sum.altered += t.altered;
  if (sum.failure.empty()) sum.failure = t.failure, sum.sequence = t.sequence;
}

}  // namespace

ChangesTally verify_changes(std::uint64_t count, const std::vector<Isa>& isas, std::uint64_t first) {
  return run_cases(
      count, first, &ChangesTally::sequence, "sequence",
      [&](ChangesTally& tally) { Changes(tally.sequence, isas, tally).run(); }, add);
}

}  // namespace oktett
