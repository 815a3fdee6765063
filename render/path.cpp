/// \file Path tracing, see integrators.h.

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/direct_light.h"
#include "render/integrators.h"
#include "render/path_emission.h"
#include "render/path_numbers.h"
#include "render/photon/caustics.h"
#include "render/sample_dimensions.h"
#include "render/sampling/owen_sobol.h"
#include "render/surface_bsdf.h"

namespace oktett {
namespace {

/// The random numbers of one sample at one bounce.
class Choices {
 public:
  Choices(const Wavefront& wavefront, std::size_t ray)
      : pixel_(wavefront.samples.key[wavefront.rays.sample[ray]]),
        sample_(wavefront.samples.number[wavefront.rays.sample[ray]]),
        level_(wavefront.level) {}

  float number(Decision decision) const { return sobol_number(sample_, key(decision)); }
  SquareSample point(Decision decision) const { return sobol_point(sample_, key(decision)); }

 private:
  std::uint64_t key(Decision decision) const { return sequence_key(pixel_, dimension(decision, level_)); }

  std::uint64_t pixel_;
  std::uint32_t sample_;
  unsigned level_;
};

/// See kLeastGap.
float before_surface(const Vec3f& light, float distance) {
  const float blur = kPlaceError * max_component(abs(light)) / distance;
  return 1 - std::max(kLeastGap, std::min(blur, 0.5f));
}

/// Sends a ray to a light chosen at random.
void sample_light(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
                  const SurfaceBsdf& bsdf, const LightPoint& from, const Choices& choices) {
  // A single number of 24 bits is too coarse for millions of lights.
  const double which = choices.point(Decision::light).x;
  const std::optional<LightSample> light =
      context.sampled->set().sample(from, which, choices.point(Decision::light_place));
  if (!light) return;
  const BsdfValue found = bsdf.evaluate(light->direction);
  if (found.value == Color{0, 0, 0}) return;
  const float weight = light->delta ? 1 : power_weight(light->pdf, found.pdf);
  const Color arriving = wavefront.rays.throughput[ray] * found.value *
                         (light->radiance * context.sampled->texture_at(*light, context.textures)) *
                         (weight / light->pdf);
  if (arriving == Color{0, 0, 0}) return;
  // Light that photons bring through glass must not pass it straight, too.
  const bool straight = light->delta && !(context.caustics && context.caustics->brings(light->emitter));
  Ray shadow;
  shadow.origin = offset_origin(p.surface, light->direction);
  shadow.direction = light->direction;
  if (std::isfinite(light->distance)) {
    const Vec3f place = from.position + light->direction * light->distance;
    shadow.direction = place - shadow.origin;
    shadow.tmax = light->delta ? kBeforeLight : before_surface(place, light->distance);
  }
  wavefront.shadows[straight ? 0 : kAreaQueue].push_back(shadow, static_cast<std::uint32_t>(ray), arriving);
}

/// Russian roulette: ends paths of small weight at random and raises the weight of the others, so that the
/// mean does not change. False if the path ends.
bool survives(const Wavefront& wavefront, std::size_t ray, const Choices& choices, Color& throughput) {
  if (wavefront.rays.bounces[ray] + 1u <= kSureBounces) return true;
  const float chance = std::min(kMostSurvival, max_component(throughput));
  if (choices.number(Decision::roulette) >= chance) return false;
  throughput *= 1 / chance;
  return true;
}

/// Passes straight through a hole. Light behind it could have been chosen where the ray left a surface.
void pass_hole(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  push_bounce(wavefront, ray, p, p.direction, wavefront.rays.throughput[ray], Bounce::straight);
  const bool camera = wavefront.level == 0;
  wavefront.next_paths.push_back(camera ? 0 : wavefront.paths.pdf[ray],
                                 camera ? LightPoint{} : wavefront.paths.from[ray],
                                 !camera && wavefront.paths.scattered[ray] != 0);
}

}  // namespace

void shade_path(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const Choices choices(wavefront, ray);
  if (p.opacity < 1 && choices.number(Decision::hole) >= p.opacity) return pass_hole(wavefront, ray, p);

  const Color throughput = wavefront.rays.throughput[ray];
  if (!(p.emission == Color{0, 0, 0}))
    wavefront.radiance.add(
        ray, throughput * p.emission * emission_weight(context, wavefront, ray, p.surface.position));
  if (wavefront.rays.bounces[ray] > context.settings.depth) return;

  const SurfaceBsdf bsdf(p);
  const LightPoint from{p.surface.position, p.ng, !bsdf.transmits()};
  if (!bsdf.only_delta()) {
    sample_light(context, wavefront, ray, p, bsdf, from, choices);
    if (context.caustics != nullptr)
      wavefront.radiance.add(ray, throughput * context.caustics->light(wavefront, ray, p, bsdf));
  }

  const std::optional<BsdfSample> next =
      bsdf.sample(choices.number(Decision::lobe), choices.point(Decision::direction));
  if (!next) return;
  Color onward = throughput * next->weight;
  if (!survives(wavefront, ray, choices, onward)) return;
  push_bounce(wavefront, ray, p, next->direction, onward,
              next->transmitted ? Bounce::refracted : Bounce::reflected);
  const bool scattered = wavefront.level > 0 && wavefront.paths.scattered[ray] != 0;
  wavefront.next_paths.push_back(next->pdf, from, scattered || next->pdf > 0);
}

}  // namespace oktett
