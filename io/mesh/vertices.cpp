#include "io/mesh/vertices.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "core/error.h"

namespace oktett {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kBuckets = 64;
using BucketCounts = std::array<std::uint32_t, kBuckets>;

/// Of equal positions the same.
std::uint32_t hash_of(const Vec3f& p) {
  std::uint64_t hash = 0;
  for (const float x : {p.x, p.y, p.z}) {
    // -0 + 0 is 0.
    hash = (hash ^ std::bit_cast<std::uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return static_cast<std::uint32_t>(hash);
}

std::size_t bucket_of(std::uint32_t hash) { return hash % kBuckets; }

class Weld {
 public:
  explicit Weld(TriangleMesh& mesh)
      : mesh_(mesh), count_(mesh.positions.size()), blocks_((count_ + kBlock - 1) / kBlock) {}

  void run() {
    sort_into_buckets();
    oneapi::tbb::parallel_for(std::size_t{0}, kBuckets, [this](std::size_t b) { find_equal(b); });
    keep_first_ones();
    for (MeshAttribute& attribute : mesh_.attributes)
      if (attribute.domain == AttributeDomain::vertex) weld(attribute);
    for_each_block(mesh_.indices.size(), [this](std::size_t, std::size_t i) {
      std::uint32_t& index = mesh_.indices[i];
      index = kept_[first_[index]];
    });
  }

 private:
  /// Calls f(block, i) for all i below `count`.
  template <class F>
  static void for_each_block(std::size_t count, const F& f) {
    oneapi::tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) f(block, i);
    });
  }

  /// Lists the vertices of each bucket in their order.
  void sort_into_buckets() {
    hashes_.resize_uninitialized(count_);
    std::vector<BucketCounts> places(blocks_, BucketCounts{});
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      hashes_[i] = hash_of(mesh_.positions[i]);
      ++places[block][bucket_of(hashes_[i])];
    });
    std::uint32_t next = 0;
    for (std::size_t b = 0; b < kBuckets; ++b) {
      starts_[b] = next;
      for (BucketCounts& place : places) next += std::exchange(place[b], next);
    }
    starts_[kBuckets] = next;
    members_.resize_uninitialized(count_);
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      members_[places[block][bucket_of(hashes_[i])]++] = static_cast<std::uint32_t>(i);
    });
  }

  /// Sets first_ of all vertices in a bucket.
  void find_equal(std::size_t bucket) {
    const std::size_t size = starts_[bucket + 1] - starts_[bucket];
    const std::size_t slots = std::bit_ceil(2 * size + 1);
    std::vector<std::uint32_t> table(slots, kNoId);
    for (std::size_t m = starts_[bucket]; m < starts_[bucket + 1]; ++m) {
      const std::uint32_t i = members_[m];
      std::size_t slot = (hashes_[i] / kBuckets) & (slots - 1);
      while (table[slot] != kNoId && !(mesh_.positions[table[slot]] == mesh_.positions[i]))
        slot = (slot + 1) & (slots - 1);
      if (table[slot] == kNoId) table[slot] = i;
      first_[i] = table[slot];
    }
  }

  /// Moves the first of each place together and notes where they are now.
  void keep_first_ones() {
    std::vector<std::uint32_t> before(blocks_ + 1, 0);
    for_each_block(count_, [&](std::size_t block, std::size_t i) { before[block + 1] += first_[i] == i; });
    for (std::size_t block = 0; block < blocks_; ++block) before[block + 1] += before[block];
    Column<Vec3f> positions(before[blocks_]);
    for_each_block(count_, [&](std::size_t block, std::size_t i) {
      if (first_[i] != i) return;
      positions[before[block]] = mesh_.positions[i];
      kept_[i] = before[block]++;
    });
    mesh_.positions = std::move(positions);
  }

  /// Of values that are the same wherever vertices become one, those of the first ones are left.
  void weld(MeshAttribute& attribute) {
    attribute.floats.empty() ? weld(attribute, attribute.srgb) : weld(attribute, attribute.floats);
  }
  template <class T>
  void weld(MeshAttribute& attribute, Column<T>& values) {
    const std::size_t size = attribute.components;
    std::atomic<bool> differ{false};
    for_each_block(count_, [&](std::size_t, std::size_t i) {
      if (first_[i] != i && std::memcmp(&values[size * i], &values[size * first_[i]], size * sizeof(T)) != 0)
        differ.store(true, std::memory_order_relaxed);
    });
    const auto copy = [&](std::size_t from, std::size_t to, Column<T>& out) {
      std::copy_n(&values[size * from], size, &out[size * to]);
    };
    Column<T> result(size * (differ ? mesh_.indices.size() : mesh_.positions.size()));
    if (differ) {
      attribute.domain = AttributeDomain::corner;
      for_each_block(mesh_.indices.size(),
                     [&](std::size_t, std::size_t i) { copy(mesh_.indices[i], i, result); });
    } else {
      for_each_block(count_, [&](std::size_t, std::size_t i) {
        if (first_[i] == i) copy(i, kept_[i], result);
      });
    }
    values = std::move(result);
  }

  TriangleMesh& mesh_;
  const std::size_t count_, blocks_;
  Column<std::uint32_t> hashes_, members_;  ///< members_: vertices by bucket
  std::array<std::uint32_t, kBuckets + 1> starts_{};
  Column<std::uint32_t> first_{count_};  ///< the first vertex at the same place
  Column<std::uint32_t> kept_{count_};   ///< where a first vertex is kept
};

}  // namespace

void weld_positions(TriangleMesh& mesh) { Weld(mesh).run(); }

namespace {

/// What a corner shows beside its position.
struct CornerLook {
  Vec3f normal{0, 0, 0};
  Vec2f uv{0, 0};
  std::uint32_t tangent = kNoId, second_uv = kNoId;  ///< indices of what has no index of its own

  /// By their bits: -0 and 0 differ, and a NaN is like itself.
  bool operator==(const CornerLook& other) const { return std::memcmp(this, &other, sizeof *this) == 0; }
};
static_assert(sizeof(CornerLook) == 28);

class Unifying {
 public:
  Unifying(const TriangleMesh& mesh, bool keep_faces)
      : mesh_(mesh), has_normals_(any(mesh.normal_indices)), has_uvs_(any(mesh.uv_indices)) {
    for (const MeshAttribute& attribute : mesh.attributes)
      if (attribute.domain == AttributeDomain::corner ||
          (attribute.domain == AttributeDomain::face && !keep_faces))
        splitting_.push_back(&attribute);
  }

  UnifiedMesh run() {
    out_.positions.assign(mesh_.positions.begin(), mesh_.positions.end());
    out_.origin = mesh_.origin;
    out_.indices.assign(mesh_.indices.begin(), mesh_.indices.end());
    corner_of_.assign(splitting_.empty() ? 0 : mesh_.positions.size(), 0);
    if (has_normals_ || has_uvs_ || !splitting_.empty()) split();
    for (const MeshAttribute& attribute : mesh_.attributes) out_.attributes.push_back(unified(attribute));
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
        const std::size_t corner = 3 * std::size_t{triangle} + k;
        out_.indices[corner] = vertex(out_.indices[corner], looks[k], corner);
      }
    }
    out_.split = out_.positions.size() - count;
    for (const CornerLook& look : looks_) {
      if (has_normals_) out_.normals.push_back(look.normal);
      if (has_uvs_) out_.uvs.push_back(look.uv);
      if (has_normals_ && !mesh_.tangents.empty())
        out_.tangents.push_back(look.tangent == kNoId ? std::array<float, 4>{}
                                                      : mesh_.tangents[look.tangent]);
      if (has_uvs_ && !mesh_.second_uvs.empty())
        out_.second_uvs.push_back(look.second_uv == kNoId ? Vec2f{0, 0} : mesh_.second_uvs[look.second_uv]);
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
      for (std::size_t k = 0; k < 3; ++k) {
        looks[k].normal = smooth ? mesh_.normals[index[k]] : flat(first);
        if (smooth && !mesh_.tangents.empty()) looks[k].tangent = index[k];
      }
    }
    if (has_uvs_) {
      const std::array<Vec2f, 3> uvs = corner_uvs(mesh_, triangle);
      for (std::size_t k = 0; k < 3; ++k) {
        looks[k].uv = uvs[k];
        if (!mesh_.second_uvs.empty()) looks[k].second_uv = mesh_.uv_indices[first + k];
      }
    }
    return looks;
  }

  Vec3f flat(std::size_t first) const {
    const auto corner = [&](std::size_t k) { return mesh_.positions[mesh_.indices[first + k]]; };
    return flat_normal(corner(0), corner(1), corner(2));
  }

  /// The vertex at `position` that looks like that corner; new if there is none.
  std::uint32_t vertex(std::uint32_t position, const CornerLook& look, std::size_t corner) {
    if (!used_[position]) {
      used_[position] = true, looks_[position] = look;
      if (!splitting_.empty()) corner_of_[position] = corner;
      return position;
    }
    std::uint32_t last = position;
    for (std::uint32_t i = position; i != kNoId; last = i, i = next_[i])
      if (looks_[i] == look && carry_the_same(i, corner)) return i;
    if (out_.positions.size() >= kNoId - 1) throw Error("more vertices than 32-bit indices can tell apart");
    const auto added = static_cast<std::uint32_t>(out_.positions.size());
    out_.positions.push_back(mesh_.positions[position]);
    looks_.push_back(look), next_.push_back(kNoId);
    if (!splitting_.empty()) corner_of_.push_back(corner);
    next_[last] = added;
    return added;
  }

  /// Where the value of a corner stands in an attribute of faces or corners.
  static std::size_t value_place(const MeshAttribute& attribute, std::size_t corner) {
    return (attribute.domain == AttributeDomain::face ? corner / 3 : corner) * attribute.components;
  }

  /// Whether the attributes that are split are those of the corner that made the vertex.
  bool carry_the_same(std::uint32_t vertex, std::size_t corner) const {
    for (const MeshAttribute* a : splitting_) {
      const std::size_t one = value_place(*a, corner_of_[vertex]), other = value_place(*a, corner);
      const auto equal = [&](const auto& values) {
        return values.empty() ||
               std::memcmp(&values[one], &values[other], a->components * sizeof(values[0])) == 0;
      };
      if (!equal(a->floats) || !equal(a->srgb)) return false;
    }
    return true;
  }

  MeshAttribute unified(const MeshAttribute& attribute) const {
    MeshAttribute out;
    out.name = attribute.name, out.components = attribute.components;
    const bool splits = std::ranges::find(splitting_, &attribute) != splitting_.end();
    if (attribute.domain == AttributeDomain::face && !splits) {
      out.domain = AttributeDomain::face;
      out.floats = attribute.floats, out.srgb = attribute.srgb;
      return out;
    }
    const auto fill = [&](const auto& values, auto& to) {
      if (values.empty()) return;
      const std::size_t size = attribute.components;
      to.resize_uninitialized(out_.positions.size() * size);
      // Vertices that no triangle has are those before the split ones.
      std::memset(to.data(), 0, to.size() * sizeof(to[0]));
      if (!splits) std::copy_n(values.data(), values.size(), to.data());
      for (std::size_t corner = 0; corner < out_.indices.size(); ++corner) {
        const std::size_t from = splits ? value_place(attribute, corner) : mesh_.indices[corner] * size;
        std::copy_n(values.data() + from, size, to.data() + out_.indices[corner] * size);
      }
    };
    fill(attribute.floats, out.floats), fill(attribute.srgb, out.srgb);
    return out;
  }

  const TriangleMesh& mesh_;
  const bool has_normals_, has_uvs_;
  std::vector<const MeshAttribute*> splitting_;  ///< by which vertices differ, too
  UnifiedMesh out_;
  std::vector<CornerLook> looks_;
  std::vector<std::uint32_t> next_;       ///< the next vertex at the same position
  std::vector<bool> used_;                ///< by a triangle so far
  std::vector<std::uint64_t> corner_of_;  ///< the first that a vertex was made for; if attributes are split
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

UnifiedMesh unify_vertices(const TriangleMesh& mesh, bool keep_faces) {
  return Unifying(mesh, keep_faces).run();
}

Vec3f flat_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d normal = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
  const double size = length(normal);
  return size > 0 ? Vec3f(normal * (1 / size)) : Vec3f{0, 0, 0};
}

}  // namespace oktett
