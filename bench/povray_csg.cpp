#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/bench_object.h"
#include "bench/povray_scene.h"
#include "verify/oracles/exact_families.h"

namespace oktett::bench {

namespace {

Object operand(Shape shape) { return make_object(std::move(shape), kNoId); }

CsgShape combine(CsgOp op, std::vector<Object> operands) {
  return {op, std::make_shared<const std::vector<Object>>(std::move(operands))};
}

constexpr int kHolesX = 25, kHolesZ = 40;
constexpr double kPlate = 1.3, kHoleRadius = 0.02;

double hole_place(int i, int count) { return ((2 * i + 1) / static_cast<double>(count) - 1) * kPlate; }

}  // namespace

FieldObject rounded_cube(const double (&)[6]) {
  FieldObject object{"difference { intersection { box { -0.75, 0.75 } sphere { 0, 1 } }", {}, {}};
  std::vector<Object> operands{
      operand(combine(CsgOp::intersect, {operand(BoxShape{{-0.75, -0.75, -0.75}, {0.75, 0.75, 0.75}}),
                                         operand(SphereShape{})}))};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d end{0, 0, 0};
    end[axis] = 1.1;
    operands.push_back(operand(ExactShape{CylinderShape{-end, end, 0.45}}));
    object.pov += fmt::format(" cylinder {{ -1.1*{0}, 1.1*{0}, 0.45 }}", "xyz"[axis]);
  }
  object.pov += " }";
  object.shape = combine(CsgOp::subtract, std::move(operands));
  object.f = [](const Vec3l& p) {
    long double f = std::max(outside({-0.75, -0.75, -0.75}, {0.75, 0.75, 0.75}, p), std::sqrt(dot(p, p)) - 1);
    for (int axis = 0; axis < 3; ++axis) {
      const long double x = p[(axis + 1) % 3], y = p[(axis + 2) % 3];
      f = std::max(f, 0.45L - std::hypot(x, y));
    }
    return f;
  };
  return object;
}

FieldObject drilled_plate(const double (&)[6]) {
  FieldObject object{
      fmt::format("difference {{ box {{ <-{0}, -0.2, -{0}>, <{0}, 0.2, {0}> }}", kPlate), {}, {}};
  std::vector<Object> operands{operand(BoxShape{{-kPlate, -0.2, -kPlate}, {kPlate, 0.2, kPlate}})};
  for (int i = 0; i < kHolesX; ++i)
    for (int k = 0; k < kHolesZ; ++k) {
      const double x = hole_place(i, kHolesX), z = hole_place(k, kHolesZ);
      operands.push_back(operand(ExactShape{CylinderShape{{x, -0.3, z}, {x, 0.3, z}, kHoleRadius}}));
      object.pov += fmt::format(" cylinder {{ <{0}, -0.3, {1}>, <{0}, 0.3, {1}>, {2} }}", x, z, kHoleRadius);
    }
  object.pov += " }";
  object.shape = combine(CsgOp::subtract, std::move(operands));
  object.f = [](const Vec3l& p) {
    // The nearest hole is that of the cell around the point.
    const auto nearest = [](long double x, int count) {
      const auto cell = static_cast<int>(std::floor((x / kPlate + 1) / 2 * count));
      return x - hole_place(std::clamp(cell, 0, count - 1), count);
    };
    const long double d = std::hypot(nearest(p.x, kHolesX), nearest(p.z, kHolesZ));
    return std::max(outside({-kPlate, -0.2, -kPlate}, {kPlate, 0.2, kPlate}, p), kHoleRadius - d);
  };
  return object;
}

}  // namespace oktett::bench
