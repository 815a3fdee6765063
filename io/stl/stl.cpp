#include "io/stl/stl.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/bytes.h"
#include "core/error.h"
#include "core/phase.h"
#include "io/mesh/numbers.h"
#include "io/stl/facets.h"
#include "io/text/file_content.h"

namespace oktett {
namespace {

constexpr std::size_t kHeaderBytes = 84;
/// A normal, three vertices and an attribute of two bytes.
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kCornerBytes = 36;
static_assert(sizeof(Vec3f) == 12);

/// The loading of one file.
class StlLoad {
 public:
  StlLoad(const std::string& path, const MeshReadOptions& options)
      : path_(path), options_(options), file_(path), text_(file_.text()) {}

  ParsedMesh run() {
    if (is_text())
      read_text();
    else
      read_bytes();
    parsed_.has_faces = parsed_.mesh.triangle_count() > 0;
    return std::move(parsed_);
  }

 private:
  /// Facets of a file of bytes by its header; 0 if it has none.
  std::uint64_t stated_count() const {
    std::uint32_t count = 0;
    if (text_.size() >= kHeaderBytes) std::memcpy(&count, text_.data() + kHeaderBytes - 4, sizeof count);
    return count;
  }

  /// Some programs write `solid` to the header of files of bytes, too.
  bool is_text() const {
    const char* p = text_.data();
    while (is_blank(*p) || (*p != '\0' && is_line_end(*p))) ++p;
    if (!begins_with_word(p, "solid")) return false;
    if (text_.size() >= kHeaderBytes && text_.size() == kHeaderBytes + kFacetBytes * stated_count())
      return false;
    const std::string_view start = text_.substr(0, 512);
    return std::ranges::none_of(start,
                                [](char c) {
                                  return static_cast<unsigned char>(c) < ' ' &&
                                         std::strchr("\t\n\v\f\r", c) == nullptr;
                                }) &&
           start.find('\0') == std::string_view::npos;
  }

  void allocate(std::uint64_t triangles) {
    check_limit(path_, 3 * triangles, "vertices", options_.max_elements);
    parsed_.mesh.positions.resize_uninitialized(3 * triangles);
    parsed_.mesh.indices.resize_uninitialized(3 * triangles);
  }

  void number_corners(std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t i = 3 * first; i < 3 * last; ++i)
      parsed_.mesh.indices[i] = static_cast<std::uint32_t>(i);
  }

  void read_text() {
    std::vector<StlChunk> chunks = cut_into_facets(text_, std::max<std::size_t>(options_.chunk_bytes, 1));
    allocate(chunks.empty() ? 0 : chunks.back().before + chunks.back().triangles);
    oneapi::tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      read_facets(chunks, i, parsed_.mesh.positions.data());
      number_corners(chunks[i].before, chunks[i].before + chunks[i].triangles);
      file_.release(chunks[i].begin, chunks[i].end);
      phase_.add(static_cast<std::uint64_t>(chunks[i].end - chunks[i].begin));
    });
    std::optional<MeshFailure> first;
    for (const StlChunk& chunk : chunks) keep_first(first, chunk.failure);
    if (first) fail_at_line(path_, text_, *first);
  }

  void read_bytes() {
    const std::uint64_t count = stated_count();
    if (text_.size() < kHeaderBytes)
      throw Error(Location{path_}, "expected text that begins with 'solid', or a header of 84 bytes; found " +
                                       std::to_string(text_.size()) + " bytes");
    const std::size_t end = kHeaderBytes + kFacetBytes * count;
    if (text_.size() < end)
      throw Error(Location{path_}, "byte 80: " + std::to_string(count) + " triangles take " +
                                       std::to_string(end) + " bytes, but the file ends at byte " +
                                       std::to_string(text_.size()));
    allocate(count);
    const std::uint64_t per_task = std::max<std::uint64_t>(options_.chunk_bytes / kFacetBytes, 1);
    std::vector<std::optional<MeshFailure>> failures((count + per_task - 1) / per_task);
    oneapi::tbb::parallel_for(std::size_t{0}, failures.size(), [&](std::size_t i) {
      failures[i] = read_records(i * per_task, std::min(count, (i + 1) * per_task));
    });
    for (const std::optional<MeshFailure>& failure : failures)
      if (failure) fail_at_byte(path_, text_, *failure);
    if (text_.size() > end)
      parsed_.notices.push_back(
          {end, std::to_string(text_.size() - end) + " bytes behind the last triangle are not read", {0, 0}});
  }

  std::optional<MeshFailure> read_records(std::uint64_t first, std::uint64_t last) {
    const char* const begin = text_.data() + kHeaderBytes + kFacetBytes * first;
    const char* p = begin + kNormalBytes;
    Vec3f* out = parsed_.mesh.positions.data() + 3 * first;
    bool good = true;
    for (std::uint64_t i = first; i < last; ++i, p += kFacetBytes, out += 3) {
      std::memcpy(out, p, kCornerBytes);
      for (int k = 0; k < 3; ++k) {
        const bool x = is_coordinate(out[k].x), y = is_coordinate(out[k].y), z = is_coordinate(out[k].z);
        good &= x & y & z;
      }
    }
    number_corners(first, last);
    std::optional<MeshFailure> failure;
    if (!good) failure = find_bad(first, last);
    file_.release(begin, begin + kFacetBytes * (last - first));
    phase_.add(kFacetBytes * (last - first));
    return failure;
  }

  std::optional<MeshFailure> find_bad(std::uint64_t first, std::uint64_t last) const {
    for (std::uint64_t i = first; i < last; ++i)
      for (std::size_t k = 0; k < kCornerBytes; k += 4) {
        const char* const p = text_.data() + kHeaderBytes + kFacetBytes * i + kNormalBytes + k;
        float x;
        std::memcpy(&x, p, sizeof x);
        if (!is_coordinate(x)) return MeshFailure{p, bad_coordinate(x)};
      }
    return std::nullopt;
  }

  const std::string path_;
  const MeshReadOptions options_;
  const FileContent file_;
  const std::string_view text_;
  Phase phase_{"reading", std::filesystem::path(path_).filename().string(), text_.size()};
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh parse_stl(const std::string& path, const MeshReadOptions& options) {
  return StlLoad(path, options).run();
}

}  // namespace oktett
