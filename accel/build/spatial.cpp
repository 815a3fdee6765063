#include "accel/build/spatial.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace oktett {
namespace {

constexpr int kSlices = 16;                    ///< per axis; planes lie between them
constexpr std::size_t kSlicedTogether = 4096;  ///< references sliced by one task

Box box_of(const PrimRef& r) {
  return {{-r.negative_lo[0], -r.negative_lo[1], -r.negative_lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
}

PrimRef with_box(const PrimRef& r, const Box& b) {
  return {{-b.lo.x, -b.lo.y, -b.lo.z}, r.item, {b.hi.x, b.hi.y, b.hi.z}, r.kind};
}

/// What stands in two leaves must give the same hit in both, which the watertight test does.
bool may_cut(const PrimRef& r) {
  return r.kind == (static_cast<std::uint32_t>(Kind::triangle) |
                    static_cast<std::uint32_t>(TriangleTest::watertight) << 8);
}

/// The boxes of the triangle's parts on the two sides of a plane, inside `box`. Crossings are computed in
/// double and rounded outwards.
void cut_box(const Box& box, int axis, float place, const Vec3f (&v)[3], Box (&side)[2]) {
  side[0] = side[1] = Box{};
  for (int k = 0; k < 3; ++k) {
    const Vec3f &a = v[k], &b = v[(k + 1) % 3];
    if (a[axis] <= place) side[0].grow(a);
    if (a[axis] >= place) side[1].grow(a);
    if ((a[axis] < place) == (b[axis] < place)) continue;
    const Vec3d p(a), q(b);
    const double t = (double(place) - p[axis]) / (q[axis] - p[axis]);
    const Vec3d crossing = p * (1 - t) + q * t;
    const auto rounded = [&](float direction) {
      Vec3f r;
      for (int c = 0; c < 3; ++c) {
        const auto f = static_cast<float>(crossing[c]);
        r[c] = f + direction * (std::fabs(f) * 0x1p-23f + std::numeric_limits<float>::denorm_min());
      }
      return r;
    };
    const Vec3f lo = rounded(-1), hi = rounded(1);
    for (Box& s : side) s.grow(lo), s.grow(hi);
  }
  for (Box& s : side) s.lo = max(s.lo, box.lo), s.hi = min(s.hi, box.hi);
  side[0].hi[axis] = std::min(side[0].hi[axis], place);
  side[1].lo[axis] = std::max(side[1].lo[axis], place);
}

/// Slices of equal thickness across one axis of a box.
struct Slices {
  float place[kSlices + 1];  ///< slice b lies between place[b] and place[b + 1]
  float lo = 0;
  float scale = 0;  ///< 0: the axis has no planes

  Slices() = default;
  Slices(float from, float to) : lo(from) {
    const double width = (double(to) - from) / kSlices;
    for (int b = 0; b <= kSlices; ++b) place[b] = static_cast<float>(from + width * b);
    place[kSlices] = to;
    for (int b = 0; b < kSlices; ++b)
      if (!(place[b] < place[b + 1])) return;
    scale = static_cast<float>(1 / width);
    if (!std::isfinite(scale) || !std::isfinite(to - from)) scale = 0;
  }
  /// The slice of a coordinate in the box.
  int operator()(float v) const { return std::clamp(static_cast<int>((v - lo) * scale), 0, kSlices - 1); }
  /// The same for any coordinate; -1 or kSlices if it is outside.
  int beside(float v) const { return v < lo ? -1 : v > place[kSlices] ? kSlices : (*this)(v); }
};

/// What lies in each slice of each axis.
struct Sliced {
  Box box[3][kSlices];
  std::uint32_t begins[3][kSlices] = {}, ends[3][kSlices] = {};

  void grow(const Sliced& s) {
    for (int axis = 0; axis < 3; ++axis)
      for (int b = 0; b < kSlices; ++b) {
        box[axis][b].grow(s.box[axis][b]);
        begins[axis][b] += s.begins[axis][b], ends[axis][b] += s.ends[axis][b];
      }
  }
};

/// Grows slices `first` to `last` by the parts of a triangle in them, inside `box`: only an estimate, so
/// float does.
void slice_triangle(const Slices& s, int axis, int first, int last, const Box& box, const Vec3f (&v)[3],
                    Box* out) {
  Box part[kSlices + 2];  // one more at either end, for what is outside
  Box* const at = part + 1;
  for (int k = 0; k < 3; ++k) {
    const bool up = v[k][axis] <= v[(k + 1) % 3][axis];
    const Vec3f &a = v[up ? k : (k + 1) % 3], &b = v[up ? (k + 1) % 3 : k];
    const int from = s.beside(a[axis]), to = s.beside(b[axis]);
    at[s.beside(v[k][axis])].grow(v[k]);
    const Vec3f step = (b - a) / (b[axis] - a[axis]);
    for (int p = std::max(from + 1, first), end = std::min(to, last + 1); p <= end; ++p) {
      const Vec3f crossing = a + step * (s.place[p] - a[axis]);
      at[p - 1].grow(crossing), at[p].grow(crossing);
    }
  }
  for (int b = first; b <= last; ++b) {
    Box clipped{max(at[b].lo, box.lo), min(at[b].hi, box.hi)};
    clipped.lo[axis] = std::max(clipped.lo[axis], s.place[b]);
    clipped.hi[axis] = std::min(clipped.hi[axis], s.place[b + 1]);
    if (!clipped.empty()) out[b].grow(clipped);
  }
}

/// Slices refs[0, count): of each `every` times kBinGroup references the first kBinGroup. Returns how many.
std::size_t slice(const PrimRef* refs, std::size_t count, std::size_t every, const Slices (&slices)[3],
                  const TriangleCorners& triangles, Sliced& out) {
  std::size_t sliced = 0;
  for (std::size_t i = 0; i < count; i += (i + 1) % kBinGroup == 0 ? 1 + (every - 1) * kBinGroup : 1) {
    ++sliced;
    const Box box = box_of(refs[i]);
    Vec3f v[3];
    bool have = false;
    for (int axis = 0; axis < 3; ++axis) {
      const Slices& s = slices[axis];
      if (s.scale == 0) continue;
      int first = s(box.lo[axis]);
      const int last = s(box.hi[axis]);
      if (first != last && !may_cut(refs[i])) first = last;
      ++out.begins[axis][first], ++out.ends[axis][last];
      if (first == last) {
        out.box[axis][first].grow(box);
        continue;
      }
      if (!have) triangles.corners(refs[i].item, v), have = true;
      slice_triangle(s, axis, first, last, box, v, out.box[axis]);
    }
  }
  return sliced;
}

/// What lies on a side of a plane.
struct SideCost {
  double area, count;
};

/// A reference that is divided: its number, and its box on either side.
struct CutReference {
  std::size_t number;
  Box side[2];
};

/// Where the references of a chunk go.
struct ChunkSides {
  std::size_t count[2] = {};
  std::vector<CutReference> cut;  ///< by ascending number
};

constexpr std::uint8_t kOnLeft = 1, kOnRight = 2;

/// The sides that a reference goes to, as kOnLeft and kOnRight, with its boxes there if it goes to both.
std::uint8_t sides_of(const PrimRef& ref, const SpatialSplit& split, const SideCost (&cost)[2],
                      const TriangleCorners& triangles, Box (&side)[2]) {
  const Box box = box_of(ref);
  const int axis = split.axis;
  if (box.hi[axis] <= split.place) return kOnLeft;
  if (box.lo[axis] >= split.place || !may_cut(ref)) return kOnRight;
  Vec3f v[3];
  triangles.corners(ref.item, v);
  cut_box(box, axis, split.place, v, side);
  if (side[0].empty()) return kOnRight;
  if (side[1].empty()) return kOnLeft;
  // "Reference unsplitting": the whole on the side that it makes less larger.
  Box whole[2] = {split.side[0], split.side[1]};
  whole[0].grow(box), whole[1].grow(box);
  const double both = cost[0].area * cost[0].count + cost[1].area * cost[1].count;
  const double only_left = half_area(whole[0]) * cost[0].count + cost[1].area * (cost[1].count - 1),
               only_right = cost[0].area * (cost[0].count - 1) + half_area(whole[1]) * cost[1].count;
  if (only_left < both && only_left <= only_right) return kOnLeft;
  return only_right < both ? kOnRight : kOnLeft | kOnRight;
}

}  // namespace

double half_area(const Box& box) {
  if (box.empty()) return 0;
  const Vec3d e = Vec3d(box.hi) - Vec3d(box.lo);
  return e.x * (e.y + e.z) + e.y * e.z;
}

SpatialSplit find_spatial(const PrimRef* refs, std::size_t count, const Box& box,
                          const TriangleCorners& triangles, const SpatialSearch& search) {
  Slices slices[3];
  const float longest = max_component(box.extent());
  for (int axis = 0; axis < 3; ++axis)
    if (search.every_axis || box.extent()[axis] >= longest) slices[axis] = Slices(box.lo[axis], box.hi[axis]);
  const Chunks chunks(count, kSlicedTogether);
  std::vector<Sliced> parts(chunks.count);
  std::vector<std::size_t> sliced(chunks.count);
  chunks.each(search.parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    sliced[c] = slice(refs + begin, end - begin, search.every, slices, triangles, parts[c]);
  });
  for (std::size_t c = 1; c < parts.size(); ++c) parts[0].grow(parts[c]), sliced[0] += sliced[c];
  const Sliced& all = parts[0];
  const std::size_t total = sliced[0];
  const double each = static_cast<double>(count) / static_cast<double>(total);
  const auto blocks = [&](std::size_t n) {
    return blocks_of(static_cast<std::uint32_t>(static_cast<double>(n) * each));
  };

  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (slices[axis].scale == 0) continue;
    Box right[kSlices];
    std::size_t rights[kSlices] = {};
    Box side;
    std::size_t n = 0;
    for (int b = kSlices - 1; b > 0; --b) {
      side.grow(all.box[axis][b]), n += all.ends[axis][b];
      right[b] = side, rights[b] = n;
    }
    side = {}, n = 0;
    for (int b = 0; b + 1 < kSlices; ++b) {
      side.grow(all.box[axis][b]), n += all.begins[axis][b];
      if (n == 0 || rights[b + 1] == 0 || n == total || rights[b + 1] == total) continue;
      const double cost = half_area(side) * blocks(n) + half_area(right[b + 1]) * blocks(rights[b + 1]);
      if (cost < best.cost) {
        best.axis = axis, best.place = slices[axis].place[b + 1], best.cost = cost;
        best.side[0] = side, best.side[1] = right[b + 1];
        best.count[0] = static_cast<double>(n) * each;
        best.count[1] = static_cast<double>(rights[b + 1]) * each;
      }
    }
  }
  return best;
}

SpatialParts partition_spatial(const PrimRef* refs, std::size_t count, std::size_t room,
                               const SpatialSplit& split, const TriangleCorners& triangles, bool parallel,
                               PrimRef* left, PrimRef* right) {
  const SideCost cost[2] = {{half_area(split.side[0]), split.count[0]},
                            {half_area(split.side[1]), split.count[1]}};
  const Chunks chunks(count, kSlicedTogether);
  std::vector<std::uint8_t> sides(count);
  std::vector<ChunkSides> parts(chunks.count);
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    ChunkSides& part = parts[c];
    for (std::size_t i = begin; i < end; ++i) {
      Box side[2];
      sides[i] = sides_of(refs[i], split, cost, triangles, side);
      part.count[0] += (sides[i] & kOnLeft) != 0, part.count[1] += (sides[i] & kOnRight) != 0;
      if (sides[i] == (kOnLeft | kOnRight)) part.cut.push_back({i, {side[0], side[1]}});
    }
  });
  SpatialParts all;
  for (ChunkSides& part : parts) {
    const std::size_t before[2] = {all.left, all.right};
    all.left += part.count[0], all.right += part.count[1];
    part.count[0] = before[0], part.count[1] = before[1];
  }
  if (all.left + all.right > room) return {};
  if (all.left == 0 || all.right == 0 || all.left == count || all.right == count) return {};
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    const CutReference* cut = parts[c].cut.data();
    PrimRef *to_left = left + parts[c].count[0], *to_right = right - parts[c].count[1];
    for (std::size_t i = begin; i < end; ++i) {
      const bool is_cut = sides[i] == (kOnLeft | kOnRight);
      if (sides[i] & kOnLeft) *to_left++ = is_cut ? with_box(refs[i], cut->side[0]) : refs[i];
      if (sides[i] & kOnRight) *--to_right = is_cut ? with_box(refs[i], cut->side[1]) : refs[i];
      cut += is_cut;
    }
  });
  return all;
}

}  // namespace oktett
