#include "io/mesh/unify.h"

#include <array>
#include <cstring>

#include "core/error.h"

namespace oktett {
namespace {

/// What a corner shows beside its position.
struct CornerLook {
  Vec3f normal{0, 0, 0};
  Vec2f uv{0, 0};

  /// By their bits: -0 and 0 differ, and a NaN is like itself.
  bool operator==(const CornerLook& other) const { return std::memcmp(this, &other, sizeof *this) == 0; }
};
static_assert(sizeof(CornerLook) == 20);

class Unifying {
 public:
  explicit Unifying(const TriangleMesh& mesh)
      : mesh_(mesh), has_normals_(any(mesh.normal_indices)), has_uvs_(any(mesh.uv_indices)) {}

  UnifiedMesh run() {
    out_.positions.assign(mesh_.positions.begin(), mesh_.positions.end());
    out_.indices.assign(mesh_.indices.begin(), mesh_.indices.end());
    if (has_normals_ || has_uvs_) split();
    return std::move(out_);
  }

 private:
  static bool any(const Column<std::uint32_t>& indices) {
    for (const std::uint32_t index : indices)
      if (index != kNoId) return true;
    return false;
  }

  void split() {
    const std::size_t count = mesh_.positions.size();
    looks_.resize(count);
    next_.assign(count, kNoId);
    used_.assign(count, false);
    for (std::uint32_t triangle = 0; triangle < mesh_.triangle_count(); ++triangle) {
      const std::array<CornerLook, 3> looks = looks_of(triangle);
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& index = out_.indices[3 * std::size_t{triangle} + k];
        index = vertex(index, looks[k]);
      }
    }
    out_.split = out_.positions.size() - count;
    for (const CornerLook& look : looks_) {
      if (has_normals_) out_.normals.push_back(look.normal);
      if (has_uvs_) out_.uvs.push_back(look.uv);
    }
  }

  std::array<CornerLook, 3> looks_of(std::uint32_t triangle) {
    std::array<CornerLook, 3> looks;
    const std::size_t first = 3 * std::size_t{triangle};
    if (has_normals_) {
      const std::uint32_t* const index = &mesh_.normal_indices[first];
      // A triangle that lacks one of them is shown flat.
      const bool smooth = index[0] != kNoId && index[1] != kNoId && index[2] != kNoId;
      if (!smooth) ++out_.flat;
      for (std::size_t k = 0; k < 3; ++k) looks[k].normal = smooth ? mesh_.normals[index[k]] : flat(first);
    }
    if (has_uvs_) {
      const std::array<Vec2f, 3> uvs = corner_uvs(mesh_, triangle);
      for (std::size_t k = 0; k < 3; ++k) looks[k].uv = uvs[k];
    }
    return looks;
  }

  Vec3f flat(std::size_t first) const {
    const auto corner = [&](std::size_t k) { return mesh_.positions[mesh_.indices[first + k]]; };
    return flat_normal(corner(0), corner(1), corner(2));
  }

  /// The vertex at `position` that looks like that; new if there is none.
  std::uint32_t vertex(std::uint32_t position, const CornerLook& look) {
    if (!used_[position]) {
      used_[position] = true, looks_[position] = look;
      return position;
    }
    std::uint32_t last = position;
    for (std::uint32_t i = position; i != kNoId; last = i, i = next_[i])
      if (looks_[i] == look) return i;
    if (out_.positions.size() >= kNoId - 1) throw Error("more vertices than 32-bit indices can tell apart");
    const auto added = static_cast<std::uint32_t>(out_.positions.size());
    out_.positions.push_back(mesh_.positions[position]);
    looks_.push_back(look), next_.push_back(kNoId);
    next_[last] = added;
    return added;
  }

  const TriangleMesh& mesh_;
  const bool has_normals_, has_uvs_;
  UnifiedMesh out_;
  std::vector<CornerLook> looks_;
  std::vector<std::uint32_t> next_;  ///< the next vertex at the same position
  std::vector<bool> used_;           ///< by a triangle so far
};

}  // namespace

void UnifiedMesh::note_changes(std::size_t before, MeshLosses& losses) const {
  if (split > 0)
    losses.push_back("changed: " + std::to_string(positions.size()) + " vertices instead of " +
                     std::to_string(before) + ", because one has one normal and one texture coordinate");
  if (flat > 0)
    losses.push_back("changed: " + count_of(flat, "triangle") +
                     " without normals get those of flat triangles");
}

UnifiedMesh unify_vertices(const TriangleMesh& mesh) { return Unifying(mesh).run(); }

Vec3f flat_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d normal = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
  const double size = length(normal);
  return size > 0 ? Vec3f(normal * (1 / size)) : Vec3f{0, 0, 0};
}

}  // namespace oktett
