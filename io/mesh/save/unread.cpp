#include "io/mesh/save/unread.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "io/ply/header.h"
#include "io/text/extension.h"
#include "io/text/file_content.h"
#include "io/text/scan.h"

namespace oktett {
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

void note_precision(MeshLosses& losses) {
  losses.push_back("lost: digits of coordinates beyond single precision");
}

/// Polygons of more than three corners, by what became of them.
void note_polygons(std::size_t polygons, std::size_t triangles, MeshLosses& losses) {
  if (triangles > polygons)
    losses.push_back("changed: polygons are cut into triangles (" + std::to_string(polygons) + " faces, " +
                     std::to_string(triangles) + " triangles)");
}

struct WrittenCounts {
  std::size_t faces = 0, names = 0, colours = 0;
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
    if (words < 3 && word.size() > kFloatDigits)
      counts.is_precise = counts.is_precise || significant_digits(word) > kFloatDigits;
    q = word.data() + word.size();
  }
  if (words >= 6) ++counts.colours;
}

void note_obj(std::string_view text, std::size_t triangles, MeshLosses& losses) {
  WrittenCounts counts;
  const char* const end = text.data() + text.size();
  for (const char* p = text.data(); p < end; p = next_line(find_joined_line_end(p), end))
    count_line(skip_blanks(p), counts);
  if (counts.names > 0)
    losses.push_back("lost: " + count_of(counts.names, "name") + " of objects and groups");
  if (counts.colours > 0) losses.push_back("lost: colours of vertices");
  if (counts.is_precise) note_precision(losses);
  note_polygons(counts.faces, triangles, losses);
}

void note_ply(std::string_view text, std::size_t triangles, MeshLosses& losses) {
  PlyHeader header;
  try {
    header = read_ply_header(text);
  } catch (const MeshFailure&) {
    return;  // changed since it was read
  }
  const PlyElement* const vertices = header.find("vertex");
  if (vertices != nullptr && std::ranges::any_of(vertices->properties, [](const PlyProperty& property) {
        return property.type == PlyType::float64 && !property.is_list;
      }))
    note_precision(losses);
  const PlyElement* const faces = header.find("face");
  if (faces != nullptr && header.find("tristrips") == nullptr) note_polygons(faces->count, triangles, losses);
}

/// Some programs write colours of facets to the two bytes behind each.
void note_stl(std::string_view text, std::size_t triangles, MeshLosses& losses) {
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

}  // namespace

void note_unread(const std::string& path, std::size_t triangles, MeshLosses& losses) {
  const FileContent file(path);
  const std::string extension = lower_case_extension(without_packing(path));
  if (extension == ".obj") note_obj(file.text(), triangles, losses);
  if (extension == ".ply") note_ply(file.text(), triangles, losses);
  if (extension == ".stl") note_stl(file.text(), triangles, losses);
}

}  // namespace oktett
