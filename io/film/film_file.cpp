#include "io/film/film_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/bytes.h"
#include "core/error.h"
#include "io/image/output.h"
#include "io/text/file_content.h"
#include "io/text/files.h"
#include "render/light_groups.h"

namespace oktett {

// ---- The header of a film file: all but the sums.

namespace {

/// Beside the kind of the tone curve.
constexpr unsigned kHasGamma = 128;
constexpr unsigned kDataLayers = 1, kSampleCounts = 2, kMattes = 4, kMoves = 8, kCamera = 16, kHasOrigin = 32,
                   kCatchers = 64;

void append_pairs(std::string& bytes, const FilmFingerprint::Entries& pairs) {
  append_number(bytes, static_cast<std::uint32_t>(pairs.size()));
  for (const auto& [name, value] : pairs) append_text(bytes, name), append_text(bytes, value);
}

FilmFingerprint::Entries take_pairs(ByteReader& reader) {
  FilmFingerprint::Entries pairs;
  for (std::uint32_t left = reader.count(8); left > 0; --left) {
    std::string name = reader.text();
    pairs.emplace_back(std::move(name), reader.text());
  }
  return pairs;
}

void append_texts(std::string& bytes, const std::vector<std::string>& texts) {
  append_number(bytes, static_cast<std::uint32_t>(texts.size()));
  for (const std::string& text : texts) append_text(bytes, text);
}

std::vector<std::string> take_texts(ByteReader& reader) {
  std::vector<std::string> texts;
  for (std::uint32_t left = reader.count(4); left > 0; --left) texts.push_back(reader.text());
  return texts;
}

/// Planes are named after light groups, and found by the name of the first.
void check_light_groups(const FilmFormat& format) {
  const std::vector<std::string>& names = format.light_groups;
  if (names.empty()) return;
  const std::set<std::string> different(names.begin(), names.end());
  if (!format.data_layers || names.size() > kMostLightGroups || names.front() != kDefaultLightGroup ||
      different.size() != names.size() || !std::ranges::all_of(names, is_light_group_name))
    throw Error("its light groups cannot be");
}

bool has_origin(const ImageMetadata& metadata) { return !(metadata.origin == Vec3d{}); }

void append_metadata(std::string& bytes, const ImageMetadata& metadata) {
  for (const std::string* text : {&metadata.software, &metadata.command_line, &metadata.scene})
    append_text(bytes, *text);
  append_number(bytes, metadata.samples);
  append_number(bytes, metadata.render_seconds);
  if (metadata.camera)
    for (const Matrix4* matrix : {&metadata.camera->world_to_camera, &metadata.camera->world_to_ndc})
      for (const float x : *matrix) append_number(bytes, x);
  if (has_origin(metadata))
    for (int k = 0; k < 3; ++k) append_number(bytes, metadata.origin[k]);
}

ImageMetadata take_metadata(ByteReader& reader, bool camera, bool origin) {
  ImageMetadata metadata;
  for (std::string* text : {&metadata.software, &metadata.command_line, &metadata.scene})
    *text = reader.text();
  metadata.samples = reader.number<std::uint32_t>();
  metadata.render_seconds = reader.number<double>();
  if (camera) {
    metadata.camera.emplace();
    for (Matrix4* matrix : {&metadata.camera->world_to_camera, &metadata.camera->world_to_ndc})
      for (float& x : *matrix) x = reader.number<float>();
  }
  for (int k = 0; origin && k < 3; ++k) metadata.origin[k] = reader.number<double>();
  return metadata;
}

void append_window(std::string& bytes, const FilmFormat& format) {
  for (const std::uint32_t x : {format.window.x0, format.window.y0, format.window.x1, format.window.y1,
                                format.full_width, format.full_height})
    append_number(bytes, x);
}

void take_window(ByteReader& reader, FilmFormat& format) {
  for (std::uint32_t* x : {&format.window.x0, &format.window.y0, &format.window.x1, &format.window.y1,
                           &format.full_width, &format.full_height})
    *x = reader.number<std::uint32_t>();
  const PixelWindow& w = format.window;
  const bool good = w.x0 < w.x1 && w.x1 <= format.full_width && format.full_width <= kMostFilmSide &&
                    w.y0 < w.y1 && w.y1 <= format.full_height && format.full_height <= kMostFilmSide;
  if (!good || std::uint64_t{format.full_width} * format.full_height > kMostFilmPixels)
    throw Error("its picture has a size that cannot be");
}

Tone take_tone(ByteReader& reader) {
  const auto first = reader.number<std::uint8_t>();
  const unsigned kind = first & ~kHasGamma;
  const auto exposure = reader.number<double>();
  const double gamma = (first & kHasGamma) != 0 ? reader.number<double>() : 1;
  if (!(gamma >= kGammas.lo && gamma <= kGammas.hi)) throw Error("its gamma is unknown");
  if (kind >= std::size(kToneKinds) || !std::isfinite(exposure) || !kExposures.contains(exposure))
    throw Error("its tone curve is unknown");
  return {static_cast<ToneKind>(kind), exposure, gamma};
}

}  // namespace

/// The header of a file with the sums of `tiles` tiles.
static std::string film_header(const FilmFile& file, std::uint32_t tiles) {
  const FilmState& film = *file.film;
  const FilmPlan& plan = film.plan();
  std::string bytes;
  const unsigned flags = (plan.format.data_layers ? kDataLayers : 0u) |
                         (plan.format.sample_counts ? kSampleCounts : 0u) |
                         (plan.format.mattes ? kMattes : 0u) | (plan.moves ? kMoves : 0u) |
                         (plan.format.catchers ? kCatchers : 0u) | (file.metadata.camera ? kCamera : 0u) |
                         (has_origin(file.metadata) ? kHasOrigin : 0u);
  append_number(bytes, static_cast<std::uint8_t>(flags));
  append_window(bytes, plan.format);
  const Tone tone = film.tone();
  const bool has_gamma = tone.gamma != 1;
  append_number(bytes,
                static_cast<std::uint8_t>(static_cast<unsigned>(tone.kind) | (has_gamma ? kHasGamma : 0u)));
  append_number(bytes, tone.exposure);
  if (has_gamma) append_number(bytes, tone.gamma);
  for (const std::uint32_t x : {plan.samples, film.added(), film.share().number, film.share().count, tiles})
    append_number(bytes, x);
  append_texts(bytes, plan.format.light_groups);
  append_pairs(bytes, plan.attributes);
  append_metadata(bytes, file.metadata);
  append_pairs(bytes, file.fingerprint.settings);
  append_pairs(bytes, file.fingerprint.files);
  append_texts(bytes, file.words);
  return bytes;
}

/// Fills in what film_header wrote and begins the film; the number of tiles. Throws Error for a header that
/// cannot be.
static std::uint32_t parse_film_header(std::string_view bytes, FilmFile& file) {
  ByteReader reader(bytes);
  FilmPlan plan;
  const unsigned flags = reader.number<std::uint8_t>();
  plan.format.data_layers = (flags & kDataLayers) != 0;
  plan.format.sample_counts = (flags & kSampleCounts) != 0, plan.format.mattes = (flags & kMattes) != 0;
  plan.moves = (flags & kMoves) != 0, plan.format.catchers = (flags & kCatchers) != 0;
  if (!plan.format.data_layers && (plan.format.sample_counts || plan.format.mattes))
    throw Error("its layers cannot be");
  take_window(reader, plan.format);
  const Tone tone = take_tone(reader);
  plan.samples = reader.number<std::uint32_t>();
  const auto added = reader.number<std::uint32_t>(), number = reader.number<std::uint32_t>(),
             count = reader.number<std::uint32_t>(), tiles = reader.number<std::uint32_t>();
  if (plan.samples < 1 || plan.samples > kMostSamples || added > kMostAddedSamples)
    throw Error("its number of samples cannot be");
  if (number < 1 || number > count || count > FilmShare::kMost) throw Error("its share cannot be");
  plan.format.light_groups = take_texts(reader);
  check_light_groups(plan.format);
  plan.attributes = take_pairs(reader);
  file.metadata = take_metadata(reader, (flags & kCamera) != 0, (flags & kHasOrigin) != 0);
  file.fingerprint.settings = take_pairs(reader);
  file.fingerprint.files = take_pairs(reader);
  file.words = take_texts(reader);
  if (reader.left() != 0) throw Error("the header has not the length that it says");
  file.film = std::make_shared<FilmState>(FilmShare{number, count}, added);
  file.film->begin(plan, tone);
  return tiles;
}

namespace {

/// Begins every file; the number is the version of the format.
constexpr std::string_view kFilmMagic = "oktett film 2\n";
/// The number of a tile, its added samples, the length of its sums.
constexpr std::size_t kRecordHeader = 4 + 4 + 8;

std::string record_bytes(std::size_t number, const TileRecord& record) {
  std::string bytes;
  append_number(bytes, static_cast<std::uint32_t>(number));
  append_number(bytes, record.added);
  append_number(bytes, std::uint64_t{record.bytes.size()});
  return bytes;
}

std::uint64_t record_checksum(std::string_view header, std::string_view sums) {
  return checksum(header) ^ checksum(sums);
}

/// Reads the records of the tiles, which stand in the order of their numbers.
void read_records(ByteReader& reader, std::uint32_t count, FilmState& film) {
  std::size_t least = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string_view header = reader.take(kRecordHeader);
    ByteReader numbers(header);
    const auto number = numbers.number<std::uint32_t>(), added = numbers.number<std::uint32_t>();
    const std::string_view sums = reader.take(numbers.number<std::uint64_t>());
    if (reader.number<std::uint64_t>() != record_checksum(header, sums))
      throw Error("the checksum of a tile is wrong: the file is damaged");
    if (number < least || number >= film.tile_count() || !film.in_share(number) || added > film.added())
      throw Error("it has a tile that cannot be there");
    least = number + std::size_t{1};
    film.set_record(number, {added, std::string(sums)});
  }
  if (reader.left() != 0) throw Error("the file has not the length that it says");
}

const std::string* find(const FilmFingerprint::Entries& entries, const std::string& name) {
  for (const auto& [other, value] : entries)
    if (other == name) return &value;
  return nullptr;
}

}  // namespace

std::string difference(const FilmFingerprint& film, const FilmFingerprint& now) {
  for (const auto& [name, value] : now.settings) {
    const std::string* before = find(film.settings, name);
    if (before == nullptr || *before != value)
      return fmt::format("{} is {} there and {} here", name, before == nullptr ? "not set" : *before, value);
  }
  for (const auto& [name, value] : film.settings)
    if (find(now.settings, name) == nullptr)
      return fmt::format("{} is {} there and not set here", name, value);
  for (const auto& [name, hash] : now.files) {
    const std::string* before = find(film.files, name);
    if (before == nullptr) return fmt::format("the file '{}' is read here and not there", name);
    if (*before != hash) return fmt::format("the file '{}' has another content", name);
  }
  for (const auto& entry : film.files)
    if (find(now.files, entry.first) == nullptr)
      return fmt::format("the file '{}' is read there and not here", entry.first);
  return "";
}

/// What a scene can do without has a hash, too, while it is missing.
static std::string hash_of_file(const std::string& path) {
  if (const auto known = known_content(path)) return fmt::format("{:016x}", *known);
  try {
    const MappedFile file(path);
    return fmt::format("{:016x}", checksum(file.text()));
  } catch (const Error&) {
    return "missing";
  }
}

FilmFingerprint::Entries hash_files(const std::vector<std::string>& paths, const std::string& folder) {
  FilmFingerprint::Entries entries;
  const auto absolute = [](const std::string& path) {
    return std::filesystem::absolute(path.empty() ? "." : path).lexically_normal();
  };
  const std::filesystem::path base = absolute(folder);
  for (const std::string& path : paths)
    entries.emplace_back(absolute(path).lexically_relative(base).generic_string(), hash_of_file(path));
  return entries;
}

void write_film(const std::string& path, const FilmFile& file) {
  OutputFile output(path);
  const auto records = file.film->records();
  const std::string header = film_header(file, static_cast<std::uint32_t>(records.size()));
  std::string start(kFilmMagic);
  append_number(start, std::uint64_t{header.size()});
  start += header;
  append_number(start, checksum(header));
  output.write(start);
  for (const auto& [number, record] : records) {
    std::string bytes = record_bytes(number, *record);
    output.write(bytes);
    output.write(record->bytes);
    const std::uint64_t hash = record_checksum(bytes, record->bytes);
    bytes.clear();
    append_number(bytes, hash);
    output.write(bytes);
  }
  output.commit();
}

FilmFile parse_film(std::string_view bytes) {
  if (!bytes.starts_with(kFilmMagic)) throw Error("is not a film of version 2");
  ByteReader reader(bytes.substr(kFilmMagic.size()));
  const std::string_view header = reader.take(reader.number<std::uint64_t>());
  if (reader.number<std::uint64_t>() != checksum(header))
    throw Error("the checksum of the header is wrong: the file is damaged");
  FilmFile file;
  const std::uint32_t tiles = parse_film_header(header, file);
  read_records(reader, tiles, *file.film);
  return file;
}

FilmFile read_film(const std::string& path) {
  const MappedFile file(path);
  try {
    return parse_film(file.text());
  } catch (const Error& error) {
    throw Error(Location{path}, error.what(), error.kind());
  }
}

}  // namespace oktett
