/// \file Finds out whether a mesh is a room, and a view from inside.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/math.h"
#include "render/camera.h"
#include "render/look/exposure.h"
#include "render/look/mesh_explorer.h"
#include "render/look/mesh_view.h"

namespace oktett {
namespace {

/// Looks for a good view from inside.
class ViewSearch {
 public:
  ViewSearch(const MeshExplorer& room, const Vec3d& up, const Film& film) : room_(room), film_(film) {
    up_ = normalize(up);
    make_basis(up_, across_, along_);
    const Vec3f e = room.box().extent();
    const int vertical = dominant_axis(up_);
    const double width = std::min(e[(vertical + 1) % 3], e[(vertical + 2) % 3]);
    near_ = std::min(0.06 * room.size(), 0.25 * width);
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

  /// Free places in the lower half of the room that have walls around them; its middle if there are none.
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
    if (places.empty()) places.push_back((lo + hi) * 0.5);
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
      sum += portable::log2(1 + 40 * part) - (t < near_ ? 3 : 0);
    }
    return sum;
  }

  const MeshExplorer& room_;
  const Film& film_;
  Vec3d up_, across_, along_;
  double near_;  ///< what is nearer than this blocks the view; the walls of a corridor are not
};

/// See interior_view.
bool is_interior(const MeshExplorer& mesh, const Vec3d& up) {
  const Exposure e = exposure_of(mesh, up);
  if (!(e.back > 2 * e.front)) return false;
  // Less than five samples may be an accident. What is round has folds, which hide something, too.
  const double something = e.square > 0.9 ? 0.005 : 0.03;
  // Closed things that touch hide about as much of one side as of the other.
  if (e.hidden > 0.005) return e.facing > std::max(1.5 * e.averted, something);
  const Vec3f size = mesh.box().extent();
  const float narrowest = std::min({size.x, size.y, size.z});
  return e.square > 0.98 && narrowest > max_component(size) / 20;
}

InteriorView view_from_inside(const MeshExplorer& mesh, const Vec3d& up, const Film& film) {
  const ViewSearch search(mesh, up, film);
  const Camera camera = search.best();
  return InteriorView{camera, search.sun(camera)};
}

}  // namespace

std::optional<InteriorView> interior_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film) {
  const MeshExplorer explorer(mesh);
  if (!(explorer.size() > 0) || !is_interior(explorer, up)) return std::nullopt;
  return view_from_inside(explorer, up, film);
}

std::optional<InteriorView> inside_view(const TriangleMesh& mesh, const Vec3d& up, const Film& film) {
  const MeshExplorer explorer(mesh);
  if (!(explorer.size() > 0)) return std::nullopt;
  return view_from_inside(explorer, up, film);
}

}  // namespace oktett
