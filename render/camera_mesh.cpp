#include "render/camera_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/mesh_geometry.h"

namespace oktett {
namespace {

/// Most cells along a side of the unit square.
constexpr std::size_t kMostCells = 1024;
constexpr std::size_t kNoFace = std::numeric_limits<std::size_t>::max();

struct Barycentric {
  double u, v;
};

/// Where the point (u, v) lies in a triangle of texture coordinates; nothing outside of it, or if it has no
/// area.
std::optional<Barycentric> find_in(const std::array<Vec2f, 3>& uv, double u, double v) {
  const double ax = double{uv[1].x} - uv[0].x, ay = double{uv[1].y} - uv[0].y;
  const double bx = double{uv[2].x} - uv[0].x, by = double{uv[2].y} - uv[0].y;
  const double px = u - uv[0].x, py = v - uv[0].y;
  const double area = ax * by - ay * bx;
  if (!(std::abs(area) > 0)) return std::nullopt;
  const Barycentric at{(px * by - py * bx) / area, (ax * py - ay * px) / area};
  // Points on an edge that two faces share are in one of them at least.
  constexpr double kLeast = -1e-9;
  if (!(at.u >= kLeast && at.v >= kLeast && at.u + at.v <= 1 - kLeast)) return std::nullopt;
  return at;
}

/// Whether no corner of a triangle lacks an index, in a column that is empty if all do.
bool all_given(const Column<std::uint32_t>& indices, std::size_t triangle) {
  if (indices.empty()) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (indices[3 * triangle + k] == kNoId) return false;
  return true;
}
bool has_uvs(const TriangleMesh& mesh, std::size_t triangle) {
  return !mesh.uvs.empty() && all_given(mesh.uv_indices, triangle);
}
bool has_normals(const TriangleMesh& mesh, std::size_t triangle) {
  return !mesh.normals.empty() && all_given(mesh.normal_indices, triangle);
}

/// The mesh that has a face, by the number of the first face of each.
std::size_t mesh_of(const std::vector<std::size_t>& first, std::size_t face) {
  return static_cast<std::size_t>(std::ranges::upper_bound(first, face) - first.begin() - 1);
}

/// The cells that the numbers from `lo` to `hi` meet, of `side` in [0, 1].
std::pair<std::size_t, std::size_t> cells_of(double lo, double hi, std::size_t side) {
  const auto cell = [&](double x) {
    return static_cast<std::size_t>(
        std::clamp(std::floor(x * static_cast<double>(side)), 0.0, static_cast<double>(side - 1)));
  };
  constexpr double kMargin = 1e-6;
  return {cell(lo - kMargin), cell(hi + kMargin)};
}

}  // namespace

CameraMesh::CameraMesh(std::vector<SeeingMesh> meshes, const Settings& settings)
    : meshes_(std::move(meshes)), settings_(settings) {
  first_.push_back(0);
  Vec3d lo = Vec3d{1, 1, 1} * std::numeric_limits<double>::infinity(), hi = lo * -1.0;
  for (const SeeingMesh& placed : meshes_) {
    first_.push_back(first_.back() + placed.mesh->triangle_count());
    inverses_.push_back(placed.transform.inverse());
    for (const std::uint32_t index : placed.mesh->indices) {
      const Vec3d p = placed.transform.point(placed.mesh->origin + Vec3d(placed.mesh->positions[index]));
      lo = min(lo, p), hi = max(hi, p);
    }
  }
  if (faces() > 0) middle_ = (lo + hi) / 2;
  if (settings_.order == FaceOrder::uv) fill_grid();
}

void CameraMesh::fill_grid() {
  side_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(faces()) / 2)), 1,
                                  kMostCells);
  const auto visit = [&](const auto& what) {
    for (std::size_t m = 0; m < meshes_.size(); ++m)
      for (std::size_t t = 0; t < meshes_[m].mesh->triangle_count(); ++t) {
        if (!has_uvs(*meshes_[m].mesh, t)) continue;
        const auto uv = corner_uvs(*meshes_[m].mesh, static_cast<std::uint32_t>(t));
        const auto [u0, u1] = std::minmax({uv[0].x, uv[1].x, uv[2].x});
        const auto [v0, v1] = std::minmax({uv[0].y, uv[1].y, uv[2].y});
        // Written so that numbers that are none drop out, too.
        if (!(u1 >= 0 && u0 <= 1 && v1 >= 0 && v0 <= 1)) continue;
        const auto [x0, x1] = cells_of(u0, u1, side_);
        const auto [y0, y1] = cells_of(v0, v1, side_);
        for (std::size_t y = y0; y <= y1; ++y)
          for (std::size_t x = x0; x <= x1; ++x) what(y * side_ + x, first_[m] + t);
      }
  };
  cell_begin_.assign(side_ * side_ + 1, 0);
  visit([&](std::size_t cell, std::size_t) { ++cell_begin_[cell + 1]; });
  for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  cell_faces_.resize(cell_begin_.back());
  std::vector<std::uint32_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
  visit([&](std::size_t cell, std::size_t face) {
    cell_faces_[next[cell]++] = static_cast<std::uint32_t>(face);
  });
}

CameraMesh::FacePoint CameraMesh::point_of_uv(double u, double v) const {
  if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) return {kNoFace};
  const std::size_t cell = cells_of(v, v, side_).second * side_ + cells_of(u, u, side_).second;
  for (std::uint32_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
    const std::size_t face = cell_faces_[i];
    const std::size_t mesh = mesh_of(first_, face);
    const auto uv = corner_uvs(*meshes_[mesh].mesh, static_cast<std::uint32_t>(face - first_[mesh]));
    if (const auto at = find_in(uv, u, v)) return {face, at->u, at->v};
  }
  return {kNoFace};
}

CameraMesh::FacePoint CameraMesh::point_at(const FilmPlace& p) const {
  if (settings_.order == FaceOrder::uv) return point_of_uv(p.x / p.width, 1 - p.y / p.height);
  const double column = std::floor(p.x), row = std::floor(p.y);
  if (!(column >= 0 && column < p.width && row >= 0 && row < p.height)) return {kNoFace};
  const auto x = static_cast<std::size_t>(column), y = static_cast<std::size_t>(row);
  const std::size_t pixel = y * p.width + x, count = meshes_.size();
  if (settings_.order == FaceOrder::sequence) return {pixel < faces() ? pixel : kNoFace};
  std::size_t mesh = 0, number = pixel;
  if (settings_.order == FaceOrder::average) {
    mesh = static_cast<std::size_t>((p.x - column) * static_cast<double>(count));
  } else {
    const std::size_t width = p.width / count;
    if (width == 0) return {kNoFace};
    mesh = x / width, number = y * width + x % width;
  }
  if (mesh >= count || number >= first_[mesh + 1] - first_[mesh]) return {kNoFace};
  return {first_[mesh] + number};
}

Ray CameraMesh::ray(const FilmPlace& place, const Vec3d& origin) const {
  Ray ray;
  ray.direction = {0, 0, -1}, ray.tmax = 0;
  const FacePoint at = point_at(place);
  if (at.face == kNoFace) return ray;
  const std::size_t m = mesh_of(first_, at.face);
  const TriangleMesh& mesh = *meshes_[m].mesh;
  const std::size_t triangle = at.face - first_[m];
  std::array<Vec3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.origin + corner(mesh, triangle, k);
  const auto blend = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return a * (1 - at.u - at.v) + b * at.u + c * at.v;
  };
  Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
  if (settings_.smooth && settings_.order == FaceOrder::uv && has_normals(mesh, triangle)) {
    const auto at_corner = [&](std::size_t k) {
      return normalize(Vec3d(mesh.normals[mesh.normal_indices[3 * triangle + k]]));
    };
    normal = blend(at_corner(0), at_corner(1), at_corner(2));
  }
  normal = inverses_[m].normal_by_inverse(normal);
  const double size = length(normal);
  if (!(size > 0 && std::isfinite(size))) return ray;
  normal = normal / size;
  ray.origin =
      Vec3f(origin + meshes_[m].transform.point(blend(p[0], p[1], p[2])) + normal * settings_.offset);
  ray.direction = Vec3f(settings_.reverse ? normal * -1.0 : normal);
  ray.tmax = settings_.max_distance > 0 ? static_cast<float>(settings_.max_distance)
                                        : std::numeric_limits<float>::infinity();
  return ray;
}

}  // namespace oktett
