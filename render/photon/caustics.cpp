#include "render/photon/caustics.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "render/photon/fingerprint.h"
#include "render/photon/trace_photons.h"

namespace oktett {

/// Below this cosine between light and surface the surface counts as lit at this cosine.
static constexpr float kLeastCosine = 1e-3f;

Caustics::Caustics(std::shared_ptr<const PhotonMap> map, const PhotonSource& source)
    : map_(std::move(map)), brings_distant_(source.brings_distant()), depth_(map_->plan.depth) {
  for (std::uint32_t i = 0; i < source.emitter_count(); ++i) brings_.push_back(source.brings(i) ? 1 : 0);
}

Color Caustics::light(std::uint32_t sample, unsigned bounces, const ShadingPoint& p,
                      const SurfaceBsdf& bsdf) const {
  const PhotonPass& pass = map_->passes[sample % map_->plan.passes];
  Color sum;
  pass.visit_near(p.surface.position, p.ng, [&](const Photon& photon, float weight) {
    if (photon.bounces + bounces > depth_) return;
    const Vec3f to_light = -unpack_direction(photon.direction);
    // Photons arrive in proportion to the cosine at the true surface.
    const float cosine = std::max(kLeastCosine, std::abs(dot(to_light, p.ng)));
    sum += bsdf.evaluate(to_light).value * photon.power * (weight / cosine);
  });
  return sum;
}

PhotonPlan photon_plan(const IntegratorSettings& settings) {
  const CausticSettings& caustics = settings.caustics;
  return {caustics.photons, std::max(caustics.passes, 1u), std::min(settings.depth, 64u), settings.seed,
          caustics.radius};
}

static std::shared_ptr<PhotonMap> trace_map(const RenderContext& context, const PhotonSource& source,
                                            const PhotonPlan& plan, std::uint32_t passes) {
  auto map = std::make_shared<PhotonMap>();
  map->plan = plan;
  // Photons that all lie in one place need some radius, too.
  const double least = 0x1p-16 * (source.target_radius() > 0 ? source.target_radius() : 1);
  double first = plan.radius;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    TracedPhotons traced = trace_photons(context, source, plan, pass);
    if (pass == 0 && first == 0) first = std::max(least, usual_radius(traced.photons));
    map->passes.emplace_back(std::move(traced.photons), static_cast<float>(pass_radius(first, pass)));
  }
  return map;
}

Caustics make_caustics(const RenderContext& context, const PhotonOptions& options) {
  // Textures are looked up as finely as they are, wherever the camera stands.
  RenderContext unseen = context;
  unseen.camera = {}, unseen.data_layers = false;
  const PhotonSource source(*context.world, *context.sampled, context.textures, find_casters(*context.world));
  const PhotonPlan plan = photon_plan(context.settings);
  if (options.given != nullptr) {
    const std::string differs = difference(*options.given, plan, fingerprint(unseen, source, plan));
    if (!differs.empty())
      throw Error(Location{options.given->path}, "the photon map is for another picture: " + differs);
    return {options.given, source};
  }
  if (!options.all_passes) {
    const IntegratorSettings& s = context.settings;
    const std::uint32_t samples = s.error > 0 ? std::max(s.samples, s.max_samples) : s.samples;
    return {trace_map(unseen, source, plan, std::min(plan.passes, samples)), source};
  }
  const std::shared_ptr<PhotonMap> map = trace_map(unseen, source, plan, plan.passes);
  map->scene = fingerprint(unseen, source, plan);
  return {map, source};
}

}  // namespace oktett
