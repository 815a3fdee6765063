#include "accel/trace_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "accel/accel_data.h"
#include "accel/batch_pieces.h"
#include "accel/code.h"
#include "accel/hit_place.h"
#include "accel/hit_sink.h"
#include "accel/time/instance_motion.h"
#include "accel/time/scene_data.h"
#include "core/error.h"

namespace oktett {

HitFilter::~HitFilter() = default;
UserShape::~UserShape() = default;
FaceMap::~FaceMap() = default;

void QuadFaces::to_face(std::uint32_t& primitive, float& u, float& v) const {
  if (primitive % 2 != 0) u = 1 - u, v = 1 - v;
  primitive /= 2;
}

namespace {

/// A hit with what decides among equal distances.
struct PlacedHit {
  SceneHit hit;
  std::uint32_t place = kNoId;  ///< of the outermost geometry in the scene; kNoId: there is no hit
  bool is_inside = false;       ///< of an instance or of what stands in a structure of its own
};

/// Whether `a` counts rather than `b`, in the order of an Accel.
bool is_before(const PlacedHit& a, const PlacedHit& b) {
  if (b.place == kNoId) return true;
  if (a.hit.t != b.hit.t) return a.hit.t < b.hit.t;
  return a.is_inside != b.is_inside ? b.is_inside : a.place < b.place;
}

void name_face(SceneHit& hit, const SceneGeometry& geometry, std::uint32_t primitive) {
  hit.geometry = geometry.number, hit.primitive = primitive, hit.user = geometry.user;
  if (geometry.faces != nullptr) geometry.faces->to_face(hit.primitive, hit.u, hit.v);
}

// ---- Hits in what does not move.

/// A hit in the fixed structure of a scene, named, and seen from the innermost scene.
struct NamedHit {
  PlacedHit placed;  ///< all but the normal
  const TraceScene* scene;
  const SceneGeometry* geometry;
  Ray ray;                  ///< in the innermost scene, as its own structure traced it
  HitWithNormal own;        ///< in the fixed structure of the innermost scene
  std::uint32_t primitive;  ///< in the geometry, before faces are named
  bool is_seen = true;      ///< by the masks of the geometry and of all instances

  /// Sets the normal.
  void complete() {
    const auto& shape = std::get<Geometry>(geometry->shape);
    if (own.has_normal && shape.transform.is_identity()) {
      placed.hit.normal = own.normal;
      return;
    }
    if (own.instance == kNoId) {
      const Column<Vec3f>& normals = scene->fixed_geometries[scene->fixed->geometry_of(own.item)].normals;
      if (!normals.empty()) {
        placed.hit.normal = normals[primitive];
        return;
      }
    }
    if (const auto* const mesh = std::get_if<MeshGeometry>(&shape.shape)) {
      const TriangleMesh& own_mesh = *mesh->mesh;
      const auto corner = [&](std::size_t k) {
        return own_mesh.positions[own_mesh.indices[3 * std::size_t{primitive} + k]];
      };
      std::array<Vec3f, 3> corners{corner(0), corner(1), corner(2)};
      if (!shape.transform.is_identity()) corners = *triangle_corners(*scene->fixed, own);
      placed.hit.normal = triangle_normal(corners[0], corners[1], corners[2]);
    } else {
      placed.hit.normal = surface_interaction(*scene->fixed, ray, own).geometric_normal;
    }
  }
};

NamedHit name_hit(const TraceScene& scene, const Ray& ray, std::uint32_t mask, const InstanceChain& chain,
                  const HitWithNormal& hit) {
  NamedHit n;
  n.scene = &scene, n.ray = ray, n.own = hit;
  n.placed.hit.chain = chain;
  n.placed.is_inside = hit.instance != kNoId;
  for (;;) {
    const Accel& accel = *n.scene->fixed;
    std::optional<ChainLink> link;
    if (n.own.instance != kNoId) link = outermost_link(accel, n.own.instance);
    const std::uint32_t geometry = link ? link->geometry : accel.geometry_of(n.own.item);
    const ItemTable::Place place = n.scene->fixed_geometries[geometry].place;
    if (n.placed.place == kNoId) n.placed.place = place.geometry;
    n.geometry = &n.scene->geometries[place.geometry];
    n.is_seen &= (n.geometry->mask & mask) != 0;
    // A chain may also lead into a combination, or to the only geometry of a structure: SceneGeometry::tree,
    // or spheres that their transform distorts.
    if (std::holds_alternative<Geometry>(n.geometry->shape)) {
      n.primitive = !link ? n.own.item - accel.first_item[geometry] : link->is_combination ? 0 : n.own.item;
      break;
    }
    n.placed.hit.chain.push(n.geometry->number, place.primitive);
    n.ray = moved_ray(accel.frames[geometry].inverse, n.ray);
    n.own.instance = link->rest;
    n.scene = &n.scene->child(place.geometry, place.primitive);
  }
  SceneHit& out = n.placed.hit;
  out.t = hit.t, out.u = hit.u, out.v = hit.v;
  name_face(out, *n.geometry, n.primitive);
  return n;
}

bool same_chain(const InstanceChain& a, const InstanceChain& b) {
  return a.count == b.count && std::equal(a.geometry, a.geometry + a.count, b.geometry) &&
         std::equal(a.primitive, a.primitive + a.count, b.primitive);
}

// ---- One ray.

template <Query Q>
class SceneTracer {
 public:
  SceneTracer(const TraceScene& scene, const RayContext& context, const InstanceChain& chain, Isa isa)
      : scene_(scene), context_(context), chain_(chain), isa_(isa) {
    filters_ = context.filter != nullptr ||
               (Q == Query::closest ? scene.has_closest_filters : scene.has_any_filters);
    judges_ = scene.has_masks || filters_;
  }

  /// What the ray hits, with a place if anything; for Query::any no more than that it does. Where a filter
  /// ends the ray, there is a place without a geometry.
  const PlacedHit& run(const Ray& ray) {
    if (context_.mask == 0) return best_;
    ray_ = ray;
    if (scene_.fixed->stats.items > 0) fixed();
    for (const MovingPart& part : scene_.moving) {
      if (Q == Query::any && best_.place != kNoId) break;
      moving(part);
    }
    return best_;
  }

 private:
  // ---- Filters.

  static const HitFilter* filter_of(const SceneGeometry& geometry) {
    return Q == Query::closest ? geometry.closest_filter : geometry.any_filter;
  }

  /// The one of these hits with a geometry, in their order, that its filter and that of the query accept;
  /// null if there is none. Where the ray ends without a hit, it has no geometry.
  const SceneHit* judge(const SceneGeometry& geometry, const Ray& ray, std::span<SceneHit> hits) {
    const HitFilter* const own = filter_of(geometry);
    while (!hits.empty()) {
      std::size_t accepted = own != nullptr ? own->judge(ray, context_, hits) : 0;
      if (accepted < hits.size() && context_.filter != nullptr) {
        const std::size_t also = context_.filter->judge(ray, context_, hits.subspan(accepted, 1));
        if (also != 0) {
          hits = hits.subspan(accepted + 1);
          continue;
        }
      }
      return accepted < hits.size() ? &hits[accepted] : nullptr;
    }
    return nullptr;
  }

  // ---- What does not move.

  void fixed() {
    if (Q == Query::any && !judges_) {
      if (!any_hit(*scene_.fixed, ray_, isa_)) return;
      best_.hit.geometry = best_.place = 0;
      best_.hit.t = ray_.tmax;
      return;
    }
    if (judges_ && scene_.has_simple_hits) {
      OnTheWay judge(*this);
      const TraceCode& code = trace_code(isa_);
      (Q == Query::closest ? code.judge_closest_hit : code.judge_any_hit)(*scene_.fixed, ray_, judge);
      return;
    }
    const HitWithNormal first = trace_code(isa_).closest_hit_with_normal(*scene_.fixed, ray_);
    if (!first.valid()) return;
    NamedHit named = name_hit(scene_, ray_, context_.mask, chain_, first);
    if (!judges_) {
      if (Q == Query::closest) named.complete();
      best_ = named.placed;
      return;
    }
    if (decide(named)) return;
    // Crossings of one surface may depend on each other, so all are found at once.
    std::vector<Hit> hits;
    all_hits(*scene_.fixed, ray_, hits, isa_);
    const auto is_rest = [&](const Hit& hit) {
      return hit.t > first.t || (hit.t == first.t && !(hit == static_cast<const Hit&>(first)));
    };
    decide_in_order(std::span(hits).subspan(
        static_cast<std::size_t>(std::find_if(hits.begin(), hits.end(), is_rest) - hits.begin())));
  }

  /// Judges hits while the ray is on its way.
  class OnTheWay final : public HitJudge {
   public:
    explicit OnTheWay(SceneTracer& tracer) : tracer_(tracer) { nearest_.t = tracer.ray_.tmax; }
    bool offer(HitWithNormal* hits, int count) override {
      int left = 0;
      for (int i = 0; i < count; ++i)
        if (may_count(hits[i])) hits[left++] = hits[i];
      if (left > 1) std::sort(hits, hits + left, listed_before);
      const std::size_t accepted =
          tracer_.decide_in_order(std::span<const HitWithNormal>(hits, static_cast<std::size_t>(left)));
      if (tracer_.scene_.has_pieces) rejected_.insert(hits, hits + accepted);
      if (accepted == static_cast<std::size_t>(left)) return false;
      nearest_ = hits[accepted];
      nearest_.t = tracer_.best_.hit.t;
      return true;
    }
    float end() const override { return nearest_.t; }
    HitList& scratch() override { return list_; }

   private:
    /// Whether it is the nearest so far, and was not judged before: a triangle may stand in several leaves.
    bool may_count(const Hit& hit) const {
      if (nearest_.valid() ? !listed_before(hit, nearest_) : hit.t > nearest_.t) return false;
      return rejected_.empty() || !rejected_.contains(hit);
    }

    SceneTracer& tracer_;
    Hit nearest_;  ///< that counts
    std::vector<Crossing> crossings_;
    HitList list_{crossings_};
    std::set<Hit, decltype(&listed_before)> rejected_{listed_before};
  };

  /// Keeps the first hit that counts, of a list in order, and returns its number, or how many there are.
  template <class AnyHit>
  std::size_t decide_in_order(std::span<AnyHit> hits) {
    std::vector<NamedHit> group;
    for (std::size_t i = 0; i < hits.size();) {
      const std::size_t first = i;
      NamedHit named = name_hit(scene_, ray_, context_.mask, chain_, {hits[i++]});
      group.clear();
      for (; i < hits.size(); ++i) {
        const NamedHit more = name_hit(scene_, ray_, context_.mask, chain_, {hits[i]});
        if (more.geometry != named.geometry || !same_chain(more.placed.hit.chain, named.placed.hit.chain))
          break;
        if (group.empty()) group.push_back(named);
        group.push_back(more);
      }
      if (group.empty()) {
        if (decide(named)) return first;
      } else if (const std::size_t k = decide(group); k < group.size()) {
        return first + k;
      }
    }
    return hits.size();
  }

  /// Whether a hit counts, which is kept then.
  bool decide(NamedHit& named) {
    if (!named.is_seen) return false;
    if (Q == Query::closest || filters_) named.complete();
    const SceneHit* const accepted = judge(*named.geometry, named.ray, {&named.placed.hit, 1});
    if (accepted == nullptr) return false;
    best_ = named.placed;
    return true;
  }

  /// The same for several hits, all with one geometry in one chain, of which the first that counts is kept.
  /// Returns its number, or how many there are.
  std::size_t decide(std::span<NamedHit> group) {
    if (!group[0].is_seen) return group.size();
    std::vector<SceneHit> hits;
    for (NamedHit& named : group) {
      if (Q == Query::closest || filters_) named.complete();
      hits.push_back(named.placed.hit);
    }
    const SceneHit* const accepted = judge(*group[0].geometry, group[0].ray, hits);
    if (accepted == nullptr) return group.size();
    best_ = group[0].placed;
    best_.hit = *accepted;
    return static_cast<std::size_t>(accepted - hits.data());
  }

  // ---- What moves.

  void moving(const MovingPart& part) {
    if (!part.is_there(context_.time)) return;
    part_ = &part;
    own_time_ = part.own_time(context_.time);
    tested_item_ = kNoId;
    const TimeCalls calls{this, judges_ ? accept : nullptr, test};
    Ray ray = ray_;
    ray.tmax = std::min(ray.tmax, best_.hit.t);
    const TimeCode& code = time_code(isa_);
    const Hit hit =
        (Q == Query::closest ? code.closest_hit : code.any_hit)(*part.tree, ray, own_time_, calls);
    if (!hit.valid()) return;
    const ItemTable::Place place = part.items[hit.item];
    const PlacedHit found{hit.item == tested_item_ ? tested_ : name_triangle(place, hit), place.geometry,
                          is_instance(scene_.geometries[place.geometry])};
    if (is_before(found, best_)) best_ = found;
  }

  /// A hit of a triangle that moves.
  SceneHit name_triangle(const ItemTable::Place& place, const Hit& hit) const {
    const SceneGeometry& geometry = scene_.geometries[place.geometry];
    const auto& shape = std::get<MovingMesh>(geometry.shape);
    const KeyTime at = KeyTime::of(own_time_, 1 + static_cast<std::uint32_t>(shape.later_positions.size()));
    const Column<Vec3f>& a = at.key == 0 ? shape.mesh->positions : shape.later_positions[at.key - 1];
    const Column<Vec3f>& b = shape.later_positions[at.key];
    const auto corner = [&](std::size_t k) {
      const std::uint32_t i = shape.mesh->indices[3 * std::size_t{place.primitive} + k];
      return Vec3f{at.between(a[i].x, b[i].x), at.between(a[i].y, b[i].y), at.between(a[i].z, b[i].z)};
    };
    SceneHit out;
    out.chain = chain_;
    out.t = hit.t, out.u = hit.u, out.v = hit.v;
    out.normal = triangle_normal(corner(0), corner(1), corner(2));
    name_face(out, geometry, place.primitive);
    return out;
  }

  /// TimeCalls::accept.
  static bool accept(void* self, const Hit& hit) {
    SceneTracer& tracer = *static_cast<SceneTracer*>(self);
    const ItemTable::Place place = tracer.part_->items[hit.item];
    const SceneGeometry& geometry = tracer.scene_.geometries[place.geometry];
    if ((geometry.mask & tracer.context_.mask) == 0) return false;
    if (!tracer.filters_) return true;
    SceneHit candidate = tracer.name_triangle(place, hit);
    if (tracer.judge(geometry, tracer.ray_, {&candidate, 1}) == nullptr) return false;
    tracer.tested_ = candidate, tracer.tested_item_ = hit.item;
    return true;
  }

  /// TimeCalls::test.
  static bool test(void* self, std::uint32_t item, const Ray& ray, Hit& hit) {
    SceneTracer& tracer = *static_cast<SceneTracer*>(self);
    const ItemTable::Place place = tracer.part_->items[item];
    const SceneGeometry& geometry = tracer.scene_.geometries[place.geometry];
    if ((geometry.mask & tracer.context_.mask) == 0) return false;
    const auto* const shape = std::get_if<std::shared_ptr<const UserShape>>(&geometry.shape);
    SceneHit found;
    if (!(shape != nullptr ? tracer.ask(**shape, geometry, place.primitive, ray, found)
                           : tracer.enter(geometry, place, ray, found)))
      return false;
    if (found.t == ray.tmax && hit.valid() && item > hit.item) return false;
    tracer.tested_ = found, tracer.tested_item_ = item;
    hit.t = found.t, hit.u = found.u, hit.v = found.v;
    return true;
  }

  /// Asks a shape of the program.
  bool ask(const UserShape& shape, const SceneGeometry& geometry, std::uint32_t primitive, const Ray& ray,
           SceneHit& found) {
    RayContext context = context_;
    context.time = own_time_;
    for (Ray rest = ray;; rest.tmin = found.t) {
      found = {};
      found.chain = chain_;
      found.t = ray.tmax;
      found.geometry = geometry.number, found.primitive = primitive, found.user = geometry.user;
      if (!(Q == Query::closest ? shape.closest_hit(primitive, rest, context, found)
                                : shape.any_hit(primitive, rest, context, found)))
        return false;
      if (std::isnan(found.t)) return false;
      if (!shape.may_leave_range() && !(rest.tmin < found.t && found.t <= ray.tmax && std::isfinite(found.t)))
        return false;
      if (!filters_ || judge(geometry, ray, {&found, 1}) != nullptr) return true;
      if (!shape.has_several_hits()) return false;
    }
  }

  /// Enters a scene that an instance shows.
  bool enter(const SceneGeometry& geometry, const ItemTable::Place& place, const Ray& ray, SceneHit& found) {
    if (chain_.count == InstanceChain::kMost) return false;
    const Affine map = map_at(geometry, place.primitive, own_time_);
    const Affine to_child = map.inverse();
    if (!map.is_invertible(to_child)) return false;
    InstanceChain chain = chain_;
    chain.push(geometry.number, place.primitive);
    SceneTracer child(scene_.child(place.geometry, place.primitive), context_, chain, isa_);
    const PlacedHit& inner = child.run(moved_ray(to_child, ray));
    found = inner.hit;
    return inner.place != kNoId;
  }

  const TraceScene& scene_;
  const RayContext& context_;
  const InstanceChain& chain_;
  const Isa isa_;
  Ray ray_;
  bool filters_, judges_;
  PlacedHit best_;
  const MovingPart* part_ = nullptr;
  float own_time_ = 0;  ///< in it
  SceneHit tested_;     ///< the hit that a filter or a test let pass last, with item tested_item_
  std::uint32_t tested_item_ = kNoId;
};

const InstanceChain kNoChain{};

template <Query Q>
SceneHit trace(const TraceScene& scene, const Ray& ray, const RayContext& context, Isa isa) {
  SceneTracer<Q> tracer(scene, context, kNoChain, isa);
  const SceneHit& hit = tracer.run(ray).hit;
  if (hit.valid()) return hit;
  return {};
}

void check_sizes(std::size_t rays, std::size_t contexts, std::size_t answers, const char* query) {
  require_same_size(rays, answers, query);
  if (contexts != rays && contexts != 1)
    throw Error(std::string(query) + ": " + std::to_string(rays) + " rays, but " + std::to_string(contexts) +
                " contexts; expected one for each or one for all");
}

/// Whether the hits of a ray are those of the fixed structure alone, and nobody judges them.
template <Query Q>
bool is_plain(const TraceScene& scene, const RayContext& context) {
  return (Q == Query::closest ? scene.is_plain_closest : scene.is_plain_any) && context.mask != 0 &&
         context.filter == nullptr;
}
template <Query Q>
bool is_plain(const TraceScene& scene, std::span<const RayContext> contexts) {
  return std::all_of(contexts.begin(), contexts.end(),
                     [&](const RayContext& c) { return is_plain<Q>(scene, c); });
}

/// Names a hit of the fixed structure.
SceneHit plain_hit(const TraceScene& scene, const Ray& ray, const HitWithNormal& hit) {
  if (!hit.valid()) return {};
  if (hit.instance == kNoId) {
    const std::uint32_t g = scene.fixed->geometry_of(hit.item);
    const FixedGeometry& own = scene.fixed_geometries[g];
    if (!own.normals.empty()) {
      const std::uint32_t triangle = hit.item - scene.fixed->first_item[g];
      SceneHit out;
      out.t = hit.t, out.u = hit.u, out.v = hit.v;
      out.normal = hit.has_normal ? hit.normal : own.normals[triangle];
      name_face(out, scene.geometries[own.place.geometry], triangle);
      return out;
    }
  }
  NamedHit named = name_hit(scene, ray, ~0u, kNoChain, hit);
  named.complete();
  return named.placed.hit;
}

/// Calls f(i) for each ray, in parallel if there are many.
template <class Function>
void for_each_ray(std::size_t count, Function&& f) {
  const auto piece = [&](std::size_t k) {
    const std::size_t end = std::min(count, (k + 1) * kPieceRays);
    for (std::size_t i = k * kPieceRays; i < end; ++i) f(i);
  };
  if (count <= kPieceRays) return piece(0);
  for_each_task(piece_count(count), piece);
}

/// So few rays are traced faster one after the other than as a batch.
constexpr std::size_t kFewRays = 4;

/// The hits of rays, RaySpan or std::span<const Ray>, with what does not move.
template <class Rays>
void plain_hits(const TraceScene& scene, const Rays& rays, std::span<SceneHit> hits, Isa isa) {
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    static thread_local HitBatch found;
    found.resize_uninitialized(piece.size);
    closest_hit(*scene.fixed, piece, found.span(), isa);
    for (std::size_t i = 0; i < piece.size; ++i)
      hits[begin + i] = plain_hit(scene, rays[begin + i], {found[i]});
  });
}

void require_no_contexts(const TraceScene& scene, const char* query) {
  if (!needs_no_contexts(scene)) throw Error(std::string(query) + ": the scene needs contexts of the rays");
}

}  // namespace

bool needs_no_contexts(const TraceScene& scene) { return scene.is_plain_closest && scene.is_plain_any; }

SceneHit closest_hit(const TraceScene& scene, const Ray& ray, const RayContext& context, Isa isa) {
  if (is_plain<Query::closest>(scene, context))
    return plain_hit(scene, ray, trace_code(isa).closest_hit_with_normal(*scene.fixed, ray));
  return trace<Query::closest>(scene, ray, context, isa);
}

bool any_hit(const TraceScene& scene, const Ray& ray, const RayContext& context, Isa isa) {
  if (is_plain<Query::any>(scene, context)) return any_hit(*scene.fixed, ray, isa);
  return trace<Query::any>(scene, ray, context, isa).valid();
}

void closest_hit(const TraceScene& scene, std::span<const Ray> rays, std::span<const RayContext> contexts,
                 std::span<SceneHit> hits, Isa isa) {
  check_sizes(rays.size(), contexts.size(), hits.size(), "closest_hit");
  if (rays.size() > kFewRays && is_plain<Query::closest>(scene, contexts))
    return plain_hits(scene, rays, hits, isa);
  for_each_ray(rays.size(), [&](std::size_t i) {
    hits[i] = closest_hit(scene, rays[i], contexts[contexts.size() == 1 ? 0 : i], isa);
  });
}

void any_hit(const TraceScene& scene, std::span<const Ray> rays, std::span<const RayContext> contexts,
             std::span<std::uint8_t> occluded, Isa isa) {
  check_sizes(rays.size(), contexts.size(), occluded.size(), "any_hit");
  if (rays.size() > kFewRays && is_plain<Query::any>(scene, contexts))
    return any_hit(*scene.fixed, rays, occluded, isa);
  for_each_ray(rays.size(), [&](std::size_t i) {
    occluded[i] = any_hit(scene, rays[i], contexts[contexts.size() == 1 ? 0 : i], isa);
  });
}

void closest_hit(const TraceScene& scene, const RaySpan& rays, std::span<SceneHit> hits, Isa isa) {
  require_same_size(rays.size, hits.size(), "closest_hit");
  require_no_contexts(scene, "closest_hit");
  if (rays.size > kFewRays) return plain_hits(scene, rays, hits, isa);
  for (std::size_t i = 0; i < rays.size; ++i)
    hits[i] = plain_hit(scene, rays[i], trace_code(isa).closest_hit_with_normal(*scene.fixed, rays[i]));
}

void any_hit(const TraceScene& scene, const RaySpan& rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_no_contexts(scene, "any_hit");
  any_hit(*scene.fixed, rays, occluded, isa);
}

}  // namespace oktett
