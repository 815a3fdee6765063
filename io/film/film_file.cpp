#include "io/film/film_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/bytes.h"
#include "core/error.h"
#include "io/film/film_header.h"
#include "io/image/output.h"
#include "io/text/files_read.h"
#include "io/text/mapped_file.h"

namespace oktett {
namespace {

/// Begins every file; the number is the version of the format.
constexpr std::string_view kFilmMagic = "oktett film 1\n";
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
  if (!bytes.starts_with(kFilmMagic)) throw Error("is not a film of version 1");
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
