#pragma once
/// \file What describes a blob of points, lines and planes.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/roots/root_method.h"

namespace oktett {

/// weight / p, where p is the squared distance from a point, a line or a plane.
struct BlobSource {
  enum class Kind : std::uint8_t { point, line, plane };
  Kind kind = Kind::point;
  Vec3d at{0, 0, 0};         ///< the point, or one on the line
  Vec3d direction{0, 1, 0};  ///< of the line, or the plane's normal; not zero
  double offset = 0;         ///< direction . x = offset on the plane, with the direction's unit vector
  double weight = 1;
};
inline constexpr std::uint32_t kMaxBlobSources = roots::kMaxDegree / 2;

/// Where the sources add up to more than `iso` (Melcher, "Blobs, Typ I").
struct BlobShape {
  std::vector<BlobSource> sources;  ///< at most kMaxBlobSources
  double iso = 1;                   ///< > 0
  bool bounded = false;             ///< whether it is cut by the box; needed unless all sources are points
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};
  bool open = false;  ///< without the faces of the box
  roots::Method root_finder = roots::Method::automatic;

  static constexpr ShapeInfo kShapeInfo{"blob",
                                        "where the sum of weight / distance² of its sources exceeds `iso`"};
  void describe(auto& p) {
    p.required("sources", sources, whole(1, kMaxBlobSources),
               "points, lines and planes with weights of either sign");
    p.field("iso", iso, kPositive, "the value on the surface");
    bounded |= p.optional("bounds", SolidBox{lo, hi},
                          "a box that cuts it, and whose faces close it; required with a line or a plane");
    p.field("open", open, "without the faces of the box");
    describe_root_finder(p, root_finder);
    p.normals();
    const auto any = [this](auto&& has) { return std::any_of(sources.begin(), sources.end(), has); };
    p.nothing_if(!any([](const BlobSource& s) { return s.weight > 0; }), "no source has a positive weight");
    p.check(bounded || !any([](const BlobSource& s) { return s.kind != BlobSource::Kind::point; }), nullptr,
            "a blob with lines or planes is endless and needs 'bounds'");
  }
};

}  // namespace oktett
