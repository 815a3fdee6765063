#include "io/mesh/save/convert_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/gltf/gltf.h"
#include "io/mesh/load/load_file_scene.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/mesh_output.h"
#include "io/mesh/strokes.h"
#include "io/mesh/vertices.h"
#include "io/obj/write_obj.h"
#include "io/ply/header.h"
#include "io/ply/ply.h"
#include "io/stl/stl.h"
#include "io/text/file_content.h"
#include "io/text/files.h"
#include "io/text/number.h"
#include "io/text/scan.h"

namespace oktett {

// ---- What a mesh file says and its reader leaves aside.

namespace {

/// Digits that any float can be told by.
constexpr int kFloatDigits = 9;

/// Digits of a number between its first and its last that is not 0.
int significant_digits(std::string_view number) {
  int digits = 0, zeros = 0;
  for (const char c : number) {
    if (c == 'e' || c == 'E') break;
    if (c < '0' || c > '9' || (c == '0' && digits == 0)) continue;
    zeros = c == '0' ? zeros + 1 : 0;
    ++digits;
  }
  return digits - zeros;
}

/// Whether a coordinate loses something as a float: it has more digits than tell floats apart, and is none.
bool is_beyond_floats(std::string_view number) {
  if (number.size() <= kFloatDigits || significant_digits(number) <= kFloatDigits) return false;
  double exact = 0;
  scan_double(number.data(), exact);
  return static_cast<double>(static_cast<float>(exact)) != exact;
}

/// Of a mesh whose file has coordinates that are no floats. Those of far meshes keep their digits: a centre
/// was taken off.
void note_precision(const TriangleMesh& mesh, MeshLosses& losses) {
  if (mesh.origin == Vec3d{}) losses.push_back(kLostDigits);
}

/// Polygons of more than three corners, by what became of them.
void note_polygons(std::size_t polygons, std::size_t triangles, MeshLosses& losses) {
  if (triangles > polygons)
    losses.push_back("changed: polygons are cut into triangles (" + std::to_string(polygons) + " faces, " +
                     std::to_string(triangles) + " triangles)");
}

struct WrittenCounts {
  std::size_t faces = 0, names = 0;
  bool is_precise = false;
};

void count_line(const char* p, WrittenCounts& counts) {
  const std::string_view keyword = word_at(p);
  if (keyword == "f") ++counts.faces;
  if (keyword == "o" || keyword == "g") ++counts.names;
  if (keyword != "v") return;
  int words = 0;
  for (const char* q = p + keyword.size();; ++words) {
    const std::string_view word = word_at(next_word(q));
    if (word.empty()) break;
    if (words < 3) counts.is_precise = counts.is_precise || is_beyond_floats(word);
    q = word.data() + word.size();
  }
}

void note_obj(std::string_view text, const TriangleMesh& mesh, MeshLosses& losses) {
  WrittenCounts counts;
  const char* const end = text.data() + text.size();
  for (const char* p = text.data(); p < end; p = next_line(find_joined_line_end(p), end))
    count_line(skip_blanks(p), counts);
  if (counts.names > 0)
    losses.push_back("lost: " + count_of(counts.names, "name") + " of objects and groups");
  if (counts.is_precise) note_precision(mesh, losses);
  note_polygons(counts.faces, mesh.triangle_count(), losses);
}

/// Whether some position of a PLY file in bytes is no float. Only files whose vertices come first and have no
/// lists are looked at; others count as precise if they have doubles.
bool has_precise_positions(const PlyHeader& header, std::string_view text) {
  const PlyElement& vertices = header.elements.front();
  if (vertices.name != "vertex" || vertices.has_lists() || header.format == PlyFormat::ascii) return true;
  const std::size_t stride = vertices.least_bytes();
  const bool swap = header.format == PlyFormat::big_endian;
  std::size_t offset = 0;
  for (const PlyProperty& property : vertices.properties) {
    if (property.type == PlyType::float64 &&
        (property.name == "x" || property.name == "y" || property.name == "z"))
      for (std::uint64_t i = 0; i < vertices.count; ++i) {
        const char* const p = header.body + i * stride + offset;
        if (p + sizeof(double) > text.data() + text.size()) return false;  // changed since it was read
        const double x = load_double(property.type, swap, p);
        if (static_cast<double>(static_cast<float>(x)) != x) return true;
      }
    offset += size_of(property.type);
  }
  return false;
}

void note_ply(std::string_view text, const TriangleMesh& mesh, MeshLosses& losses) {
  PlyHeader header;
  try {
    header = read_ply_header(text);
  } catch (const MeshFailure&) {
    return;  // changed since it was read
  }
  const PlyElement* const vertices = header.find("vertex");
  if (vertices != nullptr &&
      std::ranges::any_of(vertices->properties,
                          [](const PlyProperty& property) {
                            return property.type == PlyType::float64 && !property.is_list;
                          }) &&
      has_precise_positions(header, text))
    note_precision(mesh, losses);
  const PlyElement* const faces = header.find("face");
  if (faces != nullptr && header.find("tristrips") == nullptr)
    note_polygons(faces->count, mesh.triangle_count(), losses);
}

/// Some programs write colours of facets to the two bytes behind each.
void note_stl(std::string_view text, const TriangleMesh& mesh, MeshLosses& losses) {
  const std::size_t triangles = mesh.triangle_count();
  if (text.size() < 84 + 50 * triangles) return;
  std::uint32_t stated = 0;
  std::memcpy(&stated, text.data() + 80, sizeof stated);
  if (stated != triangles) return;
  for (std::size_t i = 0; i < triangles; ++i) {
    const char* const attribute = text.data() + 84 + 50 * i + 48;
    if (attribute[0] == 0 && attribute[1] == 0) continue;
    losses.push_back("lost: attributes of facets, such as colours");
    return;
  }
}

// ---- Formats.

namespace fs = std::filesystem;

/// All that converting knows of a format.
struct ConvertedFormat {
  std::string_view extension;
  /// Adds to `losses` what the text of a file says beside the mesh that its reader made: names of objects and
  /// groups, polygons, digits beyond those of a float. Null: nothing more to say.
  void (*note_unread)(std::string_view text, const TriangleMesh& mesh, MeshLosses& losses);
  MeshLosses (*write)(const std::string& path, const MeshFile& file, bool ascii);
  bool has_text;       ///< there are files of text and of bytes
  bool has_materials;  ///< it can say some of them
};

/// For formats that are always text, or never.
template <MeshLosses (*write)(const std::string& path, const MeshFile& file)>
MeshLosses write_either(const std::string& path, const MeshFile& file, bool) {
  return write(path, file);
}

constexpr std::array kConvertedFormats{
    ConvertedFormat{".obj", note_obj, write_either<write_obj>, false, true},
    ConvertedFormat{".ply", note_ply, write_ply, true, true},
    ConvertedFormat{".stl", note_stl, write_stl, true, false},
    ConvertedFormat{".glb", nullptr, write_either<write_glb>, false, true},
};

/// The format with this end, or null.
const ConvertedFormat* find_converted(const std::string& extension) {
  const auto found = std::ranges::find(kConvertedFormats, extension, &ConvertedFormat::extension);
  return found == kConvertedFormats.end() ? nullptr : found;
}

const ConvertedFormat& written_format(const std::string& path, const ConvertOptions& options) {
  const ConvertedFormat* const format = find_converted(lower_case_extension(path));
  if (format == nullptr)
    throw Error(Location{path},
                "unknown kind of mesh file to write; expected " + or_list(written_mesh_extensions()));
  if (options.ascii && !format->has_text)
    throw Error(Location{path},
                "--ascii is for " + and_list(text_mesh_extensions()) + ", which are bytes without it");
  return *format;
}

/// What glTF and 3MF say beside meshes.
void note_scene(const FileScene& scene, MeshLosses& losses) {
  if (scene.placements.size() > scene.meshes.size())
    losses.push_back("changed: " + count_of(scene.placements.size() - scene.meshes.size(), "instance") +
                     " of meshes that are shown before, written as further triangles");
  if (scene.placements.size() > 1 ||
      std::ranges::any_of(scene.placements, [](const PlacedMesh& p) { return !p.name.empty(); }))
    losses.push_back("lost: names of " + count_of(scene.placements.size(), "object") +
                     ", which become one mesh");
  if (scene.camera) losses.push_back("lost: cameras");
  if (!scene.lights.empty()) losses.push_back("lost: " + count_of(scene.lights.size(), "light"));
}

MeshFile load(const std::string& path, const ConvertOptions& options, MeshLosses& losses) {
  if (!has_file_scene(path)) {
    check_gltf_options(path, options.gltf);
    MeshFile file = load_mesh(path);
    const ConvertedFormat* const format = find_converted(lower_case_extension(without_packing(path)));
    if (format != nullptr && format->note_unread != nullptr)
      format->note_unread(FileContent(path).text(), file.mesh, losses);
    if (options.weld) weld_positions(file.mesh);
    return file;
  }
  FileScene scene = load_file_scene(path, options.gltf);
  note_scene(scene, losses);
  MeshFile file = one_mesh(path, std::move(scene));
  if (options.weld) weld_positions(file.mesh);
  return file;
}

}  // namespace

std::vector<std::string> written_mesh_extensions() {
  std::vector<std::string> extensions;
  for (const ConvertedFormat& format : kConvertedFormats) extensions.emplace_back(format.extension);
  return extensions;
}

std::vector<std::string> text_mesh_extensions() {
  std::vector<std::string> extensions;
  for (const ConvertedFormat& format : kConvertedFormats)
    if (format.has_text) extensions.emplace_back(format.extension);
  return extensions;
}

void check_mesh_output(const std::string& path, const ConvertOptions& options) {
  written_format(path, options);
  const OutputFile probe(path);
}

static void check_not_input(const std::string& input, const std::string& output) {
  std::error_code error;
  if (fs::equivalent(input, output, error)) throw Error(Location{output}, "is the input, too");
}

Conversion write_mesh(const std::string& input, MeshFile file, const std::string& output,
                      const ConvertOptions& options) {
  const ConvertedFormat& format = written_format(output, options);
  check_not_input(input, output);
  Conversion result;
  result.triangles = file.mesh.triangle_count(), result.vertices = file.mesh.positions.size();
  result.warnings = std::move(file.warnings);
  StrokeCount strokes;
  strokes.add(file.strokes);
  if (result.triangles == 0)
    throw Error(Location{input}, strokes.all() == 0
                                     ? "no triangles to convert"
                                     : "no triangles to convert; points and lines are not written");
  if (strokes.all() > 0) result.losses.push_back("lost: " + strokes.text());
  if (!format.has_materials) {
    if (!file.materials.empty())
      result.losses.push_back("lost: " + count_of(file.materials.size(), "material"));
    if (!file.textures.empty()) result.losses.push_back("lost: " + count_of(file.textures.size(), "texture"));
  }
  std::ranges::move(format.write(output, file, options.ascii), std::back_inserter(result.losses));
  return result;
}

Conversion convert_mesh(const std::string& input, const std::string& output, const ConvertOptions& options) {
  written_format(output, options);
  check_not_input(input, output);
  MeshLosses losses;
  Conversion result = write_mesh(input, load(input, options, losses), output, options);
  result.losses.insert(result.losses.begin(), losses.begin(), losses.end());
  return result;
}

}  // namespace oktett
