#pragma once
/// \file Path tracing, as far as surfaces and media share it.

#include <cstddef>

#include "render/transport/path_block.h"
#include "render/transport/wavefront.h"

namespace oktett {

/// Veach's power heuristic for a light that two ways of sampling can find with these densities: the weight of
/// the first.
float power_weight(float pdf, float other);

/// Whether entry `ray` came from mirrors or glass that were met after a surface that scatters otherwise: the
/// lights that it meets are those that photons bring.
inline bool is_caustic(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  return context.caustics != nullptr && wavefront.level > 0 && wavefront.paths.pdf[ray] == 0 &&
         wavefront.paths.scattered[ray] != 0;
}

/// Fills a block of the hits of rays `which`, `c.count` of them, up to the random numbers.
void begin_path_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                      const InteractionBlock& found, PathBlock& c);

/// Chooses a light for each of the `count` entries listed in `entry`, whose `from` is set.
void choose_lights(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* entry,
                   std::size_t count, PathBlock& c);

/// The queues of a wavefront, open for the rays that leave the places of a block.
class PathOutput {
 public:
  /// At most so many places send rays.
  PathOutput(Wavefront& wavefront, std::size_t places);

  PathQueues& queues() { return queues_; }

  /// Shades one place: `shade(PathQueues&)` writes its rays. `around` and `behind`: the solids at the place,
  /// before and behind the surface; null unless the scene tracks them. `scatters`: a direction that is not
  /// one of finitely many counts as scattered, see PathColumns.
  /// `reflected`: the kind of rays that are not transmitted.
  template <class Shade>
  void shade_alone(const PathBlock& c, std::size_t k, const DielectricStack* around,
                   const DielectricStack* behind, bool scatters, RayKind reflected, Shade&& shade) {
    const PathQueues before = queues_;
    shade(queues_);
    note_alone(before, c, k, around, behind, scatters, reflected);
  }

  /// Closes the queues. Nothing else may have been pushed to them.
  void finish();

 private:
  void note_alone(const PathQueues& before, const PathBlock& c, std::size_t k, const DielectricStack* around,
                  const DielectricStack* behind, bool scatters, RayKind reflected);

  Wavefront& wavefront_;
  std::size_t deltas_, areas_, onward_;  ///< sizes of the queues before
  PathQueues queues_;
};

}  // namespace oktett
