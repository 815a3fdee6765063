#include "io/ply/ply.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/far_mesh.h"
#include "core/phase.h"
#include "io/mesh/rounding.h"
#include "io/ply/body.h"
#include "io/text/file_content.h"

namespace oktett {

std::uint64_t count_polygon(std::uint64_t corners) { return corners < 3 ? 0 : corners - 2; }

void check_texcoords(std::uint64_t values, std::uint64_t corners, const char* where) {
  if (values == 0 || values == 2 * corners) return;
  stop_at(where, "expected " + std::to_string(2 * corners) + " texture coordinates for " +
                     std::to_string(corners) + " corners, or none, found " + std::to_string(values));
}

void PlyFaceWriter::begin(const char* where) {
  where_ = where;
  first_ = next_;
  corners_.clear();
  uvs_.clear();
}

void check_ply_index(std::int64_t index, std::uint64_t vertices, const char* where) {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertices)
    stop_at(where, "vertex index " + std::to_string(index) + " is out of range: the file has " +
                       std::to_string(vertices) + " vertices");
}

void PlyEdgeWriter::add(std::int64_t index, const char* where) {
  check_ply_index(index, vertices_, where);
  *next_++ = static_cast<std::uint32_t>(index);
}

void PlyFaceWriter::check_index(std::int64_t index, const char* where) const {
  check_ply_index(index, vertex_count_, where);
}

void PlyFaceWriter::add_index(std::int64_t index, const char* where) {
  if (strips_ && index == -1) {
    corners_.push_back(kNoId);
    return;
  }
  check_index(index, where);
  corners_.push_back(static_cast<std::uint32_t>(index));
}

void PlyFaceWriter::end() {
  if (strips_)
    write_strips();
  else
    write_polygon();
}

std::uint32_t* PlyFaceWriter::take_triangles(std::uint64_t count, const char* where) {
  if (count > last_ - next_) stop_changed(where);
  std::uint32_t* const indices = mesh_.indices.data() + 3 * next_;
  next_ += count;
  return indices;
}

/// The arguments are numbers of corners.
void PlyFaceWriter::write(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (next_ == last_) stop_changed(where_);
  const std::size_t at = 3 * next_++;
  const std::uint32_t corner[3] = {a, b, c};
  for (std::size_t k = 0; k < 3; ++k) {
    mesh_.indices[at + k] = corners_[corner[k]];
    if (mesh_.uv_indices.empty()) continue;
    mesh_.uv_indices[at + k] = uvs_.empty() ? kNoId : static_cast<std::uint32_t>(next_uv_ + corner[k]);
  }
}

void PlyFaceWriter::write_strips() {
  std::uint32_t length = 0;
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    length = corners_[i] == kNoId ? 0 : length + 1;
    // Every second triangle of a strip runs the other way round.
    if (length > 2 && length % 2 == 1) write(i - 2, i - 1, i);
    if (length > 2 && length % 2 == 0) write(i - 1, i - 2, i);
  }
}

void PlyFaceWriter::write_polygon() {
  check_texcoords(uvs_.size(), corners_.size(), where_);
  if (uvs_.size() / 2 > last_uv_ - next_uv_) stop_changed(where_);
  for (std::size_t i = 0; i < uvs_.size() / 2; ++i) mesh_.uvs[next_uv_ + i] = {uvs_[2 * i], uvs_[2 * i + 1]};
  if (corners_.size() < 3) {
    oddities_.small_faces.add(where_);
  } else if (corners_.size() == 3) {
    write(0, 1, 2);
  } else {
    points_.clear();
    for (const std::uint32_t corner : corners_) points_.push_back(mesh_.positions[corner]);
    const std::span<const std::uint32_t> cut = triangulator_.run(points_);
    if (triangulator_.crosses_itself()) oddities_.crossings.add(where_);
    for (std::size_t i = 0; i < cut.size(); i += 3) write(cut[i], cut[i + 1], cut[i + 2]);
  }
  next_uv_ += uvs_.size() / 2;
}

namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Vec2f) == 2 * sizeof(float));

/// The loading of one file, step by step.
class PlyLoad {
  static constexpr std::array<const char*, 2> kEdgeEnds{"vertex1", "vertex2"};

 public:
  PlyLoad(const std::string& path, const MeshReadOptions& options)
      : path_(path), options_(options), file_(path), text_(without_byte_order_mark(file_.text())) {}

  ParsedMesh run() {
    try {
      header_ = read_ply_header(text_);
      in_header_ = false;
      choose_parts();
      const bool is_text = header_.format == PlyFormat::ascii;
      body_ = (is_text ? make_ascii_body : make_binary_body)(header_, text_, options_.chunk_bytes);
      note_rest(body_->locate(parts_), is_text);
      for (PlyFaces& faces : faces_) body_->count_faces(faces);
      stop_at_first_failure();
      allocate();
      read_vertices();
      read_faces();
      note_rounding();
      read_edges();
    } catch (const MeshFailure& failure) {
      const bool is_line = in_header_ || header_.format == PlyFormat::ascii || failure.where < header_.body;
      (is_line ? fail_at_line : fail_at_byte)(path_, is_line ? text_ : file_.text(), failure);
    }
    finish();
    return std::move(parsed_);
  }

 private:
  /// What each element is to the mesh. Places of the parts are those of the elements.
  void choose_parts() {
    for (const MeshFailure& notice : header_.notices) note(notice.where, notice.message);
    faces_.reserve(header_.elements.size());
    edges_.reserve(header_.elements.size());
    others_.reserve(header_.elements.size());
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        choose_vertices(element);
        parts_.push_back(&vertices_);
      } else if (element.name == "face" || element.name == "tristrips") {
        parts_.push_back(&choose_faces(element));
      } else if (element.name == "edge" && is_edge(element)) {
        parts_.push_back(&choose_edges(element));
      } else {
        parts_.push_back(&others_.emplace_back());
        if (element.count > 0) note(element.where, "element " + quote_name(element.name) + " is not read");
      }
      parts_.back()->element = &element;
    }
    if (vertices_.element == nullptr) stop_at(header_.body, "expected an element 'vertex' in the header");
    choose_face_extras();
  }

  void choose_vertices(const PlyElement& element) {
    const auto find = [&](std::string_view name) { return scalar(element, name); };
    vertices_.roles = {find("x"),  find("y"),  find("z"),         find("nx"),
                       find("ny"), find("nz"), PlyElement::kNone, PlyElement::kNone};
    constexpr std::pair<std::string_view, std::string_view> kUvNames[] = {
        {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
    for (const auto& [u, v] : kUvNames)
      if (!has(6, 8) && find(u) != PlyElement::kNone && find(v) != PlyElement::kNone)
        vertices_.roles[6] = find(u), vertices_.roles[7] = find(v);
    if (!has(0, 3)) stop_at(element.where, "expected the properties x, y and z of element 'vertex'");
    vertices_.has_normals = has(3, 6);
    vertices_.has_uvs = has(6, 8);
    vertices_.extras = choose_attributes(element, vertices_.roles, AttributeDomain::vertex, attributes_);
  }

  bool has(std::size_t first, std::size_t last) const {
    return std::all_of(vertices_.roles.begin() + static_cast<std::ptrdiff_t>(first),
                       vertices_.roles.begin() + static_cast<std::ptrdiff_t>(last),
                       [](int property) { return property != PlyElement::kNone; });
  }

  PlyFaces& choose_faces(const PlyElement& element) {
    PlyFaces& faces = faces_.emplace_back();
    faces.strips = element.name == "tristrips";
    faces.indices = element.find({"vertex_indices", "vertex_index"});
    if (faces.indices == PlyElement::kNone)
      stop_at(element.where, "expected a property 'vertex_indices' of element " + quote_name(element.name));
    const PlyProperty& indices = element.properties[static_cast<std::size_t>(faces.indices)];
    if (!indices.is_list || !is_whole(indices.type))
      stop_at(indices.where, "expected a list of whole numbers, the indices of vertices");
    const int texcoords = faces.strips ? PlyElement::kNone : element.find({"texcoord"});
    if (texcoords != PlyElement::kNone && element.properties[static_cast<std::size_t>(texcoords)].is_list)
      faces.texcoords = texcoords;
    return faces;
  }

  static bool is_edge(const PlyElement& element) {
    return std::ranges::all_of(kEdgeEnds, [&](const char* name) {
      const int i = scalar(element, name);
      return i != PlyElement::kNone && is_whole(element.properties[static_cast<std::size_t>(i)].type);
    });
  }

  PlyEdges& choose_edges(const PlyElement& element) {
    PlyEdges& edges = edges_.emplace_back();
    for (std::size_t k = 0; k < 2; ++k)
      edges.ends[k] = static_cast<std::size_t>(scalar(element, kEdgeEnds[k]));
    edges.before = edge_count_;
    edge_count_ += element.count;
    if (element.count > 0 && element.properties.size() > 2)
      note(element.where, "of element 'edge' only 'vertex1' and 'vertex2' are read");
    return edges;
  }

  /// What numbers of faces become. After the vertices, whose names count first.
  void choose_face_extras() {
    for (PlyFaces& faces : faces_) {
      if (faces.strips) continue;
      const int texnumber =
          header_.textures.empty() ? PlyElement::kNone : scalar(*faces.element, "texnumber");
      const int used[] = {texnumber};
      faces.extras = choose_attributes(*faces.element, used, AttributeDomain::face, attributes_);
      if (texnumber == PlyElement::kNone) continue;
      faces.extras.push_back({.property = texnumber, .meaning = PlyMeaning::slot});
      has_texnumbers_ = true;
    }
  }

  static int scalar(const PlyElement& element, std::string_view name) {
    const int i = element.find({name});
    return i != PlyElement::kNone && element.properties[static_cast<std::size_t>(i)].is_list
               ? PlyElement::kNone
               : i;
  }

  void note(const char* where, std::string words) {
    parsed_.notices.push_back(
        {static_cast<std::uint64_t>(where - text_.data()), std::move(words), lines_.at(where)});
  }

  void note_rest(std::uint64_t rest, bool is_text) {
    if (rest > 0)
      parsed_.notices.push_back(
          {text_.size(),
           std::to_string(rest) + (is_text ? " lines" : " bytes") + " behind the last element are not read",
           {0, 0}});
  }

  void note_oddities() {
    MeshOddities all;
    for (const PlyPart* part : parts_)
      for (const PlyChunk& chunk : part->chunks) all += chunk.oddities;
    all.report([this](const char* where, std::string words) {
      // Bytes have no lines.
      if (header_.format == PlyFormat::ascii || where < header_.body)
        note(where, std::move(words));
      else
        parsed_.notices.push_back(
            {static_cast<std::uint64_t>(where - text_.data()), std::move(words), {0, 0}});
    });
  }

  void stop_at_first_failure() const {
    std::optional<MeshFailure> first;
    for (const PlyPart* part : parts_)
      for (const PlyChunk& chunk : part->chunks) keep_first(first, chunk.failure);
    if (first) throw *first;
  }

  void allocate() {
    std::uint64_t triangles = 0, uvs = 0;
    for (PlyFaces& faces : faces_) {
      for (PlyChunk& chunk : faces.chunks) {
        chunk.triangles_before = triangles, chunk.uvs_before = uvs;
        triangles += chunk.triangles, uvs += chunk.uvs;
      }
      corner_uvs_ = corner_uvs_ || uvs > 0;
    }
    const std::uint64_t count = vertices_.element->count;
    check_limit(path_, count, "vertices", options_.max_elements);
    check_limit(path_, triangles, "triangles", options_.max_elements);
    check_limit(path_, uvs, "uvs", options_.max_elements);
    check_limit(path_, edge_count_, "edges", options_.max_elements);
    parsed_.strokes.resize_uninitialized(2 * edge_count_);
    TriangleMesh& mesh = parsed_.mesh;
    mesh.positions.resize_uninitialized(count);
    if (vertices_.has_normals) mesh.normals.resize_uninitialized(count);
    if (corner_uvs_)
      mesh.uvs.resize_uninitialized(uvs);
    else if (vertices_.has_uvs)
      mesh.uvs.resize_uninitialized(count);
    mesh.indices.resize_uninitialized(3 * triangles);
    if (corner_uvs_) mesh.uv_indices.resize_uninitialized(3 * triangles);
    allocate_extras();
  }

  void allocate_extras() {
    TriangleMesh& mesh = parsed_.mesh;
    drop_costly_extras();
    mesh.attributes = std::move(attributes_);
    for (const PlyPart* part : parts_)
      for (const PlyExtra& extra : part->extras) {
        if (extra.meaning == PlyMeaning::slot) continue;
        MeshAttribute& attribute = mesh.attributes[extra.attribute];
        const std::size_t size = domain_size(mesh, attribute.domain) * attribute.components;
        // Only some of the faces may have one.
        const bool all = attribute.domain == AttributeDomain::vertex || faces_.size() == 1;
        if (extra.component > 0 || size == 0) continue;
        if (extra.meaning == PlyMeaning::byte)
          all ? attribute.srgb.resize_uninitialized(size) : fill(attribute.srgb, size);
        else
          all ? attribute.floats.resize_uninitialized(size) : fill(attribute.floats, size);
      }
    choose_textures();
    for (PlyPart* part : parts_)
      for (PlyExtra& extra : part->extras) {
        if (extra.meaning == PlyMeaning::slot) extra.textures = texture_count();
        extra.place(mesh);
      }
  }

  /// Large polygons with many numbers would take far more memory than the file.
  void drop_costly_extras() {
    std::uint64_t numbers = 0;
    for (const MeshAttribute& a : attributes_)
      if (a.domain == AttributeDomain::face) numbers += a.components;
    const std::uint64_t triangles = parsed_.mesh.triangle_count();
    if (numbers == 0 || triangles <= (16 * text_.size() + (std::uint64_t{1} << 20)) / numbers) return;
    for (PlyFaces& faces : faces_) {
      std::erase_if(faces.extras, [](const PlyExtra& e) { return e.meaning != PlyMeaning::slot; });
      note(faces.element->where,
           "numbers of faces are not read: they would take much more memory than the file");
    }
    std::erase_if(attributes_, [](const MeshAttribute& a) { return a.domain == AttributeDomain::face; });
  }

  template <class T>
  static void fill(Column<T>& column, std::size_t size) {
    column = Column<T>(size, T{});
  }

  std::uint16_t texture_count() const { return static_cast<std::uint16_t>(header_.textures.size()); }

  /// The images that the header names are shown where there are texture coordinates.
  void choose_textures() {
    if (header_.textures.empty()) return;
    const bool has_triangles = parsed_.mesh.triangle_count() > 0;
    if (!has_triangles || (!vertices_.has_uvs && !corner_uvs_)) {
      note(header_.textures.front().data(), std::string("images are not shown: there are no ") +
                                                (has_triangles ? "texture coordinates" : "triangles"));
      drop_slots();
      return;
    }
    for (const std::string_view name : header_.textures)
      parsed_.textures.push_back({static_cast<std::uint64_t>(name.data() - text_.data()), std::string(name),
                                  lines_.at(name.data())});
    if (has_texnumbers_)
      fill(parsed_.mesh.material_slots, parsed_.mesh.triangle_count());
    else if (header_.textures.size() > 1)
      note(header_.textures[1].data(), "only the first image is shown: faces have no property 'texnumber'");
  }

  void drop_slots() {
    for (PlyPart* part : parts_)
      std::erase_if(part->extras, [](const PlyExtra& e) { return e.meaning == PlyMeaning::slot; });
  }

  /// Calls read(chunk) for all chunks, and gives back the pages of the file.
  template <class Read>
  void for_each_chunk(PlyPart& part, const Read& read) {
    oneapi::tbb::parallel_for(std::size_t{0}, part.chunks.size(), [&](std::size_t i) {
      PlyChunk& chunk = part.chunks[i];
      try {
        read(chunk);
      } catch (const MeshFailure& failure) {
        keep_first(chunk.failure, failure.where, failure.message);
      }
      file_.release(chunk.begin, chunk.end);
      phase_.add(static_cast<std::uint64_t>(chunk.end - chunk.begin));
    });
  }

  void read_vertices() {
    if (vertices_.element->count == 0) return;
    read_vertices_from({});
    TriangleMesh& mesh = parsed_.mesh;
    const std::optional<Vec3d> centre = far_centre(mesh.positions, !has_digits());
    if (!centre) return;
    mesh.origin = *centre;
    read_vertices_from(*centre);
  }

  /// Positions less `centre`.
  void read_vertices_from(const Vec3d& centre) {
    TriangleMesh& mesh = parsed_.mesh;
    PlyVertexColumns columns;
    columns.step = {3, 3, 3, 3, 3, 3, 2, 2};
    columns.centre = centre;
    const auto place = [&](std::size_t role, std::size_t size, void* column) {
      for (std::size_t k = 0; k < size; ++k) columns.base[role + k] = static_cast<float*>(column) + k;
    };
    place(0, 3, mesh.positions.data());
    if (vertices_.has_normals) place(3, 3, mesh.normals.data());
    if (vertices_.has_uvs && !corner_uvs_) place(6, 2, mesh.uvs.data());
    for_each_chunk(vertices_, [&](PlyChunk& chunk) {
      body_->read_vertices(vertices_, chunk, columns);
      chunk.oddities = {};
      if (!vertices_.has_normals) return;
      for (std::uint64_t i = chunk.first; i < chunk.first + chunk.records; ++i)
        if (!is_finite(mesh.normals[i])) chunk.oddities.bad_normals.add(vertices_.element->where);
    });
    stop_at_first_failure();
  }

  void note_rounding() {
    if (vertices_.element->count == 0 || !has_digits()) return;
    oktett::note_rounding(parsed_, [this](const Vec3d& centre) { read_vertices_from(centre); });
  }

  /// Whether positions may have more digits than floats.
  bool has_digits() const {
    if (header_.format == PlyFormat::ascii) return true;
    return std::any_of(vertices_.roles.begin(), vertices_.roles.begin() + kPlyNormals, [this](int property) {
      const PlyType type = vertices_.element->properties[static_cast<std::size_t>(property)].type;
      return type == PlyType::float64 || type == PlyType::int32 || type == PlyType::uint32;
    });
  }

  /// After the vertices, because how a polygon is cut depends on them.
  void read_faces() {
    for (PlyFaces& faces : faces_)
      for_each_chunk(faces, [&](PlyChunk& chunk) {
        PlyFaceWriter writer(faces, chunk, parsed_.mesh);
        body_->read_faces(faces, chunk, writer);
        chunk.oddities = writer.oddities();
      });
    stop_at_first_failure();
    note_oddities();
  }

  void read_edges() {
    for (PlyEdges& edges : edges_)
      for_each_chunk(edges, [&](PlyChunk& chunk) {
        PlyEdgeWriter writer(edges, chunk, parsed_.mesh.positions.size(), parsed_.strokes);
        body_->read_edges(edges, chunk, writer);
      });
    stop_at_first_failure();
  }

  void finish() {
    TriangleMesh& mesh = parsed_.mesh;
    parsed_.has_faces = mesh.triangle_count() > 0;
    if (vertices_.has_normals) mesh.normal_indices = mesh.indices;
    if (vertices_.has_uvs && !corner_uvs_) mesh.uv_indices = mesh.indices;
  }

  const std::string path_;
  const MeshReadOptions options_;
  const FileContent file_;
  const std::string_view text_;
  Phase phase_{"reading", std::filesystem::path(path_).filename().string(), text_.size()};
  LineCounter lines_{text_};
  bool in_header_ = true;
  PlyHeader header_;
  std::vector<PlyPart*> parts_;
  PlyVertices vertices_;
  std::vector<PlyFaces> faces_;
  std::vector<PlyEdges> edges_;
  std::uint64_t edge_count_ = 0;
  std::vector<PlyPart> others_;
  std::unique_ptr<PlyBody> body_;
  bool corner_uvs_ = false;  ///< texture coordinates are those of faces
  std::vector<MeshAttribute> attributes_;
  bool has_texnumbers_ = false;
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh parse_ply(const std::string& path, const MeshReadOptions& options) {
  return PlyLoad(path, options).run();
}

}  // namespace oktett
