#include "render/look/mesh_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "core/box.h"
#include "core/math.h"
#include "core/mesh.h"
#include "core/mesh_geometry.h"
#include "core/random.h"
#include "render/camera.h"
#include "render/look/coarse_mesh.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"

namespace oktett {

namespace {

/// The greatest values of four linear functions over the points: what bounds them on each side of a frustum.
struct FrustumExtent {
  double right = -kInfinity, left = -kInfinity, top = -kInfinity, bottom = -kInfinity;
  double nearest = kInfinity, farthest = -kInfinity;
};

FrustumExtent extent_of(const TriangleMesh& mesh, const CameraFrame& frame, double tan_x, double tan_y) {
  FrustumExtent e;
  for (const std::uint32_t index : mesh.indices) {
    const Vec3d p(mesh.positions[index]);
    const double x = dot(p, frame.right), y = dot(p, frame.up), z = dot(p, frame.forward);
    e.right = std::max(e.right, x - tan_x * z), e.left = std::max(e.left, -x - tan_x * z);
    e.top = std::max(e.top, y - tan_y * z), e.bottom = std::max(e.bottom, -y - tan_y * z);
    e.nearest = std::min(e.nearest, z), e.farthest = std::max(e.farthest, z);
  }
  return e;
}

}  // namespace

Camera fit_mesh(const TriangleMesh& mesh, const Vec3d& forward, const Vec3d& up, double fov, double margin,
                const Film& film) {
  Camera camera;
  camera.up = up, camera.fov = fov;
  camera.from = {}, camera.at = forward;
  const CameraFrame frame = camera_frame(camera, film);
  const double tan_y = portable::tan(fov * kDegree / 2) * (1 - 2 * margin);
  const double tan_x = tan_y * std::max(film.width, 1u) / std::max(film.height, 1u);
  const FrustumExtent e = extent_of(mesh, frame, tan_x, tan_y);
  // Each side of the frustum is a plane through the camera (x, y, z): x - tan_x z >= e.right, and so on. The
  // nearest camera is where two opposite sides both touch the mesh.
  const double x = (e.right - e.left) / 2, y = (e.top - e.bottom) / 2;
  double z = std::min(-(e.right + e.left) / (2 * tan_x), -(e.top + e.bottom) / (2 * tan_y));
  const double size = std::max(e.farthest - e.nearest, 1e-6 * std::max(std::abs(e.farthest), 1e-12));
  if (!(z < e.nearest)) z = e.nearest - size;
  camera.from = frame.right * x + frame.up * y + frame.forward * z;
  camera.at = camera.from + frame.forward * ((e.nearest + e.farthest) / 2 - z);
  return camera;
}

// ---- A triangle mesh as rays see it, to find out what it is.

/// Of a mesh of more triangles a coarse copy is explored: a tree over all would take as long to build, and as
/// much memory, as that of the picture.
constexpr std::size_t kMostExplored = 16'000'000;
constexpr int kCoarseCells = 512;

class MeshExplorer {
 public:
  /// The mesh must outlive it.
  explicit MeshExplorer(const TriangleMesh& mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const Box& box() const { return box_; }
  /// The diagonal of the box; zero if there is nothing that a ray could hit.
  double size() const { return size_; }

  std::vector<Hit> hits(const std::vector<Ray>& rays) const;
  /// Distances along unit directions, infinite where nothing is hit.
  std::vector<float> distances(const std::vector<Ray>& rays) const;
  /// For each ray 1 if it hits something, else 0.
  std::vector<std::uint8_t> occluded(const std::vector<Ray>& rays) const;

  /// `count` triangles in equal steps of area; none if no triangle has an area.
  std::vector<std::uint32_t> triangles_by_area(std::uint32_t count) const;

 private:
  const TriangleMesh coarse_;  ///< empty if the mesh itself is explored
  const TriangleMesh& mesh_;
  std::shared_ptr<const Accel> accel_;
  Box box_;
  double size_;
};

MeshExplorer::MeshExplorer(const TriangleMesh& mesh)
    : coarse_(mesh.triangle_count() > kMostExplored ? coarse_copy(mesh, kCoarseCells) : TriangleMesh{}),
      mesh_(coarse_.indices.empty() ? mesh : coarse_) {
  std::vector<Geometry> geometries(1);
  geometries[0].shape = MeshGeometry{&mesh_, false, TriangleTest::watertight};
  BuildOptions options;
  options.quality = BuildQuality::fast;
  accel_ = build_accel(std::move(geometries), options);
  box_ = bounds(*accel_);
  size_ = length(Vec3d(box_.extent()));
}

std::vector<Hit> MeshExplorer::hits(const std::vector<Ray>& rays) const {
  std::vector<Hit> hits(rays.size());
  closest_hit(*accel_, rays, hits);
  return hits;
}

std::vector<float> MeshExplorer::distances(const std::vector<Ray>& rays) const {
  std::vector<float> t;
  for (const Hit& hit : hits(rays)) t.push_back(hit.t);
  return t;
}

std::vector<std::uint8_t> MeshExplorer::occluded(const std::vector<Ray>& rays) const {
  std::vector<std::uint8_t> occluded(rays.size());
  any_hit(*accel_, rays, occluded);
  return occluded;
}

std::vector<std::uint32_t> MeshExplorer::triangles_by_area(std::uint32_t count) const {
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangle_count());
  double total = 0;
  for (std::uint32_t i = 0; i < triangles; ++i) total += length(area_normal(mesh_, i));
  std::vector<std::uint32_t> chosen;
  double sum = 0;
  for (std::uint32_t i = 0; i < triangles && chosen.size() < count; ++i) {
    sum += length(area_normal(mesh_, i));
    while (chosen.size() < count && sum > (static_cast<double>(chosen.size()) + 0.5) * total / count)
      chosen.push_back(i);
  }
  return chosen;
}

// ---- How much of a mesh is seen from outside, and what it hides.

/// Shares of the surface of a mesh, by samples.
struct Exposure {
  double front = 0;   ///< that who stands outside sees from the front
  double back = 0;    ///< that he sees from the back only
  double hidden = 0;  ///< that he does not see
  /// Of what is hidden, the part from whose front, and from whose back, straight ways lead to the front of a
  /// wall behind which there is nothing. In a furnished room the first is greater. In a mesh that is turned
  /// inside out, with something in it, the second is.
  double facing = 0, averted = 0;
  double square = 0;  ///< that is level or upright
};

namespace {

constexpr std::uint32_t kPoints = 1024;
/// From each point to its front and to its back. More to the back: where a single way leads out there, the
/// point is no content of a room. To the front it may lead through a window.
constexpr std::uint32_t kFrontRays = 4, kBackRays = 16, kRays = kFrontRays + kBackRays;

/// Rays from a random point of the triangle, first to the front, then to the back.
void add_rays(const MeshExplorer& mesh, std::uint32_t triangle, std::uint32_t number,
              std::vector<Ray>& rays) {
  const SquareSample place = sobol_point(number, mix_bits(1));
  const double root = std::sqrt(place.x), u = root * place.y, v = 1 - root;
  const auto at = [&](std::size_t k) { return corner(mesh.mesh(), triangle, k); };
  const Vec3d a = at(0), p = a + (at(1) - a) * u + (at(2) - a) * v;
  const Vec3d n = normalize(area_normal(mesh.mesh(), triangle));
  for (int side = 0; side < 2; ++side)
    for (std::uint32_t i = 0, count = side == 0 ? kFrontRays : kBackRays; i < count; ++i) {
      const Vec3f out(side == 0 ? n : -n);
      Ray ray;
      ray.direction = cosine_direction(out, sobol_point(number * count + i, mix_bits(2 + side)));
      ray.origin = Vec3f(p + Vec3d(out) * (1e-5 * mesh.size()));
      rays.push_back(ray);
    }
}

/// For each ray 1 if it hits the front of a wall behind which there is nothing, else 0.
std::vector<std::uint8_t> reach_walls(const MeshExplorer& mesh, const std::vector<Ray>& rays) {
  const std::vector<Hit> hits = mesh.hits(rays);
  std::vector<Ray> onwards;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray ray = rays[i];
    const double beyond = hits[i].valid() ? hits[i].t + 1e-5 * mesh.size() : 0;
    ray.origin = Vec3f(Vec3d(ray.origin) + Vec3d(ray.direction) * beyond);
    onwards.push_back(ray);
  }
  std::vector<std::uint8_t> reached = mesh.occluded(onwards);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool front =
        hits[i].valid() && dot(area_normal(mesh.mesh(), hits[i].item), Vec3d(rays[i].direction)) < 0;
    reached[i] = front && reached[i] == 0;
  }
  return reached;
}

}  // namespace

/// `up` is a unit vector.
static Exposure exposure_of(const MeshExplorer& mesh, const Vec3d& up) {
  const std::vector<std::uint32_t> triangles = mesh.triangles_by_area(kPoints);
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) add_rays(mesh, triangles[i], i, rays);
  const std::vector<std::uint8_t> occluded = mesh.occluded(rays);
  Exposure e;
  std::vector<Ray> inner;  // of what is hidden
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto first = rays.begin() + static_cast<std::ptrdiff_t>(kRays * i);
    const std::uint8_t* const to_front = &occluded[kRays * i];
    const bool front = std::count(to_front, to_front + kFrontRays, 0) > 0;
    const bool back = std::count(to_front + kFrontRays, to_front + kRays, 0) > 0;
    e.front += front, e.back += back && !front, e.hidden += !front && !back;
    if (!front && !back) inner.insert(inner.end(), first, first + 2 * kFrontRays);
    const double rise = std::abs(dot(normalize(area_normal(mesh.mesh(), triangles[i])), up));
    e.square += rise < 0.05 || rise > 0.995;
  }
  const std::vector<std::uint8_t> walls = reach_walls(mesh, inner);
  // As many to the back as to the front.
  for (std::size_t i = 0; i < inner.size(); ++i)
    (i / kFrontRays % 2 == 0 ? e.facing : e.averted) += static_cast<double>(walls[i]) / kFrontRays;
  const double count = std::max(1.0, static_cast<double>(triangles.size()));
  for (double* share : {&e.front, &e.back, &e.hidden, &e.facing, &e.averted, &e.square}) *share /= count;
  return e;
}

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
