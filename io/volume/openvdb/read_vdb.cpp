/// \file Reads densities with OpenVDB. The shared library liboktett_volumes.

#include <fmt/format.h>
// Statics of its templates must be those of OpenVDB's own library, also where all else is hidden.
#pragma GCC visibility push(default)
#include <openvdb/Grid.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#pragma GCC visibility pop

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/volume/vdb_file.h"

namespace oktett {
namespace {

constexpr float kMostDensity = 1e9f;
/// Beyond it, indices of voxels are not computed with.
constexpr std::int64_t kMostIndex = std::int64_t{1} << 30;

/// A name of a file for a message: OpenVDB gives any bytes.
std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : name.substr(0, 40)) text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return text + (name.size() > 40 ? "...'" : "'");
}

class VdbReading {
 public:
  VdbReading(const std::string& path, const std::string& opened) : path_(path), file_(opened) {
    file_.open(/*delayLoad=*/false);
    for (auto it = file_.beginName(); it != file_.endName(); ++it) names_.push_back(it.gridName());
  }

  VdbDensities run(const std::string& wanted) {
    const std::string name = choose(wanted);
    const openvdb::GridBase::Ptr grid = file_.readGrid(name);
    if (is_level_set(*grid))
      fail("the grid " + quoted(name) + " is a level set (distances from a surface); expected densities" +
           others());
    if (!grid->transform().isLinear())
      fail("the grid " + quoted(name) + " is a frustum; expected a grid with an affine transform" + others());
    if (const auto floats = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid)) return dense(name, *floats);
    if (const auto doubles = openvdb::gridConstPtrCast<openvdb::DoubleGrid>(grid))
      return dense(name, *doubles);
    fail("the grid " + quoted(name) + " is of type " + grid->valueType() + "; expected float" + others());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw Error(Location{path_}, message); }

  static bool is_scalar(const openvdb::GridBase& grid) {
    return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>();
  }

  static bool is_level_set(const openvdb::GridBase& grid) {
    return grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  }

  /// The grids of the file for a message: "the file has 'density' (float), 'surface' (float, level set)".
  std::string has() {
    std::string all;
    for (const std::string& name : names_) {
      const openvdb::GridBase::ConstPtr grid = file_.readGridMetadata(name);
      if (all.size() < 400)
        all += (all.empty() ? "" : ", ") + quoted(name) + " (" + grid->valueType() +
               (is_level_set(*grid) ? ", level set)" : ")");
    }
    return all.empty() ? "the file has none" : "the file has " + all;
  }

  /// The same after what is wrong with one of several grids.
  std::string others() { return names_.size() > 1 ? "; " + has() : std::string(); }

  /// The name of the grid to read.
  std::string choose(const std::string& wanted) {
    const std::string first = wanted.empty() ? "density" : wanted;
    if (std::find(names_.begin(), names_.end(), first) != names_.end()) return first;
    // OpenVDB numbers grids that have one name.
    if (std::find(names_.begin(), names_.end(), first + "[0]") != names_.end())
      fail("several grids are called " + quoted(first) + "; expected 'grid_name' with a number: " + has());
    if (!wanted.empty()) fail("no grid " + quoted(wanted) + "; " + has());
    std::vector<std::string> densities, level_sets;
    for (const std::string& name : names_) {
      const openvdb::GridBase::ConstPtr grid = file_.readGridMetadata(name);
      if (is_scalar(*grid)) (is_level_set(*grid) ? level_sets : densities).push_back(name);
    }
    if (densities.empty()) densities.swap(level_sets);
    if (densities.empty()) fail("expected a grid of floats; " + has());
    if (densities.size() > 1)
      fail("no grid is called 'density', and several hold floats; expected 'grid_name': " + has());
    return densities[0];
  }

  template <class Grid>
  VdbDensities dense(const std::string& name, const Grid& grid) const {
    VdbDensities out;
    openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const bool is_empty = box.empty();
    if (is_empty) box = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(0));
    std::uint64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t first = box.min()[axis], last = box.max()[axis];
      if (first < -kMostIndex || last > kMostIndex)
        fail("the grid " + quoted(name) + " has voxels at indices beyond 2^30");
      const auto side = static_cast<std::uint64_t>(last - first + 3);
      count *= side;
      if (side > kMostDensitySide || count > kMostDensities)
        fail(fmt::format(
            "the grid {} fills {} x {} x {} voxels; expected at most {} along an edge and {} in all",
            quoted(name), box.dim()[0], box.dim()[1], box.dim()[2], kMostDensitySide - 2, kMostDensities));
      out.size[axis] = static_cast<std::uint32_t>(side);
    }
    box.expand(1);
    out.values.resize_uninitialized(count);
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> values(box, out.values.data());
    if (is_empty)
      values.fill(0);
    else
      openvdb::tools::copyToDense(grid, values);
    check(name, out);
    out.background = static_cast<float>(grid.background());
    out.place = place_of(grid.transform(), box, out.size);
    return out;
  }

  void check(const std::string& name, VdbDensities& out) const {
    for (std::size_t i = 0; i < out.values.size(); ++i) {
      float& value = out.values[i];
      if (!(std::abs(value) <= kMostDensity))
        fail(fmt::format("a value of the grid {} is {:g}; expected a density from 0 to {:g}", quoted(name),
                         value, kMostDensity));
      if (value >= 0) continue;
      value = 0;
      ++out.negative;
    }
  }

  /// The map from the unit cube between the centres of the outer voxels of `box` to the space of the file.
  static Affine place_of(const openvdb::math::Transform& transform, const openvdb::CoordBBox& box,
                         const std::uint32_t (&size)[3]) {
    // OpenVDB multiplies rows by matrices from the right.
    const openvdb::math::Mat4d rows = transform.baseMap()->getAffineMap()->getMat4().transpose();
    const Affine map = Affine::from_rows(rows.asPointer());
    const openvdb::Coord& lo = box.min();
    return map * Affine::translation({double(lo.x()), double(lo.y()), double(lo.z())}) *
           Affine::scaling({size[0] - 1.0, size[1] - 1.0, size[2] - 1.0});
  }

  const std::string& path_;
  openvdb::io::File file_;
  std::vector<std::string> names_;  ///< of its grids, each different
};

class OpenVdbLibrary final : public VolumeLibrary {
 public:
  OpenVdbLibrary() { openvdb::initialize(); }

  VdbDensities read(const std::string& path, const std::string& opened,
                    const std::string& name) const override {
    try {
      return VdbReading(path, opened).run(name);
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      throw Error(Location{path}, std::string("cannot be read as an OpenVDB file: ") + error.what());
    }
  }
};

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) const oktett::VolumeLibrary* oktett_volume_library();
const oktett::VolumeLibrary* oktett_volume_library() {
  static const oktett::OpenVdbLibrary library;
  return &library;
}
