#pragma once
/// \file The header of a PLY file: which elements follow it, and how they are laid out. The format is that of
/// the scans of Stanford's repository.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "io/mesh/failure.h"

namespace oktett {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_whole(PlyType type) { return type < PlyType::float32; }

enum class PlyFormat { ascii, little_endian, big_endian };

/// A value of each record, or a list of values with its length before it.
struct PlyProperty {
  std::string_view name;
  const char* where = nullptr;  ///< the line of the header
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType length_type = PlyType::uint8;  ///< of a list
};

struct PlyElement {
  std::string_view name;
  const char* where = nullptr;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  static constexpr int kNone = -1;
  /// The index of the first of these properties that there is, or kNone.
  int find(std::initializer_list<std::string_view> names) const;
  bool has_lists() const;
  /// The fewest bytes of a record in a binary file: lists are empty. That is the size if there are no lists.
  std::size_t least_bytes() const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  const char* body = nullptr;  ///< behind the header

  const PlyElement* find(std::string_view name) const;
};

/// Reads the header of a file. Throws MeshFailure.
PlyHeader read_ply_header(std::string_view text);

}  // namespace oktett
