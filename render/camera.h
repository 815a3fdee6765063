#pragma once
/// \file From places on the film to rays.

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

/// A camera ready to make rays. The film point (x, y) counts in pixels of the full frame from its upper left
/// corner. A film point's ray passes through origin + (x * per_pixel_x + y * per_pixel_y) + corner: for
/// perspective that is a direction at distance 1 along the view axis, for orthographic views an offset of the
/// ray's origin.
struct CameraFrame {
  Projection projection = Projection::perspective;
  Vec3d origin;
  Vec3d right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< orthonormal
  Vec3d corner, per_pixel_x, per_pixel_y;
  double pixel_size =
      0;  ///< height of a pixel: at distance 1 (perspective), or in world units (orthographic)
};

/// Any camera gives a frame: an `up` along the view axis or a zero view direction is replaced by some valid
/// choice.
CameraFrame camera_frame(const Camera& camera, const Film& film);

/// Film points and the rays through them, in columns of equal length.
struct FilmPoints {
  const Column<double>& x;
  const Column<double>& y;
};

/// The rays through all `points`, each the same bits as `camera_ray` gives. `rays` has their size.
void camera_rays(const CameraFrame& camera, const FilmPoints& points, Isa isa, RayBatch& rays);

/// The ray through a film point, of unit direction.
Ray camera_ray(const CameraFrame& camera, double x, double y);

/// Distance of `p` in front of the camera along its view axis.
double camera_depth(const CameraFrame& camera, const Vec3f& p);

/// Where the rays through the film points one pixel to the right and one down, relative to that of `ray`,
/// meet the plane through `p` with normal `n`, as vectors from `p`: the footprint of a pixel. `ray` is a
/// camera ray that hits `p`. Zero where such a ray does not meet the plane.
void pixel_footprint(const CameraFrame& camera, const Ray& ray, const Vec3f& p, const Vec3f& n, Vec3f& dx,
                     Vec3f& dy);

}  // namespace oktett
