#include "kernels/fields/blobtree.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"

namespace oktett {

// ---- The program of a tree of blends.

namespace field {

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

}  // namespace field

// ---- The surface.

namespace {

/// Cells are divided down to this, in reaches of their smallest element.
constexpr double kLeastPartSize = 0.25;
/// Times relative to that of a node: a cell, and each of its elements.
constexpr double kPartCellCost = 20, kPartCost = 20;

double square_end(PotentialKind kind) {
  return kind == PotentialKind::inverse_square ? kInfinity
         : kind == PotentialKind::gaussian     ? field::kGaussianEnd
                                               : 1.0;
}

/// The potential without its weight.
double potential(const FieldPart& part, double square, double& slope) {
  if (square >= square_end(part.kind)) return slope = 0;
  if (part.kind == PotentialKind::gaussian) {
    const double v = portable::exp(-square);
    slope = -v;
    return v;
  }
  using D = Simd<double, 1, ScalarIsa>;
  D value, by_square;
  field::potential_at(part.kind, part.d, D(square), value, by_square);
  slope = only_lane(by_square);
  return only_lane(value);
}

/// What leads from the nearest place in the polygon to (x, y).
void from_polygon(const BlobTreePool& pool, const FieldPart& part, double x, double y, double& dx,
                  double& dy) {
  const double* corner = pool.corners.data() + 2 * std::size_t{part.corner};
  const double* a = corner + 2 * (part.corners - 1);
  bool within = false;
  double nearest = kInfinity;
  for (std::uint32_t i = 0; i < part.corners; ++i) {
    const double* b = corner + 2 * i;
    const double ex = b[0] - a[0], ey = b[1] - a[1], px = x - a[0], py = y - a[1];
    const double h = std::clamp((px * ex + py * ey) / (ex * ex + ey * ey), 0.0, 1.0);
    const double qx = px - h * ex, qy = py - h * ey, square = qx * qx + qy * qy;
    if (square < nearest) nearest = square, dx = qx, dy = qy;
    if ((a[1] > y) != (b[1] > y) && px < py * (ex / ey)) within = !within;
    a = b;
  }
  if (within) dx = dy = 0;
}

/// R, and half its gradient.
double square_at(const BlobTreePool& pool, const FieldPart& part, const Vec3d& p, Vec3d& half) {
  const Vec3d o = p - part.origin;
  if (part.shape == FieldPart::Shape::segment) {
    const Vec3d n = o - part.axis * std::clamp(dot(o, part.axis) * part.inverse_axis, 0.0, 1.0);
    half = n * part.unit_square;
    return dot(n, half);
  }
  Vec3d y{dot(part.row[0], o), dot(part.row[1], o), dot(part.row[2], o)};
  double unit = 1;
  if (part.shape == FieldPart::Shape::polygon) {
    from_polygon(pool, part, y.x, y.y, y.x, y.y);
    unit = part.unit_square;
  }
  half = (part.row[0] * y.x + part.row[1] * y.y + part.row[2] * y.z) * unit;
  return dot(y, y) * unit;
}

/// What R may be in a box.
CellRange square_in(const BlobTreePool& pool, const FieldPart& part, const CellBox& box) {
  const Vec3d middle = (box.lo + box.hi) * 0.5, extent = (box.hi - box.lo) * 0.5;
  if (part.shape == FieldPart::Shape::point) {
    double near = 0, far = 0;
    for (const Vec3d& row : part.row) {
      const double y = std::abs(dot(row, middle - part.origin)), e = dot(abs(row), extent);
      near += clamp_square(y - e), far += (y + e) * (y + e);
    }
    return {near, far};
  }
  // Distances do not grow faster than the way.
  Vec3d unused;
  const double unit = std::sqrt(part.unit_square), way = length(extent) * unit;
  const double r = std::sqrt(square_at(pool, part, middle, unused));
  return {clamp_square(r - way), (r + way) * (r + way)};
}

struct PartRange {
  double lo, hi;
  bool zero;
};

/// Encloses a weighted potential in a box.
PartRange part_range(const BlobTreePool& pool, const FieldPart& part, const CellBox& box) {
  const CellRange square = square_in(pool, part, box);
  if (square.lo * (1 - 0x1p-30) >= square_end(part.kind)) return {0, 0, true};
  double unused;
  const double high = potential(part, square.lo * (1 - 0x1p-30), unused);
  const double low = potential(part, square.hi * (1 + 0x1p-30), unused);
  const double error = 0x1p-36 * (1 + high), a = part.weight * std::max(low - error, 0.0),
               b = part.weight * (high + error);
  return {std::min(a, b), std::max(a, b), false};
}

class BlobRule : public CellRule {
 public:
  BlobRule(const BlobTreePool& pool, double iso) : pool_(pool), iso_(iso) {}

  CellRange narrow(const CellBox& box, std::span<const std::uint32_t> part,
                   std::vector<std::uint32_t>& out) const override {
    Entry stack[kBlobStack];
    int top = -1;
    for (const std::uint32_t code : part) {
      const auto op = BlobCode::op(code);
      if (op == BlobCode::element) {
        const PartRange r = part_range(pool_, pool_.parts[BlobCode::index(code)], box);
        stack[++top] = {r.lo, r.hi, out.size(), r.zero};
        out.push_back(r.zero ? BlobCode::make(BlobCode::zero) : code);
      } else if (op == BlobCode::zero) {
        stack[++top] = {0, 0, out.size(), true};
        out.push_back(code);
      } else {
        const Entry& b = stack[top--];
        blend(op, code, stack[top], b, out);
      }
    }
    const Entry& all = stack[top];
    const double error = 0x1p-36 * (iso_ + std::max(std::abs(all.lo), std::abs(all.hi)));
    return {iso_ - all.hi - error, iso_ - all.lo + error};
  }

  double least_size(std::span<const std::uint32_t> part) const override {
    double reach = kInfinity;
    for (const std::uint32_t code : part)
      if (BlobCode::op(code) == BlobCode::element)
        reach = std::min(reach, pool_.parts[BlobCode::index(code)].reach);
    return kLeastPartSize * reach;
  }

  double cost(std::span<const std::uint32_t> part) const override {
    double cost = kPartCellCost;
    for (const std::uint32_t code : part)
      if (BlobCode::op(code) == BlobCode::element) {
        const FieldPart& p = pool_.parts[BlobCode::index(code)];
        cost += kPartCost * (p.shape == FieldPart::Shape::polygon ? p.corners : 1);
      }
    return cost;
  }

 private:
  struct Entry {
    double lo, hi;
    std::size_t begin;  ///< of its program in `out`
    bool zero;
  };

  /// Makes one of the two topmost values; leaves out what does not matter.
  void blend(BlobCode::Op op, std::uint32_t code, Entry& a, const Entry& b,
             std::vector<std::uint32_t>& out) const {
    const auto keep_a = [&] { out.resize(b.begin); };
    const auto keep_b = [&] {
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(a.begin),
                out.begin() + static_cast<std::ptrdiff_t>(b.begin));
      a = {b.lo, b.hi, a.begin, b.zero};
    };
    const double c_lo = op == BlobCode::difference ? 2 * iso_ - b.hi : b.lo;
    const double c_hi = op == BlobCode::difference ? 2 * iso_ - b.lo : b.hi;
    switch (op) {
      case BlobCode::sum:
        if (b.zero) return keep_a();
        if (a.zero) return keep_b();
        a.lo += b.lo, a.hi += b.hi;
        break;
      case BlobCode::max:
        if (b.hi <= a.lo) return keep_a();
        if (a.hi <= b.lo) return keep_b();
        a.lo = std::max(a.lo, b.lo), a.hi = std::max(a.hi, b.hi);
        break;
      case BlobCode::min:
        if (a.hi <= b.lo) return keep_a();
        if (b.hi <= a.lo) return keep_b();
        a.lo = std::min(a.lo, b.lo), a.hi = std::min(a.hi, b.hi);
        break;
      default:
        if (a.hi <= c_lo) return keep_a();
        a.lo = std::min(a.lo, c_lo), a.hi = std::min(a.hi, c_hi);
    }
    a.zero = false;
    out.push_back(code);
  }

  const BlobTreePool& pool_;
  double iso_;
};

}  // namespace

void BlobTree::add(Pool& pool, const BlobTreeShape& s, const ExactPlace& place) {
  std::vector<std::uint32_t> code = field::program(s);
  if (code.empty() || !(s.iso > 0 && std::isfinite(s.iso))) return;
  // No blend exceeds the sum of the positive elements. Of n that never end one must be iso / n at least.
  double endless = 0;
  for (const FieldElement& e : s.elements)
    endless += e.potential.kind == PotentialKind::inverse_square && e.potential.weight > 0;
  CellBox box{};
  bool any = false;
  for (const FieldElement& e : s.elements) {
    const Potential& p = e.potential;
    if (!(p.scale > 0 && std::isfinite(p.weight))) return;
    if (!(p.weight > 0)) continue;
    double reach = p.scale;
    if (p.kind == PotentialKind::gaussian) reach = std::sqrt(field::kGaussianEnd / p.scale);
    if (p.kind == PotentialKind::inverse_square) reach = p.scale * std::sqrt(p.weight * endless / s.iso);
    const CellBox own = field::box_of(e.skeleton, reach * (1 + 0x1p-30));
    box = any ? CellBox{min(box.lo, own.lo), max(box.hi, own.hi)} : own;
    any = true;
  }
  const Vec3d middle = (box.lo + box.hi) * 0.5, extent = box.hi - box.lo;
  const double size = 0.5 * std::max({extent.x, extent.y, extent.z});
  if (!any || !(size > 0 && std::isfinite(dot(extent, extent)))) return;

  const auto first = static_cast<std::uint32_t>(pool.parts.size());
  if (pool.parts.size() + s.elements.size() >= std::size_t{1} << BlobCode::kShift) return;
  for (const FieldElement& e : s.elements)
    pool.parts.push_back(field::make_part(e, middle, size, pool.corners));
  for (std::uint32_t& c : code)
    if (BlobCode::op(c) == BlobCode::element) c += first;
  BlobTreeElement e{s.iso, static_cast<std::uint32_t>(pool.codes.size()),
                    static_cast<std::uint32_t>(code.size()), 0};
  pool.codes.insert(pool.codes.end(), code.begin(), code.end());
  BlobRule rule(pool, s.iso);
  const Vec3d half = extent * (0.5 / size);
  e.root = pool.tree.divide(rule, {-half, half}, code, static_cast<std::uint32_t>(pool.elements.size()),
                            pool.cells);
  add_element(pool, e, place.to_world * Affine::translation(middle) * Affine::scaling({size, size, size}),
              place);
}

Slope BlobTree::slope_at(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const BlobTreeElement& e = pool.elements[i];
  const CellNode& node = pool.tree.leaf_at(e.root, p);
  const bool leaf = node.kind == CellNode::Kind::leaf;
  const std::uint32_t* code = leaf ? pool.tree.lists.data() + node.first : pool.codes.data() + e.begin;
  const std::uint32_t count = leaf ? node.second : e.count;
  Slope stack[kBlobStack];
  int top = -1;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto op = BlobCode::op(code[k]);
    if (op == BlobCode::zero) {
      stack[++top] = {0, {0, 0, 0}};
    } else if (op == BlobCode::element) {
      const FieldPart& part = pool.parts[BlobCode::index(code[k])];
      Vec3d half;
      double slope;
      const double v = potential(part, square_at(pool, part, p, half), slope);
      stack[++top] = {part.weight * v, half * (2 * part.weight * slope)};
    } else {
      const Slope b = stack[top--];
      Slope& a = stack[top];
      if (op == BlobCode::sum) {
        a = {a.value + b.value, a.gradient + b.gradient};
      } else if (op == BlobCode::difference) {
        if (2 * e.iso - b.value < a.value) a = {2 * e.iso - b.value, -b.gradient};
      } else if (op == BlobCode::max ? b.value > a.value : b.value < a.value) {
        a = b;
      }
    }
  }
  return {e.iso - stack[0].value, -stack[0].gradient};
}

}  // namespace oktett
