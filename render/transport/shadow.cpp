#include "render/transport/shadow.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "core/math.h"
#include "render/hit_object.h"
#include "render/shading_point.h"
#include "render/transport/grouped_light.h"
#include "render/transport/medium_march.h"
#include "render/transport/medium_paths.h"
#include "render/transport/render_code.h"

namespace oktett {

Ray continue_behind(const Ray& ray, const SurfaceInteraction& s) {
  Ray rest = ray;
  rest.origin = offset_origin(s, ray.direction);
  if (ray.tmax < std::numeric_limits<float>::infinity()) {
    rest.direction = ray.origin + ray.direction * ray.tmax - rest.origin;
    rest.tmax = 1 - 0x1p-24f;
    // The surface may be so close to the end of the ray that the offset moves past the end.
    if (!(dot(rest.direction, ray.direction) > 0)) rest.tmax = 0;
  }
  return rest;
}

/// Looks at what the rays of `p.left` have met: those that meet nothing arrive, `p.kept` may go on.
static void look_at_surfaces(const RenderContext& context, ShadowRule rule, PassingRays& p) {
  p.kept.clear();
  for (std::uint32_t k = 0; k < p.left.size(); ++k) {
    const Hit hit = p.hits[k];
    if (!hit.valid()) continue;
    // Most materials are opaque, and the names are enough to find the material.
    if (is_opaque(material_at(*context.world, identify(*context.world->accel, hit)), rule))
      p.passed[p.left[k]].light = {0, 0, 0};
    else
      p.kept.push_back(k);
  }
}

/// What Whitted's model leaves of light that has come through a solid to the surface where a ray leaves it.
static Color passing_interior(const RenderContext& context, const Ray& ray, const Hit& hit,
                              const SurfaceInteraction& s) {
  const Vec3d direction(ray.direction);
  const double size = length(direction);
  return passing_interior(context, material_index(*context.world, s.user, s.material_slot),
                          {Vec3d(ray.origin), direction / size, static_cast<double>(hit.t) * size});
}

/// Takes the light of the rays of `p.kept` through the surfaces that they have met. Sets `p.behind` to the
/// parts of these rays behind, and `p.left` to their numbers.
static void go_behind_surfaces(const RenderContext& context, const RaySpan& rays, ShadowRule rule,
                               PassingRays& p) {
  InteractionBlock surfaces;
  std::size_t left = 0;
  p.behind.resize_uninitialized(p.kept.size());
  for (std::size_t first = 0; first < p.kept.size(); first += InteractionBlock::kMost) {
    const std::size_t count = std::min(InteractionBlock::kMost, p.kept.size() - first);
    surface_interactions(*context.world->accel, rays, p.hits, std::span(p.kept).subspan(first, count),
                         surfaces, context.isa);
    for (std::size_t k = first; k < first + count; ++k) {
      const std::uint32_t met = p.kept[k], number = p.left[met];
      const SurfaceInteraction s = surfaces[k - first];
      const StraightPassage passage = straight_passage(context, rays[met], p.hits[met], s, rule);
      StraightLight& light = p.passed[number];
      if (!passage.front && context.tracks_insides)
        light.lose(passing_interior(context, rays[met], p.hits[met], s));
      light.pass(passage, material_index(*context.world, s.user, s.material_slot));
      if (is_black(light.light)) continue;
      p.behind.set(left, continue_behind(rays[met], s));
      p.left[left++] = number;
    }
  }
  p.behind.resize_uninitialized(left);
  p.left.resize(left);
}

void add_arriving(const RenderContext& context, Wavefront& wavefront, const ShadowQueue& queue,
                  std::size_t entry, const Color& light) {
  wavefront.radiance.add(queue.owner[entry], light);
  if (context.light_groups != nullptr) add_shadow_to_layers(context, wavefront, queue, entry, light);
}

/// Multiplies the light of each ray by what the surfaces in its way leave of it.
static void pass_surfaces(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  PassingRays& p = queue.passing;
  p.passed.assign(queue.size(), {});
  p.left.resize(queue.size());
  std::iota(p.left.begin(), p.left.end(), 0u);
  RaySpan rays = queue.rays;
  for (unsigned layer = 0; layer < kMostPassages && !p.left.empty(); ++layer) {
    p.hits.resize_uninitialized(p.left.size());
    closest_hit(seen_by(*context.world, RayKind::shadow), rays, p.hits.span(), context.isa);
    look_at_surfaces(context, rule, p);
    go_behind_surfaces(context, rays, rule, p);
    std::swap(p.rays, p.behind);
    rays = p.rays;
  }
  for (const std::uint32_t i : p.left) p.passed[i].light = {0, 0, 0};
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Color passed = p.passed[i].light;
    queue.light.set(i, is_black(passed) ? Color{0, 0, 0} : queue.light[i] * passed);
  }
}

void find_arriving(const RenderContext& context, ShadowQueue& queue, ShadowRule rule) {
  const World& world = *context.world;
  // Where light may pass, the nearest surface is looked for at once: most blocked rays need to know it.
  if (world.has_holes || (world.has_clear && rule == ShadowRule::transparent_passes))
    return pass_surfaces(context, queue, rule);
  queue.occluded.resize_uninitialized(queue.size());
  any_hit(seen_by(world, RayKind::shadow), queue.rays, queue.occluded, context.isa);
  render_code(context.isa).block_light(queue.occluded, queue.light);
}

void trace_shadows(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue, ShadowRule rule) {
  if (queue.size() == 0) return;
  find_arriving(context, queue, rule);
  render_code(context.isa).add_colors(queue.light, queue.owner, wavefront.radiance);
  if (context.light_groups == nullptr) return;
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (!is_black(queue.light[i])) add_shadow_to_layers(context, wavefront, queue, i, queue.light[i]);
}

namespace {

/// Shadow rays on their way through media and transparent surfaces.
struct ShadowWalks {
  struct State {
    std::uint32_t entry;  ///< of the queue
    StraightLight light;  ///< what is left of it
    DielectricStack dielectrics;
    TrackingNumbers numbers;
  };
  RayBatch rays;
  std::vector<State> states;

  void push_back(const Ray& ray, const State& state) { rays.push_back(ray), states.push_back(state); }
  void clear() { rays.resize_uninitialized(0), states.clear(); }
};

/// Takes the walks of one queue from surface to surface.
class ShadowWalker {
 public:
  ShadowWalker(const RenderContext& context, ShadowRule rule) : context_(context), rule_(rule) {}

  /// Replaces `walks` by their parts behind the next surface. The light of those that meet none goes to
  /// `arriving`, at their entry.
  void step(ShadowWalks& walks, std::vector<Color>& arriving) {
    const Accel& accel = *context_.world->accel;
    hits_.resize_uninitialized(walks.states.size());
    closest_hit(seen_by(*context_.world, RayKind::shadow), walks.rays.span(), hits_.span(), context_.isa);
    kept_.clear();
    for (std::uint32_t k = 0; k < walks.states.size(); ++k) {
      if (!pass_medium(walks.rays[k], hits_[k], walks.states[k])) continue;
      if (hits_[k].valid())
        kept_.push_back(k);
      else
        arriving[walks.states[k].entry] = walks.states[k].light.light;
    }
    rest_.clear();
    for (std::size_t first = 0; first < kept_.size(); first += InteractionBlock::kMost) {
      const std::size_t count = std::min(InteractionBlock::kMost, kept_.size() - first);
      const auto which = std::span(kept_).subspan(first, count);
      surface_interactions(accel, walks.rays, hits_, which, found_, context_.isa);
      for (std::size_t n = 0; n < count; ++n)
        pass_surface(walks.rays[which[n]], hits_[which[n]], found_[n], walks.states[which[n]]);
    }
    std::swap(walks, rest_);
  }

 private:
  /// Attenuates the light of a walk before its hit, or before its end. False if nothing is left, or if the
  /// surface surely stops it.
  bool pass_medium(const Ray& ray, const Hit& hit, ShadowWalks::State& state) const {
    const World& world = *context_.world;
    if (hit.valid()) {
      const Material& m = material_at(world, identify(*world.accel, hit));
      if (is_opaque(m, rule_) && !encloses(m)) return false;
    }
    const std::uint32_t medium = medium_in(world, state.dielectrics, context_.outer_medium);
    if (medium == kNoId) return true;
    const Vec3d direction(ray.direction);
    const double scale = length(direction), end = static_cast<double>(hit.valid() ? hit.t : ray.tmax);
    const MediumSegment segment{ray.origin, Vec3f(direction / scale), end * scale};
    state.light.lose(context_.media[medium].transmittance(segment, state.numbers));
    return !is_black(state.light.light);
  }

  void pass_surface(const Ray& ray, const Hit& hit, const SurfaceInteraction& s,
                    const ShadowWalks::State& state) {
    const bool front = !(dot(ray.direction, s.geometric_normal) > 0);
    const Boundary boundary =
        boundary_at(*context_.world, state.dielectrics, s, front, index_of_refraction(context_, ray, hit, s));
    StraightLight light = state.light;
    if (!boundary.hidden)
      light.pass(straight_passage(context_, ray, hit, s, rule_, boundary.ior),
                 material_index(*context_.world, s.user, s.material_slot));
    if (is_black(light.light)) return;
    rest_.push_back(continue_behind(ray, s), {state.entry, light, boundary.behind, state.numbers});
  }

  const RenderContext& context_;
  ShadowRule rule_;
  HitBatch hits_;
  std::vector<std::uint32_t> kept_;  ///< walks that met a surface
  InteractionBlock found_;
  ShadowWalks rest_;
};

}  // namespace

void trace_shadows_in_media(const RenderContext& context, Wavefront& wavefront, ShadowQueue& queue,
                            ShadowRule rule) {
  if (queue.size() == 0) return;
  ShadowWalks walks;
  for (std::uint32_t i = 0; i < queue.size(); ++i)
    walks.push_back(queue.rays[i], {i,
                                    {queue.light[i]},
                                    queue.dielectrics[i],
                                    tracking_numbers(wavefront, queue.owner[i], MediumDecision::shadow)});
  std::vector<Color> arriving(queue.size(), Color{0, 0, 0});
  ShadowWalker walker(context, rule);
  for (unsigned layer = 0; layer < kMostPassages && !walks.states.empty(); ++layer)
    walker.step(walks, arriving);
  for (std::size_t i = 0; i < queue.size(); ++i)
    if (!is_black(arriving[i])) add_arriving(context, wavefront, queue, i, arriving[i]);
}

}  // namespace oktett
