#include "render/area_lights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <variant>

#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"

namespace oktett {
namespace {

/// Pixels of a block of 4 x 4 have one pattern each.
constexpr std::uint32_t kPlaces = 16;
/// No more points than this are made; samples of a pixel share patterns before.
constexpr std::uint32_t kMostPoints = 1u << 16;
/// Radiance times area of all emitters together: more would not be finite as a float.
constexpr double kMostWeight = 1e38;
/// The key of the points' random numbers.
constexpr std::uint32_t kDimension = 0xfffffffeu;

/// A point of an emitter, with what LightSample says of it.
struct EmitterPoint {
  Vec3d place, normal;
  double u = 0, v = 0;
};

double area_of(const TriangleEmitter& e) {
  return length(cross(Vec3d(e.b) - Vec3d(e.a), Vec3d(e.c) - Vec3d(e.a))) / 2;
}
EmitterPoint point_of(const TriangleEmitter& e, const SquareSample& s) {
  const Vec3d a(e.a), u = Vec3d(e.b) - a, v = Vec3d(e.c) - a;
  const double root = std::sqrt(s.x), x = root * (1 - s.y), y = root * s.y;
  return {a + u * x + v * y, cross(u, v), x, y};
}

double area_of(const RectangleEmitter& e) { return length(cross(Vec3d(e.edge_u), Vec3d(e.edge_v))); }
EmitterPoint point_of(const RectangleEmitter& e, const SquareSample& s) {
  const Vec3d u(e.edge_u), v(e.edge_v);
  return {Vec3d(e.corner) + u * s.x + v * s.y, cross(u, v), s.x, s.y};
}

double area_of(const DiskEmitter& e) { return std::numbers::pi * e.radius * e.radius; }
EmitterPoint point_of(const DiskEmitter& e, const SquareSample& s) {
  const SquareSample at = disk_point(s);
  const Vec3d n(e.normal);
  Vec3d x, y;
  make_basis(n, x, y);
  return {Vec3d(e.center) + (x * at.x + y * at.y) * double{e.radius}, n};
}

double area_of(const SphereEmitter& e) { return 4 * std::numbers::pi * e.radius * e.radius; }
EmitterPoint point_of(const SphereEmitter& e, const SquareSample& s) {
  // Both halves are disks whose areas are kept (Lambert's projection).
  const bool upper = s.x < 0.5;
  const SquareSample at = disk_point({upper ? 2 * s.x : 2 * s.x - 1, s.y});
  const double square = at.x * at.x + at.y * at.y, across = std::sqrt(2 - square), up = 1 - square;
  const Vec3d n{at.x * across, at.y * across, upper ? up : -up};
  return {Vec3d(e.center) + n * double{e.radius}, n};
}

template <class E>
constexpr bool kHasArea = requires(const E& e) {
  area_of(e);
};

/// What the choice of a surface needs.
struct WeighedArea {
  std::uint32_t emitter;
  double area, weight, sum;  ///< `sum`: of the weights up to and with this one
};

std::vector<WeighedArea> areas_of(const std::vector<Emitter>& emitters) {
  std::vector<WeighedArea> areas;
  double sum = 0;
  for (std::uint32_t i = 0; i < emitters.size(); ++i)
    std::visit(
        [&]<class E>(const E& e) {
          if constexpr (kHasArea<E>) {
            const double area = area_of(e), weight = area * double{color_weight(e.radiance)};
            if (!(weight > 0 && sum + weight < kMostWeight)) return;
            sum += weight;
            areas.push_back({i, area, weight, sum});
          }
        },
        emitters[i]);
  return areas;
}

/// The point that `s` chooses, as a light that gives its share of the light of `count` of them.
LightSource light_at(const SceneLights& lights, const TextureSampler* textures,
                     const std::vector<WeighedArea>& areas, SquareSample s, std::uint32_t count) {
  const double target = s.x * areas.back().sum;
  const auto above = [](double sum, const WeighedArea& chosen) { return sum < chosen.sum; };
  const auto found = std::upper_bound(areas.begin(), areas.end() - 1, target, above);
  const WeighedArea& chosen = *found;
  s.x = std::clamp((target - (chosen.sum - chosen.weight)) / chosen.weight, 0.0, 0x1.fffffffffffffp-1);
  LightSource light;
  std::visit(
      [&]<class E>(const E& e) {
        if constexpr (kHasArea<E>) {
          const EmitterPoint p = point_of(e, s);
          light.place = Vec3f(p.place), light.axis = Vec3f(normalize(p.normal));
          light.back = e.both_sides ? 1.0f : 0.0f;
          LightSample sample{};
          sample.emitter = chosen.emitter, sample.u = static_cast<float>(p.u),
          sample.v = static_cast<float>(p.v);
          const double share = chosen.area * areas.back().sum / (chosen.weight * std::numbers::pi * count);
          light.color = Color(Vec3d(e.radiance * lights.texture_at(sample, textures)) * share);
        }
      },
      lights.set().emitters()[chosen.emitter]);
  light.glows = light.falloff = true;
  light.list = lights.set().list(chosen.emitter);
  light.lift = 0x1p-20f * max_component(abs(light.place));
  return light;
}

}  // namespace

std::uint32_t AreaLights::pattern(std::uint32_t x, std::uint32_t y, std::uint32_t sample) const {
  if (at_random) {
    const std::uint64_t pixel = std::uint64_t{y} << 32 | x;
    return static_cast<std::uint32_t>((mix_bits(key + pixel * kGoldenBits) + sample) % patterns);
  }
  // Bits of the place in its block such that next neighbours differ in the highest one.
  const std::uint32_t place = (x ^ y) % 2 << 3 | y % 2 << 2 | (x / 2 ^ y / 2) % 2 << 1 | y / 2 % 2;
  return ((place + sample) % kPlaces + sample / kPlaces * kPlaces) % patterns;
}

AreaLights area_lights(const SceneLights& lights, const TextureSampler* textures,
                       const IntegratorSettings& settings) {
  AreaLights area;
  if (!traits(settings.kind).light_from_points || settings.light_samples == 0) return area;
  const std::vector<WeighedArea> areas = areas_of(lights.set().emitters());
  if (areas.empty()) return area;
  area.samples = settings.light_samples,
  area.penumbra = std::bit_floor(std::clamp(settings.penumbra_factor, 1u, kPlaces));
  // As many as a pixel has samples, if they are not too many.
  const std::uint32_t most = std::max(kMostPoints / area.samples / kPlaces, 1u);
  const std::uint32_t samples = std::max(settings.samples, settings.error > 0 ? settings.max_samples : 1);
  area.patterns = kPlaces * std::min((samples - 1) / kPlaces + 1, most);
  const std::uint64_t key = sequence_key(mix_bits(settings.seed), kDimension);
  area.at_random = settings.error > 0, area.key = mix_bits(key);
  for (std::uint32_t i = 0; i < area.patterns * area.samples; ++i)
    area.points.push_back(light_at(lights, textures, areas, sobol_point(i, key), area.samples));
  return area;
}

}  // namespace oktett
