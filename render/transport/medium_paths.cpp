#include "render/transport/medium_paths.h"

#include <algorithm>
#include <span>
#include <vector>

#include "render/medium/medium_tracker.h"
#include "render/sampling/owen_sobol.h"
#include "render/transport/grouped_light.h"
#include "render/transport/integrators.h"
#include "render/transport/path.h"
#include "render/transport/path_shading.h"

namespace oktett {

void enclose_camera_rays(const RenderContext& context, Wavefront& wavefront) {
  const std::size_t count = wavefront.rays.size();
  Column<DielectricStack>& dielectrics = wavefront.paths.dielectrics;
  dielectrics.resize_uninitialized(count);
  std::fill_n(dielectrics.data(), count, context.camera_dielectrics);
  if (!context.world->has_enclosing_solids) return;
  // Where a camera has more than one place, surfaces may lie in between.
  RayBatch between;
  std::vector<std::uint32_t> away;
  for (std::uint32_t i = 0; i < count; ++i) {
    Ray ray{context.camera_place, 0, wavefront.rays.rays[i].origin - context.camera_place, 1};
    if (ray.direction == Vec3f{0, 0, 0}) continue;
    between.push_back(ray), away.push_back(i);
  }
  if (away.empty()) return;
  HitLists lists;
  all_hits(*context.world->accel, between.span(), lists, context.isa);
  for (std::uint32_t k = 0; k < away.size(); ++k)
    dielectrics[away[k]] =
        dielectrics_behind(context, context.camera_dielectrics, between[k], lists.of_ray(k));
}

TrackingNumbers tracking_numbers(const Wavefront& wavefront, std::uint32_t ray, MediumDecision decision) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint32_t number = wavefront.samples.number[sample];
  return {sequence_key(wavefront.samples.key[sample], dimension(decision, wavefront.level)), number};
}

/// The numbers that decide how far entry `ray` goes.
static SquareSample passage_point(const Wavefront& wavefront, std::uint32_t ray) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint32_t passage = dimension(MediumDecision::passage, wavefront.level);
  return sobol_point(wavefront.samples.number[sample], sequence_key(wavefront.samples.key[sample], passage));
}

void pass_media(const RenderContext& context, Wavefront& wavefront) {
  wavefront.medium_events.clear();
  for (std::uint32_t i = 0; i < wavefront.rays.size(); ++i) {
    const std::uint32_t medium =
        medium_in(*context.world, wavefront.paths.dielectrics[i], context.outer_medium);
    if (medium == kNoId) continue;
    const Ray ray = wavefront.rays.rays[i];
    const Color before = wavefront.rays.throughput[i];
    TrackingNumbers numbers = tracking_numbers(wavefront, i, MediumDecision::tracking);
    const MediumPassage passage = context.media[medium].pass({ray.origin, ray.direction, wavefront.hits.t[i]},
                                                             before, passage_point(wavefront, i), numbers);
    if (passage.scattered || !(passage.emitted == Color{0, 0, 0}))
      wavefront.medium_events.push_back({i, medium, passage});
    const Color after = passage.scattered ? Color{0, 0, 0} : passage.throughput;
    wavefront.rays.throughput.set(i, after);
    // In the mean this covers 1 - transmittance of the pixel.
    if (wavefront.rays.from_camera[i])
      wavefront.samples.alpha[wavefront.rays.sample[i]] += channel_mean(before) - channel_mean(after);
    if (!passage.scattered) continue;
    wavefront.hits.item[i] = kNoId;
    wavefront.hits.t[i] = static_cast<float>(passage.t);
  }
}

namespace {

/// How a medium scatters light, in world space: what PathShading needs, for one place.
class MediumScattering {
 public:
  using D = Simd<double, 1, ScalarIsa>;
  using F = FloatsOf<D>;
  using Surface = float;  ///< the anisotropy
  static constexpr bool kAtSurface = false;

  MediumScattering(float anisotropy, bool, const Vec3<F>& direction, const Vec3<F>&, const Vec3<F>&)
      : direction_(only_lane(direction)), anisotropy_(anisotropy) {}

  Vec3<F> to_local(const Vec3<F>& l) const { return l; }
  F::M may_scatter(const Vec3<F>&, const Vec3<F>&, const F::M&) const { return F::M::all_true(); }
  BsdfValues<D> evaluate(const Vec3<F>& l) const {
    const F value(phase_value(direction_, only_lane(l), anisotropy_));
    return {{value, value, value}, value};
  }
  BsdfSamples<D> sample(const D&, const D& x, const D& y) const {
    const Vec3f onward = phase_direction(direction_, anisotropy_, {only_lane(x), only_lane(y)});
    BsdfSamples<D> s;
    s.direction = broadcast<F>(onward);
    s.weight = {F(1.0f), F(1.0f), F(1.0f)};
    s.pdf = F(phase_value(direction_, onward, anisotropy_));
    s.found = F::M::all_true();
    s.transmitted = ~s.found;
    return s;
  }

 private:
  Vec3f direction_;
  float anisotropy_;
};

/// Shades the places where light is scattered.
void shade_scattering(const RenderContext& context, Wavefront& wavefront,
                      std::span<const MediumEvent* const> events) {
  InteractionBlock found;
  PathBlock c;
  c.count = events.size();
  std::uint32_t which[PathBlock::kMost], all[PathBlock::kMost];
  for (std::size_t k = 0; k < PathBlock::kMost; ++k) {
    const MediumEvent& event = *events[std::min(k, events.size() - 1)];
    const Ray ray = wavefront.rays.rays[event.ray];
    SurfaceInteraction place;
    place.position = ray.origin + ray.direction * static_cast<float>(event.passage.t);
    place.geometric_normal = place.shading_normal = -ray.direction;
    found.set_shape(k, place);
    which[k] = event.ray;
    all[k] = static_cast<std::uint32_t>(k);
  }
  begin_path_block(context, wavefront, which, found, c);
  for (std::size_t k = 0; k < c.count; ++k) {
    InteractionBlock::put(c.throughput, k, events[k]->passage.throughput);
    c.light_kind[k] = LightKind::none;
    c.from[k] = {};
    c.from[k].position = InteractionBlock::get(found.position, k);
    c.from[k].lists = light_lists_in(*context.world, wavefront.paths.dielectrics[c.ray[k]]);
  }
  choose_lights(context, wavefront, all, c.count, c);
  PathOutput output(wavefront, c.count);
  for (std::uint32_t k = 0; k < c.count; ++k) {
    const DielectricStack* const around = &wavefront.paths.dielectrics[c.ray[k]];
    const float anisotropy = context.media[events[k]->medium].anisotropy();
    output.shade_alone(c, k, around, around, false, RayKind::volume, [&](PathQueues& out) {
      shade_path_run<MediumScattering>(found, arriving_rays(wavefront), c, anisotropy, true, {&k, 1}, out);
    });
  }
  output.finish();
}

}  // namespace

void shade_media(const RenderContext& context, Wavefront& wavefront) {
  std::vector<const MediumEvent*> scattering;
  for (const MediumEvent& event : wavefront.medium_events) {
    wavefront.radiance.add(event.ray, event.passage.emitted);
    add_to_layer(wavefront, event.ray, 0, event.passage.emitted);
    if (event.passage.scattered && wavefront.rays.bounces[event.ray] <= context.settings.depth)
      scattering.push_back(&event);
  }
  for (std::size_t first = 0; first < scattering.size(); first += PathBlock::kMost)
    shade_scattering(
        context, wavefront,
        std::span(scattering).subspan(first, std::min(PathBlock::kMost, scattering.size() - first)));
}

}  // namespace oktett
