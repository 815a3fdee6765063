#include "kernels/exact/bezier_patch.h"

#include <algorithm>
#include <cmath>

namespace oktett {
namespace {

using PatchPiece = BezierPatchElement::Piece;

/// Bounds how far the derivatives stray, and how strongly each way of dividing would reduce that.
struct PatchBend {
  bool is_flat;
  int axis;
};

/// What four control points in a row become in both halves.
void halve_row(const Vec3d* c, int step, Vec3d* l, Vec3d* h) {
  const Vec3d a = (c[0] + c[step]) * 0.5, b = (c[step] + c[2 * step]) * 0.5,
              d = (c[2 * step] + c[3 * step]) * 0.5, ab = (a + b) * 0.5, bd = (b + d) * 0.5,
              middle = (ab + bd) * 0.5;
  l[0] = c[0], l[step] = a, l[2 * step] = ab, l[3 * step] = middle;
  h[0] = middle, h[step] = bd, h[2 * step] = d, h[3 * step] = c[3 * step];
}

PatchBend bend_of(const PatchPiece& piece) {
  const Vec3d* p = piece.p;
  const double far = 1e300;
  Vec3d lo[2] = {{far, far, far}, {far, far, far}}, hi[2] = {-lo[0], -lo[1]};
  double second[2] = {0, 0};
  for (int axis = 0; axis < 2; ++axis) {
    const int step = axis == 0 ? 1 : 4, row = axis == 0 ? 4 : 1;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) {
        const Vec3d* c = p + k * row + i * step;
        const Vec3d d = c[step] - c[0];
        lo[axis] = min(lo[axis], d), hi[axis] = max(hi[axis], d);
        if (i < 2) second[axis] = std::max(second[axis], length(c[2 * step] - c[step] * 2 + c[0]));
      }
  }
  const Vec3d a = (lo[0] + hi[0]) * 0.5, b = (lo[1] + hi[1]) * 0.5;
  const double stray = length(hi[0] - lo[0]) * 0.5 * length(b) + length(hi[1] - lo[1]) * 0.5 * length(a);
  return {stray <= 0.25 * length(cross(a, b)), second[0] * length(b) >= second[1] * length(a) ? 0 : 1};
}

/// Appends the pieces of a patch, which is halved up to `depth[axis]` times along each axis.
void divide_patch(PatchPiece piece, const int (&depth)[2], std::vector<PatchPiece>& out) {
  const PatchBend bend = bend_of(piece);
  if (bend.is_flat || (depth[0] == 0 && depth[1] == 0)) {
    piece.lo = piece.hi = piece.p[0];
    for (const Vec3d& p : piece.p) piece.lo = min(piece.lo, p), piece.hi = max(piece.hi, p);
    // Room for the rounding of rays, more than the solver has.
    constexpr double kRoom = 0x1p-40;
    piece.lo -= Vec3d{kRoom, kRoom, kRoom}, piece.hi += Vec3d{kRoom, kRoom, kRoom};
    out.push_back(piece);
    return;
  }
  const int axis = depth[bend.axis] > 0 ? bend.axis : 1 - bend.axis;
  PatchPiece low{}, high{};
  low.box = high.box = piece.box;
  for (int k = 0; k < 4; ++k) {
    const int first = axis == 0 ? 4 * k : k;
    halve_row(piece.p + first, axis == 0 ? 1 : 4, low.p + first, high.p + first);
  }
  if (axis == 0)
    low.box.u1 = high.box.u0 = (piece.box.u0 + piece.box.u1) * 0.5;
  else
    low.box.v1 = high.box.v0 = (piece.box.v0 + piece.box.v1) * 0.5;
  int left[2] = {depth[0], depth[1]};
  --left[axis];
  divide_patch(low, left, out);
  divide_patch(high, left, out);
}

/// Halvings along each axis: many patches are small already. Hit::u, a float, holds the number of a piece, so
/// there may be 2^24.
int depth_for(std::size_t patches) {
  return patches <= 4096 ? 3 : patches <= 65536 ? 2 : patches <= (1 << 18) ? 1 : 0;
}

/// dP/du of texture coordinates that are bilinear in the parameters.
void set_texture(const double (&uv)[8], double u, double v, UvPoint& at) {
  double d[2][2];
  for (int k = 0; k < 2; ++k) {
    const double a = uv[k], b = uv[2 + k], e = uv[4 + k], c = uv[6 + k];
    at.texture[k] = (a * (1 - u) + b * u) * (1 - v) + (c * (1 - u) + e * u) * v;
    d[k][0] = (b - a) * (1 - v) + (e - c) * v, d[k][1] = (c - a) * (1 - u) + (e - b) * u;
  }
  const double det = d[0][0] * d[1][1] - d[0][1] * d[1][0];
  if (!(std::abs(det) > 0)) return;
  at.tangent = (at.by_u * d[1][1] - at.by_v * d[1][0]) / det;
  at.bitangent = (at.by_v * d[0][0] - at.by_u * d[0][1]) / det;
}

}  // namespace

void BezierPatch::add(Pool& pool, const BezierPatchShape& s, const ExactPlace& place) {
  if (s.patches.empty()) return;
  Vec3d lo = s.patches[0].p[0], hi = lo;
  for (const BezierPatchPoints& patch : s.patches)
    for (const Vec3d& p : patch.p) lo = min(lo, p), hi = max(hi, p);
  const Vec3d middle = (lo + hi) * 0.5;
  const double size = 0.5 * max_component(hi - lo);
  if (!(size > 0) || !std::isfinite(size + length(middle))) return;
  BezierPatchElement e;
  std::copy(std::begin(s.uv), std::end(s.uv), e.uv);
  const int depth = depth_for(s.patches.size());
  for (const BezierPatchPoints& patch : s.patches) {
    if (std::all_of(patch.p + 1, patch.p + 16, [&](const Vec3d& p) { return p == patch.p[0]; })) continue;
    PatchPiece piece{};
    piece.box = {0, 1, 0, 1};
    for (int k = 0; k < 16; ++k) piece.p[k] = (patch.p[k] - middle) / size;
    divide_patch(piece, {depth, depth}, e.pieces);
  }
  if (!s.open) turn_outwards(e);
  add_element(pool, e, place.to_world * Affine::translation(middle) * Affine::scaling({size, size, size}),
              place);
  for (std::size_t k = 0; k < e.pieces.size(); ++k)
    add_cell(pool, e.pieces[k].lo, e.pieces[k].hi).begin = static_cast<std::uint32_t>(k);
}

int BezierPatch::first_of(const BezierPatchElement& e, std::size_t piece, const Vec3d& o, const Vec3d& d,
                          double begin, int room, double* t, double* turn, double& up_to) {
  return first_crossings_of(e, piece, o, d, begin, room, t, turn, up_to);
}

UvPoint BezierPatch::point(const BezierPatchElement& e, std::size_t piece, double u, double v) {
  const PatchPiece& part = e.pieces[piece];
  const double wide = part.box.u1 - part.box.u0, high = part.box.v1 - part.box.v0;
  const UvFrame f = bicubic_at(part.p, (u - part.box.u0) / wide, (v - part.box.v0) / high);
  UvPoint at{f.p, f.by_u / wide, f.by_v / high, {u, v}, {}, {}};
  set_texture(e.uv, u, v, at);
  return at;
}

}  // namespace oktett
