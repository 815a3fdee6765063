#pragma once
/// \file A tree whose boxes move along straight lines, over moving triangles and over items that only a
/// callback can test.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "accel/hit_sink.h"
#include "accel/node.h"
#include "core/pages.h"
#include "kernels/triangle/triangle_block.h"

namespace oktett {

/// The corners of eight triangles at one key: [corner][axis][lane].
struct MovingCorners {
  float at[3][3][TriangleBlock::kSize];
};

/// A time as a place between two keys: (1 - f) of `key` and f of the next one.
struct KeyTime {
  std::uint32_t key = 0;
  float f = 0;

  /// Of `keys` keys that are equally far apart from time 0 to 1.
  OKTETT_INLINE static KeyTime of(float time, std::uint32_t keys) {
    if (keys < 2 || !(time > 0)) return {};
    const float at = (time < 1 ? time : 1.0f) * static_cast<float>(keys - 1);
    const std::uint32_t key =
        static_cast<std::uint32_t>(at) < keys - 1 ? static_cast<std::uint32_t>(at) : keys - 2;
    return {key, at - static_cast<float>(key)};
  }
  /// A number between its values at both keys, as everything that moves is interpolated. Rounding is
  /// monotone, so what is at most b at both keys is at most the interpolated b in between: boxes hold what
  /// they held at the keys.
  OKTETT_INLINE float between(float a, float b) const { return (1 - f) * a + f * b; }
};

/// The tree. Its items are numbered by the caller.
struct TimeTree {
  std::uint32_t keys = 1;
  NodeRef root = NodeRef::none();
  Box bounds;       ///< at all times
  Box first, last;  ///< at the first and the last key
  /// The boxes at each key. The links are those of the first; unused children have boxes that are turned
  /// inside out, of finite numbers.
  std::vector<VirtualArray<BvhNode>> nodes;
  /// Of Kind::box: `begin` is a block of moving triangles; of Kind::instance: an item that is called.
  std::vector<LeafEntry> leaves;
  std::vector<MovingCorners> corners;  ///< of block b at key k: number b * keys + k
  std::vector<std::array<std::uint32_t, TriangleBlock::kSize>> block_items;
  std::vector<std::uint32_t> called_items;
};

/// What stands in a tree, for the builder.
class TimeSource {
 public:
  virtual ~TimeSource() = default;
  virtual std::uint32_t count() const = 0;
  virtual bool is_triangle(std::uint32_t item) const = 0;
  virtual void corners(std::uint32_t item, std::uint32_t key, Vec3f (&v)[3]) const = 0;
  /// Of items that are no triangles.
  virtual Box bounds(std::uint32_t item, std::uint32_t key) const = 0;
};

/// Items that are not finite at some key, or have no bounds there, are left out.
std::unique_ptr<TimeTree> build_time_tree(std::uint32_t keys, const TimeSource& source,
                                          const BuildOptions& options);

/// What a ray on its way through a tree calls.
struct TimeCalls {
  void* self;
  /// A triangle is hit at hit.t by the ray, as its nearest hit so far: whether that counts. Null: all count.
  bool (*accept)(void* self, const Hit& hit);
  /// Tests an item that is no triangle with the ray, which ends at its nearest hit so far, `hit`, if that is
  /// valid. Returns true and sets t, u and v if there is one that counts instead.
  bool (*test)(void* self, std::uint32_t item, const Ray& ray, Hit& hit);
};

/// The nearest hit of a ray whose range ends at its nearest hit so far; Hit::item is the item of the tree.
struct TimeCode {
  Hit (*closest_hit)(const TimeTree&, const Ray&, float time, const TimeCalls&);
  Hit (*any_hit)(const TimeTree&, const Ray&, float time, const TimeCalls&);
};

template <class A>
const TimeCode& time_code();
/// Throws Error if this build holds no code for the set.
const TimeCode& time_code(Isa isa);

}  // namespace oktett
