/// \file Densities in OpenVDB files, which OpenVDB itself writes here.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "io/volume/vdb_file.h"
#include "tests/io/scene_test_support.h"

namespace oktett::vdb_test {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;
using test::SceneFiles;

/// A grid with a name, and the transform of voxels of that size.
FloatGrid::Ptr named(const std::string& name, double voxel = 1) {
  const FloatGrid::Ptr grid = FloatGrid::create(0);
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  return grid;
}

class Vdb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }

  /// Writes the grids to a.vdb.
  void write(const openvdb::GridPtrVec& grids,
             std::uint32_t compression = openvdb::io::COMPRESS_ACTIVE_MASK |
                                         openvdb::io::COMPRESS_BLOSC) const {
    openvdb::io::File file(files.dir.file("a.vdb"));
    file.setCompression(compression);
    file.write(grids);
  }
  Medium medium(const std::string& more = "") const {
    const Scene scene = files.load_v1("media: {a: {grid: a.vdb, scattering: [1, 1, 1]" + more + "}}\n");
    EXPECT_TRUE(scene.warnings.empty());
    return scene.media.at(0);
  }
  std::string error(const std::string& more = "") const {
    return files.error_v1("media: {a: {grid: a.vdb" + more + "}}\n");
  }
  void expect_error(const std::string& expected, const std::string& more = "") const {
    const std::string found = error(more);
    EXPECT_NE(found.find(expected), std::string::npos) << found;
  }

  SceneFiles files;
};

/// The density of a medium at a place in the world.
double density_at(const Medium& medium, const Vec3d& place) {
  const Vec3d unit = medium.grid_place.inverse().point(place);
  return medium.grid->at({unit.x * (medium.grid->size(0) - 1.0), unit.y * (medium.grid->size(1) - 1.0),
                          unit.z * (medium.grid->size(2) - 1.0)});
}

/// Compares with OpenVDB's own interpolation, in a box around all active voxels and beyond.
void expect_like_box_sampler(const Medium& medium, const FloatGrid& grid, double tolerance = 1e-5) {
  const CoordBBox box = grid.evalActiveVoxelBoundingBox();
  std::mt19937 random(7);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    openvdb::Vec3d index;
    for (int k = 0; k < 3; ++k) {
      std::uniform_real_distribution<double> along(box.min()[k] - 3.0, box.max()[k] + 3.0);
      index[k] = along(random);
    }
    const openvdb::Vec3d world = grid.indexToWorld(index);
    const double expected = openvdb::tools::BoxSampler::sample(grid.tree(), index);
    inside += expected > 0 ? 1 : 0;
    EXPECT_NEAR(density_at(medium, {world.x(), world.y(), world.z()}), expected, tolerance) << world;
  }
  EXPECT_GT(inside, 200);
}

/// A ball of fog of radius 3 about (1, 2, 3), and voxels of 0.2.
FloatGrid::Ptr fog_ball() {
  const FloatGrid::Ptr grid = openvdb::tools::createLevelSetSphere<FloatGrid>(3, {1, 2, 3}, 0.2, 6);
  openvdb::tools::sdfToFogVolume(*grid);
  grid->setName("density");
  return grid;
}

TEST_F(Vdb, DensitiesAreThoseOfOpenVdbsInterpolation) {
  const FloatGrid::Ptr ball = fog_ball();
  write({ball});
  const Medium ball_medium = medium();
  expect_like_box_sampler(ball_medium, *ball);
  EXPECT_NEAR(density_at(ball_medium, {1, 2, 3}), 1, 1e-5);
  EXPECT_EQ(density_at(ball_medium, {1, 2, 6.5}), 0);

  // A place that is turned, sheared and far away.
  openvdb::math::Transform::Ptr place = openvdb::math::Transform::createLinearTransform(0.5);
  place->preRotate(0.7, openvdb::math::Y_AXIS);
  place->postShear(0.3, openvdb::math::X_AXIS, openvdb::math::Z_AXIS);
  place->postTranslate({1000, -20, 3});
  ball->setTransform(place);
  write({ball});
  expect_like_box_sampler(medium(), *ball);
}

TEST_F(Vdb, TilesAndInactiveVoxelsHaveTheirValues) {
  const FloatGrid::Ptr grid = named("density", 0.25);
  grid->fill(CoordBBox(Coord(-40, 0, 8), Coord(-9, 31, 39)), 0.75f);  // whole leaves: tiles
  grid->tree().setValueOn(Coord(20, 70, -30), 4);                     // a voxel far from them
  grid->tree().setValueOff(Coord(5, 20, 10), 2);                      // inactive
  ASSERT_GT(grid->tree().activeTileCount(), 0u);
  for (const std::uint32_t compression :
       {openvdb::io::COMPRESS_NONE + 0, openvdb::io::COMPRESS_ZIP + 0, openvdb::io::COMPRESS_BLOSC + 0}) {
    write({grid}, compression);
    const Medium read = medium();
    expect_like_box_sampler(read, *grid);
    EXPECT_NEAR(density_at(read, {20 * 0.25, 70 * 0.25, -30 * 0.25}), 4, 1e-9);
    EXPECT_NEAR(density_at(read, {5 * 0.25, 20 * 0.25, 10 * 0.25}), 2, 1e-9);
    EXPECT_NEAR(density_at(read, {-20 * 0.25, 20 * 0.25, 20 * 0.25}), 0.75, 1e-9);
  }
}

TEST_F(Vdb, HalfFloatsAndDoublesAreRead) {
  const FloatGrid::Ptr half = fog_ball();
  half->setSaveFloatAsHalf(true);
  write({half});
  expect_like_box_sampler(medium(), *half, 0x1p-11);

  const openvdb::DoubleGrid::Ptr doubles = openvdb::DoubleGrid::create(0);
  doubles->tree().setValueOn(Coord(1, 2, 3), 0.1);
  write({doubles});
  EXPECT_EQ(density_at(medium(), {1, 2, 3}), static_cast<double>(0.1f));
}

TEST_F(Vdb, TheGridIsTheOneOfThatNameOrDensityOrTheOnlyOne) {
  const FloatGrid::Ptr density = named("density"), flame = named("flame");
  density->tree().setValueOn(Coord(0), 2), flame->tree().setValueOn(Coord(0), 3);
  const openvdb::Vec3SGrid::Ptr velocity = openvdb::Vec3SGrid::create();
  velocity->setName("velocity");
  write({velocity, flame, density});
  EXPECT_EQ(density_at(medium(), {}), 2);
  EXPECT_EQ(density_at(medium(", grid_name: flame"), {}), 3);
  expect_error("no grid 'smoke'; the file has 'density' (float), 'flame' (float), 'velocity' (vec3s)",
               ", grid_name: smoke");
  expect_error("the grid 'velocity' is of type vec3s; expected float", ", grid_name: velocity");
  expect_error("expected the name of a grid", ", grid_name: ''");
  write({velocity, flame});
  EXPECT_EQ(density_at(medium(), {}), 3);
  write({flame, named("heat")});
  expect_error("several hold floats; expected 'grid_name': the file has 'flame' (float), 'heat' (float)");
  write({velocity});
  expect_error("expected a grid of floats; the file has 'velocity' (vec3s)");
}

TEST_F(Vdb, ErrorsNameTheGridsThatTheFileHas) {
  const FloatGrid::Ptr surface = openvdb::tools::createLevelSetSphere<FloatGrid>(1, {0, 0, 0}, 0.2);
  surface->setName("surface");
  const FloatGrid::Ptr smoke = named("smoke");
  smoke->tree().setValueOn(Coord(0), 2);
  const openvdb::Int32Grid::Ptr flags = openvdb::Int32Grid::create();
  flags->setName("flags");
  write({surface, smoke, flags});
  EXPECT_EQ(density_at(medium(), {}), 2);  // the only one that can be densities
  const std::string has = "; the file has 'flags' (int32), 'smoke' (float), 'surface' (float, level set)";
  expect_error("is a level set (distances from a surface); expected densities" + has, ", grid_name: surface");
  expect_error("the grid 'flags' is of type int32; expected float" + has, ", grid_name: flags");
  expect_error("no grid 'flame'" + has, ", grid_name: flame");
  smoke->setTransform(openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 10, 1));
  write({surface, smoke, flags});
  expect_error("the grid 'smoke' is a frustum; expected a grid with an affine transform" + has);
}

TEST_F(Vdb, GridsOfOneNameHaveNumbers) {
  const FloatGrid::Ptr first = named("density"), second = named("density");
  first->tree().setValueOn(Coord(0), 2), second->tree().setValueOn(Coord(0), 3);
  write({first, second});
  EXPECT_EQ(density_at(medium(", grid_name: 'density[0]'"), {}), 2);
  EXPECT_EQ(density_at(medium(", grid_name: 'density[1]'"), {}), 3);
  for (const std::string more : {"", ", grid_name: density"})
    expect_error(
        "several grids are called 'density'; expected 'grid_name' with a number: the file has 'density[0]' "
        "(float), 'density[1]' (float)",
        more);
}

// Blender 3.4 writes a fog of halves from index 0 on, a velocity on faces and a shadow of -1 everywhere; the
// grids of its noise have names of their own.
TEST_F(Vdb, SmokeOfBlenderStandsInItsDomainByTheTransformsOfTheDocument) {
  const double cell = 4.0 / 24;  // the domain is 2 x 3 x 4, with 24 cells along z
  const FloatGrid::Ptr smoke = named("density", cell), shadow = named("shadow", cell);
  for (const FloatGrid::Ptr& grid : {smoke, shadow}) {
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setSaveFloatAsHalf(true);
  }
  smoke->tree().setValueOn(Coord(3, 16, 20), 0.5f), smoke->tree().setValueOn(Coord(11, 17, 23), 0.25f);
  shadow->denseFill(CoordBBox(Coord(0), Coord(11, 17, 23)), -1);
  const openvdb::Vec3SGrid::Ptr velocity = openvdb::Vec3SGrid::create();
  velocity->setName("velocity");
  velocity->setGridClass(openvdb::GRID_STAGGERED);
  write({smoke, shadow, velocity});
  const Medium placed = medium(
      ", transform: [{translate: [-1, -1.5, -2]}, {translate: [0.0833333333333333, 0.0833333333333333, "
      "0.0833333333333333]}, {rotate: [0, 0, 90]}, {translate: [3, -2, 1]}]");
  // The middle of a cell in the domain that is turned by 90 degrees about z and moved.
  const auto middle = [&](int i, int j, int k) {
    const Vec3d local{-1 + (i + 0.5) * cell, -1.5 + (j + 0.5) * cell, -2 + (k + 0.5) * cell};
    return Vec3d{3 - local.y, -2 + local.x, 1 + local.z};
  };
  EXPECT_NEAR(density_at(placed, middle(3, 16, 20)), 0.5, 1e-9);
  EXPECT_NEAR(density_at(placed, middle(11, 17, 23)), 0.25, 1e-9);
  EXPECT_NEAR(density_at(placed, middle(11, 17, 22)), 0, 1e-9);
  EXPECT_EQ(files.warnings_v1("media: {a: {grid: a.vdb, grid_name: shadow}}\n"),
            "a.vdb: warning: 5184 densities are below 0 and count as 0\n");
  smoke->setName("density_noise"), shadow->setName("flame_noise");
  write({smoke, shadow});
  EXPECT_NEAR(density_at(medium(", grid_name: density_noise"), {0.5, 16 * cell, 20 * cell}), 0.5, 1e-9);
  expect_error("the file has 'density_noise' (float), 'flame_noise' (float)");
}

TEST_F(Vdb, TheTransformOfTheMediumMovesTheGrid) {
  const FloatGrid::Ptr grid = named("density", 0.5);
  grid->tree().setValueOn(Coord(2, 0, 0), 1);
  write({grid});
  EXPECT_NEAR(density_at(medium(), {1, 0, 0}), 1, 1e-12);
  const Medium moved = medium(", transform: [{rotate: [-90, 0, 0]}, {translate: [0, 3, 0]}]");
  EXPECT_NEAR(density_at(moved, {1, 3, 0}), 1, 1e-12);
  EXPECT_EQ(density_at(moved, {1, 0, 0}), 0);
  expect_error("2:34: an OpenVDB file says where its grid is; 'transform' moves it",
               ", bounds: {min: [0, 0, 0], max: [1, 1, 1]}");
}

// The first frames of smoke may have none.
TEST_F(Vdb, AnEmptyGridIsNothing) {
  write({named("density")});
  EXPECT_EQ(medium().grid->most(), 0);
}

TEST_F(Vdb, DensitiesBelowZeroAreZeroWithAWarning) {
  const FloatGrid::Ptr grid = named("density");
  grid->tree().setValueOn(Coord(0), 1), grid->tree().setValueOn(Coord(1, 0, 0), -0.5f);
  write({grid});
  const std::string scene = "media: {a: {grid: a.vdb}}\n";
  EXPECT_EQ(files.warnings_v1(scene), "a.vdb: warning: a density is below 0 and counts as 0\n");
  const Scene loaded = files.load_v1(scene);
  EXPECT_EQ(density_at(loaded.media[0], {1, 0, 0}), 0);
  EXPECT_EQ(density_at(loaded.media[0], {0.25, 0, 0}), 0.75);
}

TEST_F(Vdb, DensitiesOfAllSpaceEndAroundTheVoxelsWithAWarning) {
  const std::string scene = "media: {a: {grid: a.vdb}}\n";
  const std::string warning =
      "a.vdb: warning: the grid states a density of 0.25 for all places without a voxel; beyond its voxels "
      "it "
      "counts as 0\n";
  const FloatGrid::Ptr grid = FloatGrid::create(0.25f);
  write({grid});
  EXPECT_EQ(files.warnings_v1(scene), warning);
  EXPECT_EQ(files.load_v1(scene).media[0].grid->most(), 0);
  grid->tree().setValueOn(Coord(0), 1), grid->tree().setValueOn(Coord(2, 0, 0), 1);
  write({grid});
  EXPECT_EQ(files.warnings_v1(scene), warning);
  const Scene loaded = files.load_v1(scene);
  EXPECT_EQ(density_at(loaded.media[0], {1, 0, 0}), 0.25);
  EXPECT_EQ(density_at(loaded.media[0], {2.5, 0, 0}), 0.625);
  EXPECT_EQ(density_at(loaded.media[0], {5, 0, 0}), 0);
}

TEST_F(Vdb, WhatIsNoDensityIsAnError) {
  const FloatGrid::Ptr surface = openvdb::tools::createLevelSetSphere<FloatGrid>(1, {0, 0, 0}, 0.2);
  surface->setName("surface");
  write({surface});
  expect_error("a.vdb: the grid 'surface' is a level set");
  const FloatGrid::Ptr grid = named("density");
  grid->tree().setValueOn(Coord(0), 1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 10, 1));
  write({grid});
  expect_error("a.vdb: the grid 'density' is a frustum");
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e9f}) {
    const FloatGrid::Ptr wrong = named("density");
    wrong->tree().setValueOn(Coord(0), bad);
    write({wrong});
    expect_error("a.vdb: a value of the grid 'density' is ");
    expect_error("expected a density from 0 to 1e+09");
  }
}

// A file of a few hundred bytes may be a box of any size.
TEST_F(Vdb, GridsThatAreTooLargeAreErrors) {
  const FloatGrid::Ptr grid = named("density");
  grid->tree().setValueOn(Coord(0), 1), grid->tree().setValueOn(Coord(4094, 0, 0), 1);
  write({grid});
  expect_error("a.vdb: the grid 'density' fills 4095 x 1 x 1 voxels; expected at most 4094 along an edge");
  grid->tree().setValueOff(Coord(4094, 0, 0), 0), grid->tree().setValueOn(Coord(4093, 0, 0), 1);
  write({grid});
  EXPECT_EQ(medium().grid->size(0), 4096u);
  grid->clear();
  grid->tree().addTile(3, Coord(0), 1, true);
  grid->tree().setValueOn(Coord(700, 700, 700), 1);
  write({grid});
  expect_error("and 268435456 in all");
  grid->clear();
  grid->tree().setValueOn(Coord(std::numeric_limits<int>::max(), 0, 0), 1);
  write({grid});
  expect_error("has voxels at indices beyond 2^30");
}

TEST_F(Vdb, BadFilesAreErrors) {
  EXPECT_EQ(error(), "scene.yaml:2:19: 'a.vdb': no such file");
  files.dir.write("a.vdb", "");
  expect_error("a.vdb: cannot be read as an OpenVDB file: ");
  files.dir.write("a.vdb", "oktett density grid 1\n");
  expect_error("a.vdb: cannot be read as an OpenVDB file: ");
  write({fog_ball()});
  const std::string whole = test::file_content(files.dir.file("a.vdb"));
  files.dir.write("a.vdb", whole.substr(0, whole.size() / 3));
  expect_error("a.vdb: ");
}

}  // namespace
}  // namespace oktett::vdb_test
