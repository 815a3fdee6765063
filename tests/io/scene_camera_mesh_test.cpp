// The meshes of cameras in scene files, and POV-Ray's mesh_camera.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "io/yaml/write_yaml.h"
#include "render/picture/render.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_camera_mesh_test {
namespace {

using test::SceneFiles;

/// A square from -1 to 1 at z = 0 that looks to +z, with texture coordinates.
const char* const kSquare =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
const char* const kBare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A picture of the same surface, whose rays meet it on the front, shows at each pixel the texture
/// coordinates of its middle: an image that is baked lies on the surface as it was seen.
TEST(SceneCameraMesh, PicturesLieOnTheSurfaceAgain) {
  const SceneFiles files;
  files.dir.write("square.obj", kSquare);
  Scene scene = files.load_v1(
      "camera: {projection: mesh, mesh: {order: uv, offset: 0.5, reverse: true, meshes: [{file: square.obj, "
      "transform: [{scale: [2, 3, 1]}, {rotate: {axis: [1, 2, 3], angle: 40}}]}]}}\n"
      "film: {width: 8, height: 6}\nintegrator: {kind: uv, samples: 1}\n"
      "objects:\n  - mesh: {file: square.obj}\n    transform: [{scale: [2, 3, 1]}, {rotate: {axis: [1, 2, "
      "3], "
      "angle: 40}}]\n");
  EXPECT_TRUE(scene.warnings.empty());
  const Picture picture = render(std::move(scene), {}).picture;
  for (std::uint32_t y = 0; y < 6; ++y)
    for (std::uint32_t x = 0; x < 8; ++x) {
      const auto at = [&](const char* plane) { return picture.find(plane)->values[y * 8 + x]; };
      EXPECT_NEAR(at("R"), (x + 0.5) / 8, 1e-5);
      EXPECT_NEAR(at("G"), 1 - (y + 0.5) / 6, 1e-5);
    }
}

TEST(SceneCameraMesh, ErrorsHaveTheirPlace) {
  const SceneFiles files;
  files.dir.write("bare.obj", kBare), files.dir.write("empty.obj", "v 0 0 0\n");
  const auto error = [&](const std::string& camera) { return files.error_v1("camera: {" + camera + "}"); };
  EXPECT_EQ(error("projection: mesh"), "scene.yaml:2:9: a mesh view needs a 'mesh', whose faces see");
  EXPECT_EQ(error("projection: mesh, mesh: {meshes: []}"),
            "scene.yaml:2:43: a camera has 0 meshes; expected 1 to 1024");
  EXPECT_EQ(error("projection: mesh, mesh: {order: uv, meshes: [{file: bare.obj}]}"),
            "scene.yaml:2:34: 'order: uv' needs texture coordinates, which a mesh of the camera has not");
  EXPECT_EQ(error("projection: mesh, mesh: {meshes: [{file: empty.obj}]}"),
            "scene.yaml:2:51: a camera sees from triangles, but the mesh has none");
  EXPECT_EQ(error("projection: mesh, mesh: {order: rows, meshes: [{file: bare.obj}]}"),
            "scene.yaml:2:42: expected average or sequence or columns or uv, found 'rows'");
  EXPECT_EQ(error("projection: mesh, aperture: 1, mesh: {meshes: [{file: bare.obj}]}"),
            "scene.yaml:2:38: a mesh view has no lens; 'aperture' is for perspective and orthographic views");
  EXPECT_EQ(
      files.warnings_v1("camera: {projection: mesh, from: [1, 2, 3], mesh: {meshes: [{file: bare.obj}], "
                        "smooth: true}}\n"),
      "scene.yaml:2:88: warning: 'smooth' has no effect: faces see along one normal; 'order: uv' has "
      "several\nscene.yaml:2:34: warning: 'from' has no effect: the view of a mesh is that of its faces\n");
}

// ---- mesh_camera.

/// The camera in one line, and what is wrong with it, of the text in its block.
class PovMeshCamera : public testing::Test {
 protected:
  std::string camera(const std::string& text) {
    const pov::TranslatedScene scene = read_pov_tree(write(text), {}, {});
    for (std::size_t i = 0; i + 1 < scene.root->items.size(); i += 2)
      if (scene.root->items[i]->text == "camera") return flow_text(*scene.root->items[i + 1]);
    return "none";
  }
  std::string error(const std::string& text) {
    try {
      load_scene(write(text));
    } catch (const Error& e) {
      return files.without_directory(e.what());
    }
    return "no error";
  }
  std::string write(const std::string& text) const {
    return files.dir.write("scene.pov",
                           "#version 3.7;\n#declare M = mesh { triangle { 0, x, y uv_vectors "
                           "<0,0>, <1,0>, <0,1> } }\ncamera { " +
                               text + " }\n");
  }
  SceneFiles files;
};

TEST_F(PovMeshCamera, DistributionsAreOrders) {
  const std::string begin = "{projection: mesh, mesh: {meshes: ", m = "{file: M.ply}";
  EXPECT_EQ(camera("mesh_camera { 1 0 mesh { M } }"), begin + "[" + m + "], order: average, reverse: true}}");
  EXPECT_EQ(camera("mesh_camera { 2 0 mesh { M } mesh { M translate x } mesh { M translate y } }"),
            begin + "[" + m +
                ", {file: M.ply, transform: {translate: [1, 0, 0]}}], order: average, reverse: "
                "true}}");
  EXPECT_EQ(camera("mesh_camera { 3 1 mesh { M } }"),
            begin + "[" + m + "], order: sequence, reverse: true}}");
  EXPECT_EQ(camera("mesh_camera { 1 2 mesh { M } mesh { M } } direction -z"),
            begin + "[" + m + ", " + m + "], order: columns}}");
  // Only the first mesh counts.
  EXPECT_EQ(camera("mesh_camera { 1 3 2.5 mesh { M } mesh { M } } location <1,2,0.5>"),
            begin + "[" + m + "], order: uv, reverse: true, offset: -0.5, max_distance: 2.5}}");
  EXPECT_EQ(camera("mesh_camera { 1 3 mesh { M } smooth } location 0.5*z"),
            begin + "[" + m + "], order: uv, smooth: true, offset: 0.5}}");
}

TEST_F(PovMeshCamera, ErrorsHaveTheirPlace) {
  const std::string place = "scene.pov:3:10: ";
  EXPECT_EQ(error("mesh_camera { 1 4 mesh { M } }"),
            "scene.pov:3:24: expected a distribution from 0 to 3 in a mesh_camera, found 4");
  EXPECT_EQ(error("mesh_camera { 0 0 mesh { M } }"),
            "scene.pov:3:24: a mesh_camera with 0 rays per pixel cannot be meant; expected 1 to 1024");
  EXPECT_EQ(error("mesh_camera { 2 3 mesh { M } }"),
            "scene.pov:3:24: a mesh_camera of distribution 3 has 1 ray per pixel, found 2");
  EXPECT_EQ(
      error("mesh_camera { 2 0 mesh { M } }"),
      place + "a mesh_camera of distribution 0 has a mesh for each ray of a pixel; expected 2, found 1");
  EXPECT_EQ(error("mesh_camera { 1 0 }"), place + "a mesh_camera needs a mesh");
  EXPECT_EQ(error("mesh_camera { 1 0 sphere { 0, 1 } }"),
            "scene.pov:3:28: expected a mesh in a mesh_camera, found 'sphere'");
  EXPECT_EQ(error("mesh_camera { 1 0 mesh { M } smooth }"),
            "scene.pov:3:39: 'smooth' is for a mesh_camera of distribution 3");
}

/// POV-Ray shows the same values, but 0.6 in the last pixel, see docs/pov.md.
TEST_F(PovMeshCamera, ShowsWhatFacesSee) {
  const auto picture = [&](const std::string& camera) {
    Scene scene = load_scene(
        files.dir.write("walls.pov",
                        "#version 3.7;\n#default { finish { ambient 1 diffuse 0 } }\n"
                        "#declare M = mesh { triangle { 0, x, y } triangle { 5*x, 6*x, 5*x + y } }\n"
                        "camera { mesh_camera { " +
                            camera +
                            " } }\n"
                            "box { <-1,-1,-3>, <2,2,-2> pigment { rgb 0.2 } }\n"
                            "box { <4,-1,-3>, <7,2,-2> pigment { rgb 0.6 } }\n"));
    scene.film.width = 2, scene.film.height = 1;
    return render(std::move(scene), {}).picture;
  };
  const auto expect = [](const Picture& p, float left, float right) {
    EXPECT_NEAR(p.find("R")->values[0], left, 1e-4);
    EXPECT_NEAR(p.find("R")->values[1], right, 1e-4);
  };
  expect(picture("1 0 mesh { M }"), 0.2f, 0.6f);
  expect(picture("2 0 mesh { M } mesh { M translate 5*x }"), 0.4f, 0.3f);
  expect(picture("1 2 mesh { M translate 5*x } mesh { M }"), 0.6f, 0.2f);
}

}  // namespace
}  // namespace oktett::scene_camera_mesh_test
