#include "io/pov/translate/height_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/error.h"
#include "io/image/library.h"
#include "io/pov/evaluate.h"
#include "io/pov/read_pov.h"

namespace oktett::pov {
namespace {

/// Most places of a mesh.
constexpr std::size_t kMostPlaces = std::size_t{2048} * 2048;

/// Where the heights stand.
struct Field {
  const Heights& heights;
  std::uint32_t columns = heights.columns, rows = heights.rows;

  Vec3d place(std::uint32_t column, std::uint32_t row) const {
    return {column / (columns - 1.0), heights.y[std::size_t{row} * columns + column], row / (rows - 1.0)};
  }
  /// From the heights to both sides.
  Vec3d normal(std::uint32_t column, std::uint32_t row) const {
    const std::uint32_t left = column > 0 ? column - 1 : 0, right = std::min(column + 1, columns - 1);
    const std::uint32_t front = row > 0 ? row - 1 : 0, back = std::min(row + 1, rows - 1);
    const Vec3d along_x = place(right, row) - place(left, row),
                along_z = place(column, back) - place(column, front);
    return normalize(cross(along_z, along_x));
  }
};

double grey_of(double red, double green, double blue) { return 0.297 * red + 0.589 * green + 0.114 * blue; }

/// The value at a place, as an image of 16 bits has it.
std::optional<double> height_at(Context& context, const Function& function, double x, double y,
                                std::uint64_t most_steps) {
  const FunctionNode& last = function.nodes.back();
  double value = 0;
  if (function.components == 5 && last.block != nullptr && last.block->keyword == "pigment") {
    const auto color = context.queries->pigment(last.block, {x, y, 0});
    if (!color) return std::nullopt;
    value = grey_of((*color)[0], (*color)[1], (*color)[2]);
  } else {
    const double place[] = {x, y, 0};
    value = evaluate(function, std::span(place).first(std::min<std::size_t>(3, function.parameters.size())),
                     context.queries, most_steps);
  }
  if (!std::isfinite(value)) return std::nullopt;
  return std::round(std::clamp(value, 0.0, 1.0) * 65535) / 65535;
}

void add_face(MeshMaker& mesh, const MeshCorner& a, const MeshCorner& b, const MeshCorner& c) {
  mesh.add({a, b, c});
}

/// Sides down to y = `bottom` along an edge of the field, whose corners are given in order, seen from above
/// with the inside to the left.
void add_sides(MeshMaker& mesh, const std::vector<Vec3d>& edge, double bottom) {
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const Vec3d &a = edge[i], &b = edge[i + 1];
    const MeshCorner below_a{{a.x, bottom, a.z}}, below_b{{b.x, bottom, b.z}};
    add_face(mesh, {a}, {b}, below_b), add_face(mesh, {a}, below_b, below_a);
  }
}

void close(MeshMaker& mesh, const Field& h) {
  constexpr double kBottom = -1e-4;
  std::vector<Vec3d> edge;
  for (std::uint32_t i = 0; i < h.columns; ++i) edge.push_back(h.place(i, 0));
  for (std::uint32_t i = 1; i < h.rows; ++i) edge.push_back(h.place(h.columns - 1, i));
  for (std::uint32_t i = h.columns - 1; i-- > 0;) edge.push_back(h.place(i, h.rows - 1));
  for (std::uint32_t i = h.rows - 1; i-- > 0;) edge.push_back(h.place(0, i));
  add_sides(mesh, edge, kBottom);
  // The bottom meets the sides in all their corners.
  const MeshCorner middle{{0.5, kBottom, 0.5}};
  for (std::size_t i = 0; i + 1 < edge.size(); ++i)
    add_face(mesh, middle, {{edge[i].x, kBottom, edge[i].z}}, {{edge[i + 1].x, kBottom, edge[i + 1].z}});
}

/// Adds the part of a triangle that is not below the water.
void add_above(MeshMaker& mesh, const std::array<MeshCorner, 3>& triangle, double water) {
  std::vector<MeshCorner> left;
  for (std::size_t i = 0; i < 3; ++i) {
    const MeshCorner &a = triangle[i], &b = triangle[(i + 1) % 3];
    const double above_a = a.position.y - water, above_b = b.position.y - water;
    if (above_a >= 0) left.push_back(a);
    if ((above_a >= 0) == (above_b >= 0)) continue;
    const double part = above_a / (above_a - above_b);
    MeshCorner shore{a.position + (b.position - a.position) * part};
    if (a.normal && b.normal) shore.normal = *a.normal + (*b.normal - *a.normal) * part;
    left.push_back(shore);
  }
  for (std::size_t i = 2; i < left.size(); ++i) mesh.add({left[0], left[i - 1], left[i]});
}

/// All triangles, two to a cell.
std::shared_ptr<const TriangleMesh> whole_field(const Field& h, bool smooth) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t row = 0; row < h.rows; ++row)
    for (std::uint32_t column = 0; column < h.columns; ++column) {
      mesh->positions.push_back(Vec3f(h.place(column, row)));
      if (smooth) mesh->normals.push_back(Vec3f(h.normal(column, row)));
      if (column + 1 == h.columns || row + 1 == h.rows) continue;
      const std::uint32_t a = row * h.columns + column, b = a + 1, d = a + h.columns, c = d + 1;
      for (const std::uint32_t corner : {a, d, b, b, d, c}) mesh->indices.push_back(corner);
    }
  if (smooth) mesh->normal_indices = mesh->indices;
  return mesh;
}

}  // namespace

std::optional<Heights> heights_of_function(Context& context, const Function& function, std::uint32_t columns,
                                           std::uint32_t rows) {
  if (context.queries == nullptr || function.nodes.empty()) return std::nullopt;
  Heights h{columns, rows, {}};
  h.y.reserve(std::size_t{columns} * rows);
  // A function that takes more in all is none here.
  constexpr std::uint64_t kMostSteps = std::uint64_t{1} << 30;
  const std::uint64_t most_steps = kMostSteps / (std::uint64_t{columns} * rows);
  try {
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column) {
        // The upper edge of the picture, where y is 0, lies at z = 1.
        const auto y =
            height_at(context, function, column / (columns - 1.0), 1 - row / (rows - 1.0), most_steps);
        if (!y) return std::nullopt;
        h.y.push_back(*y);
      }
  } catch (const Error&) {
    return std::nullopt;
  }
  return h;
}

std::optional<Heights> heights_of_colors(const std::string& file) {
  const TexelImage image = image_library().read_texels({file, {}, TextureColors::linear});
  if (image.colors != 3 || image.width < 2 || image.height < 2 ||
      std::size_t{image.width} * image.height > kMostPlaces)
    return std::nullopt;
  Heights h{image.width, image.height, {}};
  h.y.reserve(std::size_t{h.columns} * h.rows);
  for (std::uint32_t row = h.rows; row-- > 0;)
    for (std::uint32_t column = 0; column < h.columns; ++column) {
      const std::size_t at = (std::size_t{row} * h.columns + column) * image.channels();
      const auto& floats = image.floats;
      const double word = image.bytes.empty() ? 65535 * grey_of(floats[at], floats[at + 1], floats[at + 2])
                                              : 256.0 * image.bytes[at] + image.bytes[at + 1];
      h.y.push_back(std::clamp(std::floor(word), 0.0, 65535.0) / 65535);
    }
  return h;
}

std::shared_ptr<const TriangleMesh> height_mesh(const Heights& heights, const HeightForm& form) {
  const Field h{heights};
  const auto [columns, rows] = std::pair(h.columns, h.rows);
  const auto [smooth, solid, water] = form;
  if (!solid && !(water > 0)) return whole_field(h, smooth);
  const auto corner = [&, normals = smooth](std::uint32_t column, std::uint32_t row) {
    MeshCorner c{h.place(column, row)};
    if (normals) c.normal = h.normal(column, row);
    return c;
  };
  MeshMaker mesh;
  for (std::uint32_t row = 0; row + 1 < rows; ++row)
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const MeshCorner a = corner(column, row), b = corner(column + 1, row), c = corner(column + 1, row + 1),
                       d = corner(column, row + 1);
      for (const std::array<MeshCorner, 3>& triangle : {std::array{a, d, b}, std::array{b, d, c}}) {
        if (solid || !(water > 0))
          mesh.add(triangle);
        else
          add_above(mesh, triangle, water);
      }
    }
  if (solid) close(mesh, h);
  return mesh.finish();
}

}  // namespace oktett::pov
