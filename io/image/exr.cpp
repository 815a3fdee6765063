#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <ctime>
#include <map>
#include <new>
#include <string>

#include "core/error.h"
#include "io/image/writers.h"

namespace oktett {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are stored as they stand in memory");

constexpr float kLargestHalf = 65504;
constexpr std::uint32_t kBlockRows = 16;
/// Level 2 takes half the time of zlib's default and makes files that are a few percent larger.
constexpr int kLevel = 2;

using Planes = std::vector<const PicturePlane*>;

template <class T>
std::string bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// The nearest half, of two equally near ones the even one. NaN keeps the upper bits of its payload.
std::uint16_t to_half(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -kLargestHalf, kLargestHalf);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = bits >> 16 & 0x8000, magnitude = bits & 0x7fffffff;
  std::uint32_t half;
  if (magnitude > 0x7f800000) {
    const std::uint32_t payload = magnitude >> 13 & 0x3ff;
    half = 0x7c00 | payload | (payload == 0 ? 1 : 0);
  } else if (magnitude == 0x7f800000) {
    half = 0x7c00;
  } else if (magnitude < 0x38800000) {
    // Below 2^-14 halves are 2^-24 apart, as floats from 1/2 to 1 are; the sum is rounded to one of these.
    half = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) + 0.5f) - 0x3f000000;
  } else {
    // The exponent's bias goes from 127 to 15, and half a unit of the last place that stays rounds.
    half = (magnitude - (112u << 23) + 0xfff + (magnitude >> 13 & 1)) >> 13;
  }
  return static_cast<std::uint16_t>(sign | half);
}

/// The planes in the order of their names, which is that of files.
Planes sorted_planes(const Picture& picture) {
  Planes planes;
  for (const PicturePlane& plane : picture.planes) planes.push_back(&plane);
  std::sort(planes.begin(), planes.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string& name = planes[i]->name;
    if (name.empty() || name.size() > 255 || name.find('\0') != std::string::npos)
      throw Error("a plane's name must have 1 to 255 characters");
    if (i > 0 && name == planes[i - 1]->name) throw Error("the picture has two planes named " + name);
  }
  return planes;
}

std::string channel_list(const Planes& planes) {
  std::string list;
  for (const PicturePlane* plane : planes) {
    const std::int32_t type = plane->type == PlaneType::unsigned_int ? 0
                              : plane->type == PlaneType::half_float ? 1
                                                                     : 2;
    // Perceptually linear or not, three reserved bytes, one sample per pixel in x and y.
    list += plane->name + '\0' + bytes_of(type) + bytes_of(std::array<std::int32_t, 3>{0, 1, 1});
  }
  return list + '\0';
}

/// The local time in the form of OpenEXR's standard attribute.
std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &local)};
}

/// The corners (x, y) and (x + width - 1, y + height - 1).
std::string box(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) {
  return bytes_of(std::array<std::uint32_t, 4>{x, y, x + width - 1, y + height - 1});
}

std::string header(const Picture& picture, const Planes& planes, const std::vector<Attribute>& attributes) {
  const bool framed = picture.full_width > 0 && picture.full_height > 0;
  struct Field {
    std::string type, bytes;
  };
  std::map<std::string, Field> fields{
      {"capDate", {"string", date()}},
      {"channels", {"chlist", channel_list(planes)}},
      {"compression", {"compression", std::string(1, 3)}},
      {"dataWindow", {"box2i", box(picture.x, picture.y, picture.width, picture.height)}},
      {"displayWindow",
       {"box2i", box(0, 0, framed ? picture.full_width : picture.width,
                     framed ? picture.full_height : picture.height)}},
      {"lineOrder", {"lineOrder", std::string(1, 0)}},
      {"pixelAspectRatio", {"float", bytes_of(1.0f)}},
      {"screenWindowCenter", {"v2f", bytes_of(std::array<float, 2>{})}},
      {"screenWindowWidth", {"float", bytes_of(1.0f)}}};
  const char* const types[] = {"string", "int", "float", "m44f"};
  for (const Attribute& attribute : attributes) {
    const auto* text = std::get_if<std::string>(&attribute.value);
    fields[attribute.name] = {
        types[attribute.value.index()],
        text != nullptr ? *text : std::visit([](const auto& v) { return bytes_of(v); }, attribute.value)};
  }
  const bool long_names =
      std::any_of(planes.begin(), planes.end(), [](const auto* p) { return p->name.size() > 31; });
  std::string bytes = bytes_of(std::array<std::uint32_t, 2>{20000630, long_names ? 0x402u : 2u});
  for (const auto& [name, field] : fields)
    bytes += name + '\0' + field.type + '\0' + bytes_of(static_cast<std::int32_t>(field.bytes.size())) +
             field.bytes;
  return bytes + '\0';
}

/// Appends a row of a plane in the type that the file has.
void append_row(const PicturePlane& plane, std::size_t first, std::size_t count, std::string& out) {
  const auto append = [&](const auto* numbers) {
    out.append(reinterpret_cast<const char*>(numbers), count * sizeof *numbers);
  };
  if (plane.type == PlaneType::unsigned_int) return append(&plane.ids[first]);
  if (plane.type == PlaneType::single_float) return append(&plane.values[first]);
  std::vector<std::uint16_t> halves(count);
  for (std::size_t i = 0; i < count; ++i) halves[i] = to_half(plane.values[first + i]);
  append(halves.data());
}

/// The bytes of even places before those of odd places, each less the one before it.
std::string predicted(const std::string& data) {
  std::string bytes(data.size(), '\0');
  const std::size_t odd_begin = (data.size() + 1) / 2;
  for (std::size_t i = 0; i < data.size(); ++i) bytes[(i % 2) * odd_begin + i / 2] = data[i];
  for (std::size_t i = data.size(); i-- > 1;) bytes[i] = static_cast<char>(bytes[i] - bytes[i - 1] + 128);
  return bytes;
}

/// Up to kBlockRows rows behind their place and size; as they are if compression does not help.
std::string block(const Picture& picture, const Planes& planes, std::uint32_t first_row) {
  const std::uint32_t last_row = std::min(first_row + kBlockRows, picture.height);
  std::string rows;
  for (std::uint32_t row = first_row; row < last_row; ++row)
    for (const PicturePlane* plane : planes)
      append_row(*plane, std::size_t{row} * picture.width, picture.width, rows);
  if (rows.size() > 0x7fffffff) throw Error("the rows of the picture are too long for an EXR file");
  const std::string bytes = predicted(rows);
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), kLevel) != Z_OK)
    throw std::bad_alloc();
  packed.resize(size);
  const std::string& stored = size < rows.size() ? packed : rows;
  return bytes_of(picture.y + first_row) + bytes_of(static_cast<std::int32_t>(stored.size())) + stored;
}

}  // namespace

void write_exr(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes) {
  const Planes planes = sorted_planes(picture);
  const std::size_t blocks = (std::size_t{picture.height} + kBlockRows - 1) / kBlockRows;
  file.append(header(picture, planes, attributes));
  std::vector<std::uint64_t> places(blocks);
  const auto table = [&] {
    return std::string_view(reinterpret_cast<const char*>(places.data()), blocks * sizeof places[0]);
  };
  const std::uint64_t table_place = file.append(table());
  places = file.append_blocks(blocks, [&](std::size_t i) {
    return block(picture, planes, static_cast<std::uint32_t>(i) * kBlockRows);
  });
  file.overwrite(table_place, table());
}

}  // namespace oktett
