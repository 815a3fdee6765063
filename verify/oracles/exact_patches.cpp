/// \file Bezier patches: heights over a square, and bodies all of whose points are seen from the origin.
/// Where the way from there through a point meets the body is found by Newton's method on polynomials in
/// powers.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "kernels/exact/bezier_patch.h"
#include "verify/oracles/exact_families.h"

namespace oktett {
namespace {

/// A patch in powers of u and v.
template <class R>
struct PowerPatch {
  Vec3<R> c[4][4];  ///< of v^j u^i

  explicit PowerPatch(const BezierPatchPoints& patch) {
    // Bernstein's polynomials of degree 3 in powers.
    constexpr int kPowers[4][4] = {{1, -3, 3, -1}, {0, 3, -6, 3}, {0, 0, 3, -3}, {0, 0, 0, 1}};
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        c[j][i] = {0, 0, 0};
        for (int n = 0; n < 4; ++n)
          for (int m = 0; m < 4; ++m)
            c[j][i] += Vec3<R>(patch.p[4 * n + m]) * static_cast<R>(kPowers[n][j] * kPowers[m][i]);
      }
  }
  void at(R u, R v, Vec3<R>& p, Vec3<R>& by_u, Vec3<R>& by_v) const {
    p = by_u = by_v = {0, 0, 0};
    for (int j = 3; j >= 0; --j) {
      const Vec3<R>(&r)[4] = c[j];
      const Vec3<R> row = ((r[3] * u + r[2]) * u + r[1]) * u + r[0];
      by_v = by_v * v + p, p = p * v + row;
      by_u = by_u * v + ((r[3] * (3 * u) + r[2] * 2) * u + r[1]);
    }
  }
};

/// Where the way from the origin along `way` meets a patch; false if Newton's method does not get there.
template <class R>
bool look_along(const PowerPatch<R>& patch, const Vec3<R>& way, R& u, R& v, R& distance, int steps) {
  Vec3<R> a, b, p, by_u, by_v;
  make_basis(way, a, b);
  R last = HUGE_VAL;
  for (int i = 0; i < steps; ++i) {
    patch.at(u, v, p, by_u, by_v);
    const R f = dot(a, p), g = dot(b, p), fu = dot(a, by_u), fv = dot(a, by_v), gu = dot(b, by_u),
            gv = dot(b, by_v), det = fu * gv - fv * gu;
    if (!(std::abs(det) > 0)) break;
    const R du = (fv * g - gv * f) / det, dv = (gu * f - fu * g) / det;
    u = std::clamp(u + du, R(-0.5), R(1.5)), v = std::clamp(v + dv, R(-0.5), R(1.5));
    last = std::abs(du) + std::abs(dv);
    if (last < R(1e-17)) break;
  }
  patch.at(u, v, p, by_u, by_v);
  distance = dot(way, p);
  const R off = std::max(std::abs(dot(a, p)), std::abs(dot(b, p)));
  return distance > 0 && off < R(1e-12);
}

/// Slices of balls that hold patches, strips of them, and parts of strips.
class PatchSlices {
 public:
  explicit PatchSlices(const std::vector<BezierPatchPoints>& patches) {
    for (const BezierPatchPoints& patch : patches) {
      Group& group = groups_.emplace_back();
      group.all = slice_about(patch);
      for (int i = 0; i < kSide; ++i) {
        const BezierPatchPoints along = part(patch, i);
        group.strips[i].all = slice_about(along);
        for (int j = 0; j < kSide; ++j) group.strips[i].parts[j] = slice_about(part(turned(along), j));
      }
    }
  }
  /// Whether part of a patch may be within `room` of p.
  bool near(const Vec3d& p, double room) const {
    const auto is_near = [&](const Slice& slice) {
      const Vec3d d = p - slice.center;
      return dot(d, d) <= (slice.radius + room) * (slice.radius + room) &&
             std::abs(dot(d, slice.normal)) <= slice.thick + room;
    };
    for (const Group& group : groups_) {
      if (!is_near(group.all)) continue;
      for (const Strip& strip : group.strips)
        if (is_near(strip.all) && std::ranges::any_of(strip.parts, is_near)) return true;
    }
    return false;
  }

 private:
  static constexpr int kSide = 16;
  /// What of a ball is no farther than `thick` from the plane through its middle.
  struct Slice {
    Vec3d center, normal;
    double radius = 0, thick = 0;
  };
  struct Strip {
    Slice all, parts[kSide];
  };
  struct Group {
    Slice all;
    Strip strips[kSide];
  };

  /// A patch lies between its control points.
  static Slice slice_about(const BezierPatchPoints& patch) {
    Slice slice;
    for (const Vec3d& p : patch.p) slice.center += p * (1.0 / 16);
    const Vec3d n = cross(patch.p[15] - patch.p[0], patch.p[12] - patch.p[3]);
    if (dot(n, n) > 0) slice.normal = normalize(n);
    for (const Vec3d& p : patch.p) {
      slice.radius = std::max(slice.radius, length(p - slice.center));
      slice.thick = std::max(slice.thick, std::abs(dot(p - slice.center, slice.normal)));
    }
    const double rounding = 1e-9 * (1 + slice.radius);
    slice.radius += rounding, slice.thick += rounding;
    return slice;
  }
  static BezierPatchPoints turned(const BezierPatchPoints& patch) {
    BezierPatchPoints other;
    for (int k = 0; k < 16; ++k) other.p[k] = patch.p[k % 4 * 4 + k / 4];
    return other;
  }
  /// Number i of the strips along u. Its control points are values of the blossom, k times at `to` and else
  /// at `from`.
  static BezierPatchPoints part(const BezierPatchPoints& patch, int i) {
    const double from = double(i) / kSide, to = double(i + 1) / kSide;
    BezierPatchPoints strip;
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) {
        Vec3d q[4];
        for (int n = 0; n < 4; ++n) q[n] = patch.p[4 * row + n];
        for (int n = 3; n > 0; --n)
          for (int m = 0; m < n; ++m) {
            const double u = n <= k ? to : from;
            q[m] = q[m] * (1 - u) + q[m + 1] * u;
          }
        strip.p[4 * row + k] = q[0];
      }
    return strip;
  }

  std::vector<Group> groups_;
};

/// A body all of whose surface is seen from the origin.
class Star {
 public:
  struct Place {
    int patch = 0;
    double u = 0, v = 0;
  };

  explicit Star(const std::vector<BezierPatchPoints>& patches) {
    for (const BezierPatchPoints& p : patches) rough_.emplace_back(p), exact_.emplace_back(p);
    for (int k = 0; k < static_cast<int>(patches.size()); ++k)
      for (int i = 0; i < kSide * kSide; ++i) {
        const Place place{k, (i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide};
        Vec3d p, by_u, by_v;
        rough_[static_cast<std::size_t>(k)].at(place.u, place.v, p, by_u, by_v);
        const Vec3d n = cross(by_u, by_v);
        least_facing = std::min(least_facing, dot(n, p) / (length(n) * length(p)));
        samples_.push_back({normalize(p), place});
      }
    if (!(least_facing > kFacing)) return;
    for (int bin = 0; bin < 6 * kBins * kBins; ++bin) near_.push_back(nearest(middle_of(bin)));
  }
  /// How much the surface faces the origin at least: the cosine.
  double least_facing = 1;
  static constexpr double kFacing = 0.25;

  /// The distance of the surface along `way`, and where it is.
  Real distance(const Vec3l& way, Place& place, bool roughly) const {
    const Vec3d d{static_cast<double>(way.x), static_cast<double>(way.y), static_cast<double>(way.z)};
    place = near_[static_cast<std::size_t>(bin_of(d))];
    double about;
    if (!try_at(d, place, about)) {
      // Other patches, those with the nearest samples first.
      std::vector<std::pair<double, Place>> others;
      for (const auto& [to, where] : samples_)
        if (dot(to, d) > 0.5) others.push_back({-dot(to, d), where});
      std::sort(others.begin(), others.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [score, where] : others)
        if (place = where; try_at(d, place, about)) break;
    }
    if (roughly) return about;
    Real u = place.u, v = place.v, exact;
    look_along(exact_[static_cast<std::size_t>(place.patch)], way, u, v, exact, 4);
    return exact;
  }

 private:
  static constexpr int kSide = 14, kBins = 24;

  bool try_at(const Vec3d& d, Place& place, double& about) const {
    constexpr double kRoom = 1e-9;
    return look_along(rough_[static_cast<std::size_t>(place.patch)], d, place.u, place.v, about, 24) &&
           place.u > -kRoom && place.u < 1 + kRoom && place.v > -kRoom && place.v < 1 + kRoom;
  }
  Place nearest(const Vec3d& d) const {
    double best = -2;
    Place place;
    for (const auto& [to, where] : samples_)
      if (const double near = dot(to, d); near > best) best = near, place = where;
    return place;
  }
  /// Directions by the faces of a cube.
  static int bin_of(const Vec3d& d) {
    const Vec3d a = abs(d);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const auto cell = [&](double x) {
      return std::clamp(static_cast<int>((x / a[axis] + 1) * 0.5 * kBins), 0, kBins - 1);
    };
    return ((2 * axis + (d[axis] < 0)) * kBins + cell(d[(axis + 2) % 3])) * kBins + cell(d[(axis + 1) % 3]);
  }
  static Vec3d middle_of(int bin) {
    const int face = bin / (kBins * kBins), axis = face / 2;
    Vec3d d;
    d[axis] = face % 2 == 0 ? 1 : -1;
    d[(axis + 1) % 3] = (bin % kBins + 0.5) / kBins * 2 - 1;
    d[(axis + 2) % 3] = (bin / kBins % kBins + 0.5) / kBins * 2 - 1;
    return normalize(d);
  }

  std::vector<PowerPatch<double>> rough_;
  std::vector<PowerPatch<Real>> exact_;
  std::vector<std::pair<Vec3d, Place>> samples_;
  std::vector<Place> near_;
};

/// Control points that several patches share: the same one for the same key.
class SharedPoints {
 public:
  SharedPoints(CaseRandom& random, double rough) : random_(random), rough_(rough) {}
  Vec3d at(std::array<int, 3> key, const Vec3d& p) {
    const auto [found, is_new] = points_.try_emplace(key, p);
    if (is_new) found->second = p * (1 + rough_ * random_.sign()) + random_.vector() * (0.2 * rough_);
    return found->second;
  }

 private:
  CaseRandom& random_;
  double rough_;
  std::map<std::array<int, 3>, Vec3d> points_;
};

/// A cube's six faces, blown up and dented.
std::vector<BezierPatchPoints> ball_of_six(CaseRandom& random, double rough) {
  SharedPoints points(random, rough);
  const double round = 0.6 + 0.4 * random.unit();
  std::vector<BezierPatchPoints> patches;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, sign = face % 2 == 0 ? 1 : -1;
    BezierPatchPoints& patch = patches.emplace_back();
    for (int k = 0; k < 16; ++k) {
      std::array<int, 3> key;
      key[static_cast<std::size_t>(axis)] = 3 * sign;
      key[static_cast<std::size_t>((axis + 1) % 3)] = (2 * (k % 4) - 3) * sign;
      key[static_cast<std::size_t>((axis + 2) % 3)] = 2 * (k / 4) - 3;
      const Vec3d p = Vec3d{1.0 * key[0], 1.0 * key[1], 1.0 * key[2]} / 3;
      patch.p[k] = points.at(key, p * (1 - round) + normalize(p) * (1.3 * round));
    }
  }
  return patches;
}

/// Four patches from the equator to each pole, where their edges are points.
std::vector<BezierPatchPoints> ball_of_eight(CaseRandom& random, double rough) {
  SharedPoints points(random, rough);
  constexpr double c = 0.5522847498;
  constexpr double kRadius[7] = {0, c, 1, 1, 1, c, 0}, kHeight[7] = {-1, -1, -c, 0, c, 1, 1};
  constexpr double kX[12] = {1, 1, c, 0, -c, -1, -1, -1, -c, 0, c, 1};
  std::vector<BezierPatchPoints> patches;
  for (int half = 0; half < 2; ++half)
    for (int quarter = 0; quarter < 4; ++quarter) {
      BezierPatchPoints& patch = patches.emplace_back();
      for (int k = 0; k < 16; ++k) {
        const int around = (3 * quarter + k % 4) % 12, up = 3 * half + k / 4;
        const bool pole = up == 0 || up == 6;
        patch.p[k] = points.at({pole ? 0 : around, up, 0},
                               {kRadius[up] * kX[around], kRadius[up] * kX[(around + 9) % 12], kHeight[up]});
      }
    }
  return patches;
}

template <std::vector<BezierPatchPoints> (*kBall)(CaseRandom&, double)>
std::vector<BezierPatchPoints> draw_ball(CaseRandom& random, std::shared_ptr<const Star>& star) {
  for (double rough = 0.35 * random.unit();; rough *= 0.7) {
    std::vector<BezierPatchPoints> patches = kBall(random, rough);
    star = std::make_shared<const Star>(patches);
    if (star->least_facing > Star::kFacing) return patches;
    if (rough < 1e-6) rough = 0;
  }
}

ExactOracle star_oracle(std::vector<BezierPatchPoints> patches, const std::shared_ptr<const Star>& star) {
  BezierPatchShape s;
  s.open = false;
  const auto f = [star](const Vec3l& p) -> Real {
    const Real away = std::sqrt(dot(p, p));
    if (!(away > 1e-9L)) return -1;
    Star::Place place;
    const Real rough = away - star->distance(p / away, place, true);
    return std::abs(rough) > 1e-6L ? rough : away - star->distance(p / away, place, false);
  };
  s.patches = std::move(patches);
  ExactOracle o{{s}, f};
  o.clear = [slices = PatchSlices(s.patches)](const Vec3d& a, const Vec3d& b) {
    return !slices.near((a + b) * 0.5, length(b - a) * 0.5);
  };
  for (const BezierPatchPoints& patch : s.patches)
    for (const Vec3d& p : patch.p) o.grow(p, 0.01);
  return o;
}

template <std::vector<BezierPatchPoints> (*kBall)(CaseRandom&, double)>
ExactOracle closed_ball(CaseRandom& random) {
  std::shared_ptr<const Star> star;
  std::vector<BezierPatchPoints> patches = draw_ball<kBall>(random, star);
  return star_oracle(std::move(patches), star);
}

/// The upper half of such a ball.
ExactOracle patch_cap(CaseRandom& random) {
  std::shared_ptr<const Star> star;
  std::vector<BezierPatchPoints> patches = draw_ball<ball_of_eight>(random, star);
  ExactOracle o = star_oracle(patches, star);
  BezierPatchShape s;
  s.patches.assign(patches.begin() + 4, patches.end());
  o.shape = {s};
  o.where = [star](const Vec3l& p) -> Real {
    const Real away = std::sqrt(dot(p, p));
    if (!(away > 1e-9L)) return 1;
    Star::Place place;
    star->distance(p / away, place, true);
    return place.patch < 4 ? 1 - place.v : -place.v;
  };
  return o;
}

/// Heights over a square, of one patch or several.
ExactOracle patch_heights(CaseRandom& random) {
  const int columns = 1 + static_cast<int>(random.unit() * 2.5),
            rows = 1 + static_cast<int>(random.unit() * 2.5);
  const double high = random.unit() < 0.2 ? 0 : random.magnitude(-2, 0.3);
  const bool bent = random.unit() < 0.3;
  std::vector<double> z;
  for (int k = 0; k < (3 * columns + 1) * (3 * rows + 1); ++k)
    z.push_back(bent ? high * std::sin(0.9 * k) : high * random.sign());
  const auto height = [=](int i, int j) { return z[static_cast<std::size_t>(i + j * (3 * columns + 1))]; };
  BezierPatchShape s;
  std::vector<PowerPatch<Real>> exact;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      BezierPatchPoints& patch = s.patches.emplace_back();
      for (int k = 0; k < 16; ++k) {
        const int x = 3 * i + k % 4, y = 3 * j + k / 4;
        patch.p[k] = {x / 3.0, y / 3.0, height(x, y)};
      }
      exact.emplace_back(patch);
    }
  const auto f = [=](const Vec3l& p) -> Real {
    const int i = std::clamp(static_cast<int>(std::floor(p.x)), 0, columns - 1),
              j = std::clamp(static_cast<int>(std::floor(p.y)), 0, rows - 1);
    Vec3l at, by_u, by_v;
    exact[static_cast<std::size_t>(i + j * columns)].at(p.x - i, p.y - j, at, by_u, by_v);
    return p.z - at.z;
  };
  ExactOracle o{{s}, f};
  for (const BezierPatchPoints& patch : s.patches)
    for (const Vec3d& p : patch.p) o.grow(p, 0.01);
  o.where = [=](const Vec3l& p) { return std::max({-p.x, -p.y, p.x - columns, p.y - rows}); };
  // Over the patches the height changes no faster than between neighbouring control points, also past edges.
  double by_x = 0, by_y = 0;
  for (const BezierPatchPoints& patch : s.patches)
    for (int k = 0; k < 16; ++k) {
      if (k % 4 > 0) by_x = std::max(by_x, 3 * std::abs(patch.p[k].z - patch.p[k - 1].z));
      if (k / 4 > 0) by_y = std::max(by_y, 3 * std::abs(patch.p[k].z - patch.p[k - 4].z));
    }
  o.clear = [=](const Vec3d& a, const Vec3d& b) {
    const Vec3<Enclosure> way = box_about(a, b);
    if (way.x.hi < 0 || way.x.lo > columns || way.y.hi < 0 || way.y.lo > rows) return true;
    const Vec3d middle = (a + b) * 0.5, half = abs(b - a) * 0.5;
    const Vec3l foot{std::clamp(middle.x, 0.0, double(columns)), std::clamp(middle.y, 0.0, double(rows)),
                     middle.z};
    return std::abs(f(foot)) > (half.z + by_x * half.x + by_y * half.y) * (1 + 1e-12L) + 1e-12L;
  };
  return o;
}

}  // namespace

std::vector<ExactCase> patch_cases() {
  return {{"bezier_patch", patch_heights},
          {"bezier_patch_cap", patch_cap},
          {"bezier_patch_solid", closed_ball<ball_of_six>},
          {"bezier_patch_globe", closed_ball<ball_of_eight>}};
}

}  // namespace oktett
