#include "io/gltf/accessor.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "core/parallel.h"
#include "io/gltf/packed.h"
#include "io/mesh/reading.h"

namespace oktett {
namespace {

/// Elements that one task reads.
constexpr std::uint64_t kPerTask = std::uint64_t{1} << 16;
/// Most elements of an accessor for which no byte stands in the file.
constexpr std::uint64_t kMostZeros = std::uint64_t{1} << 20;

static_assert(sizeof(Vec3f) == 12 && sizeof(Vec2f) == 8);

template <class T>
T load(const char* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

/// A number as a float: whole ones as they are, or as a part of the greatest one (glTF 2.0, 3.6.2.2).
template <class T>
float as_float(T value, bool normalized) {
  const float x = static_cast<float>(value);
  if constexpr (sizeof(T) > 2) return x;
  if (!normalized) return x;
  return std::max(x / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

/// Calls f.operator()<T>() for the type of the numbers.
template <class F>
void with_number(GltfNumber number, const F& f) {
  switch (number) {
    case GltfNumber::int8:
      return f.template operator()<std::int8_t>();
    case GltfNumber::uint8:
      return f.template operator()<std::uint8_t>();
    case GltfNumber::int16:
      return f.template operator()<std::int16_t>();
    case GltfNumber::uint16:
      return f.template operator()<std::uint16_t>();
    case GltfNumber::uint32:
      return f.template operator()<std::uint32_t>();
    case GltfNumber::float32:
      return f.template operator()<float>();
  }
}

/// Reads `kSize` numbers per element, without a gap, of elements `first` to `last`.
template <std::uint32_t kSize>
void read_part(const GltfElements& e, std::uint64_t first, std::uint64_t last, float* out) {
  if (e.data == nullptr) {
    std::fill(out + kSize * first, out + kSize * last, 0.0f);
    return;
  }
  if (e.number == GltfNumber::float32 && e.stride == 4 * kSize) {
    std::memcpy(out + kSize * first, e.data + std::uint64_t{e.stride} * first, 4 * kSize * (last - first));
    return;
  }
  with_number(e.number, [&]<class T>() {
    for (std::uint64_t i = first; i < last; ++i) {
      const char* const p = e.data + std::uint64_t{e.stride} * i;
      for (std::uint32_t k = 0; k < kSize; ++k)
        out[kSize * i + k] = as_float(load<T>(p + k * sizeof(T)), e.normalized);
    }
  });
}

std::uint64_t whole_at(const char* p, GltfNumber number) {
  switch (number) {
    case GltfNumber::uint8:
      return load<std::uint8_t>(p);
    case GltfNumber::uint16:
      return load<std::uint16_t>(p);
    default:
      return load<std::uint32_t>(p);
  }
}

[[noreturn]] void fail(const GltfFile& file, const GltfElements& e, const std::string& what) {
  file.fail(e.name + ": " + what);
}

/// Calls put(index, value) for each element that stands elsewhere.
template <class Put>
void for_each_sparse(const GltfFile& file, const GltfElements& e, const Put& put) {
  const std::uint32_t size = bytes_of(e.number) * e.components;
  for (std::uint64_t i = 0; i < e.sparse_count; ++i) {
    const std::uint64_t index = whole_at(e.sparse_indices + i * bytes_of(e.sparse_number), e.sparse_number);
    if (index >= e.count)
      fail(file, e,
           "sparse element " + std::to_string(index) + " is out of range: it has " + std::to_string(e.count));
    put(index, e.sparse_values + i * size);
  }
}

template <std::uint32_t kSize>
void read_all(const GltfFile& file, const GltfElements& e, GltfCheck check, float* out) {
  if (e.components != kSize)
    fail(file, e,
         "expected vectors of " + std::to_string(kSize) + " numbers, found " + std::to_string(e.components));
  if (e.number == GltfNumber::uint32) fail(file, e, "expected numbers of another type than 32-bit integers");
  std::atomic<bool> good = true;
  const float most = check == GltfCheck::coordinate ? kMostCoordinate : std::numeric_limits<float>::max();
  in_parts(e.count, kPerTask, [&](std::uint64_t first, std::uint64_t last) {
    read_part<kSize>(e, first, last, out);
    bool all = true;
    for (std::uint64_t i = kSize * first; i < kSize * last; ++i) all &= std::abs(out[i]) <= most;
    if (!all) good = false;
  });
  for_each_sparse(file, e, [&](std::uint64_t index, const char* value) {
    with_number(e.number, [&]<class T>() {
      for (std::uint32_t k = 0; k < kSize; ++k) {
        const float x = as_float(load<T>(value + k * sizeof(T)), e.normalized);
        if (!(std::abs(x) <= most)) good = false;
        out[kSize * index + k] = x;
      }
    });
  });
  if (good) return;
  // What a sparse element replaces may be anything.
  for (std::uint64_t i = 0; i < kSize * e.count; ++i)
    if (!(std::abs(out[i]) <= most))
      fail(file, e, "element " + std::to_string(i / kSize) + ": " + bad_coordinate(out[i]));
}

}  // namespace

std::string_view GltfAccessors::view_bytes(std::uint32_t number, const std::string& where) {
  const GltfView& view = file_.model().views[number];
  const std::string name = where + ": bufferViews[" + std::to_string(number) + "]";
  if (!view.packing) return file_.bytes(view.range, name);
  const auto [found, is_new] = unpacked_.try_emplace(number);
  if (is_new) found->second = unpack_meshopt(file_, *view.packing, name);
  return found->second;
}

std::string_view GltfAccessors::elements_in(std::uint32_t view, std::uint64_t offset, std::uint64_t count,
                                            std::uint32_t size, std::uint32_t stride,
                                            const std::string& where) {
  const std::string_view bytes = view_bytes(view, where);
  // Nothing here overflows: a count is at most that of bytes.
  const bool fits =
      count == 0 || (offset <= bytes.size() && count <= bytes.size() && size <= bytes.size() - offset &&
                     (count - 1) * stride <= bytes.size() - offset - size);
  if (!fits)
    file_.fail(where + ": " + std::to_string(count) + " elements from byte " + std::to_string(offset) +
               " on do not fit into bufferViews[" + std::to_string(view) + "], which has " +
               std::to_string(bytes.size()) + " bytes");
  return count == 0 ? std::string_view{} : bytes.substr(offset);
}

GltfElements GltfAccessors::elements(std::uint32_t number) {
  const GltfAccessor& accessor = file_.model().accessors[number];
  GltfElements e;
  e.name = "accessors[" + std::to_string(number) + "]";
  if (!accessor.problem.empty()) file_.fail(e.name + ": " + accessor.problem);
  e.count = accessor.count, e.number = accessor.number;
  e.components = accessor.components, e.normalized = accessor.normalized;
  const std::uint32_t size = accessor.element_bytes();
  if (accessor.view != kNoId) {
    const GltfView& view = file_.model().views[accessor.view];
    const std::uint32_t given = view.packing ? view.packing->stride : view.stride;
    e.stride = given != 0 ? given : size;
    if (e.stride < size)
      file_.fail(e.name + ": elements of " + std::to_string(size) + " bytes, but a stride of " +
                 std::to_string(e.stride));
    e.data = elements_in(accessor.view, accessor.offset, e.count, size, e.stride, e.name).data();
  } else if (e.count > kMostZeros) {
    file_.fail(e.name + ": " + std::to_string(e.count) + " elements, but no view that holds them");
  }
  if (accessor.sparse) add_sparse(accessor, e);
  return e;
}

std::vector<float> GltfAccessors::numbers(std::uint32_t accessor, std::uint32_t components) {
  const GltfElements e = elements(accessor);
  spend(sizeof(float) * std::uint64_t{components} * e.count);
  return read_gltf_numbers(file_, e, components);
}

void GltfAccessors::spend(std::uint64_t bytes) {
  spent_ += bytes;
  const std::uint64_t most = (std::uint64_t{64} << 20) + 256 * file_.total_bytes();
  if (spent_ > most)
    file_.fail("its meshes take more than " + std::to_string(most) + " bytes, too many for " +
               std::to_string(file_.total_bytes()) + " bytes of files");
}

void GltfAccessors::add_sparse(const GltfAccessor& accessor, GltfElements& e) {
  const GltfSparse& s = *accessor.sparse;
  const std::uint32_t size = bytes_of(s.index_number);
  if (s.index_number != GltfNumber::uint8 && s.index_number != GltfNumber::uint16 &&
      s.index_number != GltfNumber::uint32)
    file_.fail(e.name + ": the indices of sparse elements are of a type that indices cannot have");
  e.sparse_count = s.count, e.sparse_number = s.index_number;
  e.sparse_indices = elements_in(s.index_view, s.index_offset, s.count, size, size, e.name).data();
  const std::uint32_t value_size = accessor.element_bytes();
  e.sparse_values = elements_in(s.value_view, s.value_offset, s.count, value_size, value_size, e.name).data();
}

void read_gltf_vectors(const GltfFile& file, const GltfElements& e, GltfCheck check, Vec3f* out) {
  read_all<3>(file, e, check, reinterpret_cast<float*>(out));
}

void read_gltf_uvs(const GltfFile& file, const GltfElements& e, Vec2f* out) {
  read_all<2>(file, e, GltfCheck::finite, reinterpret_cast<float*>(out));
  in_parts(e.count, kPerTask, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t i = first; i < last; ++i) out[i].y = 1 - out[i].y;
  });
}

std::vector<float> read_gltf_numbers(const GltfFile& file, const GltfElements& e, std::uint32_t components) {
  std::vector<float> numbers(std::size_t{components} * e.count);
  float* const out = numbers.data();
  switch (components) {
    case 1:
      read_all<1>(file, e, GltfCheck::finite, out);
      break;
    case 3:
      read_all<3>(file, e, GltfCheck::finite, out);
      break;
    case 4:
      read_all<4>(file, e, GltfCheck::finite, out);
      break;
    default:
      read_all<16>(file, e, GltfCheck::finite, out);
  }
  return numbers;
}

void read_gltf_tangents(const GltfFile& file, const GltfElements& e, std::array<float, 4>* out) {
  read_all<4>(file, e, GltfCheck::finite, reinterpret_cast<float*>(out));
}

void read_gltf_values(const GltfFile& file, const GltfElements& e, bool parts, float* out) {
  const std::uint64_t size = e.components;
  const auto read = [&](std::uint64_t index, const char* from) {
    with_number(e.number, [&]<class T>() {
      for (std::uint64_t k = 0; k < size; ++k)
        out[size * index + k] = as_float(load<T>(from + k * sizeof(T)), e.normalized || parts);
    });
  };
  in_parts(e.count, kPerTask, [&](std::uint64_t first, std::uint64_t last) {
    if (e.data == nullptr)
      std::fill(out + size * first, out + size * last, 0.0f);
    else
      for (std::uint64_t i = first; i < last; ++i) read(i, e.data + std::uint64_t{e.stride} * i);
  });
  for_each_sparse(file, e, read);
}

void read_gltf_indices(const GltfFile& file, const GltfElements& e, std::uint64_t limit, std::uint32_t* out) {
  const bool is_whole =
      e.number == GltfNumber::uint8 || e.number == GltfNumber::uint16 || e.number == GltfNumber::uint32;
  if (!is_whole || e.components != 1) fail(file, e, "expected whole numbers, the indices of vertices");
  std::atomic<bool> good = true;
  in_parts(e.count, kPerTask, [&](std::uint64_t first, std::uint64_t last) {
    if (e.data == nullptr)
      std::fill(out + first, out + last, 0u);
    else if (e.number == GltfNumber::uint32 && e.stride == 4)
      std::memcpy(out + first, e.data + 4 * first, 4 * (last - first));
    else
      for (std::uint64_t i = first; i < last; ++i)
        out[i] = static_cast<std::uint32_t>(whole_at(e.data + std::uint64_t{e.stride} * i, e.number));
    std::uint32_t greatest = 0;
    for (std::uint64_t i = first; i < last; ++i) greatest = std::max(greatest, out[i]);
    if (greatest >= limit) good = false;
  });
  for_each_sparse(file, e, [&](std::uint64_t index, const char* value) {
    out[index] = static_cast<std::uint32_t>(whole_at(value, e.number));
    if (out[index] >= limit) good = false;
  });
  if (good) return;
  for (std::uint64_t i = 0; i < e.count; ++i)
    if (out[i] >= limit)
      fail(file, e,
           "element " + std::to_string(i) + ": vertex index " + std::to_string(out[i]) +
               " is out of range: there are " + std::to_string(limit) + " vertices");
}

}  // namespace oktett
