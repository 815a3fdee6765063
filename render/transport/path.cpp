/// \file Path tracing, see integrators.h.

#include "render/transport/path.h"

#include <algorithm>

#include "render/dispersion.h"
#include "render/hit_object.h"
#include "render/path_surface.h"
#include "render/photon/caustics.h"
#include "render/sampling/owen_sobol.h"
#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path_lights.h"
#include "render/transport/render_code.h"
#include "render/transport/sample_dimensions.h"

namespace oktett {
namespace {

constexpr std::size_t kMostHits = PathBlock::kMost, kGroup = PathBlock::kGroup;

}  // namespace

// ---- Light that a ray meets

float power_weight(float pdf, float other) {
  // Divided first: squares of densities may be too large for a float.
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

namespace {

/// The weight of the light that the surface at `position`, the hit of entry `ray`, emits: against light
/// samples that find the same, and none where photons bring it. `emitter`: its number, see
/// SceneLights::emitter_at; `user`: as in SurfaceInteraction.
float emission_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                      const Vec3f& position, std::uint32_t emitter, std::uint32_t user) {
  if (wavefront.level == 0) return 1;
  if (!lights(*context.world, user, wavefront.paths.from[ray].lists)) return 0;
  const float pdf = wavefront.paths.pdf[ray];
  if (pdf == 0 && !is_caustic(context, wavefront, ray)) return 1;
  if (pdf > 0 && emitter != kNoId && context.shadows_decide) return 0;
  const LightPoint& from = wavefront.paths.from[ray];
  if (pdf == 0) return emitter != kNoId && context.caustics->brings(emitter) ? 0.0f : 1.0f;
  const float distance = length(position - from.position);
  if (emitter == kNoId || distance < wavefront.paths.unsampled[ray]) return power_weight(pdf, 0);
  return power_weight(
      pdf, context.sampled->set().pdf(from, emitter, wavefront.rays.rays[ray].direction, distance));
}

/// Adds the light that photons bring to the hit of entry `ray`.
void add_caustics(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                  const ShadingPoint& p) {
  const Color throughput = wavefront.rays.throughput[ray];
  Color of_group[kMostLightGroups];
  const bool grouped = context.light_groups != nullptr;
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const Color light =
      context.caustics->light(wavefront.samples.key[sample], wavefront.samples.number[sample],
                              wavefront.rays.bounces[ray], p, SurfaceBsdf(p), grouped ? of_group : nullptr);
  wavefront.radiance.add(ray, throughput * light);
  for (std::size_t group = 0; group < wavefront.samples.grouped.size(); ++group)
    add_to_layer(wavefront, ray, static_cast<std::uint8_t>(group), throughput * of_group[group]);
}

}  // namespace

// ---- Blocks

void begin_path_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                      const InteractionBlock& found, PathBlock& c) {
  for (std::size_t k = 0; k < kMostHits; ++k) {
    const std::uint32_t i = which[std::min(k, c.count - 1)], sample = wavefront.rays.sample[i];
    c.ray[k] = i;
    c.key[k] = wavefront.samples.key[sample];
    c.number[k] = wavefront.samples.number[sample];
    c.bounces[k] = wavefront.rays.bounces[i];
  }
  c.asks_lights = !context.sampled->set().empty();
  render_code(context.isa).begin_path(found, arriving_rays(wavefront), wavefront.level, c);
}

void choose_lights(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* entry,
                   std::size_t count, PathBlock& c) {
  if (c.asks_lights) sample_lights(context, entry, count, c);
  if (c.asks_lights && c.raised != nullptr) raise_lights(context, entry, count, c);
  if (context.light_groups == nullptr) return;
  for (std::size_t i = 0; i < count; ++i)
    if (c.light_kind[entry[i]] != LightKind::none)
      wavefront.sampled_emitter[c.ray[entry[i]]] = c.light_emitter[entry[i]];
}

static PathOnward end_of(RayQueue& queue, PathColumns& paths, std::size_t more) {
  PathOnward to{end_of(queue, more), nullptr, nullptr, nullptr};
  paths.resize_uninitialized(queue.size());
  to.pdf = paths.pdf.data();
  to.unsampled = paths.unsampled.data();
  to.from = paths.from.data();
  return to;
}

PathOutput::PathOutput(Wavefront& wavefront, std::size_t places)
    : wavefront_(wavefront),
      deltas_(wavefront.shadows[0].size()),
      areas_(wavefront.shadows[kAreaQueue].size()),
      onward_(wavefront.next.size()),
      queues_{end_of(wavefront.shadows[0], places), end_of(wavefront.shadows[kAreaQueue], places),
              end_of(wavefront.next, wavefront.next_paths, places)} {}

void PathOutput::note_alone(const PathQueues& before, const PathBlock& c, std::size_t k,
                            const DielectricStack* around, const DielectricStack* behind, bool scatters,
                            RayKind reflected) {
  const std::uint32_t ray = c.ray[k];
  const bool sent = queues_.next.size > before.next.size;
  const bool transmitted = queues_.next.transmitted > before.next.transmitted;
  if (around != nullptr) {
    const bool light_behind = !c.from[k].front_only && dot(InteractionBlock::get(c.ng, k),
                                                           InteractionBlock::get(c.light_direction, k)) < 0;
    const DielectricStack& at_light = light_behind ? *behind : *around;
    if (queues_.delta.size > before.delta.size) wavefront_.shadows[0].dielectrics.push_back(at_light);
    if (queues_.area.size > before.area.size) wavefront_.shadows[kAreaQueue].dielectrics.push_back(at_light);
    if (sent) wavefront_.next_paths.dielectrics.push_back(transmitted ? *behind : *around);
  }
  if (!sent) return;
  wavefront_.next.kind[before.next.size] = transmitted ? RayKind::transmission : reflected;
  const bool scattered = wavefront_.level > 0 && wavefront_.paths.scattered[ray] != 0;
  wavefront_.next_paths.scattered[before.next.size] =
      scatters && (scattered || queues_.next.pdf[before.next.size] > 0) ? 1 : 0;
}

void PathOutput::finish() {
  ShadowQueue &delta = wavefront_.shadows[0], &area = wavefront_.shadows[kAreaQueue];
  RayQueue& next = wavefront_.next;
  delta.resize_uninitialized(queues_.delta.size);
  area.resize_uninitialized(queues_.area.size);
  next.resize_uninitialized(queues_.next.size);
  wavefront_.next_paths.resize_uninitialized(queues_.next.size);
  // The columns of rays that are the same for all.
  const Ray like;
  const auto fill = [](Column<float>& column, std::size_t first, std::size_t end, float value) {
    std::fill(column.data() + first, column.data() + end, value);
  };
  fill(delta.rays.tmin, deltas_, delta.size(), like.tmin);
  fill(area.rays.tmin, areas_, area.size(), like.tmin);
  finish_rays(next, onward_);
  wavefront_.counts.refracted += queues_.next.transmitted;
  wavefront_.counts.reflected += next.size() - onward_ - queues_.next.transmitted;
}

// ---- Hits

namespace {

/// A hit of the block and the PathSurface that it shows.
struct Shown {
  std::uint32_t surface, entry;
};

/// Moves the entries of the first surface in `shown` to `entry`, without branches that depend on the
/// surfaces. Returns their number.
std::size_t take_first_surface(Shown* shown, std::size_t count, std::uint32_t* entry) {
  const std::uint32_t number = shown[0].surface;
  std::size_t taken = 0, kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Shown one = shown[i];
    const bool same = one.surface == number;
    entry[taken] = one.entry;
    shown[kept] = one;
    taken += same ? 1 : 0;
    kept += same ? 0 : 1;
  }
  return taken;
}

void shade_run(const RenderCode& code, const InteractionBlock& found, const ArrivingRays& rays,
               const PathBlock& c, const PathSurface& surface, const PathRun& run, PathQueues& out) {
  if (surface.principled)
    code.shade_principled(found, rays, c, surface.layers, surface.transmits, run, out);
  else
    code.shade_phong(found, rays, c, surface.phong, surface.transmits, run, out);
}

/// Shades the hits in `shown`, surface by surface.
void shade_runs(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                const PathBlock& c, Shown* shown, std::size_t count, PathOutput& output) {
  const RenderCode& code = render_code(context.isa);
  while (count > 0) {
    std::uint32_t entry[kMostHits + kGroup];
    const std::uint32_t number = shown[0].surface;
    const PathRun run{entry, take_first_surface(shown, count, entry)};
    count -= run.count;
    count_lanes(wavefront, run.count, code.path_lanes);
    for (std::size_t k = 0; k < kGroup; ++k) entry[run.count + k] = entry[run.count - 1];
    shade_run(code, found, arriving_rays(wavefront), c, (*context.path_surfaces)[number], run,
              output.queues());
  }
}

/// Shades a hit that has a surface of its own.
void shade_lone(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                const PathBlock& c, const LoneHit& hit, PathOutput& output) {
  const std::uint32_t ray = c.ray[hit.entry];
  if (context.caustics != nullptr && !hit.surface.only_delta)
    add_caustics(context, wavefront, ray, hit.point);
  const DielectricStack* const around =
      context.tracks_dielectrics ? &wavefront.paths.dielectrics[ray] : nullptr;
  // Of the lobes of a surface only the one that is chosen counts.
  const bool diffuse = context.bounces_differ && SurfaceBsdf(hit.point).chooses_diffuse(c.lobe[hit.entry]);
  const RayKind reflected = diffuse ? RayKind::diffuse : RayKind::glossy;
  output.shade_alone(c, hit.entry, around, &hit.boundary.behind, true, reflected, [&](PathQueues& out) {
    shade_run(render_code(Isa::scalar), found, arriving_rays(wavefront), c, hit.surface, {&hit.entry, 1},
              out);
  });
}

/// Passes straight on. Light behind the surface could have been chosen where the ray left the last one.
void pass_straight(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const LoneHit& hit) {
  push_bounce(wavefront, wavefront.next, ray, hit.point, hit.point.direction, wavefront.rays.throughput[ray],
              Bounce::straight);
  const bool camera = wavefront.level == 0;
  // Lights that shadow rays decide on have been looked for all along the ray.
  const float unsampled = context.shadows_decide ? kAllMet : camera ? 0 : wavefront.paths.unsampled[ray];
  wavefront.next_paths.push_back(camera ? 0 : wavefront.paths.pdf[ray], unsampled,
                                 camera ? LightPoint{} : wavefront.paths.from[ray],
                                 !camera && wavefront.paths.scattered[ray] != 0,
                                 context.tracks_dielectrics ? &hit.boundary.behind : nullptr);
}

/// Fills `hit` and the normals of its entry. False if the ray passes straight on: through a hole, or where
/// solids of higher priority fill both sides.
bool meet_alone(const RenderContext& context, Wavefront& wavefront, const RayHistory& history,
                const SurfaceInteraction& found, PathBlock& c, LoneHit& hit) {
  const std::size_t k = hit.entry, ray = c.ray[k];
  hit.point = shading_point(context, wavefront.rays.rays[ray], wavefront.hits[ray], history, found);
  ShadingPoint& p = hit.point;
  if (disperses(p)) {
    const std::uint64_t key = sequence_key(c.key[k], dispersion_dimension(wavefront.level));
    const Color before = wavefront.rays.throughput[ray];
    const Color left = before * disperse(p, before, sobol_number(c.number[k], key));
    wavefront.rays.throughput.set(ray, left);
    InteractionBlock::put(c.throughput, k, left);
  }
  if (context.tracks_dielectrics) {
    hit.boundary = boundary_at(*context.world, wavefront.paths.dielectrics[ray], p.surface, p.front,
                               index_of_refraction(p));
    if (hit.boundary.hidden) return false;
    if (hit.boundary.ior) set_index_of_refraction(p, *hit.boundary.ior);
  }
  if (p.opacity < 1) {
    const std::uint64_t key = sequence_key(c.key[k], dimension(Decision::hole, wavefront.level));
    if (sobol_number(c.number[k], key) >= p.opacity) return false;
  }
  hit.surface = path_surface(p);
  InteractionBlock::put(c.ng, k, p.ng);
  InteractionBlock::put(c.ns, k, p.ns);
  return true;
}

/// The normal by which lights are chosen for hit `k`. Rays leave an opaque smooth triangle wherever they lead
/// above the curved surface, see RaisedPoints.
Vec3f normal_for_lights(const InteractionBlock& found, const PathBlock& c, std::size_t k, bool transmits) {
  const bool flat =
      InteractionBlock::get(found.shading_normal, k) == InteractionBlock::get(found.geometric_normal, k);
  return InteractionBlock::get(flat || transmits ? c.ng : c.ns, k);
}

}  // namespace

void shade_path_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                      std::size_t count, const InteractionBlock& found) {
  PathBlock c;
  c.count = count;
  begin_path_block(context, wavefront, which, found, c);
  RaisedPoints raised = raised_points(context, wavefront, which, found);
  c.raised = &raised;
  const bool all_alone = context.one_by_one || context.tracks_dielectrics || context.caustics != nullptr ||
                         context.bounces_differ;
  Shown shown[kMostHits];
  std::uint32_t asks[kMostHits];
  std::size_t in_lanes = 0, asking = 0;
  LoneHit lone;
  wavefront.lone_hits.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = c.ray[k];
    const bool behind = c.behind >> k & 1;
    const std::uint32_t number =
        2 * material_index(*context.world, found.user[k], found.material_slot[k]) + (behind ? 1 : 0);
    const PathSurface* surface = &(*context.path_surfaces)[number];
    const bool from_camera = wavefront.rays.from_camera[i] != 0, alone = all_alone || surface->alone;
    const RayHistory history{wavefront.rays.distance[i], from_camera};
    if (alone) {
      lone.entry = static_cast<std::uint32_t>(k);
      if (!meet_alone(context, wavefront, history, found[k], c, lone)) {
        pass_straight(context, wavefront, i, lone);
        continue;
      }
      surface = &lone.surface;
    }
    if (from_camera) {
      if (alone)
        record_first_hit(context, wavefront, i, shown_surface(lone.point));
      else if (context.data_layers)
        record_first_hit(
            context, wavefront, i,
            shown_surface(context, wavefront.rays.rays[i], wavefront.hits[i], history, found[k]));
      cover(context, wavefront, i, 1);
    }
    const Vec3f position = InteractionBlock::get(found.position, k);
    const std::uint32_t emitter = surface->glows ? context.sampled->emitter_at(wavefront.hits[i]) : kNoId;
    if (!(surface->emission == Color{0, 0, 0})) {
      const Color emitted = wavefront.rays.throughput[i] * surface->emission *
                            emission_weight(context, wavefront, i, position, emitter, found.user[k]);
      wavefront.radiance.add(i, emitted);
      add_emission_to_layer(context, wavefront, i, number / 2, emitted);
    }
    if (wavefront.rays.bounces[i] > context.settings.depth) continue;
    c.light_kind[k] = LightKind::none;
    c.from[k] = {position, normal_for_lights(found, c, k, surface->transmits), !surface->transmits,
                 light_lists_at(*context.world, wavefront.hits[i], found.user[k]), emitter};
    if (!surface->only_delta) asks[asking++] = static_cast<std::uint32_t>(k);
    if (alone)
      wavefront.lone_hits.push_back(lone);
    else
      shown[in_lanes++] = {number, static_cast<std::uint32_t>(k)};
  }
  choose_lights(context, wavefront, asks, asking, c);
  if (context.caustics != nullptr)
    for (std::size_t i = 0; i < asking; ++i)
      if (LightKind& kind = c.light_kind[asks[i]];
          kind == LightKind::delta && context.caustics->brings(c.light_emitter[asks[i]]))
        kind = LightKind::left_to_photons;
  if (in_lanes + wavefront.lone_hits.size() == 0) return;
  PathOutput output(wavefront, in_lanes + wavefront.lone_hits.size());
  shade_runs(context, wavefront, found, c, shown, in_lanes, output);
  for (const LoneHit& hit : wavefront.lone_hits) shade_lone(context, wavefront, found, c, hit, output);
  output.finish();
}

}  // namespace oktett
