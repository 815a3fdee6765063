#include "core/mesh_attributes.h"

#include "core/math.h"
#include "core/mesh.h"

namespace oktett {
namespace {

std::array<float, 256> make_srgb_bytes() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = linear_of_srgb(static_cast<double>(i) / 255);
  return table;
}

/// Each value once for corner k, so that faces and corners take the same way as vertices.
std::size_t value_index(const MeshAttribute& attribute, const TriangleMesh& mesh, std::size_t triangle,
                        std::size_t k) {
  switch (attribute.domain) {
    case AttributeDomain::vertex:
      return mesh.indices[3 * triangle + k];
    case AttributeDomain::face:
      return triangle;
    case AttributeDomain::corner:
      break;
  }
  return 3 * triangle + k;
}

}  // namespace

float linear_of_srgb(double part) {
  return static_cast<float>(part <= 0.04045 ? part / 12.92 : portable::pow((part + 0.055) / 1.055, 2.4));
}

float linear_of_srgb_byte(std::uint8_t byte) {
  static const std::array<float, 256> table = make_srgb_bytes();
  return table[byte];
}

float MeshAttribute::value(std::size_t i, std::uint32_t k) const {
  const std::size_t at = i * components + k;
  if (!floats.empty()) return floats[at];
  return k < 3 ? linear_of_srgb_byte(srgb[at]) : static_cast<float>(srgb[at]) / 255;
}

std::size_t domain_size(const TriangleMesh& mesh, AttributeDomain domain) {
  switch (domain) {
    case AttributeDomain::vertex:
      return mesh.positions.size();
    case AttributeDomain::face:
      return mesh.triangle_count();
    case AttributeDomain::corner:
      break;
  }
  return mesh.indices.size();
}

float corner_value(const TriangleMesh& mesh, const MeshAttribute& attribute, std::size_t triangle,
                   std::size_t corner, std::uint32_t component) {
  return attribute.value(value_index(attribute, mesh, triangle, corner), component);
}

const MeshAttribute* find_attribute(const TriangleMesh& mesh, std::string_view name) {
  for (const MeshAttribute& attribute : mesh.attributes)
    if (attribute.name == name) return &attribute;
  return nullptr;
}

AttributeValue attribute_at(const MeshPoint& point, const MeshAttribute& attribute) {
  const TriangleMesh& mesh = *point.mesh;
  AttributeValue result{0, 0, 0, 1};
  const double u = point.u, v = point.v, w = 1 - u - v;
  for (std::uint32_t k = 0; k < attribute.components; ++k) {
    const auto at = [&](std::size_t corner) -> double {
      return corner_value(mesh, attribute, point.triangle, corner, k);
    };
    // One value for all three corners is itself, also where it is not finite.
    result[k] = attribute.domain == AttributeDomain::face
                    ? static_cast<float>(at(0))
                    : static_cast<float>(at(0) * w + at(1) * u + at(2) * v);
  }
  if (attribute.components == 1) result[1] = result[2] = result[0];
  return result;
}

}  // namespace oktett
