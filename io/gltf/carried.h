#pragma once
/// \file What the vertices of a glTF mesh carry: COLOR_n and _NAME. Within io/gltf/ only.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "io/gltf/accessor.h"

namespace oktett {

/// The values of an attribute for the vertices of a primitive.
struct GltfCarriedValues {
  std::string name;
  bool is_color = false;
  std::uint32_t accessor = kNoId;  ///< kNoId: of this primitive alone
  GltfElements elements{};         ///< of 1 to 4 numbers, 3 or 4 for a colour
};

/// Why these values of so many vertices are not read; empty: they are.
std::string why_not_carried(const GltfCarriedValues& values, std::uint64_t vertices);

/// A primitive, its place in the mesh, and what it carries.
struct GltfCarrier {
  std::vector<GltfCarriedValues> values;  ///< of different names
  std::uint32_t positions = kNoId;        ///< their accessor; kNoId: of this primitive alone
  std::uint64_t vertices = 0;             ///< at most
  std::uint64_t base = 0;                 ///< of its vertices in the mesh
  std::uint64_t first_corner = 0, corners = 0;
};

/// Makes what primitives carry attributes of their mesh: of vertices, or of corners where primitives share
/// vertices but not values. Primitives without an attribute that others have are white, or zero.
class GltfCarriedJoin {
 public:
  /// Places need not be known yet. The carriers must outlive the join.
  explicit GltfCarriedJoin(std::vector<const GltfCarrier*> carriers);

  /// The most memory that they will take.
  std::uint64_t bytes() const;
  /// Adds the attributes to the mesh, whose positions and indices are there. Throws Error.
  void fill(const GltfFile& file, TriangleMesh& mesh) const;

 private:
  using Use = std::pair<const GltfCarrier*, const GltfCarriedValues*>;
  struct Attribute {
    std::string name;
    std::uint32_t components = 1;
    bool is_color = false;
    AttributeDomain domain = AttributeDomain::vertex;
    std::vector<Use> uses;  ///< those of one accessor follow each other
  };

  AttributeDomain domain_of(const Attribute& attribute) const;
  static void copy(const Attribute& from, const Use& use, const Column<float>& numbers,
                   const TriangleMesh& mesh, Column<float>& to);

  std::vector<const GltfCarrier*> carriers_;
  std::vector<Attribute> attributes_;
};

}  // namespace oktett
