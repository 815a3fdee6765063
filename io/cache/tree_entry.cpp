#include "core/bytes.h"
#include "core/error.h"
#include "io/cache/entries.h"

namespace oktett {
namespace {

/// The number changes with the tree that is built, and with the layout of nodes and blocks.
constexpr std::string_view kTreeKind = "tree 3 " OKTETT_VERSION;

enum Section : std::size_t { kNodes, kBlocks, kLeaves, kItems };

}  // namespace

std::string tree_header(std::uint64_t key, const Accel& accel, const ItemOrder& order) {
  std::string bytes;
  append_text(bytes, kTreeKind);
  append_number(bytes, key);
  append_number(bytes, accel.root.bits());
  for (const Vec3f& corner : {accel.bounds.lo, accel.bounds.hi})
    for (int k = 0; k < 3; ++k) append_number(bytes, corner[k]);
  append_number(bytes, static_cast<std::uint8_t>(accel.pieces));
  for (const std::vector<std::uint32_t>& items : order) append_number(bytes, std::uint64_t{items.size()});
  return bytes;
}

std::vector<CacheSection> tree_sections(const Accel& accel, const ItemOrder& order,
                                        std::vector<std::uint32_t>& items) {
  items.clear();
  for (const std::vector<std::uint32_t>& list : order) items.insert(items.end(), list.begin(), list.end());
  return {{accel.nodes.data(), accel.stats.nodes * sizeof(BvhNode)},
          {accel.blocks.data(), block_count(accel) * sizeof(TriangleBlock)},
          {accel.leaves.data(), accel.leaves.size() * sizeof(LeafEntry)},
          {items.data(), items.size() * sizeof(std::uint32_t)}};
}

void read_tree(const CacheFile& file, std::uint64_t key, Accel& accel, ItemOrder& order) {
  Column<std::uint32_t> items;
  Column<LeafEntry> leaves;
  file.copy(kItems, items);
  file.copy(kLeaves, leaves);
  try {
    ByteReader reader(file.header());
    if (reader.text() != kTreeKind || reader.number<std::uint64_t>() != key)
      throw Error("is not of this version");
    accel.root = NodeRef::from_bits(reader.number<std::uint32_t>());
    for (Vec3f* corner : {&accel.bounds.lo, &accel.bounds.hi})
      for (int k = 0; k < 3; ++k) (*corner)[k] = reader.number<float>();
    accel.pieces = reader.number<std::uint8_t>() != 0;
    std::size_t first = 0;
    for (std::vector<std::uint32_t>& list : order) {
      const auto count = reader.number<std::uint64_t>();
      if (count > items.size() - first) throw Error("has too few items");
      list.assign(items.begin() + first, items.begin() + first + count);
      first += count;
    }
  } catch (const Error& error) {
    file.fail(error.what());
  }
  accel.leaves.assign(leaves.begin(), leaves.end());
  accel.nodes = file.map<BvhNode>(kNodes);
  accel.blocks = file.map<TriangleBlock>(kBlocks);
  count_tree(accel, file.count<BvhNode>(kNodes), file.count<TriangleBlock>(kBlocks));
}

}  // namespace oktett
