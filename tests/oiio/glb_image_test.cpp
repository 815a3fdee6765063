// Images that are computed for GLB files.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "io/image/texture.h"
#include "tests/io/convert_test_support.h"

namespace oktett::test::glb_image_test {
namespace {

constexpr Vec2f kNoChange{0, 0};

class GlbImages : public Convert {
 protected:
  void write_image(const char* name, int width, int height, int channels,
                   const std::vector<std::uint8_t>& pixels) const {
    const OIIO::ImageSpec spec(width, height, channels, OIIO::TypeUInt8);
    auto output = OIIO::ImageOutput::create(files.dir.file(name));
    ASSERT_TRUE(output && output->open(files.dir.file(name), spec) &&
                output->write_image(OIIO::TypeUInt8, pixels.data()) && output->close());
  }
  void write_square(const std::string& material, const char* scale = "1") const {
    files.write("in.mtl", "newmtl m\n" + material);
    const std::string s(scale);
    files.write("in.obj", "mtllib in.mtl\nv 0 0 0\nv " + s + " 0 0\nv " + s + " " + s + " 0\nv 0 " + s +
                              " 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
  }
};

// Colour and opacity of two images become one, whichever is larger, and one alone is white.
TEST_F(GlbImages, OpacityBecomesAlpha) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> colors(4 * 4 * 3), holes(8 * 8);
  for (std::uint8_t& v : colors) v = static_cast<std::uint8_t>(random());
  for (std::uint8_t& v : holes) v = static_cast<std::uint8_t>(random());
  write_image("color.png", 4, 4, 3, colors);
  write_image("holes.png", 8, 8, 1, holes);
  for (const std::string material : {"map_Kd color.png\nmap_d holes.png\n", "map_d holes.png\n"}) {
    write_square(material);
    const Losses losses = convert("in.obj", "a.glb");
    EXPECT_EQ(std::ranges::count(losses, "changed: 1 image, drawn anew with the opacity as alpha"), 1)
        << testing::PrintToString(losses);
    const MeshFile before = load("in.obj"), after = load("a.glb");
    const Material &from = before.materials.at(0), &to = after.materials.at(0);
    const ImageTextures one(before.textures), other(after.textures);
    EXPECT_TRUE(other.warnings().empty());
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) {
        const Vec2f uv{(static_cast<float>(x) + 0.5f) / 8, (static_cast<float>(y) + 0.5f) / 8};
        const float opacity = one.value(from.opacity_texture, uv, kNoChange, kNoChange);
        EXPECT_NEAR(other.value(to.opacity_texture, uv, kNoChange, kNoChange), opacity, 1e-6);
        // Eight bits over black.
        const Color a = one.color(from.color_texture, uv, kNoChange, kNoChange),
                    b = other.color(to.color_texture, uv, kNoChange, kNoChange);
        if (opacity > 0.05f) {
          EXPECT_LT(length(a - b), 0.02f) << x << " " << y;
        }
      }
  }
}

// Heights of 2 from left to right over a square of that size, four times as steep where the image is
// repeated.
TEST_F(GlbImages, BumpsBecomeNormals) {
  const int size = 64;
  std::vector<std::uint8_t> heights;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      heights.push_back(
          static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * std::sin(2 * M_PI * x / size) / 2)));
  write_image("bump.png", size, size, 1, heights);
  for (const double repeats : {1.0, 4.0})
    for (const double side : {1.0, 3.0}) {
      write_square("map_Bump -bm 0.1 -s " + exact_text(static_cast<float>(repeats)) + " 1 1 bump.png\n",
                   exact_text(static_cast<float>(side)).c_str());
      const Losses losses = convert("in.obj", "a.glb");
      EXPECT_EQ(std::ranges::count(losses,
                                   "changed: 1 bump map, as the normals of heights on a surface whose "
                                   "coordinates are everywhere as long"),
                1)
          << testing::PrintToString(losses);
      // Heights of 8 bits are wrong by half a step, so the slope over two pixels by a whole one.
      const double tolerance = 0.01 + 0.1 / 255 / (2.0 / size) * repeats / side;
      const MeshFile after = load("a.glb");
      const Material& m = after.materials.at(0);
      ASSERT_NE(m.normal_texture, kNoId);
      const ImageTextures textures(after.textures);
      for (int x = 0; x < size; ++x) {
        const double at = (x + 0.5) / size;
        const Vec3f texel = textures.normal(m.normal_texture, {static_cast<float>(at / repeats), 0.3f},
                                            kNoChange, kNoChange) *
                                2 -
                            Vec3f{1, 1, 1};
        // The derivative of 0.1 (1/2 + sin(2 pi s) / 4), where the image is side / repeats wide.
        const double slope = 0.05 * M_PI * std::cos(2 * M_PI * x / size) / (side / repeats);
        const Vec3d expected = normalize(Vec3d{-slope, 0, 1});
        EXPECT_LT(length(Vec3d(texel) - expected), tolerance) << x << " " << repeats << " " << side;
      }
    }
}

// Formats that glTF does not know are written as PNG.
TEST_F(GlbImages, OtherFormatsBecomePng) {
  write_image("color.tga", 2, 1, 3, {255, 0, 0, 0, 0, 255});
  write_square("map_Kd color.tga\n");
  convert("in.obj", "a.glb");
  const MeshFile after = load("a.glb");
  const ImageTextures textures(after.textures);
  EXPECT_TRUE(textures.warnings().empty());
  EXPECT_EQ(textures.color(after.materials.at(0).color_texture, {0.25f, 0.5f}, kNoChange, kNoChange),
            (Color{1, 0, 0}));
}

}  // namespace
}  // namespace oktett::test::glb_image_test
