#pragma once
/// \file A scene as data: what a scene file says, or what a program puts together, before anything is built.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/error.h"
#include "core/mesh.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "kernels/closed/shape_data.h"
#include "kernels/exact_form.h"
#include "render/fog.h"
#include "render/light/environment_picture.h"
#include "render/light/light_fade.h"
#include "render/light/light_profile.h"
#include "render/material.h"
#include "render/medium/medium.h"
#include "render/motion.h"
#include "render/rainbow.h"
#include "render/sampling/filter_kind.h"
#include "render/tone.h"

namespace oktett {

/// Height of the film that f-numbers refer to, in world units: that of a 35 mm camera, in metres.
inline constexpr double kFilmHeight = 0.024;

/// How a camera projects. All but the first two are curved: straight lines are not straight in the picture.
enum class Projection {
  perspective,
  orthographic,
  fisheye,           ///< equidistant: the distance from the middle is the angle from the view axis
  ultra_wide_angle,  ///< like the fisheye, but fills the picture
  omnimax,           ///< a dome that is filled by a projector off its middle
  panoramic,         ///< half a turn across, the height by the tangent
  cylindrical,       ///< the wall of a cylinder, unrolled
  spherical,         ///< longitude across, latitude up: equirectangular
  mesh,              ///< from the faces of meshes, see CameraMesh
};
/// Their names.
inline constexpr Choice<Projection> kProjections[] = {{"perspective", Projection::perspective},
                                                      {"orthographic", Projection::orthographic},
                                                      {"fisheye", Projection::fisheye},
                                                      {"ultra_wide_angle", Projection::ultra_wide_angle},
                                                      {"omnimax", Projection::omnimax},
                                                      {"panoramic", Projection::panoramic},
                                                      {"cylindrical", Projection::cylindrical},
                                                      {"spherical", Projection::spherical},
                                                      {"mesh", Projection::mesh}};
/// Whether the picture is no plane.
constexpr bool is_curved(Projection projection) {
  return projection != Projection::perspective && projection != Projection::orthographic;
}
/// Whether Camera::angle counts.
constexpr bool has_angle(Projection projection) {
  return projection == Projection::fisheye || projection == Projection::ultra_wide_angle ||
         projection == Projection::cylindrical || projection == Projection::spherical;
}

/// The axis of the cylinder of a cylindrical projection.
enum class CylinderAxis { up, right };
/// Their names.
inline constexpr Choice<CylinderAxis> kCylinderAxes[] = {{"up", CylinderAxis::up},
                                                         {"right", CylinderAxis::right}};

/// What a camera sees, as POV-Ray has it: the middle of the picture lies in `direction`, its edges half of
/// `right` and half of `up` away, whatever the size of the film. The vectors may be of any lengths, need not
/// be perpendicular, and may be left-handed, which mirrors the picture.
struct ViewFrame {
  Vec3d right{1, 0, 0};       ///< the whole width
  Vec3d up{0, 1, 0};          ///< the whole height
  Vec3d direction{0, 0, -1};  ///< from the eye; of an orthographic view only the direction counts
  bool operator==(const ViewFrame&) const = default;

  /// Sine of the angle by which the view leaves the plane of `right` and `up`, less where these are nearly
  /// parallel; 0 or not a number: nothing can be seen.
  double depth() const;

  static constexpr const char* kMap = "a frame";
  void describe(auto& p) {
    p.required("right", right, "the width of what is seen, to the right");
    p.required("up", up, "the height of what is seen, upwards");
    p.required("direction", direction, "to the middle of what is seen");
    p.check(depth() > 1e-9, "direction", "the three vectors of the frame lie in one plane");
  }
};

class CameraMesh;
using CameraMeshPointer = std::shared_ptr<const CameraMesh>;

/// Looks from `from` to `at` in right-handed world space. Pixel (0, 0) is the upper left one.
struct Camera {
  Projection projection = Projection::perspective;
  Vec3d from{0, 0, 5};
  Vec3d at{0, 0, 0};
  Vec3d up{0, 1, 0};  ///< the direction that points up in the picture, of any length
  double fov = 40;    ///< full vertical angle in degrees, (0, 180); perspective only
  /// Height of the view volume in world units; orthographic, also along the axis of a cylinder, only.
  double height = 2;
  /// Full angles in degrees, (0, 360]; 0: usual_angle(). See has_angle() for the projections that have one,
  /// and docs/scene-format.md for what it spans. Of a spherical picture the second is the vertical one; 0:
  /// half of the first. Of all others there is only one.
  double angle[2] = {0, 0};
  CylinderAxis axis = CylinderAxis::up;  ///< cylindrical only
  /// Cylindrical only: orthographic along the axis, so that the eye moves along it, instead of perspective.
  Projection along_axis = Projection::perspective;
  /// Diameter of the lens in world units; 0 is a pinhole, which shows everything sharp.
  double aperture = 0;
  /// If not 0, the aperture is the focal length divided by this, for film of kFilmHeight; perspective only.
  double f_number = 0;
  double focus = 0;  ///< what is sharp lies at this distance along the view axis; 0: at the distance of `at`
  std::optional<Vec3d> focus_at{};  ///< instead of `focus`: a point in the plane that is sharp
  double shutter[2] = {0, 1};       ///< times at which it opens and closes; not descending
  MotionPointer motion{};           ///< moves `from`, `at`, `up`, `focus_at` and `frame`
  /// Instead of the direction of `at`, `up`, `fov` and `height`, which set_frame makes resemble it.
  std::optional<ViewFrame> frame{};
  CameraMeshPointer mesh{};    ///< Projection::mesh only, where nothing else says where rays start
  Vec3d mesh_origin{0, 0, 0};  ///< where the places of `mesh` count from
  bool operator==(const Camera&) const = default;
  /// The angle that a projection has if none is given, in degrees.
  static constexpr double usual_angle(Projection projection) {
    return projection == Projection::spherical ? 360 : 180;
  }
  /// Takes a frame, as seen from `from`.
  void set_frame(const ViewFrame& given);

  static constexpr Range kFieldsOfView{0, 180, true, true};
  void describe(auto& p) {
    p.field("from", from, "the eye");
    bool is_plain = p.field("at", at, "what it looks at");
    is_plain |= p.field("up", up, "what points up in the picture; not parallel to the view");
    is_plain |= p.field("fov", fov, kFieldsOfView, "perspective: full vertical angle in degrees");
    p.choice("projection", projection, kProjections, "how the camera projects");
    is_plain |= p.field("height", height, kPositive, "orthographic: height of what is seen");
    p.optional("angle", Angles{angle},
               "curved projections: full angle in degrees, of a spherical one also [horizontal, vertical]");
    p.choice("axis", axis, kCylinderAxes, "cylindrical: the axis of the cylinder");
    p.choice("along_axis", along_axis, std::span(kProjections).first(2),
             "cylindrical: projection along the axis");
    if (is_plain) frame.reset();
    ViewFrame given;
    if (p.optional("frame", given, "instead of `at`, `up`, `fov` and `height`: what is seen, by vectors"))
      frame = given;
    for (const char* key : {"at", "up", "fov", "height"}) p.not_both("frame", key, nullptr, key);
    p.not_both("aperture", "f_number");
    if (p.optional("aperture", aperture, kNonNegative, "diameter of the lens; 0: all is sharp")) f_number = 0;
    if (p.optional("f_number", f_number, kPositive, "perspective: focal length over aperture")) aperture = 0;
    p.optional("focus", Focus{focus, focus_at},
               "what is sharp: a distance along the view axis, or a point before the camera");
    p.field("shutter", shutter, "times when it opens and closes");
    p.check(shutter[0] <= shutter[1], "shutter", "the shutter closes before it opens");
    p.optional("motion", motion, "transforms of `from`, `at`, `up`, `frame` and a point in `focus`");
    p.optional("mesh", mesh, "projection `mesh`: the faces that see");
  }
  /// Camera::focus or Camera::focus_at.
  struct Focus {
    double& distance;
    std::optional<Vec3d>& point;
  };
  /// Camera::angle.
  struct Angles {
    double (&values)[2];
  };
};

/// Most pixels of a film along an edge and in all.
inline constexpr std::uint32_t kMostFilmSide = 65536;
inline constexpr std::uint64_t kMostFilmPixels = std::uint64_t{1} << 30;
inline constexpr Range kFilmSides = whole(1, kMostFilmSide);
/// Most samples of a pixel.
inline constexpr std::uint32_t kMostSamples = 65536;
inline constexpr Range kPixelSamples = whole(1, kMostSamples);
/// IntegratorSettings::depth.
inline constexpr Range kDepths = whole(0, 64);

/// The picture: its size in pixels, the part of it that is rendered, and how samples become pixels and
/// pixels become files.
struct Film {
  std::uint32_t width = 960;   ///< in kFilmSides; both together at most kMostFilmPixels
  std::uint32_t height = 540;  ///< likewise
  /// Part of the picture to render, as fractions [0, 1] of width and height: x0, x1, y0, y1 (pbrt's order).
  double crop[4] = {0, 1, 0, 1};
  FilterKind filter = FilterKind::box;
  double filter_radius = 0;  ///< in pixels; 0: usual_radius(filter)
  Tone tone{};
  bool cryptomatte = false;  ///< also coverage by objects and materials
  bool operator==(const Film&) const = default;

  void describe(auto& p) {
    p.field("width", width, kFilmSides, "pixels");
    p.field("height", height, kFilmSides, "pixels");
    p.check(std::uint64_t{width} * height <= kMostFilmPixels, nullptr, "the film has more than 2^30 pixels");
    p.field("crop", crop, kUnitInterval,
            "the part to render: x0, x1, y0, y1 as fractions of width and height");
    p.check(crop[0] < crop[1] && crop[2] < crop[3], "crop",
            "the crop window is empty; expected [x0, x1, y0, y1] with x0 < x1 and y0 < y1");
    if (p.choice("filter", filter, kFilterKinds, "how samples become pixels")) filter_radius = 0;
    p.optional("filter_radius", filter_radius, kFilterRadii, "in pixels; by filter if it is left out");
    p.choice("tone", tone.kind, kToneKinds, "tone curve of 8-bit pictures");
    p.field("exposure", tone.exposure, kExposures, "of 8-bit pictures, in stops");
    p.field("gamma", tone.gamma, kGammas, "of 8-bit pictures: the power of light that is shown");
    p.field("cryptomatte", cryptomatte, "mattes of objects and materials in EXR files");
  }
};

/// How light is computed.
enum class IntegratorKind {
  whitted,    ///< Whitted 1980: lights, shadows, mirrors and glass
  path,       ///< path tracing, with light from diffuse surfaces, too
  ao,         ///< ambient occlusion: the unoccluded part of the hemisphere
  normal,     ///< shading normals as colours
  depth,      ///< distances as grey
  albedo,     ///< colours of materials
  uv,         ///< surface parameters as red and green
  position,   ///< places in the box around the scene as colours
  object,     ///< a colour for each object
  primitive,  ///< a colour for each primitive, e.g. each triangle
  facing,     ///< how far surfaces face the viewer; backs are red
  wire,       ///< the edges of triangles
};
/// Their names.
inline constexpr Choice<IntegratorKind> kIntegratorKinds[] = {
    {"whitted", IntegratorKind::whitted}, {"path", IntegratorKind::path},
    {"ao", IntegratorKind::ao},           {"normal", IntegratorKind::normal},
    {"depth", IntegratorKind::depth},     {"albedo", IntegratorKind::albedo},
    {"uv", IntegratorKind::uv},           {"position", IntegratorKind::position},
    {"object", IntegratorKind::object},   {"primitive", IntegratorKind::primitive},
    {"facing", IntegratorKind::facing},   {"wire", IntegratorKind::wire}};

/// What a kind of picture needs; all code but that of the integrator itself asks these, not for its name.
struct IntegratorTraits {
  bool random_numbers = false;  ///< draws random numbers for each sample
  /// Light comes from points and directions, and from points on glowing surfaces, as in Whitted's model.
  bool light_from_points = false;
  /// All light of a scene is sampled along random paths: by the principled material, media, photons, light
  /// groups, motion of lights.
  bool traces_paths = false;
  bool uv = false;         ///< shows the surface parameters of every hit
  bool ao_radius = false;  ///< is limited by IntegratorSettings::ao_radius
  /// Rays go on after the first hit, up to IntegratorSettings::depth.
  bool bounces() const { return light_from_points || traces_paths; }
};

constexpr IntegratorTraits traits(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::whitted:
      return {.light_from_points = true};
    case IntegratorKind::path:
      return {.random_numbers = true, .traces_paths = true};
    case IntegratorKind::ao:
      return {.random_numbers = true, .ao_radius = true};
    case IntegratorKind::uv:
      return {.uv = true};
    default:
      return {};
  }
}

/// Relative errors that adaptive sampling can be asked for; 0: it is off.
inline constexpr Range kErrors{0, 1};
/// The least number of samples that adaptive sampling begins with: fewer do not tell how much they vary.
inline constexpr std::uint32_t kLeastPilot = 4;

/// Caustics by photons, in path tracing.
struct CausticSettings {
  static constexpr std::uint32_t kUsualPhotons = 200000, kMostPhotons = 1u << 26, kMostPasses = 4096;

  std::uint32_t photons = 0;  ///< emitted per pass, [0, kMostPhotons]; 0: only what paths happen to find
  std::uint32_t passes = 16;  ///< [1, kMostPasses]; sample s of a pixel uses pass s modulo `passes`
  double radius = 0;          ///< of the first pass in world units; 0: chosen by the photons
  bool operator==(const CausticSettings&) const = default;

  void describe(auto& p) {
    p.field("photons", photons, whole(1, kMostPhotons), "emitted per pass");
    p.field("passes", passes, whole(1, kMostPasses), "how many times photons are emitted anew");
    p.optional("radius", Radius{radius}, "within which photons count in the first pass, or `auto`");
  }
  /// Greater than 0, or chosen by the photons.
  struct Radius {
    double& value;
  };
};

/// How light is computed, and with how many samples.
struct IntegratorSettings {
  IntegratorKind kind = IntegratorKind::whitted;
  std::uint32_t samples = 4;  ///< per pixel, in kPixelSamples
  std::uint32_t depth = 6;    ///< greatest number of bounces after the camera ray, in kDepths
  std::uint32_t seed = 0;
  double ao_radius =
      0;  ///< reach of ambient-occlusion rays in world units; 0: a tenth of the scene's diagonal
  /// If not 0, samples brighter than this are darkened to it, which is a bias: the picture loses light.
  double clamp = 0;
  /// If not 0, pixels get more than `samples` samples until their relative error is about this.
  double error = 0;
  std::uint32_t max_samples = 1024;  ///< most samples of a pixel if `error` is given, in kPixelSamples
  CausticSettings caustics = {};
  /// Shadow rays of each hit to points of glowing surfaces in Whitted's model, [0, 1024]; 0: these light
  /// nothing.
  std::uint32_t light_samples = 0;
  /// Hits for which some of these points are hidden and others are not ask this many times as many: 1, 2, 4,
  /// 8 or 16.
  std::uint32_t penumbra_factor = 4;
  /// Mirrored and refracted rays that change the picture by less are not traced in Whitted's model, [0, 1]:
  /// adaptive depth control (Hall 1983).
  double cutoff = 1 / 4096.0;
  bool operator==(const IntegratorSettings&) const = default;

  void describe(auto& p) {
    p.choice("kind", kind, kIntegratorKinds, "what is computed for a pixel");
    p.field("samples", samples, kPixelSamples, "per pixel");
    p.field("depth", depth, kDepths, "bounces after the camera ray");
    p.field("cutoff", cutoff, kUnitInterval,
            "`whitted`: mirrored and refracted rays that change the picture by less are not traced");
    p.field("seed", seed, kAnySeed, "of the random numbers");
    p.field("ao_radius", ao_radius, kNonNegative, "`ao`: reach of rays; 0: a tenth of the scene's diagonal");
    p.field("clamp", clamp, kNonNegative, "brighter samples are darkened to it, which loses light; 0: none");
    p.field("error", error, kErrors,
            "pixels get more samples until their relative error is about this; 0: none do");
    p.field("max_samples", max_samples, kPixelSamples, "with `error`: most per pixel");
    p.field("caustics", caustics, "`path`: photons, by `true` or a map");
    p.field("light_samples", light_samples, whole(0, 1024),
            "`whitted`: shadow rays per hit to lights that have an area; 0: these light nothing");
    p.field("penumbra_factor", penumbra_factor, whole(1, 16),
            "`whitted`: how many times as many, 1, 2, 4, 8 or 16, where some are blocked");
    const double found = penumbra_factor;
    p.check(std::has_single_bit(penumbra_factor), "penumbra_factor", "expected 1, 2, 4, 8 or 16", &found);
  }
};

/// Whether the settings ask for photons.
inline bool wants_photons(const IntegratorSettings& settings) {
  return traits(settings.kind).traces_paths && settings.caustics.photons > 0;
}

// The colour of a light is what a white diffuse surface shows that faces it: an irradiance divided by pi, or
// for lights with falloff an intensity divided by pi. Radiance stands as it is.

/// Emits light in all directions. Its light does not fall off with distance unless `falloff` is set (1/r^2).
struct PointLight {
  Vec3d position;
  Color color{1, 1, 1};
  bool falloff = false;
  /// Multiplies the intensity by direction, its axis along `down`. Null: the same in all directions.
  std::shared_ptr<const LightProfile> profile = nullptr;
  double rotation = 0;   ///< of the profile: degrees about its axis
  Vec3d down{0, -1, 0};  ///< of any length but zero
  LightFade fade{};      ///< without `falloff`
};

/// A point that emits light into a cone, which falls off as 1/r^2 unless `falloff` is not set. From the inner
/// to the outer angle it fades smoothly.
struct SpotLight {
  Vec3d position;
  Vec3d direction{0, -1, 0};  ///< along the middle of the cone, of any length but zero
  Color color{1, 1, 1};
  double inner_angle = 30;  ///< degrees from the middle, [0, outer_angle]
  double outer_angle = 40;  ///< degrees from the middle, (0, 180]
  /// Instead of the angles: multiplies the intensity by direction, its axis along `direction`. May be null.
  std::shared_ptr<const LightProfile> profile = nullptr;
  double rotation = 0;  ///< of the profile: degrees about its axis
  bool falloff = true;
  LightFade fade{};  ///< without `falloff`
  double tightness =
      0;  ///< power of the cosine to the axis that multiplies the light, >= 0; with angles only
};

/// Parallel light that travels along `direction`.
struct DirectionalLight {
  Vec3d direction{0, -1, 0};
  Color color{1, 1, 1};
  /// Angular diameter in degrees, [0, 180]: the light comes from a disk in the sky, which path tracing shows
  /// and samples. The sun has 0.53.
  double angle = 0;
  // In Whitted's model:
  /// What lies behind the plane through this point, across the light, casts no shadow.
  std::optional<Vec3d> from{};
  LightFade fade{};  ///< with the distance from that plane; none without `from`
  LightBeam beam{};  ///< about the line through `from`, and only before the plane; none without `from`
};

/// Light from all directions, which is also the background.
struct EnvironmentLight {
  std::shared_ptr<const EnvironmentPicture> picture;  ///< not null
  double rotation = 0;                                ///< degrees about +y
  Color color{1, 1, 1};                               ///< multiplies the radiance of the picture
};

/// The clear sky by day with the sun in it, over a diffuse ground; also the background. See Sky.
struct SkyLight {
  Vec3d sun{1, 2, 1};              ///< towards the sun, of any length but zero; the horizon is y = 0
  double turbidity = 3;            ///< [2, 10]: from very clear to hazy
  Color ground{0.2f, 0.2f, 0.2f};  ///< albedo of what is below the horizon
  /// Multiplies radiance in kcd / m^2. With the default, white shows about 1 in the sun of noon.
  Color color{0.03f, 0.03f, 0.03f};
};

/// A light of any kind.
using Light = std::variant<PointLight, SpotLight, DirectionalLight, EnvironmentLight, SkyLight>;

/// A choice of objects that lights are for, see Object::listed.
struct LightList {
  bool lights_others = false;  ///< these lights light all objects but those on the list
  Location where{};            ///< where a scene file states it; else empty
};
/// Most lists of a scene.
inline constexpr std::size_t kMostLightLists = 16;

/// What may be said of any light.
struct LightTraits {
  MotionPointer motion{};      ///< moves the light; not of environments and skies
  std::string group{};         ///< the light group; empty: kDefaultLightGroup
  std::uint32_t list = kNoId;  ///< index into Scene::light_lists; kNoId: it lights all objects
  bool shadows = true;     ///< in Whitted's model, of lights that are no environment: things are in its way
  bool highlights = true;  ///< likewise: it shows Phong's highlights
  bool dimmed_by_fog = false;  ///< likewise: fog on its way takes light
};

/// The group of all light that is in no other: that of lights without a group, the background and media.
inline constexpr const char* kDefaultLightGroup = "default";
/// Most light groups of a scene, the default one included.
inline constexpr std::size_t kMostLightGroups = 64;

/// Where the vertices of a mesh are at a time; columns that the mesh lacks are empty.
struct MeshPose {
  double time = 0;
  Column<Vec3f> positions, normals;
  Column<std::array<float, 4>> tangents;
};

/// How a mesh is bent: at least one pose, of ascending times. Between two all numbers change linearly, before
/// the first and after the last nothing does.
struct MeshBending {
  std::vector<MeshPose> poses;
};

/// A mesh, shared by all objects that show the same file, and the material of each of its slots.
struct MeshShape {
  std::shared_ptr<const TriangleMesh> mesh;
  std::vector<std::uint32_t>
      slot_materials;  ///< index into Scene::materials per slot of the mesh; may be empty
  bool smooth = true;  ///< interpolate the mesh's normals; false: flat shading
  TriangleTest test = TriangleTest::watertight;
  bool by_winding = false;  ///< take part in combinations even if the mesh is not closed
  bool weld = false;        ///< what the scene file asked for; `mesh` is as it says
  /// If not 0, the triangles are points and lines of this width, balls and round cylinders: without area,
  /// their corners a, a, a of a point and a, b, b of a line. All are in slot 0, and none has an inside.
  double stroke_width = 0;
  /// If not null, how the mesh is bent; `mesh` is as at time 0. Only of objects of the scene itself.
  std::shared_ptr<const MeshBending> bending = nullptr;

  static constexpr ShapeInfo kShapeInfo{"mesh", "the triangles of a file"};
  void describe(auto& p) {
    p.required("file", ByHand{"mesh file", "file"}, "triangles and, with OBJ, their materials");
    p.field("smooth", smooth, "interpolates the normals of the file");
    p.field("weld", weld, "makes one of all vertices at the same place, which an STL file does not share");
    p.choice("test", test,
             {{"watertight", TriangleTest::watertight},
              {"moller_trumbore", TriangleTest::moller_trumbore},
              {"badouel", TriangleTest::badouel},
              {"segura_feito", TriangleTest::segura_feito}},
             "how a ray is tested against a triangle");
    p.optional("stroke_width", stroke_width, kPositive, "width of the points and lines of the file");
    p.choice("solid", by_winding, {{"closed", false}, {"winding", true}},
             "which meshes have an inside: closed ones, or any, see below");
  }
};

/// All objects of a prototype, moved by the object's transform.
struct InstanceShape {
  std::uint32_t prototype = kNoId;  ///< index into Scene::prototypes
};

struct Object;

/// A Boolean combination of objects. An operand's transform maps to the space of the object that has this
/// shape. Each operand keeps its own material.
struct CsgShape {
  CsgOp op =
      CsgOp::unite;  ///< not CsgOp::operand; CsgOp::surfaces of no combinations, and within another one
  std::shared_ptr<const std::vector<Object>> operands;
  /// Shapes in the same space: only rays that run through each of them see the combination. Null: none. Of
  /// combinations inside others they do not count.
  std::shared_ptr<const std::vector<Object>> windows{};
};

/// What a ray is for. Those of bounces are called after the lobe that sent them: mirrors and highlights are
/// glossy, what passes to the other side is transmission, and media send rays of volumes.
enum class RayKind : std::uint8_t { camera, diffuse, glossy, transmission, volume, shadow };
inline constexpr std::size_t kRayKinds = 6;
/// Their names.
inline constexpr Choice<RayKind> kRayKindNames[kRayKinds] = {
    {"camera", RayKind::camera}, {"diffuse", RayKind::diffuse},
    {"glossy", RayKind::glossy}, {"transmission", RayKind::transmission},
    {"volume", RayKind::volume}, {"shadow", RayKind::shadow}};
/// A kind in a set of kinds, and the set of all.
constexpr std::uint8_t bit_of(RayKind kind) {
  return static_cast<std::uint8_t>(1u << static_cast<unsigned>(kind));
}
inline constexpr std::uint8_t kAllRays = (1u << kRayKinds) - 1;
/// The kinds of bounces.
inline constexpr RayKind kBounceKinds[] = {RayKind::diffuse, RayKind::glossy, RayKind::transmission,
                                           RayKind::volume};

/// Any shape that an object can have. Copying, moving and destroying one are functions of scene.cpp: inline,
/// they take the compiler a second in each file that needs them.
struct Shape : std::variant<MeshShape, TriangleShape, SphereShape OKTETT_AND_CLOSED_FORMS, ExactShape,
                            CsgShape, InstanceShape> {
  using variant::variant;
  Shape();
  Shape(const Shape&);
  Shape(Shape&&) noexcept;
  Shape& operator=(const Shape&);
  Shape& operator=(Shape&&) noexcept;
  ~Shape();
};

/// A thing in the scene. The groups of a scene file are already multiplied into the transforms of their
/// objects.
struct Object {
  Shape shape;
  std::uint32_t material =
      kNoId;         ///< index into Scene::materials; kNoId: the mesh's own, or the default material
  Affine transform;  ///< from the shape's space to that of the prototype or the world
  /// If not null, it gives the transform at each time, and `transform` is that at time 0. Only of objects of
  /// the scene itself.
  MotionPointer motion;
  std::string name;  ///< may be empty
  Location where;    ///< where a scene file defines it; else empty
  /// The kinds of rays that meet it, by bit_of(); of what an instance shows, those that both state. Operands
  /// of combinations must have kAllRays.
  std::uint8_t visible_to = kAllRays;
  /// Where the camera sees it, the picture shows only how other objects change its light, see write_tile().
  /// All that an instance shows is one if either states it. Not of operands of combinations.
  bool shadow_catcher = false;
  /// Bit i: it is on Scene::light_lists[i], and so is all that it shows.
  std::uint16_t listed = 0;
  /// Fog is in the solid, too; so it is in all that an instance shows that is. Not of operands of
  /// combinations.
  bool hollow = false;
  /// The list of the light that its material emits, as LightTraits::list.
  std::uint32_t light_list = kNoId;
};

/// Objects that are rendered only through instances. A prototype may hold instances of prototypes that stand
/// before it in Scene::prototypes.
struct Prototype {
  std::string name;
  std::vector<Object> objects;
};

/// Everything that render() needs. Its indices must be in range; they are not checked.
struct Scene {
  Camera camera;
  bool camera_given = false;  ///< false: render() chooses a three-quarter view of the whole scene
  Film film;
  IntegratorSettings integrator;
  Color background{0, 0, 0};
  /// Multiplies it, into `textures`: a pattern is looked up where its direction meets the unit sphere.
  std::uint32_t background_texture = kNoId;
  Color ambient_light{1, 1, 1};
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Medium> media;
  std::uint32_t medium = kNoId;   ///< index into `media`: what fills the space outside of all solids
  std::vector<Fog> fogs;          ///< in Whitted's model, outside of solids
  std::vector<Rainbow> rainbows;  ///< likewise
  std::vector<Light> lights;
  std::vector<LightTraits> light_traits;  ///< of the light of the same number; may be shorter
  std::vector<LightList> light_lists;     ///< at most kMostLightLists
  bool lights_given = false;              ///< false: render() adds a key and a fill light beside the camera
  std::vector<Prototype> prototypes;
  std::vector<Object> objects;
  /// The place in the coordinates of its files from which all places of the scene count; far away floats
  /// would lose details. Planes of positions in pictures count from there, too.
  Vec3d origin{0, 0, 0};
  // Where a file defines the material or texture of the same number, if it has lines; may be shorter.
  std::vector<Location> material_places, texture_places;
  std::vector<Warning> warnings;  ///< what was skipped or given a default while a file was read
  std::string source;             ///< path of the file that the scene was read from; else empty

  // Functions of scene.cpp, for the same reason as those of Shape.
  Scene();
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();
};

}  // namespace oktett
