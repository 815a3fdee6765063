#include "verify/checks/scenes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <tuple>
#include <utility>

#include "accel/query.h"
#include "core/random.h"
#include "render/geometry.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/compare_mode.h"
#include "verify/checks/kernels.h"
#include "verify/oracles/along_ray.h"
#include "verify/oracles/known_shapes.h"

namespace oktett {

// ---- The rays.

namespace {

/// Rays through a scene that start elsewhere than on its surfaces.
constexpr std::size_t kRaysPerScene = 320;

/// Rays that leave the surfaces which `rays` hit, in random directions.
void add_second_rays(const Accel& accel, CaseRandom& random, RayBatch& rays) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), Isa::scalar, TraceMode::single);
  for (std::size_t i = 0, end = rays.size(); i < end; i += 4) {
    if (!hits[i].valid()) continue;
    const SurfaceInteraction s = surface_interaction(accel, rays[i], hits[i]);
    const Vec3f d(random.vector());
    rays.push_back({offset_origin(s, d), 0, d});
  }
}

}  // namespace

RayBatch draw_rays(const Scene& scene, std::uint64_t number) {
  const World world = build_world(scene, {BuildQuality::fast, false});
  CaseRandom random(mix_bits(number) + 5);
  Vec3d middle{0, 0, 0}, half{1, 1, 1};
  if (!world.bounds.empty()) middle = Vec3d(world.bounds.center()), half = Vec3d(world.bounds.extent()) * 0.5;
  const double size = std::max(length(half), 1e-30);
  const auto around = [&](double reach) { return middle + normalize(random.vector()) * (size * reach); };
  RayBatch rays;
  while (rays.size() < kRaysPerScene) {
    // Runs from one point exercise beams and packets.
    const bool camera = random.unit() < 0.5;
    const Vec3d eye = around(1.2 + random.unit()), towards = middle + half * random.vector() * 0.7;
    const double spread = random.unit();
    for (int k = 0; k < (camera ? 64 : 32); ++k) {
      const Vec3d at = camera ? towards + half * random.vector() * spread : middle + half * random.vector();
      Vec3d from = camera ? eye : random.unit() < 0.3 ? middle + half * random.vector() : around(1.5);
      Ray ray;
      ray.direction = Vec3f(at - from);
      if (!camera && random.unit() < 0.2) {
        const int axis = static_cast<int>(random.unit() * 3);
        const double side = random.sign() < 0 ? -1 : 1;
        from = at, from[axis] -= side * 2 * size;
        ray.direction = {0, 0, 0}, ray.direction[axis] = static_cast<float>(side);
      }
      ray.origin = Vec3f(from);
      const double reach = size / std::max(1e-30, double(max_component(abs(ray.direction))));
      if (random.unit() < 0.1) ray.tmin = static_cast<float>(reach * random.unit());
      if (random.unit() < 0.1) ray.tmax = static_cast<float>(3 * reach * random.unit());
      rays.push_back(ray);
    }
  }
  add_second_rays(*world.accel, random, rays);
  return rays;
}

// ---- The checks.

namespace {

/// One ray in so many is compared with the oracle's crossings, which takes long; hits are always looked at.
constexpr std::size_t kSampledRays = 8;

World build(const Scene& scene, BuildQuality quality) { return build_world(scene, {quality, false}); }

/// Objects of the scene that become one geometry, alone.
struct Part {
  std::size_t first = 0, count = 1;
  World world;
  std::optional<KnownShape> known;  ///< of a single object
  Affine to_own;
  bool in_instance = false;  ///< as a sphere with unequal scales: the tracer makes an instance of it
  HitBatch closest;
  HitLists lists;
};

bool is_instance(const Object& object) { return std::holds_alternative<InstanceShape>(object.shape); }

std::vector<Part> parts_of(const Scene& scene) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < scene.objects.size();) {
    std::size_t run = 0;
    while (i + run < scene.objects.size() && is_instance(scene.objects[i + run])) ++run;
    Part& part = parts.emplace_back();
    part.first = i, part.count = run >= kLeastInstanceList ? run : 1;
    Scene alone;
    alone.prototypes = scene.prototypes;
    const auto begin = scene.objects.begin() + static_cast<std::ptrdiff_t>(i);
    alone.objects.assign(begin, begin + static_cast<std::ptrdiff_t>(part.count));
    part.world = build(alone, BuildQuality::balanced);
    if (part.count == 1) part.known = known_shape(begin->name);
    if (part.known && !part.known->truth.f) part.known.reset();
    part.to_own = begin->transform.inverse();
    i += part.count;
  }
  return parts;
}

/// The kinds of the known shapes among objects and operands. `exact` becomes false if there are textbook
/// tests of triangles, whose hits are only about right.
void add_kinds(const std::vector<Object>& objects, std::set<std::string>& kinds, bool& exact) {
  for (const Object& object : objects) {
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    exact &= mesh == nullptr || mesh->test == TriangleTest::watertight;
    if (!object.name.empty()) kinds.insert(object.name.substr(0, object.name.find('.')));
    if (const auto* csg = std::get_if<CsgShape>(&object.shape)) add_kinds(*csg->operands, kinds, exact);
  }
}

/// What of a hit does not depend on what else is in the scene.
std::tuple<float, float, float> place(const Hit& h) { return {h.t, h.u, h.v}; }

class SceneChecker {
 public:
  SceneChecker(const Scene& scene, const RayBatch& rays, const std::vector<Isa>& isas, std::uint64_t turn)
      : scene_(scene), rays_(rays), isas_(isas), isa_(isas[turn % isas.size()]) {}

  SceneTally run() {
    world_ = build(scene_, BuildQuality::balanced);
    tally_.scenes = 1, tally_.objects = scene_.objects.size(), tally_.rays = rays_.size();
    add_kinds(scene_.objects, tally_.kinds, exact_);
    for (const Prototype& prototype : scene_.prototypes) add_kinds(prototype.objects, tally_.kinds, exact_);
    closest_.resize_uninitialized(rays_.size());
    closest_hit(*world_.accel, rays_.span(), closest_.span(), isas_.front(), TraceMode::single);
    for (std::size_t i = 0; i < rays_.size(); ++i) tally_.hits += closest_[i].valid();
    compare_ways();
    compare_queries();
    compare_qualities();
    compare_surfaces();
    compare_parts();
    return tally_;
  }

 private:
  void fail(std::uint64_t& count, std::size_t i, const std::string& what) {
    ++count;
    if (tally_.failure.empty()) tally_.failure = what + "; ray " + exact_text(rays_[i]);
  }

  void compare_ways() {
    for (const Isa isa : isas_)
      for (const TraceMode mode : kTraceModes) {
        if (isa != isa_ && mode != TraceMode::automatic && mode != TraceMode::single) continue;
        compare_mode(*world_.accel, rays_, closest_, isa, mode, [&](std::size_t i, bool closest, bool) {
          fail(tally_.differing, i,
               fmt::format("{} of {} in mode {} differs", closest ? "the closest hit" : "any_hit",
                           to_string(isa), static_cast<int>(mode)));
        });
      }
  }

  /// One ray, eight and all at a time; closest, any, all and the number of hits.
  void compare_queries() {
    const Accel& accel = *world_.accel;
    all_hits(accel, rays_.span(), lists_, isas_.front());
    HitBatch eight;
    eight.resize_uninitialized(rays_.size());
    for (std::size_t i = 0; i < rays_.size(); i += 8) {
      const std::size_t n = std::min<std::size_t>(8, rays_.size() - i);
      closest_hit(accel, rays_.span().part(i, n), eight.span().part(i, n), isa_);
    }
    HitLists lists;
    all_hits(accel, rays_.span(), lists, isa_);
    std::vector<std::uint32_t> counts(rays_.size());
    count_hits(accel, rays_.span(), counts, isa_);
    std::vector<Hit> list;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Hit first = closest_[i];
      const auto expect = [&](bool ok, const char* what) {
        if (!ok) fail(tally_.differing, i, fmt::format("{} ({})", what, to_string(isa_)));
      };
      expect(same_bits(eight[i], first), "the closest hit differs in a batch of eight");
      expect(same_bits(closest_hit(accel, rays_[i], isa_), first), "the closest hit differs alone");
      expect(any_hit(accel, rays_[i], isa_) == first.valid(), "any_hit of one ray against closest_hit");
      const auto expected = lists_.of_ray(i);
      all_hits(accel, rays_[i], list, isa_);
      const auto same = [](const Hit& a, const Hit& b) { return same_bits(a, b); };
      expect(std::ranges::equal(list, expected, same), "all_hits of one ray differ");
      expect(std::ranges::equal(lists.of_ray(i), expected, same), "all_hits of a batch differ");
      expect(counts[i] == expected.size(), "count_hits against all_hits");
      expect(expected.empty() ? !first.valid() : same_bits(expected[0], first),
             "the closest hit is not the first of all_hits");
    }
  }

  void compare_qualities() {
    constexpr std::size_t whole = BuildOptions{}.together;
    for (const auto& [quality, together] : {std::pair(BuildQuality::fast, whole),
                                            {BuildQuality::best, whole},
                                            {BuildQuality::compact, whole},
                                            {BuildQuality::compact, 100}}) {
      BuildOptions options{quality, false};
      options.together = together;
      const World other = build_world(scene_, options);
      compare_mode(*other.accel, rays_, closest_, isa_, TraceMode::automatic, [&](std::size_t i, bool, bool) {
        fail(tally_.differing, i,
             fmt::format("build quality {}, {} at once, differs", static_cast<int>(options.quality),
                         options.together));
      });
    }
  }

  /// In blocks and one by one; near where the ray is, within the stated error.
  void compare_surfaces() {
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < rays_.size(); ++i)
      if (closest_[i].valid()) which.push_back(i);
    for (std::size_t at = 0; at < which.size(); at += InteractionBlock::kMost) {
      const auto part = std::span(which).subspan(at, std::min(InteractionBlock::kMost, which.size() - at));
      surface_interactions(*world_.accel, rays_.span(), closest_.span(), part, block_, isa_, true);
      for (std::size_t k = 0; k < part.size(); ++k) compare_surface(part[k], block_[k]);
    }
  }

  void compare_surface(std::size_t i, const SurfaceInteraction& b) {
    const Ray ray = rays_[i];
    const Hit hit = closest_[i];
    const SurfaceInteraction s = surface_interaction(*world_.accel, ray, hit);
    const auto compare = [&](const char* what, const Vec3f& one, const Vec3f& in_block) {
      if (same_bits(one, in_block)) return;
      fail(tally_.differing, i,
           fmt::format(
               "{} of surface_interactions is ({:a}, {:a}, {:a}), of surface_interaction ({:a}, {:a}, {:a})",
               what, in_block.x, in_block.y, in_block.z, one.x, one.y, one.z));
    };
    compare("the position", s.position, b.position), compare("the error", s.position_error, b.position_error);
    compare("the normal", s.geometric_normal, b.geometric_normal);
    compare("the shading normal", s.shading_normal, b.shading_normal);
    compare("uv", {s.uv.x, s.uv.y, 0}, {b.uv.x, b.uv.y, 0});
    if (s.geometry != b.geometry || s.primitive != b.primitive || s.user != b.user)
      fail(tally_.differing, i, "a number of surface_interactions differs from surface_interaction");
    const SurfaceInteraction name = identify(*world_.accel, hit);
    if (name.geometry != s.geometry || name.primitive != s.primitive || name.user != s.user)
      fail(tally_.differing, i, "identify differs from surface_interaction");
    if (!exact_) return;
    // Guarantee 4 of docs/numerics.md.
    const double reach = double(hit.t) * max_component(abs(ray.direction));
    for (int k = 0; k < 3; ++k) {
      const double at = ray.origin[k] + double(hit.t) * ray.direction[k];
      const double room = double(s.position_error[k]) + 0x1p-22 * (std::abs(ray.origin[k]) + reach);
      if (!(std::abs(at - s.position[k]) <= room))
        return fail(tally_.untrue, i,
                    fmt::format("the position at {} is {:g} from the ray along {}, the error is {:g}", hit.t,
                                at - s.position[k], "xyz"[k], s.position_error[k]));
    }
  }

  /// The hits of the scene are those of its parts.
  void compare_parts() {
    std::vector<Part> parts = parts_of(scene_);
    for (Part& part : parts) {
      part.closest.resize_uninitialized(rays_.size());
      closest_hit(*part.world.accel, rays_.span(), part.closest.span(), isa_);
      for (std::size_t i = 0; i < rays_.size(); ++i) part.in_instance |= part.closest[i].instance != kNoId;
      all_hits(*part.world.accel, rays_.span(), part.lists, isa_);
    }
    // Parts without items are no geometries, so that numbers do not tell which is which.
    const bool numbered =
        std::ranges::all_of(parts, [](const Part& part) { return stats(*part.world.accel).items > 0; });
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      compare_first(parts, i, numbered);
      compare_lists(parts, i);
      for (const Part& part : parts)
        if (part.known) compare_truth(part, i);
    }
  }

  void compare_first(const std::vector<Part>& parts, std::size_t i, bool numbered) {
    const Hit hit = closest_[i];
    float nearest = HUGE_VALF;
    for (const Part& part : parts)
      if (part.closest[i].valid()) nearest = std::min(nearest, part.closest[i].t);
    const Part* first = nullptr;
    bool same = false, plain = true;
    for (const Part& part : parts) {
      const Hit own = part.closest[i];
      if (!own.valid() || own.t != nearest) continue;
      same |= place(own) == place(hit);
      plain &= own.instance == kNoId;
      if (first == nullptr) first = &part;
    }
    if (first == nullptr ? hit.valid() : !hit.valid() || !same)
      return fail(tally_.apart, i,
                  fmt::format("the closest hit is at {}, but that of all objects at {}", hit.t, nearest));
    // Of hits at the same place the first geometry counts; those in instances have numbers of their own.
    if (first == nullptr || !numbered || !plain) return;
    const auto expected = static_cast<std::size_t>(first - parts.data());
    if (const std::size_t found = identify(*world_.accel, hit).geometry; found != expected)
      fail(tally_.apart, i, fmt::format("the closest hit is of geometry {}, not {}", found, expected));
  }

  void compare_lists(const std::vector<Part>& parts, std::size_t i) {
    std::vector<std::tuple<float, float, float>> together, apart;
    for (const Hit& hit : lists_.of_ray(i)) together.push_back(place(hit));
    for (const Part& part : parts)
      for (const Hit& hit : part.lists.of_ray(i)) apart.push_back(place(hit));
    std::ranges::sort(together), std::ranges::sort(apart);
    if (together != apart)
      fail(tally_.apart, i,
           fmt::format("all_hits lists {} hits, those of the objects are {}", together.size(), apart.size()));
  }

  void compare_truth(const Part& part, std::size_t i) {
    const Hit hit = part.closest[i];
    const bool sampled = i % kSampledRays == 0;
    if (!hit.valid() && !sampled) return;
    ++tally_.compared;
    const AlongRay f(part.known->truth, part.to_own, rays_[i], part.in_instance);
    const std::string& name = scene_.objects[part.first].name;
    if (hit.valid() && f.crosses(hit.t) == AlongRay::Crossing::no)
      fail(tally_.untrue, i, fmt::format("{} is hit at {} where nothing is", name, hit.t));
    if (!sampled) return;
    for (const long double t : f.crossings()) {
      const long double s = f.room(t);
      if (t <= rays_[i].tmin + s || t >= rays_[i].tmax - s) continue;
      if (!hit.valid() || hit.t > t + s)
        fail(tally_.untrue, i,
             fmt::format("{} is missed at {}, the hit is at {}", name, static_cast<double>(t), hit.t));
      return;
    }
  }

  const Scene& scene_;
  const RayBatch& rays_;
  const std::vector<Isa>& isas_;
  const Isa isa_;
  World world_;
  HitBatch closest_;
  HitLists lists_;
  InteractionBlock block_;
  bool exact_ = true;  ///< without textbook tests of triangles
  SceneTally tally_;
};

}  // namespace

void SceneTally::add(const SceneTally& o) {
  scenes += o.scenes, objects += o.objects, rays += o.rays, hits += o.hits, compared += o.compared;
  differing += o.differing, apart += o.apart, untrue += o.untrue;
  kinds.insert(o.kinds.begin(), o.kinds.end());
  if (failure.empty()) failure = o.failure, scene = o.scene;
}

SceneTally check_scene(const Scene& scene, const RayBatch& rays, const std::vector<Isa>& isas,
                       std::uint64_t turn) {
  return SceneChecker(scene, rays, isas, turn).run();
}

SceneTally verify_scenes(std::uint64_t count, const std::vector<Isa>& isas, std::uint64_t first) {
  std::vector<SceneTally> tallies(count);
  tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t k) {
    const Scene scene = draw_scene(first + k);
    tallies[k] = check_scene(scene, draw_rays(scene, first + k), isas, first + k);
    tallies[k].scene = first + k;
    if (!tallies[k].failure.empty())
      tallies[k].failure = fmt::format("scene {}: {}", first + k, tallies[k].failure);
  });
  SceneTally sum;
  for (const SceneTally& tally : tallies) sum.add(tally);
  return sum;
}

}  // namespace oktett
