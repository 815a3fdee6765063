#include "io/mesh/reading.h"

#include <fmt/format.h>

#include "core/error.h"

namespace oktett {

MeshOddities& MeshOddities::operator+=(const MeshOddities& later) {
  for (const auto member : {&MeshOddities::crossings, &MeshOddities::small_faces, &MeshOddities::short_lines,
                            &MeshOddities::bad_normals, &MeshOddities::no_normals, &MeshOddities::no_uvs})
    this->*member += later.*member;
  return *this;
}

void MeshOddities::report(const std::function<void(const char*, std::string)>& note) const {
  const auto say = [&](const Tally& tally, const std::string& one, const std::string& many) {
    if (tally.count > 0) note(tally.first, tally.count == 1 ? one : std::to_string(tally.count) + many);
  };
  say(crossings, "a face crosses itself: its triangles may overlap",
      " faces cross themselves: their triangles may overlap");
  say(small_faces, "a face of fewer than 3 corners is skipped", " faces of fewer than 3 corners are skipped");
  say(short_lines, "a line or point without vertices to join is skipped",
      " lines or points without vertices to join are skipped");
  say(bad_normals, "a normal is not finite: corners that have it show the normal of their face",
      " normals are not finite: corners that have them show the normal of their face");
  say(no_normals, "a corner names a normal, but the file defines none",
      " corners name a normal, but the file defines none");
  say(no_uvs, "a corner names texture coordinates, but the file defines none",
      " corners name texture coordinates, but the file defines none");
}

void fail_at_line(const std::string& path, std::string_view text, const MeshFailure& failure) {
  const TextPosition position = LineCounter(text).at(failure.where);
  throw Error(Location{path, position.line, position.column}, failure.message);
}

void fail_at_byte(const std::string& path, std::string_view text, const MeshFailure& failure) {
  throw Error(Location{path}, "byte " + std::to_string(failure.where - text.data()) + ": " + failure.message);
}

void check_limit(const std::string& path, std::uint64_t count, const char* what, std::size_t most) {
  if (count > most)
    throw Error(Location{path},
                std::to_string(count) + " " + what + ", but indices reach only " + std::to_string(most));
}

std::string quote_name(std::string_view text) {
  constexpr std::size_t most = 40;
  std::string result = "'";
  for (const char c : text.substr(0, most)) {
    const auto code = static_cast<unsigned char>(c);
    result += code < 0x20 || code == 0x7f ? '?' : c;
  }
  // A cut must not leave half a UTF-8 sequence behind.
  if (text.size() > most) {
    while (result.size() > 1 && (static_cast<unsigned char>(result.back()) & 0xc0) == 0x80) result.pop_back();
    if (result.size() > 1 && static_cast<unsigned char>(result.back()) >= 0xc0) result.pop_back();
    result += "...";
  }
  return result + "'";
}

std::string quote_word(const char* p) {
  std::string word(word_at(p).substr(0, 64));
  // Not a name but a keyword or a number, where bytes beyond ASCII are garbage in no known encoding.
  for (char& c : word)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  return quote_name(word);
}

void stop_at_number(const char* p, NumberProblem problem) {
  if (is_line_end(*p) || *p == '#') stop_at(p, "expected a number, found the end of the line");
  if (problem == NumberProblem::overflow)
    stop_at(p, "expected a finite number, but " + quote_word(p) + " is out of range");
  stop_at(p, "expected a number, found " + quote_word(p));
}

void stop_at_coordinate(const char* p, float x) {
  if (!std::isfinite(x)) stop_at(p, "expected a finite number, found " + quote_word(p));
  stop_at(p, "coordinate out of range: " + quote_word(p) + " (magnitude at most 1e30)");
}

std::string bad_coordinate(float x) {
  if (std::isfinite(x)) return fmt::format("coordinate out of range: {} (magnitude at most 1e30)", x);
  return std::string("expected a finite number, found ") + (std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf");
}

}  // namespace oktett
