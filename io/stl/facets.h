#pragma once
/// \file Facets of STL files in text.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/vec3.h"
#include "io/mesh/failure.h"

namespace oktett {

/// A run of whole lines. All but the first of a file begin with a line `facet`.
struct StlChunk {
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t triangles = 0;         ///< counted by the first pass
  std::uint64_t before = 0;            ///< triangles in all chunks before it
  std::optional<MeshFailure> failure;  ///< the first one
};

/// Whether the line at `p` begins with `word`, in upper or lower case.
bool begins_with_word(const char* p, std::string_view word);

/// Cuts `text` into chunks of about `chunk_bytes` each and counts their triangles.
std::vector<StlChunk> cut_into_facets(std::string_view text, std::size_t chunk_bytes);

/// Reads chunk `index` to `positions`, which holds three for each triangle of the file. Stops at the first
/// failure in the chunk.
void read_facets(std::vector<StlChunk>& chunks, std::size_t index, Vec3f* positions);

}  // namespace oktett
