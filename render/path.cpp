#include <algorithm>

#include "render/direct_light.h"
#include "render/integrators.h"
#include "render/sample_dimensions.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"
#include "render/specular.h"

namespace oktett {
namespace {

/// Bounces before Russian roulette begins.
constexpr unsigned kSureBounces = 3;
constexpr float kMostSurvival = 0.95f;

std::uint64_t key_of(const Wavefront& wavefront, std::uint32_t sample, Decision decision) {
  return sequence_key(wavefront.samples.key[sample], dimension(decision, wavefront.level));
}

float random_number(const Wavefront& wavefront, std::uint32_t sample, Decision decision) {
  return sobol_number(wavefront.samples.number[sample], key_of(wavefront, sample, decision));
}

/// Russian roulette: ends paths of small weight at random and raises the weight of the others, so that the
/// mean does not change. False if the path ends.
bool survives(const Wavefront& wavefront, std::size_t ray, Color& throughput) {
  if (wavefront.rays.bounces[ray] + 1u <= kSureBounces) return true;
  const float chance = std::min(kMostSurvival, max_component(throughput));
  if (random_number(wavefront, wavefront.rays.sample[ray], Decision::roulette) >= chance) return false;
  throughput *= 1 / chance;
  return true;
}

void push_path(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p, const Vec3f& towards,
               Color throughput, Bounce bounce) {
  if (survives(wavefront, ray, throughput)) push_bounce(wavefront, ray, p, towards, throughput, bounce);
}

void push_diffuse(Wavefront& wavefront, std::size_t ray, const ShadingPoint& p, const Color& throughput) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const SquareSample at =
      sobol_point(wavefront.samples.number[sample], key_of(wavefront, sample, Decision::direction));
  const Vec3f towards = cosine_direction(p.ns, at);
  if (dot(towards, p.ng) <= 0) return;
  push_path(wavefront, ray, p, towards, throughput, Bounce::reflected);
}

}  // namespace

void shade_path(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const Color throughput = wavefront.rays.throughput[ray];
  const std::uint32_t sample = wavefront.rays.sample[ray];
  if (p.opacity < 1 && random_number(wavefront, sample, Decision::hole) >= p.opacity)
    return push_bounce(wavefront, ray, p, p.direction, throughput, Bounce::straight);

  wavefront.radiance.add(ray, throughput * p.emission);
  add_direct_light(context, p, throughput, static_cast<std::uint32_t>(ray), wavefront.shadows);
  if (wavefront.rays.bounces[ray] >= context.settings.depth) return;

  const SpecularRays specular = specular_rays(p);
  const Color diffuse = p.color * p.material->diffuse;
  const float weight[3] = {max_component(diffuse), max_component(specular.mirror),
                           max_component(specular.refracted)};
  const float sum = weight[0] + weight[1] + weight[2];
  if (!(sum > 0)) return;
  const float at = random_number(wavefront, sample, Decision::lobe) * sum;
  if (at < weight[0]) {
    push_diffuse(wavefront, ray, p, throughput * diffuse * (sum / weight[0]));
  } else if (at < weight[0] + weight[1]) {
    push_path(wavefront, ray, p, specular.mirror_direction, throughput * specular.mirror * (sum / weight[1]),
              Bounce::reflected);
  } else if (weight[2] > 0) {
    push_path(wavefront, ray, p, specular.refracted_direction,
              throughput * specular.refracted * (sum / weight[2]), Bounce::refracted);
  }
}

}  // namespace oktett
