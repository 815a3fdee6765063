#include "io/stl/stl.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/bytes.h"
#include "core/error.h"
#include "core/far_mesh.h"
#include "core/phase.h"
#include "io/mesh/reading.h"
#include "io/mesh/rounding.h"
#include "io/text/file_content.h"

namespace oktett {

// ---- Facets in text.

namespace {

/// A run of whole lines. All but the first of a file begin with a line `facet`.
struct StlChunk {
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t triangles = 0;         ///< counted by the first pass
  std::uint64_t before = 0;            ///< triangles in all chunks before it
  std::optional<MeshFailure> failure;  ///< the first one
};

/// Past `word` at `p`; null if something else stands there.
const char* match_word(const char* p, std::string_view word) {
  for (const char c : word)
    if ((*p++ | 0x20) != c) return nullptr;
  return is_blank(*p) || is_line_end(*p) ? p : nullptr;
}

/// Whether the line at `p` begins with `word`, in upper or lower case.
bool begins_with_word(const char* p, std::string_view word) {
  return match_word(skip_plain_blanks(p), word) != nullptr;
}

/// What may stand in the next line.
enum class State { outside, solid, loop, vertex0, vertex1, vertex2, endloop, endfacet };

const char* expected_in(State state) {
  constexpr const char* kExpected[] = {"'solid'",      "'facet normal' or 'endsolid'",
                                       "'outer loop'", "'vertex'",
                                       "'vertex'",     "'vertex'",
                                       "'endloop'",    "'endfacet'"};
  return kExpected[static_cast<int>(state)];
}

MeshFailure unexpected(State state, const char* p, const char* text_end) {
  return {p, std::string("expected ") + expected_in(state) +
                 (p >= text_end ? ", found the end of the file" : ", found " + quote_word(p))};
}

class FacetReader {
 public:
  FacetReader(const StlChunk& chunk, bool is_first, Vec3f* positions, const Vec3d& centre)
      : chunk_(chunk),
        centre_(centre),
        state_(is_first ? State::outside : State::solid),
        next_(positions + 3 * chunk.before),
        last_(next_ + 3 * chunk.triangles) {}

  /// Returns what may stand behind the chunk.
  State run() {
    for (const char* line = chunk_.begin; line < chunk_.end;) {
      const char* p = skip_plain_blanks(line);
      if (!is_line_end(*p)) p = read_line(p);
      line = next_line(find_line_end(p), chunk_.end);
    }
    return state_;
  }

 private:
  const char* read_line(const char* p) {
    switch (state_) {
      case State::outside:
        expect(p, "solid");
        state_ = State::solid;
        return p;
      case State::solid:
        if (match_word(p, "endsolid") != nullptr) {
          state_ = State::outside;
          return p;
        }
        expect(skip_plain_blanks(expect(p, "facet")), "normal");
        state_ = State::loop;
        return p;
      case State::loop:
        return end_line(expect(skip_plain_blanks(expect(p, "outer")), "loop"), State::vertex0);
      case State::vertex0:
      case State::vertex1:
      case State::vertex2:
        return read_vertex(expect(p, "vertex"));
      case State::endloop:
        return end_line(expect(p, "endloop"), State::endfacet);
      case State::endfacet:
        return end_line(expect(p, "endfacet"), State::solid);
    }
    return p;
  }

  const char* expect(const char* p, std::string_view word) const {
    const char* rest = match_word(p, word);
    if (rest == nullptr) throw unexpected(state_, p, chunk_.end);
    return rest;
  }

  const char* read_vertex(const char* p) {
    if (next_ == last_) stop_changed(p);
    for (int k = 0; k < 3; ++k) p = read_coordinate_from(centre_[k], skip_plain_blanks(p), (*next_)[k]);
    ++next_;
    return end_line(p, static_cast<State>(static_cast<int>(state_) + 1));
  }

  const char* end_line(const char* p, State next) {
    p = skip_plain_blanks(p);
    if (!is_line_end(*p)) stop_at(p, "expected the end of the line, found " + quote_word(p));
    state_ = next;
    return p;
  }

  const StlChunk& chunk_;
  const Vec3d centre_;
  State state_;
  Vec3f* next_;
  Vec3f* const last_;
};

/// The start of the first line `facet` from the line `p` on.
const char* find_facet(const char* p, const char* end) {
  while (p < end && !begins_with_word(p, "facet")) p = next_line(find_line_end(p), end);
  return p;
}

void count_facets(StlChunk& chunk) {
  std::uint64_t vertices = 0;
  for (const char* line = chunk.begin; line < chunk.end;) {
    const char* p = skip_plain_blanks(line);
    vertices += (*p | 0x20) == 'v' ? 1 : 0;
    const char* end = find_line_end(p);
    if (*end == '\0' && end < chunk.end) keep_first(chunk.failure, end, "unexpected zero byte");
    line = next_line(end, chunk.end);
  }
  // There may be a facet with fewer than three, which is an error found later.
  chunk.triangles = (vertices + 2) / 3;
}

}  // namespace

/// Cuts `text` into chunks of about `chunk_bytes` each and counts their triangles.
static std::vector<StlChunk> cut_into_facets(std::string_view text, std::size_t chunk_bytes) {
  std::vector<StlChunk> chunks;
  const char* const text_end = text.data() + text.size();
  for (const char* begin = text.data(); begin < text_end;) {
    StlChunk& chunk = chunks.emplace_back();
    chunk.begin = begin;
    begin = static_cast<std::size_t>(text_end - begin) <= chunk_bytes
                ? text_end
                : find_facet(next_line(find_line_end(begin + chunk_bytes), text_end), text_end);
    chunk.end = begin;
  }
  oneapi::tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) { count_facets(chunks[i]); });
  std::uint64_t before = 0;
  for (StlChunk& chunk : chunks) {
    chunk.before = before;
    before += chunk.triangles;
  }
  return chunks;
}

/// Reads chunk `index`, less `centre`, to `positions`, which holds three for each triangle of the file. Stops
/// at the first failure in the chunk.
static void read_facets(std::vector<StlChunk>& chunks, std::size_t index, Vec3f* positions,
                        const Vec3d& centre) {
  StlChunk& chunk = chunks[index];
  try {
    const State end = FacetReader(chunk, index == 0, positions, centre).run();
    // Another chunk begins with a facet, as is only right within a solid.
    const bool is_last = index + 1 == chunks.size();
    if (end != (is_last ? State::outside : State::solid))
      throw unexpected(end, skip_plain_blanks(chunk.end), chunks.back().end);
  } catch (const MeshFailure& failure) {
    keep_first(chunk.failure, failure.where, failure.message);
  }
}

namespace {

/// Reads facets word by word, for files that leave line ends, normals or the last `endsolid` out or hold
/// comments, as programs in use write or read them.
class LooseFacets {
 public:
  LooseFacets(std::string_view text, const Vec3d& centre)
      : next_(text.data()), end_(text.data() + text.size()), centre_(centre) {}

  /// The corners, three for each triangle. Throws MeshFailure.
  std::vector<Vec3f> run() {
    expect("solid");
    skip_name();
    for (;;) {
      skip_space();
      if (next_ >= end_) return std::move(corners_);
      if (take("endsolid")) {
        skip_name();
      } else if (take("solid")) {
        skip_name();
      } else {
        read_facet();
      }
    }
  }

 private:
  /// Past blanks, line ends and comments.
  void skip_space() {
    while (next_ < end_ && *next_ != '\0') {
      if (is_blank(*next_) || is_line_end(*next_))
        ++next_;
      else if (*next_ == '#' || *next_ == ';' || (next_[0] == '/' && next_[1] == '/'))
        next_ = find_line_end(next_);
      else
        return;
    }
  }

  bool take(std::string_view word) {
    skip_space();
    const char* const rest = match_word(next_, word);
    if (rest == nullptr) return false;
    next_ = rest;
    return true;
  }

  void expect(std::string_view word) {
    if (take(word)) return;
    stop_at(next_, "expected '" + std::string(word) + "'" +
                       (next_ >= end_ ? ", found the end of the file" : ", found " + quote_word(next_)));
  }

  /// The name of a solid: up to the end of the line, or to a facet.
  void skip_name() {
    while (next_ < end_ && !is_line_end(*next_) && match_word(next_, "facet") == nullptr) {
      while (next_ < end_ && !is_line_end(*next_) && !is_blank(*next_)) ++next_;
      next_ = skip_plain_blanks(next_);
    }
  }

  void read_facet() {
    expect("facet");
    if (take("normal"))
      for (int k = 0; k < 3; ++k) skip_number();
    expect("outer"), expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      Vec3f corner;
      for (int axis = 0; axis < 3; ++axis) {
        skip_space();
        next_ = read_coordinate_from(centre_[axis], next_, corner[axis]);
      }
      corners_.push_back(corner);
    }
    expect("endloop"), expect("endfacet");
  }

  /// Of a normal, which may hold anything.
  void skip_number() {
    skip_space();
    while (next_ < end_ && !is_line_end(*next_) && !is_blank(*next_)) ++next_;
  }

  const char* next_;
  const char* const end_;
  const Vec3d centre_;
  std::vector<Vec3f> corners_;
};

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
    if (is_text()) {
      text_ = without_byte_order_mark(text_);
      read_text();
    } else {
      read_bytes();
    }
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
    const char* p = without_byte_order_mark(text_).data();
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
    read_chunks(chunks, {});
    std::optional<MeshFailure> first;
    for (const StlChunk& chunk : chunks) keep_first(first, chunk.failure);
    if (first) read_loosely(*first, {});
    const auto read_again = [&](const Vec3d& centre) {
      if (first)
        read_loosely(*first, centre);
      else
        read_chunks(chunks, centre);
    };
    if (const std::optional<Vec3d> centre = far_centre(parsed_.mesh.positions, false)) {
      parsed_.mesh.origin = *centre;
      read_again(*centre);
    }
    note_rounding(parsed_, read_again);
  }

  void read_chunks(std::vector<StlChunk>& chunks, const Vec3d& centre) {
    oneapi::tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      read_facets(chunks, i, parsed_.mesh.positions.data(), centre);
      number_corners(chunks[i].before, chunks[i].before + chunks[i].triangles);
      file_.release(chunks[i].begin, chunks[i].end);
      phase_.add(static_cast<std::uint64_t>(chunks[i].end - chunks[i].begin));
    });
  }

  /// Other programs read more than the format allows.
  void read_loosely(const MeshFailure& failure, const Vec3d& centre) {
    std::vector<Vec3f> corners;
    try {
      corners = LooseFacets(text_, centre).run();
    } catch (const MeshFailure&) {
      fail_at_line(path_, text_, failure);
    }
    allocate(corners.size() / 3);
    std::ranges::copy(corners, parsed_.mesh.positions.data());
    number_corners(0, corners.size() / 3);
    if (!(centre == Vec3d{})) return;  // it was said before
    parsed_.notices.push_back({static_cast<std::uint64_t>(failure.where - text_.data()),
                               failure.message + "; read all the same",
                               LineCounter(text_).at(failure.where)});
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
    if (const std::optional<Vec3d> centre = far_centre(parsed_.mesh.positions, true))
      take_off(*centre, parsed_.mesh);
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
  std::string_view text_;
  Phase phase_{"reading", std::filesystem::path(path_).filename().string(), text_.size()};
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh parse_stl(const std::string& path, const MeshReadOptions& options) {
  return StlLoad(path, options).run();
}

}  // namespace oktett
