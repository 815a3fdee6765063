#include "io/scene/write_scene.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <variant>

#include "io/scene/readers.h"
#include "io/scene/shape_text.h"
#include "kernels/heights/height_grid.h"
#include "render/recentre.h"

namespace oktett {
namespace {

/// A grey TIFF image, uncompressed: each sample `bytes` bytes, of floats if `floats`, else whole numbers.
std::string tiff(std::uint32_t columns, std::uint32_t rows, const std::string& samples, std::uint32_t bytes,
                 bool floats) {
  std::string out("II*\0", 4);
  const auto put = [&](std::uint32_t value, int size) {
    for (int k = 0; k < size; ++k) out += static_cast<char>(value >> (8 * k));
  };
  constexpr std::uint32_t kHeader = 8, kShort = 3, kLong = 4;
  put(kHeader + static_cast<std::uint32_t>(samples.size()), 4);
  out += samples;
  const struct {
    std::uint32_t tag, type, value;
  } entries[] = {{256, kLong, columns},
                 {257, kLong, rows},
                 {258, kShort, 8 * bytes},
                 {259, kShort, 1},
                 {262, kShort, 1},
                 {273, kLong, kHeader},
                 {277, kShort, 1},
                 {278, kLong, rows},
                 {279, kLong, static_cast<std::uint32_t>(samples.size())},
                 {339, kShort, floats ? 3u : 1u}};
  put(static_cast<std::uint32_t>(std::size(entries)), 2);
  for (const auto& e : entries) put(e.tag, 2), put(e.type, 2), put(1, 4), put(e.value, 4);
  put(0, 4);
  return out;
}

class SceneWriter {
 public:
  explicit SceneWriter(const std::string& path, const Scene& scene) : scene_(scene), files_(path) {}

  std::string text() {
    std::string out = "oktett: 1\n";
    const Camera& c = scene_.camera;
    // With a camera near the origin a scene of far objects is not moved when it is read.
    if (scene_.camera_given || would_move())
      out += fmt::format("camera: {{from: {}, at: {}, up: {}, fov: {}}}\n", vector_text(c.from),
                         vector_text(c.at), vector_text(c.up), c.fov);
    if (!scene_.prototypes.empty()) out += "define:\n";
    for (const Prototype& p : scene_.prototypes) out += "  " + quoted(p.name) + ":\n" + group(p.objects);
    out += scene_.objects.empty() ? "objects: []\n" : "objects:\n";
    for (const Object& object : scene_.objects) out += "  - " + object_text(object) + "\n";
    return out;
  }

 private:
  bool would_move() const {
    Scene copy = scene_;
    recentre(copy);
    return !(copy.origin == scene_.origin);
  }

  std::string group(const std::vector<Object>& objects) {
    std::string out = "    group:\n";
    for (const Object& object : objects) out += "      - " + object_text(object) + "\n";
    return out;
  }

  /// In one line, since operands stand inside.
  std::string object_text(const Object& object) {
    std::string out = "{" + what(object.shape);
    if (!object.transform.is_identity()) out += ", transform: " + transform_text(object.transform);
    if (!object.name.empty()) out += ", name: " + quoted(object.name);
    return out + "}";
  }

  std::string what(const Shape& shape) {
    if (const auto* instance = std::get_if<InstanceShape>(&shape))
      return "instance: " + quoted(scene_.prototypes[instance->prototype].name);
    const auto* csg = std::get_if<CsgShape>(&shape);
    if (!csg) return shape_text(shape, files_);
    std::string out;
    for (const auto& key : kCsgKeys)
      if (key.value == csg->op) out = std::string(key.name) + ": [";
    for (const Object& operand : *csg->operands)
      out += (&operand == csg->operands->data() ? "" : ", ") + object_text(operand);
    out += "]";
    if (csg->windows == nullptr) return out;
    out += ", seen_through: [";
    for (const Object& window : *csg->windows)
      out += (&window == csg->windows->data() ? "" : ", ") + object_text(window);
    return out + "]";
  }

  static std::string quoted(const std::string& name) {
    std::string out = "\"";
    for (const char c : name) out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return out + '"';
  }

  const Scene& scene_;
  SideFiles files_;
};

}  // namespace

void write_text(const std::string& path, std::string_view text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  const bool written = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const int reason = errno;
  if ((file != nullptr && std::fclose(file) != 0) || !written)
    throw Error(Location{path, 0, 0}, std::string("cannot be written: ") + std::strerror(reason),
                ErrorKind::io);
}

std::string SideFiles::next(const char* extension) {
  std::filesystem::path path(scene_path_);
  path.replace_extension();
  return fmt::format("{}-{}{}", path.string(), ++count_, extension);
}

std::string SideFiles::mesh(const TriangleMesh& mesh) {
  std::string out;
  for (const Vec3f& p : mesh.positions) out += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out += fmt::format("f {} {} {}\n", mesh.indices[i] + 1, mesh.indices[i + 1] + 1, mesh.indices[i + 2] + 1);
  const std::string path = next(".obj");
  write_text(path, out);
  return std::filesystem::path(path).filename().string();
}

std::string SideFiles::heights(const HeightGrid& grid) {
  const bool words = grid.unit() != 1;
  std::string samples;
  for (std::uint32_t j = 0; j < grid.rows(); ++j)
    for (std::uint32_t i = 0; i < grid.columns(); ++i) {
      const auto word = static_cast<std::uint16_t>(words ? grid.at(i, j) : 0);
      const auto real = static_cast<float>(grid.at(i, j));
      samples.append(words ? reinterpret_cast<const char*>(&word) : reinterpret_cast<const char*>(&real),
                     words ? sizeof word : sizeof real);
    }
  const std::string path = next(".tif");
  write_text(path, tiff(grid.columns(), grid.rows(), samples, words ? 2 : 4, !words));
  return std::filesystem::path(path).filename().string();
}

void write_scene_file(const std::string& path, const Scene& scene, const std::string& comment) {
  std::string out;
  for (std::size_t begin = 0; begin < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', begin), comment.size());
    out += "# " + comment.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  write_text(path, out + SceneWriter(path, scene).text());
}

}  // namespace oktett
