// Files of the cache: as they are, and with right checksums around wrong numbers. What is accepted is traced.

#include <unistd.h>

#include <memory>
#include <string>
#include <vector>

#include "accel/accel_data.h"
#include "core/error.h"
#include "io/cache/entries.h"
#include "io/cache/scene_cache.h"
#include "io/mesh/load/parse_mesh.h"
#include "tests/fuzz/tracing.h"
#include "tests/support/mixed_geometry.h"

namespace oktett {
namespace {

/// Replaces 32-bit words here and there, as the input says.
template <class T>
void patch(T* data, std::size_t count, test::InputBytes& bytes) {
  static_assert(sizeof(T) % 4 == 0);
  const std::size_t words = count * sizeof(T) / 4;
  const auto at = bytes.take<std::uint16_t>();
  const auto value = bytes.take<std::uint32_t>();
  if (words > 0) std::memcpy(reinterpret_cast<char*>(data) + at % words * 4, &value, 4);
}

/// Gives out the tree that was kept last, changed by an input.
class PatchedStore final : public TreeStore {
 public:
  explicit PatchedStore(test::InputBytes& bytes) : bytes_(bytes) { set_tree_store(this); }
  ~PatchedStore() override { set_tree_store(nullptr); }
  std::size_t least_triangles() const override { return 1; }
  bool load(std::uint64_t, Accel& accel, ItemOrder& order) override {
    if (nodes_.empty()) return false;
    std::vector<BvhNode> nodes = nodes_;
    std::vector<TriangleBlock> blocks = blocks_;
    accel.leaves = leaves_, accel.root = root_, accel.bounds = bounds_;
    for (int k = 0; k < kKinds; ++k) order[k] = order_[k];
    for (int left = 1 + bytes_.take<std::uint8_t>() % 8; left > 0; --left) {
      switch (bytes_.take<std::uint8_t>() % 8) {
        case 0:
        case 1:
        case 2:
          patch(nodes.data(), nodes.size(), bytes_);
          break;
        case 3:
          patch(nodes[bytes_.take<std::uint8_t>() % nodes.size()].child, BvhNode::kWidth, bytes_);
          break;
        case 4:
          patch(blocks.data(), blocks.size(), bytes_);
          break;
        case 5:
          patch(accel.leaves.data(), accel.leaves.size(), bytes_);
          break;
        case 6: {
          std::vector<std::uint32_t>& items = order[bytes_.take<std::uint8_t>() % kKinds];
          patch(items.data(), items.size(), bytes_);
          break;
        }
        default:
          accel.root = NodeRef::from_bits(bytes_.take<std::uint32_t>());
      }
    }
    accel.nodes = copy<BvhNode>(nodes), accel.blocks = copy<TriangleBlock>(blocks);
    count_tree(accel, nodes.size(), blocks.size());
    return true;
  }
  void refuse(std::uint64_t, const std::string& why) override {
    test::require(!why.empty(), "there is a reason");
  }
  void keep(std::uint64_t, const Accel& accel, const ItemOrder& order) override {
    nodes_.assign(accel.nodes.data(), accel.nodes.data() + accel.stats.nodes);
    blocks_.assign(accel.blocks.data(), accel.blocks.data() + block_count(accel));
    leaves_ = accel.leaves, root_ = accel.root, bounds_ = accel.bounds;
    for (int k = 0; k < kKinds; ++k) order_[k] = order[k];
  }

 private:
  template <class T>
  static VirtualArray<T> copy(const std::vector<T>& from) {
    VirtualArray<T> array(from.size());
    if (!from.empty()) std::memcpy(static_cast<void*>(array.data()), from.data(), from.size() * sizeof(T));
    return array;
  }

  test::InputBytes& bytes_;
  static inline std::vector<BvhNode> nodes_;
  static inline std::vector<TriangleBlock> blocks_;
  static inline std::vector<LeafEntry> leaves_;
  static inline NodeRef root_ = NodeRef::none();
  static inline Box bounds_;
  static inline ItemOrder order_;
};

void trace(const Accel& accel, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size()), all;
  closest_hit(accel, rays, hits);
  std::vector<std::uint8_t> occluded(rays.size());
  any_hit(accel, rays, occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    all_hits(accel, rays[i], all, Isa::scalar);
    if (hits[i].valid()) (void)surface_interaction(accel, rays[i], hits[i]);
  }
}

void fuzz_tree(test::InputBytes& bytes) {
  static const test::MixedGeometry mixed(60, 3);
  PatchedStore store(bytes);
  BuildOptions options;
  options.parallel = false;
  // The first call keeps the tree.
  static const auto good = build_accel(mixed.geometries, options);
  const auto accel = build_accel(mixed.geometries, options);
  trace(*accel, test::take_rays(bytes, 16));
}

void expect_indices(const TriangleMesh& mesh) {
  for (const std::uint32_t index : mesh.indices)
    test::require(index < mesh.positions.size(), "an index leads to a vertex");
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) (void)corner_uvs(mesh, t);
}

void fuzz_file(test::InputBytes& bytes, bool mesh) {
  static test::InputFile file("a.cache");
  const std::string& path = file.write(bytes.rest());
  try {
    const CacheFile cache(path);
    if (mesh) {
      MeshEntry entry = read_mesh_header(cache);
      read_mesh_columns(cache, entry);
      expect_indices(entry.parsed.mesh);
    } else {
      Accel accel;
      ItemOrder order;
      read_tree(cache, 0, accel, order);
    }
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
}

/// A file of a mesh with right checksums, whose header and columns the input has changed.
void fuzz_mesh(test::InputBytes& bytes) {
  static test::InputFile file("b.cache");
  MeshEntry entry;
  TriangleMesh& mesh = entry.parsed.mesh;
  const auto few = [&] { return std::size_t{bytes.take<std::uint8_t>()} % 8; };
  const auto fill = [&](Column<std::uint32_t>& indices) {
    for (std::size_t left = few(); left > 0; --left) {
      const auto value = bytes.take<std::uint8_t>();
      indices.push_back(value < 0xf0 ? value % 9 : bytes.take<std::uint32_t>());
    }
  };
  for (std::size_t left = few(); left > 0; --left) mesh.positions.push_back({1, 2, 3});
  for (std::size_t left = few(); left > 0; --left) mesh.normals.push_back({1, 2, 3});
  for (std::size_t left = few(); left > 0; --left) mesh.uvs.push_back({1, 2});
  fill(mesh.indices), fill(mesh.normal_indices), fill(mesh.uv_indices);
  for (std::size_t left = few(); left > 0; --left)
    mesh.material_slots.push_back(bytes.take<std::uint8_t>() % 5);
  entry.parsed.materials.resize(few() % 4);
  entry.path = "/a.obj";
  std::string header = mesh_header(entry);
  if (bytes.take<std::uint8_t>() % 4 == 0) header[bytes.take<std::uint8_t>() % header.size()] ^= 1;
  const std::string path = file.dir().file("b.cache");
  write_cache_file(path, header, mesh_sections(entry), 0);
  try {
    const CacheFile cache(path);
    MeshEntry read = read_mesh_header(cache);
    read_mesh_columns(cache, read);
    expect_indices(read.parsed.mesh);
    (void)finish_mesh("/a.obj", std::move(read.parsed));
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
}

}  // namespace
}  // namespace oktett

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  test::InputBytes bytes(data, size);
  const auto kind = bytes.take<std::uint8_t>();
  if (kind % 8 < 5)
    fuzz_tree(bytes);
  else if (kind % 8 < 7)
    fuzz_mesh(bytes);
  else
    fuzz_file(bytes, kind & 8);
  return 0;
}
