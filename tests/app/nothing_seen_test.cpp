/// \file What is told of pictures that show nothing, and the light of files that have a camera and no lights.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::nothing_seen_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

/// What `oktett render` prints to stderr for a scene.
std::string told(const std::string& rest, const std::vector<std::string>& options = {}) {
  const TempDir dir;
  dir.write("scene.yaml",
            "oktett: 1\nfilm: {width: 16, height: 12}\nobjects: [{sphere: {radius: 1}}]\n" + rest);
  std::vector<std::string> words{"render", "scene.yaml", "-o", "x.png", "--quiet"};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult result = run_command(dir, words);
  EXPECT_EQ(result.status, 0) << result.err;
  return result.err;
}

TEST(NothingSeen, ACameraThatMeetsNoObjectIsTold) {
  const std::string away = "camera: {from: [0, 0, 5], at: [0, 0, 9]}\n";
  for (const char* integrator : {"whitted", "path", "normal", "facing"})
    EXPECT_EQ(told(away, {"--integrator", integrator}),
              "warning: the camera at (0, 0, 5), which looks towards (0, 0, 9), sees none of the objects\n");
  EXPECT_EQ(told("camera: {from: [0, 0, 5], at: [0, 0, 0]}\n"), "");
  // An edge of the object is enough, and a picture of nothing but sky may be meant.
  EXPECT_EQ(told("camera: {from: [0, 0, 5], at: [1.9, 0, 0], fov: 40}\n"), "");
}

// A scan in coordinates of a map, which the scene counts from.
TEST(NothingSeen, AFarCameraIsToldInTheCoordinatesOfTheFile) {
  const TempDir dir;
  dir.write("a.obj", "v 432100 5411000 300\nv 432100.5 5411000 300\nv 432100 5411000.5 300\nf 1 2 3\n");
  dir.write("a.yaml",
            "oktett: 1\ncamera: {from: [432100.25, 5411000, 305], at: [432100.25, 5411000, 309.5]}\n"
            "objects: [{mesh: {file: a.obj}}]\n");
  const CommandResult result =
      run_command(dir, {"render", "a.yaml", "-o", "x.png", "--quiet", "--size", "8x6"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err,
            "warning: the camera at (432100.25, 5411000, 305), which looks towards (432100.25, 5411000, "
            "309.5), sees none of the objects\n");
}

TEST(NothingSeen, ABlackPictureSaysWhy) {
  const std::string camera = "camera: {from: [0, 0, 5], at: [0, 0, 0]}\n";
  const std::string dark = camera + "background: [0, 0, 0]\nambient_light: [0, 0, 0]\n";
  for (const char* integrator : {"whitted", "path"}) {
    const std::vector<std::string> options{"--integrator", integrator};
    EXPECT_EQ(told(dark + "lights: []\n", options),
              "warning: the picture is black: the scene has no lights\n");
    EXPECT_EQ(told(dark + "lights: [{point: {position: [0, 0, 0], color: [1, 1, 1]}}]\n", options),
              "warning: the picture is black: no light reaches what the camera sees\n");
    EXPECT_EQ(told(dark, options), "");
  }
}

/// A glTF file of a triangle of black metal, or what its material is, with the nodes given.
std::string triangle_file(const std::string& nodes, const std::string& material) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},)" + nodes +
         R"(],"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],)" +
         R"("materials":[)" + material + R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)" +
         R"("material":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)" +
         R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)" +
         R"({"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

// Metal shows nothing but what it mirrors.
TEST(NothingSeen, AFileWithACameraAndNoLightsGetsThatOfTheLook) {
  const TempDir dir;
  for (const char* material :
       {R"({"pbrMetallicRoughness":{}})", R"({"pbrMetallicRoughness":{"roughnessFactor":0.2}})",
        R"({"pbrMetallicRoughness":{"metallicFactor":0}})"}) {
    dir.write("a.gltf", triangle_file(R"({"camera":0,"translation":[0.3,0.3,3]})", material));
    const CommandResult result =
        run_command(dir, {"render", "a.gltf", "-o", "a.ppm", "--quiet", "--size", "32x32", "--spp", "16"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const std::string picture = test::file_content(dir.file("a.ppm"));
    // The pixel in the middle shows the triangle.
    const auto* pixel = reinterpret_cast<const unsigned char*>(picture.data()) + picture.size() -
                        3 * 32 * 32 + 3 * (16 * 32 + 16);
    EXPECT_GT(std::min({pixel[0], pixel[1], pixel[2]}), 60) << material;
  }
}

}  // namespace
}  // namespace oktett::nothing_seen_test
