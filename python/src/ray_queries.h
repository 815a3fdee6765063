#pragma once
/// \file Queries on the arrays of Python: rays in rows, answers in columns. Each function works on one
/// thread. `places` are the numbers of the rays to trace, in the order in which they are traced; the answer
/// for a ray goes where its number says.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/ray.h"
#include "render/geometry.h"

namespace oktett::python {

using Places = std::span<const std::size_t>;

/// Primitives that rays pass as if they were not there: of each object one flag for each primitive from
/// number 0 on; those that have none are there.
struct IgnoredPrimitives {
  std::map<std::uint32_t, std::span<const bool>> of_object;

  bool empty() const { return of_object.empty(); }
  bool holds(std::uint32_t object, std::uint32_t primitive) const {
    const auto found = of_object.find(object);
    return found != of_object.end() && primitive < found->second.size() && found->second[primitive];
  }
};

/// Rays in rows of six floats, origin and direction, each with its interval.
struct RayRows {
  const float* rows = nullptr;
  const float* tmin = nullptr;  ///< of ray i: tmin[i * tmin_step]
  const float* tmax = nullptr;
  std::size_t tmin_step = 0, tmax_step = 0;  ///< 0: one number for all rays
  std::size_t size = 0;
};

/// Where the values of an attribute go: `components` for each hit, NaN where a hit has none.
struct AttributeColumn {
  std::string name;
  std::uint32_t components = 1;
  float* values = nullptr;
};

/// Where places go, three numbers each: as floats that count from (0, 0, 0), or, in a world that has an
/// origin, as doubles.
struct PlaceColumn {
  float* floats = nullptr;
  double* doubles = nullptr;  ///< instead
  Vec3d origin{};             ///< what is added to these

  explicit operator bool() const { return floats != nullptr || doubles != nullptr; }
  /// Place `i`; of a miss 0.
  void set(std::size_t i, const Vec3f& place) const {
    for (int k = 0; k < 3; ++k)
      if (doubles != nullptr)
        doubles[3 * i + k] = origin[k] + static_cast<double>(place[k]);
      else
        floats[3 * i + k] = place[k];
  }
  void set_miss(std::size_t i) const {
    for (int k = 0; k < 3; ++k)
      if (doubles != nullptr)
        doubles[3 * i + k] = 0;
      else
        floats[3 * i + k] = 0;
  }
};

/// Where the answers of hits go. A column that is null is not wanted.
struct HitColumns {
  float* t = nullptr;
  std::uint32_t* object = nullptr;
  std::uint32_t* primitive = nullptr;
  std::uint32_t* instance = nullptr;
  float* uv = nullptr;      ///< 2 per hit
  float* normal = nullptr;  ///< 3 per hit
  PlaceColumn position;
  float* texcoord = nullptr;  ///< 2 per hit
  std::vector<AttributeColumn> attributes;
};

/// Fills the columns of `out` but for `t` for hits, and for misses among them: what belongs to hit i at
/// places[i]. `rays`, those of the hits, are only needed for normals and positions.
void describe_hits(const World& world, const RaySpan& rays, const HitSpan& hits, Places places,
                   const HitColumns& out);

/// The nearest hits. A miss has t infinite, all ids kNoId and all else 0.
void closest_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
                  const HitColumns& out);

/// occluded[i] becomes 1 or 0.
void any_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
              std::uint8_t* occluded);

/// counts[i] becomes the number of hits.
void count_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
                std::uint32_t* counts);

/// Columns of all hits of some rays.
struct FoundHits {
  std::vector<std::size_t> begin;  ///< where the hits of each ray begin; one more than there are rays
  std::vector<float> t, uv, normal, position, texcoord;
  std::vector<std::vector<float>> attributes;
  std::vector<std::uint32_t> object, primitive, instance;
};

/// Replaces those columns of `lists` that are not null in `wanted` by the hits of the rays, in the order of
/// `places`.
void all_hits(const World& world, const RayRows& rays, Places places, const IgnoredPrimitives& ignored,
              const HitColumns& wanted, FoundHits& lists);

}  // namespace oktett::python
