#pragma once
/// \file Light on its way through a medium: how much passes, and where it is scattered.

#include <cstdint>
#include <limits>

#include "core/random.h"
#include "core/vec3.h"
#include "render/medium/density_grid.h"
#include "render/medium/medium.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- How a medium scatters light: the phase function of Henyey and Greenstein (1941).

/// Density per solid angle of scattering from `direction`, in which light or a path travels, into `onward`.
/// It is also the value of the phase function. `anisotropy` is clamped to kMostAnisotropy.
float phase_value(const Vec3f& direction, const Vec3f& onward, float anisotropy);

/// A direction of that density.
Vec3f phase_direction(const Vec3f& direction, float anisotropy, const SquareSample& u);

// ---- The blocks of a DensityGrid along a ray, in order (Amanatides and Woo 1987).

/// A part of a ray within one block.
struct BlockSpan {
  double begin = 0, end = 0;  ///< distances along the ray
  double most = 0;            ///< no density in it is greater
};

class BlockWalk {
 public:
  /// Origin and direction in units of cells; the part of the ray from 0 to `length` is walked.
  BlockWalk(const DensityGrid& grid, const Vec3d& origin, const Vec3d& direction, double length);

  /// The next block; false behind the last one.
  bool next(BlockSpan& span);

 private:
  const DensityGrid& grid_;
  double begin_ = 0, end_ = 0;
  int block_[3] = {}, step_[3] = {};
  double crossing_[3] = {}, across_[3] = {};  ///< distance to the next border along each axis, and between
                                              ///< two borders
};

// ---- Tracking.

/// As many random numbers as a ray needs, in order.
class TrackingNumbers {
 public:
  TrackingNumbers(std::uint64_t key, std::uint32_t sample) : key_(key), sample_(sample) {}
  /// Uniform in [0, 1).
  double next() { return static_cast<double>(random_bits(key_, sample_, count_++) >> 11) * 0x1p-53; }

 private:
  std::uint64_t key_;
  std::uint32_t sample_, count_ = 0;
};

/// The part of a ray of unit direction that lies in a medium.
struct MediumSegment {
  Vec3f origin, direction;
  double length = 0;  ///< may be infinite
};

/// What becomes of a path in a medium.
struct MediumPassage {
  bool scattered = false;
  double t = 0;            ///< distance of the place of scattering
  Color throughput;        ///< of the path behind that place, or behind the segment
  Color emitted{0, 0, 0};  ///< radiance that the medium gives off along the way, times the throughput
};

/// A medium prepared for tracking. Coefficients that are negative or NaN count as 0.
class MediumTracker {
 public:
  explicit MediumTracker(const Medium& medium);

  float anisotropy() const { return anisotropy_; }

  /// The fraction of light that passes the segment: exact in a homogeneous medium, an estimate by ratio
  /// tracking (Novák 2014, "Residual ratio tracking for estimating attenuation in participating media") on a
  /// grid.
  Color transmittance(const MediumSegment& segment, TrackingNumbers& numbers) const;

  /// Sends a path of the given throughput through the segment. The distance to the place of scattering is
  /// chosen for one colour channel, and the result is weighted by the mean density of all channels (Miller
  /// 2019, "A null-scattering path integral formulation of light transport"). Channels count by their
  /// throughput. `u.x` decides the distance and `u.y` the channel.
  ///
  /// On a grid places are chosen by the greatest extinction of a block and of all channels, and at each of
  /// them, whether the path is scattered, by the mean over the channels (Kutz 2017, "Spectral and
  /// decomposition tracking for rendering heterogeneous volumes"). Where a path would stop at more than 65536
  /// places its light is lost.
  MediumPassage pass(const MediumSegment& segment, const Color& throughput, const SquareSample& u,
                     TrackingNumbers& numbers) const;

 private:
  Color grid_transmittance(const MediumSegment& segment, TrackingNumbers& numbers) const;
  MediumPassage pass_grid(const MediumSegment& segment, const Color& throughput,
                          TrackingNumbers& numbers) const;

  Vec3d scattering_, extinction_, emission_;
  float anisotropy_;
  bool scatters_;
  std::shared_ptr<const DensityGrid> grid_;
  Affine to_cells_;  ///< from the world
  double rate_ = 0;  ///< density of the places to stop at, per density of the medium
};

}  // namespace oktett
