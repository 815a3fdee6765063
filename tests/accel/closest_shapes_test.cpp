#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "accel/point_query.h"
#include "core/error.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::closest_shapes_test {
namespace {

template <class Shape>
Geometry geometry(Shape shape) {
  Geometry g;
  g.shape = std::move(shape);
  return g;
}

/// A surface in its own space: points on it, drawn at random, and how far a point is from satisfying its
/// equation.
struct Sampled {
  const char* name;
  Geometry geometry;
  std::function<Vec3d(CaseRandom&)> draw;
  std::function<double(const Vec3d&)> off;
  std::vector<Vec3d> special = {};  ///< points with many nearest ones
};

double radius_of(const Vec3d& p) { return std::sqrt(p.x * p.x + p.y * p.y); }

/// On the box of half-lengths `h`: 0.
double off_box(const Vec3d& p, const Vec3d& h) {
  const Vec3d d = abs(p) - h;
  return length(max(d, Vec3d{0, 0, 0})) + std::min(max_component(d), 0.0);
}

Vec3d on_sphere(CaseRandom& r) {
  const double z = r.sign(), angle = std::numbers::pi * r.sign(), rho = std::sqrt(1 - z * z);
  return {rho * std::cos(angle), rho * std::sin(angle), z};
}

/// A point of a disk about the z axis, often on its edge.
Vec3d on_disk(CaseRandom& r, double radius, double z) {
  const double rho = r.unit() < 0.1 ? radius : radius * std::sqrt(r.unit()),
               angle = std::numbers::pi * r.sign();
  return {rho * std::cos(angle), rho * std::sin(angle), z};
}

/// A frustum about the z axis from radius a at z = -h to radius b at h.
Sampled frustum(const char* name, const ExactForm& form, double a, double b, double h, bool open) {
  Sampled s{
      name, geometry(ExactShape{form}), {}, {}, {{0, 0, 0}, {0, 0, h}, {0, 0, 3 * h}, {0, 0, -0.3 * h}}};
  s.draw = [=](CaseRandom& r) {
    const double part = r.unit();
    if (!open && part < 0.2) return on_disk(r, a, -h);
    if (!open && part < 0.4) return on_disk(r, b, h);
    const double z = h * r.sign(), rho = 0.5 * (a + b) + 0.5 * (b - a) * z / h,
                 angle = std::numbers::pi * r.sign();
    return Vec3d{rho * std::cos(angle), rho * std::sin(angle), z};
  };
  s.off = [=](const Vec3d& p) {
    const double rho = radius_of(p), z = p.z;
    const double beyond = std::max(std::abs(z) - h, 0.0);
    const double side = std::abs(rho - (0.5 * (a + b) + 0.5 * (b - a) * z / h)) + beyond;
    if (open) return side;
    const double low = std::abs(z + h) + std::max(rho - a, 0.0),
                 high = std::abs(z - h) + std::max(rho - b, 0.0);
    return std::min({side, low, high});
  };
  return s;
}

Sampled torus(const char* name, double major, double minor) {
  Sampled s{name,
            geometry(ExactShape{TorusShape{major, minor}}),
            {},
            {},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, -5}, {major, 0, 0}, {0, -major, 0}}};
  s.draw = [=](CaseRandom& r) {
    for (;;) {
      const double around = std::numbers::pi * r.sign(), tube = std::numbers::pi * r.sign(),
                   rho = major + minor * std::cos(tube);
      // What meets itself is cut off at the axis.
      if (rho >= 0) return Vec3d{rho * std::cos(around), rho * std::sin(around), minor * std::sin(tube)};
    }
  };
  s.off = [=](const Vec3d& p) { return std::abs(std::hypot(radius_of(p) - major, p.z) - minor); };
  return s;
}

/// The circles of an ovus, each as far as the others do not hide it: points of one that are inside of the egg
/// are drawn again.
Sampled ovus(const char* name, double bottom, double top) {
  const double arc = 2 * std::max(bottom, top), low = arc - bottom, high = arc - top;
  const double y = (low * low - high * high + bottom * bottom) / (2 * bottom),
               x = std::sqrt(low * low - y * y);
  // How far a point is from the egg's circles in its half-plane. The lines from the centre of the arc through
  // those of the balls part them.
  const auto off = [=](double rho, double h) {
    const double from_arc = std::hypot(rho + x, h - y);
    if ((h - y) * x < -y * (rho + x)) return std::hypot(rho, h) - bottom;
    if ((h - y) * x > (bottom - y) * (rho + x)) return std::hypot(rho, h - bottom) - top;
    return from_arc - arc;
  };
  Sampled s{name,
            geometry(ExactShape{OvusShape{bottom, top}}),
            {},
            {},
            {{0, 0, 0}, {0, bottom, 0}, {0, 0.5 * bottom, 0}, {0, 9, 0}, {0, -9, 0}}};
  s.draw = [=](CaseRandom& r) {
    for (;;) {
      const double part = r.unit() * 3, angle = std::numbers::pi * r.sign(),
                   around = std::numbers::pi * r.sign();
      double rho = std::cos(angle), h = std::sin(angle);
      if (part < 1)
        rho *= bottom, h *= bottom;
      else if (part < 2)
        rho *= top, h = bottom + top * h;
      else
        rho = arc * rho - x, h = y + arc * h;
      if (rho >= 0 && std::abs(off(rho, h)) < 1e-12)
        return Vec3d{rho * std::cos(around), h, rho * std::sin(around)};
    }
  };
  s.off = [=](const Vec3d& p) { return off(std::hypot(p.x, p.z), p.y); };
  return s;
}

/// A part of a profile that turns about the y axis: radius and height, 0 <= u <= 1.
using ProfilePart = std::function<ProfilePoint(double)>;

ProfilePart straight(const ProfilePoint& a, const ProfilePoint& b) {
  return [=](double u) {
    return ProfilePoint{a.radius + u * (b.radius - a.radius), a.height + u * (b.height - a.height)};
  };
}

ProfilePart bezier(const std::vector<ProfilePoint>& p, std::size_t first) {
  return [=](double u) {
    const double w = 1 - u, b[4] = {w * w * w, 3 * w * w * u, 3 * w * u * u, u * u * u};
    ProfilePoint at{0, 0};
    for (std::size_t k = 0; k < 4; ++k)
      at.radius += b[k] * p[first + k].radius, at.height += b[k] * p[first + k].height;
    return at;
  };
}

/// Between two of four points f as a function of the height, with the slopes of the chords past each; f is
/// the radius, or its square as POV-Ray has it.
ProfilePart cubic(const std::vector<ProfilePoint>& p, std::size_t k, bool squared) {
  const auto slope = [&](std::size_t i) {
    const double s = (p[i + 1].radius - p[i - 1].radius) / (p[i + 1].height - p[i - 1].height);
    return squared ? 2 * p[i].radius * s : s;
  };
  const auto f = [&](std::size_t i) { return squared ? p[i].radius * p[i].radius : p[i].radius; };
  const double y0 = p[k].height, h = p[k + 1].height - y0, f0 = f(k), f1 = f(k + 1);
  const double d0 = h * slope(k), d1 = h * slope(k + 1);
  return [=](double u) {
    const double value = f0 + u * (d0 + u * (3 * (f1 - f0) - 2 * d0 - d1 + u * (2 * (f0 - f1) + d0 + d1)));
    return ProfilePoint{squared ? std::sqrt(std::max(value, 0.0)) : value, y0 + u * h};
  };
}

/// What is off of a profile is measured from chords of it.
Sampled turned(const char* name, Geometry g, const std::vector<ProfilePart>& parts) {
  constexpr int kChords = 3000;
  const auto chords = std::make_shared<std::vector<std::array<ProfilePoint, 2>>>();
  for (const ProfilePart& part : parts)
    for (int i = 0; i < kChords; ++i)
      // Finer towards the ends, where the curve may be upright on the axis.
      chords->push_back({part(0.5 - 0.5 * std::cos(std::numbers::pi * i / kChords)),
                         part(0.5 - 0.5 * std::cos(std::numbers::pi * (i + 1) / kChords))});
  Sampled s{name, std::move(g), {}, {}, {{0, 0, 0}, {0, 0.3, 0}, {0, 9, 0}, {0, -9, 0}, {0.5, 0, 0}}};
  s.draw = [=](CaseRandom& r) {
    const auto part =
        std::min(parts.size() - 1, static_cast<std::size_t>(r.unit() * static_cast<double>(parts.size())));
    const ProfilePoint p = parts[part](r.unit() < 0.1 ? std::round(r.unit()) : r.unit());
    const double around = std::numbers::pi * r.sign();
    return Vec3d{p.radius * std::cos(around), p.height, p.radius * std::sin(around)};
  };
  s.off = [=](const Vec3d& p) {
    const double rho = std::hypot(p.x, p.z);
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : *chords) {
      const double x = b.radius - a.radius, y = b.height - a.height, l2 = x * x + y * y;
      const double fx = rho - a.radius, fy = p.y - a.height;
      const double t = l2 > 0 ? std::clamp((fx * x + fy * y) / l2, 0.0, 1.0) : 0.0;
      least = std::min(least, std::hypot(fx - t * x, fy - t * y));
    }
    return least;
  };
  return s;
}

void add_turned(std::vector<Sampled>& all) {
  using Profile = RevolutionShape::Profile;
  const auto revolution = [](const std::vector<ProfilePoint>& points, Profile profile, bool open) {
    return geometry(ExactShape{RevolutionShape{points, profile, open}});
  };
  const std::vector<ProfilePoint> steps{{0.2, -1}, {0.9, -0.3}, {0.5, -0.3}, {0.8, 0.8}};
  all.push_back(
      turned("revolution of lines and a step", revolution(steps, Profile::linear, false),
             {straight(steps[0], steps[1]), straight(steps[1], steps[2]), straight(steps[2], steps[3]),
              straight({0, -1}, steps[0]), straight(steps[3], {0, 0.8})}));
  const std::vector<ProfilePoint> vase{{0.1, -1.6}, {0.9, -1}, {0.3, -0.4}, {1, 0.2}, {0.2, 0.9}, {0.6, 1.5}};
  all.push_back(turned("open revolution of a spline", revolution(vase, Profile::spline, true),
                       {cubic(vase, 1, false), cubic(vase, 2, false), cubic(vase, 3, false)}));
  all.push_back(turned("sor", revolution(vase, Profile::sor, false),
                       {cubic(vase, 1, true), cubic(vase, 2, true), cubic(vase, 3, true),
                        straight({0, -1}, vase[1]), straight(vase[4], {0, 0.9})}));
  // With slopes of 0 where the radius is 0, and others at which the squared radius is greatest inside.
  const std::vector<ProfilePoint> drop{{0.5, -1.5}, {0, -1}, {0.9, -0.2}, {0.9, 0.4}, {0, 1}, {0.4, 1.3}};
  all.push_back(turned("sor from axis to axis", revolution(drop, Profile::sor, true),
                       {cubic(drop, 1, true), cubic(drop, 2, true), cubic(drop, 3, true)}));
  const auto lathe = [](const std::vector<ProfilePoint>& points, bool open) {
    return geometry(ExactShape{LatheShape{points, open}});
  };
  // Back and forth, with a disk at each end.
  const std::vector<ProfilePoint> hook{{0.3, -1},   {1.4, -1},  {1.2, 0.6}, {0.8, 0.2},
                                       {0.5, -0.1}, {0.7, 0.9}, {0.2, 0.8}};
  all.push_back(
      turned("lathe with an overhang", lathe(hook, false),
             {bezier(hook, 0), bezier(hook, 3), straight({0, -1}, hook[0]), straight(hook[6], {0, 0.8})}));
  all.push_back(turned("open lathe from the top", lathe({hook.rbegin(), hook.rend()}, true),
                       {bezier(hook, 0), bezier(hook, 3)}));
  // A ring whose section is a closed curve with a corner, a parabola in it, and a straight piece.
  const ProfilePoint a{0.3, -0.5}, b{1, -0.4}, c{0.9, 0.6};
  const auto between = [](const ProfilePoint& p, const ProfilePoint& q, double u) {
    return straight(p, q)(u);
  };
  const ProfilePoint peak{1.5, 0.2};
  const std::vector<ProfilePoint> ring{a,
                                       between(a, b, 1.0 / 3),
                                       between(a, b, 2.0 / 3),
                                       b,
                                       between(b, peak, 2.0 / 3),
                                       between(c, peak, 2.0 / 3),
                                       c,
                                       {0.2, 1.2},
                                       {0.7, -0.2},
                                       a};
  all.push_back(
      turned("lathe of a ring", lathe(ring, false), {bezier(ring, 0), bezier(ring, 3), bezier(ring, 6)}));
}

std::vector<Sampled> surfaces() {
  std::vector<Sampled> all;
  all.push_back({"sphere",
                 geometry(SpheresShape{{{{0, 0, 0}, 1}}}),
                 on_sphere,
                 [](const Vec3d& p) { return length(p) - 1; },
                 {{0, 0, 0}}});
  const Vec3d h{1, 0.5, 2};
  all.push_back({"box",
                 geometry(BoxShape{-h, h}),
                 [h](CaseRandom& r) {
                   Vec3d p = r.vector() * h;
                   const int axis = static_cast<int>(r.unit() * 3);
                   p[axis] = r.sign() < 0 ? -h[axis] : h[axis];
                   return p;
                 },
                 [h](const Vec3d& p) { return off_box(p, h); },
                 {{0, 0, 0}, {0, 0, 1.5}, {0.5, 0, 0}}});
  const Vec3d c{0.7, 0.1, 0.9};
  all.push_back({"box beside the origin", geometry(BoxShape{c - h, c + h}),
                 [h, c](CaseRandom& r) {
                   Vec3d p = r.vector() * h;
                   const int axis = static_cast<int>(r.unit() * 3);
                   p[axis] = r.sign() < 0 ? -h[axis] : h[axis];
                   return c + p;
                 },
                 [h, c](const Vec3d& p) { return off_box(p - c, h); }});
  all.push_back({"plane", geometry(PlaneShape{{0, 0, 2}, 0.25}),
                 [](CaseRandom& r) {
                   return Vec3d{4 * r.sign(), 4 * r.sign(), 0.25};
                 },
                 [](const Vec3d& p) { return p.z - 0.25; }});
  all.push_back({"disk",
                 geometry(DiskShape{{0, 0, 0}, {0, 0, 3}, 1}),
                 [](CaseRandom& r) { return on_disk(r, 1, 0); },
                 [](const Vec3d& p) { return std::abs(p.z) + std::max(radius_of(p) - 1, 0.0); },
                 {{0, 0, 0}, {0, 0, 1}}});
  // An L, which is not convex.
  const std::vector<Vec3d> corners{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  all.push_back({"polygon",
                 geometry(PolygonShape{corners}),
                 [](CaseRandom& r) {
                   const double x = r.unit(), y = r.unit(), part = r.unit() * 3;
                   return Vec3d{x + (part < 1 ? 1 : 0), y + (part > 2 ? 1 : 0), 0};
                 },
                 [](const Vec3d& p) {
                   const auto beyond = [](double x, double end) { return std::max({-x, x - end, 0.0}); };
                   return std::abs(p.z) +
                          std::min(beyond(p.x, 2) + beyond(p.y, 1), beyond(p.x, 1) + beyond(p.y, 2));
                 },
                 {{1.5, 1.5, 0}, {1.5, 1.5, 1}}});
  const Vec3d low{0, 0, -1.5}, high{0, 0, 1.5};
  all.push_back(frustum("cylinder", CylinderShape{low, high, 0.7}, 0.7, 0.7, 1.5, false));
  all.push_back(frustum("open cylinder", CylinderShape{low, high, 0.7, true}, 0.7, 0.7, 1.5, true));
  all.push_back(frustum("cone", ConeShape{low, high, 1, 0}, 1, 0, 1.5, false));
  all.push_back(frustum("frustum", ConeShape{low, high, 0.4, 1.2}, 0.4, 1.2, 1.5, false));
  all.push_back(frustum("open frustum", ConeShape{low, high, 0.4, 1.2, true}, 0.4, 1.2, 1.5, true));
  all.push_back(torus("torus", 0.7, 0.3));
  all.push_back(torus("torus that meets itself", 0.5, 0.8));
  all.push_back(ovus("ovus", 1, 0.6));
  all.push_back(ovus("ovus on its tip", 0.8, 1.3));
  all.push_back(ovus("pointed ovus", 1, 0.05));
  add_turned(all);
  return all;
}

/// Rotated, mirrored and scaled; the box and the polygon may also be sheared.
Affine random_map(CaseRandom& r, bool any) {
  const double scale = r.magnitude(-2, 2);
  const Affine turn = Affine::translation(r.vector() * (2 * scale)) * Affine::rotation(r.vector() * 180.0);
  if (!any) return turn * Affine::scaling({scale, scale, -scale});
  return turn * Affine::scaling({scale, 2 * scale, -0.5 * scale}) * Affine::rotation(r.vector() * 180.0);
}

/// A surface under a map as it stands, in an instance, or in an instance of a list.
std::shared_ptr<const Accel> placed(Geometry g, const Affine& m, int how) {
  if (how == 0) {
    g.transform = m;
    return build_accel({g});
  }
  // Half of the map is the instance's.
  g.transform = m;
  const auto child = build_accel({g});
  if (how == 1) return build_accel({{InstanceGeometry{child}, Affine{}, kNoId}});
  InstanceList list{{child}, {{{}, 0, kNoId}}};
  Affine{}.to_rows(list.places[0].to_list);
  return build_accel({{list, {}, kNoId}});
}

/// Points in the cells of a grid, so that most of them need not be looked at.
class SampleGrid {
 public:
  explicit SampleGrid(const std::vector<Vec3d>& samples) : cells_(kSide * kSide * kSide) {
    Vec3d lo = samples[0], hi = samples[0];
    for (const Vec3d& p : samples) lo = min(p, lo), hi = max(p, hi);
    for (const Vec3d& p : samples) {
      int index = 0;
      for (int k = 0; k < 3; ++k) {
        const double extent = std::max(hi[k] - lo[k], 1e-300);
        index = index * kSide + std::min(kSide - 1, static_cast<int>((p[k] - lo[k]) / extent * kSide));
      }
      Cell& cell = cells_[static_cast<std::size_t>(index)];
      if (cell.points.empty()) cell.lo = cell.hi = p;
      cell.lo = min(p, cell.lo), cell.hi = max(p, cell.hi);
      cell.points.push_back(p);
    }
    std::erase_if(cells_, [](const Cell& c) { return c.points.empty(); });
  }

  /// The least distance of p from a sample.
  double distance(const Vec3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Cell& cell : cells_) {
      const Vec3d gap = max(max(cell.lo - p, p - cell.hi), Vec3d{0, 0, 0});
      if (dot(gap, gap) >= least) continue;
      for (const Vec3d& q : cell.points) least = std::min(least, dot(q - p, q - p));
    }
    return std::sqrt(least);
  }

 private:
  static constexpr int kSide = 24;
  struct Cell {
    Vec3d lo, hi;
    std::vector<Vec3d> points;
  };
  std::vector<Cell> cells_;
};

/// The nearest point is on the surface, at the distance that is told, with the normal along the way, and no
/// sample is nearer.
void check_point(const Sampled& s, const Affine& m, const Vec3f& p, const ClosestPoint& c,
                 const SampleGrid& samples) {
  const double scale = length(m.vector({1, 0, 0})), far = length(Vec3d(p)) + scale * 4;
  const Vec3d point(c.point);
  ASSERT_TRUE(c.valid());
  ASSERT_NEAR(length(Vec3d(p) - point), c.distance, 1e-6 * far);
  ASSERT_NEAR(s.off(m.inverse().point(point)) * scale, 0, 4e-6 * far);
  ASSERT_LE(c.distance, samples.distance(Vec3d(p)) * (1 + 1e-7) + 1e-12 * far);
  ASSERT_NEAR(length(c.normal), 1, 1e-6);
}

/// OKTETT_POINT_EFFORT = 1000 makes 10^6 samples and 10^5 points for each shape.
TEST(ClosestShapes, NoSampleIsNearer) {
  const char* wanted = std::getenv("OKTETT_POINT_EFFORT");
  const int effort = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
  for (const Sampled& s : surfaces()) {
    const bool any = std::holds_alternative<BoxShape>(s.geometry.shape) ||
                     std::holds_alternative<PolygonShape>(s.geometry.shape) ||
                     std::holds_alternative<PlaneShape>(s.geometry.shape);
    CaseRandom r(17);
    for (int round = 0; round < 4; ++round) {
      const Affine m = round == 0 ? Affine{} : random_map(r, any && round == 3);
      const auto accel = placed(s.geometry, m, round % 3);
      std::vector<Vec3d> samples;
      for (int i = 0; i < std::max(1000, 1000 * effort); ++i) samples.push_back(m.point(s.draw(r)));
      const SampleGrid grid(samples);
      std::vector<Vec3f> points;
      for (const Vec3d& p : s.special) points.push_back(Vec3f(m.point(p)));
      for (int i = 0; i < 60 + 25 * effort; ++i)
        points.push_back(Vec3f(m.point(r.vector() * (i % 5 == 0 ? 30.0 : 3.0))));
      std::vector<ClosestPoint> found(points.size()), other(points.size());
      closest_point(*accel, points, found, Isa::scalar);
      for (const Isa isa : available_isas()) {
        closest_point(*accel, points, other, isa);
        ASSERT_EQ(found, other) << s.name;
      }
      for (std::size_t i = 0; i < points.size(); ++i) {
        check_point(s, m, points[i], found[i], grid);
        if (HasFatalFailure())
          FAIL() << s.name << ", round " << round << ", point " << i << ": " << points[i].x << " "
                 << points[i].y << " " << points[i].z;
      }
    }
  }
}

// The normal points from the surface to points outside, also where the shape is mirrored or sheared.
TEST(ClosestShapes, NormalsPointOutwards) {
  CaseRandom r(4);
  int solids = 0;
  for (const Sampled& s : surfaces()) {
    if (!inside(*build_accel({s.geometry}), Vec3f(Vec3d{0.6, 0.01, 0.02}))) continue;
    const bool any = std::holds_alternative<BoxShape>(s.geometry.shape);
    for (int round = 0; round < 3; ++round) {
      const Affine m = round == 0 ? Affine{} : random_map(r, any && round == 2);
      const auto accel = placed(s.geometry, m, 0);
      const double size = std::cbrt(std::abs(m.determinant()));
      int checked = 0;
      std::vector<Vec3d> points = s.special;
      for (int i = 0; i < 300; ++i) points.push_back(r.vector() * 2.0);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3f p(m.point(points[i]));
        const ClosestPoint c = closest_point(*accel, p);
        if (c.distance < 1e-4 * size) continue;
        ++checked;
        const float along = dot(p - c.point, c.normal);
        EXPECT_EQ(along > 0, !inside(*accel, p)) << s.name << ", round " << round << ", point " << i;
      }
      EXPECT_GT(checked, 270) << s.name;
    }
    ++solids;
  }
  EXPECT_GE(solids, 5);
}

// Those of an open surface are those that it has closed, also if its profile runs the other way.
TEST(ClosestShapes, OpenSurfacesKeepTheirNormals) {
  const std::vector<ProfilePoint> up{{0.3, -1}, {0.9, -0.8}, {0.8, 0.1}, {0.6, 1}};
  const auto lathe = [](const std::vector<ProfilePoint>& points, bool open) {
    return build_accel({geometry(ExactShape{LatheShape{points, open}})});
  };
  const auto closed = lathe(up, false), open = lathe(up, true), down = lathe({up.rbegin(), up.rend()}, true);
  CaseRandom r(8);
  int checked = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3f p(r.vector() * 1.5);
    const ClosestPoint c = closest_point(*closed, p);
    if (std::abs(std::abs(c.point.y) - 1) < 1e-6) continue;
    ++checked;
    for (const auto& accel : {open, down}) {
      const ClosestPoint o = closest_point(*accel, p);
      EXPECT_NEAR(o.distance, c.distance, 1e-6);
      EXPECT_GT(dot(o.normal, c.normal), 0.999) << i;
    }
  }
  EXPECT_GT(checked, 100);
}

// Of all things in a scene the nearest counts, at equal distance the first.
TEST(ClosestShapes, AmongOthers) {
  std::vector<Geometry> things;
  SpheresShape spheres;
  CaseRandom r(5);
  for (int i = 0; i < 300; ++i) spheres.spheres.push_back({r.vector() * 10.0, 0.1 + 0.4 * r.unit()});
  spheres.spheres.push_back(spheres.spheres[7]);
  things.push_back({spheres, {}, kNoId});
  for (int i = 0; i < 100; ++i)
    things.push_back({ExactShape{TorusShape{0.5, 0.2}},
                      Affine::translation(r.vector() * 10.0) * Affine::rotation(r.vector() * 90.0), kNoId});
  for (int i = 0; i < 100; ++i)
    things.push_back(
        {BoxShape{{-0.3, -0.2, -0.1}, {0.3, 0.2, 0.1}}, Affine::translation(r.vector() * 10.0), kNoId});
  std::vector<std::shared_ptr<const Accel>> alone;
  for (const Geometry& g : things) alone.push_back(build_accel({g}));
  const auto accel = build_accel(things);
  things.push_back({PlaneShape{{0, 1, 0}, -9}, {}, kNoId});
  const auto with_plane = build_accel(things);
  for (int i = 0; i < 500; ++i) {
    const Vec3f p = Vec3f(r.vector() * 12.0);
    ClosestPoint best;
    std::uint32_t first_item = 0;
    for (std::size_t g = 0; g < alone.size(); ++g) {
      ClosestPoint c = closest_point(*alone[g], p);
      c.item += first_item;
      if (c.distance < best.distance) best = c;
      first_item += g == 0 ? 301 : 1;
    }
    for (const Isa isa : available_isas()) {
      EXPECT_EQ(closest_point(*accel, p, isa), best);
      const float height = std::abs(p.y + 9);
      const ClosestPoint c = closest_point(*with_plane, p, isa);
      EXPECT_EQ(c.distance, std::min(best.distance, height));
      EXPECT_TRUE(height >= best.distance || c.item == first_item);
    }
  }
}

std::string error_of(const std::vector<Geometry>& things) {
  const auto accel = build_accel(things);
  try {
    closest_point(*accel, {0, 0, 0});
  } catch (const Error& e) {
    EXPECT_THROW(signed_distance(*accel, {0, 0, 0}), Error);
    return e.what();
  }
  return "";
}

// What does not tell its nearest points is named, also inside instances; rays and inside() still work.
TEST(ClosestShapes, WhatDoesNotTellIsAnError) {
  const std::string others =
      " has no nearest points; these have: mesh, sphere, plane, disk, box, polygon, torus, ovus, cylinder, "
      "cone, "
      "revolution, lathe, prism. Ask it with rays or with inside()";
  ImplicitShape implicit;
  implicit.function = compile_function("x^2 + y^2 + z^2 - 0.5");
  const Geometry field{ExactShape{implicit}, {}, kNoId};
  EXPECT_EQ(error_of({field}), "closest_point: a surface of kind 'implicit'" + others);
  EXPECT_TRUE(inside(*build_accel({field}), {0, 0, 0}));
  const auto expression = std::make_shared<CsgExpression>();
  expression->solids = {{BoxShape{}, {}, kNoId}};
  const Geometry combination{CsgGeometry{expression}, {}, kNoId};
  EXPECT_EQ(error_of({{InstanceGeometry{build_accel({combination})}, {}, kNoId}}),
            "closest_point: a Boolean combination" + others);

  const Affine stretch = Affine::scaling({1, 2, 1}), turn = Affine::rotation({30, 40, 50});
  const auto distorted = [&](const char* name) {
    return std::string("closest_point: a ") + name + " that its transform distorts" + others;
  };
  const Geometry sphere{SpheresShape{{{{0, 0, 0}, 1}}}, {}, kNoId};
  const Geometry cylinder{ExactShape{CylinderShape{}}, {}, kNoId}, ring{ExactShape{TorusShape{}}, {}, kNoId};
  const auto under = [](Geometry g, const Affine& m) {
    g.transform = m;
    return g;
  };
  const auto shown = [](const Geometry& g, const Affine& m) {
    return Geometry{InstanceGeometry{build_accel({g})}, m, kNoId};
  };
  EXPECT_EQ(error_of({under(sphere, stretch)}), distorted("sphere"));
  EXPECT_EQ(error_of({shown(sphere, stretch)}), distorted("sphere"));
  EXPECT_EQ(error_of({under(ring, stretch)}), distorted("torus"));
  EXPECT_EQ(error_of({under(cylinder, stretch * turn)}), distorted("cylinder"));
  EXPECT_EQ(error_of({shown(shown(cylinder, stretch), turn)}), distorted("cylinder"));
  // Along its axis a cylinder may be stretched; boxes may be sheared.
  EXPECT_EQ(
      error_of({under(cylinder, turn * stretch), shown(under(ring, turn), Affine::scaling({-3, 3, 3}))}), "");
  EXPECT_EQ(error_of({shown({BoxShape{}, turn, kNoId}, stretch)}), "");
}

}  // namespace
}  // namespace oktett::closest_shapes_test
