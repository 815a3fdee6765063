// Textures of single components of blobs in POV-Ray's language.

#include <gtest/gtest.h>

#include <string>

#include "io/scene/scene_file.h"
#include "render/picture/render.h"
#include "tests/support/temp_dir.h"

namespace oktett::pov_blob_textures_test {
namespace {

/// What POV-Ray 3.7.0.10 shows in the middle of nine pixels of a blob of two balls: by magnitudes of the
/// fields, also of negative ones, and the blob's own texture where a ball has none.
TEST(PovBlobTextures, AreWeightedByFields) {
  const test::TempDir dir;
  const auto expect = [&](const std::string& balls, int pixel, const Vec3d& color) {
    Scene scene = load_scene(dir.write(
        "blob.pov",
        "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n#default { finish { ambient 1 diffuse 0 } }\n"
        "camera { orthographic location -10*z right 3.6*x up 0.4*y direction z }\n"
        "blob { threshold 0.3 " +
            balls + " }\n"));
    scene.film.width = 9, scene.film.height = 1, scene.integrator.samples = 1;
    const Picture picture = render(std::move(scene), {}).picture;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(picture.find(std::string(1, "RGB"[k]))->values[static_cast<std::size_t>(pixel)], color[k],
                  0.002)
          << balls << " " << k;
  };
  const std::string red = "sphere { <-0.5,0,0>, 1.2, 1 texture { pigment { rgb x } } } ";
  expect(red + "sphere { <0.5,0,0>, 1.2, 1 texture { pigment { rgb z } } }", 4, {0.5, 0, 0.5});
  expect(red + "sphere { <0.5,0,0>, 1.2, 2 pigment { rgb z } }", 4, {0.333, 0, 0.667});
  expect(red + "sphere { <0.5,0,0>, 1.2, 2 pigment { rgb z } }", 1, {1, 0, 0});
  expect(red + "sphere { <0.5,0,0>, 1.2, 2 pigment { rgb z } }", 6, {0, 0, 1});
  expect(red + "sphere { <0.3,0,0>, 1.5, -0.3 pigment { rgb z } }", 2, {0.955, 0, 0.045});
  expect(red + "sphere { <0.3,0,0>, 1.5, -0.3 pigment { rgb z } }", 3, {0.813, 0, 0.187});
  expect(red + "sphere { <0.5,0,0>, 1.2, 1 } texture { pigment { rgb y } }", 4, {0.5, 0.5, 0});
}

}  // namespace
}  // namespace oktett::pov_blob_textures_test
