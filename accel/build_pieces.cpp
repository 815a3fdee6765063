#include "accel/build_pieces.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace oktett {
namespace {

constexpr double kBudget = 0.5;  ///< references added per reference, at most
/// A triangle becomes 1 + floor(kAboveMean * its priority / the mean priority) pieces: even meshes stay as
/// they are.
constexpr double kAboveMean = 0.4;
constexpr int kMostPieces = 64;       ///< of one triangle
constexpr int kLevels = 20;           ///< the grid has 2^20 cells along the longest axis
constexpr std::size_t kChunk = 4096;  ///< references per task

/// A plane of the grid that cuts a box: the one that the fewest halvings of the scene lead to.
struct Cut {
  int axis = -1;
  int level = 0;  ///< greater: more important
  float place = 0;
};

/// Powers of two of cells: planes at coarse levels are shared by all boxes that they cut.
class Cells {
 public:
  explicit Cells(const Box& bounds) : origin_(bounds.lo) {
    const Vec3d extent = Vec3d(bounds.hi) - Vec3d(bounds.lo);
    cell_ = std::max({extent.x, extent.y, extent.z}) / (1 << kLevels);
  }

  Cut find(const Box& box) const {
    Cut best;
    double widest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t lo = index(box.lo[axis], axis), hi = index(box.hi[axis], axis);
      if (lo == hi) continue;
      const int level = std::bit_width(lo ^ hi) - 1;
      const double width = double(box.hi[axis]) - box.lo[axis];
      if (best.axis >= 0 && (level < best.level || (level == best.level && width <= widest))) continue;
      const auto place = static_cast<float>(origin_[axis] + cell_ * double(hi >> level << level));
      if (!(box.lo[axis] < place && place < box.hi[axis])) continue;
      best = {axis, level, place}, widest = width;
    }
    return best;
  }

 private:
  std::uint32_t index(float v, int axis) const {
    const double i = (double(v) - origin_[axis]) / cell_;
    return static_cast<std::uint32_t>(std::clamp(i, 0.0, double((1 << kLevels) - 1)));
  }
  Vec3d origin_;
  double cell_;
};

Box box_of(const PrimRef& r) {
  return {{-r.negative_lo[0], -r.negative_lo[1], -r.negative_lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
}

bool may_cut(const PrimRef& r) {
  return r.kind == (static_cast<std::uint32_t>(Kind::triangle) |
                    static_cast<std::uint32_t>(TriangleTest::watertight) << 8);
}

/// Surface of the box beyond what boxes around ever smaller pieces of the triangle would have, weighed by how
/// early in the tree the cut comes.
double priority(const Cells& cells, const Box& box, const Vec3f (&v)[3]) {
  const Cut cut = cells.find(box);
  if (cut.axis < 0) return 0;
  const Vec3d e = Vec3d(box.hi) - Vec3d(box.lo),
              n = cross(Vec3d(v[1]) - Vec3d(v[0]), Vec3d(v[2]) - Vec3d(v[0]));
  const double surface = 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  const double least = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  return std::cbrt(std::ldexp(std::max(0.0, surface - least), cut.level - kLevels));
}

/// The boxes of the triangle's parts on the two sides of a plane, inside `box` (Stich, Friedrich and Dietrich
/// 2009). Crossings are computed in double and rounded outwards.
void cut_box(const Box& box, const Cut& cut, const Vec3f (&v)[3], Box (&side)[2]) {
  side[0] = side[1] = Box{};
  for (int k = 0; k < 3; ++k) {
    const Vec3f &a = v[k], &b = v[(k + 1) % 3];
    if (a[cut.axis] <= cut.place) side[0].grow(a);
    if (a[cut.axis] >= cut.place) side[1].grow(a);
    if ((a[cut.axis] < cut.place) == (b[cut.axis] < cut.place)) continue;
    const Vec3d p(a), q(b);
    const double t = (double(cut.place) - p[cut.axis]) / (q[cut.axis] - p[cut.axis]);
    const Vec3d crossing = p * (1 - t) + q * t;
    for (Box& s : side) s.grow(round_down(crossing)), s.grow(round_up(crossing));
  }
  for (Box& s : side) s.lo = max(s.lo, box.lo), s.hi = min(s.hi, box.hi);
  side[0].hi[cut.axis] = std::min(side[0].hi[cut.axis], cut.place);
  side[1].lo[cut.axis] = std::max(side[1].lo[cut.axis], cut.place);
}

/// Appends `ref` as up to `pieces` references.
void add_pieces(const Cells& cells, const PrimRef& ref, const Box& box, const Vec3f (&v)[3], int pieces,
                std::vector<PrimRef>& out) {
  Cut cut;
  if (pieces > 1) cut = cells.find(box);
  Box side[2];
  if (cut.axis >= 0) cut_box(box, cut, v, side);
  if (cut.axis < 0 || side[0].empty() || side[1].empty()) {
    out.push_back({{-box.lo.x, -box.lo.y, -box.lo.z}, ref.item, {box.hi.x, box.hi.y, box.hi.z}, ref.kind});
    return;
  }
  const Vec3f l = side[0].extent(), r = side[1].extent();
  const double left = std::max({l.x, l.y, l.z}), right = std::max({r.x, r.y, r.z});
  const double share = left + right > 0 ? left / (left + right) : 0.5;
  const int to_left = std::clamp(static_cast<int>(std::lround(pieces * share)), 1, pieces - 1);
  add_pieces(cells, ref, side[0], v, to_left, out);
  add_pieces(cells, ref, side[1], v, pieces - to_left, out);
}

int pieces_of(double weight) { return 1 + static_cast<int>(std::min(weight, kMostPieces - 1.0)); }

/// By how much to multiply priorities for the pieces above one; less if they would not keep to the budget.
double find_factor(const std::vector<float>& priorities) {
  double sum = 0;
  for (const float p : priorities) sum += p;
  if (!(sum > 0) || !std::isfinite(sum)) return 0;
  const auto count = static_cast<double>(priorities.size());
  double factor = kAboveMean * count / sum;
  for (int i = 0; i < 20; ++i) {
    double added = 0;
    for (const float p : priorities) added += pieces_of(p * factor) - 1;
    if (added <= kBudget * count) return factor;
    factor *= 0.8;
  }
  return 0;
}

}  // namespace

bool split_large(Column<PrimRef>& refs, const TriangleSource& triangles, const Box& bounds, bool parallel) {
  const Cells cells(bounds);
  const std::size_t chunks = (refs.size() + kChunk - 1) / kChunk;
  const auto each = [&](auto&& body) {
    const auto chunk = [&](std::size_t c) {
      for (std::size_t i = c * kChunk, end = std::min(i + kChunk, refs.size()); i < end; ++i) body(c, i);
    };
    if (parallel)
      tbb::parallel_for(std::size_t{0}, chunks, chunk);
    else
      for (std::size_t c = 0; c < chunks; ++c) chunk(c);
  };
  std::vector<float> priorities(refs.size(), 0.0f);
  each([&](std::size_t, std::size_t i) {
    if (!may_cut(refs[i])) return;
    Vec3f v[3];
    triangles.corners(refs[i].item, v);
    priorities[i] = static_cast<float>(priority(cells, box_of(refs[i]), v));
  });
  const double factor = find_factor(priorities);
  if (!(factor > 0)) return false;
  std::vector<std::vector<PrimRef>> parts(chunks);
  for (auto& p : parts) p.reserve(kChunk + kChunk / 2);
  each([&](std::size_t c, std::size_t i) {
    const int pieces = pieces_of(priorities[i] * factor);
    if (pieces == 1) return parts[c].push_back(refs[i]);
    Vec3f v[3];
    triangles.corners(refs[i].item, v);
    add_pieces(cells, refs[i], box_of(refs[i]), v, pieces, parts[c]);
  });
  std::size_t total = 0;
  for (const auto& p : parts) total += p.size();
  if (total == refs.size() || total > kNoId - 1) return false;
  refs.resize_uninitialized(total);
  PrimRef* to = refs.data();
  for (const auto& p : parts) to = std::copy(p.begin(), p.end(), to);
  return true;
}

}  // namespace oktett
