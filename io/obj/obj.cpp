#include "io/obj/obj.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "core/far_mesh.h"
#include "core/phase.h"
#include "io/mesh/rounding.h"
#include "io/mesh/strokes.h"
#include "io/obj/parsed_obj.h"
#include "io/text/file_content.h"

namespace oktett {
namespace {

/// The loading of one file, step by step.
class ObjLoad {
 public:
  ObjLoad(const std::string& path, const ObjOptions& options)
      : path_(path),
        options_(options),
        file_(path),
        text_(without_byte_order_mark(file_.text())),
        phase_("reading", std::filesystem::path(path).filename().string(), kPasses * text_.size()) {}

  ParsedMesh run() {
    count();
    read_all_vertices();
    recentre();
    read_all_faces();
    assign_slots(chunks_, text_.data(), obj_);
    stop_at_first_failure();
    note_rounding(obj_, [this](const Vec3d& centre) { read_positions_from(centre); });
    drop_unused_columns();
    take_colors();
    note_skipped();
    note_oddities();
    obj_.has_faces = total_.faces > 0;
    return std::move(obj_);
  }

  /// Every line that is wrong.
  std::vector<Error> find_errors() {
    gathers_ = true;
    count();
    read_all_vertices();
    read_all_faces();
    assign_slots(chunks_, text_.data(), obj_);
    std::vector<MeshFailure> failures;
    for (ObjChunk& chunk : chunks_) std::ranges::move(chunk.failures, std::back_inserter(failures));
    if (std::optional<MeshFailure> brace = find_unpaired_brace(chunks_))
      failures.push_back(std::move(*brace));
    std::ranges::stable_sort(failures, {}, &MeshFailure::where);
    std::vector<Error> errors;
    LineCounter counter = lines();
    for (const MeshFailure& failure : failures) {
      const TextPosition position = counter.at(failure.where);
      if (!errors.empty() && errors.back().where().line == position.line) continue;
      errors.emplace_back(Location{path_, position.line, position.column}, failure.message);
    }
    return errors;
  }

  LineCounter lines() const { return LineCounter(text_); }
  const char* text() const { return text_.data(); }

 private:
  /// Lines are counted, vertices read, faces read.
  static constexpr std::uint64_t kPasses = 3;

  template <class Work>
  void for_each_chunk(const Work& work) {
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
      work(chunks_[i]);
      phase_.add(static_cast<std::uint64_t>(chunks_[i].end - chunks_[i].begin));
    });
  }

  void count() {
    chunks_ = cut_into_chunks(text_, std::max<std::size_t>(options_.chunk_bytes, 1));
    for_each_chunk([this](ObjChunk& chunk) {
      chunk.gathers = gathers_;
      count_chunk(chunk);
    });
    total_ = sum_counts(chunks_);
    check_limit(path_, total_.positions, "vertices", options_.max_elements);
    check_limit(path_, total_.uvs, "uvs", options_.max_elements);
    check_limit(path_, total_.normals, "normals", options_.max_elements);
    check_limit(path_, total_.triangles, "triangles", options_.max_elements);
    check_limit(path_, total_.strokes, "points and lines", options_.max_elements);
    const bool has_slash =
        std::any_of(chunks_.begin(), chunks_.end(), [](const ObjChunk& chunk) { return chunk.has_slash; });
    TriangleMesh& mesh = obj_.mesh;
    mesh.positions.resize_uninitialized(total_.positions);
    allocate_colors();
    mesh.uvs.resize_uninitialized(total_.uvs);
    mesh.normals.resize_uninitialized(total_.normals);
    mesh.indices.resize_uninitialized(3 * total_.triangles);
    obj_.strokes.resize_uninitialized(2 * total_.strokes);
    if (has_slash && total_.uvs > 0) mesh.uv_indices.resize_uninitialized(3 * total_.triangles);
    if (has_slash && total_.normals > 0) mesh.normal_indices.resize_uninitialized(3 * total_.triangles);
  }

  void read_all_vertices() {
    const auto read = [this](ObjChunk& chunk) {
      const ObjCounts& counts = chunk.counts;
      if (counts.positions + counts.uvs + counts.normals + counts.painted == 0) return;
      read_vertices(chunk, obj_.mesh, colors_);
      if (counts.faces == 0 && !chunk.has_strokes) file_.release(chunk.begin, chunk.end);
    };
    for_each_chunk(read);
    sum_colors();
    // Some may have begun in the middle of chunks, or were no bytes behind those that were.
    const bool missed = colors_.levels.empty() || !all_colors_.are_bytes || all_colors_.greatest > 1;
    if (all_colors_.count == 0 || !colors_.numbers.empty() || !missed || first_failure()) return;
    colors_ = {};
    colors_.numbers.resize_uninitialized(3 * total_.positions);
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) { read(chunks_[i]); });
    sum_colors();
  }

  void allocate_colors() {
    const auto any = [this](bool ObjChunk::*has) { return std::ranges::any_of(chunks_, has); };
    const bool bytes = std::ranges::all_of(
        chunks_, [](const ObjChunk& chunk) { return chunk.has_levels || !chunk.has_colors; });
    if (any(&ObjChunk::has_colors))
      bytes ? colors_.levels.resize_uninitialized(3 * total_.positions)
            : colors_.numbers.resize_uninitialized(3 * total_.positions);
    else if (total_.painted > 0 && total_.painted == total_.positions)
      colors_.painted.resize_uninitialized(3 * total_.painted);
  }

  void sum_colors() {
    all_colors_ = {};
    for (const ObjChunk& chunk : chunks_) all_colors_ += chunk.colors;
  }

  void take_colors() {
    const bool painted = !colors_.painted.empty() && all_colors_.count == 0;
    if (all_colors_.count > 0 && !(colors_.numbers.empty() && colors_.levels.empty())) {
      set_colors(obj_.mesh, all_colors_, std::move(colors_));
      if (all_colors_.count < total_.positions)
        note(all_colors_.without, "vertices without colours, this one and " +
                                      std::to_string(total_.positions - all_colors_.count - 1) +
                                      " more, are white");
    } else if (painted) {
      set_colors(obj_.mesh, all_colors_, std::move(colors_));
    } else if (total_.painted > 0) {
      obj_.notices.push_back({0,
                              std::to_string(total_.painted) + " colours of '#MRGB' for " +
                                  std::to_string(total_.positions) + " vertices are not read",
                              {}});
    }
  }

  void recentre() {
    if (first_failure()) return;
    const std::optional<Vec3d> centre = far_centre(obj_.mesh.positions, false);
    if (!centre) return;
    read_positions_from(*centre);
    obj_.mesh.origin = *centre;
  }

  void read_positions_from(const Vec3d& centre) {
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
      if (chunks_[i].counts.positions > 0) oktett::read_positions_from(centre, chunks_[i], obj_.mesh);
    });
  }

  /// After all vertices, because how a polygon is cut depends on them, and they may come behind it.
  void read_all_faces() {
    const ObjFaceOptions options{.positions_known = !first_failure()};
    for_each_chunk([&](ObjChunk& chunk) {
      if (chunk.counts.faces == 0 && !chunk.has_strokes) return;
      read_faces(chunk, total_, obj_, options);
      file_.release(chunk.begin, chunk.end);
    });
  }

  std::optional<MeshFailure> first_failure() const {
    std::optional<MeshFailure> first;
    for (const ObjChunk& chunk : chunks_) keep_first(first, chunk.failure);
    keep_first(first, find_unpaired_brace(chunks_));
    return first;
  }

  void stop_at_first_failure() const {
    const std::optional<MeshFailure> failure = first_failure();
    if (failure) fail_at_line(path_, text_, *failure);
  }

  void drop_unused_columns() {
    bool uses_uvs = false, uses_normals = false;
    for (const ObjChunk& chunk : chunks_) {
      uses_uvs = uses_uvs || chunk.uses_uvs;
      uses_normals = uses_normals || chunk.uses_normals;
    }
    if (!uses_uvs) obj_.mesh.uv_indices.clear();
    if (!uses_normals) obj_.mesh.normal_indices.clear();
  }

  /// One warning for each unknown keyword.
  void note_skipped() {
    std::vector<std::string_view> seen;
    for (const ObjChunk& chunk : chunks_) {
      for (const ObjSkipped& skipped : chunk.skipped) {
        if (std::find(seen.begin(), seen.end(), skipped.keyword) != seen.end()) continue;
        if (seen.size() == kMaxSkippedKeywords) {
          note(skipped.where, "more unknown keywords are ignored");
          return;
        }
        seen.push_back(skipped.keyword);
        note(skipped.where, "unknown keyword " + quote_name(skipped.keyword) + " is ignored");
      }
    }
  }

  void note_oddities() {
    MeshOddities all;
    for (const ObjChunk& chunk : chunks_) all += chunk.oddities;
    all.report([this](const char* where, std::string words) { note(where, std::move(words)); });
  }

  void note(const char* where, std::string message) {
    obj_.notices.push_back({static_cast<std::uint64_t>(where - text_.data()), std::move(message), {}});
  }

  const std::string path_;
  const ObjOptions options_;
  const FileContent file_;
  std::string_view text_;
  Phase phase_;
  std::vector<ObjChunk> chunks_;
  ObjCounts total_;
  ObjColorColumns colors_;
  ObjColors all_colors_;
  ParsedMesh obj_;
  bool gathers_ = false;
};

}  // namespace

ObjFile load_obj(const std::string& path, const ObjOptions& options) {
  ObjLoad load(path, options);
  ParsedMesh parsed = load.run();
  LineCounter lines = load.lines();
  return finish_mesh(path, std::move(parsed), [&](std::uint64_t at) { return lines.at(load.text() + at); });
}

ObjFile load_obj(const std::string& path) { return load_obj(path, ObjOptions{}); }

std::vector<Error> find_obj_errors(const std::string& path, const ObjOptions& options) {
  return ObjLoad(path, options).find_errors();
}

std::vector<Error> find_obj_errors(const std::string& path) { return find_obj_errors(path, ObjOptions{}); }

ParsedMesh parse_obj(const std::string& path) {
  ObjLoad load(path, ObjOptions{});
  ParsedMesh parsed = load.run();
  std::vector<MeshStatement*> statements;
  for (auto* list : {&parsed.libraries, &parsed.materials, &parsed.notices})
    for (MeshStatement& statement : *list)
      if (statement.at != MeshStatement::kNowhere) statements.push_back(&statement);
  std::ranges::sort(statements, {}, &MeshStatement::at);
  LineCounter lines = load.lines();
  for (MeshStatement* statement : statements) statement->position = lines.at(load.text() + statement->at);
  return parsed;
}

/// One material for each image that the file names, and a last one for faces without, if slots tell them
/// apart, and for points and lines.
static void add_texture_materials(const std::string& path, const std::vector<MeshStatement>& names,
                                  const std::function<TextPosition(std::uint64_t)>& position,
                                  MeshFile& file) {
  if (names.empty()) return;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (const MeshStatement& name : names) {
    Texture texture;
    texture.path = (folder / name.words).string();
    const TextPosition place = position(name.at);
    file.textures.push_back(std::move(texture));
    file.texture_places.push_back(Location{path, place.line, place.column});
    file.materials.push_back(
        image_material(name.words, static_cast<std::uint32_t>(file.textures.size() - 1)));
    if (file.mesh.material_slots.empty()) break;
  }
  const std::size_t strokes = file.strokes.triangle_count();
  if (file.mesh.material_slots.empty() && strokes == 0) return;
  file.materials.push_back(image_material("without image", kNoId));
  if (strokes > 0)
    file.strokes.material_slots =
        Column<std::uint16_t>(strokes, static_cast<std::uint16_t>(file.materials.size() - 1));
}

/// Vertices without faces, points and lines are points.
static void take_strokes(ParsedMesh& parsed, MeshFile& file) {
  const auto vertices = static_cast<std::uint32_t>(file.mesh.positions.size());
  if (!parsed.has_faces && parsed.strokes.empty()) {
    parsed.strokes.resize_uninitialized(2 * std::size_t{vertices});
    for (std::uint32_t i = 0; i < vertices; ++i) parsed.strokes[2 * i] = parsed.strokes[2 * i + 1] = i;
  }
  if (parsed.strokes.empty()) return;
  file.strokes = make_strokes(file.mesh, parsed.strokes, std::move(parsed.stroke_slots));
}

MeshFile finish_mesh(const std::string& path, ParsedMesh parsed,
                     const std::function<TextPosition(std::uint64_t)>& position) {
  MeshFile obj;
  obj.mesh = std::move(parsed.mesh);
  take_strokes(parsed, obj);
  // Those about materials stand before others of the same place.
  std::vector<MeshStatement> notices;
  resolve_materials(parsed.libraries, parsed.materials, path, obj, notices);
  add_texture_materials(path, parsed.textures, position, obj);
  std::ranges::move(parsed.notices, std::back_inserter(notices));
  std::ranges::stable_sort(notices, {}, &MeshStatement::at);
  std::vector<Warning> warnings;
  for (const MeshStatement& notice : notices) {
    const TextPosition place = position(notice.at);
    warnings.push_back({Location{path, place.line, place.column}, notice.words});
  }
  if (!parsed.has_faces && obj.strokes.indices.empty()) warnings.push_back({Location{path}, "no faces"});
  obj.warnings.insert(obj.warnings.begin(), warnings.begin(), warnings.end());
  return obj;
}

MeshFile finish_mesh(const std::string& path, ParsedMesh parsed) {
  std::unordered_map<std::uint64_t, TextPosition> positions;
  for (const auto* list : {&parsed.libraries, &parsed.materials, &parsed.textures, &parsed.notices})
    for (const MeshStatement& statement : *list) positions.emplace(statement.at, statement.position);
  return finish_mesh(path, std::move(parsed), [&](std::uint64_t at) { return positions[at]; });
}

}  // namespace oktett
