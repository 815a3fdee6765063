#pragma once
/// \file The scene as data only: what the scene file says, resolved to numbers and indices, before anything
/// is built.

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "kernels/closed/shape_data.h"
#include "kernels/exact_form.h"
#include "render/material.h"

namespace oktett {

enum class Projection { perspective, orthographic };

/// Right-handed, looks from `from` to `at`. Pixel (0, 0) is the upper left one.
struct Camera {
  Projection projection = Projection::perspective;
  Vec3d from{0, 0, 5};
  Vec3d at{0, 0, 0};
  Vec3d up{0, 1, 0};
  double fov = 40;    ///< full vertical angle in degrees, (0, 180); perspective only
  double height = 2;  ///< height of the view volume in world units; orthographic only
  bool operator==(const Camera&) const = default;
};

struct Film {
  std::uint32_t width = 960;
  std::uint32_t height = 540;
  /// Part of the picture to render, as fractions [0, 1] of width and height: x0, x1, y0, y1 (pbrt's order).
  double crop[4] = {0, 1, 0, 1};
  bool operator==(const Film&) const = default;
};

enum class IntegratorKind { whitted, path, ao, normal, depth };

struct IntegratorSettings {
  IntegratorKind kind = IntegratorKind::whitted;
  std::uint32_t samples = 4;  ///< per pixel, [1, 65536]
  std::uint32_t depth = 6;    ///< greatest number of bounces after the camera ray, [0, 64]
  std::uint32_t seed = 0;
  double ao_radius =
      0;  ///< reach of ambient-occlusion rays in world units; 0 = a tenth of the scene's diagonal
  bool operator==(const IntegratorSettings&) const = default;
};

/// Emits `color` in all directions. Its light does not fall off with distance unless `falloff` is set
/// (1/r^2).
struct PointLight {
  Vec3d position;
  Color color{1, 1, 1};
  bool falloff = false;
};

/// Parallel light that travels along `direction`.
struct DirectionalLight {
  Vec3d direction{0, -1, 0};
  Color color{1, 1, 1};
};

using Light = std::variant<PointLight, DirectionalLight>;

/// A mesh, shared by all objects that show the same file, and the material of each of its slots.
struct MeshShape {
  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<std::uint32_t>
      slot_materials;  ///< index into Scene::materials per slot of the mesh; may be empty
  bool smooth = true;  ///< interpolate the mesh's normals; false = flat shading
  TriangleTest test = TriangleTest::watertight;
  bool by_winding = false;  ///< in combinations: inside is where crossings say so, closed or not
};

/// Everything that prototype `prototype` holds, moved by the object's transform.
struct InstanceShape {
  std::uint32_t prototype = kNoId;  ///< index into Scene::prototypes
};

struct Object;

/// Operands combined; `subtract` takes the others from the first. An operand's transform leads to the space
/// of the object that this is the shape of, and each keeps its own material.
struct CsgShape {
  CsgOp op = CsgOp::unite;
  std::shared_ptr<const std::vector<Object>> operands;
};

/// Any shape an object can have. The plain shapes are listed in kernels/closed/shape_data.h.
using Shape = std::variant<MeshShape, SphereShape, SpheresShape, PlaneShape, DiskShape, BoxShape,
                           PolygonShape, TriangleShape, ExactShape, CsgShape, InstanceShape>;

/// A thing in the scene: groups are flattened into objects while the file is read, their transforms
/// multiplied out.
struct Object {
  Shape shape;
  std::uint32_t material =
      kNoId;         ///< index into Scene::materials; kNoId = the mesh's own, or the default material
  Affine transform;  ///< object space to the space of the prototype or world
  std::string name;
  Location where;  ///< where the scene file defines it
};

/// Objects that are rendered only through instances. A prototype may hold instances of prototypes before it
/// in the list.
struct Prototype {
  std::string name;
  std::vector<Object> objects;
};

struct Scene {
  Camera camera;
  bool camera_given = false;  ///< false: frame the whole scene from a three-quarter view
  Film film;
  IntegratorSettings integrator;
  Color background{0, 0, 0};
  Color ambient_light{1, 1, 1};
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;
  bool lights_given = false;  ///< false: a key and a fill light placed relative to the camera
  std::vector<Prototype> prototypes;
  std::vector<Object> objects;
  std::vector<Warning> warnings;  ///< what was skipped or defaulted while reading
  std::string source;             ///< path of the file the scene was read from
};

}  // namespace oktett
