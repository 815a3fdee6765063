#include "render/look/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {
namespace {

constexpr std::uint32_t kWidth = 512, kHeight = 256;

/// 0 below `lo`, 1 above `hi`, and a smooth cubic between.
double smooth_step(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A rectangle of light with soft edges.
struct SoftBox {
  double azimuth, elevation;  ///< degrees of its middle: to the right of the viewer's back, above the horizon
  double half_width, half_height;  ///< tangents of the angles at which its edges are
  Vec3d radiance;

  Vec3d towards(const Vec3d& d) const {
    const double a = azimuth * kDegree, e = elevation * kDegree;
    const double ce = portable::cos(e), se = portable::sin(e), ca = portable::cos(a), sa = portable::sin(a);
    // In the studio's frame: x to the right, y up, z back.
    const Vec3d axis{ce * sa, se, ce * ca}, across{ca, 0, -sa}, along{-se * sa, ce, -se * ca};
    const double depth = dot(d, axis);
    if (!(depth > 0)) return {};
    const double x = std::abs(dot(d, across)) / depth, y = std::abs(dot(d, along)) / depth;
    constexpr double kSoft = 0.75;  // the part of the box that is bright throughout
    return radiance * (smooth_step(half_width, kSoft * half_width, x) *
                       smooth_step(half_height, kSoft * half_height, y));
  }
};

constexpr SoftBox kBoxes[] = {{-52, 42, 0.50, 0.50, {10.0, 9.5, 8.9}},  // key
                              {75, 22, 0.40, 0.60, {0.8, 0.95, 1.15}},  // fill
                              {0, 88, 0.70, 0.50, {1.0, 1.0, 1.0}},     // above
                              {150, 36, 0.60, 0.20, {3.6, 3.8, 4.1}}};  // behind, for the outline

/// The backdrop in units of the horizon's radiance, by the sine of the elevation.
double backdrop(double up) { return 1 - 0.8 * smooth_step(0, 0.55, up); }

Vec3d boxes(const Vec3d& d) {
  Vec3d sum;
  for (const SoftBox& box : kBoxes) sum = sum + box.towards(d);
  return sum;
}

/// The direction of a pixel in the studio's frame.
Vec3d pixel_direction(const StudioFrame& frame, std::size_t pixel) {
  const double u = (static_cast<double>(pixel % kWidth) + 0.5) / kWidth;
  const double v = (static_cast<double>(pixel / kWidth) + 0.5) / kHeight;
  const Vec3d world(environment_direction(u, v));
  return {dot(world, frame.right), dot(world, frame.up), dot(world, frame.back)};
}

EnvironmentPicture empty_picture() {
  EnvironmentPicture picture;
  picture.width = kWidth, picture.height = kHeight;
  picture.pixels.resize(std::size_t{kWidth} * kHeight);
  return picture;
}

}  // namespace

EnvironmentPicture studio_picture(const StudioFrame& frame, double ground, double horizon) {
  EnvironmentPicture picture = empty_picture();
  std::vector<Vec3d> box_light(picture.pixels.size());
  std::vector<double> ups(picture.pixels.size());
  // The irradiance of the ground, from the boxes and from the backdrop.
  Vec3d from_boxes;
  double from_backdrop = 0;
  for (std::size_t i = 0; i < box_light.size(); ++i) {
    const Vec3d d = pixel_direction(frame, i);
    ups[i] = d.y;
    if (!(d.y > 0)) continue;
    box_light[i] = boxes(d);
    const double v = (static_cast<double>(i / kWidth) + 0.5) / kHeight;
    const double part = d.y * portable::sin(std::numbers::pi * v) * (2 * std::numbers::pi / kWidth) *
                        (std::numbers::pi / kHeight);
    from_boxes += box_light[i] * part;
    from_backdrop += backdrop(d.y) * part;
  }
  // In each channel wall = ground / pi * (scale * from_boxes + wall * from_backdrop), and `horizon` on
  // average.
  const double mean = (from_boxes.x + from_boxes.y + from_boxes.z) / 3;
  const Vec3d wall = from_boxes * (horizon / mean);
  const double scale = horizon * (std::numbers::pi / ground - from_backdrop) / mean;
  for (std::size_t i = 0; i < box_light.size(); ++i)
    picture.pixels[i] = Color(box_light[i] * scale + wall * backdrop(std::max(ups[i], 0.0)));
  return picture;
}

EnvironmentPicture overcast_picture(const StudioFrame& frame) {
  EnvironmentPicture picture = empty_picture();
  const Color horizon{1.5f, 1.55f, 1.6f}, zenith{0.75f, 1.0f, 1.4f};
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const auto part = static_cast<float>(smooth_step(0, 0.9, pixel_direction(frame, i).y));
    picture.pixels[i] = horizon * (1 - part) + zenith * part;
  }
  return picture;
}

}  // namespace oktett
