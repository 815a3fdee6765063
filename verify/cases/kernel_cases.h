#pragma once
/// \file Pairs of a ray and a shape that try a kernel, each a function of its number alone.

#include <cstdint>

#include "core/ray.h"
#include "core/soa.h"
#include "verify/probes/kernel_probe.h"

namespace oktett {

/// What kind of difficulty a pair stands for.
enum class CaseClass : std::uint8_t {
  random,
  axis,     ///< the direction has one component
  vertex,   ///< aimed at a corner, or at the centre of what has none
  edge,     ///< aimed at an edge, a rim or a silhouette
  grazing,  ///< nearly along the surface
  far,      ///< everything stands at (148376, 1234, -223423)
  huge,     ///< coordinates of 1e15 to 1e30
  tiny,     ///< coordinates of 1e-15 to 1e-25
};
inline constexpr int kCaseClasses = 8;
inline constexpr int kKernels = 11;
const char* to_string(CaseClass c);
const char* to_string(KernelId id);

/// Random numbers that depend on a key and on how many were drawn.
class CaseRandom {
 public:
  explicit CaseRandom(std::uint64_t key) : key_(key) {}
  std::uint64_t bits();
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double sign() { return 2 * unit() - 1; }
  Vec3d vector();
  /// 10^x with x uniform in [lo, hi].
  double magnitude(double lo, double hi);

 private:
  std::uint64_t key_, drawn_ = 0;
};

/// Columns of pairs as KernelProbe wants them.
struct KernelCases {
  RayBatch rays;
  Column<float> corner[3][3];
  Column<double> shape[12];

  /// Pairs `first`, `first` + 1, ... of class `c`.
  void fill(KernelId id, CaseClass c, std::uint64_t first, std::size_t count);
  /// All columns from position `begin` on; results are left to the caller.
  KernelProbe run(std::size_t begin, std::size_t count) const;
};

}  // namespace oktett
