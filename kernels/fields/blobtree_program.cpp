#include "kernels/fields/blobtree.h"

#include <algorithm>
#include <cmath>

namespace oktett::field {

std::vector<std::uint32_t> program(const BlobTreeShape& shape) {
  struct Entry {
    std::vector<std::uint32_t> code;
    int height;
  };
  std::vector<Entry> stack;
  for (const Blend& blend : shape.blends) {
    if (blend.op == Blend::Op::element) {
      if (blend.element >= shape.elements.size()) return {};
      stack.push_back({{BlobCode::make(BlobCode::element, blend.element)}, 1});
      continue;
    }
    if (blend.count == 0 || blend.count > stack.size()) return {};
    const auto op = blend.op == Blend::Op::sum   ? BlobCode::sum
                    : blend.op == Blend::Op::max ? BlobCode::max
                    : blend.op == Blend::Op::min ? BlobCode::min
                                                 : BlobCode::difference;
    const std::size_t first = stack.size() - blend.count;
    for (std::size_t k = first + 1; k < stack.size(); ++k) {
      Entry& all = stack[first];
      all.code.insert(all.code.end(), stack[k].code.begin(), stack[k].code.end());
      all.code.push_back(BlobCode::make(op));
      all.height = std::max(all.height, stack[k].height + 1);
    }
    stack.resize(first + 1);
  }
  return stack.size() == 1 && stack[0].height <= kBlobStack ? std::move(stack[0].code)
                                                            : std::vector<std::uint32_t>{};
}

CellBox box_of(const Skeleton& skeleton, double reach) {
  const auto around = [](const Vec3d& lo, const Vec3d& hi, const Vec3d& by) {
    return CellBox{lo - by, hi + by};
  };
  const Vec3d all{reach, reach, reach};
  if (const auto* s = std::get_if<PointSkeleton>(&skeleton)) return around(s->center, s->center, all);
  if (const auto* s = std::get_if<SegmentSkeleton>(&skeleton))
    return around(min(s->from, s->to), max(s->from, s->to), all);
  if (const auto* s = std::get_if<PolygonSkeleton>(&skeleton)) {
    Vec3d lo = s->vertices[0], hi = lo;
    for (const Vec3d& v : s->vertices) lo = min(lo, v), hi = max(hi, v);
    return around(lo, hi, all);
  }
  const auto& s = std::get<EllipsoidSkeleton>(skeleton);
  const Affine turn = Affine::rotation(s.rotation);
  Vec3d by;
  for (int k = 0; k < 3; ++k) {
    double square = 0;
    for (int j = 0; j < 3; ++j) square += turn.m[k][j] * s.radii[j] * turn.m[k][j] * s.radii[j];
    by[k] = reach * std::sqrt(square);
  }
  return around(s.center, s.center, by);
}

/// Directions in the plane of a polygon and its normal (Newell).
static void set_plane(const std::vector<Vec3d>& vertices, FieldPart& part) {
  Vec3d n{0, 0, 0};
  double longest = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d a = vertices[i] - vertices[0], edge = vertices[(i + 1) % vertices.size()] - vertices[i];
    n += cross(a, edge);
    if (dot(edge, edge) > longest) longest = dot(edge, edge), part.row[0] = edge;
  }
  part.row[2] = normalize(n);
  part.row[1] = normalize(cross(part.row[2], part.row[0]));
  part.row[0] = cross(part.row[1], part.row[2]);
}

FieldPart make_part(const FieldElement& element, const Vec3d& middle, double size,
                    std::vector<double>& corners) {
  const Potential& p = element.potential;
  FieldPart part;
  part.kind = p.kind, part.d = p.d, part.weight = p.weight;
  const double scale = (p.kind == PotentialKind::gaussian ? 1 / std::sqrt(p.scale) : p.scale) / size;
  const double unit = 1 / scale;
  part.unit_square = unit * unit, part.reach = scale;
  const auto own = [&](const Vec3d& x) { return (x - middle) / size; };
  if (const auto* s = std::get_if<PointSkeleton>(&element.skeleton)) {
    part.origin = own(s->center);
    part.row[0] = {unit, 0, 0}, part.row[1] = {0, unit, 0}, part.row[2] = {0, 0, unit};
  } else if (const auto* line = std::get_if<SegmentSkeleton>(&element.skeleton)) {
    part.shape = FieldPart::Shape::segment;
    part.origin = own(line->from), part.axis = own(line->to) - part.origin;
    part.axis_square = dot(part.axis, part.axis);
    part.inverse_axis = part.axis_square > 0 ? 1 / part.axis_square : 0;
  } else if (const auto* polygon = std::get_if<PolygonSkeleton>(&element.skeleton)) {
    part.shape = FieldPart::Shape::polygon;
    part.origin = own(polygon->vertices[0]);
    set_plane(polygon->vertices, part);
    part.corner = static_cast<std::uint32_t>(corners.size() / 2);
    part.corners = static_cast<std::uint32_t>(polygon->vertices.size());
    for (const Vec3d& v : polygon->vertices) {
      const Vec3d o = own(v) - part.origin;
      corners.push_back(dot(o, part.row[0])), corners.push_back(dot(o, part.row[1]));
    }
  } else {
    const auto& e = std::get<EllipsoidSkeleton>(element.skeleton);
    const Affine turn = Affine::rotation(e.rotation);
    part.origin = own(e.center);
    for (int k = 0; k < 3; ++k)
      part.row[k] = Vec3d{turn.m[0][k], turn.m[1][k], turn.m[2][k]} * (unit / e.radii[k]);
    part.reach = scale * std::min({e.radii.x, e.radii.y, e.radii.z});
  }
  return part;
}

}  // namespace oktett::field
