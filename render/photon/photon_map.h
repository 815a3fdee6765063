#pragma once
/// \file Photons that can be found by place.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

// ---- A photon that has arrived at a surface, as it is kept in memory and in files.

/// Light that reaches a surface after mirrors or glass alone, in 32 bytes.
struct Photon {
  Vec3f position;
  /// In W per colour channel, divided by the square of the index of refraction around the surface, as
  /// radiance is in render/bsdf/bsdf.h.
  Color power;
  std::uint32_t direction = 0;    ///< in which the light travels, see pack_direction
  std::uint16_t bounces = 0;      ///< at mirrors and glass, > 0
  std::uint16_t light_group = 0;  ///< number of the light's, see LightGroups
  bool operator==(const Photon&) const = default;
};
static_assert(sizeof(Photon) == 32);

/// A unit vector in 32 bits: 16 for each coordinate on an octahedron that is folded flat (Cigolle et al.
/// 2014, JCGT 3(2)). The angle to the vector is below 1e-4.
std::uint32_t pack_direction(const Vec3f& direction);
/// The unit vector that pack_direction made `packed` of, nearly. Any number gives a unit vector.
Vec3f unpack_direction(std::uint32_t packed);

/// The photons of one pass, ordered by the cell of a hashed grid, those of a cell by their numbers. The edge
/// of a cell is a little more than twice the radius, so a search looks at no more than eight cells.
class PhotonPass {
 public:
  PhotonPass() = default;
  /// `photons` in the order of their numbers; `radius` > 0.
  PhotonPass(Column<Photon> photons, float radius);

  float radius() const { return radius_; }
  const Column<Photon>& photons() const { return photons_; }

  /// Calls visit(photon, weight) in a fixed order for the photons in a cylinder about the unit vector
  /// `normal`, whose radius is that of the pass and which reaches a quarter of it up and down. The weights of
  /// a place are a density on the plane (Epanechnikov's kernel): their integral over the plane is 1.
  template <class Visit>
  void visit_near(const Vec3f& position, const Vec3f& normal, Visit&& visit) const {
    if (photons_.empty()) return;
    std::uint32_t buckets[8];
    const int count = buckets_near(position, buckets);
    const float square = radius_ * radius_, half = radius_ / 4;
    const float most = 2 / (3.14159265f * square);
    for (int k = 0; k < count; ++k)
      for (std::uint32_t i = start_[buckets[k]]; i < start_[buckets[k] + 1]; ++i) {
        const Vec3f to = photons_[i].position - position;
        const float up = dot(to, normal), across = dot(to, to) - up * up;
        if (across < square && std::abs(up) < half) visit(photons_[i], most * (1 - across / square));
      }
  }

 private:
  std::int64_t cell(double x) const {
    return static_cast<std::int64_t>(std::clamp(std::floor(x * per_cell_), -0x1p60, 0x1p60));
  }
  std::uint32_t bucket(std::int64_t x, std::int64_t y, std::int64_t z) const;
  /// The different buckets of the cells within the radius.
  int buckets_near(const Vec3f& p, std::uint32_t (&buckets)[8]) const;

  Column<Photon> photons_;
  Column<std::uint32_t> start_;  ///< of each bucket; one more than there are
  std::uint32_t mask_ = 0;       ///< number of buckets less 1
  float radius_ = 1;
  double per_cell_ = 0.499;
};

/// What photons are traced for a scene.
struct PhotonPlan {
  std::uint32_t photons = 0;  ///< emitted per pass
  std::uint32_t passes = 0;
  std::uint32_t depth = 0;  ///< most bounces
  std::uint32_t seed = 0;
  double radius = 0;  ///< of the first pass in world units; 0: chosen by the photons of the first pass
  std::uint32_t moments = 1;  ///< at which the scene stands differently; pass p is of moment p modulo moments
  bool operator==(const PhotonPlan&) const = default;
};

/// What the photons of a map depend on: hashes of parts of the scene. Camera and film are in none of them.
struct SceneFingerprint {
  std::uint64_t geometry = 0, materials = 0, lights = 0;
  bool operator==(const SceneFingerprint&) const = default;
};

/// The photons of all passes.
struct PhotonMap {
  PhotonPlan plan;
  SceneFingerprint scene;
  std::vector<PhotonPass> passes;
  std::string path;  ///< of the file that it was read from, for messages; else empty

  std::size_t photon_count() const {
    std::size_t count = 0;
    for (const PhotonPass& pass : passes) count += pass.photons().size();
    return count;
  }
};

/// The radius of pass number `pass` of a map whose first pass has the radius `first`: its square shrinks by
/// (i + a) / (i + 1), a = 2/3, in step i = 1, 2, ... (Knaus and Zwicker 2011, ACM TOG 30(3)). So the variance
/// of the mean of n passes falls as n^-2/3 and its bias as n^-1/3.
double pass_radius(double first, std::uint32_t pass);

/// The radius that suits photons: around half of them it holds at least 32 others. 0 if there are fewer than
/// two.
double usual_radius(const Column<Photon>& photons);

}  // namespace oktett
