#include "io/pov/translate/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "core/far_mesh.h"
#include "core/random.h"
#include "io/pov/translate/extent.h"
#include "io/pov/translate/plane_loops.h"

namespace oktett::pov {

namespace {

/// Position, normal and uv of a corner.
using CornerNumbers = std::array<double, 8>;
struct HashOfCorner {
  std::size_t operator()(const CornerNumbers& corner) const {
    std::uint64_t key = 0;
    for (const double number : corner)
      key = mix_bits(key + std::bit_cast<std::uint64_t>(number) + kGoldenBits);
    return key;
  }
};

/// Of a triangle; up, if it has no area.
Vec3d flat_normal(const std::array<MeshCorner, 3>& triangle) {
  const Vec3d face =
      cross(triangle[1].position - triangle[0].position, triangle[2].position - triangle[0].position);
  const double size = length(face);
  return size > 0 ? face / size : Vec3d{0, 1, 0};
}

}  // namespace

void MeshMaker::add(std::array<MeshCorner, 3> corners) {
  const Vec3d face =
      cross(corners[1].position - corners[0].position, corners[2].position - corners[0].position);
  Vec3d normals{0, 0, 0};
  for (const MeshCorner& c : corners) normals = normals + c.normal.value_or(Vec3d{0, 0, 0});
  if (use_ == MeshUse::shown && dot(face, normals) < 0) std::swap(corners[1], corners[2]);
  triangles_.push_back(std::move(corners));
}

std::shared_ptr<const TriangleMesh> MeshMaker::finish() const {
  auto mesh = std::make_shared<TriangleMesh>();
  bool normals = false, uvs = false;
  for (const auto& triangle : triangles_)
    for (const MeshCorner& c : triangle) normals |= c.normal.has_value(), uvs |= c.uv.has_value();
  std::vector<Vec3d> places;
  std::unordered_map<CornerNumbers, std::uint32_t, HashOfCorner> known;
  for (const auto& triangle : triangles_) {
    const Vec3d flat = normals ? flat_normal(triangle) : Vec3d{0, 1, 0};
    for (const MeshCorner& c : triangle) {
      const Vec3d n = c.normal.value_or(flat);
      const auto uv = c.uv.value_or(std::array<double, 2>{0, 0});
      CornerNumbers key{c.position.x, c.position.y, c.position.z};
      if (normals) key[3] = n.x, key[4] = n.y, key[5] = n.z;
      if (uvs) key[6] = uv[0], key[7] = uv[1];
      for (double& number : key) number += 0.0;  // 0 for -0, which has other bits
      const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(places.size()));
      if (is_new) {
        places.push_back(c.position);
        mesh->positions.push_back(Vec3f(c.position));
        if (normals) mesh->normals.push_back(Vec3f(n));
        if (uvs) mesh->uvs.push_back({static_cast<float>(uv[0]), static_cast<float>(uv[1])});
      }
      mesh->indices.push_back(entry->second);
      if (normals) mesh->normal_indices.push_back(entry->second);
      if (uvs) mesh->uv_indices.push_back(entry->second);
    }
  }
  // What lies far from the origin counts from a centre, as in files.
  if (const std::optional<Vec3d> centre = far_centre(mesh->positions, false)) {
    mesh->origin = *centre;
    for (std::size_t i = 0; i < places.size(); ++i) mesh->positions[i] = Vec3f(places[i] - *centre);
  }
  return mesh;
}

std::string add_mesh(Context& context, std::shared_ptr<const TriangleMesh> mesh, const std::string& wanted) {
  std::string name;
  for (int i = 1; name.empty() || context.meshes.contains(name); ++i)
    name = fmt::format("{}{}{}.ply", context.mesh_prefix, wanted, i == 1 ? "" : fmt::format("-{}", i));
  context.meshes.emplace(name, std::move(mesh));
  return name;
}

namespace {

/// Triangles by texture, in the order in which the textures come first.
class Parts {
 public:
  explicit Parts(MeshUse use) : use_(use) {}

  MeshMaker& of(const std::shared_ptr<const Block>& texture) {
    for (MeshPart& part : made.parts)
      if (part.texture == texture || use_ == MeshUse::camera) return part.mesh;
    made.parts.push_back({MeshMaker(use_), texture});
    return made.parts.back().mesh;
  }
  MadeMesh made;

 private:
  MeshUse use_;
};

// ---- Polygons.

/// Cuts a list of points, of which each loop ends with its first point, into loops.
template <class Point>
std::vector<std::vector<Point>> split_loops(const std::vector<Point>& points) {
  std::vector<std::vector<Point>> loops;
  std::vector<Point> loop;
  for (const Point& p : points) {
    if (loop.size() > 1 && p == loop.front()) {
      loops.push_back(std::move(loop));
      loop.clear();
    } else {
      loop.push_back(p);
    }
  }
  if (loop.size() > 2) loops.push_back(std::move(loop));
  std::erase_if(loops, [](const auto& l) { return l.size() < 3; });
  return loops;
}

// ---- Each kind of object.

MadeMesh make_triangles(Context& context, const Block& block, bool smooth, Arguments& a) {
  (void)block;
  MeshMaker mesh;
  std::array<MeshCorner, 3> corners;
  for (MeshCorner& c : corners) {
    c.position = a.vector("a point");
    if (smooth) c.normal = a.vector("a normal");
  }
  mesh.add(corners);
  (void)context;
  return {{{mesh, nullptr}}, false};
}

std::array<std::array<double, 2>, 3> read_uvs(Arguments& a) {
  std::array<std::array<double, 2>, 3> uv;
  for (auto& each : uv) each = a.pair("a texture coordinate");
  return uv;
}

MadeMesh make_mesh1(Context& context, Arguments& a, MeshUse use) {
  Parts parts(use);
  while (const Block* const block = a.peek_block()) {
    const bool smooth = block->keyword == "smooth_triangle";
    if (!smooth && block->keyword != "triangle") break;
    Arguments inner(context, *block);
    std::array<MeshCorner, 3> corners;
    for (MeshCorner& c : corners) {
      c.position = inner.vector("a point");
      if (smooth) c.normal = inner.vector("a normal");
    }
    std::shared_ptr<const Block> texture;
    while (!inner.at_end()) {
      if (const auto own = inner.peek_shared_block()) {
        if (own->keyword == "texture") texture = own;
        inner.take();
      } else if (inner.take_word("uv_vectors")) {
        const auto uv = read_uvs(inner);
        for (std::size_t k = 0; k < 3; ++k) corners[k].uv = uv[k];
      } else {
        inner.take();
      }
    }
    parts.of(texture).add(corners);
    a.take();
  }
  return parts.made;
}

/// The numbers of a list of `mesh2`, behind their count.
struct Lists {
  std::vector<Vec3d> vertices, normals;
  std::vector<std::array<double, 2>> uvs;
  std::vector<std::shared_ptr<const Block>> textures;
  struct Face {
    std::array<std::size_t, 3> at{};
    std::array<std::size_t, 3> textures{};
    bool has_texture = false;
  };
  std::vector<Face> faces;
  std::vector<std::array<std::size_t, 3>> normal_faces, uv_faces;
};

std::array<std::size_t, 3> indices(Context& context, Arguments& a, std::size_t count) {
  const Place where = a.where();
  const Vec3d v = a.vector("three indices");
  std::array<std::size_t, 3> out{};
  for (int k = 0; k < 3; ++k) {
    if (!(v[k] >= 0 && v[k] < static_cast<double>(count)))
      context.fail(where, fmt::format("index {} is out of range: there are {}", v[k], count));
    out[static_cast<std::size_t>(k)] = static_cast<std::size_t>(v[k]);
  }
  return out;
}

void read_list(Context& context, const Block& block, Lists& lists) {
  Arguments a(context, block);
  const std::string_view k = block.keyword;
  if (k == "texture_list") {
    while (!a.at_end()) {
      if (const auto texture = a.peek_shared_block()) lists.textures.push_back(texture);
      a.take();
    }
    return;
  }
  const auto count = static_cast<std::size_t>(std::max(0.0, a.number("a count")));
  for (std::size_t i = 0; i < count; ++i) {
    if (k == "vertex_vectors") {
      lists.vertices.push_back(a.vector("a point"));
    } else if (k == "normal_vectors") {
      lists.normals.push_back(a.vector("a normal"));
    } else if (k == "uv_vectors") {
      lists.uvs.push_back(a.pair("a texture coordinate"));
    } else if (k == "face_indices") {
      Lists::Face face{indices(context, a, lists.vertices.size())};
      for (std::size_t n = 0; n < 3 && a.is_numbers() && !a.is_vector(); ++n) {
        const auto index = static_cast<std::size_t>(std::max(0.0, a.number("an index")));
        if (n == 0) face.textures.fill(index);
        face.textures[n] = index, face.has_texture = true;
      }
      lists.faces.push_back(face);
    } else if (k == "normal_indices") {
      lists.normal_faces.push_back(indices(context, a, lists.normals.size()));
    } else if (k == "uv_indices") {
      lists.uv_faces.push_back(indices(context, a, lists.uvs.size()));
    }
  }
}

MadeMesh make_mesh2(Context& context, Arguments& a, MeshUse use) {
  Lists lists;
  while (const Block* const block = a.peek_block()) {
    const std::string_view k = block->keyword;
    if (k != "vertex_vectors" && k != "normal_vectors" && k != "uv_vectors" && k != "texture_list" &&
        k != "face_indices" && k != "normal_indices" && k != "uv_indices")
      break;
    read_list(context, *block, lists);
    a.take();
  }
  // Without indices of their own, normals and texture coordinates are numbered as vertices.
  const bool normals_by_vertex = lists.normal_faces.empty() && lists.normals.size() == lists.vertices.size();
  const bool uvs_by_vertex = lists.uv_faces.empty() && lists.uvs.size() == lists.vertices.size();
  Parts parts(use);
  for (std::size_t f = 0; f < lists.faces.size(); ++f) {
    const Lists::Face& face = lists.faces[f];
    std::array<MeshCorner, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k].position = lists.vertices[face.at[k]];
      if (normals_by_vertex && !lists.normals.empty()) corners[k].normal = lists.normals[face.at[k]];
      if (f < lists.normal_faces.size()) corners[k].normal = lists.normals[lists.normal_faces[f][k]];
      if (uvs_by_vertex && !lists.uvs.empty()) corners[k].uv = lists.uvs[face.at[k]];
      if (f < lists.uv_faces.size()) corners[k].uv = lists.uvs[lists.uv_faces[f][k]];
    }
    std::shared_ptr<const Block> texture;
    if (face.has_texture && face.textures[0] < lists.textures.size())
      texture = lists.textures[face.textures[0]];
    if (face.has_texture && (face.textures[1] != face.textures[0] || face.textures[2] != face.textures[0]))
      context.tell("blended textures", a.block().where,
                   "triangles whose corners have several textures show that of the first");
    parts.of(texture).add(corners);
  }
  return parts.made;
}

std::optional<MadeMesh> make_polygon(Context& context, Arguments& a) {
  const Place where = a.where();
  const auto count = static_cast<std::size_t>(std::max(0.0, a.number("a count")));
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(a.vector("a point"));
  const auto loops = split_loops(points);
  if (loops.empty()) {
    context.warn(where, "the polygon has no area; it is left out");
    return std::nullopt;
  }
  // The plane of the first loop, by Newell's sum.
  Vec3d normal{0, 0, 0};
  for (std::size_t i = 0; i < loops[0].size(); ++i)
    normal = normal + cross(loops[0][i], loops[0][(i + 1) % loops[0].size()]);
  const double size = length(normal);
  if (!(size > 0)) {
    context.warn(where, "the polygon has no area; it is left out");
    return std::nullopt;
  }
  normal = normal / size;
  // Loops are laid out without the axis along which the plane is seen best, and found again by their places.
  const int drop = std::abs(normal.x) > std::abs(normal.y) && std::abs(normal.x) > std::abs(normal.z) ? 0
                   : std::abs(normal.y) > std::abs(normal.z)                                          ? 1
                                                                                                      : 2;
  const int ax = (drop + 1) % 3, ay = (drop + 2) % 3;
  const double height = dot(normal, loops[0][0]);
  std::vector<Loop> flat;
  for (const auto& loop : loops) {
    flat.emplace_back();
    for (const Vec3d& p : loop) flat.back().push_back({p[ax], p[ay]});
  }
  const auto lift = [&](const PlainPoint& p) {
    Vec3d out;
    out[ax] = p.x, out[ay] = p.y;
    out[drop] = (height - normal[ax] * p.x - normal[ay] * p.y) / normal[drop];
    return out;
  };
  MeshMaker mesh;
  fill(std::move(flat), [&](PlainPoint p, PlainPoint q, PlainPoint r) {
    // As triangles of meshes, which have their fronts on the other side than polygons.
    std::array<MeshCorner, 3> corners{MeshCorner{lift(p)}, MeshCorner{lift(q)}, MeshCorner{lift(r)}};
    const Vec3d face =
        cross(corners[1].position - corners[0].position, corners[2].position - corners[0].position);
    if (dot(face, normal) > 0) std::swap(corners[1], corners[2]);
    mesh.add(std::move(corners));
  });
  return MadeMesh{{{mesh, nullptr}}, false};
}

}  // namespace

std::optional<MadeMesh> make_mesh(Context& context, Arguments& a, MeshUse use) {
  const std::string_view kind = a.block().keyword;
  if (kind == "mesh") return make_mesh1(context, a, use);
  if (kind == "mesh2") return make_mesh2(context, a, use);
  if (kind == "triangle" || kind == "smooth_triangle")
    return make_triangles(context, a.block(), kind == "smooth_triangle", a);
  if (kind == "polygon") return make_polygon(context, a);
  return std::nullopt;
}

}  // namespace oktett::pov
