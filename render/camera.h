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

/// What the rays of a curved projection have in common. With u from -1/2 to 1/2 across the picture, v from
/// -1/2 to 1/2 up, the unit vectors X, Y, Z of the frame's `right`, `up` and `direction`, their lengths w, h
/// and l, and A and B the angles, the ray has the direction
///
/// - fisheye: cos(r A / 2) Z + sin(r A / 2) (2 u w X + 2 v h Y) / r, where r = |(2 u w, 2 v h)| <= 1
/// - ultra_wide_angle: sin a X + sin b Y + cos a cos b Z, where a = u A, b = v A h / w
/// - omnimax: as fisheye, of the angle 1.41127 r - 0.09438 r^3 + 0.25674 r^5 from Z for
///   r = |(2 u s w / h, 2 v s + max(0, 1 - s))| <= 1, where s = max(h / w, 0.77915), above the great circle
///   through X and Z - Y
/// - panoramic: sin(pi u) w X + tan(pi v) h Y + cos(pi u) l Z
/// - cylindrical: sin(u A) X + v h Y + cos(u A) Z, orthographic along the axis without the second term, from
///   v h Y beside the eye; about the axis `right` with X and u in place of Y and v
/// - spherical: Z turned about X by v B towards Y, then about Y by u A towards X
///
/// The vectors need not be perpendicular. These are the cameras of POV-Ray 3.7, found by what its pictures
/// show of a sphere that is coloured by place; the numbers of `omnimax` are fitted to them, with an error of
/// 0.0001.
struct CurvedView {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, -1};   ///< X, Y, Z
  double width = 1, height = 1, distance = 1;  ///< w, h, l
  double angle[2] = {0, 0};                    ///< A, B in radians
  double per_pixel_x = 1, per_pixel_y = 1;     ///< u and v of a pixel, without sign
  double handedness = -1;                      ///< 1 if X, Y, Z are left-handed, else -1; spherical only
  CylinderAxis axis = CylinderAxis::up;
  bool parallel = false;  ///< orthographic along the axis
};

/// What the rays of a camera of meshes have in common.
struct MeshView {
  CameraMeshPointer mesh;
  Vec3d origin;                         ///< where its places count from
  std::uint32_t width = 1, height = 1;  ///< of the film
};

/// A camera with all that its rays have in common. A film point (x, y) counts pixels of the full frame from
/// its upper left corner; v(x, y) = corner + x per_pixel_x + y per_pixel_y. A perspective ray starts at
/// `origin` in the direction v(x, y); an orthographic one starts at origin + v(x, y) in the direction
/// `forward`. With a lens, the ray starts at a point of a disk about that origin, across the view axis, and
/// meets the ray of the pinhole at the distance `focus` along the axis (Cook, Porter, Carpenter 1984). Of a
/// camera with a frame, `right` and `up` may be left-handed, and v(x, y) may be sheared. Curved projections
/// have `curved` or `mesh` instead of v(x, y), and no lens.
struct CameraFrame {
  Projection projection = Projection::perspective;
  Vec3d origin;
  Vec3d right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< orthonormal
  Vec3d corner, per_pixel_x, per_pixel_y;
  double pixel_size = 0;   ///< height of a pixel in world units: at distance 1 (perspective, curved),
                           ///< everywhere (orthographic)
  double lens_radius = 0;  ///< 0: a pinhole
  double focus = 1;        ///< along the view axis
  CurvedView curved{};
  MeshView mesh{};  ///< with Projection::mesh; `origin` is then the middle of the meshes
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

/// The ray through a film point, of unit direction, from the middle of the lens. Where a curved projection
/// has none, as outside the circle of a fisheye, tmax is 0: it hits nothing, see leaves_out().
Ray camera_ray(const CameraFrame& camera, double x, double y);
/// The same from the point of the lens where the point (u, v) of the unit square lies.
Ray camera_ray(const CameraFrame& camera, double x, double y, double u, double v);

/// Whether nothing is seen at the film point of this camera ray: the picture is black there, not covered.
inline bool leaves_out(const Ray& ray) { return !(ray.tmax > ray.tmin); }

/// Distance of `p` in front of the camera along its view axis; of curved projections that from the eye, or
/// from the line that it moves along.
double camera_depth(const CameraFrame& camera, const Vec3f& p);

/// The footprint of a pixel on the plane through `p` with the normal `n`, where `ray` is a camera ray that
/// hits `p`: `dx` leads from `p` to where the ray one pixel to the right meets the plane, `dy` to where the
/// ray one pixel down does. Zero for a ray that does not meet it.
/// Of curved projections, whose pixels have many forms, both have the size of a pixel in the middle of the
/// picture and no certain direction.
void pixel_footprint(const CameraFrame& camera, const Ray& ray, const Vec3f& p, const Vec3f& n, Vec3f& dx,
                     Vec3f& dy);

}  // namespace oktett
