#include "io/mesh/strokes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/mesh_geometry.h"
#include "core/parallel.h"
#include "io/mesh/mesh_output.h"

namespace oktett {
namespace {

/// Elements of `components` numbers each, those with the numbers `used`.
template <class T>
Column<T> picked(const Column<T>& from, const Column<std::uint32_t>& used, std::size_t components) {
  Column<T> to;
  if (from.empty()) return to;
  to.resize_uninitialized(used.size() * components);
  for_all(used.size(), [&](std::size_t i) {
    std::copy_n(from.data() + used[i] * components, components, to.data() + i * components);
  });
  return to;
}

MeshAttribute picked(const MeshAttribute& a, const Column<std::uint32_t>& used) {
  MeshAttribute own;
  own.name = a.name, own.domain = a.domain, own.components = a.components;
  own.floats = picked(a.floats, used, a.components), own.srgb = picked(a.srgb, used, a.components);
  return own;
}

/// The vertices of `mesh` that are used, in their order, with what they carry. `number` has kNoId for each
/// vertex, before and after.
TriangleMesh with_used_vertices(const TriangleMesh& mesh, Column<std::uint32_t> indices,
                                Column<std::uint32_t>& number) {
  TriangleMesh out;
  out.origin = mesh.origin;
  Column<std::uint32_t> used;
  for (const std::uint32_t vertex : indices)
    if (number[vertex] == kNoId) number[vertex] = 0, used.push_back(vertex);
  if (!std::ranges::is_sorted(used)) std::ranges::sort(used);
  for (std::uint32_t i = 0; i < used.size(); ++i) number[used[i]] = i;
  out.positions = picked(mesh.positions, used, 1);
  for (const MeshAttribute& a : mesh.attributes)
    if (a.domain == AttributeDomain::vertex) out.attributes.push_back(picked(a, used));
  out.indices = std::move(indices);
  for_all(out.indices.size(), [&](std::size_t i) { out.indices[i] = number[out.indices[i]]; });
  for (const std::uint32_t vertex : used) number[vertex] = kNoId;
  return out;
}

}  // namespace

TriangleMesh make_strokes(const TriangleMesh& mesh, const Column<std::uint32_t>& ends,
                          Column<std::uint16_t> slots) {
  Column<std::uint32_t> indices(ends.size() / 2 * 3);
  for_all(ends.size() / 2, [&](std::size_t i) {
    indices[3 * i] = ends[2 * i];
    indices[3 * i + 1] = indices[3 * i + 2] = ends[2 * i + 1];
  });
  Column<std::uint32_t> number(mesh.positions.size(), kNoId);
  TriangleMesh strokes = with_used_vertices(mesh, std::move(indices), number);
  strokes.material_slots = std::move(slots);
  return strokes;
}

std::vector<StrokeSlot> split_by_slot(TriangleMesh strokes) {
  std::vector<StrokeSlot> parts;
  const auto has_first_slot = [&](std::uint16_t slot) { return slot == strokes.material_slots[0]; };
  if (std::ranges::all_of(strokes.material_slots, has_first_slot)) {
    const std::uint16_t slot = strokes.material_slots.empty() ? std::uint16_t{0} : strokes.material_slots[0];
    strokes.material_slots.clear();
    if (strokes.triangle_count() > 0) parts.push_back({std::move(strokes), slot});
    return parts;
  }
  std::map<std::uint16_t, std::size_t> part_of;
  std::vector<Column<std::uint32_t>> indices, numbers;
  for (std::uint32_t i = 0; i < strokes.triangle_count(); ++i) {
    const std::uint16_t slot = strokes.material_slots[i];
    const auto [found, is_new] = part_of.try_emplace(slot, parts.size());
    if (is_new) parts.push_back({{}, slot}), indices.emplace_back(), numbers.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      indices[found->second].push_back(strokes.indices[3 * std::size_t{i} + k]);
      numbers[found->second].push_back(3 * i + static_cast<std::uint32_t>(k));
    }
  }
  Column<std::uint32_t> number(strokes.positions.size(), kNoId);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    TriangleMesh& own = parts[part].strokes;
    own = with_used_vertices(strokes, std::move(indices[part]), number);
    for (const MeshAttribute& a : strokes.attributes)
      if (a.domain == AttributeDomain::corner) own.attributes.push_back(picked(a, numbers[part]));
  }
  return parts;
}

double usual_stroke_width(const Box& box, std::size_t strokes) {
  const double diagonal = box.empty() ? 0 : length(Vec3d(box.extent()));
  return diagonal > 0 ? diagonal / std::max(200.0, std::sqrt(static_cast<double>(strokes))) : 1;
}

void StrokeCount::add(const TriangleMesh& strokes) {
  for (std::size_t i = 0; i < strokes.indices.size(); i += 3)
    ++(strokes.indices[i] == strokes.indices[i + 1] ? points : lines);
}

std::string StrokeCount::text() const {
  if (lines == 0) return count_of(points, "point");
  return (points > 0 ? count_of(points, "point") + " and " : "") + count_of(lines, "line");
}

std::string StrokeCount::width_message(double width) const {
  return fmt::format(
      "{}: shown {:.3g} wide; --stroke-width, or stroke_width of a mesh in a scene, says otherwise", text(),
      width);
}

}  // namespace oktett
