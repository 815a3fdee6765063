#include "accel/build/mesh_source.h"

#include <algorithm>
#include <bit>

#include "core/parallel.h"

namespace oktett {
namespace {

/// References made by one task.
constexpr std::size_t kTrianglesTogether = 1u << 12;

/// Corners may coincide: no ray hits such a triangle, but a point has a nearest one on it.
bool is_finite(const Vec3f (&v)[3]) {
  std::uint32_t greatest = 0;
  for (const Vec3f& p : v)
    for (int k = 0; k < 3; ++k)
      greatest = std::max(greatest, std::bit_cast<std::uint32_t>(p[k]) & 0x7fffffffu);
  return greatest < 0x7f800000u;
}

bool have_same_bits(const Vec3f& a, const Vec3f& b) {
  for (int k = 0; k < 3; ++k)
    if (std::bit_cast<std::uint32_t>(a[k]) != std::bit_cast<std::uint32_t>(b[k])) return false;
  return true;
}

}  // namespace

MeshSource::MeshSource(const Accel& accel) : accel_(accel) {
  std::uint32_t vertices = 0;
  for (std::size_t g = 0; g < accel.geometries.size(); ++g) {
    const Geometry& geometry = accel.geometries[g];
    Mesh m;
    if (const auto* shape = std::get_if<MeshGeometry>(&geometry.shape)) {
      m = {shape->mesh->positions.data(), shape->mesh->indices.data(), accel.first_item[g], vertices,
           geometry.transform.is_identity() ? nullptr : &geometry.transform};
      vertices += static_cast<std::uint32_t>(shape->mesh->positions.size());
    }
    meshes_.push_back(m);
  }
}

inline void MeshSource::corners(const Mesh& mesh, std::uint32_t item, Vec3f (&v)[3]) const {
  const std::uint32_t* index = indices(mesh, item);
  for (int k = 0; k < 3; ++k) {
    v[k] = mesh.positions[index[k]];
    if (mesh.transform != nullptr) v[k] = Vec3f(mesh.transform->point(Vec3d(v[k])));
  }
}

inline const MeshSource::Mesh& MeshSource::mesh_of(std::uint32_t item) const {
  return meshes_.size() == 1 ? meshes_[0] : meshes_[accel_.geometry_of(item)];
}

void MeshSource::corners(std::uint32_t item, Vec3f (&v)[3]) const { corners(mesh_of(item), item, v); }

std::size_t MeshSource::references(std::uint32_t geometry, std::size_t begin, std::size_t end, PrimRef* out,
                                   Box& bounds) const {
  const MeshGeometry& shape = std::get<MeshGeometry>(accel_.geometries[geometry].shape);
  const Mesh& mesh = meshes_[geometry];
  const std::uint32_t kind =
      static_cast<std::uint32_t>(Kind::triangle) | static_cast<std::uint32_t>(shape.test) << 8;
  const PrimRef* const first = out;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t item = mesh.first_item + static_cast<std::uint32_t>(i);
    Vec3f v[3];
    corners(mesh, item, v);
    if (!is_finite(v)) continue;
    const Vec3f lo = min(min(v[0], v[1]), v[2]), hi = max(max(v[0], v[1]), v[2]);
    bounds.lo = min(lo, bounds.lo), bounds.hi = max(hi, bounds.hi);
    *out++ = {{-lo.x, -lo.y, -lo.z}, item, {hi.x, hi.y, hi.z}, kind};
  }
  return static_cast<std::size_t>(out - first);
}

Box MeshSource::add_references(std::uint32_t geometry, BuildArrays& arrays, bool parallel) const {
  const std::size_t triangles =
      std::get<MeshGeometry>(accel_.geometries[geometry].shape).mesh->triangle_count();
  PrimRef* const refs = arrays.refs + arrays.count;
  arrays.populate(refs, triangles, parallel);
  struct Part {
    Box bounds;
    std::size_t finite = 0;
  };
  const Chunks chunks(triangles, kTrianglesTogether);
  std::vector<Part> parts(chunks.count);
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    parts[c].finite = references(geometry, begin, end, refs + begin, parts[c].bounds);
  });
  // Close the gaps that the others left.
  Box bounds;
  PrimRef* end = refs;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    const PrimRef* from = refs + c * chunks.size;
    if (from != end) std::copy(from, from + parts[c].finite, end);
    end += parts[c].finite;
    if (parts[c].finite > 0) bounds.grow(parts[c].bounds);
  }
  arrays.count += static_cast<std::size_t>(end - refs);
  return bounds;
}

void MeshSource::note_vertices(const PrimRef* refs, std::uint32_t count, VertexNumbers* out) const {
  const auto is_triangle = [&](std::uint32_t i) {
    return static_cast<Kind>(refs[i].kind & 0xff) == Kind::triangle;
  };
  for (std::uint32_t i = 0; i < count; ++i)
    if (is_triangle(i)) __builtin_prefetch(indices(mesh_of(refs[i].item), refs[i].item));
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!is_triangle(i)) continue;
    const Mesh& mesh = mesh_of(refs[i].item);
    const std::uint32_t* index = indices(mesh, refs[i].item);
    for (int k = 0; k < 3; ++k) out[i].of[k] = mesh.first_vertex + index[k];
  }
}

bool MeshSource::pack_corners(const std::uint32_t* items, int count, std::uint16_t* corners) const {
  Vec3f known[TriangleBlock::kCorners];
  int known_count = 0;
  for (int i = 0; i < count; ++i) {
    Vec3f v[3];
    this->corners(mesh_of(items[i]), items[i], v);
    int packed = 0;
    for (int k = 0; k < 3; ++k) {
      int n = 0;
      while (n < known_count && !have_same_bits(known[n], v[k])) ++n;
      if (n == TriangleBlock::kCorners) return false;
      if (n == known_count) known[known_count++] = v[k];
      packed |= n << 4 * k;
    }
    corners[i] = static_cast<std::uint16_t>(packed);
  }
  return true;
}

void MeshSource::fill(const std::uint32_t* items, const std::uint16_t* corners, int count,
                      TriangleBlock& block) const {
  for (int i = 0; i < count; ++i) {
    Vec3f v[3];
    this->corners(mesh_of(items[i]), items[i], v);
    if (i == 0)
      for (int axis = 0; axis < 3; ++axis) std::fill_n(block.row(axis), TriangleBlock::kCorners, v[0][axis]);
    block.first.corners[i] = corners[i], block.first.item[i] = items[i];
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) block.row(axis)[corners[i] >> 4 * k & 15] = v[k][axis];
  }
  for (int i = count; i < TriangleBlock::kSize; ++i) block.first.corners[i] = 0, block.first.item[i] = kNoId;
  std::ranges::fill(block.top, 0);
}

void MeshSource::prefetch(const std::uint32_t* items, int count) const {
  // One geometry, and it is a mesh.
  if (meshes_.size() != 1 || meshes_[0].indices == nullptr) return;
  const Mesh& mesh = meshes_[0];
  for (int i = 0; i < count; ++i) __builtin_prefetch(indices(mesh, items[i]));
}

}  // namespace oktett
