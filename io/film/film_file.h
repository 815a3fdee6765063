#pragma once
/// \file Pictures in progress as files: checkpoints, and shares of a picture.
///
/// A file is a line with the version of the format, a header with its length and checksum, and the sums of
/// each finished tile with theirs; all numbers are little-endian. Files are not trusted: lengths and counts
/// are compared with what is left of the file before memory is asked for.

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/image/metadata.h"
#include "render/film/film_state.h"

namespace oktett {

/// What the bits of a picture depend on, each with a name: settings and files.
struct FilmFingerprint {
  using Entries = std::vector<std::pair<std::string, std::string>>;
  Entries settings;  ///< name and value
  Entries files;     ///< path, relative to the folder of the scene, and hash of the content
};

/// What differs between a film, "there", and a scene or another film, "here", as one phrase; empty if nothing
/// does.
std::string difference(const FilmFingerprint& film, const FilmFingerprint& now);

/// Names and hashes of files, see FilmFingerprint::files.
FilmFingerprint::Entries hash_files(const std::vector<std::string>& paths, const std::string& folder);

/// A picture in progress and where it comes from.
struct FilmFile {
  FilmFingerprint fingerprint;
  std::vector<std::string> words;  ///< of the command line that began it
  ImageMetadata metadata;          ///< of the picture; render_seconds: so far
  std::shared_ptr<FilmState> film;
};

/// Writes the file under another name, flushes it to the disk and renames it. Throws Error of kind io; then
/// what was at `path` is still there. `file.film` has begun; other threads may use it meanwhile.
void write_film(const std::string& path, const FilmFile& file);

/// Reads what write_film wrote. Throws Error if the file cannot be read, is none of this version, is damaged
/// or says what cannot be.
FilmFile read_film(const std::string& path);
/// The same of the bytes of a file.
FilmFile parse_film(std::string_view bytes);

}  // namespace oktett
