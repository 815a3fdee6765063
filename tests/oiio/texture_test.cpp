#include "io/image/texture.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/parallel_for.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "io/image/color.h"
#include "io/image/contents.h"
#include "io/obj/obj.h"
#include "tests/oiio/image_support.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temp_dir.h"

namespace oktett::texture_test {
namespace {

using test::TempDir;
using test::write_pixels;

constexpr Vec2f kNoChange{0, 0};

using Bytes = std::vector<std::uint8_t>;

Texture texture_of(const std::string& path) {
  Texture texture;
  texture.path = path;
  return texture;
}

std::string checkers(const TempDir& dir) {
  // Upper row red, green; lower row blue, white.
  return write_pixels(dir.file("checkers.png"), 2, 2, 3,
                      Bytes{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255});
}

TEST(ImageTextures, OriginIsTheLowerLeftCorner) {
  const TempDir dir;
  const ImageTextures textures({texture_of(checkers(dir))});
  EXPECT_TRUE(textures.warnings().empty());
  EXPECT_EQ(textures.color(0, {0.25f, 0.25f}, kNoChange, kNoChange), (Color{0, 0, 1}));
  EXPECT_EQ(textures.color(0, {0.75f, 0.25f}, kNoChange, kNoChange), (Color{1, 1, 1}));
  EXPECT_EQ(textures.color(0, {0.25f, 0.75f}, kNoChange, kNoChange), (Color{1, 0, 0}));
  EXPECT_EQ(textures.color(0, {0.75f, 0.75f}, kNoChange, kNoChange), (Color{0, 1, 0}));
}

TEST(ImageTextures, RepeatAndClampBeyondTheEdge) {
  const TempDir dir;
  Texture clamped = texture_of(checkers(dir));
  clamped.lookup = kClampedTexture;
  const ImageTextures textures({texture_of(checkers(dir)), clamped});
  for (const float whole : {-3.0f, -1.0f, 1.0f, 7.0f})
    EXPECT_EQ(textures.color(0, {0.25f + whole, 0.75f}, kNoChange, kNoChange), (Color{1, 0, 0})) << whole;
  EXPECT_EQ(textures.color(1, {-5, 9}, kNoChange, kNoChange), (Color{1, 0, 0}));
  EXPECT_EQ(textures.color(1, {5, -9}, kNoChange, kNoChange), (Color{1, 1, 1}));
  // Repeating mixes the edges, clamping does not.
  EXPECT_EQ(textures.color(0, {0, 0.75f}, kNoChange, kNoChange), (Color{0.5f, 0.5f, 0}));
  EXPECT_EQ(textures.color(1, {0, 0.75f}, kNoChange, kNoChange), (Color{1, 0, 0}));
}

TEST(ImageTextures, NearestShowsSquares) {
  const TempDir dir;
  Texture squares = texture_of(checkers(dir));
  squares.lookup.magnified = TextureFilter::nearest;
  const ImageTextures textures({squares});
  EXPECT_EQ(textures.color(0, {0.02f, 0.52f}, kNoChange, kNoChange), (Color{1, 0, 0}));
  EXPECT_EQ(textures.color(0, {0.49f, 0.98f}, kNoChange, kNoChange), (Color{1, 0, 0}));
  EXPECT_EQ(textures.color(0, {0.51f, 0.98f}, kNoChange, kNoChange), (Color{0, 1, 0}));
}

TEST(ImageTextures, EightBitColoursAreSrgbAndValuesAreRaw) {
  const TempDir dir;
  const ImageTextures textures({texture_of(write_pixels(dir.file("a.png"), 1, 1, 3, Bytes{128, 10, 255})),
                                texture_of(write_pixels(dir.file("a.tif"), 1, 1, 3, Bytes{128, 10, 255})),
                                texture_of(write_pixels(dir.file("grey.png"), 1, 1, 1, Bytes{128}))});
  for (const std::uint32_t i : {0u, 1u, 2u}) {
    EXPECT_NEAR(textures.color(i, {0.3f, 0.6f}, kNoChange, kNoChange).x, srgb_to_linear(128 / 255.0f), 2e-4f);
    EXPECT_NEAR(textures.value(i, {0.3f, 0.6f}, kNoChange, kNoChange), 128 / 255.0f, 2e-4f);
  }
  const Vec3f normal = textures.normal(0, {0.3f, 0.6f}, kNoChange, kNoChange);
  EXPECT_NEAR(normal.x, 128 / 255.0f, 2e-4f);
  EXPECT_NEAR(normal.y, 10 / 255.0f, 2e-4f);
  EXPECT_EQ(normal.z, 1);
  EXPECT_NEAR(textures.color(0, {0.3f, 0.6f}, kNoChange, kNoChange).y, srgb_to_linear(10 / 255.0f), 1e-5f);
  EXPECT_EQ(textures.color(2, {0.3f, 0.6f}, kNoChange, kNoChange).x,
            textures.color(2, {0.3f, 0.6f}, kNoChange, kNoChange).z);
}

TEST(ImageTextures, FloatsAreTakenAsTheyAre) {
  const TempDir dir;
  const ImageTextures textures(
      {texture_of(write_pixels(dir.file("a.exr"), 1, 1, 3, std::vector<float>{0.123456f, 7.5f, -2}))});
  EXPECT_EQ(textures.color(0, {0, 0}, kNoChange, kNoChange), (Color{0.123456f, 7.5f, -2}));
  EXPECT_EQ(textures.value(0, {0, 0}, kNoChange, kNoChange), 0.123456f);
}

TEST(ImageTextures, AlphaDoesNotDarkenColours) {
  const TempDir dir;
  const ImageTextures textures(
      {texture_of(write_pixels(dir.file("a.png"), 1, 1, 4, Bytes{255, 255, 255, 0}))});
  EXPECT_EQ(textures.color(0, {0, 0}, kNoChange, kNoChange), (Color{1, 1, 1}));
}

// Numbers of one image from each of its channels, beside its colours; an image without alpha is opaque.
TEST(ImageTextures, ChannelsOfNumbers) {
  const TempDir dir;
  const std::string with_alpha = write_pixels(dir.file("a.png"), 1, 1, 4, Bytes{10, 100, 200, 50});
  const std::string grey = write_pixels(dir.file("b.png"), 1, 1, 2, Bytes{30, 60});
  const std::string opaque = write_pixels(dir.file("c.png"), 1, 1, 3, Bytes{10, 100, 200});
  std::vector<Texture> list;
  for (const std::string& path : {with_alpha, grey, opaque})
    for (const ImageChannel channel :
         {ImageChannel::red, ImageChannel::green, ImageChannel::blue, ImageChannel::alpha}) {
      list.push_back(texture_of(path));
      list.back().channel = channel;
    }
  const ImageTextures textures(list);
  const int expected[] = {10, 100, 200, 50, 30, 30, 30, 60, 10, 100, 200, 255};
  for (std::uint32_t i = 0; i < 12; ++i)
    EXPECT_NEAR(textures.value(i, {0.3f, 0.6f}, kNoChange, kNoChange), static_cast<float>(expected[i]) / 255,
                2e-4f)
        << i;
  // In place of a colour alpha is a grey; the other channels stand beside each other.
  EXPECT_NEAR(textures.color(1, {0, 0}, kNoChange, kNoChange).z, srgb_to_linear(200 / 255.0f), 2e-4f);
  EXPECT_NEAR(textures.color(3, {0, 0}, kNoChange, kNoChange).y, 50 / 255.0f, 2e-4f);
}

TEST(ImageTextures, LuminanceIsThatOfTheColorsAsStored) {
  const TempDir dir;
  const std::string path = write_pixels(dir.file("a.png"), 1, 1, 4, Bytes{10, 100, 200, 50});
  const std::string grey = write_pixels(dir.file("b.png"), 1, 1, 2, Bytes{30, 60});
  std::vector<Texture> list{texture_of(path), texture_of(grey)};
  for (Texture& texture : list) texture.channel = ImageChannel::luminance;
  const ImageTextures textures(list);
  EXPECT_NEAR(textures.value(0, {0, 0}, kNoChange, kNoChange),
              (0.2126 * 10 + 0.7152 * 100 + 0.0722 * 200) / 255, 1e-6);
  EXPECT_NEAR(textures.value(1, {0, 0}, kNoChange, kNoChange), 30 / 255.0, 1e-6);
}

// The same file may be shown as it says and otherwise.
TEST(ImageTextures, ColorsAreEncodedAsTheTextureSays) {
  const TempDir dir;
  const std::string path = write_pixels(dir.file("a.png"), 1, 1, 3, Bytes{10, 100, 200});
  std::vector<Texture> list(3, texture_of(path));
  list[1].color_space = TextureColors::linear;
  list[2].color_space = TextureColors::srgb;
  const ImageTextures textures(list);
  for (const std::uint32_t i : {0u, 2u})
    EXPECT_NEAR(textures.color(i, {0, 0}, kNoChange, kNoChange).y, srgb_to_linear(100 / 255.0f), 1e-6) << i;
  EXPECT_NEAR(textures.color(1, {0, 0}, kNoChange, kNoChange).y, 100 / 255.0, 1e-6);
}

TEST(ImageContents, NormalMapsAndAlphaAreKnown) {
  const TempDir dir;
  std::mt19937 random(2);
  Bytes normals, heights, colors, mask, solid;
  std::normal_distribution<double> slope(0, 0.4);
  for (int i = 0; i < 64; ++i) {
    Vec3d n = normalize(Vec3d{slope(random), slope(random), 1});
    for (int k = 0; k < 3; ++k) normals.push_back(static_cast<std::uint8_t>(127.5 * (n[k] + 1) + 0.5));
    heights.insert(heights.end(), 3, static_cast<std::uint8_t>(random() % 256));
    for (int k = 0; k < 3; ++k) colors.push_back(static_cast<std::uint8_t>(random() % 256));
    for (int k = 0; k < 4; ++k) mask.push_back(static_cast<std::uint8_t>(random() % 256));
    for (int k = 0; k < 4; ++k) solid.push_back(k == 3 ? 255 : static_cast<std::uint8_t>(random() % 256));
  }
  const auto contents = [&](const char* name, int channels, const Bytes& bytes) {
    return image_contents(write_pixels(dir.file(name), 8, 8, channels, bytes));
  };
  EXPECT_TRUE(contents("normals.png", 3, normals).normals);
  EXPECT_TRUE(contents("flat.png", 3, Bytes{[] {
                         Bytes flat;
                         for (int i = 0; i < 64; ++i) flat.insert(flat.end(), {128, 128, 255});
                         return flat;
                       }()})
                  .normals);
  EXPECT_FALSE(contents("heights.png", 3, heights).normals);
  EXPECT_FALSE(contents("white.png", 3, Bytes(192, 255)).normals);
  EXPECT_FALSE(contents("colors.png", 3, colors).normals);
  EXPECT_FALSE(contents("blue.png", 3, Bytes{[] {
                          Bytes blue;
                          for (int i = 0; i < 64; ++i) blue.insert(blue.end(), {40, 90, 240});
                          return blue;
                        }()})
                   .normals);
  EXPECT_TRUE(contents("mask.png", 4, mask).alpha);
  EXPECT_FALSE(contents("solid.png", 4, solid).alpha);
  EXPECT_FALSE(contents("none.png", 3, colors).alpha);
  const ImageContents gone = image_contents(dir.file("gone.png"));
  EXPECT_FALSE(gone.normals || gone.alpha);
}

// Blender writes normal maps as map_Bump; the mask of map_d is the alpha of an image that has one.
TEST(ObjImages, MapsAreReadAsTheirImagesShow) {
  const TempDir dir;
  write_pixels(dir.file("n.png"), 1, 1, 3, Bytes{128, 128, 255});
  write_pixels(dir.file("h.png"), 1, 1, 3, Bytes{128, 128, 128});
  write_pixels(dir.file("a.png"), 1, 1, 4, Bytes{255, 255, 255, 100});
  write_pixels(dir.file("s.png"), 1, 1, 4, Bytes{50, 50, 50, 255});
  dir.write("m.mtl",
            "newmtl a\nmap_Bump -bm 1 n.png\nmap_d a.png\nmap_Kd a.png\nnewmtl b\nmap_Bump -bm 2 "
            "h.png\nmap_d s.png\n"
            "newmtl c\nmap_d -imfchan r a.png\nmap_Bump n.png\nnorm n.png\n");
  const MeshFile file = load_obj(dir.write(
      "m.obj",
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"));
  EXPECT_TRUE(file.warnings.empty());
  const auto texture = [&](std::uint32_t i) { return file.textures.at(i); };
  const Material &a = file.materials.at(0), &b = file.materials.at(1), &c = file.materials.at(2);
  EXPECT_EQ(texture(a.normal_texture).path, dir.file("n.png"));
  EXPECT_EQ(a.bump_texture, kNoId);
  EXPECT_EQ(texture(a.opacity_texture).channel, ImageChannel::alpha);
  EXPECT_EQ(texture(b.bump_texture).path, dir.file("h.png"));
  EXPECT_EQ(b.normal_texture, kNoId);
  EXPECT_EQ(texture(b.opacity_texture).channel, ImageChannel::luminance);
  EXPECT_EQ(texture(c.opacity_texture).channel, ImageChannel::red);
  EXPECT_EQ(c.bump_texture, kNoId);
}

// Bytes in memory give what the same bytes in a file do.
TEST(ImageTextures, ImagesInMemory) {
  const TempDir dir;
  std::vector<Texture> list;
  for (const char* name : {"a.png", "a.jpg", "a.webp"}) {
    const std::string path = write_pixels(dir.file(name), 2, 2, 3, Bytes(12, 77));
    list.push_back(texture_of(path));
    list.push_back(texture_of("model.glb, images[" + std::to_string(list.size()) + "]"));
    list.back().content = std::make_shared<const std::string>(test::file_content(path));
  }
  list.push_back(texture_of("no image"));
  list.back().content = std::make_shared<const std::string>("\x89PNG and then nothing");
  const ImageTextures textures(list);
  for (std::uint32_t i = 0; i < 6; i += 2) {
    const Color color = textures.color(i, {0.5f, 0.5f}, kNoChange, kNoChange);
    EXPECT_LT(color.x, 0.2f) << i;
    EXPECT_EQ(textures.color(i + 1, {0.5f, 0.5f}, kNoChange, kNoChange), color) << i;
  }
  EXPECT_EQ(textures.color(6, {0, 0}, kNoChange, kNoChange), (Color{1, 1, 1}));
  ASSERT_EQ(textures.warnings().size(), 1u);
  EXPECT_EQ(textures.warnings()[0].where.file, "no image");
}

/// The texture of the bytes of a file, and the file is gone.
Texture in_memory(const std::string& path) {
  Texture texture = texture_of("model.glb, images[0]");
  texture.content = std::make_shared<const std::string>(test::file_content(path));
  std::filesystem::remove(path);
  return texture;
}

// All pixels have their places and values. JPEG and WebP change them a little.
TEST(ImageTextures, PixelsOfImagesInMemory) {
  const TempDir dir;
  constexpr int kWidth = 24, kHeight = 16;
  Bytes pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (const int byte : {8 * x + 20, 12 * y + 20, 4 * (x + y) + 20})
        pixels.push_back(static_cast<std::uint8_t>(byte));
  std::string without;
  for (const auto& [name, most] : {std::pair{"a.png", 1e-6f}, {"a.jpg", 0.06f}, {"a.webp", 0.06f}}) {
    if (OIIO::ImageOutput::create(name) == nullptr) {
      without += std::string(" ") + name;
      continue;
    }
    const ImageTextures textures({in_memory(write_pixels(dir.file(name), kWidth, kHeight, 3, pixels))});
    EXPECT_TRUE(textures.warnings().empty()) << name;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Vec2f uv{(static_cast<float>(x) + 0.5f) / kWidth, 1 - (static_cast<float>(y) + 0.5f) / kHeight};
        const Vec3f stored = textures.normal(0, uv, kNoChange, kNoChange);
        const std::size_t at = 3 * static_cast<std::size_t>(y * kWidth + x);
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(stored[static_cast<int>(c)], static_cast<float>(pixels[at + c]) / 255, most)
              << name << " " << x << " " << y;
      }
  }
  if (!without.empty()) GTEST_SKIP() << "OpenImageIO cannot write" << without;
}

// Each warns and is white. Only PNG, JPEG and WebP may stand in memory.
TEST(ImageTextures, BrokenImagesInMemoryWarnAndAreWhite) {
  const TempDir dir;
  Bytes noise;
  std::mt19937 random(3);
  for (int i = 0; i < 64 * 64 * 3; ++i) noise.push_back(static_cast<std::uint8_t>(random()));
  std::vector<Texture> list;
  const auto add = [&](const std::string& content) {
    list.push_back(texture_of("model.glb, images[" + std::to_string(list.size()) + "]"));
    list.back().content = std::make_shared<const std::string>(content);
  };
  for (const char* name : {"a.png", "a.jpg", "a.webp"}) {
    if (OIIO::ImageOutput::create(name) == nullptr) continue;
    const std::string whole = test::file_content(write_pixels(dir.file(name), 64, 64, 3, noise));
    add(whole.substr(0, 12));
    add(whole.substr(0, 30));
    add(whole.substr(0, 12) + std::string(1000, '\x55'));
    add("x" + whole);
  }
  for (const char* name : {"a.bmp", "a.tif"})
    add(test::file_content(write_pixels(dir.file(name), 64, 64, 3, noise)));
  for (const char* text : {"", "x", "\x89PNG", "\xff\xd8\xff", "RIFF....WEBP", "RIFF....WAVE", "no image"})
    add(text);
  const ImageTextures textures(list);
  ASSERT_EQ(textures.warnings().size(), list.size());
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(textures.color(i, {0.2f, 0.2f}, kNoChange, kNoChange), (Color{1, 1, 1})) << i;
    const Warning& warning = textures.warnings()[i];
    EXPECT_EQ(warning.where.file, list[i].path);
    EXPECT_NE(warning.message.find("cannot read the image"), std::string::npos) << warning.message;
    EXPECT_EQ(warning.message.find('\n'), std::string::npos) << warning.message;
  }
}

TEST(ImageTextures, ScaleOffsetGainAndBase) {
  const TempDir dir;
  Texture moved = texture_of(checkers(dir));
  moved.scale = {2, 1, 1};
  moved.offset = {0.5f, 0, 0};
  moved.gain = 0.5f;
  moved.base = 0.25f;
  const ImageTextures textures({moved});
  // u = 0.125 looks at 0.75: white in the lower row.
  EXPECT_EQ(textures.color(0, {0.125f, 0.25f}, kNoChange, kNoChange), (Color{0.75f, 0.75f, 0.75f}));
  EXPECT_EQ(textures.color(0, {0.375f, 0.25f}, kNoChange, kNoChange), (Color{0.25f, 0.25f, 0.75f}));
  EXPECT_EQ(textures.value(0, {0.125f, 0.25f}, kNoChange, kNoChange), 0.75f);
}

// Filtering happens in linear light: a fine black and white pattern averages to one half, not to the light of
// 128.
TEST(ImageTextures, WideFootprintsAverageLight) {
  const TempDir dir;
  Bytes pixels;
  for (int i = 0; i < 64 * 64; ++i) pixels.insert(pixels.end(), 3, ((i % 64) + i / 64) % 2 == 0 ? 255 : 0);
  const ImageTextures textures({texture_of(write_pixels(dir.file("a.png"), 64, 64, 3, pixels))});
  const Color wide = textures.color(0, {0.4f, 0.6f}, {1, 0}, {0, 1});
  EXPECT_NEAR(wide.x, 0.5f, 0.01f);
  EXPECT_NEAR(textures.color(0, {0.4f, 0.6f}, {0.25f, 0}, {0, 0.25f}).y, 0.5f, 0.01f);
}

TEST(ImageTextures, MissingAndDamagedFilesWarnOnceAndAreWhite) {
  const TempDir dir;
  Bytes noise;
  std::mt19937 random(1);
  for (int i = 0; i < 64 * 64 * 3; ++i) noise.push_back(static_cast<std::uint8_t>(random()));
  const std::string cut = write_pixels(dir.file("cut.bmp"), 64, 64, 3, noise);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  // Its reader goes on behind the rows that are missing.
  const std::string rows = write_pixels(dir.file("rows.tif"), 64, 64, 3, noise);
  std::filesystem::resize_file(rows, std::filesystem::file_size(rows) / 2);
  Texture missing = texture_of(dir.file("missing.png"));
  missing.gain = 0.5f;
  const ImageTextures textures({missing, texture_of(dir.write("garbage.jpg", "no image")), texture_of(cut),
                                texture_of(checkers(dir)), missing, texture_of(dir.path().string()),
                                texture_of(dir.write("empty.png", "")), texture_of(""), texture_of(rows)});
  for (const std::uint32_t i : {0u, 1u, 2u, 4u, 5u, 6u, 7u, 8u, 99u, kNoId}) {
    EXPECT_EQ(textures.color(i, {0.2f, 0.2f}, kNoChange, kNoChange), (Color{1, 1, 1})) << i;
    EXPECT_EQ(textures.value(i, {0.2f, 0.2f}, kNoChange, kNoChange), 1) << i;
    EXPECT_EQ(textures.normal(i, {0.2f, 0.2f}, kNoChange, kNoChange), (Vec3f{0.5f, 0.5f, 1})) << i;
  }
  EXPECT_EQ(textures.color(3, {0.25f, 0.25f}, kNoChange, kNoChange), (Color{0, 0, 1}));
  // Readers clear the path of a texture that they have warned of.
  ASSERT_EQ(textures.warnings().size(), 6u);
  EXPECT_EQ(textures.warnings()[0].where.file, dir.file("missing.png"));
  EXPECT_NE(textures.warnings()[0].message.find("no such file"), std::string::npos);
  for (const Warning& warning : textures.warnings()) EXPECT_EQ(warning.message.find('\n'), std::string::npos);
}

// Paths hold no patterns: what the texture library reads as a tile set is a plain name here.
TEST(ImageTextures, PathsAreTakenLiterally) {
  const TempDir dir;
  const std::string path = write_pixels(dir.file("a<UDIM>.png"), 1, 1, 3, Bytes{0, 255, 0});
  const ImageTextures textures({texture_of(path)});
  EXPECT_TRUE(textures.warnings().empty());
  EXPECT_EQ(textures.color(0, {0.5f, 0.5f}, kNoChange, kNoChange), (Color{0, 1, 0}));
}

TEST(ImageTextures, AnyCoordinatesAreSafe) {
  const TempDir dir;
  Texture clamped = texture_of(checkers(dir));
  clamped.lookup = kClampedTexture;
  const ImageTextures textures({texture_of(checkers(dir)), clamped});
  const float inf = std::numeric_limits<float>::infinity();
  const float odd[] = {
      std::numeric_limits<float>::quiet_NaN(), inf, -inf, 3e38f, -3e38f, 1e-40f, -1e-40f, 16777217.0f};
  for (const float u : odd)
    for (const float v : odd)
      for (const std::uint32_t i : {0u, 1u}) {
        const Color c = textures.color(i, {u, v}, {v, u}, {u, 0});
        EXPECT_TRUE(is_finite(c)) << u << " " << v;
        EXPECT_TRUE(c.x >= 0 && c.x <= 1);
      }
}

// The same lookups in another order, from many threads and in a fresh cache, give the same bits.
TEST(ImageTextures, OthersDoNotShowThrough) {
  // The cache uses its entries again, here also for files of other sizes and types and for damaged ones.
  const TempDir dir;
  std::vector<std::string> files;
  for (int k = 0; k < 8; ++k) {
    const int side = 1 + 37 * k % 90;
    const std::uint8_t grey = static_cast<std::uint8_t>(20 + 30 * k);
    const std::size_t count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    files.push_back(write_pixels(dir.file(std::to_string(k) + (k % 2 == 0 ? ".png" : ".tif")), side, side, 1,
                                 Bytes(count, grey)));
  }
  const std::string damaged = dir.write("damaged.png", "nothing");
  tbb::parallel_for(0, 400, [&](int i) {
    const int k = i % 8;
    std::vector<Texture> list = {texture_of(files[static_cast<std::size_t>(k)])};
    if (i % 3 == 0) list.insert(list.begin(), texture_of(damaged));
    if (i % 5 == 0) list.push_back(texture_of(files[static_cast<std::size_t>((k + 1) % 8)]));
    const ImageTextures textures(list);
    ASSERT_EQ(textures.warnings().size(), i % 3 == 0 ? 1u : 0u);
    const std::uint32_t at = i % 3 == 0 ? 1 : 0;
    for (const float width : {0.0f, 0.01f, 0.9f}) {
      const Vec2f dx{width, 0}, dy{0, width};
      ASSERT_NEAR(textures.value(at, {0.4f, 0.6f}, dx, dy), float(20 + 30 * k) / 255, 1e-3f) << i;
      if (i % 5 != 0) continue;
      const int next = (k + 1) % 8;
      ASSERT_NEAR(textures.value(at + 1, {0.4f, 0.6f}, dx, dy), float(20 + 30 * next) / 255, 1e-3f);
    }
  });
}

TEST(ImageTextures, MemoryIsFreed) {
  if (test::kSanitized)
    GTEST_SKIP() << "sanitizers have an allocator of their own, and find leaks by themselves";
  const TempDir dir;
  const std::vector<Texture> list = {texture_of(checkers(dir)),
                                     texture_of(dir.write("damaged.png", "nothing"))};
  const auto allocated = [] { return mallinfo2().uordblks; };
  for (int i = 0; i < 100; ++i) ImageTextures{list};
  const std::size_t before = allocated();
  for (int i = 0; i < 500; ++i) ImageTextures{list};
  // One leaked object per image would be more.
  EXPECT_LT(allocated(), before + 500 * 32);
}

TEST(ImageTextures, ResultsDependOnArgumentsAlone) {
  const TempDir dir;
  Bytes noise;
  std::mt19937 random(1);
  for (int i = 0; i < 67 * 45 * 3; ++i) noise.push_back(static_cast<std::uint8_t>(random()));
  const std::vector<Texture> list = {texture_of(write_pixels(dir.file("a.png"), 67, 45, 3, noise))};
  struct Query {
    Vec2f uv, dx, dy;
  };
  std::uniform_real_distribution<float> place(-2, 2);
  std::vector<Query> queries(4000);
  for (Query& q : queries) {
    const float size = std::exp2(4 * place(random) - 4);
    q = {{place(random), place(random)}, {size, size * place(random)}, {size * place(random), size}};
  }
  std::vector<Color> expected(queries.size()), parallel(queries.size()), backwards(queries.size());
  const ImageTextures first(list), second(list), third(list);
  const auto ask = [&](const ImageTextures& textures, std::size_t i) {
    return textures.color(0, queries[i].uv, queries[i].dx, queries[i].dy);
  };
  for (std::size_t i = 0; i < queries.size(); ++i) expected[i] = ask(first, i);
  for (std::size_t i = queries.size(); i-- > 0;) backwards[i] = ask(second, i);
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t i) { parallel[i] = ask(third, i); });
  EXPECT_EQ(expected, backwards);
  EXPECT_EQ(expected, parallel);
}

}  // namespace
}  // namespace oktett::texture_test
