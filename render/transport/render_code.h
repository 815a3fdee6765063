#pragma once
/// \file Code of the renderer that is compiled for each instruction set in render/isa.

#include "core/isa.h"
#include "render/context.h"
#include "render/shading_columns.h"
#include "render/transport/path_block.h"
#include "render/transport/path_lights.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// The image plane in front of a pinhole camera.
struct ViewPlane {
  Vec3d corner;                    ///< from the pinhole to the point (0, 0)
  Vec3d per_pixel_x, per_pixel_y;  ///< from a point to its neighbours
};

/// Points (x[i], y[i]) of a plane, and the columns that receive the unit vectors from the pinhole to them.
struct ViewPoints {
  const double* x = nullptr;
  const double* y = nullptr;
  std::size_t count = 0;
  float* direction[3] = {};
};

struct RenderCode {
  std::size_t whitted_lanes, path_lanes;  ///< hits that are shaded at once
  /// direction = normalize(corner + x * per_pixel_x + y * per_pixel_y), computed in double and rounded once.
  void (*view_directions)(const ViewPlane&, const ViewPoints&);
  /// Sets origins and directions of the rays to those that camera_ray gives for a camera with a lens.
  void (*lens_rays)(const CameraFrame&, const FilmPoints&, RayBatch&);
  /// Sets x and y to sobol_point of the samples [first, last) of the sequence that `key` chooses.
  void (*sobol_points)(std::uint32_t first, std::uint32_t last, std::uint64_t key, double* x, double* y);
  /// Fills all columns after `ray` and `material` from the rays and from a table of materials, and adds their
  /// unlit light, except for materials that vary, to the radiance of the rays.
  void (*begin_shading)(const InteractionBlock&, const ShadingMaterial* table, const ArrivingRays&,
                        ShadingColumns&);
  /// Writes the rays to one light, with the light that they carry if nothing blocks them, for all hits that
  /// it could reach. Their tmin and tmax are left out.
  void (*shadow_rays)(const InteractionBlock&, const LightSource&, const ShadingColumns&, ShadowColumns& out);
  /// Adds the rays that mirrors and glass send out. Those that would bring next to no light are left out.
  void (*bounce_rays)(const InteractionBlock&, const ShadingColumns&, BounceColumns& mirrored,
                      BounceColumns& refracted);
  /// Writes the rays that are sent, in the order of their hits. `rays`: entries of the rays that arrive at
  /// these.
  void (*queue_rays)(const BounceColumns&, const std::uint32_t* rays, const ArrivingRays&, OnwardColumns& to);

  /// Fills the columns of a PathBlock up to the random numbers, but those for `ray`, `key`, `number` and
  /// `bounces`, which are given.
  void (*begin_path)(const InteractionBlock&, const ArrivingRays&, unsigned level, PathBlock&);
  /// Writes the shadow rays and the rays of the next bounce of hits of one surface. All columns of the block
  /// are filled.
  void (*shade_phong)(const InteractionBlock&, const ArrivingRays&, const PathBlock&, const PhongSurface&,
                      bool transmits, const PathRun&, PathQueues&);
  void (*shade_principled)(const InteractionBlock&, const ArrivingRays&, const PathBlock&,
                           const PrincipledSurface&, bool transmits, const PathRun&, PathQueues&);
  LightCode lights;

  /// Sets the radiance of each ray, to `throughput` times `background` if it hit nothing and to 0 if it did,
  /// and lists the rays that hit. `item`: Hit::item of each ray.
  void (*split_rays)(const Column<std::uint32_t>& item, const ColorColumn& throughput,
                     const Color& background, ColorColumn& radiance, Column<std::uint32_t>& hit_rays);
  /// Makes the light of shadow rays black where their byte of `blocked` is not 0.
  void (*block_light)(const Column<std::uint8_t>& blocked, ColorColumn& light);
  /// Adds each colour of `from` that is not black to its entry of `to`, in the order of `from`.
  void (*add_colors)(const ColorColumn& from, const Column<std::uint32_t>& entry, ColorColumn& to);
  /// Whether no number is infinite or NaN.
  bool (*all_finite)(const float* column, std::size_t count);
};

template <class A>
const RenderCode& render_code();

/// Throws Error if this build holds no code for the set.
const RenderCode& render_code(Isa isa);

}  // namespace oktett
