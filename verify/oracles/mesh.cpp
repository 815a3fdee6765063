#include "verify/oracles/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace oktett {
namespace {

void add_triangle(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  for (const std::uint32_t i : {a, b, c}) mesh.indices.push_back(i);
}

/// Two triangles, a and c at opposite corners.
void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  add_triangle(mesh, a, b, c), add_triangle(mesh, a, c, d);
}

/// Joins every vertex of a mesh to the first one at the same position.
std::vector<std::uint32_t> welded(const TriangleMesh& mesh) {
  std::map<std::tuple<float, float, float>, std::uint32_t> first;
  std::vector<std::uint32_t> id(mesh.positions.size());
  for (std::uint32_t i = 0; i < id.size(); ++i) {
    // Adding zero makes -0 and 0 one key.
    const Vec3f p = mesh.positions[i] + Vec3f{0, 0, 0};
    id[i] = first.try_emplace({p.x, p.y, p.z}, i).first->second;
  }
  return id;
}

Vec3d corner(const TriangleMesh& mesh, std::size_t triangle, int k) {
  return Vec3d(mesh.positions[mesh.indices[3 * triangle + static_cast<std::size_t>(k)]]);
}

}  // namespace

OracleMesh make_cube() {
  OracleMesh r{"cube", {}, true};
  for (int i = 0; i < 8; ++i)
    r.mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces) add_quad(r.mesh, f[0], f[1], f[2], f[3]);
  return r;
}

OracleMesh make_icosphere(int levels) {
  OracleMesh r{"icosphere", {}, true};
  const float g = static_cast<float>(std::numbers::phi);
  const auto push = [&](const Vec3d& p) {
    r.mesh.positions.push_back(Vec3f(normalize(p)));
    return static_cast<std::uint32_t>(r.mesh.positions.size() - 1);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 4; ++i) {
      Vec3d p{0, 0, 0};
      p[(axis + 1) % 3] = i & 1 ? 1 : -1, p[(axis + 2) % 3] = i & 2 ? g : -g;
      push(p);
    }
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        const auto near = [&](std::uint32_t i, std::uint32_t j) {
          return length(r.mesh.positions[i] - r.mesh.positions[j]) < 1.2f;
        };
        if (!near(a, b) || !near(b, c) || !near(c, a)) continue;
        const Vec3f pa = r.mesh.positions[a], pb = r.mesh.positions[b], pc = r.mesh.positions[c];
        const bool outwards = dot(cross(pb - pa, pc - pa), pa) > 0;
        faces.push_back({a, outwards ? b : c, outwards ? c : b});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    std::vector<std::array<std::uint32_t, 3>> split;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto key = std::minmax(a, b);
      const auto [at, fresh] = middles.try_emplace({key.first, key.second}, 0);
      if (fresh) at->second = push(Vec3d(r.mesh.positions[a]) + Vec3d(r.mesh.positions[b]));
      return at->second;
    };
    for (const auto& f : faces) {
      const std::uint32_t m[3] = {middle(f[0], f[1]), middle(f[1], f[2]), middle(f[2], f[0])};
      split.push_back({f[0], m[0], m[2]}), split.push_back({f[1], m[1], m[0]});
      split.push_back({f[2], m[2], m[1]}), split.push_back({m[0], m[1], m[2]});
    }
    faces = std::move(split);
  }
  for (const auto& f : faces) add_triangle(r.mesh, f[0], f[1], f[2]);
  return r;
}

OracleMesh make_torus(int rings, int sides) {
  OracleMesh r{"torus", {}, false};
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      const double a = 2 * std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / sides;
      const double radius = 1 + 0.4 * std::cos(b);
      r.mesh.positions.push_back(Vec3f(Vec3d{radius * std::cos(a), 0.4 * std::sin(b), radius * std::sin(a)}));
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % rings) * sides + j % sides); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) add_quad(r.mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  return r;
}

OracleMesh make_globe(int slices, int stacks) {
  OracleMesh r{"globe", {}, false};
  r.mesh.positions.push_back({0, -1, 0});
  for (int s = 1; s < stacks; ++s)
    for (int i = 0; i < slices; ++i) {
      const double a = 2 * std::numbers::pi * i / slices, b = std::numbers::pi * (s / double(stacks) - 0.5);
      r.mesh.positions.push_back(
          Vec3f(Vec3d{std::cos(b) * std::cos(a), std::sin(b), std::cos(b) * std::sin(a)}));
    }
  r.mesh.positions.push_back({0, 1, 0});
  const auto at = [&](int s, int i) { return static_cast<std::uint32_t>(1 + (s - 1) * slices + i % slices); };
  const std::uint32_t top = static_cast<std::uint32_t>(r.mesh.positions.size() - 1);
  for (int i = 0; i < slices; ++i) {
    add_triangle(r.mesh, 0, at(1, i), at(1, i + 1));
    add_triangle(r.mesh, top, at(stacks - 1, i + 1), at(stacks - 1, i));
    for (int s = 1; s + 1 < stacks; ++s)
      add_quad(r.mesh, at(s, i), at(s + 1, i), at(s + 1, i + 1), at(s, i + 1));
  }
  return r;
}

OracleMesh make_needles(int count) {
  OracleMesh r{"needles", {}, false};
  // Two rings of `count` corners and two poles.
  const double radius = 1e-5 * count / (2 * std::numbers::pi);
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < count; ++i) {
      const double a = 2 * std::numbers::pi * i / count;
      r.mesh.positions.push_back(Vec3f(Vec3d{side ? 0.5 : -0.5, radius * std::cos(a), radius * std::sin(a)}));
    }
  const std::uint32_t n = static_cast<std::uint32_t>(count);
  r.mesh.positions.push_back({-0.5f, 0, 0});
  r.mesh.positions.push_back({0.5f, 0, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add_quad(r.mesh, i, j, n + j, n + i);
    add_triangle(r.mesh, 2 * n, j, i), add_triangle(r.mesh, 2 * n + 1, n + i, n + j);
  }
  return r;
}

std::vector<OracleMesh> make_closed_meshes() {
  return {make_cube(), make_icosphere(4), make_torus(64, 32), make_globe(500, 8), make_needles(200)};
}

std::size_t open_edge_count(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> id = welded(mesh);
  // +1 for each way an edge is walked along upwards, -1 for downwards.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = id[mesh.indices[i + k]], b = id[mesh.indices[i + (k + 1) % 3]];
      if (a != b) balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return static_cast<std::size_t>(
      std::count_if(balance.begin(), balance.end(), [](const auto& e) { return e.second != 0; }));
}

double winding_number(const TriangleMesh& mesh, const Vec3d& point) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const Vec3d a = corner(mesh, i, 0) - point, b = corner(mesh, i, 1) - point,
                c = corner(mesh, i, 2) - point;
    const double la = length(a), lb = length(b), lc = length(c);
    sum +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

bool near_surface(const TriangleMesh& mesh, const Vec3d& point, double distance) {
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    Vec3d p[3], lo, hi;
    for (int k = 0; k < 3; ++k) p[k] = corner(mesh, i, k);
    lo = min(p[0], min(p[1], p[2])), hi = max(p[0], max(p[1], p[2]));
    bool outside = false;
    for (int k = 0; k < 3; ++k) outside |= point[k] < lo[k] - distance || point[k] > hi[k] + distance;
    if (outside) continue;
    const Vec3d n = cross(p[1] - p[0], p[2] - p[0]);
    if (std::abs(dot(n, point - p[0])) <= distance * length(n)) return true;
  }
  return false;
}

TriangleMesh placed(const TriangleMesh& mesh, double scale, const Vec3d& offset) {
  TriangleMesh r;
  r.indices = mesh.indices;
  for (const Vec3f& p : mesh.positions) r.positions.push_back(Vec3f(Vec3d(p) * scale + offset));
  return r;
}

}  // namespace oktett
