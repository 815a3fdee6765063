#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>

#include "io/image/writers.h"

namespace oktett {
namespace {

constexpr std::size_t kStripBytes = std::size_t{1} << 18;
constexpr int kLevel = 6;

const Bytef* bytes_of(const std::string& data) { return reinterpret_cast<const Bytef*>(data.data()); }

std::string big_endian(std::uint32_t number) {
  return {static_cast<char>(number >> 24), static_cast<char>(number >> 16), static_cast<char>(number >> 8),
          static_cast<char>(number)};
}

std::string chunk(const char* type, const std::string& data) {
  const std::string body = type + data;
  const uLong check = crc32_z(0, bytes_of(body), body.size());
  return big_endian(static_cast<std::uint32_t>(data.size())) + body +
         big_endian(static_cast<std::uint32_t>(check));
}

/// The neighbour among left, above and above left that is nearest to left + above - above left.
int paeth(int left, int above, int corner) {
  const int to_left = std::abs(above - corner), to_above = std::abs(left - corner);
  const int to_corner = std::abs(left + above - 2 * corner);
  if (to_left <= to_above && to_left <= to_corner) return left;
  return to_above <= to_corner ? above : corner;
}

/// Filter 0 to 4 of the specification: what `filter` expects at byte i is taken from each byte of `row`.
/// Bytes before the row are 0. Returns the sum of the magnitudes of the differences.
template <int filter>
std::size_t difference(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
                       std::size_t channels, std::uint8_t* out) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const int a = i < channels ? 0 : row[i - channels], b = above[i],
              c = i < channels ? 0 : above[i - channels];
    const int expected[] = {0, a, b, (a + b) / 2, filter == 4 ? paeth(a, b, c) : 0};
    out[i] = static_cast<std::uint8_t>(row[i] - expected[filter]);
    sum += static_cast<std::size_t>(std::abs(static_cast<std::int8_t>(out[i])));
  }
  return sum;
}
constexpr decltype(&difference<0>) kFilters[] = {difference<0>, difference<1>, difference<2>, difference<3>,
                                                 difference<4>};

/// Rows [first, last) of the picture, each behind the number of the filter that leaves the smallest bytes.
std::string filtered_rows(const Picture& picture, std::uint32_t channels, std::size_t first,
                          std::size_t last) {
  const std::size_t bytes = std::size_t{picture.width} * channels;
  std::vector<std::uint8_t> above(bytes), row(bytes), candidate(bytes), best(bytes);
  if (first > 0) encode_srgb8(picture, channels, (first - 1) * picture.width, picture.width, above.data());
  std::string rows;
  for (std::size_t y = first; y < last; ++y) {
    encode_srgb8(picture, channels, y * picture.width, picture.width, row.data());
    std::size_t least = std::numeric_limits<std::size_t>::max();
    char chosen = 0;
    for (char filter = 0; filter < 5; ++filter) {
      const std::size_t sum = kFilters[static_cast<std::size_t>(filter)](row.data(), above.data(), bytes,
                                                                         channels, candidate.data());
      if (sum >= least) continue;
      least = sum, chosen = filter;
      best.swap(candidate);
    }
    rows += chosen;
    rows.append(reinterpret_cast<const char*>(best.data()), bytes);
    row.swap(above);
  }
  return rows;
}

/// A piece of a deflate stream that does not refer to the pieces before it and ends with a whole byte.
std::string deflate_piece(const std::string& data, bool is_last) {
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  // A flush adds an empty block, of at most six bytes, to what the bound counts.
  std::string packed(deflateBound(&stream, data.size()) + 6, '\0');
  stream.next_in = const_cast<Bytef*>(bytes_of(data));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace

void write_png(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes) {
  const std::uint32_t channels = stored_channels(picture, PixelLayout::srgb8_alpha);
  const char rgb = 2, rgba = 6;
  file.append("\x89PNG\r\n\x1a\n");
  file.append(chunk("IHDR", big_endian(picture.width) + big_endian(picture.height) +
                                std::string{8, channels == 4 ? rgba : rgb, 0, 0, 0}));
  // sRGB, for readers that know only the older chunks too; the numbers are those of the specification.
  file.append(chunk("gAMA", big_endian(45455)));
  file.append(chunk("sRGB", std::string(1, 3)));
  std::string primaries;
  for (const std::uint32_t xy : {31270u, 32900u, 64000u, 33000u, 30000u, 60000u, 15000u, 6000u})
    primaries += big_endian(xy);
  file.append(chunk("cHRM", primaries));
  for (const Attribute& attribute : attributes)
    if (const auto* text = std::get_if<std::string>(&attribute.value))
      file.append(chunk("tEXt", attribute.name + '\0' + *text));

  // Strips of rows are converted and compressed by all threads. Together they are one zlib stream.
  const std::size_t row_bytes = 1 + std::size_t{picture.width} * channels;
  const std::size_t strip_rows = std::max<std::size_t>(1, kStripBytes / row_bytes);
  const std::size_t strips = (picture.height + strip_rows - 1) / strip_rows;
  std::vector<uLong> checks(strips);
  file.append(chunk("IDAT", "\x78\x9c"));
  file.append_blocks(strips, [&](std::size_t strip) {
    const std::size_t first = strip * strip_rows,
                      last = std::min(first + strip_rows, std::size_t{picture.height});
    const std::string rows = filtered_rows(picture, channels, first, last);
    checks[strip] = adler32_z(1, bytes_of(rows), rows.size());
    return chunk("IDAT", deflate_piece(rows, strip + 1 == strips));
  });
  uLong check = 1;
  for (std::size_t strip = 0; strip < strips; ++strip) {
    const std::size_t rows = std::min(strip_rows, picture.height - strip * strip_rows);
    check = adler32_combine(check, checks[strip], static_cast<z_off_t>(rows * row_bytes));
  }
  file.append(chunk("IDAT", big_endian(static_cast<std::uint32_t>(check))));
  file.append(chunk("IEND", ""));
}

}  // namespace oktett
