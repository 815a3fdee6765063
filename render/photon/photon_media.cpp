#include "render/photon/photon_media.h"

#include <limits>
#include <map>
#include <utility>

#include "accel/accel.h"
#include "render/shading_point.h"

namespace oktett {

std::vector<EnclosureStack> start_enclosures(const RenderContext& context,
                                             std::span<const PhotonStart> starts) {
  std::vector<EnclosureStack> enclosures;
  if (!context.tracks_enclosures) return enclosures;
  enclosures.resize(starts.size());
  if (!context.world->has_enclosing_solids) return enclosures;
  std::map<std::uint32_t, std::size_t> firsts;  // by emitter
  RayBatch between;
  std::vector<std::pair<std::size_t, std::size_t>> others;  // with the first photon of the emitter
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Vec3f& place = starts[i].ray.origin;
    const auto [found, is_new] = firsts.try_emplace(starts[i].emitter, i);
    const std::size_t first = found->second;
    if (is_new) enclosures[i] = enclosures_at(context, place);
    const Ray way{starts[first].ray.origin, 0, place - starts[first].ray.origin, 1};
    if (way.direction == Vec3f{0, 0, 0})
      enclosures[i] = enclosures[first];
    else
      between.push_back(way), others.push_back({i, first});
  }
  if (others.empty()) return enclosures;
  HitLists lists;
  all_hits(*context.world->accel, between.span(), lists, context.isa);
  for (std::uint32_t k = 0; k < others.size(); ++k)
    enclosures[others[k].first] =
        enclosures_behind(context, enclosures[others[k].second], between[k], lists.of_ray(k));
  return enclosures;
}

Color passing_media(const RenderContext& context, const EnclosureStack& around, const MediumSegment& segment,
                    TrackingNumbers numbers) {
  const std::uint32_t medium = medium_in(*context.world, around, context.outer_medium);
  return medium == kNoId ? Color{1, 1, 1} : context.media[medium].transmittance(segment, numbers);
}

namespace {

/// Follows the light of one photon back to where it comes from.
Color reaching(const RenderContext& context, const PhotonStart& start, EnclosureStack around,
               const TrackingNumbers& numbers) {
  Color light{1, 1, 1};
  Ray ray{start.ray.origin, 0, -start.ray.direction, std::numeric_limits<float>::infinity()};
  for (unsigned layer = 0; layer < kMostPassages; ++layer) {
    const Hit hit = closest_hit(*context.world->accel, ray, context.isa);
    if (context.tracks_enclosures) {
      const double end = hit.valid() ? static_cast<double>(hit.t) : std::numeric_limits<double>::infinity();
      light = light * passing_media(context, around, {ray.origin, ray.direction, end}, numbers);
    }
    if (!hit.valid()) return light;
    const SurfaceInteraction s = surface_interaction(*context.world->accel, ray, hit);
    bool hidden = false;
    if (context.tracks_enclosures) {
      const Boundary boundary =
          boundary_at(*context.world, around, s, !(dot(ray.direction, s.geometric_normal) > 0));
      around = boundary.behind, hidden = boundary.hidden;
    }
    if (!hidden) light = light * transmittance(context, ray, hit, s, ShadowRule::holes_pass);
    if (light == Color{0, 0, 0}) return light;
    ray.origin = offset_origin(s, ray.direction);
  }
  return {0, 0, 0};
}

}  // namespace

std::vector<Color> reaching_start(const RenderContext& context, std::span<const PhotonStart> starts,
                                  std::span<const EnclosureStack> around,
                                  std::span<const TrackingNumbers> numbers) {
  std::vector<Color> light(starts.size(), Color{1, 1, 1});
  // Few scenes have anything in this way, and one look at all rays finds those.
  RayBatch outward;
  std::vector<std::size_t> distant;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!starts[i].distant) continue;
    outward.push_back({starts[i].ray.origin, 0, -starts[i].ray.direction});
    distant.push_back(i);
  }
  if (distant.empty()) return light;
  std::vector<std::uint8_t> meets(distant.size());
  any_hit(*context.world->accel, outward, meets, context.isa);
  for (std::size_t k = 0; k < distant.size(); ++k) {
    const std::size_t i = distant[k];
    if (!meets[k] && !context.tracks_enclosures) continue;
    light[i] = reaching(context, starts[i], around.empty() ? EnclosureStack{} : around[i], numbers[i]);
  }
  return light;
}

}  // namespace oktett
