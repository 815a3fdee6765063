#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/mesh/reading.h"
#include "io/ply/body.h"

namespace oktett {
namespace {

/// The start of the next value on the line.
const char* next_value(const char* p, const PlyProperty& property) {
  p = skip_plain_blanks(p);
  if (is_line_end(*p))
    stop_at(p, "expected a value of " + quote_name(property.name) + ", found the end of the line");
  return p;
}

const char* skip_value(const char* p, const PlyProperty& property) {
  p = next_value(p, property);
  while (!is_blank(*p) && !is_line_end(*p)) ++p;
  return p;
}

bool ends_value(const char* p) { return is_blank(*p) || is_line_end(*p); }

const char* read_length(const char* p, const PlyProperty& property, std::uint64_t& length) {
  p = next_value(p, property);
  const char* const end = scan_whole(p, length);
  if (end == p || !ends_value(end)) stop_at(p, "expected the length of a list, found " + quote_word(p));
  // A value takes a blank and a character.
  if (length > static_cast<std::uint64_t>(find_line_end(end) - end) / 2)
    stop_at(p, "the line is too short for a list of " + std::to_string(length) + " values");
  return end;
}

const char* read_index(const char* p, const PlyProperty& property, std::int64_t& index) {
  p = next_value(p, property);
  const char* const digits = *p == '-' || *p == '+' ? p + 1 : p;
  std::uint64_t value = 0;
  const char* const end = scan_whole(digits, value);
  if (end == digits || !ends_value(end)) stop_at(p, "expected a vertex index, found " + quote_word(p));
  index = static_cast<std::int64_t>(std::min(value, std::uint64_t{1} << 62));
  if (*p == '-') index = -index;
  return end;
}

/// A number that becomes part of an attribute; infinite if a float cannot hold it.
const char* read_extra(const char* p, const PlyProperty& property, float& x) {
  p = next_value(p, property);
  NumberProblem problem = NumberProblem::none;
  if (const char* const end = scan_float(p, x, problem)) return end;
  if (problem != NumberProblem::overflow) stop_at_number(p, problem);
  x = *p == '-' ? -HUGE_VALF : HUGE_VALF;
  return skip_value(p, property);
}

const char* skip_property(const char* p, const PlyProperty& property) {
  std::uint64_t length = 1;
  if (property.is_list) p = read_length(p, property, length);
  for (; length > 0; --length) p = skip_value(p, property);
  return p;
}

void expect_end(const char* p) {
  p = skip_plain_blanks(p);
  if (!is_line_end(*p)) stop_at(p, "expected the end of the line, found " + quote_word(p));
}

/// Calls read(p) for each line of [p, end) that is not empty, `most` lines at the most. Returns where the
/// next one begins.
template <class Read>
const char* for_each_line(const char* p, const char* end, std::uint64_t most, const Read& read) {
  while (p < end && most > 0) {
    p = skip_plain_blanks(p);
    if (!is_line_end(*p)) {
      read(p);
      --most;
    }
    p = next_line(find_line_end(p), end);
  }
  return p;
}

/// Each record stands on a line of its own; empty lines are skipped.
class AsciiBody final : public PlyBody {
 public:
  AsciiBody(const PlyHeader& header, std::string_view text, std::size_t chunk_bytes)
      : end_(text.data() + text.size()), chunk_bytes_(std::max<std::size_t>(chunk_bytes, 1)) {
    cut(header.body);
  }

  std::uint64_t locate(std::vector<PlyPart*>& parts) override {
    for (PlyPart* part : parts) take(*part);
    return lines_left_;
  }

  void count_faces(PlyFaces& faces) const override {
    oneapi::tbb::parallel_for(std::size_t{0}, faces.chunks.size(), [&](std::size_t i) {
      try {
        count(faces, faces.chunks[i]);
      } catch (const MeshFailure& failure) {
        keep_first(faces.chunks[i].failure, failure.where, failure.message);
      }
    });
  }

  void read_vertices(const PlyVertices& vertices, const PlyChunk& chunk,
                     const PlyVertexColumns& columns) const override {
    struct Value {
      const PlyProperty* property;
      std::size_t role;
      const PlyExtra* extra;
    };
    std::vector<Value> values;
    for (std::size_t i = 0; i < vertices.element->properties.size(); ++i) {
      const auto role = std::ranges::find(vertices.roles, static_cast<int>(i));
      values.push_back({&vertices.element->properties[i],
                        static_cast<std::size_t>(role - vertices.roles.begin()), extra_of(vertices, i)});
    }
    std::uint64_t vertex = chunk.first;
    for_each_line(chunk.begin, chunk.end, chunk.records, [&](const char* p) {
      for (const Value& value : values) {
        if (value.extra != nullptr) {
          float x = 0;
          p = read_extra(p, *value.property, x);
          value.extra->put(vertex, x);
          continue;
        }
        if (value.role == kPlyRoles || columns.base[value.role] == nullptr) {
          p = skip_property(p, *value.property);
          continue;
        }
        p = next_value(p, *value.property);
        float* const x = columns.at(value.role, vertex);
        const bool is_normal = value.role >= kPlyNormals && value.role < kPlyUvs;
        p = is_normal                  ? read_number(p, *x)
            : value.role < kPlyNormals ? read_coordinate_from(columns.centre[value.role], p, *x)
                                       : read_uv_coordinate(p, *x);
      }
      expect_end(p);
      ++vertex;
    });
    if (vertex != chunk.first + chunk.records) stop_changed(chunk.begin);
  }

  void read_faces(const PlyFaces& faces, const PlyChunk& chunk, PlyFaceWriter& writer) const override {
    const std::vector<PlyProperty>& properties = faces.element->properties;
    std::vector<const PlyExtra*> extras;
    for (std::size_t i = 0; i < properties.size(); ++i) extras.push_back(extra_of(faces, i));
    std::vector<float> numbers(properties.size());
    for_each_line(chunk.begin, chunk.end, chunk.records, [&](const char* p) {
      writer.begin(p);
      for (int i = 0; i < static_cast<int>(properties.size()); ++i) {
        const PlyProperty& property = properties[static_cast<std::size_t>(i)];
        if (extras[static_cast<std::size_t>(i)] != nullptr) {
          p = read_extra(p, property, numbers[static_cast<std::size_t>(i)]);
          continue;
        }
        if (i != faces.indices && i != faces.texcoords) {
          p = skip_property(p, property);
          continue;
        }
        std::uint64_t length = 0;
        p = read_length(p, property, length);
        for (; length > 0; --length) p = read_item(p, property, i == faces.indices, writer);
      }
      expect_end(p);
      writer.end();
      for (std::size_t i = 0; i < properties.size(); ++i)
        if (extras[i] != nullptr) writer.put(*extras[i], double{numbers[i]});
    });
  }

  void read_edges(const PlyEdges& edges, const PlyChunk& chunk, PlyEdgeWriter& writer) const override {
    const std::vector<PlyProperty>& properties = edges.element->properties;
    for_each_line(chunk.begin, chunk.end, chunk.records, [&](const char* p) {
      std::array<std::int64_t, 2> index{};
      std::array<const char*, 2> where{};
      for (std::size_t i = 0; i < properties.size(); ++i) {
        const auto end = std::ranges::find(edges.ends, i) - edges.ends.begin();
        if (end == 2) {
          p = skip_property(p, properties[i]);
          continue;
        }
        const auto k = static_cast<std::size_t>(end);
        where[k] = skip_plain_blanks(p);
        p = read_index(p, properties[i], index[k]);
      }
      expect_end(p);
      for (std::size_t k = 0; k < 2; ++k) writer.add(index[k], where[k]);
    });
  }

 private:
  /// The extra of property `i`, or null.
  static const PlyExtra* extra_of(const PlyPart& part, std::size_t i) {
    const auto found = std::ranges::find(part.extras, static_cast<int>(i), &PlyExtra::property);
    return found == part.extras.end() ? nullptr : &*found;
  }

  static const char* read_item(const char* p, const PlyProperty& property, bool is_index,
                               PlyFaceWriter& writer) {
    if (is_index) {
      std::int64_t index = 0;
      const char* const end = read_index(p, property, index);
      writer.add_index(index, skip_plain_blanks(p));
      return end;
    }
    float x = 0;
    p = read_uv_coordinate(next_value(p, property), x);
    writer.add_uv(x);
    return p;
  }

  static void count(const PlyFaces& faces, PlyChunk& chunk) {
    const std::vector<PlyProperty>& properties = faces.element->properties;
    const int last = std::max(faces.indices, faces.texcoords);
    for_each_line(chunk.begin, chunk.end, chunk.records, [&](const char* p) {
      for (int i = 0; i <= last; ++i) {
        const PlyProperty& property = properties[static_cast<std::size_t>(i)];
        std::uint64_t length = 0;
        const char* const value = p;
        if (i == faces.indices && faces.strips) {
          StripCounter strips;
          p = read_length(p, property, length);
          for (std::int64_t index; length > 0; --length) {
            p = read_index(p, property, index);
            strips.add(index);
          }
          chunk.triangles += strips.triangles;
        } else if (i == faces.indices) {
          read_length(p, property, length);
          chunk.triangles += count_polygon(length);
          // What follows the last list that matters is looked at later.
          if (i < last) p = skip_property(value, property);
        } else {
          if (i == faces.texcoords) {
            read_length(p, property, length);
            chunk.uvs += length / 2;
          }
          if (i < last) p = skip_property(value, property);
        }
      }
    });
  }

  /// Cuts the body into runs of whole lines and counts those that are not empty.
  void cut(const char* begin) {
    while (begin < end_) {
      PlyChunk& chunk = chunks_.emplace_back();
      chunk.begin = begin;
      begin = static_cast<std::size_t>(end_ - begin) <= chunk_bytes_
                  ? end_
                  : next_line(find_line_end(begin + chunk_bytes_ - 1), end_);
      chunk.end = begin;
    }
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
      PlyChunk& chunk = chunks_[i];
      for (const char* p = chunk.begin; p < chunk.end;) {
        p = skip_plain_blanks(p);
        const char* const end = find_line_end(p);
        chunk.records += end > p ? 1 : 0;
        if (*end == '\0' && end < end_) keep_first(chunk.failure, end, "unexpected zero byte");
        p = next_line(end, chunk.end);
      }
    });
    for (const PlyChunk& chunk : chunks_) {
      if (chunk.failure) throw *chunk.failure;
      lines_left_ += chunk.records;
    }
  }

  /// Gives `part` the lines that are next.
  void take(PlyPart& part) {
    if (part.element->properties.empty()) return;
    std::uint64_t left = part.element->count;
    if (left > lines_left_)
      stop_at(end_, "expected " + std::to_string(left) + " lines of element " +
                        quote_name(part.element->name) + ", found " + std::to_string(lines_left_));
    lines_left_ -= left;
    while (left > 0) {
      PlyChunk& source = chunks_[next_];
      const std::uint64_t records = std::min(left, source.records);
      const char* const begin = source.begin;
      const char* end = source.end;
      if (left < source.records) {
        source.begin = end = for_each_line(source.begin, source.end, left, [](const char*) {});
        source.records -= left;
      } else {
        ++next_;
      }
      if (records > 0) {
        PlyChunk& chunk = part.chunks.emplace_back();
        chunk.begin = begin, chunk.end = end;
        chunk.first = part.element->count - left, chunk.records = records;
      }
      left -= records;
    }
  }

  const char* const end_;
  const std::size_t chunk_bytes_;
  std::vector<PlyChunk> chunks_;  ///< of the whole body; those before next_ are taken
  std::size_t next_ = 0;
  std::uint64_t lines_left_ = 0;
};

}  // namespace

std::unique_ptr<PlyBody> make_ascii_body(const PlyHeader& header, std::string_view text,
                                         std::size_t chunk_bytes) {
  return std::make_unique<AsciiBody>(header, text, chunk_bytes);
}

}  // namespace oktett
