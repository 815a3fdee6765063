#pragma once
/// \file What stands in the files of the cache. Within io/ only.

#include <cstdint>
#include <string>

#include "accel/build/tree_store.h"
#include "io/cache/cache_file.h"
#include "io/mesh/reading.h"

namespace oktett {

/// What tells versions of a file apart without reading it.
struct FileStamp {
  std::uint64_t size = 0, inode = 0;
  std::int64_t content_time = 0, status_time = 0;  ///< of the last change, in nanoseconds since 1970
  bool operator==(const FileStamp&) const = default;
};

/// A mesh and the file that it was read from.
struct MeshEntry {
  std::string path;  ///< canonical
  FileStamp stamp;
  std::uint64_t checksum = 0;  ///< of the content of the file, as in core/bytes.h
  ParsedMesh parsed;
};

/// The header of an entry and its sections; the columns belong to `entry`.
std::string mesh_header(const MeshEntry& entry);
std::vector<CacheSection> mesh_sections(const MeshEntry& entry);
/// All but the columns of the mesh. Throws Error for a file that cannot be an entry.
MeshEntry read_mesh_header(const CacheFile& file);
/// Reads the columns. Throws Error if they do not go together.
void read_mesh_columns(const CacheFile& file, MeshEntry& entry);

/// The same for trees. `items` is filled by the function and must live as long as its result.
std::string tree_header(std::uint64_t key, const Accel& accel, const ItemOrder& order);
std::vector<CacheSection> tree_sections(const Accel& accel, const ItemOrder& order,
                                        std::vector<std::uint32_t>& items);
/// Sets what TreeStore::load sets. Throws Error for a file that cannot be an entry of that key.
void read_tree(const CacheFile& file, std::uint64_t key, Accel& accel, ItemOrder& order);

}  // namespace oktett
