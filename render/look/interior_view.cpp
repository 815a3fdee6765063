/// \file Finds out whether a mesh is a room, and a view from inside.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "accel/accel.h"
#include "core/math.h"
#include "core/random.h"
#include "render/camera.h"
#include "render/look/mesh_view.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"

namespace oktett {
namespace {

/// Shares of the surface, from 0 to 1.
struct Exposure {
  double front = 0, back = 0;  ///< that who stands outside sees from the front, from the back
  double hidden = 0;           ///< that he sees from neither side
};

/// A triangle mesh as rays see it.
class Explorer {
 public:
  explicit Explorer(const TriangleMesh& mesh) : mesh_(mesh) {
    std::vector<Geometry> geometries(1);
    geometries[0].shape = MeshGeometry{&mesh, false, TriangleTest::watertight};
    BuildOptions options;
    options.quality = BuildQuality::fast;
    accel_ = build_accel(std::move(geometries), options);
    box_ = bounds(*accel_);
    size_ = length(Vec3d(box_.extent()));
  }

  const Box& box() const { return box_; }
  double size() const { return size_; }

  Exposure exposure() const {
    constexpr std::uint32_t kPoints = 1024, kRays = 4;
    const std::vector<std::uint32_t> triangles = triangles_by_area(kPoints);
    std::vector<Ray> rays;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) add_rays(triangles[i], i, kRays, rays);
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(*accel_, rays, occluded);
    Exposure e;
    for (std::size_t i = 0; i < rays.size(); i += 2 * kRays) {
      const auto free = [&](std::size_t first) {
        return std::count(&occluded[first], &occluded[first] + kRays, 0) > 0;
      };
      const bool front = free(i), back = free(i + kRays);
      e.front += front, e.back += back, e.hidden += !front && !back;
    }
    const double count = std::max(1.0, static_cast<double>(triangles.size()));
    return {e.front / count, e.back / count, e.hidden / count};
  }

  /// Distances along unit directions, infinite where nothing is hit.
  std::vector<float> distances(const std::vector<Ray>& rays) const {
    std::vector<Hit> hits(rays.size());
    closest_hit(*accel_, rays, hits);
    std::vector<float> t;
    for (const Hit& hit : hits) t.push_back(hit.t);
    return t;
  }

 private:
  Vec3d corner(std::uint32_t triangle, std::uint32_t k) const {
    return Vec3d(mesh_.positions[mesh_.indices[3 * std::size_t{triangle} + k]]);
  }
  Vec3d area_vector(std::uint32_t triangle) const {
    const Vec3d a = corner(triangle, 0);
    return cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
  }

  /// `count` triangles in equal steps of area.
  std::vector<std::uint32_t> triangles_by_area(std::uint32_t count) const {
    const auto triangles = static_cast<std::uint32_t>(mesh_.triangle_count());
    double total = 0;
    for (std::uint32_t i = 0; i < triangles; ++i) total += length(area_vector(i));
    std::vector<std::uint32_t> chosen;
    double sum = 0;
    for (std::uint32_t i = 0; i < triangles && chosen.size() < count; ++i) {
      sum += length(area_vector(i));
      while (chosen.size() < count && sum > (static_cast<double>(chosen.size()) + 0.5) * total / count)
        chosen.push_back(i);
    }
    return chosen;
  }

  /// Rays from a random point of the triangle, first to the front, then to the back.
  void add_rays(std::uint32_t triangle, std::uint32_t number, std::uint32_t count,
                std::vector<Ray>& rays) const {
    const SquareSample place = sobol_point(number, mix_bits(1));
    const double root = std::sqrt(place.x), u = root * place.y, v = 1 - root;
    const Vec3d a = corner(triangle, 0);
    const Vec3d p = a + (corner(triangle, 1) - a) * u + (corner(triangle, 2) - a) * v;
    const Vec3d n = normalize(area_vector(triangle));
    for (int side = 0; side < 2; ++side)
      for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3f out(side == 0 ? n : -n);
        Ray ray;
        ray.direction = cosine_direction(out, sobol_point(number * count + i, mix_bits(2 + side)));
        ray.origin = Vec3f(p + Vec3d(out) * (1e-5 * size_));
        rays.push_back(ray);
      }
  }

  const TriangleMesh& mesh_;
  std::shared_ptr<const Accel> accel_;
  Box box_;
  double size_;
};

/// Looks for a good view from inside.
class ViewSearch {
 public:
  ViewSearch(const Explorer& room, const Vec3d& up, const Film& film) : room_(room), film_(film) {
    up_ = normalize(up);
    make_basis(up_, across_, along_);
  }

  Camera best() const {
    Camera best;
    double best_score = -kInfinity;
    for (const Vec3d& place : places())
      for (int turn = 0; turn < kTurns; ++turn) {
        const Camera camera = view(place, turn);
        const double found = score(camera);
        if (found > best_score) best = camera, best_score = found;
      }
    return best;
  }

  /// The direction from which most of what the camera sees is lit.
  std::optional<Vec3d> sun(const Camera& camera) const {
    constexpr double kLeastShare = 0.04;
    const std::vector<Ray> seen = sight(camera);
    const std::vector<float> t = room_.distances(seen);
    std::vector<Vec3d> candidates;
    for (const double elevation : {70, 58, 46, 35})
      for (int turn = 0; turn < kTurns; ++turn)
        candidates.push_back(up_ * portable::sin(elevation * kDegree) +
                             heading(turn) * portable::cos(elevation * kDegree));
    std::vector<Ray> rays;
    for (const Vec3d& direction : candidates)
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const double distance = std::isfinite(t[i]) ? t[i] : 0;
        rays.push_back(ray(
            Vec3d(seen[i].origin) + Vec3d(seen[i].direction) * (distance - 1e-4 * room_.size()), direction));
      }
    const std::vector<float> way = room_.distances(rays);
    std::size_t best = 0, most = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      std::size_t lit = 0;
      for (std::size_t i = 0; i < seen.size(); ++i)
        lit += std::isfinite(t[i]) && !std::isfinite(way[c * seen.size() + i]);
      if (lit > most) best = c, most = lit;
    }
    if (static_cast<double>(most) < kLeastShare * static_cast<double>(seen.size())) return std::nullopt;
    return candidates[best];
  }

 private:
  static constexpr int kTurns = 16, kColumns = 12, kRows = 8;
  static constexpr double kFov = 58;

  /// Free places in the lower half of the room that have walls around them.
  std::vector<Vec3d> places() const {
    constexpr int kGrid = 9;
    const Vec3d lo(room_.box().lo), hi(room_.box().hi);
    std::vector<Vec3d> candidates;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j)
        for (const double height : {0.15, 0.25, 0.4}) {
          const double f[2] = {(i + 1.0) / (kGrid + 1), (j + 1.0) / (kGrid + 1)};
          Vec3d p;
          for (int axis = 0, flat = 0; axis < 3; ++axis) {
            const bool vertical = axis == dominant_axis(up_);
            const double part = vertical ? (up_[axis] > 0 ? height : 1 - height) : f[flat++];
            p[axis] = lo[axis] + (hi[axis] - lo[axis]) * part;
          }
          candidates.push_back(p);
        }
    std::vector<Ray> rays;
    for (const Vec3d& p : candidates)
      for (int turn = 0; turn < kTurns; ++turn) rays.push_back(ray(p, heading(turn)));
    const std::vector<float> t = room_.distances(rays);
    std::vector<Vec3d> places;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const auto begin = t.begin() + static_cast<std::ptrdiff_t>(i * kTurns), end = begin + kTurns;
      const bool free = *std::min_element(begin, end) > 0.02 * room_.size();
      const bool inside = std::count_if(begin, end, [](float x) { return std::isfinite(x); }) > kTurns / 2;
      if (free && inside) places.push_back(candidates[i]);
    }
    return places;
  }

  Vec3d heading(int turn) const {
    const double angle = 2 * std::numbers::pi * turn / kTurns;
    return across_ * portable::cos(angle) + along_ * portable::sin(angle);
  }

  static Ray ray(const Vec3d& from, const Vec3d& direction) {
    Ray r;
    r.origin = Vec3f(from), r.direction = Vec3f(normalize(direction));
    return r;
  }

  Camera view(const Vec3d& place, int turn) const {
    Camera camera;
    camera.from = place;
    camera.at = place + (heading(turn) + up_ * 0.04) * (0.25 * room_.size());
    camera.up = up_;
    camera.fov = kFov;
    return camera;
  }

  /// Rays through places all over the picture.
  std::vector<Ray> sight(const Camera& camera) const {
    const CameraFrame frame = camera_frame(camera, film_);
    std::vector<Ray> rays;
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column)
        rays.push_back(
            camera_ray(frame, (column + 0.5) / kColumns * film_.width, (row + 0.5) / kRows * film_.height));
    return rays;
  }

  /// How far one sees, on average of logarithms, so that near and far things both count. Things so near that
  /// they block the view count against it, and so does what leads outside.
  double score(const Camera& camera) const {
    double sum = 0;
    for (const float t : room_.distances(sight(camera))) {
      if (!std::isfinite(t)) continue;
      const double part = t / room_.size();
      sum += portable::log2(1 + 40 * part) - (part < 0.06 ? 3 : 0);
    }
    return sum;
  }

  const Explorer& room_;
  const Film& film_;
  Vec3d up_, across_, along_;
};

}  // namespace

std::optional<InteriorView> interior_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film) {
  const Explorer room(mesh);
  if (!(room.size() > 0)) return std::nullopt;
  const Exposure e = room.exposure();
  const bool building = e.hidden > 0.3 && e.front<0.3, closed_room = e.hidden> 0.1 && e.front < 0.05;
  if (!building && !closed_room) return std::nullopt;
  const ViewSearch search(room, up, film);
  const Camera camera = search.best();
  return InteriorView{camera, search.sun(camera)};
}

}  // namespace oktett
