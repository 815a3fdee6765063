#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "core/parallel.h"
#include "io/mesh/reading.h"
#include "io/ply/body.h"
#include "io/ply/header.h"

namespace oktett {
namespace {

class BinaryBody final : public PlyBody {
 public:
  BinaryBody(const PlyHeader& header, std::string_view text, std::size_t chunk_bytes)
      : body_(header.body),
        end_(text.data() + text.size()),
        chunk_bytes_(chunk_bytes),
        swap_(header.format == PlyFormat::big_endian) {}

  std::uint64_t locate(std::vector<PlyPart*>& parts) override {
    const char* p = body_;
    for (PlyPart* part : parts) p = locate(*part, p);
    return static_cast<std::uint64_t>(end_ - p);
  }

  void count_faces(PlyFaces& faces) const override {
    const bool equal = faces.stride > 0 && !faces.strips;
    oneapi::tbb::parallel_for(std::size_t{0}, faces.chunks.size(), [&](std::size_t i) {
      PlyChunk& chunk = faces.chunks[i];
      try {
        if (equal) {
          count_record(faces, starts_at(faces, chunk.begin), chunk);
          chunk.triangles *= chunk.records;
          chunk.uvs *= chunk.records;
        } else {
          for_each_record(faces, chunk, [&](std::uint64_t, const std::vector<const char*>& starts) {
            count_record(faces, starts, chunk);
          });
        }
      } catch (const MeshFailure& failure) {
        keep_first(chunk.failure, failure.where, failure.message);
      }
    });
  }

  void read_vertices(const PlyVertices& vertices, const PlyChunk& chunk,
                     const PlyVertexColumns& columns) const override {
    const std::vector<PlyProperty>& properties = vertices.element->properties;
    // Blocks that stay in the cache from one column to the next.
    constexpr std::uint64_t kBlock = 1024;
    if (vertices.stride > 0) {
      for (std::uint64_t i = 0; i < chunk.records; i += kBlock)
        read_block(vertices, chunk.begin + i * vertices.stride, chunk.first + i,
                   std::min(kBlock, chunk.records - i), columns);
      return;
    }
    for_each_record(vertices, chunk, [&](std::uint64_t vertex, const std::vector<const char*>& starts) {
      for (std::size_t role = 0; role < kPlyRoles; ++role) {
        if (columns.base[role] == nullptr) continue;
        const auto i = static_cast<std::size_t>(vertices.roles[role]);
        const float x =
            role < kPlyNormals && columns.is_far()
                ? static_cast<float>(load_double(properties[i].type, swap_, starts[i]) - columns.centre[role])
                : load_float(properties[i].type, swap_, starts[i]);
        if (!(std::abs(x) <= most_of(role)) && must_hold(role)) stop_at(starts[i], bad_coordinate(x));
        *columns.at(role, vertex) = x;
      }
      for (const PlyExtra& extra : vertices.extras)
        extra.put(vertex, number_of(vertices, extra, starts[static_cast<std::size_t>(extra.property)]));
    });
  }

  void read_faces(const PlyFaces& faces, const PlyChunk& chunk, PlyFaceWriter& writer) const override {
    const auto list = static_cast<std::size_t>(faces.indices);
    const PlyProperty& indices = faces.element->properties[list];
    if (faces.stride > 0 && !faces.strips && faces.texcoords == PlyElement::kNone &&
        chunk.triangles == chunk.records) {
      const char* const first = chunk.begin + faces.offsets[list] + size_of(indices.length_type);
      const std::uint64_t triangle = writer.next();
      with_type(indices.type, swap_, [&]<class T, bool kSwap>() {
        if constexpr (std::integral<T>) read_triangles<T, kSwap>(first, faces.stride, chunk.records, writer);
      });
      read_extras(faces, chunk.begin, triangle, chunk.records);
      return;
    }
    for_each_record(faces, chunk, [&](std::uint64_t, const std::vector<const char*>& starts) {
      writer.begin(starts[0]);
      const char* p = starts[list] + size_of(indices.length_type);
      for (std::int64_t n = load_whole(indices.length_type, swap_, starts[list]); n > 0; --n) {
        writer.add_index(load_whole(indices.type, swap_, p), p);
        p += size_of(indices.type);
      }
      if (faces.texcoords != PlyElement::kNone) read_texcoords(faces, starts, writer);
      writer.end();
      for (const PlyExtra& extra : faces.extras)
        writer.put(extra, number_of(faces, extra, starts[static_cast<std::size_t>(extra.property)]));
    });
  }

  void read_edges(const PlyEdges& edges, const PlyChunk& chunk, PlyEdgeWriter& writer) const override {
    for_each_record(edges, chunk, [&](std::uint64_t, const std::vector<const char*>& starts) {
      for (const std::size_t end : edges.ends)
        writer.add(load_whole(edges.element->properties[end].type, swap_, starts[end]), starts[end]);
    });
  }

 private:
  double number_of(const PlyPart& part, const PlyExtra& extra, const char* p) const {
    const PlyType type = part.element->properties[static_cast<std::size_t>(extra.property)].type;
    return with_type(type, swap_,
                     [p]<class T, bool kSwap>() { return static_cast<double>(load_value<T, kSwap>(p)); });
  }

  /// Reads the extras of `count` records of equal size, the first at `p`, for the elements from `first` on.
  void read_extras(const PlyPart& part, const char* p, std::uint64_t first, std::uint64_t count) const {
    if (part.extras.empty() || read_bytes(part, p, first, count)) return;
    for (const PlyExtra& extra : part.extras) {
      const auto i = static_cast<std::size_t>(extra.property);
      const char* const begin = p + part.offsets[i];
      with_type(part.element->properties[i].type, swap_, [&]<class T, bool kSwap>() {
        for (std::uint64_t k = 0; k < count; ++k)
          extra.put(first + k, load_value<T, kSwap>(begin + k * part.stride));
      });
    }
  }

  /// The same if they are the bytes of colours one behind the other and nothing else.
  static bool read_bytes(const PlyPart& part, const char* p, std::uint64_t first, std::uint64_t count) {
    const std::vector<PlyExtra>& extras = part.extras;
    const std::size_t begin = part.offsets[static_cast<std::size_t>(extras[0].property)];
    for (std::size_t k = 0; k < extras.size(); ++k) {
      const auto i = static_cast<std::size_t>(extras[k].property);
      if (extras[k].meaning != PlyMeaning::byte || part.element->properties[i].type != PlyType::uint8 ||
          part.offsets[i] != begin + k || extras[k].component != k)
        return false;
    }
    const auto copy = [&]<std::size_t kSize>() {
      std::uint8_t* out = extras[0].bytes + first * kSize;
      for (const char* from = p + begin; count > 0; --count, from += part.stride, out += kSize)
        std::memcpy(out, from, kSize);
    };
    extras.size() == 3 ? copy.template operator()<3>() : copy.template operator()<4>();
    return true;
  }

  const char* locate(PlyPart& part, const char* begin) const {
    const PlyElement& element = *part.element;
    const std::size_t least = element.least_bytes();
    if (least == 0 || element.count == 0) return begin;
    const auto left = static_cast<std::uint64_t>(end_ - begin);
    if (element.count > left / least)
      stop_at(begin, std::to_string(element.count) + " records of element " + quote_name(element.name) +
                         " take at least " + std::to_string(least) + " bytes each, but only " +
                         std::to_string(left) + " bytes are left");
    find_layout(part, begin);
    if (part.stride == 0) return walk(part, begin);
    const std::uint64_t per_chunk = std::max<std::uint64_t>(chunk_bytes_ / part.stride, 1);
    for (std::uint64_t first = 0; first < element.count; first += per_chunk) {
      PlyChunk& chunk = part.chunks.emplace_back();
      chunk.first = first;
      chunk.records = std::min(per_chunk, element.count - first);
      chunk.begin = begin + first * part.stride;
      chunk.end = chunk.begin + chunk.records * part.stride;
    }
    return begin + element.count * part.stride;
  }

  /// Sets the stride and the offsets if all records have the size of the first one, at `begin`.
  void find_layout(PlyPart& part, const char* begin) const {
    const PlyElement& element = *part.element;
    std::vector<const char*> starts;
    const std::size_t size = static_cast<std::size_t>(skip_record(element, begin, starts) - begin);
    if (element.count > static_cast<std::uint64_t>(end_ - begin) / size) return;
    if (element.has_lists() && !have_equal_lengths(element, size, starts)) return;
    part.stride = size;
    for (const char* start : starts) part.offsets.push_back(static_cast<std::size_t>(start - begin));
  }

  /// Whether all records, of `size` bytes, have the lengths of lists of the first one.
  bool have_equal_lengths(const PlyElement& element, std::size_t size,
                          const std::vector<const char*>& starts) const {
    std::atomic<bool> equal{true};
    in_parts(element.count, std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = 0; i < starts.size() && equal; ++i) {
        if (!element.properties[i].is_list) continue;
        const char* const first = starts[i];
        with_type(element.properties[i].length_type, swap_, [&]<class T, bool kSwap>() {
          const T wanted = load_value<T, kSwap>(first);
          bool same = true;
          for (std::size_t r = begin; r < end; ++r) same &= load_value<T, kSwap>(first + r * size) == wanted;
          if (!same) equal = false;
        });
      }
    });
    return equal;
  }

  /// Cuts records of different sizes into chunks, one after the other.
  const char* walk(PlyPart& part, const char* p) const {
    std::vector<const char*> starts;
    for (std::uint64_t i = 0; i < part.element->count; ++i) {
      if (part.chunks.empty() ||
          static_cast<std::size_t>(p - part.chunks.back().begin) >= std::max<std::size_t>(chunk_bytes_, 1))
        part.chunks.push_back({.begin = p, .end = p, .first = i});
      p = skip_record(*part.element, p, starts);
      ++part.chunks.back().records;
      part.chunks.back().end = p;
    }
    return p;
  }

  /// Past the record at `p`; `starts` gets where its properties stand.
  const char* skip_record(const PlyElement& element, const char* p, std::vector<const char*>& starts) const {
    starts.clear();
    for (const PlyProperty& property : element.properties) {
      starts.push_back(p);
      const auto left = static_cast<std::uint64_t>(end_ - p);
      std::uint64_t bytes = size_of(property.is_list ? property.length_type : property.type);
      if (bytes > left) stop_short(element);
      if (property.is_list) {
        const std::int64_t length = load_whole(property.length_type, swap_, p);
        if (length < 0) stop_at(p, "a list of length " + std::to_string(length));
        bytes += static_cast<std::uint64_t>(length) * size_of(property.type);
        if (bytes > left) stop_short(element);
      }
      p += bytes;
    }
    return p;
  }

  [[noreturn]] void stop_short(const PlyElement& element) const {
    stop_at(end_, "the file ends within element " + quote_name(element.name));
  }

  /// Where the properties of the record at `p` stand.
  static std::vector<const char*> starts_at(const PlyPart& part, const char* p) {
    std::vector<const char*> starts;
    for (const std::size_t offset : part.offsets) starts.push_back(p + offset);
    return starts;
  }

  /// Calls f(record, starts) for each record of the chunk.
  template <class F>
  void for_each_record(const PlyPart& part, const PlyChunk& chunk, const F& f) const {
    std::vector<const char*> starts;
    const char* p = chunk.begin;
    for (std::uint64_t i = 0; i < chunk.records; ++i) {
      p = skip_record(*part.element, p, starts);
      f(chunk.first + i, starts);
    }
  }

  void count_record(const PlyFaces& faces, const std::vector<const char*>& starts, PlyChunk& chunk) const {
    const auto list = static_cast<std::size_t>(faces.indices);
    const PlyProperty& indices = faces.element->properties[list];
    const auto length = static_cast<std::uint64_t>(load_whole(indices.length_type, swap_, starts[list]));
    if (faces.strips) {
      StripCounter strips;
      const char* p = starts[list] + size_of(indices.length_type);
      for (std::uint64_t i = 0; i < length; ++i, p += size_of(indices.type))
        strips.add(load_whole(indices.type, swap_, p));
      chunk.triangles += strips.triangles;
      return;
    }
    chunk.triangles += count_polygon(length);
    if (faces.texcoords == PlyElement::kNone) return;
    const auto uvs = static_cast<std::size_t>(faces.texcoords);
    const PlyType type = faces.element->properties[uvs].length_type;
    const auto values = static_cast<std::uint64_t>(load_whole(type, swap_, starts[uvs]));
    check_texcoords(values, length, starts[uvs]);
    chunk.uvs += values / 2;
  }

  void read_texcoords(const PlyFaces& faces, const std::vector<const char*>& starts,
                      PlyFaceWriter& writer) const {
    const auto list = static_cast<std::size_t>(faces.texcoords);
    const PlyProperty& property = faces.element->properties[list];
    const char* p = starts[list] + size_of(property.length_type);
    for (std::int64_t n = load_whole(property.length_type, swap_, starts[list]); n > 0; --n) {
      const float x = load_float(property.type, swap_, p);
      if (!std::isfinite(x)) stop_at(p, bad_coordinate(x));
      writer.add_uv(x);
      p += size_of(property.type);
    }
  }

  /// The greatest magnitude that a number of a vertex may have.
  static float most_of(std::size_t role) { return role < kPlyNormals ? kMostCoordinate : kMostUv; }

  /// A normal that is not finite counts as none.
  static bool must_hold(std::size_t role) { return role < kPlyNormals || role >= kPlyUvs; }

  /// Reads `count` vertices, the first at `p`, column by column.
  void read_block(const PlyVertices& vertices, const char* p, std::uint64_t vertex, std::uint64_t count,
                  const PlyVertexColumns& columns) const {
    read_extras(vertices, p, vertex, count);
    for (std::size_t role = 0; role < kPlyRoles; ++role) {
      float* const out = columns.at(role, vertex);
      if (out == nullptr) continue;
      const auto i = static_cast<std::size_t>(vertices.roles[role]);
      const char* const first = p + vertices.offsets[i];
      const std::size_t step = columns.step[role], stride = vertices.stride;
      const float most = most_of(role);
      if (role < kPlyNormals && columns.is_far()) {
        for (std::uint64_t k = 0; k < count; ++k)
          out[k * step] = static_cast<float>(
              load_double(vertices.element->properties[i].type, swap_, first + k * stride) -
              columns.centre[role]);
        continue;
      }
      const bool good =
          with_type(vertices.element->properties[i].type, swap_, [&]<class T, bool kSwap>() -> bool {
            bool all = true;
            for (std::uint64_t k = 0; k < count; ++k) {
              const float x = static_cast<float>(load_value<T, kSwap>(first + k * stride));
              all &= std::abs(x) <= most;
              out[k * step] = x;
            }
            return all;
          });
      if (good || !must_hold(role)) continue;
      for (std::uint64_t k = 0; k < count; ++k)
        if (!(std::abs(out[k * step]) <= most)) stop_at(first + k * stride, bad_coordinate(out[k * step]));
    }
  }

  /// Reads triangles whose indices stand at `p` and every `stride` bytes behind it.
  template <class T, bool kSwap>
  static void read_triangles(const char* p, std::size_t stride, std::uint64_t count, PlyFaceWriter& writer) {
    std::uint32_t* const out = writer.take_triangles(count, p);
    const auto vertex_count = static_cast<std::uint32_t>(writer.vertex_count());
    bool good = true;
    for (std::uint64_t i = 0; i < count; ++i)
      for (std::uint64_t k = 0; k < 3; ++k) {
        // Negative indices become greater than all others.
        const auto index = static_cast<std::uint32_t>(load_value<T, kSwap>(p + i * stride + k * sizeof(T)));
        good &= index < vertex_count;
        out[3 * i + k] = index;
      }
    if (good) return;
    for (std::uint64_t i = 0; i < count; ++i)
      for (std::uint64_t k = 0; k < 3; ++k) {
        const char* const where = p + i * stride + k * sizeof(T);
        writer.check_index(load_value<T, kSwap>(where), where);
      }
  }

  const char* const body_;
  const char* const end_;
  const std::size_t chunk_bytes_;
  const bool swap_;
};

}  // namespace

std::unique_ptr<PlyBody> make_binary_body(const PlyHeader& header, std::string_view text,
                                          std::size_t chunk_bytes) {
  return std::make_unique<BinaryBody>(header, text, chunk_bytes);
}

}  // namespace oktett
