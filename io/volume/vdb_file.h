#pragma once
/// \file Densities in OpenVDB files. Within io/ only.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/soa.h"
#include "core/transform.h"
#include "render/medium/density_grid.h"

namespace oktett {

/// Whether the name of a file is that of an OpenVDB file: it ends in .vdb, in upper or lower case.
bool is_vdb_file(const std::string& path);

/// Whether this build reads such files.
bool can_read_vdb();

/// Densities and where they are.
struct PlacedDensities {
  std::shared_ptr<const DensityGrid> grid;
  Affine place;  ///< maps the unit cube, which the grid fills, to the space of the file
};

/// Reads the grid of floats `name` of an OpenVDB file; for an empty name the one called `density`, else the
/// only one that is no level set. The box of the active voxels is read, and one voxel more on each side, so
/// that between all of them the densities are those that OpenVDB's BoxSampler gives. The place of a grid may
/// be singular. Throws Error of kind io if the file cannot be read, and Error for what is no grid of
/// densities or too large; adds warnings for densities below 0 and for those beyond the box, which count as
/// 0.
PlacedDensities read_vdb(const std::string& path, const std::string& name, std::vector<Warning>& warnings);

// ---- The shared library that knows OpenVDB, liboktett_volumes. It takes 50 ms to start, so it is loaded
// with the first such file.

/// A grid as it is in a file.
struct VdbDensities {
  std::uint32_t size[3] = {2, 2, 2};
  Column<float> values;      ///< x fastest, then y, then z
  Affine place;              ///< maps the unit cube, which they fill, to the space of the file
  std::size_t negative = 0;  ///< how many values are below 0
  float background = 0;      ///< what the file states for all places without a voxel
};

class VolumeLibrary {
 public:
  /// Reads the file `opened`; messages call it `path`. See read_vdb.
  virtual VdbDensities read(const std::string& path, const std::string& opened,
                            const std::string& name) const = 0;

 protected:
  ~VolumeLibrary() = default;
};

/// What the library shows, by its name for dlsym.
inline constexpr const char* kVolumeLibraryEntry = "oktett_volume_library";
using VolumeLibraryEntry = const VolumeLibrary* (*)();

}  // namespace oktett
