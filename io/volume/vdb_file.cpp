#include "io/volume/vdb_file.h"

#include <fmt/format.h>

#include <utility>

#include "io/library/loaded_library.h"
#include "io/text/files.h"

namespace oktett {

bool is_vdb_file(const std::string& path) { return lower_case_extension(path) == ".vdb"; }

#ifdef OKTETT_VOLUME_LIBRARY

namespace {

constexpr LoadedLibrary kVolumes{OKTETT_VOLUME_LIBRARY, kVolumeLibraryEntry, "reads OpenVDB files",
                                 std::size_t{256} << 20};

const VolumeLibrary& volume_library() {
  static const VolumeLibrary* const library = reinterpret_cast<VolumeLibraryEntry>(load_library(kVolumes))();
  return *library;
}

}  // namespace

bool can_read_vdb() { return true; }

PlacedDensities read_vdb(const std::string& path, const std::string& name, std::vector<Warning>& warnings) {
  note_file_read(path);
  if (const std::string why = why_unreadable(path); !why.empty())
    throw Error(Location{path}, why, ErrorKind::io);
  VdbDensities read = volume_library().read(path, path_to_open(path), name);
  if (read.negative > 0)
    warnings.push_back(
        {Location{path}, read.negative == 1
                             ? std::string("a density is below 0 and counts as 0")
                             : std::to_string(read.negative) + " densities are below 0 and count as 0"});
  if (read.background > 0)
    warnings.push_back(
        {Location{path}, fmt::format("the grid states a density of {:g} for all places without "
                                     "a voxel; beyond its voxels it counts as 0",
                                     read.background)});
  return {
      std::make_shared<const DensityGrid>(read.size[0], read.size[1], read.size[2], std::move(read.values)),
      read.place};
}

#else

bool can_read_vdb() { return false; }

PlacedDensities read_vdb(const std::string& path, const std::string&, std::vector<Warning>&) {
  throw Error(Location{path}, "is an OpenVDB file, and this program is built without OpenVDB");
}

#endif

}  // namespace oktett
