#pragma once
/// \file The header of a film file: all but the sums.

#include <cstdint>
#include <string>
#include <string_view>

#include "io/film/film_file.h"

namespace oktett {

/// The header of a file with the sums of `tiles` tiles.
std::string film_header(const FilmFile& file, std::uint32_t tiles);

/// Fills in what film_header wrote and begins the film; the number of tiles. Throws Error for a header that
/// cannot be.
std::uint32_t parse_film_header(std::string_view bytes, FilmFile& file);

}  // namespace oktett
