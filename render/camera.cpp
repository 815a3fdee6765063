#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/camera_mesh.h"
#include "render/sampling/warp.h"

namespace oktett {

static void crop_axis(std::uint32_t size, double from, double to, std::uint32_t& begin, std::uint32_t& end) {
  // Slightly less than the product, so that rounding in the fraction does not add a pixel.
  const auto pixel = [&](double fraction) {
    const double at = std::ceil(fraction * size - 1e-6);
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(size)));
  };
  begin = std::min(pixel(from), size - 1);
  end = std::max(pixel(to), begin + 1);
}

PixelWindow crop_window(const Film& film) {
  PixelWindow w;
  crop_axis(std::max(film.width, 1u), film.crop[0], film.crop[1], w.x0, w.x1);
  crop_axis(std::max(film.height, 1u), film.crop[2], film.crop[3], w.y0, w.y1);
  return w;
}

/// An orthonormal frame that looks from `from` to `at`, whatever the camera says.
static void look_at(const Camera& camera, CameraFrame& frame) {
  const Vec3d view = camera.at - camera.from;
  const double distance = length(view);
  frame.forward = distance > 0 && std::isfinite(distance) ? view / distance : Vec3d{0, 0, -1};
  const Vec3d right = cross(frame.forward, camera.up);
  const double size = length(right);
  if (size > 1e-9 * length(camera.up) && std::isfinite(size)) {
    frame.right = right / size;
  } else {
    Vec3d unused;
    make_basis(frame.forward, frame.right, unused);
  }
  frame.up = cross(frame.right, frame.forward);
}

double ViewFrame::depth() const {
  const auto unit = [](const Vec3d& v) { return normalize(v / max_component(abs(v))); };
  return std::abs(dot(cross(unit(right), unit(up)), unit(direction)));
}

void Camera::set_frame(const ViewFrame& given) {
  frame = given;
  at = from + given.direction, up = given.up;
  height = length(given.up);
  fov = 360 / std::numbers::pi * portable::atan2(height / 2, length(given.direction));
}

/// The rotation that turns the view of one camera into that of another.
static Affine turn_of_view(const Camera& from, const Camera& to) {
  CameraFrame a, b;
  look_at(from, a), look_at(to, b);
  const auto rows = [](const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    return Affine{{{{x.x, x.y, x.z, 0}, {y.x, y.y, y.z, 0}, {z.x, z.y, z.z, 0}}}};
  };
  const Affine to_view = rows(a.right, a.up, a.forward);
  const Affine from_view = rows({b.right.x, b.up.x, b.forward.x}, {b.right.y, b.up.y, b.forward.y},
                                {b.right.z, b.up.z, b.forward.z});
  return from_view * to_view;
}

void carry_frame(const Camera& before, Camera& after) {
  if (!before.frame) return;
  const auto half = [](const Camera& c) { return portable::tan(c.fov * (std::numbers::pi / 360)); };
  const Affine turn = turn_of_view(before, after);
  ViewFrame frame = *before.frame;
  const bool perspective = after.projection == Projection::perspective;
  const double wider = perspective ? half(after) / half(before) : after.height / before.height;
  frame.right = turn.vector(frame.right) * wider, frame.up = turn.vector(frame.up) * wider;
  frame.direction = turn.vector(frame.direction);
  after.frame = frame;
}

/// The parts of a frame that the camera states by vectors, and the height of what is seen, at distance 1 if
/// the camera is a perspective one.
static double set_view(const ViewFrame& view, const Film& film, CameraFrame& frame) {
  const bool perspective = frame.projection == Projection::perspective;
  Vec3d away = normalize(cross(view.right, view.up));
  if (dot(away, view.direction) < 0) away = away * -1.0;
  frame.forward = perspective ? away : normalize(view.direction);
  const auto across = [&](const Vec3d& v, const Vec3d& n) { return v - n * dot(v, n); };
  frame.right = normalize(across(view.right, frame.forward));
  frame.up = normalize(across(across(view.up, frame.forward), frame.right));
  // The plane of the picture lies at distance 1 along the axis.
  const double scale = perspective ? 1 / dot(away, view.direction) : 1;
  const Vec3d right = view.right * scale, up = view.up * scale;
  frame.per_pixel_x = right / std::max(film.width, 1u);
  frame.per_pixel_y = up / -static_cast<double>(std::max(film.height, 1u));
  frame.pixel_size = length(frame.per_pixel_y);
  frame.corner = (up - right) / 2;
  if (perspective) frame.corner += view.direction * scale;
  return length(up);
}

/// `height` is that of what is seen, at distance 1 if the camera is a perspective one.
static void set_lens(const Camera& camera, double height, CameraFrame& frame) {
  frame.focus = camera.focus_at     ? dot(*camera.focus_at - camera.from, frame.forward)
                : camera.focus != 0 ? camera.focus
                                    : length(camera.at - camera.from);
  const bool has_f_number = camera.f_number > 0 && camera.projection == Projection::perspective;
  const double diameter = has_f_number ? kFilmHeight / height / camera.f_number : camera.aperture;
  if (is_curved(camera.projection)) return;
  if (diameter > 0 && std::isfinite(diameter) && frame.focus > 0 && std::isfinite(frame.focus))
    frame.lens_radius = diameter / 2;
}

// ---- Curved projections.

/// The vectors that a curved projection without a frame has, for square pixels in the middle.
static ViewFrame usual_frame(const Camera& camera, const CameraFrame& view, double aspect, double angle) {
  ViewFrame frame{view.right * aspect, view.up, view.forward};
  if (camera.projection != Projection::cylindrical) return frame;
  const bool upright = camera.axis == CylinderAxis::up;
  if (camera.along_axis == Projection::orthographic) {
    frame.right = frame.right * camera.height, frame.up = frame.up * camera.height;
  } else if (upright) {
    frame.up = frame.up * (angle / aspect);
  } else {
    frame.right = frame.right * angle;
  }
  return frame;
}

static void set_curved(const Camera& camera, const Film& film, CameraFrame& frame) {
  const double width = std::max(film.width, 1u), height = std::max(film.height, 1u);
  CurvedView& c = frame.curved;
  const double angle = camera.angle[0] > 0 ? camera.angle[0] : Camera::usual_angle(camera.projection);
  c.angle[0] = angle * kDegree;
  c.angle[1] = (camera.angle[1] > 0 ? camera.angle[1] : angle / 2) * kDegree;
  const ViewFrame view =
      camera.frame ? *camera.frame : usual_frame(camera, frame, width / height, c.angle[0]);
  c.width = length(view.right), c.height = length(view.up), c.distance = length(view.direction);
  c.x = view.right / c.width, c.y = view.up / c.height, c.z = view.direction / c.distance;
  c.handedness = dot(cross(c.y, c.z), c.x) > 0 ? 1 : -1;
  c.axis = camera.axis;
  c.parallel = camera.projection == Projection::cylindrical && camera.along_axis == Projection::orthographic;
  c.per_pixel_x = 1 / width, c.per_pixel_y = 1 / height;
  frame.forward = c.z;
  const auto across = [](const Vec3d& v, const Vec3d& n) { return v - n * dot(v, n); };
  frame.right = normalize(across(c.x, c.z));
  frame.up = normalize(across(across(c.y, c.z), frame.right));
  const auto way = [&](double x, double y) {
    return Vec3d(camera_ray(frame, width / 2 + x, height / 2 + y).direction);
  };
  frame.pixel_size = std::max(length(way(0.5, 0) - way(-0.5, 0)), length(way(0, 0.5) - way(0, -0.5)));
  if (!std::isfinite(frame.pixel_size)) frame.pixel_size = 0;
}

CameraFrame camera_frame(const Camera& camera, const Film& film) {
  CameraFrame frame;
  frame.projection = camera.projection;
  frame.origin = camera.from;
  if (camera.projection == Projection::mesh) {
    look_at(camera, frame);
    frame.mesh = {camera.mesh, camera.mesh_origin, std::max(film.width, 1u), std::max(film.height, 1u)};
    return frame;
  }
  if (is_curved(camera.projection)) {
    look_at(camera, frame);
    set_curved(camera, film, frame);
    return frame;
  }
  if (camera.frame) {
    set_lens(camera, set_view(*camera.frame, film, frame), frame);
    return frame;
  }
  look_at(camera, frame);
  const bool perspective = camera.projection == Projection::perspective;
  const double height =
      perspective ? 2 * portable::tan(camera.fov * (std::numbers::pi / 360)) : camera.height;
  const double width_in_pixels = std::max(film.width, 1u), height_in_pixels = std::max(film.height, 1u);
  frame.pixel_size = height / height_in_pixels;
  frame.per_pixel_x = frame.right * frame.pixel_size;
  frame.per_pixel_y = frame.up * -frame.pixel_size;
  frame.corner = frame.per_pixel_x * (-width_in_pixels / 2) + frame.per_pixel_y * (-height_in_pixels / 2);
  if (perspective) frame.corner += frame.forward;
  set_lens(camera, height, frame);
  return frame;
}

/// `v` turned about the unit vector `axis`, from `axis` x v counted.
static Vec3d turned(const Vec3d& v, const Vec3d& axis, double angle) {
  const Vec3d along = axis * dot(v, axis);
  return along + (v - along) * portable::cos(angle) + cross(axis, v) * portable::sin(angle);
}

/// The directions of curved projections by CurvedView; zero where there is none. Those of cylinders move
/// `origin`.
static Vec3d curved_direction(const CurvedView& c, Projection projection, double u, double v, Vec3d& origin) {
  using portable::cos, portable::sin, portable::tan;
  /// At the angle `from_axis` from Z, towards (x, y).
  const auto dome = [&](double x, double y, double r, double from_axis) {
    if (r == 0) return c.z;
    const double sine = sin(from_axis) / r;
    return c.z * cos(from_axis) + c.x * (sine * x) + c.y * (sine * y);
  };
  switch (projection) {
    case Projection::fisheye: {
      const double x = 2 * u * c.width, y = 2 * v * c.height, r = std::sqrt(x * x + y * y);
      return r <= 1 ? dome(x, y, r, r * c.angle[0] / 2) : Vec3d{0, 0, 0};
    }
    case Projection::ultra_wide_angle: {
      const double a = u * c.angle[0], b = v * c.angle[0] * (c.height / c.width);
      return c.x * sin(a) + c.y * sin(b) + c.z * (cos(a) * cos(b));
    }
    case Projection::omnimax: {
      // The width of the picture over its height at which it begins to lose a part of the dome.
      constexpr double kWidest = 1 / 0.77915;
      const double form = c.width / c.height, scale = 1 / std::min(form, kWidest);
      const double x = 2 * u * scale * form, y = 2 * v * scale + std::max(0.0, 1 - scale);
      const double r = std::sqrt(x * x + y * y), r2 = r * r;
      const double from_axis = r * (1.41127 + r2 * (-0.09438 + r2 * 0.25674));
      // The lower edge is the great circle that lies an eighth of a turn below the axis.
      const bool too_low = y < 0 && sin(from_axis) * y + cos(from_axis) * r < 0;
      return r <= 1 && !too_low ? dome(x, y, r, from_axis) : Vec3d{0, 0, 0};
    }
    case Projection::panoramic: {
      const double a = std::numbers::pi * u;
      return c.x * (sin(a) * c.width) + c.y * (tan(std::numbers::pi * v) * c.height) +
             c.z * (cos(a) * c.distance);
    }
    case Projection::cylindrical: {
      const bool upright = c.axis == CylinderAxis::up;
      const double a = (upright ? u : v) * c.angle[0];
      const Vec3d along = upright ? c.y * (v * c.height) : c.x * (u * c.width);
      const Vec3d around = (upright ? c.x : c.y) * sin(a) + c.z * cos(a);
      if (!c.parallel) return around + along;
      origin += along;
      return around;
    }
    case Projection::spherical: {
      const Vec3d raised = turned(c.z, c.x, -c.handedness * v * c.angle[1]);
      return turned(raised, c.y, c.handedness * u * c.angle[0]);
    }
    default:
      return {0, 0, 0};
  }
}

static Ray curved_ray(const CameraFrame& camera, double x, double y) {
  const CurvedView& c = camera.curved;
  Vec3d origin = camera.origin;
  const Vec3d way =
      curved_direction(c, camera.projection, x * c.per_pixel_x - 0.5, 0.5 - y * c.per_pixel_y, origin);
  const double size = length(way);
  Ray ray;
  ray.origin = Vec3f(origin);
  if (size > 0 && std::isfinite(size)) {
    ray.direction = Vec3f(way / size);
  } else {
    ray.direction = Vec3f(camera.forward);
    ray.tmax = 0;
  }
  return ray;
}

/// Of a camera of meshes.
static Ray mesh_ray(const MeshView& view, double x, double y) {
  if (view.mesh != nullptr) return view.mesh->ray({x, y, view.width, view.height}, view.origin);
  Ray none;
  none.direction = {0, 0, -1}, none.tmax = 0;
  return none;
}

Ray camera_ray(const CameraFrame& camera, double x, double y) {
  if (camera.projection == Projection::mesh) return mesh_ray(camera.mesh, x, y);
  if (is_curved(camera.projection)) return curved_ray(camera, x, y);
  const Vec3d place = camera.corner + camera.per_pixel_x * x + camera.per_pixel_y * y;
  Ray ray;
  if (camera.projection == Projection::perspective) {
    ray.origin = Vec3f(camera.origin);
    ray.direction = Vec3f(normalize(place));
  } else {
    ray.origin = Vec3f(camera.origin + place);
    ray.direction = Vec3f(camera.forward);
  }
  return ray;
}

Ray camera_ray(const CameraFrame& camera, double x, double y, double u, double v) {
  if (camera.lens_radius == 0) return camera_ray(camera, x, y);
  const SquareSample at = disk_point({u, v});
  const Vec3d lens = camera.right * (camera.lens_radius * at.x) + camera.up * (camera.lens_radius * at.y);
  const Vec3d place = camera.corner + camera.per_pixel_x * x + camera.per_pixel_y * y;
  const bool perspective = camera.projection == Projection::perspective;
  const Vec3d from = perspective ? lens : lens + place;
  const Vec3d to = perspective ? place * camera.focus : place + camera.forward * camera.focus;
  Ray ray;
  ray.origin = Vec3f(camera.origin + from);
  ray.direction = Vec3f(normalize(to - from));
  return ray;
}

double camera_depth(const CameraFrame& camera, const Vec3f& p) {
  if (is_curved(camera.projection)) {
    const CurvedView& c = camera.curved;
    const Vec3d d = Vec3d(p) - camera.origin;
    return length(c.parallel ? cross(d, c.axis == CylinderAxis::up ? c.y : c.x) : d);
  }
  return dot(Vec3d(p) - camera.origin, camera.forward);
}

void pixel_footprint(const CameraFrame& camera, const Ray& ray, const Vec3f& p, const Vec3f& n, Vec3f& dx,
                     Vec3f& dy) {
  const Vec3d origin(ray.origin), direction(ray.direction), normal(n), point(p);
  const double height = dot(normal, point - origin);
  const auto meet = [&](const Vec3d& from, const Vec3d& along) {
    const double t = height - dot(normal, from - origin);
    const double slope = dot(normal, along);
    const Vec3f d(from + along * (t / slope) - point);
    return t / slope > 0 && is_finite(d) ? d : Vec3f{};
  };
  if (is_curved(camera.projection)) {
    Vec3d across, down;
    make_basis(direction, across, down);
    dx = meet(origin, direction + across * camera.pixel_size);
    dy = meet(origin, direction + down * camera.pixel_size);
  } else if (camera.projection == Projection::perspective) {
    const Vec3d place = direction / dot(direction, camera.forward);
    dx = meet(origin, place + camera.per_pixel_x);
    dy = meet(origin, place + camera.per_pixel_y);
  } else {
    dx = meet(origin + camera.per_pixel_x, direction);
    dy = meet(origin + camera.per_pixel_y, direction);
  }
}

}  // namespace oktett
