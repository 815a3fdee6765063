/// \file Path tracing, see integrators.h.

#include <optional>

#include "render/photon/caustics.h"
#include "render/surface_bsdf.h"
#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path_choices.h"
#include "render/transport/path_emission.h"

namespace oktett {
namespace {

/// The solids around a ray that leaves the hit of entry `ray`. `boundary` is null unless the scene tracks
/// them.
const EnclosureStack* enclosures(const Wavefront& wavefront, std::size_t ray, const Boundary* boundary,
                                 bool behind) {
  if (boundary == nullptr) return nullptr;
  return behind ? &boundary->behind : &wavefront.paths.enclosures[ray];
}

/// Sends a ray to a light chosen at random.
void sample_light(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
                  const SurfaceBsdf& bsdf, const LightPoint& from, const Choices& choices,
                  const Boundary* boundary) {
  const std::optional<LightSample> light = choose_light(context, from, choices);
  if (!light) return;
  const BsdfValue found = bsdf.evaluate(light->direction);
  if (found.value == Color{0, 0, 0}) return;
  const Color arriving = light_found(context, wavefront.rays.throughput[ray], *light, found);
  const bool behind = dot(p.ng, light->direction) < 0;
  // Light that photons bring through glass must not pass it straight, too.
  const bool straight = light->delta && !(context.caustics && context.caustics->brings(light->emitter));
  queue_light(wavefront, ray, offset_origin(p.surface, light->direction), from, *light, arriving, straight,
              enclosures(wavefront, ray, boundary, behind));
}

/// Adds the light that photons bring.
void add_caustics(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
                  const SurfaceBsdf& bsdf) {
  const Color throughput = wavefront.rays.throughput[ray];
  Color of_group[kMostLightGroups];
  const bool grouped = context.light_groups != nullptr;
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const Color light =
      context.caustics->light(wavefront.samples.key[sample], wavefront.samples.number[sample],
                              wavefront.rays.bounces[ray], p, bsdf, grouped ? of_group : nullptr);
  wavefront.radiance.add(ray, throughput * light);
  for (std::size_t group = 0; group < wavefront.samples.grouped.size(); ++group)
    add_to_layer(wavefront, ray, static_cast<std::uint8_t>(group), throughput * of_group[group]);
}

/// Passes straight on. Light behind the surface could have been chosen where the ray left the last one.
void pass_straight(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p, const Boundary* boundary) {
  push_bounce(wavefront, wavefront.next, ray, p, p.direction, wavefront.rays.throughput[ray],
              Bounce::straight);
  const bool camera = wavefront.level == 0;
  wavefront.next_paths.push_back(
      camera ? 0 : wavefront.paths.pdf[ray], camera ? LightPoint{} : wavefront.paths.from[ray],
      !camera && wavefront.paths.scattered[ray] != 0, enclosures(wavefront, ray, boundary, true));
}

void shade_surface(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
                   const Boundary* boundary) {
  const Choices choices(wavefront, ray);
  if (p.opacity < 1 && choices.number(Decision::hole) >= p.opacity)
    return pass_straight(wavefront, ray, p, boundary);
  if (wavefront.rays.from_camera[ray]) {
    record_first_hit(context, wavefront, ray, {p.surface, p.color, p.opacity});
    cover(context, wavefront, ray, 1);
  }

  const Color throughput = wavefront.rays.throughput[ray];
  const std::uint32_t material = material_index(*context.world, p.surface.user, p.surface.material_slot);
  // Also where a texture is black, since it may not be so everywhere on the emitter.
  const bool is_lamp = glows(context.world->materials[material]);
  const std::uint32_t emitter = is_lamp ? context.sampled->emitter_at(wavefront.hits[ray]) : kNoId;
  if (!(p.emission == Color{0, 0, 0})) {
    const Color emitted =
        throughput * p.emission * emission_weight(context, wavefront, ray, p.surface.position, emitter);
    wavefront.radiance.add(ray, emitted);
    add_emission_to_layer(context, wavefront, ray, material, emitted);
  }
  if (wavefront.rays.bounces[ray] > context.settings.depth) return;

  const SurfaceBsdf bsdf(p);
  const LightPoint from{p.surface.position, p.ng, !bsdf.transmits(), emitter};
  if (!bsdf.only_delta()) {
    sample_light(context, wavefront, ray, p, bsdf, from, choices, boundary);
    if (context.caustics != nullptr) add_caustics(context, wavefront, ray, p, bsdf);
  }

  const std::optional<BsdfSample> next =
      bsdf.sample(choices.number(Decision::lobe), choices.point(Decision::direction));
  if (!next) return;
  Color onward = throughput * next->weight;
  if (!survives(wavefront, ray, choices, next->pdf == 0 ? next->weight : onward, onward)) return;
  push_bounce(wavefront, wavefront.next, ray, p, next->direction, onward,
              next->transmitted ? Bounce::refracted : Bounce::reflected);
  const bool scattered = wavefront.level > 0 && wavefront.paths.scattered[ray] != 0;
  wavefront.next_paths.push_back(next->pdf, from, scattered || next->pdf > 0,
                                 enclosures(wavefront, ray, boundary, next->transmitted));
}

}  // namespace

void shade_path(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  if (!context.tracks_enclosures) return shade_surface(context, wavefront, ray, p, nullptr);
  const Boundary boundary = boundary_at(*context.world, wavefront.paths.enclosures[ray], p.surface, p.front,
                                        index_of_refraction(p));
  if (boundary.hidden) return pass_straight(wavefront, ray, p, &boundary);
  if (!boundary.ior) return shade_surface(context, wavefront, ray, p, &boundary);
  ShadingPoint between = p;
  between.ior = *boundary.ior;
  if (between.principled) between.principled->ior = *boundary.ior;
  shade_surface(context, wavefront, ray, between, &boundary);
}

}  // namespace oktett
