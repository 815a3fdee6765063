#include "io/stl/facets.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "io/mesh/numbers.h"

namespace oktett {
namespace {

const char* skip_plain_blanks(const char* p) {
  while (is_blank(*p)) ++p;
  return p;
}

/// Past `word` at `p`; null if something else stands there.
const char* match_word(const char* p, std::string_view word) {
  for (const char c : word)
    if ((*p++ | 0x20) != c) return nullptr;
  return is_blank(*p) || is_line_end(*p) ? p : nullptr;
}

/// What may stand in the next line.
enum class State { outside, solid, loop, vertex0, vertex1, vertex2, endloop, endfacet };

const char* expected_in(State state) {
  switch (state) {
    case State::outside:
      return "'solid'";
    case State::solid:
      return "'facet normal' or 'endsolid'";
    case State::loop:
      return "'outer loop'";
    case State::vertex0:
    case State::vertex1:
    case State::vertex2:
      return "'vertex'";
    case State::endloop:
      return "'endloop'";
    case State::endfacet:
      return "'endfacet'";
  }
  return "";
}

MeshFailure unexpected(State state, const char* p, const char* text_end) {
  return {p, std::string("expected ") + expected_in(state) +
                 (p >= text_end ? ", found the end of the file" : ", found " + quote_word(p))};
}

class FacetReader {
 public:
  FacetReader(const StlChunk& chunk, bool is_first, Vec3f* positions)
      : chunk_(chunk),
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
    p = read_coordinate(skip_plain_blanks(p), next_->x);
    p = read_coordinate(skip_plain_blanks(p), next_->y);
    p = read_coordinate(skip_plain_blanks(p), next_->z);
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

bool begins_with_word(const char* p, std::string_view word) {
  return match_word(skip_plain_blanks(p), word) != nullptr;
}

std::vector<StlChunk> cut_into_facets(std::string_view text, std::size_t chunk_bytes) {
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

void read_facets(std::vector<StlChunk>& chunks, std::size_t index, Vec3f* positions) {
  StlChunk& chunk = chunks[index];
  try {
    const State end = FacetReader(chunk, index == 0, positions).run();
    // Another chunk begins with a facet, as is only right within a solid.
    const bool is_last = index + 1 == chunks.size();
    if (end != (is_last ? State::outside : State::solid))
      throw unexpected(end, skip_plain_blanks(chunk.end), chunks.back().end);
  } catch (const MeshFailure& failure) {
    keep_first(chunk.failure, failure.where, failure.message);
  }
}

}  // namespace oktett
