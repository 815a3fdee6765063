#include "io/off/off.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/far_mesh.h"
#include "core/phase.h"
#include "io/mesh/polygon.h"
#include "io/mesh/rounding.h"
#include "io/text/file_content.h"
#include "io/text/number.h"

namespace oktett {
namespace {

/// What the header says of a vertex.
struct OffHeader {
  bool has_uv = false, has_color = false, has_normal = false;
};

/// The loading of one file.
class OffLoad {
 public:
  OffLoad(const std::string& path, const MeshReadOptions& options)
      : path_(path), options_(options), file_(path), text_(without_byte_order_mark(file_.text())) {}

  ParsedMesh run() {
    try {
      next_ = text_.data();
      read_header();
      read_counts();
      vertices_ = next_;
      if (has_unsaid_colors()) header_.has_color = true;
      read_vertices({});
      recentre();
      read_faces();
      note_rounding(parsed_, [this](const Vec3d& centre) { read_vertices(centre); });
    } catch (const MeshFailure& failure) {
      fail_at_line(path_, text_, failure);
    }
    oddities_.report([this](const char* where, std::string words) { note(where, std::move(words)); });
    if (colors_ != nullptr) note(colors_, "colours are not read");
    phase_.add(text_.size());
    parsed_.has_faces = parsed_.mesh.triangle_count() > 0;
    return std::move(parsed_);
  }

 private:
  const char* text_end() const { return text_.data() + text_.size(); }

  /// Past blanks, line ends and comments.
  void skip_space() {
    while (next_ < text_end()) {
      if (*next_ == '#')
        next_ = find_line_end(next_);
      else if (is_blank(*next_) || (is_line_end(*next_) && *next_ != '\0'))
        ++next_;
      else
        return;
    }
  }

  void skip_word() {
    while (next_ < text_end() && !is_blank(*next_) && !is_line_end(*next_)) ++next_;
  }

  std::string found() const {
    return next_ >= text_end() ? "found the end of the file" : "found " + quote_word(next_);
  }

  bool take(std::string_view word) {
    if (!std::string_view(next_, static_cast<std::size_t>(text_end() - next_)).starts_with(word))
      return false;
    next_ += word.size();
    return true;
  }

  void read_header() {
    skip_space();
    const char* const start = next_;
    if (*next_ >= '0' && *next_ <= '9') return;  // the keyword may be left out
    header_.has_uv = take("ST");
    header_.has_color = take("C");
    header_.has_normal = take("N");
    if (*next_ == '4' || *next_ == 'n') stop_at(start, "OFF files of four or more dimensions are not read");
    if (!take("OFF")) {
      next_ = start;
      stop_at(start, "expected 'OFF', also with ST, C or N before it, " + found());
    }
    const char* const behind = skip_plain_blanks(next_);
    if (std::string_view(behind, static_cast<std::size_t>(text_end() - behind)).starts_with("BINARY"))
      stop_at(behind, "OFF files of bytes are not read; expected text");
  }

  std::uint64_t read_count(const char* of) {
    skip_space();
    std::uint64_t count = 0;
    const char* const end = scan_whole(next_, count);
    if (end == next_ || !is_delimiter(end))
      stop_at(next_, std::string("expected the number of ") + of + ", " + found());
    next_ = end;
    return count;
  }

  void read_counts() {
    vertex_count_ = read_count("vertices");
    face_count_ = read_count("faces");
    // That of edges, which some leave out.
    next_ = skip_plain_blanks(next_);
    if (next_ < text_end() && !is_line_end(*next_) && *next_ != '#') read_count("edges");
    check_limit(path_, vertex_count_, "vertices", options_.max_elements);
    check_limit(path_, face_count_, "faces", options_.max_elements);
    // A number takes a digit and a blank.
    const auto left = static_cast<std::uint64_t>(text_end() - next_);
    if (vertex_count_ > left / 6 + 1 || face_count_ > left / 2 + 1)
      stop_at(next_, "the file is too short for " + std::to_string(vertex_count_) + " vertices and " +
                         std::to_string(face_count_) + " faces");
  }

  template <class Read>
  float read_value(const Read& read) {
    skip_space();
    if (next_ >= text_end()) stop_at(next_, "expected a number, found the end of the file");
    float x = 0;
    next_ = read(next_, x);
    return x;
  }

  /// Their positions less `centre`.
  void read_vertices(const Vec3d& centre) {
    TriangleMesh& mesh = parsed_.mesh;
    next_ = vertices_;
    oddities_.bad_normals = {};
    mesh.positions.resize_uninitialized(vertex_count_);
    if (header_.has_normal) mesh.normals.resize_uninitialized(vertex_count_);
    if (header_.has_uv) mesh.uvs.resize_uninitialized(vertex_count_);
    for (std::uint64_t i = 0; i < vertex_count_; ++i) {
      for (int k = 0; k < 3; ++k) {
        mesh.positions[i][k] =
            read_value([&](const char* p, float& x) { return read_coordinate_from(centre[k], p, x); });
      }
      if (header_.has_normal) {
        skip_space();
        const char* const where = next_;
        for (int k = 0; k < 3; ++k) mesh.normals[i][k] = read_value(read_number);
        if (!is_finite(mesh.normals[i])) oddities_.bad_normals.add(where);
      }
      if (header_.has_color) read_vertex_color();
      if (header_.has_uv) {
        mesh.uvs[i].x = read_value(read_uv_coordinate);
        mesh.uvs[i].y = read_value(read_uv_coordinate);
      }
    }
  }

  /// Some write colours behind positions without 'C' in the header. Two vertices on a line leave fewer lines.
  bool has_unsaid_colors() {
    if (header_.has_color || header_.has_normal || header_.has_uv) return false;
    skip_space();
    const std::size_t count = count_words(next_);
    if (count != 6 && count != 7) return false;
    std::uint64_t lines = 0;
    for (const char* p = next_; p < text_end() && lines < vertex_count_ + face_count_; p = find_line_end(p)) {
      while (p < text_end() && (is_blank(*p) || is_line_end(*p))) ++p;
      if (p == text_end()) break;
      if (*p == '#') continue;
      if (lines < vertex_count_ && count_words(p) != count) return false;
      ++lines;
    }
    return lines == vertex_count_ + face_count_;
  }

  void recentre() {
    const std::optional<Vec3d> centre = far_centre(parsed_.mesh.positions, false);
    if (!centre) return;
    parsed_.mesh.origin = *centre;
    read_vertices(*centre);
  }

  /// Three or four numbers: the rest of the line tells.
  void read_vertex_color() {
    skip_space();
    note_color();
    const std::size_t others = header_.has_uv ? 2 : 0;
    std::size_t count = count_words(next_);
    count = count >= others ? count - others : 0;
    for (std::size_t k = 0; k < std::clamp<std::size_t>(count, 3, 4); ++k) read_value(read_number);
  }

  void note_color() {
    if (colors_ == nullptr) colors_ = next_;
  }

  void read_faces() {
    for (std::uint64_t i = 0; i < face_count_; ++i) read_face();
    TriangleMesh& mesh = parsed_.mesh;
    check_limit(path_, indices_.size() / 3, "triangles", options_.max_elements);
    mesh.indices.resize_uninitialized(indices_.size());
    std::ranges::copy(indices_, mesh.indices.data());
    if (header_.has_normal) mesh.normal_indices = mesh.indices;
    if (header_.has_uv) mesh.uv_indices = mesh.indices;
    skip_space();
    if (next_ < text_end()) note(next_, "what stands behind the last face is not read");
  }

  void read_face() {
    skip_space();
    const char* const where = next_;
    std::uint64_t corners = 0;
    const char* const end = scan_whole(next_, corners);
    if (end == next_ || !is_delimiter(end)) stop_at(next_, "expected the number of corners, " + found());
    next_ = end;
    if (corners > static_cast<std::uint64_t>(text_end() - next_) / 2 + 1)
      stop_at(where, "the file is too short for a face of " + std::to_string(corners) + " corners");
    corners_.clear();
    for (std::uint64_t k = 0; k < corners; ++k) corners_.push_back(read_corner());
    write_polygon(where);
    // A colour, or the index of one, on the same line.
    next_ = skip_plain_blanks(next_);
    if (next_ >= text_end() || is_line_end(*next_) || *next_ == '#') return;
    note_color();
    next_ = find_line_end(next_);
  }

  std::uint32_t read_corner() {
    skip_space();
    std::uint64_t index = 0;
    const char* const end = scan_whole(next_, index);
    if (end == next_ || !is_delimiter(end)) stop_at(next_, "expected a vertex index, " + found());
    if (index >= vertex_count_)
      stop_at(next_, "vertex index " + std::to_string(index) + " is out of range: the file has " +
                         std::to_string(vertex_count_) + " vertices");
    next_ = end;
    return static_cast<std::uint32_t>(index);
  }

  void write_polygon(const char* where) {
    if (corners_.size() < 3) {
      oddities_.small_faces.add(where);
      return;
    }
    if (corners_.size() == 3) {
      indices_.insert(indices_.end(), corners_.begin(), corners_.end());
      return;
    }
    points_.clear();
    for (const std::uint32_t corner : corners_) points_.push_back(parsed_.mesh.positions[corner]);
    for (const std::uint32_t k : triangulator_.run(points_)) indices_.push_back(corners_[k]);
    if (triangulator_.crosses_itself()) oddities_.crossings.add(where);
  }

  void note(const char* where, std::string words) {
    parsed_.notices.push_back(
        {static_cast<std::uint64_t>(where - text_.data()), std::move(words), LineCounter(text_).at(where)});
  }

  const std::string path_;
  const MeshReadOptions options_;
  const FileContent file_;
  const std::string_view text_;
  Phase phase_{"reading", std::filesystem::path(path_).filename().string(), text_.size()};
  const char *next_ = nullptr, *vertices_ = nullptr;
  OffHeader header_;
  std::uint64_t vertex_count_ = 0, face_count_ = 0;
  std::vector<std::uint32_t> corners_, indices_;
  std::vector<Vec3f> points_;
  PolygonTriangulator triangulator_;
  MeshOddities oddities_;
  const char* colors_ = nullptr;  ///< where the first one stands
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh parse_off(const std::string& path, const MeshReadOptions& options) {
  return OffLoad(path, options).run();
}

}  // namespace oktett
