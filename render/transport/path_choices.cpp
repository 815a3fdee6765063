#include "render/transport/path_choices.h"

#include <algorithm>
#include <cmath>

#include "render/sampling/owen_sobol.h"
#include "render/transport/direct_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path_emission.h"
#include "render/transport/path_numbers.h"

namespace oktett {

Choices::Choices(const Wavefront& wavefront, std::size_t ray)
    : pixel_(wavefront.samples.key[wavefront.rays.sample[ray]]),
      sample_(wavefront.samples.number[wavefront.rays.sample[ray]]),
      level_(wavefront.level) {}

std::uint64_t Choices::key(Decision decision) const {
  return sequence_key(pixel_, dimension(decision, level_));
}
float Choices::number(Decision decision) const { return sobol_number(sample_, key(decision)); }
SquareSample Choices::point(Decision decision) const { return sobol_point(sample_, key(decision)); }

std::optional<LightSample> choose_light(const RenderContext& context, const LightPoint& from,
                                        const Choices& choices) {
  const double which = choices.point(Decision::light).x;
  return context.sampled->set().sample(from, which, choices.point(Decision::light_place));
}

Color light_found(const RenderContext& context, const Color& throughput, const LightSample& light,
                  const BsdfValue& scattered) {
  const float weight = light.delta ? 1 : power_weight(light.pdf, scattered.pdf);
  return throughput * scattered.value *
         (light.radiance * context.sampled->texture_at(light, context.textures)) * (weight / light.pdf);
}

/// See kLeastGap.
static float before_surface(const Vec3f& light, float distance) {
  const float blur = kPlaceError * max_component(abs(light)) / distance;
  return 1 - std::max(kLeastGap, std::min(blur, 0.5f));
}

void queue_light(Wavefront& wavefront, std::size_t ray, const Vec3f& origin, const LightPoint& from,
                 const LightSample& light, const Color& arriving, bool straight,
                 const EnclosureStack* around) {
  if (arriving == Color{0, 0, 0}) return;
  Ray shadow;
  shadow.origin = origin;
  shadow.direction = light.direction;
  if (std::isfinite(light.distance)) {
    const Vec3f place = from.position + light.direction * light.distance;
    shadow.direction = place - shadow.origin;
    shadow.tmax = light.delta ? kBeforeLight : before_surface(place, light.distance);
  }
  if (!wavefront.sampled_emitter.empty()) wavefront.sampled_emitter[ray] = light.emitter;
  ShadowQueue& queue = wavefront.shadows[straight ? 0 : kAreaQueue];
  queue.push_back(shadow, static_cast<std::uint32_t>(ray), arriving);
  if (around != nullptr) queue.enclosures.push_back(*around);
}

bool survives(const Wavefront& wavefront, std::size_t ray, const Choices& choices, const Color& kept,
              Color& throughput) {
  if (wavefront.rays.bounces[ray] + 1u <= kSureBounces) return true;
  const float chance = std::min(1.0f, std::sqrt(max_component(kept)));
  if (choices.number(Decision::roulette) >= chance) return false;
  throughput *= 1 / chance;
  return true;
}

}  // namespace oktett
