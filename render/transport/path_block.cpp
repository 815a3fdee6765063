/// \file Path tracing of hits in blocks, see integrators.h.

#include <algorithm>

#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path_emission.h"
#include "render/transport/path_lights.h"
#include "render/transport/path_surfaces.h"
#include "render/transport/render_code.h"

namespace oktett {
namespace {

constexpr std::size_t kMost = PathBlock::kMost, kGroup = PathBlock::kGroup;

/// A hit of the block and the PathSurface that it shows.
struct Shown {
  std::uint32_t surface, entry;
};

PathRays path_rays(const Wavefront& wavefront) {
  PathRays rays;
  for (int k = 0; k < 3; ++k) {
    rays.direction[k] = wavefront.rays.rays.direction[k].data();
    rays.throughput[k] = wavefront.rays.throughput.part[k].data();
  }
  rays.distance = wavefront.rays.distance.data(), rays.t = wavefront.hits.t.data();
  rays.sample = wavefront.rays.sample.data();
  return rays;
}

/// Fills the block up to the random numbers.
void begin_block(const RenderContext& context, const Wavefront& wavefront, const std::uint32_t* which,
                 const InteractionBlock& found, PathBlock& c) {
  const auto name = [&](std::size_t k, std::uint32_t i) {
    const std::uint32_t sample = wavefront.rays.sample[i];
    c.ray[k] = i, c.key[k] = wavefront.samples.key[sample], c.number[k] = wavefront.samples.number[sample];
    c.bounces[k] = wavefront.rays.bounces[i];
  };
  for (std::size_t k = 0; k < c.count; ++k) name(k, which[k]);
  for (std::size_t k = c.count; k < kMost; ++k) name(k, which[c.count - 1]);
  c.asks_lights = !context.sampled->set().empty();
  render_code(context.isa).begin_path(found, path_rays(wavefront), wavefront.level, c);
}

PathShadows end_of(ShadowQueue& queue, std::size_t count) {
  PathShadows to;
  to.size = queue.size();
  queue.resize_uninitialized(to.size + count + kGroup);
  for (int k = 0; k < 3; ++k) {
    to.origin[k] = queue.rays.origin[k].data(), to.direction[k] = queue.rays.direction[k].data();
    to.light[k] = queue.light.part[k].data();
  }
  to.tmax = queue.rays.tmax.data(), to.owner = queue.owner.data();
  return to;
}

PathOnward end_of(RayQueue& queue, PathColumns& paths, std::size_t count) {
  PathOnward to;
  to.size = queue.size();
  queue.resize_uninitialized(to.size + count + kGroup);
  paths.resize_uninitialized(to.size + count + kGroup);
  for (int k = 0; k < 3; ++k) {
    to.origin[k] = queue.rays.origin[k].data(), to.direction[k] = queue.rays.direction[k].data();
    to.throughput[k] = queue.throughput.part[k].data();
  }
  to.distance = queue.distance.data(), to.pdf = paths.pdf.data(), to.from = paths.from.data();
  to.sample = queue.sample.data(), to.bounces = queue.bounces.data();
  return to;
}

/// The columns of rays that are the same for all.
void fill_rays(RayBatch& rays, std::size_t first, std::size_t end, bool with_tmax) {
  const Ray like;
  std::fill(rays.tmin.data() + first, rays.tmin.data() + end, like.tmin);
  if (with_tmax) std::fill(rays.tmax.data() + first, rays.tmax.data() + end, like.tmax);
}

/// Moves the entries of the first surface in `shown` to `entry`, without branches that depend on the
/// surfaces. Returns their number.
std::size_t take_first_surface(Shown* shown, std::size_t count, std::uint32_t* entry) {
  const std::uint32_t number = shown[0].surface;
  std::size_t taken = 0, kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Shown one = shown[i];
    const bool same = one.surface == number;
    entry[taken] = one.entry, shown[kept] = one;
    taken += same ? 1 : 0, kept += same ? 0 : 1;
  }
  return taken;
}

/// Shades the hits in `shown`, surface by surface.
void shade_runs(const RenderContext& context, Wavefront& wavefront, const InteractionBlock& found,
                const PathBlock& c, Shown* shown, std::size_t count) {
  const RenderCode& code = render_code(context.isa);
  const PathRays rays = path_rays(wavefront);
  ShadowQueue &delta = wavefront.shadows[0], &area = wavefront.shadows[kAreaQueue];
  const std::size_t deltas = delta.size(), areas = area.size(), onward = wavefront.next.size();
  PathQueues out{end_of(delta, count), end_of(area, count),
                 end_of(wavefront.next, wavefront.next_paths, count)};
  while (count > 0) {
    std::uint32_t entry[kMost + kGroup];
    const std::uint32_t number = shown[0].surface;
    const PathRun run{entry, take_first_surface(shown, count, entry)};
    count -= run.count;
    count_lanes(wavefront, run.count, code.path_lanes);
    for (std::size_t k = 0; k < kGroup; ++k) entry[run.count + k] = entry[run.count - 1];
    const PathSurface& surface = (*context.path_surfaces)[number];
    if (surface.principled)
      code.shade_principled(found, rays, c, surface.layers, surface.transmits, run, out);
    else
      code.shade_phong(found, rays, c, surface.phong, surface.transmits, run, out);
  }
  delta.resize_uninitialized(out.delta.size), area.resize_uninitialized(out.area.size);
  wavefront.next.resize_uninitialized(out.next.size),
      wavefront.next_paths.resize_uninitialized(out.next.size);
  fill_rays(delta.rays, deltas, out.delta.size, false), fill_rays(area.rays, areas, out.area.size, false);
  fill_rays(wavefront.next.rays, onward, out.next.size, true);
  std::fill(wavefront.next.from_camera.data() + onward, wavefront.next.from_camera.data() + out.next.size,
            std::uint8_t{0});
  wavefront.counts.refracted += out.next.transmitted;
  wavefront.counts.reflected += out.next.size - onward - out.next.transmitted;
}

}  // namespace

void shade_path_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                      std::size_t count, const InteractionBlock& found) {
  PathBlock c;
  c.count = count;
  begin_block(context, wavefront, which, found, c);
  Shown shown[kMost];
  std::uint32_t asks[kMost];
  std::size_t in_lanes = 0, asking = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = c.ray[k];
    const bool behind = c.behind >> k & 1;
    const std::uint32_t number =
        2 * material_index(*context.world, found.user[k], found.material_slot[k]) + (behind ? 1 : 0);
    const PathSurface& surface = (*context.path_surfaces)[number];
    const bool from_camera = wavefront.rays.from_camera[i] != 0;
    const RayHistory history{wavefront.rays.distance[i], from_camera};
    if (surface.alone) {
      const ShadingPoint p =
          shading_point(context, wavefront.rays.rays[i], wavefront.hits[i], history, found[k]);
      shade_path(context, wavefront, i, p);
      continue;
    }
    if (from_camera && context.data_layers)
      record_first_hit(context, wavefront, i,
                       shown_surface(context, wavefront.rays.rays[i], wavefront.hits[i], history, found[k]));
    if (from_camera) cover(context, wavefront, i, 1);
    const Vec3f position = InteractionBlock::get(found.position, k);
    const std::uint32_t emitter = surface.glows ? context.sampled->emitter_at(wavefront.hits[i]) : kNoId;
    if (!(surface.emission == Color{0, 0, 0})) {
      const Color emitted = wavefront.rays.throughput[i] * surface.emission *
                            emission_weight(context, wavefront, i, position, emitter);
      wavefront.radiance.add(i, emitted);
      add_emission_to_layer(context, wavefront, i, number / 2, emitted);
    }
    if (wavefront.rays.bounces[i] > context.settings.depth) continue;
    c.light_kind[k] = LightKind::none;
    c.from[k] = {position, InteractionBlock::get(c.ng, k), !surface.transmits, emitter};
    if (!surface.only_delta) asks[asking++] = static_cast<std::uint32_t>(k);
    shown[in_lanes++] = {number, static_cast<std::uint32_t>(k)};
  }
  if (c.asks_lights) sample_lights(context, asks, asking, c);
  if (context.light_groups != nullptr)
    for (std::size_t i = 0; i < asking; ++i)
      if (c.light_kind[asks[i]] != LightKind::none)
        wavefront.sampled_emitter[c.ray[asks[i]]] = c.light_emitter[asks[i]];
  if (in_lanes > 0) shade_runs(context, wavefront, found, c, shown, in_lanes);
}

}  // namespace oktett
