// Trees from the cache have the bytes of those that are built; those of other scenes and damaged ones are
// refused.

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "accel/accel_data.h"
#include "accel/build/kernels.h"
#include "accel/build/mesh_source.h"
#include "accel/build/tree_store.h"
#include "core/error.h"
#include "io/cache/entries.h"
#include "io/cache/scene_cache.h"
#include "tests/support/mixed_geometry.h"
#include "tests/support/temp_dir.h"
#include "verify/oracles/mesh.h"

namespace oktett::tree_cache_test {
namespace {

namespace fs = std::filesystem;
using test::MixedGeometry;
using test::TempDir;

/// Counts what is asked of a cache.
struct Counts {
  int loads = 0, hits = 0, refusals = 0, keeps = 0;
};

class CountingStore final : public TreeStore {
 public:
  explicit CountingStore(TreeStore& inner) : inner_(inner) { set_tree_store(this); }
  ~CountingStore() override { set_tree_store(&inner_); }
  std::size_t least_triangles() const override { return inner_.least_triangles(); }
  bool load(std::uint64_t key, Accel& accel, ItemOrder& order) override {
    ++counts.loads;
    const bool found = inner_.load(key, accel, order);
    if (found && change) change(accel, order);
    counts.hits += found;
    return found;
  }
  void refuse(std::uint64_t key, const std::string& why) override {
    ++counts.refusals, inner_.refuse(key, why);
  }
  void keep(std::uint64_t key, const Accel& accel, const ItemOrder& order) override {
    ++counts.keeps, inner_.keep(key, accel, order);
  }

  Counts counts;
  std::function<void(Accel&, ItemOrder&)> change;

 private:
  TreeStore& inner_;
};

RayBatch rays(std::size_t count) {
  RayBatch batch;
  batch.resize_uninitialized(count);
  CaseRandom r(9);
  for (std::size_t i = 0; i < count; ++i) {
    Ray ray;
    ray.origin = Vec3f(r.vector() * 3.0);
    ray.direction = Vec3f(r.vector()) - ray.origin;
    batch.set(i, ray);
  }
  return batch;
}

void expect_same_tree(const Accel& a, const Accel& b) {
  EXPECT_EQ(a.root.bits(), b.root.bits());
  EXPECT_EQ(a.pieces, b.pieces);
  EXPECT_EQ(a.bounds.lo, b.bounds.lo);
  EXPECT_EQ(a.bounds.hi, b.bounds.hi);
  ASSERT_EQ(a.stats.nodes, b.stats.nodes);
  EXPECT_EQ(a.stats.leaves, b.stats.leaves);
  EXPECT_EQ(a.stats.bytes(), b.stats.bytes());
  EXPECT_EQ(a.stats.depth, b.stats.depth);
  EXPECT_EQ(a.stats.sah_cost, b.stats.sah_cost);
  ASSERT_EQ(block_count(a), block_count(b));
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.stats.node_bytes), 0);
  EXPECT_EQ(std::memcmp(a.blocks.data(), b.blocks.data(), block_count(a) * sizeof(TriangleBlock)), 0);
  ASSERT_EQ(a.leaves.size(), b.leaves.size());
  EXPECT_EQ(std::memcmp(a.leaves.data(), b.leaves.data(), a.leaves.size() * sizeof(LeafEntry)), 0);
  const RayBatch batch = rays(2000);
  HitBatch x, y;
  x.resize_uninitialized(batch.size()), y.resize_uninitialized(batch.size());
  closest_hit(a, batch.span(), x.span()), closest_hit(b, batch.span(), y.span());
  int hits = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Hit p = x[i], q = y[i];
    ASSERT_EQ(std::memcmp(&p, &q, sizeof(Hit)), 0) << i;
    hits += p.valid();
  }
  EXPECT_GT(hits, 100);
}

class TreeCache : public testing::Test {
 protected:
  TreeCache() {
    options_.least_triangles = 1;
    options_.tell = [this](const std::string& problem) { told_.push_back(problem); };
    cache_ = std::make_unique<SceneCache>(dir_.file("cache"), options_);
  }
  std::string entry() const {
    for (const auto& file : fs::directory_iterator(dir_.file("cache")))
      if (file.path().extension() == ".tree") return file.path().string();
    return "";
  }

  TempDir dir_;
  std::vector<std::string> told_;
  SceneCacheOptions options_;
  std::unique_ptr<SceneCache> cache_;
};

TEST_F(TreeCache, TreesOfAllKindsComeBack) {
  for (const BuildQuality quality :
       {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best, BuildQuality::compact})
    for (const int triangles : {1, 40, 3000}) {
      const MixedGeometry mixed(triangles, 3);
      set_tree_store(nullptr);
      const auto built = build_accel(mixed.geometries, {quality});
      set_tree_store(cache_.get());
      CountingStore store(*cache_);
      const auto kept = build_accel(mixed.geometries, {quality});
      const auto loaded = build_accel(mixed.geometries, {quality});
      EXPECT_EQ(store.counts.hits, 1);
      EXPECT_EQ(store.counts.keeps, 1);
      expect_same_tree(*built, *kept);
      expect_same_tree(*built, *loaded);
    }
  EXPECT_TRUE(told_.empty());
}

TEST_F(TreeCache, EverythingThatTheTreeDependsOnMakesAnotherKey) {
  MixedGeometry mixed(50, 3);
  CountingStore store(*cache_);
  const auto expect_hit = [&](bool expected, const char* what) {
    store.counts = {};
    const auto accel = build_accel(mixed.geometries);
    EXPECT_EQ(store.counts.hits == 1, expected) << what;
    set_tree_store(nullptr);
    const auto built = build_accel(mixed.geometries);
    set_tree_store(&store);
    expect_same_tree(*accel, *built);
  };
  expect_hit(false, "first");
  expect_hit(true, "again");
  mixed.first.positions[5].x += 0.01f;
  expect_hit(false, "a vertex");
  std::swap(mixed.first.indices[0], mixed.first.indices[4]);
  expect_hit(false, "an index");
  mixed.geometries[5].transform.m[0][3] += 0.5;
  expect_hit(false, "a transform");
  std::get<MeshGeometry>(mixed.geometries[5].shape).test = TriangleTest::badouel;
  expect_hit(false, "a test");
  std::get<SpheresShape>(mixed.geometries[0].shape).spheres[1].radius *= 1.5;
  expect_hit(false, "a sphere");
  std::get<InstanceList>(mixed.geometries[9].shape).places[3].to_list[3] += 0.25f;
  expect_hit(false, "an instance");
  // What shading alone depends on.
  std::get<MeshGeometry>(mixed.geometries[1].shape).smooth = false;
  mixed.geometries[1].user = 7;
  expect_hit(true, "shading");
  store.counts = {};
  build_accel(mixed.geometries, {BuildQuality::best});
  EXPECT_EQ(store.counts.hits, 0);
  options_.least_triangles = 1000;
  store.counts = {};
  cache_.reset();
  cache_ = std::make_unique<SceneCache>(dir_.file("cache"), options_);
  build_accel(mixed.geometries);
  EXPECT_EQ(store.counts.loads, 0) << "a small tree is not kept";
}

// The builder's kernels of all instruction sets make the same tree, so it may be shared by machines.
TEST_F(TreeCache, NoTreeDependsOnTheInstructionSet) {
  const MixedGeometry mixed(3000, 5);
  const TriangleMesh& mesh = mixed.first;
  std::vector<std::unique_ptr<Accel>> trees;
  for (const Isa isa : available_isas()) {
    Accel& accel = *trees.emplace_back(std::make_unique<Accel>());
    accel.geometries = {{MeshGeometry{&mesh}, {}, kNoId}};
    accel.first_item = {0, static_cast<std::uint32_t>(mesh.triangle_count())};
    const MeshSource source(accel);
    BuildArrays arrays(mesh.triangle_count(), effort_of(BuildQuality::balanced));
    ItemOrder order;
    accel.bounds = source.add_references(0, arrays, true);
    build_tree(accel, arrays, source, order, {}, build_kernels(isa));
    ASSERT_EQ(accel.stats.bytes(), trees[0]->stats.bytes());
    EXPECT_EQ(std::memcmp(accel.nodes.data(), trees[0]->nodes.data(), accel.stats.node_bytes), 0);
    EXPECT_EQ(std::memcmp(accel.blocks.data(), trees[0]->blocks.data(), accel.stats.leaf_bytes), 0);
  }
}

/// A copy of the nodes that may be changed; those from the cache are mapped for reading.
VirtualArray<BvhNode> copy_nodes(const Accel& accel) {
  VirtualArray<BvhNode> nodes(accel.stats.nodes);
  std::memcpy(static_cast<void*>(nodes.data()), accel.nodes.data(), accel.stats.node_bytes);
  return nodes;
}
VirtualArray<TriangleBlock> copy_blocks(const Accel& accel) {
  VirtualArray<TriangleBlock> blocks(block_count(accel));
  std::memcpy(static_cast<void*>(blocks.data()), accel.blocks.data(),
              block_count(accel) * sizeof(TriangleBlock));
  return blocks;
}

/// Trees that are no trees, as no checksum can tell.
TEST_F(TreeCache, ImpossibleTreesAreRefused) {
  const MixedGeometry mixed(3000, 3);
  CountingStore store(*cache_);
  const auto good = build_accel(mixed.geometries);
  using Change = std::function<void(Accel&, ItemOrder&)>;
  const auto node = [](int n, int child, auto ref) -> Change {
    return [=](Accel& a, ItemOrder&) {
      a.nodes = copy_nodes(a);
      a.nodes[static_cast<std::size_t>(n)].child[child] = ref(a);
    };
  };
  const auto block = [](auto edit) -> Change {
    return [=](Accel& a, ItemOrder&) {
      a.blocks = copy_blocks(a);
      edit(a.blocks[1], a);
    };
  };
  /// The first entry of the leaf table that `mark` changes.
  const auto in_table = [](auto mark) -> Change {
    return [=](Accel& a, ItemOrder&) {
      a.nodes = copy_nodes(a);
      for (std::size_t n = 0; n < a.stats.nodes; ++n)
        for (NodeRef& ref : a.nodes[n].child) {
          if (!ref.is_leaf() || ref.is_none() || ref.is_triangles()) continue;
          const NodeRef marked = mark(ref);
          if (marked.bits() == ref.bits()) continue;
          ref = marked;
          return;
        }
    };
  };
  const auto last_node = [](const Accel& a) { return static_cast<std::uint32_t>(a.stats.nodes); };
  const Change changes[] = {
      node(0, 0, [](const Accel&) { return NodeRef::node(0); }),
      node(3, 0, [](const Accel&) { return NodeRef::node(2); }),
      node(0, 0, [=](const Accel& a) { return NodeRef::node(last_node(a)); }),
      node(0, 1, [](const Accel& a) { return a.nodes[0].child[0]; }),
      node(0, 0, [](const Accel&) { return NodeRef::none(); }),
      node(0, 0, [](const Accel&) { return NodeRef::way_out(); }),
      node(2, 0,
           [](const Accel& a) { return NodeRef::triangles(static_cast<std::uint32_t>(block_count(a)), 3); }),
      node(2, 0,
           [](const Accel& a) {
             return NodeRef::leaf(static_cast<std::uint32_t>(a.leaves.size()), Kind::plane);
           }),
      in_table(
          [](NodeRef ref) { return ref.is_spheres() ? NodeRef::leaf(ref.table_index(), Kind::plane) : ref; }),
      in_table([](NodeRef ref) {
        return ref.is_spheres() ? ref : NodeRef::leaf(ref.table_index(), Kind::sphere);
      }),
      block([](TriangleBlock& b, const Accel& a) {
        b.first.item[0] = static_cast<std::uint32_t>(a.stats.items);
      }),
      block([](TriangleBlock& b, const Accel&) { b.first.item[0] = 0; }),
      block([](TriangleBlock& b, const Accel&) { b.first.item[0] = kNoId; }),
      [](Accel& a, ItemOrder&) { a.root = NodeRef::none(); },
      [](Accel& a, ItemOrder&) { a.root = NodeRef::node(1); },
      [](Accel& a, ItemOrder&) { a.bounds.lo.x = -std::numeric_limits<float>::infinity(); },
      [](Accel& a, ItemOrder&) { a.leaves[0].kind = static_cast<Kind>(kKinds); },
      [](Accel& a, ItemOrder&) { a.leaves[0].begin = 1u << 20; },
      [](Accel& a, ItemOrder&) { a.leaves[0].count = 0; },
      [](Accel& a, ItemOrder&) {
        for (LeafEntry& leaf : a.leaves)
          if (leaf.kind == Kind::triangle) leaf.count = 9;
      },
      [](Accel& a, ItemOrder& order) {
        ASSERT_GE(order[static_cast<int>(Kind::instance_list)].size(), 9u);
        for (LeafEntry& leaf : a.leaves)
          if (leaf.kind == Kind::instance_list) leaf.begin = 0, leaf.count = 9;
      },
      [](Accel& a, ItemOrder&) {
        for (LeafEntry& leaf : a.leaves)
          if (leaf.kind == Kind::triangle) leaf.test = static_cast<TriangleTest>(9);
      },
      [](Accel&, ItemOrder& order) { order[static_cast<int>(Kind::sphere)][0] = 5; },
      [](Accel&, ItemOrder& order) { order[static_cast<int>(Kind::sphere)].push_back(0); },
      [](Accel&, ItemOrder& order) { order[static_cast<int>(Kind::plane)].clear(); },
      [](Accel&, ItemOrder& order) {
        std::vector<std::uint32_t>& list = order[static_cast<int>(Kind::instance_list)];
        list[0] = list[1];
      }};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    store.counts = {}, told_.clear();
    store.change = changes[i];
    const auto accel = build_accel(mixed.geometries);
    EXPECT_EQ(store.counts.refusals, 1) << i;
    EXPECT_EQ(store.counts.keeps, 1) << i;
    expect_same_tree(*accel, *good);
  }
}

/// Compact trees whose blocks are no such blocks.
TEST_F(TreeCache, ImpossibleBlocksAreRefused) {
  const TriangleMesh ball = make_icosphere(5).mesh;
  const std::vector<Geometry> geometries = {{MeshGeometry{&ball}, {}, kNoId}};
  const BuildOptions compact{BuildQuality::compact};
  CountingStore store(*cache_);
  const auto good = build_accel(geometries, compact);
  std::size_t packed = 0, plain = 0;
  while (!good->blocks[packed].is_packed()) ++packed;
  while (good->blocks[plain].is_packed()) ++plain;
  const auto edit = [](std::size_t number, auto change) {
    return [=](Accel& a, ItemOrder&) {
      a.blocks = copy_blocks(a);
      change(a.blocks[number]);
      count_tree(a, a.stats.nodes, block_count(a));
    };
  };
  const std::function<void(Accel&, ItemOrder&)> changes[] = {
      edit(packed, [](TriangleBlock& b) { b.first.corners[0] &= 0xfff; }),
      edit(packed, [](TriangleBlock& b) { b.first.corners[7] &= 0xfff; }),
      edit(packed, [](TriangleBlock& b) { b.second.lists.corners[3] &= 0xfff; }),
      edit(packed, [](TriangleBlock& b) { b.second.lists.item[0] = 1u << 31; }),
      edit(packed, [](TriangleBlock& b) { b.second.lists.item[0] = kNoId; }),
      edit(plain, [](TriangleBlock& b) { b.first.corners[0] |= TriangleBlock::kPacked; }),
      edit(plain,
           [](TriangleBlock& b) {
             for (std::uint16_t& corners : b.first.corners) corners |= TriangleBlock::kPacked;
           }),
      // The second leaf of a plain block.
      [=](Accel& a, ItemOrder&) {
        a.nodes = copy_nodes(a);
        for (std::size_t n = 0; n < a.stats.nodes; ++n)
          for (NodeRef& ref : a.nodes[n].child)
            if (ref.is_triangles() && ref.triangle_leaf() == TriangleBlock::kLeaves * plain)
              ref = NodeRef::triangles(ref.triangle_leaf() + 1, ref.triangle_count());
      }};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    store.counts = {}, told_.clear();
    store.change = changes[i];
    const auto accel = build_accel(geometries, compact);
    EXPECT_EQ(store.counts.refusals, 1) << i;
    expect_same_tree(*accel, *good);
  }
}

TEST_F(TreeCache, DamagedTreesAreBuiltAgain) {
  const MixedGeometry mixed(1000, 3);
  const auto good = build_accel(mixed.geometries);
  const std::string path = entry();
  std::vector<char> bytes(fs::file_size(path));
  std::FILE* file = std::fopen(path.c_str(), "rb");
  ASSERT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
  std::fclose(file);
  CaseRandom r(1);
  for (int i = 0; i < 40; ++i) {
    std::vector<char> changed = bytes;
    std::size_t at = i < 20 ? static_cast<std::size_t>(i * 11) : r.bits() % bytes.size();
    while (at >= 500 && bytes[at] == 0) at = r.bits() % bytes.size();
    if (i % 10 == 9)
      changed.resize(at);
    else
      changed[at] = static_cast<char>(changed[at] ^ 1 << r.bits() % 8);
    // Trees that are in use stay mapped, so the file is replaced and not written over.
    fs::remove(path);
    file = std::fopen(path.c_str(), "wb");
    std::fwrite(changed.data(), 1, changed.size(), file);
    std::fclose(file);
    told_.clear();
    cache_.reset();
    cache_ = std::make_unique<SceneCache>(dir_.file("cache"), options_);
    expect_same_tree(*build_accel(mixed.geometries), *good);
    EXPECT_EQ(told_.size(), 1u) << at;
    EXPECT_EQ(fs::file_size(path), bytes.size()) << at;
  }
}

}  // namespace
}  // namespace oktett::tree_cache_test
