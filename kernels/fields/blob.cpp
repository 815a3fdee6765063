#include "kernels/fields/blob.h"

#include <algorithm>
#include <cmath>

namespace oktett {
namespace {

/// The vector from the source's point, line or plane to p; its square is the squared distance.
Vec3d from_source(const BlobElement::Source& s, const Vec3d& p) {
  const Vec3d v = p - s.at;
  if (s.kind == BlobSource::Kind::point) return v;
  const Vec3d along = s.axis * dot(v, s.axis);
  return s.kind == BlobSource::Kind::plane ? along : v - along;
}

/// How far the surface may reach along `axis` towards `side`, if all sources are points: at a distance of x
/// beyond all of them they add up to no more than if all were straight behind, and that falls with x.
double reach(const BlobShape& s, int axis, double side) {
  double last = -HUGE_VAL, total = 0;
  for (const BlobSource& source : s.sources)
    if (source.weight > 0) last = std::max(last, side * source.at[axis]), total += source.weight;
  double lo = last, hi = last + std::sqrt(total / s.iso);
  for (int k = 0; k < 60; ++k) {
    const double x = 0.5 * (lo + hi);
    double sum = 0;
    for (const BlobSource& source : s.sources) {
      const double d = x - side * source.at[axis];
      if (source.weight > 0) sum += source.weight / (d * d);
    }
    (sum > s.iso ? lo : hi) = x;
  }
  return side * hi;
}

}  // namespace

std::optional<std::array<Vec3d, 2>> blob_box(const BlobShape& s) {
  if (s.bounded) return std::array{s.lo, s.hi};
  bool any = false;
  for (const BlobSource& source : s.sources) {
    if (source.kind != BlobSource::Kind::point) return std::nullopt;
    any |= source.weight > 0;
  }
  if (!any) return std::nullopt;
  std::array<Vec3d, 2> box;
  for (int k = 0; k < 3; ++k) box[0][k] = reach(s, k, -1), box[1][k] = reach(s, k, 1);
  // What was rounded on the way.
  const Vec3d pad = (box[1] - box[0]) * 0x1p-40;
  box[0] -= pad, box[1] += pad;
  return box;
}

void Blob::add(Pool& pool, const BlobShape& s, const ExactPlace& place) {
  const auto box = blob_box(s);
  if (!box || s.sources.empty() || s.sources.size() > kMaxBlobSources || !(s.iso > 0)) return;
  const Vec3d middle = ((*box)[0] + (*box)[1]) * 0.5, half = ((*box)[1] - (*box)[0]) * 0.5;
  const double size = max_component(half);
  if (!(half.x > 0 && half.y > 0 && half.z > 0 && std::isfinite(size + length(middle)))) return;
  BlobElement e{};
  double weights = 0;
  for (const BlobSource& source : s.sources) {
    const bool is_point = source.kind == BlobSource::Kind::point;
    const double l = is_point ? 1 : length(source.direction);
    if (!(l > 0)) return;
    BlobElement::Source& own = e.sources[e.count++];
    own.kind = source.kind;
    own.axis = is_point ? Vec3d{0, 0, 0} : source.direction / l;
    const Vec3d at = source.kind == BlobSource::Kind::plane ? own.axis * source.offset : source.at;
    own.at = (at - middle) / size;
    // The box is far from some points of a line or a plane; the nearest ones to it make small numbers.
    if (source.kind == BlobSource::Kind::line) own.at = own.at - own.axis * dot(own.at, own.axis);
    own.weight = source.weight / (size * size);
    weights = std::max(weights, std::abs(own.weight));
  }
  // Only the ratio of weights and iso value matters; so both stay far from the ends of the range of numbers.
  const double greatest = std::max(weights, s.iso);
  for (int i = 0; i < e.count; ++i) e.sources[i].weight /= greatest;
  e.iso = s.iso / greatest;
  e.open = !s.bounded || s.open;
  e.root_finder = s.root_finder;
  e.lo = half * (-1 / size), e.hi = half * (1 / size);
  const Affine own = Affine::translation(middle) * Affine::scaling({size, size, size});
  add_element(pool, e, place.to_world * own, place);
  add_cell(pool, e.lo, e.hi);
}

Slope Blob::slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const BlobElement& e = pool.elements[i];
  if (part > 0) return {face_value(e.lo, e.hi, part, p), face_gradient(part)};
  Slope s{e.iso, {0, 0, 0}};
  for (int k = 0; k < e.count; ++k) {
    const Vec3d v = from_source(e.sources[k], p);
    const double q = dot(v, v);
    s.value -= e.sources[k].weight / q;
    s.gradient += v * (2 * e.sources[k].weight / (q * q));
  }
  return s;
}

}  // namespace oktett
