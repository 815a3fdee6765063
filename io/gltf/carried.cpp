#include "io/gltf/carried.h"

#include <algorithm>
#include <map>
#include <set>

namespace oktett {
namespace {

/// What tells values apart that share vertices.
std::pair<std::uint32_t, bool> source_of(const GltfCarriedValues& values) {
  return {values.accessor, values.is_color};
}

}  // namespace

std::string why_not_carried(const GltfCarriedValues& values, std::uint64_t vertices) {
  const GltfElements& e = values.elements;
  if (values.is_color) {
    const bool is_part = e.number == GltfNumber::uint8 || e.number == GltfNumber::uint16;
    const bool good = (e.components == 3 || e.components == 4) && e.count == vertices &&
                      (is_part || e.number == GltfNumber::float32);
    return good ? "" : "expected three or four floats or parts of 8 or 16 bits for each vertex";
  }
  return e.components <= 4 && e.count == vertices ? "" : "expected up to four numbers for each vertex";
}

GltfCarriedJoin::GltfCarriedJoin(std::vector<const GltfCarrier*> carriers) : carriers_(std::move(carriers)) {
  std::map<std::string, std::size_t> known;
  for (const GltfCarrier* carrier : carriers_)
    for (const GltfCarriedValues& values : carrier->values) {
      const auto [found, is_new] = known.try_emplace(values.name, attributes_.size());
      if (is_new) attributes_.emplace_back().name = values.name;
      Attribute& a = attributes_[found->second];
      a.components = std::max(a.components, values.elements.components);
      a.is_color = a.is_color || values.is_color;
      a.uses.emplace_back(carrier, &values);
    }
  for (Attribute& a : attributes_) {
    a.domain = domain_of(a);
    std::ranges::stable_sort(a.uses, {}, [](const Use& use) { return source_of(*use.second); });
  }
}

AttributeDomain GltfCarriedJoin::domain_of(const Attribute& a) const {
  std::map<std::uint32_t, std::size_t> sharing, carrying;
  for (const GltfCarrier* carrier : carriers_) ++sharing[carrier->positions];
  std::map<std::uint32_t, std::pair<std::uint32_t, bool>> sources;
  for (const auto& [carrier, values] : a.uses) {
    if (carrier->positions == kNoId) continue;
    ++carrying[carrier->positions];
    const auto [found, is_new] = sources.try_emplace(carrier->positions, source_of(*values));
    if (!is_new && found->second != source_of(*values)) return AttributeDomain::corner;
  }
  for (const auto& [positions, count] : carrying)
    if (count != sharing[positions]) return AttributeDomain::corner;
  return AttributeDomain::vertex;
}

std::uint64_t GltfCarriedJoin::bytes() const {
  std::uint64_t vertices = 0, corners = 0, most_read = 0, floats = 0;
  std::set<std::uint32_t> known;
  for (const GltfCarrier* carrier : carriers_) {
    corners += carrier->corners;
    if (carrier->positions == kNoId || known.insert(carrier->positions).second) vertices += carrier->vertices;
    for (const GltfCarriedValues& values : carrier->values)
      most_read = std::max(most_read, values.elements.count * values.elements.components);
  }
  for (const Attribute& a : attributes_)
    floats += a.components * (a.domain == AttributeDomain::vertex ? vertices : corners);
  return sizeof(float) * (floats + most_read);
}

void GltfCarriedJoin::fill(const GltfFile& file, TriangleMesh& mesh) const {
  for (const Attribute& a : attributes_) {
    MeshAttribute& out = mesh.attributes.emplace_back();
    out.name = a.name, out.components = a.components, out.domain = a.domain;
    out.floats = Column<float>(domain_size(mesh, a.domain) * a.components, a.is_color ? 1.0f : 0.0f);
    Column<float> numbers;
    std::set<std::uint64_t> done;
    for (std::size_t i = 0; i < a.uses.size(); ++i) {
      const GltfCarriedValues& values = *a.uses[i].second;
      const bool is_read =
          i > 0 && values.accessor != kNoId && source_of(*a.uses[i - 1].second) == source_of(values);
      if (!is_read) {
        numbers.resize_uninitialized(values.elements.count * values.elements.components);
        read_gltf_values(file, values.elements, values.is_color, numbers.data());
      }
      const bool by_corner = a.domain == AttributeDomain::corner;
      if (by_corner || done.insert(a.uses[i].first->base).second)
        copy(a, a.uses[i], numbers, mesh, out.floats);
    }
  }
}

void GltfCarriedJoin::copy(const Attribute& a, const Use& use, const Column<float>& numbers,
                           const TriangleMesh& mesh, Column<float>& to) {
  const auto& [carrier, values] = use;
  const std::uint64_t size = values->elements.components;
  const auto put = [&](std::uint64_t from, std::uint64_t index) {
    std::copy_n(numbers.data() + from * size, size, to.data() + index * a.components);
  };
  if (a.domain == AttributeDomain::vertex)
    for (std::uint64_t i = 0; i < values->elements.count; ++i) put(i, carrier->base + i);
  else
    for (std::uint64_t i = carrier->first_corner; i < carrier->first_corner + carrier->corners; ++i)
      put(mesh.indices[i] - carrier->base, i);
}

}  // namespace oktett
