#include "io/obj/obj.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/obj/chunk.h"
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

  ObjFile run() {
    count();
    read_all_vertices();
    read_all_faces();
    assign_materials(chunks_, path_, obj_, notices_);
    stop_at_first_failure();
    drop_unused_columns();
    report_notices();
    return std::move(obj_);
  }

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

  void report_notices() {
    note_skipped();
    std::stable_sort(notices_.begin(), notices_.end(),
                     [](const ObjNotice& a, const ObjNotice& b) { return a.where < b.where; });
    LineCounter lines(text_);
    std::vector<Warning> warnings;
    for (const ObjNotice& notice : notices_) {
      const TextPosition position = lines.at(notice.where);
      warnings.push_back({Location{path_, position.line, position.column}, notice.message});
    }
    if (total_.faces == 0) warnings.push_back({Location{path_}, "no faces"});
    obj_.warnings.insert(obj_.warnings.begin(), warnings.begin(), warnings.end());
  }

  /// One warning for lines and points together, and one for each unknown keyword.
  void note_skipped() {
    std::vector<std::string_view> seen;
    bool lines_seen = false;
    for (const ObjChunk& chunk : chunks_) {
      for (const ObjSkipped& skipped : chunk.skipped) {
        if (skipped.keyword == "l" || skipped.keyword == "p") {
          if (!lines_seen) notices_.push_back({skipped.where, "lines and points are skipped"});
          lines_seen = true;
          continue;
        }
        if (std::find(seen.begin(), seen.end(), skipped.keyword) != seen.end()) continue;
        if (seen.size() == kMaxSkippedKeywords) {
          notices_.push_back({skipped.where, "more unknown keywords are ignored"});
          return;
        }
        seen.push_back(skipped.keyword);
        notices_.push_back({skipped.where, "unknown keyword " + quote_name(skipped.keyword) + " is ignored"});
      }
    }
  }

  const std::string path_;
  const ObjOptions options_;
  const MappedFile file_;
  std::string_view text_;
  std::vector<ObjChunk> chunks_;
  ObjCounts total_;
  ObjFile obj_;
  std::vector<ObjNotice> notices_;
};

}  // namespace

ObjFile load_obj(const std::string& path, const ObjOptions& options) { return ObjLoad(path, options).run(); }

ObjFile load_obj(const std::string& path) { return load_obj(path, ObjOptions{}); }

}  // namespace oktett
