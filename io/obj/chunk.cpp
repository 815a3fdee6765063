#include "io/obj/chunk.h"

#include <algorithm>

namespace oktett {
namespace {

constexpr const char* kBraceInBlock = "a block starts within a block; expected '}' first";
constexpr const char* kBraceAlone = "'}' without a block before it";

bool is_printable_word(std::string_view word) {
  return std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

/// The brace of the statement at `where`; `rest` is what follows it on its line.
void note_brace(ObjChunk& chunk, const char* where, bool open, const char* rest) {
  const ObjBrace brace{where, open};
  if (chunk.first_brace.where == nullptr)
    chunk.first_brace = brace;
  else if (chunk.last_brace.open == open)
    chunk.fail(where, open ? kBraceInBlock : kBraceAlone);
  chunk.last_brace = brace;
  rest = next_word(rest);
  if (!is_line_end(*rest)) chunk.fail(rest, "expected the end of the line, found " + quote_word(rest));
}

void note_skipped(ObjChunk& chunk, const char* where, std::string_view keyword) {
  // Room for `l`, `p` and the one that is too many.
  if (chunk.skipped.size() >= kMaxSkippedKeywords + 3) return;
  for (const ObjSkipped& known : chunk.skipped)
    if (known.keyword == keyword) return;
  chunk.skipped.push_back({where, keyword});
}

/// The end of the joined line from `p` on, without a backslash at the end of the text.
const char* statement_end(const char* p) {
  const char* end = find_joined_line_end(p);
  return end > p && *end == '\0' && end[-1] == '\\' ? end - 1 : end;
}

/// A statement other than those that make up the bulk of a file.
void note_statement(ObjChunk& chunk, const char* p) {
  const std::string_view keyword = word_at(p);
  const char* rest = p + keyword.size();
  if (!is_printable_word(keyword)) {
    chunk.fail(p, "expected an OBJ keyword, found " + quote_word(p));
  } else if (keyword == "usemtl") {
    chunk.material_uses.push_back({p, trimmed(rest, statement_end(p)), chunk.counts.triangles});
  } else if (keyword == "mtllib") {
    chunk.libraries.push_back({p, trimmed(rest, statement_end(p))});
  } else if (keyword == "{" || keyword == "vertices{" || keyword == "triangles{") {
    note_brace(chunk, p, true, rest);
  } else if (keyword == "}") {
    note_brace(chunk, p, false, rest);
  } else if ((keyword == "vertices" || keyword == "triangles") && word_at(next_word(rest)) == "{") {
    note_brace(chunk, p, true, next_word(rest) + 1);
  } else if ((keyword == "vertices" || keyword == "triangles") && is_line_end(*next_word(rest))) {
    // The brace may stand on the next line.
  } else if (keyword != "o" && keyword != "g" && keyword != "s") {
    note_skipped(chunk, p, keyword);
  }
}

/// Counts the face at `p` and returns the end of its joined line.
const char* count_face(ObjChunk& chunk, const char* p) {
  const LineShape shape = measure_line(p);
  const std::uint64_t corners = (shape.plain() ? shape.words : count_words(p)) - 1;
  chunk.counts.triangles += corners > 2 ? corners - 2 : 0;
  ++chunk.counts.faces;
  chunk.has_slash = chunk.has_slash || shape.slash || !shape.plain();
  return shape.continued() ? find_joined_line_end(p) : shape.end;
}

/// Counts the line at `p` and returns the end of the joined line.
const char* count_line(ObjChunk& chunk, const char* p) {
  if (p[0] == 'f' && is_delimiter(p + 1)) return count_face(chunk, p);
  if (p[0] == 'v' && is_delimiter(p + 1))
    ++chunk.counts.positions;
  else if (p[0] == 'v' && p[1] == 'n' && is_delimiter(p + 2))
    ++chunk.counts.normals;
  else if (p[0] == 'v' && p[1] == 't' && is_delimiter(p + 2))
    ++chunk.counts.uvs;
  else if (p[0] != '#' && !is_line_end(p[0]))
    note_statement(chunk, p);
  const char* end = find_line_end(p);
  return end > p && end[-1] == '\\' ? find_joined_line_end(p) : end;
}

}  // namespace

std::vector<ObjChunk> cut_into_chunks(std::string_view text, std::size_t chunk_bytes) {
  std::vector<ObjChunk> chunks;
  const char* const text_end = text.data() + text.size();
  const char* begin = text.data();
  while (begin < text_end) {
    const char* end = text_end;
    if (static_cast<std::size_t>(text_end - begin) > chunk_bytes) {
      // Going on behind every backslash may make a chunk longer than need be, but never cuts a joined line.
      const char* nominal = begin + chunk_bytes;
      if (nominal[-1] == '\r' && nominal[0] == '\n') --nominal;
      const char* line_end = find_line_end(nominal);
      end = next_line(line_end, text_end);
      while (line_end > begin && line_end[-1] == '\\' && end < text_end) {
        line_end = find_line_end(end);
        end = next_line(line_end, text_end);
      }
    }
    ObjChunk& chunk = chunks.emplace_back();
    chunk.begin = begin;
    chunk.end = begin = end;
  }
  return chunks;
}

void count_chunk(ObjChunk& chunk) {
  for (const char* p = chunk.begin; p < chunk.end;) {
    p = skip_blanks(p);
    const char* end = count_line(chunk, p);
    if (*end == '\0' && end < chunk.end) chunk.fail(end, "unexpected zero byte");
    p = next_line(end, chunk.end);
  }
}

ObjCounts sum_counts(std::vector<ObjChunk>& chunks) {
  ObjCounts total;
  for (ObjChunk& chunk : chunks) {
    chunk.before = total;
    total += chunk.counts;
  }
  return total;
}

std::optional<MeshFailure> find_unpaired_brace(const std::vector<ObjChunk>& chunks) {
  ObjBrace last;
  for (const ObjChunk& chunk : chunks) {
    if (chunk.first_brace.where == nullptr) continue;
    if (chunk.first_brace.open == last.open)
      return MeshFailure{chunk.first_brace.where, last.open ? kBraceInBlock : kBraceAlone};
    last = chunk.last_brace;
  }
  if (last.open)
    return MeshFailure{last.where, "a block is not closed; expected '}' before the end of the file"};
  return std::nullopt;
}

}  // namespace oktett
