#include "render/look/default_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/math.h"
#include "core/mesh_geometry.h"
#include "render/camera.h"
#include "render/look/mesh_view.h"

namespace oktett {

// ---- The light of a photographer's studio as a picture of all directions.

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

// ---- Normals for meshes whose file has none.

/// The triangles at each vertex, in the order of their numbers: those of vertex v are
/// triangles[first[v]] ... triangles[first[v + 1] - 1].
struct VertexTriangles {
  explicit VertexTriangles(const TriangleMesh& mesh)
      : first(mesh.positions.size() + 1), triangles(mesh.indices.size()) {
    for (const std::uint32_t v : mesh.indices) ++first[v + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
      triangles[next[mesh.indices[i]]++] = static_cast<std::uint32_t>(i / 3);
  }
  std::vector<std::uint32_t> first, triangles;
};

void add_smooth_normals(TriangleMesh& mesh, double crease) {
  const VertexTriangles around(mesh);
  const double least = portable::cos(crease * kDegree);
  std::vector<Vec3d> normals(mesh.triangle_count());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = area_normal(mesh, i);
  mesh.normals.resize_uninitialized(mesh.indices.size());
  mesh.normal_indices.resize_uninitialized(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const Vec3d& own = normals[i / 3];
    const double size = length(own);
    const std::uint32_t vertex = mesh.indices[i];
    Vec3d sum;
    for (std::uint32_t k = around.first[vertex]; k < around.first[vertex + 1]; ++k) {
      const Vec3d& other = normals[around.triangles[k]];
      if (dot(own, other) >= least * size * length(other)) sum += other;
    }
    const double longest = length(sum);
    mesh.normals[i] = longest > 0 ? Vec3f(sum / longest) : Vec3f{};
    mesh.normal_indices[i] = longest > 0 ? static_cast<std::uint32_t>(i) : kNoId;
  }
}

// ---- The look.

namespace {

constexpr double kFov = 30, kMargin = 0.07;
constexpr double kGroundAlbedo = 0.42, kHorizon = 0.45;

Material matt(const char* name, const Color& color) {
  Material m;
  m.name = name;
  m.color = color;
  m.ambient = 0, m.diffuse = 1;
  return m;
}

/// How the mesh lies about its up direction.
struct Stance {
  double low, high;  ///< along up
  double width;      ///< the greater extent across
  double depth;      ///< the smaller one
};

Stance stance_of(const TriangleMesh& mesh, const Vec3d& up) {
  Box box;
  Stance s{kInfinity, -kInfinity, 0, 0};
  for (const std::uint32_t index : mesh.indices) {
    const Vec3f& p = mesh.positions[index];
    box.grow(p);
    const double height = dot(Vec3d(p), up);
    s.low = std::min(s.low, height), s.high = std::max(s.high, height);
  }
  const Vec3f e = box.extent();
  const int vertical = dominant_axis(up);
  const double a = e[(vertical + 1) % 3], b = e[(vertical + 2) % 3];
  s.width = std::max(a, b), s.depth = std::min(a, b);
  return s;
}

/// The tangent of the angle at which the camera looks down: flat things are seen from a steeper angle.
double descent(const Stance& s) {
  const double tallness = (s.high - s.low) / std::max(s.width, 1e-30);
  return std::clamp(0.62 - 0.55 * tallness, 0.14, 0.62);
}

/// Towards the camera from a thing that stands upright: from the right of its front.
Vec3d towards_camera(const Stance& s, const Vec3d& up) {
  const Vec3d front = std::abs(up.z) > std::abs(up.y) ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
  const Vec3d right = cross(up, front);
  return normalize(front * 0.86 + right * 0.5) + up * descent(s);
}

StudioFrame studio_frame(const Camera& camera, const Vec3d& up) {
  const Vec3d right = normalize(cross(camera.at - camera.from, up));
  return {right, up, cross(right, up)};
}

/// A disk of the ground. Its opacity is that of the texture, if there is one.
void add_disk(Scene& scene, const DiskShape& disk, std::uint32_t opacity) {
  Material material = matt("ground", Color{1, 1, 1} * static_cast<float>(kGroundAlbedo));
  material.opacity_texture = opacity;
  scene.materials.push_back(std::move(material));
  Object ground;
  ground.shape = disk;
  ground.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  ground.name = "ground";
  scene.objects.push_back(std::move(ground));
}

/// What the mesh stands on. It fades into the backdrop, which has the radiance of an unshadowed ground.
void add_ground(Scene& scene, const Stance& s, const Vec3d& up) {
  const double size = s.width + s.high - s.low, step = 1e-4 * size;
  DiskShape near;
  // A little lower than the mesh, so that a flat base does not lie in it.
  near.center = scene.camera.at + up * (s.low - step - dot(scene.camera.at, up));
  near.normal = up;
  near.radius = 0.9 * size;
  // Most of the ground that is seen is opaque and has a disk of its own, since textures cost time. The disk
  // that fades lies below it.
  DiskShape far = near;
  far.center = near.center - up * step;
  far.radius = 3.2 * size;
  PatternTexture fade;
  fade.pattern = RadialPattern{far.center, near.radius, far.radius};
  fade.colors = {{1, 1, 1}, {0.85f, 0.85f, 0.85f}, {0.5f, 0.5f, 0.5f}, {0.15f, 0.15f, 0.15f}, {0, 0, 0}};
  Texture opacity;
  opacity.pattern = fade;
  scene.textures.push_back(opacity);
  add_disk(scene, near, kNoId);
  add_disk(scene, far, static_cast<std::uint32_t>(scene.textures.size() - 1));
}

void light_by(Scene& scene, EnvironmentPicture picture) {
  EnvironmentLight light;
  light.picture = std::make_shared<const EnvironmentPicture>(std::move(picture));
  scene.lights = {light};
  scene.lights_given = true;
  scene.background = {0, 0, 0};
}

/// Sky and sun through the openings, and a weak emitter beside the camera that leaves nothing black.
void light_room(Scene& scene, const InteriorView& view, const Vec3d& up) {
  light_by(scene, overcast_picture(studio_frame(view.camera, up)));
  if (view.sun) scene.lights.push_back(DirectionalLight{-*view.sun, {1.15f, 1.06f, 0.95f}, 1.5});
  const StudioFrame frame = studio_frame(view.camera, up);
  const double distance = length(view.camera.at - view.camera.from);
  PointLight emitter;
  emitter.position = view.camera.from + (frame.right * -0.1 + up * 0.15) * (0.2 * distance);
  emitter.color = Color{1, 0.97f, 0.92f} * (view.sun ? 0.3f : 0.7f);
  scene.lights.push_back(emitter);
}

/// Coarse meshes without normals get some, so that their triangles do not show.
void smooth(MeshShape& shape) {
  constexpr std::size_t kFine = 1000000;
  constexpr double kCrease = 40;
  if (!shape.smooth || !shape.mesh->normals.empty() || shape.mesh->triangle_count() > kFine) return;
  auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
  add_smooth_normals(*mesh, kCrease);
  shape.mesh = std::move(mesh);
}

/// The corners of what there is to be seen, each with an index: those of meshes, the ends of points and
/// lines, and how far these reach along the axes.
TriangleMesh corners_of(const Scene& scene) {
  TriangleMesh all;
  const auto add = [&](const Vec3f& p) {
    all.indices.push_back(static_cast<std::uint32_t>(all.positions.size()));
    all.positions.push_back(p);
  };
  for (const Object& object : scene.objects) {
    const auto& shape = std::get<MeshShape>(object.shape);
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const Vec3f& p : shape.mesh->positions) all.positions.push_back(p);
    for (const std::uint32_t i : shape.mesh->indices) all.indices.push_back(first + i);
    const auto reach = static_cast<float>(shape.stroke_width / 2);
    if (!(reach > 0)) continue;
    std::array<std::array<Vec3f, 2>, 3> ends{};
    bool is_first = true;
    each_corner(*shape.mesh, [&](const Vec3f& p) {
      for (int axis = 0; axis < 3; ++axis) {
        auto& [low, high] = ends[static_cast<std::size_t>(axis)];
        if (is_first || p[axis] < low[axis]) low = p;
        if (is_first || p[axis] > high[axis]) high = p;
      }
      is_first = false;
    });
    for (int axis = 0; axis < 3; ++axis) {
      auto [low, high] = ends[static_cast<std::size_t>(axis)];
      low[axis] -= reach, high[axis] += reach;
      add(low), add(high);
    }
  }
  return all;
}

/// The bounces that the materials of a scene need: for diffuse light `usual`; for glass as many as there may
/// be, since each face of it takes one. Paths of little light end by themselves.
std::uint32_t bounces_for(const Scene& scene, std::uint32_t usual) {
  const auto lets_light_through = [](const Material& m) {
    return m.transparency > 0 || (m.principled && m.principled->parameters.transmission > 0);
  };
  return std::ranges::any_of(scene.materials, lets_light_through) ? static_cast<std::uint32_t>(kDepths.hi)
                                                                  : usual;
}

void cover(Scene& scene, Object& object, Material material) {
  scene.materials.push_back(std::move(material));
  object.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
}

}  // namespace

/// What a mesh without materials is made of.
static Material satin() {
  Material m;
  m.name = "satin";
  m.color = {0.66f, 0.63f, 0.60f};
  PrincipledMaterial principled;
  principled.parameters.base_color = m.color;
  principled.parameters.roughness = 0.38f;
  m.principled = principled;
  resemble_principled(m);
  return m;
}

static std::uint32_t add_color_texture(Scene& scene) {
  scene.textures.emplace_back().attribute = kColorAttribute;
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

std::uint32_t add_color_material(Scene& scene) {
  Material m = satin();
  m.name = "colors";
  m.color = m.principled->parameters.base_color = {1, 1, 1};
  m.color_texture = add_color_texture(scene);
  resemble_principled(m);
  scene.materials.push_back(std::move(m));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void show_colors(Scene& scene, Object& object) {
  const auto& shape = std::get<MeshShape>(object.shape);
  if (shape.mesh == nullptr || object.material != kNoId) return;
  if (find_attribute(*shape.mesh, kColorAttribute) == nullptr) return;
  if (shape.slot_materials.empty()) {
    object.material = add_color_material(scene);
    return;
  }
  std::uint32_t texture = kNoId;
  for (const std::uint32_t slot : shape.slot_materials) {
    if (slot >= scene.materials.size()) continue;
    Material& m = scene.materials[slot];
    if (m.color_texture != kNoId || m.tint_texture != kNoId) continue;
    if (texture == kNoId) texture = add_color_texture(scene);
    m.color_texture = texture;
  }
}

void light_as_look(Scene& scene) {
  // The camera may be tilted, and look straight down.
  const Vec3d up{0, 1, 0};
  const Vec3d across = cross(scene.camera.at - scene.camera.from, up);
  const bool level = length(across) > 1e-3 * length(scene.camera.at - scene.camera.from);
  const StudioFrame frame = level ? studio_frame(scene.camera, up) : StudioFrame{};
  light_by(scene, studio_picture(frame, kGroundAlbedo, kHorizon));
  PointLight emitter;
  emitter.position = scene.camera.from;
  emitter.color = Color{1, 0.97f, 0.92f} * 0.25f;
  scene.lights.push_back(emitter);
  scene.film.tone.kind = ToneKind::neutral;
}

bool is_mesh_alone(const Scene& scene) {
  if (scene.camera_given || scene.lights_given) return false;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto* const shape = std::get_if<MeshShape>(&scene.objects[i].shape);
    if (shape == nullptr || (i > 0 && shape->stroke_width == 0)) return false;
  }
  return true;
}

void apply_look(Scene& scene, Look look) { apply_look(scene, look, Viewpoint::automatic); }

void apply_look(Scene& scene, Look look, Viewpoint viewpoint) {
  if (scene.objects.empty()) return;
  auto& shape = std::get<MeshShape>(scene.objects[0].shape);
  const bool has_strokes = std::get<MeshShape>(scene.objects.back().shape).stroke_width > 0;
  std::optional<InteriorView> inside;
  const Vec3d up = normalize(scene.camera.up);
  if (shape.stroke_width == 0) {
    smooth(shape);
    if (viewpoint == Viewpoint::automatic) inside = interior_view(*shape.mesh, up, scene.film);
    if (viewpoint == Viewpoint::inside) inside = inside_view(*shape.mesh, up, scene.film);
  }
  const TriangleMesh corners = has_strokes ? corners_of(scene) : TriangleMesh{};
  const TriangleMesh& mesh = has_strokes ? corners : *shape.mesh;
  const Stance stance = stance_of(mesh, up);
  scene.camera =
      inside ? inside->camera : fit_mesh(mesh, -towards_camera(stance, up), up, kFov, kMargin, scene.film);
  scene.camera_given = true;
  scene.integrator.samples = inside ? 16 : 12;
  scene.film.tone.kind = ToneKind::neutral;
  if (look == Look::normals || look == Look::wire) {
    scene.integrator.kind = look == Look::wire ? IntegratorKind::wire : IntegratorKind::normal;
    return;
  }
  scene.integrator.kind = IntegratorKind::path;
  const std::uint32_t usual = inside ? 4 : 2;
  scene.integrator.depth = look == Look::clay ? usual : bounces_for(scene, usual);
  if (inside)
    light_room(scene, *inside, up);
  else
    light_by(scene, studio_picture(studio_frame(scene.camera, up), kGroundAlbedo, kHorizon));
  for (Object& object : scene.objects) {
    if (look == Look::clay)
      cover(scene, object, matt("clay", {0.58f, 0.42f, 0.33f}));
    else if (std::get<MeshShape>(object.shape).slot_materials.empty() && object.material == kNoId)
      cover(scene, object, satin());
  }
  if (!inside) add_ground(scene, stance, up);
}

}  // namespace oktett
