#pragma once
/// \file The random choices of a path, and the weights of what they find: shared by surfaces and media.

#include <cstdint>
#include <optional>

#include "render/bsdf/lobes.h"
#include "render/light/light_sample.h"
#include "render/sampling/square_sample.h"
#include "render/transport/sample_dimensions.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// The random numbers of one sample at one bounce.
class Choices {
 public:
  /// Those of entry `ray` of the wavefront's rays.
  Choices(const Wavefront& wavefront, std::size_t ray);

  float number(Decision decision) const;
  SquareSample point(Decision decision) const;

 private:
  std::uint64_t key(Decision decision) const;

  std::uint64_t pixel_;
  std::uint32_t sample_;
  unsigned level_;
};

/// A light chosen at random for the point `from`, if it can give light there.
std::optional<LightSample> choose_light(const RenderContext& context, const LightPoint& from,
                                        const Choices& choices);

/// What scattering makes of the light of a sample: with the throughput of entry `ray`, and weighted against
/// rays that could find the light by chance.
Color light_found(const RenderContext& context, const Color& throughput, const LightSample& light,
                  const BsdfValue& scattered);

/// Queues the shadow ray of entry `ray` from `origin`, at or beside `from`, to a light sample that gives
/// `arriving` if nothing is in between. `straight`: it passes glass without being bent. `around`: the solids
/// at the origin; null unless the scene tracks them.
void queue_light(Wavefront& wavefront, std::size_t ray, const Vec3f& origin, const LightPoint& from,
                 const LightSample& light, const Color& arriving, bool straight,
                 const EnclosureStack* around);

/// Russian roulette: ends paths of small weight at random and raises the `throughput` of the others, so that
/// the mean does not change. `kept` is what the path is to go on by, see kSureBounces. False if the path
/// ends.
bool survives(const Wavefront& wavefront, std::size_t ray, const Choices& choices, const Color& kept,
              Color& throughput);

}  // namespace oktett
