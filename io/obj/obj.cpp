#include "io/obj/obj.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "io/obj/parsed_obj.h"
#include "io/text/mapped_file.h"

namespace oktett {
namespace {

/// The loading of one file, step by step.
class ObjLoad {
 public:
  ObjLoad(const std::string& path, const ObjOptions& options)
      : path_(path), options_(options), file_(path), text_(file_.text()) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
  }

  ParsedObj run() {
    count();
    read_all_vertices();
    read_all_faces();
    assign_slots(chunks_, text_.data(), obj_);
    stop_at_first_failure();
    drop_unused_columns();
    note_skipped();
    obj_.has_faces = total_.faces > 0;
    return std::move(obj_);
  }

  LineCounter lines() const { return LineCounter(text_); }
  const char* text() const { return text_.data(); }

 private:
  template <class Work>
  void for_each_chunk(const Work& work) {
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) { work(chunks_[i]); });
  }

  void count() {
    chunks_ = cut_into_chunks(text_, std::max<std::size_t>(options_.chunk_bytes, 1));
    for_each_chunk([](ObjChunk& chunk) { count_chunk(chunk); });
    total_ = sum_counts(chunks_);
    check_limit(total_.positions, "vertices");
    check_limit(total_.uvs, "uvs");
    check_limit(total_.normals, "normals");
    check_limit(total_.triangles, "triangles");
    const bool has_slash =
        std::any_of(chunks_.begin(), chunks_.end(), [](const ObjChunk& chunk) { return chunk.has_slash; });
    TriangleMesh& mesh = obj_.mesh;
    mesh.positions.resize_uninitialized(total_.positions);
    mesh.uvs.resize_uninitialized(total_.uvs);
    mesh.normals.resize_uninitialized(total_.normals);
    mesh.indices.resize_uninitialized(3 * total_.triangles);
    if (has_slash && total_.uvs > 0) mesh.uv_indices.resize_uninitialized(3 * total_.triangles);
    if (has_slash && total_.normals > 0) mesh.normal_indices.resize_uninitialized(3 * total_.triangles);
  }

  void check_limit(std::uint64_t count, const char* what) const {
    if (count <= options_.max_elements) return;
    throw Error(Location{path_}, std::to_string(count) + " " + what + ", but indices reach only " +
                                     std::to_string(options_.max_elements));
  }

  void read_all_vertices() {
    for_each_chunk([this](ObjChunk& chunk) {
      if (chunk.counts.positions + chunk.counts.uvs + chunk.counts.normals == 0) return;
      read_vertices(chunk, obj_.mesh);
      if (chunk.counts.faces == 0) file_.release(chunk.begin, chunk.end);
    });
  }

  /// After all vertices, because how a polygon is cut depends on them, and they may come behind it.
  void read_all_faces() {
    const ObjFaceOptions options{.positions_known = !first_failure()};
    for_each_chunk([&](ObjChunk& chunk) {
      if (chunk.counts.faces == 0) return;
      read_faces(chunk, total_, obj_.mesh, options);
      file_.release(chunk.begin, chunk.end);
    });
  }

  std::optional<ObjFailure> first_failure() const {
    std::optional<ObjFailure> first;
    for (const ObjChunk& chunk : chunks_) keep_first(first, chunk.failure);
    keep_first(first, find_unpaired_brace(chunks_));
    return first;
  }

  void stop_at_first_failure() const {
    const std::optional<ObjFailure> failure = first_failure();
    if (!failure) return;
    const TextPosition position = LineCounter(text_).at(failure->where);
    throw Error(Location{path_, position.line, position.column}, failure->message);
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

  /// One warning for lines and points together, and one for each unknown keyword.
  void note_skipped() {
    std::vector<std::string_view> seen;
    bool lines_seen = false;
    for (const ObjChunk& chunk : chunks_) {
      for (const ObjSkipped& skipped : chunk.skipped) {
        if (skipped.keyword == "l" || skipped.keyword == "p") {
          if (!lines_seen) note(skipped.where, "lines and points are skipped");
          lines_seen = true;
          continue;
        }
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

  void note(const char* where, std::string message) {
    obj_.notices.push_back({static_cast<std::uint64_t>(where - text_.data()), std::move(message), {}});
  }

  const std::string path_;
  const ObjOptions options_;
  const MappedFile file_;
  std::string_view text_;
  std::vector<ObjChunk> chunks_;
  ObjCounts total_;
  ParsedObj obj_;
};

}  // namespace

ObjFile load_obj(const std::string& path, const ObjOptions& options) {
  ObjLoad load(path, options);
  ParsedObj parsed = load.run();
  LineCounter lines = load.lines();
  return finish_obj(path, std::move(parsed), [&](std::uint64_t at) { return lines.at(load.text() + at); });
}

ObjFile load_obj(const std::string& path) { return load_obj(path, ObjOptions{}); }

ParsedObj parse_obj(const std::string& path) {
  ObjLoad load(path, ObjOptions{});
  ParsedObj parsed = load.run();
  std::vector<ObjStatement*> statements;
  for (auto* list : {&parsed.libraries, &parsed.materials, &parsed.notices})
    for (ObjStatement& statement : *list)
      if (statement.at != ObjStatement::kNowhere) statements.push_back(&statement);
  std::ranges::sort(statements, {}, &ObjStatement::at);
  LineCounter lines = load.lines();
  for (ObjStatement* statement : statements) statement->position = lines.at(load.text() + statement->at);
  return parsed;
}

ObjFile finish_obj(const std::string& path, ParsedObj parsed,
                   const std::function<TextPosition(std::uint64_t)>& position) {
  ObjFile obj;
  obj.mesh = std::move(parsed.mesh);
  // Those about materials stand before others of the same place.
  std::vector<ObjStatement> notices;
  resolve_materials(parsed.libraries, parsed.materials, path, obj, notices);
  std::ranges::move(parsed.notices, std::back_inserter(notices));
  std::ranges::stable_sort(notices, {}, &ObjStatement::at);
  std::vector<Warning> warnings;
  for (const ObjStatement& notice : notices) {
    const TextPosition place = position(notice.at);
    warnings.push_back({Location{path, place.line, place.column}, notice.words});
  }
  if (!parsed.has_faces) warnings.push_back({Location{path}, "no faces"});
  obj.warnings.insert(obj.warnings.begin(), warnings.begin(), warnings.end());
  return obj;
}

ObjFile finish_obj(const std::string& path, ParsedObj parsed) {
  std::unordered_map<std::uint64_t, TextPosition> positions;
  for (const auto* list : {&parsed.libraries, &parsed.materials, &parsed.notices})
    for (const ObjStatement& statement : *list) positions.emplace(statement.at, statement.position);
  return finish_obj(path, std::move(parsed), [&](std::uint64_t at) { return positions[at]; });
}

}  // namespace oktett
