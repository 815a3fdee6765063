#include "io/mesh/contour/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "io/mesh/contour/grid.h"
#include "io/mesh/contour/links.h"
#include "io/mesh/contour/rims.h"
#include "io/mesh/contour/sheets.h"
#include "io/mesh/contour/signs.h"
#include "kernels/closed/closest_triangle.h"

namespace oktett {
namespace {

double squared_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using D = Simd<double, 1, ScalarIsa>;
  return only_lane(
      closest_on_triangle(broadcast<D>(p), broadcast<D>(a), broadcast<D>(b), broadcast<D>(c)).d2);
}

/// The triangles of a crossing. Their corners are numbers of vertices; the crossing itself, if it is one, has
/// a number behind those of all sheets.
struct Patch {
  std::array<std::array<std::uint32_t, 3>, 8> triangles;
  std::uint32_t count = 0;
  double deviation = 0;
};

class Meshing {
 public:
  Meshing(const ContourGrid& grid, const ContourCrossings& crossings, const std::vector<SlotNumber>& links,
          const ContourSheets& sheets, const std::vector<RimPoint>& rims, std::vector<SheetVertex>& vertices)
      : grid_(grid),
        crossings_(crossings),
        links_(links),
        sheets_(sheets),
        rims_(rims),
        vertices_(vertices) {}

  Contour run() {
    split_double_links();
    const std::size_t count = crossings_.all.size();
    if (vertices_.size() + count > 0xfffffffe)
      throw Error("the mesh has too many vertices; ask for fewer cells");
    std::vector<Patch> patches(count);
    in_parts(count, 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t x = begin; x < end; ++x)
        if (!has_twins(static_cast<std::uint32_t>(x))) patches[x] = patch(static_cast<std::uint32_t>(x), -1);
    });
    for (std::size_t x = 0; x < count; ++x) {
      const auto i = static_cast<std::uint32_t>(x);
      if (has_twins(i)) patches[x] = patch_of_twin(i, patches);
    }
    Contour made = gather(patches);
    add_rims(made);
    return made;
  }

 private:
  /// The link from a slot; the same number for both of its ends.
  SlotNumber link_of(SlotNumber slot) const { return std::min(slot, links_[slot]); }

  /// Two links between the same two sheets would be one edge of the mesh for four triangles. All such links
  /// get a vertex of their own.
  void split_double_links() {
    std::vector<std::array<std::uint32_t, 3>> edges;  // of sheets behind and before a face, and the slot
    for (SlotNumber slot = 0; slot < links_.size(); ++slot)
      if (links_[slot] != kNoId && slot < links_[slot])
        edges.push_back(
            {sheets_.of_quadrant[quadrant_at(slot, 0)], sheets_.of_quadrant[quadrant_at(slot, 1)], slot});
    std::ranges::sort(edges);
    const auto same = [](const auto& e, const auto& f) { return e[0] == f[0] && e[1] == f[1]; };
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const bool doubled =
          (i > 0 && same(edges[i - 1], edges[i])) || (i + 1 < edges.size() && same(edges[i], edges[i + 1]));
      if (!doubled) continue;
      const SlotNumber slot = edges[i][2];
      const std::uint32_t x = slot / kSlots, y = links_[slot] / kSlots;
      split_.emplace_back(slot, static_cast<std::uint32_t>(vertices_.size()));
      SheetVertex v;
      v.position = (crossings_.position(grid_, x) + crossings_.position(grid_, y)) * 0.5;
      const Vec3f sum = crossings_.all[x].normal + crossings_.all[y].normal;
      v.normals[0] = dot(sum, sum) > 0.01f ? normalize(sum) : crossings_.all[x].normal;
      vertices_.push_back(v);
    }
    std::ranges::sort(split_);
  }

  /// The vertex on the link from a slot, or kNoId.
  std::uint32_t vertex_on(SlotNumber slot) const {
    if (split_.empty() || links_[slot] == kNoId) return kNoId;
    const SlotNumber link = link_of(slot);
    const auto found =
        std::ranges::lower_bound(split_, link, {}, &std::pair<SlotNumber, std::uint32_t>::first);
    return found != split_.end() && found->first == link ? found->second : kNoId;
  }

  /// Whether another crossing is on the same edge.
  bool has_twins(std::uint32_t x) const { return is_twin(x, x - 1) || is_twin(x, x + 1); }
  bool is_twin(std::uint32_t x, std::uint32_t y) const {
    return y < crossings_.all.size() && crossings_.all[x].axis == crossings_.all[y].axis &&
           crossings_.all[x].place == crossings_.all[y].place;
  }

  // Seen against the axis, the cells around an edge in order, and the faces between one and the next.
  static constexpr std::uint32_t kQuadrants[] = {0, 2, 3, 1}, kFaces[] = {0, 3, 1, 2};

  std::uint32_t sheet(std::uint32_t x, std::uint32_t quadrant) const {
    return sheets_.of_quadrant[kSlots * x + quadrant];
  }

  /// The outline of the quad, counter-clockwise from the front.
  std::vector<std::uint32_t> outline(std::uint32_t x) const {
    std::vector<std::uint32_t> corners;
    for (std::size_t k = 0; k < 4; ++k) {
      corners.push_back(sheet(x, kQuadrants[k]));
      const std::uint32_t between = vertex_on(kSlots * x + kFaces[k]);
      if (between != kNoId) corners.push_back(between);
    }
    if (crossings_.all[x].turn < 0) std::ranges::reverse(corners);
    return corners;
  }

  /// `diagonal`: -1 for the better one, 0 or 1 for that from corner 0 or 1, 2 for a fan around the crossing.
  Patch patch(std::uint32_t x, int diagonal) const {
    const std::vector<std::uint32_t> c = outline(x);
    Patch made;
    if (c.size() > 4) diagonal = 2;
    if (diagonal < 0) diagonal = better_diagonal(x, c);
    if (diagonal == 2) {
      const auto middle = static_cast<std::uint32_t>(vertices_.size()) + x;
      for (std::size_t k = 0; k < c.size(); ++k)
        made.triangles[made.count++] = {middle, c[k], c[(k + 1) % c.size()]};
      return made;
    }
    const auto d = static_cast<std::size_t>(diagonal);
    made.triangles[0] = {c[d], c[d + 1], c[(d + 2) % 4]};
    made.triangles[1] = {c[d], c[(d + 2) % 4], c[(d + 3) % 4]};
    made.count = 2;
    made.deviation = std::sqrt(off_surface(x, c, d));
    return made;
  }

  double off_surface(std::uint32_t x, const std::vector<std::uint32_t>& c, std::size_t d) const {
    const auto at = [&](std::size_t k) -> const Vec3d& { return vertices_[c[k % 4]].position; };
    const Vec3d p = crossings_.position(grid_, x);
    return std::min(squared_distance(p, at(d), at(d + 1), at(d + 2)),
                    squared_distance(p, at(d), at(d + 2), at(d + 3)));
  }

  /// Along an edge of the surface if the quad bends there, else that nearer to the crossing.
  int better_diagonal(std::uint32_t x, const std::vector<std::uint32_t>& c) const {
    const double first = off_surface(x, c, 0), second = off_surface(x, c, 1);
    const double small = 1e-8 * grid_.spacing * grid_.spacing;
    if (std::abs(first - second) > small) return first < second ? 0 : 1;
    const auto parts = [&](std::size_t k) { return std::min<int>(vertices_[c[k]].smooth_parts, 2); };
    const int along_first = parts(0) + parts(2), along_second = parts(1) + parts(3);
    if (along_first != along_second) return along_first > along_second ? 0 : 1;
    const auto distance = [&](std::size_t i, std::size_t j) {
      return length(vertices_[c[i]].position - vertices_[c[j]].position);
    };
    return distance(0, 2) <= distance(1, 3) ? 0 : 1;
  }

  /// Of a crossing with others before it on its edge: its diagonal is none of theirs.
  Patch patch_of_twin(std::uint32_t x, const std::vector<Patch>& patches) const {
    const std::vector<std::uint32_t> c = outline(x);
    if (c.size() > 4) return patch(x, 2);
    const int better = better_diagonal(x, c);
    for (const int diagonal : {better, 1 - better}) {
      const auto d = static_cast<std::size_t>(diagonal);
      const std::uint32_t from = c[d], to = c[d + 2];
      bool taken = false;
      for (std::uint32_t y = x; !taken && is_twin(x, y - 1); --y) {
        const Patch& other = patches[y - 1];
        const std::uint32_t a = other.triangles[0][0], b = other.triangles[0][2];
        taken = other.count == 2 && ((a == from && b == to) || (a == to && b == from));
      }
      if (!taken) return patch(x, diagonal);
    }
    return patch(x, 2);
  }

  Contour gather(const std::vector<Patch>& patches) {
    Contour made;
    TriangleMesh& mesh = made.mesh;
    normals_from_.resize(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      mesh.positions.push_back(Vec3f(vertices_[i].position));
      normals_from_[i] = static_cast<std::uint32_t>(mesh.normals.size());
      for (std::uint32_t k = 0; k < vertices_[i].smooth_parts; ++k)
        mesh.normals.push_back(vertices_[i].normals[k]);
    }
    for (std::uint32_t x = 0; x < patches.size(); ++x) {
      const Patch& patch = patches[x];
      made.deviation = std::max(made.deviation, patch.deviation);
      const bool has_middle = patch.count > 0 && patch.triangles[0][0] >= vertices_.size();
      const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
      const auto middle_normal = static_cast<std::uint32_t>(mesh.normals.size());
      if (has_middle) {
        mesh.positions.push_back(Vec3f(crossings_.position(grid_, x)));
        mesh.normals.push_back(crossings_.all[x].normal);
      }
      for (std::uint32_t t = 0; t < patch.count; ++t) {
        const Vec3f front = front_of(x, patch.triangles[t]);
        for (const std::uint32_t v : patch.triangles[t]) {
          const bool is_middle = v >= vertices_.size();
          mesh.indices.push_back(is_middle ? middle : v);
          mesh.normal_indices.push_back(is_middle ? middle_normal
                                                  : normals_from_[v] + nearest(vertices_[v], front));
        }
        made.users.push_back(crossings_.all[x].user);
      }
    }
    return made;
  }

  /// Where the surface ends: a triangle from the vertices on both sides of each face to the point of the rim
  /// in it, and one in each cell between the points in two of its faces.
  void add_rims(Contour& made) const {
    struct Ends {
      std::uint32_t to = kNoId, from = kNoId;  ///< points that a triangle leads to from the vertex, and from
      std::uint32_t user = kNoId;
    };
    std::map<std::uint32_t, Ends> ends;  // by sheet
    TriangleMesh& mesh = made.mesh;
    const auto add = [&](std::uint32_t user, const std::array<std::uint32_t, 3>& corners,
                         const std::array<std::uint32_t, 3>& normals) {
      for (const std::uint32_t corner : corners) mesh.indices.push_back(corner);
      for (const std::uint32_t normal : normals) mesh.normal_indices.push_back(normal);
      made.users.push_back(user);
    };
    const auto normal_of = [&](std::uint32_t vertex, const Vec3f& front) {
      return normals_from_[vertex] + nearest(vertices_[vertex], front);
    };
    std::map<std::uint32_t, std::uint32_t> rim_normals;  // by vertex
    for (const RimPoint& rim : rims_) {
      if (links_[rim.slot] != kNoId) continue;
      const std::uint32_t x = rim.slot / kSlots;
      const auto k = static_cast<std::size_t>(std::ranges::find(kFaces, rim.slot % kSlots) - kFaces);
      std::uint32_t from = sheet(x, kQuadrants[k]), to = sheet(x, kQuadrants[(k + 1) % 4]);
      if (crossings_.all[x].turn < 0) std::swap(from, to);
      const auto point = static_cast<std::uint32_t>(mesh.positions.size());
      const auto normal = static_cast<std::uint32_t>(mesh.normals.size());
      mesh.positions.push_back(Vec3f(rim.position)), mesh.normals.push_back(rim.normal);
      rim_normals[point] = normal;
      add(crossings_.all[x].user, {to, from, point},
          {normal_of(to, rim.normal), normal_of(from, rim.normal), normal});
      ends[from].to = point, ends[to].from = point, ends[from].user = ends[to].user = crossings_.all[x].user;
    }
    for (const auto& [vertex, end] : ends) {
      if (end.to == kNoId || end.from == kNoId) continue;
      const std::uint32_t normal = rim_normals[end.from];
      add(end.user, {vertex, end.from, end.to},
          {normal_of(vertex, mesh.normals[normal]), normal, rim_normals[end.to]});
    }
  }

  /// The normal of a triangle; that of the crossing if the triangle is degenerate.
  Vec3f front_of(std::uint32_t x, const std::array<std::uint32_t, 3>& t) const {
    const auto at = [&](std::uint32_t v) {
      return v < vertices_.size() ? vertices_[v].position : crossings_.position(grid_, x);
    };
    const Vec3d n = cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
    const double size = length(n);
    return size > 1e-6 * grid_.spacing * grid_.spacing ? Vec3f(n / size) : crossings_.all[x].normal;
  }

  static std::uint32_t nearest(const SheetVertex& v, const Vec3f& front) {
    std::uint32_t best = 0;
    for (std::uint32_t k = 1; k < v.smooth_parts; ++k)
      if (dot(v.normals[k], front) > dot(v.normals[best], front)) best = k;
    return best;
  }

  const ContourGrid& grid_;
  const ContourCrossings& crossings_;
  const std::vector<SlotNumber>& links_;
  const ContourSheets& sheets_;
  const std::vector<RimPoint>& rims_;
  std::vector<SheetVertex>& vertices_;
  std::vector<std::uint32_t> normals_from_;                  ///< the first normal of each vertex in the mesh
  std::vector<std::pair<SlotNumber, std::uint32_t>> split_;  ///< links and the vertices on them
};

}  // namespace

Contour contour(const Accel& accel, const ContourOptions& options) {
  const Box box = bounds(accel);
  if (box.empty() || !(max_component(box.extent()) > 0)) return {};
  const ContourGrid grid = ContourGrid::around(Vec3d(box.lo), Vec3d(box.hi), options.cells);
  ContourCrossings crossings = sample_grid(accel, grid);
  if (options.closed) make_consistent(grid, crossings);
  const std::vector<SlotNumber> links = link_crossings(grid, crossings, options.closed);
  const ContourSheets sheets = find_sheets(crossings, links);
  const std::vector<RimPoint> rims = find_rims(accel, grid, crossings, links);
  std::vector<SheetVertex> vertices = place_vertices(accel, grid, crossings, sheets, links, rims);
  return Meshing(grid, crossings, links, sheets, rims, vertices).run();
}

}  // namespace oktett
