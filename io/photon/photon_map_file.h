#pragma once
/// \file Photon maps as files, so that further cameras need not trace the photons again.
///
/// A file is a header, the photons of each pass and a checksum, all in little-endian order. Files are not
/// trusted: each number is checked.

#include <memory>
#include <string>

namespace oktett {

struct PhotonMap;

/// Writes `map` to `path`. Throws Error of kind io.
void write_photon_map(const std::string& path, const PhotonMap& map);

/// Reads what write_photon_map wrote: the same bits. Throws Error if the file cannot be read, is none of this
/// version, is cut short, or holds numbers that no photon has.
std::shared_ptr<const PhotonMap> read_photon_map(const std::string& path);

}  // namespace oktett
