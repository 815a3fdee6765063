#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::info_command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

TEST(InfoCommand, TellsAClosedMeshFromAnOpenOne) {
  const TempDir dir;
  dir.write("closed.obj", kTetrahedron);
  std::string open = kTetrahedron;
  dir.write("open.obj", open.substr(0, open.rfind("f 1 4 3")));
  const CommandResult closed = run_command(dir, {"info", "--json", "closed.obj"});
  EXPECT_EQ(closed.status, 0) << closed.err;
  EXPECT_TRUE(contains(closed.out, "\"triangles\": 4"));
  EXPECT_TRUE(contains(closed.out, "\"vertices\": 4"));
  EXPECT_TRUE(contains(closed.out, "\"closed\": true"));
  EXPECT_TRUE(contains(closed.out, "\"bounds_max\": [1, 1, 1]"));
  EXPECT_EQ(std::count(closed.out.begin(), closed.out.end(), '\n'), 1);
  const CommandResult opened = run_command(dir, {"info", "--json", "open.obj"});
  EXPECT_TRUE(contains(opened.out, "\"open_edges\": 3")) << opened.out;
  EXPECT_TRUE(contains(run_command(dir, {"info", "open.obj"}).out, "3 open edges"));
}

TEST(InfoCommand, TraceCountsWhatCameraRaysMeet) {
  const TempDir dir;
  dir.write("tetra.obj", kTetrahedron);
  const CommandResult plain = run_command(dir, {"info", "--json", "tetra.obj"});
  EXPECT_FALSE(contains(plain.out, "per_camera_ray"));
  for (const char* quality : {"fast", "balanced", "best", "compact"}) {
    const CommandResult traced =
        run_command(dir, {"info", "--json", "--trace", "--bvh", quality, "tetra.obj"});
    EXPECT_EQ(traced.status, 0) << traced.err;
    EXPECT_TRUE(contains(traced.out, "\"rays\": 518400, \"nodes\": 0,")) << traced.out;
    EXPECT_FALSE(contains(traced.out, "\"hits\": 0,"));
  }
  EXPECT_TRUE(contains(run_command(dir, {"info", "--trace", "tetra.obj"}).out, "per ray"));
  const CommandResult wrong = run_command(dir, {"info", "--bvh", "bast", "tetra.obj"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(contains(wrong.err, "did you mean")) << wrong.err;
}

TEST(InfoCommand, CountsThroughInstances) {
  const TempDir dir;
  dir.write("tetra.obj", kTetrahedron);
  const std::string scene = dir.write("scene.yaml",
                                      "oktett: 1\n"
                                      "define:\n"
                                      "  one: {mesh: {file: tetra.obj}}\n"
                                      "objects:\n"
                                      "  - instance: one\n"
                                      "  - instance: one\n"
                                      "    transform: [{translate: [5, 0, 0]}]\n"
                                      "  - sphere: {center: [0, -2, 0], radius: 1}\n"
                                      "  - plane: {}\n");
  const CommandResult result = run_command(dir, {"info", "--json", scene});
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* part : {"\"meshes\": 1", "\"triangles\": 4", "\"triangles_shown\": 8", "\"instances\": 2",
                           "\"prototypes\": 1", "\"other_shapes\": 2", "\"unbounded\": 1",
                           "\"bounds_min\": [-1, -3, -1]", "\"bounds_max\": [6.0", "\"camera_given\": false"})
    EXPECT_TRUE(contains(result.out, part)) << part << "\n" << result.out;
  EXPECT_TRUE(contains(run_command(dir, {"info", scene}).out, "triangles"));
}

TEST(InfoCommand, VerticesOfNoTriangleDoNotCount) {
  const TempDir dir;
  dir.write("stray.obj", std::string("v 100 0 -7\n") + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n");
  dir.write("turned.yaml",
            "oktett: 1\nobjects:\n  - mesh: {file: stray.obj}\n    transform: {translate: [0, 0, 2]}\n");
  for (const auto& [file, lo, hi] : {std::array{"stray.obj", "[0, 0, 0]", "[1, 1, 0]"},
                                     std::array{"turned.yaml", "[0, 0, 2]", "[1, 1, 2]"}}) {
    const CommandResult result = run_command(dir, {"info", "--json", file});
    EXPECT_TRUE(contains(result.out, "\"bounds_min\": " + std::string(lo))) << result.out;
    EXPECT_TRUE(contains(result.out, "\"bounds_max\": " + std::string(hi))) << result.out;
  }
}

// Bounds of each closed form, alone in its scene, by hand.
TEST(InfoCommand, BoundsOfClosedForms) {
  const TempDir dir;
  struct Case {
    const char *shape, *lo, *hi;
  };
  for (const Case& c :
       {Case{"sphere: {center: [1, 2, 3], radius: 0.5}", "[0.5, 1.5, 2.5]", "[1.5, 2.5, 3.5]"},
        {"disk: {center: [1, 2, 3], normal: [0, 0, -2], radius: 2}", "[-1, 0, 3]", "[3, 4, 3]"},
        // Its normal has a sine of 0.8 against x, of 0.6 against y and of 1 against z.
        {"disk: {center: [0, 0, 7], normal: [3, 4, 0], radius: 10}", "[-8, -6, -3]", "[8, 6, 17]"},
        {"box: {min: [-1, -2, -3], max: [4, 5, 6]}", "[-1, -2, -3]", "[4, 5, 6]"},
        {"triangle: {vertices: [[1, 0, 0], [0, 2, 0], [0, 0, -3]]}", "[0, 0, -3]", "[1, 2, 0]"},
        {"polygon: {vertices: [[0, 0, 5], [4, 0, 5], [1, 1, 5], [0, 4, 5]]}", "[0, 0, 5]", "[4, 4, 5]"}}) {
    const std::string scene =
        dir.write("scene.yaml", std::string("oktett: 1\nobjects:\n  - ") + c.shape + "\n");
    const CommandResult result = run_command(dir, {"info", "--json", scene});
    EXPECT_EQ(result.status, 0) << result.err;
    for (const std::string& part :
         {"\"bounds_min\": " + std::string(c.lo), "\"bounds_max\": " + std::string(c.hi)})
      EXPECT_TRUE(contains(result.out, part)) << c.shape << ": " << part << "\n" << result.out;
  }
}

}  // namespace
}  // namespace oktett::info_command_test
