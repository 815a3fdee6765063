#include "verify/checks/trace_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>

#include "accel/time/instance_motion.h"
#include "accel/time/scene_data.h"
#include "core/random.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/kernels.h"
#include "verify/checks/run_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kTimes = 5, kRaysAtOnce = 16;

// ---- Filters that judge by the numbers of a hit.

/// A question that a filter was asked.
using Question =
    std::tuple<const HitFilter*, std::vector<std::uint32_t>, std::uint32_t, std::uint32_t, float>;

Question question(const HitFilter* filter, const SceneHit& hit) {
  std::vector<std::uint32_t> chain;
  for (std::uint32_t k = 0; k < hit.chain.count; ++k)
    chain.push_back(hit.chain.geometry[k]), chain.push_back(hit.chain.primitive[k]);
  return {filter, chain, hit.geometry, hit.primitive, hit.t};
}

class NumberFilter final : public HitFilter {
 public:
  enum Rule { everything, odd_primitives, nothing, some_distances, ends, changes };
  explicit NumberFilter(Rule rule) : rule_(rule) {}

  /// Whether it accepts a hit, which it may change.
  bool accepts(SceneHit& hit) const {
    switch (rule_) {
      case odd_primitives:
        return hit.primitive % 2 != 0;
      case nothing:
        return false;
      case some_distances:
        return (std::bit_cast<std::uint32_t>(hit.t) >> 3 & 1) != 0;
      case ends:
        if (hit.geometry % 2 == 0) hit.geometry = kNoId;
        return true;
      case changes:
        hit.u = 1 - hit.u, hit.v = 7, hit.normal = -hit.normal;
        return true;
      default:
        return true;
    }
  }
  std::size_t judge(const Ray&, const RayContext& context, std::span<SceneHit> hits) const override {
    for (std::size_t k = 0; k < hits.size(); ++k) {
      if (hits[k].valid() && context.user != nullptr)
        static_cast<std::vector<Question>*>(context.user)->push_back(question(this, hits[k]));
      if (accepts(hits[k])) return k;
    }
    return hits.size();
  }

 private:
  Rule rule_;
};

const NumberFilter kFilters[] = {
    NumberFilter(NumberFilter::everything), NumberFilter(NumberFilter::odd_primitives),
    NumberFilter(NumberFilter::nothing),    NumberFilter(NumberFilter::some_distances),
    NumberFilter(NumberFilter::ends),       NumberFilter(NumberFilter::changes)};

// ---- Time, as accel/trace_scene.h states it.

struct Moment {
  std::uint32_t key = 0;
  float f = 0;

  Moment(float time, std::uint32_t keys) {
    const float clamped = std::isnan(time) || time < 0 ? 0 : std::min(time, 1.0f);
    if (keys < 2) return;
    const float at = clamped * static_cast<float>(keys - 1);
    key = std::min(static_cast<std::uint32_t>(std::floor(at)), keys - 2);
    f = at - static_cast<float>(key);
  }
};

// ---- A shape of the program: spheres that move.

class MovingSpheres final : public UserShape {
 public:
  std::vector<std::vector<Vec3d>> centers;  ///< by key
  double radius = 0.3;

  std::uint32_t primitive_count() const override { return static_cast<std::uint32_t>(centers[0].size()); }
  std::uint32_t key_count() const override { return static_cast<std::uint32_t>(centers.size()); }
  Box bounds(std::uint32_t primitive, std::uint32_t key) const override {
    const Vec3d& c = centers[key][primitive];
    const double r = radius * 1.001;
    return {round_down(c - Vec3d{r, r, r}), round_up(c + Vec3d{r, r, r})};
  }
  bool closest_hit(std::uint32_t primitive, const Ray& ray, const RayContext& context,
                   SceneHit& hit) const override {
    const Moment m(context.time, key_count());
    const std::size_t next = std::min<std::size_t>(m.key + 1, centers.size() - 1);
    const double f = static_cast<double>(m.f);
    const Vec3d c = centers[m.key][primitive] * (1 - f) + centers[next][primitive] * f;
    const Vec3d o = Vec3d(ray.origin) - c, d(ray.direction);
    const double a = dot(d, d), b = dot(o, d), q = b * b - a * (dot(o, o) - radius * radius);
    if (!(q > 0)) return false;
    for (const double root : {(-b - std::sqrt(q)) / a, (-b + std::sqrt(q)) / a}) {
      const float t = static_cast<float>(root);
      if (!(ray.tmin < t && t <= ray.tmax)) continue;
      hit.t = t, hit.u = static_cast<float>(primitive), hit.v = m.f;
      hit.normal = Vec3f(o + d * root);
      return true;
    }
    return false;
  }
};

// ---- One geometry alone.

/// A geometry where one chain of instances shows it, at a moment.
struct ScenePart {
  const SceneGeometry* geometry;
  std::vector<const SceneGeometry*> instances;
  InstanceChain chain;
  std::vector<Affine> maps;  ///< of the chain, the outermost first
  /// What decides among equal distances: of each level, whether it is an instance, which geometry, which of
  /// an array.
  std::vector<std::uint32_t> order;
  std::shared_ptr<const TriangleMesh> mesh;  ///< of a moving mesh
  std::shared_ptr<const Accel> accel;        ///< null for a shape of the program
};

/// Something that a ray may meet, and its place among what is equally far.
struct Candidate {
  SceneHit hit;
  std::vector<std::uint32_t> order;
  const ScenePart* part;
};

class Parts {
 public:
  Parts(const TraceScene& scene, float time) : time_(time) { list(scene, ScenePart{}); }
  std::vector<ScenePart> parts;

 private:
  void list(const TraceScene& scene, const ScenePart& outer) {
    for (std::uint32_t g = 0; g < scene.geometries.size(); ++g) {
      const SceneGeometry& own = scene.geometries[g];
      const auto enter = [&](std::uint32_t index, const TraceScene& child, const Affine& map) {
        ScenePart inner = outer;
        inner.instances.push_back(&own), inner.chain.push(own.number, index), inner.maps.push_back(map);
        inner.order.insert(inner.order.end(), {1, g, index});
        list(child, inner);
      };
      if (const auto* const one = std::get_if<SceneInstance>(&own.shape)) {
        enter(0, *one->child, map_of(*one));
      } else if (const auto* const many = std::get_if<SceneInstances>(&own.shape)) {
        for (std::uint32_t k = 0; k < many->places.size(); ++k)
          enter(k, *many->children[many->places[k].child], many->places[k].transform);
      } else {
        ScenePart part = outer;
        part.geometry = &own;
        build(part);
        const auto* const fixed = std::get_if<Geometry>(&own.shape);
        part.order.insert(part.order.end(), {fixed != nullptr && stands_apart(*fixed), g});
        parts.push_back(std::move(part));
      }
    }
  }

  Affine map_of(const SceneInstance& instance) const {
    const auto keys = static_cast<std::uint32_t>(instance.turning.empty() ? instance.transforms.size()
                                                                          : instance.turning.size());
    const Moment m(time_, keys);
    if (!instance.turning.empty()) return map_at(instance, {m.key, m.f});
    if (keys == 1) return instance.transforms[0];
    Affine map;
    for (std::size_t k = 0; k < 12; ++k) {
      const double f = static_cast<double>(m.f);
      map.m[k / 4][k % 4] = (1 - f) * instance.transforms[m.key].m[k / 4][k % 4] +
                            f * instance.transforms[m.key + 1].m[k / 4][k % 4];
    }
    return map;
  }

  static bool stands_apart(const Geometry& g) {
    return std::holds_alternative<CsgGeometry>(g.shape) ||
           (std::holds_alternative<SpheresShape>(g.shape) && g.transform.uniform_scale() == 0);
  }

  void build(ScenePart& part) const {
    const auto& shape = part.geometry->shape;
    if (const auto* const fixed = std::get_if<Geometry>(&shape)) part.accel = build_accel({*fixed});
    const auto* const moving = std::get_if<MovingMesh>(&shape);
    if (moving == nullptr) return;
    const Moment m(time_, static_cast<std::uint32_t>(1 + moving->later_positions.size()));
    auto mesh = std::make_shared<TriangleMesh>(*moving->mesh);
    const Column<Vec3f>& a = m.key == 0 ? moving->mesh->positions : moving->later_positions[m.key - 1];
    const Column<Vec3f>& b = moving->later_positions[m.key];
    for (std::size_t i = 0; i < a.size(); ++i)
      for (int k = 0; k < 3; ++k) mesh->positions[i][k] = (1 - m.f) * a[i][k] + m.f * b[i][k];
    part.accel = build_accel({{MeshGeometry{mesh.get()}, {}, kNoId}});
    part.mesh = std::move(mesh);
  }

  float time_;
};

/// The corners of a triangle, moved as those of meshes are.
Vec3f normal_of(const TriangleMesh& mesh, const Affine& transform, std::uint32_t triangle) {
  Vec3f p[3];
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = Vec3f(transform.point(Vec3d(mesh.positions[mesh.indices[3 * triangle + k]])));
  return cross(p[1] - p[0], p[2] - p[0]);
}

/// All that a ray meets of a part.
void meet(const ScenePart& part, Ray ray, const RayContext& context, std::vector<Candidate>& all) {
  for (const Affine& map : part.maps) {
    const Affine inverse = map.inverse();
    if (!map.is_invertible(inverse)) return;
    ray.origin = Vec3f(inverse.point(Vec3d(ray.origin)));
    ray.direction = Vec3f(inverse.vector(Vec3d(ray.direction)));
  }
  const SceneGeometry& g = *part.geometry;
  const auto add = [&](const SceneHit& hit, std::uint32_t primitive) {
    std::vector<std::uint32_t> order = part.order;
    order.push_back(primitive);
    all.push_back({hit, std::move(order), &part});
  };
  SceneHit hit;
  hit.chain = part.chain, hit.geometry = g.number;
  if (part.accel == nullptr) {
    const UserShape& shape = *std::get<std::shared_ptr<const UserShape>>(g.shape);
    for (std::uint32_t k = 0; k < shape.primitive_count(); ++k) {
      hit.primitive = k;
      if (shape.closest_hit(k, ray, context, hit)) add(hit, k);
    }
    return;
  }
  std::vector<Hit> hits;
  all_hits(*part.accel, ray, hits, Isa::scalar);
  for (const Hit& h : hits) {
    const auto* const fixed = std::get_if<Geometry>(&g.shape);
    const SurfaceInteraction s = surface_interaction(*part.accel, ray, h);
    const bool combined = fixed != nullptr && std::holds_alternative<CsgGeometry>(fixed->shape);
    hit.t = h.t, hit.u = h.u, hit.v = h.v, hit.normal = s.geometric_normal;
    const std::uint32_t primitive = combined ? 0 : s.primitive;
    hit.primitive = primitive;
    if (part.mesh != nullptr)
      hit.normal = normal_of(*part.mesh, {}, primitive);
    else if (const auto* const mesh = std::get_if<MeshGeometry>(&fixed->shape))
      hit.normal = normal_of(*mesh->mesh, fixed->transform, primitive);
    if (g.faces != nullptr) g.faces->to_face(hit.primitive, hit.u, hit.v);
    add(hit, primitive);
  }
}

// ---- One random scene.

bool same_hit(const SceneHit& a, const SceneHit& b) {
  return std::bit_cast<std::uint32_t>(a.t) == std::bit_cast<std::uint32_t>(b.t) && a.u == b.u && a.v == b.v &&
         a.normal == b.normal && question(nullptr, a) == question(nullptr, b);
}

class RandomScene {
 public:
  RandomScene(std::uint64_t number, const std::vector<Isa>& isas, TraceScenesTally& tally)
      : random_(mix_bits(number)), isas_(isas), tally_(tally) {}

  void run() {
    ++tally_.scenes;
    const std::shared_ptr<const TraceScene> scene = draw_scene(pick(0, 3));
    for (int k = 0; k < kTimes && tally_.wrong() == 0; ++k) look(*scene, draw_time());
  }

 private:
  int pick(int lo, int hi) { return lo + static_cast<int>(random_.unit() * (hi - lo + 1)); }
  bool chance(double part) { return random_.unit() < part; }

  void fail(std::uint64_t& count, const std::string& what) {
    ++count;
    if (tally_.failure.empty()) tally_.failure = what;
  }

  // ---- What stands in it.

  static const std::shared_ptr<const TriangleMesh>& draw_mesh(int which) {
    const auto shared = [](const OracleMesh& m) { return std::make_shared<const TriangleMesh>(m.mesh); };
    static const std::shared_ptr<const TriangleMesh> meshes[] = {
        shared(make_cube()), shared(make_icosphere(1)), shared(make_torus(12, 8)), shared(make_globe(7, 5))};
    return meshes[which];
  }

  /// Turns by less than a third of a turn, so that no two are opposite.
  Affine draw_map() {
    Affine map = Affine::translation(random_.vector() * 2.0);
    if (chance(0.7)) map = map * Affine::rotation(random_.vector() * 50.0);
    if (chance(0.3)) map = map * Affine::scaling(Vec3d{1, 1, 1} * random_.magnitude(-0.5, 0.5));
    if (chance(0.2)) map = map * Affine::scaling({1.5, 0.5, 1});
    return map;
  }

  Geometry draw_fixed() {
    Geometry g;
    if (chance(0.7)) g.transform = draw_map();
    if (chance(0.1)) g.transform = g.transform * Affine::scaling({1, -1, 1});
    SpheresShape spheres;
    for (int i = pick(1, 5); i > 0; --i) spheres.spheres.push_back({random_.vector(), 0.2 + random_.unit()});
    switch (pick(0, 6)) {
      case 0:
      case 1:
        g.shape = std::move(spheres);
        break;
      case 2:
        g.shape = ExactShape{TorusShape{}};
        break;
      case 3:
        g.shape = BoxShape{};
        break;
      case 4: {
        auto dented = std::make_shared<CsgExpression>();
        dented->op = CsgOp::subtract, dented->children.resize(2);
        dented->children[0].solids = {{BoxShape{}, {}, 5}};
        dented->children[1].solids = {{std::move(spheres), {}, 6}};
        g.shape = CsgGeometry{std::move(dented)};
        break;
      }
      default:
        g.shape = MeshGeometry{draw_mesh(pick(0, 3)).get()};
    }
    return g;
  }

  MovingMesh draw_moving() {
    MovingMesh moving{draw_mesh(pick(0, 3)), {}};
    const bool stands = chance(0.3);
    for (int k = pick(1, 4); k > 0; --k) {
      Column<Vec3f>& later = moving.later_positions.emplace_back(moving.mesh->positions);
      const Affine map = draw_map();
      if (!stands)
        for (Vec3f& p : later) p = Vec3f(map.point(Vec3d(p)) + random_.vector() * 0.2);
    }
    return moving;
  }

  std::shared_ptr<const UserShape> draw_spheres() {
    auto spheres = std::make_shared<MovingSpheres>();
    spheres->centers.resize(static_cast<std::size_t>(pick(1, 3)));
    const int count = pick(1, 5);
    for (auto& centers : spheres->centers)
      for (int i = 0; i < count; ++i) centers.push_back(random_.vector());
    return spheres;
  }

  SceneInstance draw_instance(int levels) {
    SceneInstance instance{draw_scene(levels - 1), {}, {}};
    const int keys = std::max(1, pick(-1, 4));
    for (int k = 0; k < keys; ++k) instance.transforms.push_back(chance(0.2) ? Affine{} : draw_map());
    if (chance(0.6)) return instance;
    for (int k = 0; k < keys; ++k) {
      TurningMap& map = instance.turning.emplace_back();
      for (double& x : map.quaternion) x = random_.sign();
      map.outer = random_.vector() * 2.0;
      map.inner = Affine::translation(random_.vector() * 0.5) * Affine::scaling({1, 0.5 + random_.unit(), 1});
    }
    return instance;
  }

  SceneInstances draw_instances(int levels) {
    SceneInstances many;
    for (int k = pick(1, 2); k > 0; --k) many.children.push_back(draw_scene(levels - 1));
    for (int k = pick(1, 4); k > 0; --k)
      many.places.push_back(
          {draw_map(), static_cast<std::uint32_t>(pick(0, static_cast<int>(many.children.size()) - 1))});
    return many;
  }

  void draw_judges(SceneGeometry& g) {
    g.mask = chance(0.6) ? ~0u : static_cast<std::uint32_t>(random_.bits() & 7);
    if (chance(0.3)) g.closest_filter = &kFilters[pick(0, 5)];
    if (chance(0.3)) g.any_filter = &kFilters[pick(0, 5)];
    if (chance(0.2)) g.faces = std::make_shared<QuadFaces>();
  }

  SceneGeometry draw_geometry(const std::vector<SceneGeometry>& others, int levels) {
    SceneGeometry g;
    if (!others.empty() && chance(0.25)) {
      // What coincides with another.
      g.shape = others[random_.bits() % others.size()].shape;
    } else if (levels > 0 && chance(0.35)) {
      g.shape = draw_instance(levels);
    } else if (levels > 0 && chance(0.25)) {
      g.shape = draw_instances(levels);
    } else if (chance(0.4)) {
      g.shape = draw_fixed();
    } else if (chance(0.6)) {
      g.shape = draw_moving();
    } else {
      g.shape = draw_spheres();
    }
    return g;
  }

  std::shared_ptr<const TraceScene> draw_scene(int levels) {
    std::vector<SceneGeometry> all;
    const bool judges = chance(0.6);
    for (int i = pick(1, 4); i > 0; --i) {
      SceneGeometry g = draw_geometry(all, levels);
      g.number = static_cast<std::uint32_t>(i) * 3 + static_cast<std::uint32_t>(pick(0, 2));
      if (judges) draw_judges(g);
      all.push_back(std::move(g));
    }
    constexpr BuildQuality qualities[] = {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best,
                                          BuildQuality::compact};
    return build_trace_scene(std::move(all), {.quality = qualities[pick(0, 3)]});
  }

  // ---- What rays meet.

  float draw_time() {
    constexpr float known[] = {0, 1, 0.5f, 0.25f, -3, 7, std::numeric_limits<float>::quiet_NaN()};
    return chance(0.4) ? static_cast<float>(random_.unit()) : known[pick(0, 6)];
  }

  Ray draw_ray(const std::vector<ScenePart>& parts) {
    Vec3d target = random_.vector() * 2.0;
    const ScenePart& part = parts[random_.bits() % parts.size()];
    if (chance(0.6)) {
      target = random_.vector();
      if (part.mesh != nullptr && chance(0.5))
        target = Vec3d(part.mesh->positions[random_.bits() % part.mesh->positions.size()]);
      for (std::size_t k = part.maps.size(); k-- > 0;) target = part.maps[k].point(target);
    }
    const Vec3d from = random_.vector() * 6.0;
    return {Vec3f(from), chance(0.2) ? 0.3f : 0, Vec3f(target - from), chance(0.3) ? 1.1f : kInf};
  }

  static bool is_seen(const ScenePart& part, std::uint32_t mask) {
    return (part.geometry->mask & mask) != 0 &&
           std::ranges::all_of(part.instances, [&](const auto* g) { return (g->mask & mask) != 0; });
  }

  /// Whether the filters let a candidate pass; they may change it.
  static bool passes(SceneHit& hit, const HitFilter* own, const HitFilter* asked) {
    for (const HitFilter* filter : {own, asked})
      if (filter != nullptr && !static_cast<const NumberFilter*>(filter)->accepts(hit)) return false;
    return true;
  }

  void look(const TraceScene& scene, float time) {
    const Parts all(scene, time);
    tally_.parts += all.parts.size();
    if (all.parts.empty()) return;
    std::vector<Ray> rays;
    std::vector<RayContext> contexts;
    std::vector<SceneHit> expected;
    std::vector<int> blocked;  // 1: yes, 0: no, 2: either
    for (int i = 0; i < kRaysAtOnce; ++i) {
      rays.push_back(draw_ray(all.parts));
      RayContext& context = contexts.emplace_back();
      context.time = time;
      if (chance(0.4)) context.mask = static_cast<std::uint32_t>(random_.bits() & 7);
      if (chance(0.3)) context.filter = &kFilters[pick(0, 5)];
      std::vector<Candidate> met;
      for (const ScenePart& part : all.parts)
        if (is_seen(part, context.mask)) meet(part, rays.back(), context, met);
      std::ranges::stable_sort(met, [](const Candidate& a, const Candidate& b) {
        return a.hit.t != b.hit.t ? a.hit.t < b.hit.t : a.order < b.order;
      });
      expected.push_back(nearest(met, context));
      blocked.push_back(is_blocked(met, context));
      ask(scene, rays.back(), context, met);
    }
    compare(scene, rays, contexts, expected, blocked);
  }

  static SceneHit nearest(const std::vector<Candidate>& met, const RayContext& context) {
    for (const Candidate& c : met) {
      SceneHit hit = c.hit;
      if (passes(hit, c.part->geometry->closest_filter, context.filter))
        return hit.valid() ? hit : SceneHit{};
    }
    return {};
  }

  static int is_blocked(const std::vector<Candidate>& met, const RayContext& context) {
    bool hits = false, ends = false;
    for (const Candidate& c : met) {
      SceneHit hit = c.hit;
      if (passes(hit, c.part->geometry->any_filter, context.filter)) (hit.valid() ? hits : ends) = true;
    }
    return hits && ends ? 2 : hits;
  }

  /// No filter is asked twice, nor about what there is not.
  void ask(const TraceScene& scene, const Ray& ray, RayContext context, const std::vector<Candidate>& met) {
    std::vector<Question> asked, may_ask;
    context.user = &asked;
    closest_hit(scene, ray, context, isas_.back());
    any_hit(scene, ray, context, isas_.back());
    for (const Candidate& c : met) {
      const SceneGeometry& g = *c.part->geometry;
      for (const HitFilter* filter : {g.closest_filter, g.any_filter})
        if (filter != nullptr) may_ask.push_back(question(filter, c.hit));
      for (const HitFilter* filter : {context.filter, context.filter})
        if (filter != nullptr) may_ask.push_back(question(filter, c.hit));
    }
    tally_.judged += asked.size();
    std::ranges::sort(asked), std::ranges::sort(may_ask);
    if (!std::ranges::includes(may_ask, asked))
      fail(tally_.misjudged, "a filter is asked about what is no hit, or twice; ray " + exact_text(ray));
  }

  void compare(const TraceScene& scene, const std::vector<Ray>& rays, const std::vector<RayContext>& contexts,
               const std::vector<SceneHit>& expected, const std::vector<int>& blocked) {
    tally_.rays += rays.size();
    for (const SceneHit& hit : expected) tally_.hits += hit.valid();
    std::vector<SceneHit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    for (const Isa isa : isas_) {
      closest_hit(scene, rays, contexts, hits, isa);
      any_hit(scene, rays, contexts, occluded, isa);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!same_hit(hits[i], expected[i]))
          return fail(
              tally_.differing,
              fmt::format("{}: time {}, t {} of geometry {}, primitive {}; expected t {} of {}, {}; "
                          "ray {}",
                          to_string(isa), contexts[i].time, hits[i].t, hits[i].geometry, hits[i].primitive,
                          expected[i].t, expected[i].geometry, expected[i].primitive, exact_text(rays[i])));
        if (blocked[i] != 2 && occluded[i] != blocked[i])
          return fail(tally_.differing,
                      fmt::format("{}: time {}, any hit {}, expected {}; ray {}", to_string(isa),
                                  contexts[i].time, occluded[i], blocked[i], exact_text(rays[i])));
      }
    }
  }

  CaseRandom random_;
  const std::vector<Isa>& isas_;
  TraceScenesTally& tally_;
};

void add(TraceScenesTally& sum, const TraceScenesTally& t) {
  sum.scenes += t.scenes, sum.rays += t.rays, sum.hits += t.hits, sum.parts += t.parts;
  sum.judged += t.judged, sum.differing += t.differing, sum.misjudged += t.misjudged;
  if (sum.failure.empty()) sum.failure = t.failure, sum.scene = t.scene;
}

}  // namespace

TraceScenesTally verify_trace_scenes(std::uint64_t count, const std::vector<Isa>& isas, std::uint64_t first) {
  return run_cases(
      count, first, &TraceScenesTally::scene, "scene",
      [&](TraceScenesTally& tally) { RandomScene(tally.scene, isas, tally).run(); }, add);
}

}  // namespace oktett
