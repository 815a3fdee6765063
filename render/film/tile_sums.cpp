#include "render/film/tile_sums.h"

#include <cstddef>
#include <cstring>

#include "core/bytes.h"
#include "core/error.h"
#include "render/film/light_layers.h"

namespace oktett {
namespace {

/// A number of a PixelSum.
struct Field {
  std::size_t offset, size;
  bool layers;  ///< only pictures with data layers have it
};

#define OKTETT_FIELD(member, layers) \
  Field { offsetof(PixelSum, member), sizeof(PixelSum::member), layers }
/// All members; arrays are kept number by number.
constexpr Field kMembers[] = {
    OKTETT_FIELD(color, false),    OKTETT_FIELD(alpha, false),  OKTETT_FIELD(good, false),
    OKTETT_FIELD(square, true),    OKTETT_FIELD(depth, true),   OKTETT_FIELD(normal, true),
    OKTETT_FIELD(position, true),  OKTETT_FIELD(albedo, true),  OKTETT_FIELD(uv, true),
    OKTETT_FIELD(hits, true),      OKTETT_FIELD(nearest, true), OKTETT_FIELD(has_ids, true),
    OKTETT_FIELD(primitive, true), OKTETT_FIELD(object, true),
};
#undef OKTETT_FIELD
static_assert(sizeof(PixelSum) == 176, "a new member of PixelSum stands in kMembers, too");

/// Calls `use(offset, size)` for each number of a PixelSum that pictures of this format have.
template <class Use>
void for_each_number(const FilmFormat& format, const Use& use) {
  for (const Field& field : kMembers) {
    if (field.layers && !format.data_layers) continue;
    const std::size_t size = field.size > sizeof(double) ? sizeof(double) : field.size;
    for (std::size_t at = 0; at < field.size; at += size) use(field.offset + at, size);
  }
}

constexpr char kSame = 0, kDifferent = 1;

/// One number of each of `count` structures `stride` bytes apart.
void encode_column(const char* first, std::size_t count, std::size_t stride, std::size_t size,
                   std::string& bytes) {
  bool same = true;
  for (std::size_t i = 1; i < count && same; ++i) same = std::memcmp(first, first + i * stride, size) == 0;
  bytes += same ? kSame : kDifferent;
  for (std::size_t i = 0; i < (same ? 1 : count); ++i) bytes.append(first + i * stride, size);
}

void decode_column(ByteReader& reader, char* first, std::size_t count, std::size_t stride, std::size_t size) {
  const char kind = reader.take(1)[0];
  if (kind != kSame && kind != kDifferent) throw Error("a tile has a column of an unknown kind");
  const std::string_view values = reader.take(kind == kSame ? size : size * count);
  // The only numbers of one byte are truth values.
  if (size == 1)
    for (const char c : values)
      if (c != 0 && c != 1) throw Error("a tile has numbers that none can have");
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(first + i * stride, values.data() + (kind == kSame ? 0 : i * size), size);
}

void encode_mattes(const std::vector<MatteSums>& mattes, std::string& bytes) {
  for (const MatteSums& matte : mattes) {
    append_number(bytes, static_cast<std::uint32_t>(matte.entries().size()));
    for (const MatteSums::Entry& entry : matte.entries())
      append_number(bytes, entry.id), append_number(bytes, entry.count);
  }
}

std::vector<MatteSums> decode_mattes(ByteReader& reader, std::size_t pixels) {
  std::vector<MatteSums> mattes(pixels);
  for (MatteSums& matte : mattes)
    for (std::uint32_t left = reader.count(8); left > 0; --left) {
      const auto id = reader.number<float>();
      matte.append(id, reader.number<std::uint32_t>());
    }
  return mattes;
}

/// Sums are divided by counts, and counts number the samples that are added.
void check_counts(const TileSums& sums) {
  constexpr std::uint32_t kMost = kMostSamples + kMostAddedSamples;
  for (std::size_t i = 0; i < sums.pixels.size(); ++i)
    if (sums.samples[i] > kMost || sums.pixels[i].good > sums.samples[i] ||
        sums.pixels[i].hits > sums.pixels[i].good)
      throw Error("a tile has counts that none can have");
}

char* bytes_of(void* numbers) { return static_cast<char*>(numbers); }
const char* bytes_of(const void* numbers) { return static_cast<const char*>(numbers); }

}  // namespace

std::uint64_t TileSums::bad_samples() const {
  std::uint64_t bad = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) bad += samples[i] - pixels[i].good;
  return bad;
}

void write_tile(const FilmFormat& format, const FinishedTile& tile, const TileSums& sums, Picture& picture) {
  PicturePlane* counts = format.sample_counts ? picture.find(kSampleCountPlane) : nullptr;
  const std::size_t object_planes = first_matte_plane(picture, kObjectLayer);
  const std::size_t material_planes = first_matte_plane(picture, kMaterialLayer);
  const std::size_t light_planes = first_light_plane(picture), channels = 3 * format.light_groups.size();
  std::size_t i = 0;
  for (std::uint32_t y = tile.y; y < tile.y + tile.height; ++y)
    for (std::uint32_t x = tile.x; x < tile.x + tile.width; ++x, ++i) {
      const std::size_t at = std::size_t{y} * picture.width + x;
      if (format.data_layers)
        write_pixel(picture, x, y, sums.pixels[i]);
      else
        write_color(picture, x, y, sums.pixels[i]);
      if (counts != nullptr) counts->ids[at] = sums.samples[i];
      write_layers(picture, light_planes, at, {sums.grouped.data() + i * channels, channels},
                   sums.pixels[i].good);
      if (!format.mattes) continue;
      sums.objects[i].write(picture, object_planes, at, sums.pixels[i].good);
      sums.materials[i].write(picture, material_planes, at, sums.pixels[i].good);
    }
}

std::string encode_tile(const FilmFormat& format, const TileSums& sums) {
  std::string bytes;
  const std::size_t count = sums.pixels.size();
  encode_column(bytes_of(sums.samples.data()), count, sizeof(std::uint32_t), sizeof(std::uint32_t), bytes);
  for_each_number(format, [&](std::size_t offset, std::size_t size) {
    encode_column(bytes_of(sums.pixels.data()) + offset, count, sizeof(PixelSum), size, bytes);
  });
  encode_mattes(sums.objects, bytes), encode_mattes(sums.materials, bytes);
  const std::size_t channels = 3 * format.light_groups.size();
  for (std::size_t k = 0; k < channels; ++k)
    encode_column(bytes_of(sums.grouped.data() + k), count, channels * sizeof(double), sizeof(double), bytes);
  return bytes;
}

TileSums decode_tile(const FilmFormat& format, std::size_t pixels, std::string_view bytes) {
  ByteReader reader(bytes);
  TileSums sums;
  sums.pixels.resize(pixels), sums.samples.resize(pixels);
  decode_column(reader, bytes_of(sums.samples.data()), pixels, sizeof(std::uint32_t), sizeof(std::uint32_t));
  for_each_number(format, [&](std::size_t offset, std::size_t size) {
    decode_column(reader, bytes_of(sums.pixels.data()) + offset, pixels, sizeof(PixelSum), size);
  });
  if (format.mattes)
    sums.objects = decode_mattes(reader, pixels), sums.materials = decode_mattes(reader, pixels);
  const std::size_t channels = 3 * format.light_groups.size();
  if (channels > reader.left() / sizeof(double)) throw Error("the file is cut short");
  sums.grouped.resize(pixels * channels);
  for (std::size_t k = 0; k < channels; ++k)
    decode_column(reader, bytes_of(sums.grouped.data() + k), pixels, channels * sizeof(double),
                  sizeof(double));
  if (reader.left() != 0) throw Error("a tile has not the length that it says");
  check_counts(sums);
  return sums;
}

}  // namespace oktett
