#pragma once
/// \file Rays through places of the film.

#include <cstdint>

#include "core/isa.h"
#include "core/ray.h"
#include "core/vec3.h"
#include "render/scene.h"

namespace oktett {

/// The pixels of the full frame that are rendered: [x0, x1) x [y0, y1). Never empty.
struct PixelWindow {
  std::uint32_t x0 = 0, y0 = 0, x1 = 1, y1 = 1;
  std::uint32_t width() const { return x1 - x0; }
  std::uint32_t height() const { return y1 - y0; }
};

/// The window that a film's crop fractions name. Fractions are rounded up to whole pixels at both ends, so
/// windows that share a fraction tile the frame without gap or overlap; a window that would be empty is made
/// one pixel wide.
PixelWindow crop_window(const Film& film);

/// A camera with all that its rays have in common. A film point (x, y) counts pixels of the full frame from
/// its upper left corner; v(x, y) = corner + x per_pixel_x + y per_pixel_y. A perspective ray starts at
/// `origin` in the direction v(x, y); an orthographic one starts at origin + v(x, y) in the direction
/// `forward`. With a lens, the ray starts at a point of a disk about that origin, across the view axis, and
/// meets the ray of the pinhole at the distance `focus` along the axis (Cook, Porter, Carpenter 1984). Of a
/// camera with a frame, `right` and `up` may be left-handed, and v(x, y) may be sheared.
struct CameraFrame {
  Projection projection = Projection::perspective;
  Vec3d origin;
  Vec3d right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< orthonormal
  Vec3d corner, per_pixel_x, per_pixel_y;
  double pixel_size =
      0;  ///< height of a pixel in world units: at distance 1 (perspective), everywhere (orthographic)
  double lens_radius = 0;  ///< 0: a pinhole
  double focus = 1;        ///< along the view axis
};

/// The frame of a camera. An `up` along the view axis, or a view direction of zero, is replaced by a valid
/// one.
CameraFrame camera_frame(const Camera& camera, const Film& film);

/// After `before` got another `from`, `at`, `up`, `fov` or `height` and became `after`: turns and widens its
/// frame, if it has one, so that a mirrored picture stays mirrored.
void carry_frame(const Camera& before, Camera& after);

/// Film points, in columns of the same size.
struct FilmPoints {
  const Column<double>& x;
  const Column<double>& y;
  /// Points of the unit square, which is laid over the lens. Needed if there is a lens.
  const Column<double>* lens_x = nullptr;
  const Column<double>* lens_y = nullptr;
};

/// Sets `rays`, which has the size of the points, to the rays through them: the bits that camera_ray gives.
void camera_rays(const CameraFrame& camera, const FilmPoints& points, RayBatch& rays,
                 Isa isa = default_isa());

/// The ray through a film point, of unit direction, from the middle of the lens.
Ray camera_ray(const CameraFrame& camera, double x, double y);
/// The same from the point of the lens where the point (u, v) of the unit square lies.
Ray camera_ray(const CameraFrame& camera, double x, double y, double u, double v);

/// Distance of `p` in front of the camera along its view axis.
double camera_depth(const CameraFrame& camera, const Vec3f& p);

/// The footprint of a pixel on the plane through `p` with the normal `n`, where `ray` is a camera ray that
/// hits `p`: `dx` leads from `p` to where the ray one pixel to the right meets the plane, `dy` to where the
/// ray one pixel down does. Zero for a ray that does not meet it.
void pixel_footprint(const CameraFrame& camera, const Ray& ray, const Vec3f& p, const Vec3f& n, Vec3f& dx,
                     Vec3f& dy);

}  // namespace oktett
