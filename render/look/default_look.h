#pragma once
/// \file How a mesh that is given without a scene is shown.

#include "core/mesh.h"
#include "core/vec3.h"
#include "render/light/environment_picture.h"
#include "render/scene.h"

namespace oktett {

// ---- The light of a photographer's studio as a picture of all directions.

/// Where a studio stands: unit vectors, perpendicular to each other.
struct StudioFrame {
  Vec3d right{1, 0, 0};  ///< to the right of who looks in
  Vec3d up{0, 1, 0};
  Vec3d back{0, 0, 1};  ///< towards who looks in
};

/// Soft boxes over a ground: a warm one from the upper left, a weak cool one from the right, one above and
/// one behind, before a backdrop that darkens upwards.
///
/// The horizon and all below it have the radiance `horizon`. It is what an unshadowed diffuse ground of the
/// albedo `ground` shows under these lights, so that such a ground and the backdrop merge.
EnvironmentPicture studio_picture(const StudioFrame& frame, double ground, double horizon);

/// A bright sky, bluer and darker towards the zenith, over a ground of its horizon's colour.
EnvironmentPicture overcast_picture(const StudioFrame& frame);

// ---- Normals for meshes whose file has none.

/// Sets the normal of each corner of each triangle to the mean, by area, of the normals of the triangles that
/// share its vertex and whose normals are at most `crease` degrees apart from that of the triangle.
void add_smooth_normals(TriangleMesh& mesh, double crease);

// ---- The look.

enum class Look {
  studio,   ///< its materials, on a soft ground in a studio's light
  clay,     ///< the same with one matt material for everything
  normals,  ///< shading normals as colours, without a ground
  wire,     ///< the edges of triangles, without a ground
};

/// Where a mesh is seen from.
enum class Viewpoint {
  automatic,  ///< inside if interior_view says so
  outside,
  inside,
};

/// Adds a material that shows the colours of meshes; returns its index.
std::uint32_t add_color_material(Scene& scene);

/// Shows the colours of a mesh that is given alone, if it has some: as the material of an object without one,
/// else on those of its materials that have no image. The mesh is that of `object`, which is no part of the
/// scene yet.
void show_colors(Scene& scene, Object& object);

/// Whether the scene holds at most one mesh, with its points and lines, and neither a camera nor lights.
bool is_mesh_alone(const Scene& scene);

/// Lights a scene that has a camera, but no lights, and where +y points up, by the light of the studio and a
/// weak emitter at the camera, which leaves nothing black in a room.
void light_as_look(Scene& scene);

/// Completes a scene that holds nothing but one mesh, its points and lines: camera, ground, light,
/// integrator, and a material for what has none. Up is that of its camera. Film, seed and what else it says
/// stay. A scene without objects stays as it is.
void apply_look(Scene& scene, Look look, Viewpoint viewpoint);
/// From where it is best seen.
void apply_look(Scene& scene, Look look);

}  // namespace oktett
