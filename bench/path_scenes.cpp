#include "bench/path_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "bench/program.h"
#include "core/random.h"
#include "io/image/image.h"

namespace oktett::bench {

namespace {

using Kind = PathMaterial::Kind;

/// Adds to the mesh of a scene.
class MeshMaker {
 public:
  explicit MeshMaker(TriangleMesh& mesh) : mesh_(mesh) {}

  /// Two triangles.
  void quad(const Vec3f& corner, const Vec3f& u, const Vec3f& v, std::uint16_t material) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const Vec3f& p : {corner, corner + u, corner + u + v, corner + v}) mesh_.positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh_.indices.push_back(first + i);
    mesh_.material_slots.push_back(material), mesh_.material_slots.push_back(material);
  }

  /// A hill of `edge` x `edge` squares about `middle`, `size` wide, with uv from 0 to 1.
  void hill(const Vec3f& middle, float size, std::uint32_t edge, float phase, std::uint16_t material) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::uint32_t j = 0; j <= edge; ++j)
      for (std::uint32_t i = 0; i <= edge; ++i) {
        const Vec2f uv{static_cast<float>(i) / static_cast<float>(edge),
                       static_cast<float>(j) / static_cast<float>(edge)};
        const float x = uv.x - 0.5f, z = 0.5f - uv.y;
        const float wide = std::cos(3 * x) * std::cos(3 * z),
                    ripples = std::sin(40 * x + phase) * std::sin(37 * z);
        mesh_.positions.push_back(middle + Vec3f{x, 0.35f * wide + 0.02f * ripples, z} * size);
        mesh_.uvs.push_back(uv);
      }
    for (std::uint32_t j = 0; j < edge; ++j)
      for (std::uint32_t i = 0; i < edge; ++i) {
        const std::uint32_t a = first + j * (edge + 1) + i, b = a + edge + 1;
        for (const std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b})
          mesh_.indices.push_back(corner), mesh_.uv_indices.push_back(corner);
        for (int k = 0; k < 2; ++k) mesh_.material_slots.push_back(material);
      }
  }

  /// Stands on `foot`, and its longest side has length `size`.
  void model(const TriangleMesh& model, const Vec3f& foot, float size, std::uint16_t material) {
    Box box;
    for (std::size_t i = 0; i < model.positions.size(); ++i) box.grow(model.positions[i]);
    const Vec3f edges = box.hi - box.lo;
    const float scale = size / max_component(edges);
    const Vec3f middle{(box.lo.x + box.hi.x) / 2, box.lo.y, (box.lo.z + box.hi.z) / 2};
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::size_t i = 0; i < model.positions.size(); ++i)
      mesh_.positions.push_back(foot + (model.positions[i] - middle) * scale);
    for (std::size_t i = 0; i < model.indices.size(); ++i) mesh_.indices.push_back(first + model.indices[i]);
    for (std::size_t i = 0; i < model.triangle_count(); ++i) mesh_.material_slots.push_back(material);
  }

 private:
  TriangleMesh& mesh_;
};

PathMaterial diffuse(const char* name, const Color& color) { return {name, Kind::diffuse, color, 0, 1.5f}; }

/// A room whose front is open, with a panel of light and the model in it.
PathScene room(const char* name, const TriangleMesh& model, const PathMaterial& of_model, float lamp_edge) {
  PathScene s;
  s.name = name;
  s.materials = {diffuse("white", {0.7f, 0.7f, 0.7f}),
                 diffuse("red", {0.6f, 0.08f, 0.06f}),
                 diffuse("green", {0.15f, 0.45f, 0.1f}),
                 {"lamp", Kind::lamp, Color{1, 0.9f, 0.75f} * (4 / (lamp_edge * lamp_edge)), 0, 1.5f},
                 of_model};
  MeshMaker make(s.mesh);
  make.quad({-1.2f, 0, -1.2f}, {2.4f, 0, 0}, {0, 0, 2.4f}, 0);
  make.quad({-1.2f, 2, -1.2f}, {2.4f, 0, 0}, {0, 0, 2.4f}, 0);
  make.quad({-1.2f, 0, -1.2f}, {2.4f, 0, 0}, {0, 2, 0}, 0);
  make.quad({-1.2f, 0, -1.2f}, {0, 0, 2.4f}, {0, 2, 0}, 1);
  make.quad({1.2f, 0, -1.2f}, {0, 0, 2.4f}, {0, 2, 0}, 2);
  make.quad({-lamp_edge / 2, 1.7f, -lamp_edge / 2}, {lamp_edge, 0, 0}, {0, 0, lamp_edge}, 3);
  make.model(model, {0, 0, 0}, 1.2f, 4);
  s.camera.from = {0, 1, 4.4}, s.camera.at = {0, 1, 0}, s.camera.fov = 34;
  return s;
}

/// A sky with a small sun in it.
std::shared_ptr<const EnvironmentPicture> sunny_picture() {
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = 512, picture->height = 256;
  const Vec3f sun = environment_direction(0.62, 0.3);
  for (std::uint32_t y = 0; y < picture->height; ++y)
    for (std::uint32_t x = 0; x < picture->width; ++x) {
      const Vec3f d = environment_direction((x + 0.5) / picture->width, (y + 0.5) / picture->height);
      const float up = std::max(d.y, 0.0f);
      Color c = d.y < 0 ? Color{0.25f, 0.22f, 0.2f}
                        : Color{0.9f, 0.95f, 1} * (1 - up) + Color{0.2f, 0.4f, 0.9f} * up;
      if (dot(d, sun) > 0.999f) c = Color{1, 0.9f, 0.8f} * 400;
      picture->pixels.push_back(c);
    }
  return picture;
}

PathScene outside(const TriangleMesh& model) {
  PathScene s;
  s.name = "environment";
  s.materials = {diffuse("ground", {0.5f, 0.45f, 0.4f}), diffuse("model", {0.75f, 0.7f, 0.65f})};
  MeshMaker make(s.mesh);
  make.quad({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0);
  make.model(model, {0, 0, 0}, 1.6f, 1);
  s.camera.from = {0.3, 1.3, 4}, s.camera.at = {0, 0.7, 0}, s.camera.fov = 34;
  s.environment = sunny_picture();
  return s;
}

/// A thousand lamps that hang over the model.
PathScene lamps(const TriangleMesh& model) {
  PathScene s;
  s.name = "lamps";
  s.materials = {diffuse("ground", {0.5f, 0.5f, 0.5f}), diffuse("model", {0.75f, 0.7f, 0.65f})};
  for (const Color& c :
       {Color{1, 0.3f, 0.2f}, Color{0.3f, 1, 0.4f}, Color{0.3f, 0.5f, 1}, Color{1, 0.9f, 0.6f}})
    s.materials.push_back({fmt::format("lamp{}", s.materials.size()), Kind::lamp, c * 60, 0, 1.5f});
  MeshMaker make(s.mesh);
  make.quad({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0);
  make.model(model, {0, 0, 0}, 1.6f, 1);
  constexpr int kSide = 32;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto random = [&](std::uint32_t which) {
      return random_float(1, static_cast<std::uint32_t>(i), which);
    };
    const float x = (static_cast<float>(i % kSide) + random(1)) / kSide * 12 - 6;
    const float z = (static_cast<float>(i / kSide) + random(2)) / kSide * 12 - 8;
    make.quad({x, 2 + random(3), z}, {0.03f, 0, 0}, {0, 0, 0.03f}, static_cast<std::uint16_t>(2 + i % 4));
  }
  s.camera.from = {0.3, 1.8, 4.4}, s.camera.at = {0, 0.5, 0}, s.camera.fov = 34;
  return s;
}

/// Coloured blocks of 2, 16 and 128 pixels, drawn by chance.
void write_texture(std::uint32_t edge, std::uint32_t seed, const std::string& path) {
  Picture picture;
  picture.width = picture.full_width = edge, picture.height = picture.full_height = edge;
  for (std::uint32_t k = 0; k < 3; ++k) {
    PicturePlane plane;
    plane.name = std::string(1, "RGB"[k]), plane.type = PlaneType::single_float;
    for (std::uint32_t y = 0; y < edge; ++y)
      for (std::uint32_t x = 0; x < edge; ++x) {
        float sum = 0.1f;
        for (const std::uint32_t block : {2u, 16u, 128u})
          sum += 0.25f * random_float(pixel_key(seed, std::uint64_t{y / block} * edge + x / block), k, block);
        plane.values.push_back(sum);
      }
    picture.planes.push_back(std::move(plane));
  }
  write_image(path, picture);
}

std::string texture_path(const std::string& directory, const PathMaterial& m) {
  return fmt::format("{}/texture_{}.png", directory, m.name);
}

template <class T>
void write_column(const Column<T>& column, const std::string& path) {
  write_text(path, std::string(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(T)));
}

std::string numbers(const auto& v) { return fmt::format("{:.9g}, {:.9g}, {:.9g}", v.x, v.y, v.z); }

std::string mtl_of(const PathScene& scene) {
  std::string text;
  for (const PathMaterial& m : scene.materials)
    text += fmt::format("newmtl {}\nillum 1\nKd {:.9g} {:.9g} {:.9g}\nKs 0 0 0\n", m.name, m.color.x,
                        m.color.y, m.color.z);
  return text;
}

std::string obj_of(const PathScene& scene) {
  std::string text = "mtllib scene.mtl\n";
  const TriangleMesh& mesh = scene.mesh;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p = mesh.positions[i];
    fmt::format_to(std::back_inserter(text), "v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
  }
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    if (i == 0 || mesh.material_slots[i] != mesh.material_slots[i - 1])
      text += "usemtl " + scene.materials[mesh.material_slots[i]].name + "\n";
    const std::uint32_t* corner = &mesh.indices[3 * i];
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", corner[0] + 1, corner[1] + 1, corner[2] + 1);
  }
  return text;
}

std::string json_of(const PathScene& scene, std::uint32_t width, std::uint32_t height) {
  constexpr const char* kKinds[] = {"diffuse", "metal", "glass", "lamp"};
  std::string materials;
  for (const PathMaterial& m : scene.materials)
    materials += fmt::format(
        "{}\n    {{\"name\": \"{}\", \"kind\": \"{}\", \"color\": [{}], \"roughness\": {:.9g}, \"ior\": "
        "{:.9g}, \"texture\": {}}}",
        materials.empty() ? "" : ",", m.name, kKinds[static_cast<int>(m.kind)], numbers(m.color), m.roughness,
        m.ior, m.texture);
  return fmt::format(
      "{{\n  \"size\": [{}, {}], \"depth\": {}, \"background\": [{}], \"environment\": {},\n"
      "  \"camera\": {{\"from\": [{}], \"at\": [{}], \"fov\": {}}},\n  \"materials\": [{}]\n}}\n",
      width, height, scene.depth, numbers(scene.background), scene.environment ? "true" : "false",
      numbers(scene.camera.from), numbers(scene.camera.at), scene.camera.fov, materials);
}

/// The middle of Cycles' map is +x of its world, which is +x here, too; a quarter of the map away from -z.
void write_environment(const EnvironmentPicture& from, const std::string& path) {
  Picture picture;
  picture.width = picture.full_width = from.width, picture.height = picture.full_height = from.height;
  for (int k = 0; k < 3; ++k) {
    PicturePlane plane;
    plane.name = std::string(1, "RGB"[k]), plane.type = PlaneType::single_float;
    for (std::uint32_t y = 0; y < from.height; ++y)
      for (std::uint32_t x = 0; x < from.width; ++x)
        plane.values.push_back(from.pixels[y * from.width + (x + from.width / 4) % from.width][k]);
    picture.planes.push_back(std::move(plane));
  }
  write_image(path, picture);
}

Material oktett_material(const PathMaterial& m) {
  Material material;
  material.name = m.name, material.color = m.color;
  material.ambient = 0, material.diffuse = 1;
  if (m.kind == Kind::lamp) material.emission = m.color, material.color = {0, 0, 0};
  if (m.kind == Kind::metal || m.kind == Kind::glass) {
    PrincipledMaterial p;
    p.parameters.base_color = m.color, p.parameters.ior = m.ior, p.parameters.roughness = m.roughness;
    (m.kind == Kind::metal ? p.parameters.metallic : p.parameters.transmission) = 1;
    material.principled = p;
    resemble_principled(material);
  }
  return material;
}

}  // namespace

std::vector<PathScene> path_scenes(const TriangleMesh& model) {
  std::vector<PathScene> scenes;
  scenes.push_back(room("diffuse", model, diffuse("model", {0.75f, 0.7f, 0.65f}), 0.5f));
  scenes.push_back(room("glossy", model, {"model", Kind::metal, {1, 1, 1}, 0.5f, 1.5f}, 0.5f));
  scenes.push_back(room("glass", model, {"model", Kind::glass, {1, 1, 1}, 0, 1.5f}, 1.2f));
  scenes.push_back(outside(model));
  scenes.push_back(lamps(model));
  return scenes;
}

PathScene textured_scene() {
  PathScene s;
  s.name = "textures";
  MeshMaker make(s.mesh);
  for (std::uint16_t i = 0; i < 10; ++i) {
    PathMaterial material = diffuse("", {1, 1, 1});
    material.name = fmt::format("hill{}", i), material.texture = 4096;
    s.materials.push_back(material);
    make.hill({static_cast<float>(i % 4) - 1.5f, 0, -static_cast<float>(i / 4)}, 1, 708, i, i);
  }
  s.camera.from = {0.3, 1.6, 2.6}, s.camera.at = {0, 0.1, -0.8}, s.camera.fov = 40;
  s.environment = sunny_picture();
  return s;
}

Scene oktett_scene(const PathScene& scene, std::uint32_t width, std::uint32_t height,
                   const std::string& directory) {
  Scene out;
  out.camera = scene.camera, out.camera_given = true;
  out.film.width = width, out.film.height = height;
  out.integrator.kind = IntegratorKind::path, out.integrator.depth = scene.depth;
  out.background = scene.background;
  MeshShape shape;
  shape.mesh = std::make_shared<const TriangleMesh>(scene.mesh);
  shape.smooth = false;
  for (const PathMaterial& m : scene.materials) {
    shape.slot_materials.push_back(static_cast<std::uint32_t>(out.materials.size()));
    out.materials.push_back(oktett_material(m));
    if (m.texture == 0) continue;
    out.materials.back().color_texture = static_cast<std::uint32_t>(out.textures.size());
    out.textures.emplace_back().path = texture_path(directory, m);
  }
  Object object;
  object.shape = std::move(shape);
  out.objects.push_back(std::move(object));
  out.lights_given = true;
  if (scene.environment) out.lights.push_back(EnvironmentLight{scene.environment});
  return out;
}

void write_path_scene(const PathScene& scene, std::uint32_t width, std::uint32_t height,
                      const std::string& directory) {
  const TriangleMesh& mesh = scene.mesh;
  if (mesh.uvs.empty()) {
    write_text(directory + "/scene.obj", obj_of(scene));
    write_text(directory + "/scene.mtl", mtl_of(scene));
  }
  write_text(directory + "/scene.json", json_of(scene, width, height));
  write_column(mesh.positions, directory + "/positions.f32");
  write_column(mesh.indices, directory + "/indices.u32");
  write_column(mesh.material_slots, directory + "/slots.u16");
  if (!mesh.uvs.empty()) write_column(mesh.uvs, directory + "/uvs.f32");
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i)
    if (const PathMaterial& m = scene.materials[i]; m.texture != 0)
      write_texture(m.texture, i, texture_path(directory, m));
  if (scene.environment) write_environment(*scene.environment, directory + "/environment.exr");
}

}  // namespace oktett::bench
