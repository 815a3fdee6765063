#include "io/cache/entries.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "core/bytes.h"
#include "core/error.h"

namespace oktett {

namespace {

/// The number changes with what parse_mesh makes of a file.
constexpr std::string_view kMeshKind = "mesh 3 " OKTETT_VERSION;

void append(std::string& bytes, const std::vector<MeshStatement>& statements) {
  append_number(bytes, static_cast<std::uint32_t>(statements.size()));
  for (const MeshStatement& s : statements) {
    append_number(bytes, s.at);
    append_text(bytes, s.words);
    append_number(bytes, std::int32_t{s.position.line});
    append_number(bytes, std::int32_t{s.position.column});
  }
}

std::vector<MeshStatement> take_statements(ByteReader& reader) {
  std::vector<MeshStatement> statements;
  for (std::uint32_t left = reader.count(20); left > 0; --left) {
    MeshStatement s;
    s.at = reader.number<std::uint64_t>();
    s.words = reader.text();
    s.position.line = reader.number<std::int32_t>();
    s.position.column = reader.number<std::int32_t>();
    statements.push_back(std::move(s));
  }
  return statements;
}

/// All but the values.
void append(std::string& bytes, const std::vector<MeshAttribute>& attributes) {
  append_number(bytes, static_cast<std::uint32_t>(attributes.size()));
  for (const MeshAttribute& a : attributes) {
    append_text(bytes, a.name);
    append_number(bytes, static_cast<std::uint8_t>(a.domain));
    append_number(bytes, static_cast<std::uint8_t>(a.components));
  }
}

std::vector<MeshAttribute> take_attributes(ByteReader& reader) {
  std::vector<MeshAttribute> attributes;
  for (std::uint32_t left = reader.count(6); left > 0; --left) {
    MeshAttribute a;
    a.name = reader.text();
    const auto domain = reader.number<std::uint8_t>();
    a.components = reader.number<std::uint8_t>();
    if (domain > 2 || a.components < 1 || a.components > 4) throw Error("has an impossible attribute");
    a.domain = static_cast<AttributeDomain>(domain);
    attributes.push_back(std::move(a));
  }
  return attributes;
}

/// Whether there is one value for each vertex, triangle or corner, in one of the two columns.
bool are_attributes(const TriangleMesh& mesh) {
  for (const MeshAttribute& a : mesh.attributes) {
    const std::size_t size = domain_size(mesh, a.domain) * a.components;
    if (a.floats.size() + a.srgb.size() != size || (!a.floats.empty() && !a.srgb.empty())) return false;
  }
  return true;
}

/// Whether `good` holds for all elements.
template <class T, class Good>
bool all_of(const Column<T>& column, const Good& good) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, column.size(), std::size_t{1} << 16), true,
      [&](const Range& range, bool all) {
        // Without an early end, so that it goes in lanes.
        for (std::size_t i = range.begin(); i < range.end(); ++i) all &= good(column[i]);
        return all;
      },
      [](bool a, bool b) { return a && b; });
}

/// One index per corner, or none at all; below `count`, or kNoId.
bool are_indices(const Column<std::uint32_t>& indices, std::size_t corners, std::size_t count) {
  if (indices.empty()) return true;
  return indices.size() == corners &&
         all_of(indices, [count](std::uint32_t index) { return index < count || index == kNoId; });
}

}  // namespace

std::string mesh_header(const MeshEntry& entry) {
  std::string bytes;
  append_text(bytes, kMeshKind);
  append_text(bytes, entry.path);
  for (const std::uint64_t n : {entry.stamp.size, entry.stamp.inode}) append_number(bytes, n);
  for (const std::int64_t n : {entry.stamp.content_time, entry.stamp.status_time}) append_number(bytes, n);
  append_number(bytes, entry.checksum);
  append_number(bytes, static_cast<std::uint8_t>(entry.parsed.has_faces));
  for (int k = 0; k < 3; ++k) append_number(bytes, entry.parsed.mesh.origin[k]);
  append(bytes, entry.parsed.libraries);
  append(bytes, entry.parsed.materials);
  append(bytes, entry.parsed.textures);
  append(bytes, entry.parsed.notices);
  append(bytes, entry.parsed.mesh.attributes);
  return bytes;
}

std::vector<CacheSection> mesh_sections(const MeshEntry& entry) {
  const TriangleMesh& mesh = entry.parsed.mesh;
  std::vector<CacheSection> sections{section_of(mesh.positions),
                                     section_of(mesh.normals),
                                     section_of(mesh.uvs),
                                     section_of(mesh.indices),
                                     section_of(mesh.normal_indices),
                                     section_of(mesh.uv_indices),
                                     section_of(mesh.material_slots),
                                     section_of(entry.parsed.strokes),
                                     section_of(entry.parsed.stroke_slots)};
  for (const MeshAttribute& a : mesh.attributes)
    sections.push_back(section_of(a.floats)), sections.push_back(section_of(a.srgb));
  return sections;
}

MeshEntry read_mesh_header(const CacheFile& file) {
  MeshEntry entry;
  try {
    ByteReader reader(file.header());
    if (reader.text() != kMeshKind) throw Error("is not of this version");
    entry.path = reader.text();
    for (std::uint64_t* n : {&entry.stamp.size, &entry.stamp.inode}) *n = reader.number<std::uint64_t>();
    for (std::int64_t* n : {&entry.stamp.content_time, &entry.stamp.status_time})
      *n = reader.number<std::int64_t>();
    entry.checksum = reader.number<std::uint64_t>();
    entry.parsed.has_faces = reader.number<std::uint8_t>() != 0;
    for (int k = 0; k < 3; ++k) entry.parsed.mesh.origin[k] = reader.number<double>();
    if (!is_finite(entry.parsed.mesh.origin)) throw Error("has a place that is not finite");
    for (auto* list :
         {&entry.parsed.libraries, &entry.parsed.materials, &entry.parsed.textures, &entry.parsed.notices})
      *list = take_statements(reader);
    entry.parsed.mesh.attributes = take_attributes(reader);
  } catch (const Error& error) {
    file.fail(error.what());
  }
  return entry;
}

void read_mesh_columns(const CacheFile& file, MeshEntry& entry) {
  TriangleMesh& mesh = entry.parsed.mesh;
  file.copy(0, mesh.positions), file.copy(1, mesh.normals), file.copy(2, mesh.uvs);
  file.copy(3, mesh.indices), file.copy(4, mesh.normal_indices), file.copy(5, mesh.uv_indices);
  file.copy(6, mesh.material_slots);
  Column<std::uint32_t>& strokes = entry.parsed.strokes;
  Column<std::uint16_t>& stroke_slots = entry.parsed.stroke_slots;
  file.copy(7, strokes), file.copy(8, stroke_slots);
  std::size_t section = 9;
  for (MeshAttribute& a : mesh.attributes) file.copy(section++, a.floats), file.copy(section++, a.srgb);
  const std::size_t corners = mesh.indices.size(), positions = mesh.positions.size();
  // Of images there is one slot more, for faces without; one alone needs no numbers.
  const std::size_t images = entry.parsed.textures.size();
  const std::size_t slots = images > 0 ? images + 1 : entry.parsed.materials.size();
  const bool good =
      corners % 3 == 0 && all_of(mesh.indices, [=](std::uint32_t index) { return index < positions; }) &&
      are_indices(mesh.normal_indices, corners, mesh.normals.size()) &&
      are_indices(mesh.uv_indices, corners, mesh.uvs.size()) &&
      (mesh.material_slots.size() == (slots > 0 ? corners / 3 : 0) ||
       (images > 0 && mesh.material_slots.empty())) &&
      strokes.size() % 2 == 0 && all_of(strokes, [=](std::uint32_t index) { return index < positions; }) &&
      stroke_slots.size() == (entry.parsed.materials.empty() ? 0 : strokes.size() / 2) &&
      all_of(stroke_slots, [=](std::uint16_t slot) { return slot < slots; }) && are_attributes(mesh) &&
      all_of(mesh.material_slots, [=](std::uint16_t slot) { return slot < slots; });
  if (!good) file.fail("has indices that lead nowhere");
}

namespace {

/// The number changes with the tree that is built, and with the layout of nodes and blocks.
constexpr std::string_view kTreeKind = "tree 4 " OKTETT_VERSION;

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
