// What the command's image files hold.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::render_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandProcess;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::file_count;
using test::kBall;
using test::run_command;
using test::TempDir;

OIIO::ImageSpec header(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  EXPECT_TRUE(input) << path << ": " << OIIO::geterror();
  return input ? input->spec() : OIIO::ImageSpec{};
}

TEST(RenderCommandFiles, WritesThePictureAndTellsTimes) {
  const TempDir dir;
  fs::create_directory(dir.path() / "scenes");
  dir.write("scenes/ball.yaml", kBall);
  const CommandResult result = run_command(dir, {"render", "scenes/ball.yaml"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* word : {"load", "build", "render", "rays/s", "write", "wrote ball.png"})
    EXPECT_TRUE(contains(result.out, word)) << word << "\n" << result.out;
  const OIIO::ImageSpec spec = header(dir.file("ball.png"));
  EXPECT_EQ(spec.width, 16);
  EXPECT_EQ(spec.height, 12);
  EXPECT_EQ(file_count(dir), 2u);
}

TEST(RenderCommandFiles, OptionsOverrideTheScene) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult result = run_command(
      dir, {"render", "ball.yaml", "--size", "40x20", "--cropwindow", "0.25,0.5,0,0.5", "--spp", "3",
            "--seed", "7", "--integrator", "normal", "--isa", "scalar", "-t", "1", "-o", "a.exr", "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const OIIO::ImageSpec spec = header(dir.file("a.exr"));
  EXPECT_EQ(spec.full_width, 40);
  EXPECT_EQ(spec.full_height, 20);
  EXPECT_EQ(spec.x, 10);
  EXPECT_EQ(spec.y, 0);
  EXPECT_EQ(spec.width, 10);
  EXPECT_EQ(spec.height, 10);
  EXPECT_EQ(spec.get_int_attribute("samples"), 3);
  EXPECT_EQ(spec.get_string_attribute("scene"), "ball.yaml");
  EXPECT_EQ(spec.get_string_attribute("Software").substr(0, 7), "oktett ");
  EXPECT_EQ(spec.get_string_attribute("commandLine").substr(0, 23), "oktett render ball.yaml");
  EXPECT_NE(spec.find_attribute("worldToCamera"), nullptr);
  EXPECT_GE(spec.channelindex("Z"), 0);
  EXPECT_GE(spec.channelindex("primID.I"), 0);
}

TEST(RenderCommandFiles, FilmOptionsOverrideTheScene) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult result = run_command(
      dir, {"render",    "ball.yaml", "--size",     "16x16", "--spp",   "4",      "--filter", "tent",
            "--tone",    "filmic",    "--exposure", "-1.5",  "--clamp", "3",      "--error",  "0.1",
            "--max-spp", "16",        "--denoise",  "-o",    "a.exr",   "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  const std::vector<std::string> names = header(dir.file("a.exr")).channelnames;
  for (const char* name : {"sampleCount.I", "Noisy.R"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  // A picture without layers is denoised, too.
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--size", "8x8", "--denoise", "-o", "a.png"}).status, 0);
  const auto error = [&](const char* option, const char* value) {
    const CommandResult bad = run_command(dir, {"render", "ball.yaml", option, value});
    EXPECT_EQ(bad.status, 2);
    return bad.err;
  };
  EXPECT_NE(error("--filter", "tend").find("--filter: unknown kind 'tend'; did you mean 'tent'?"),
            std::string::npos);
  EXPECT_NE(error("--tone", "x").find("expected srgb, filmic, aces, neutral or raw"), std::string::npos);
  EXPECT_NE(error("--exposure", "bright").find("--exposure: 'bright' is no number"), std::string::npos);
  EXPECT_NE(error("--exposure", "inf").find("--exposure: inf is out of range"), std::string::npos);
  EXPECT_NE(error("--error", "1.5").find("--error: 1.5 is out of range; expected 0 to 1"), std::string::npos);
  EXPECT_NE(error("--max-spp", "0").find("--max-spp: 0 is out of range"), std::string::npos);
  EXPECT_NE(error("--clamp", "-1").find("--clamp: -1 is out of range"), std::string::npos);
}

// A reader that knows nothing but the specification: it finds the layer by its attributes, the id of a name
// in the manifest, and adds up the coverage of that id.
TEST(RenderCommandFiles, CryptomatteCanBeReadByOthers) {
  const TempDir dir;
  dir.write("ball.yaml",
            "oktett: 1\ncamera: {projection: orthographic, height: 2}\nobjects:\n"
            "  - box: {min: [0, -2, -1], max: [2, 2, 1]}\n    name: half\n");
  ASSERT_EQ(run_command(dir, {"render", "ball.yaml", "--size", "1x1", "--spp", "16", "--cryptomatte", "-o",
                              "a.exr", "--quiet"})
                .status,
            0);
  const auto image = OIIO::ImageInput::open(dir.file("a.exr"));
  ASSERT_TRUE(image);
  const OIIO::ImageSpec& spec = image->spec();
  std::string key;
  for (const OIIO::ParamValue& p : spec.extra_attribs)
    if (p.name().string().starts_with("cryptomatte/") && p.get_string() == "CryptoObject")
      key = p.name().string().substr(0, p.name().string().rfind('/') + 1);
  ASSERT_EQ(key.size(), 20u);
  EXPECT_EQ(spec.get_string_attribute(key + "hash"), "MurmurHash3_32");
  EXPECT_EQ(spec.get_string_attribute(key + "conversion"), "uint32_to_float32");
  const std::string manifest = spec.get_string_attribute(key + "manifest");
  const std::size_t at = manifest.find("\"half\":\"");
  ASSERT_NE(at, std::string::npos) << manifest;
  const auto bits = static_cast<std::uint32_t>(std::stoul(manifest.substr(at + 8, 8), nullptr, 16));
  std::vector<float> pixel(static_cast<std::size_t>(spec.nchannels));
  ASSERT_TRUE(image->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixel.data()));
  const auto channel = [&](const std::string& name) {
    return pixel[static_cast<std::size_t>(spec.channelindex(name))];
  };
  float covered = 0;
  for (const char* rank : {"CryptoObject00.", "CryptoObject01.", "CryptoObject02."})
    for (const char* pair : {"RG", "BA"})
      if (std::bit_cast<std::uint32_t>(channel(std::string(rank) + pair[0])) == bits)
        covered += channel(std::string(rank) + pair[1]);
  EXPECT_EQ(covered, 0.5f);
}

std::vector<float> pixels(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  EXPECT_TRUE(input) << path;
  if (!input) return {};
  std::vector<float> values(static_cast<std::size_t>(input->spec().image_pixels()) *
                            static_cast<std::size_t>(input->spec().nchannels));
  EXPECT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, values.data()));
  return values;
}

TEST(RenderCommandFiles, ThePhotonMapIsWrittenOnceAndThenRead) {
  const TempDir dir;
  dir.write("ball.yaml", std::string(kBall) +
                             "    material: {transparency: 1}\n"
                             "  - plane: {normal: [0, 1, 0], offset: -1}\n"
                             "lights:\n"
                             "  - point: {position: [2, 4, 1], intensity: [90, 90, 90]}\n");
  const std::vector<std::string> first{"render",       "ball.yaml", "--integrator", "path",
                                       "--photon-map", "p.map",     "-o",           "a.exr"};
  std::vector<std::string> again = first;
  again.back() = "b.exr";
  CommandResult result = run_command(dir, first);
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string map = file_content(dir.file("p.map"));
  EXPECT_FALSE(map.empty());
  result = run_command(dir, again);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(file_content(dir.file("p.map")), map);
  EXPECT_EQ(pixels(dir.file("a.exr")), pixels(dir.file("b.exr")));
  again.insert(again.end(), {"--seed", "3"});
  result = run_command(dir, again);
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "p.map: ")) << result.err;
  EXPECT_TRUE(contains(result.err, "it has seed 0, the scene wants 3")) << result.err;
  dir.write("p.map", "no photons");
  result = run_command(dir, first);
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "p.map: is not a photon map of version 3")) << result.err;
  result = run_command(dir, {"render", "ball.yaml", "--caustics"});
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "--caustics needs the integrator 'path'")) << result.err;
}

/// A render that takes minutes unless it is stopped, in steps much shorter than a second.
std::vector<std::string> long_render() {
  return {"render", "ball.yaml", "--size", "2048x2048", "--spp", "256", "--progress", "-o", "long.png"};
}

TEST(RenderCommandFiles, TheFirstSignalWritesWhatIsFinished) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    CommandProcess process(dir, long_render());
    ASSERT_TRUE(process.wait_for_err("%", 60)) << process.err();
    process.send(signal);
    EXPECT_EQ(process.wait(), 128 + signal);
    const char* name = signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : "SIGHUP";
    EXPECT_TRUE(contains(process.err(), std::string("stopped by ") + name)) << process.err();
    EXPECT_TRUE(contains(process.err(), "% of the picture is finished")) << process.err();
    EXPECT_TRUE(contains(process.out(), "wrote long.png"));
    EXPECT_EQ(header(dir.file("long.png")).width, 2048);
    EXPECT_EQ(file_count(dir), 2u);
    fs::remove(dir.file("long.png"));
  }
}

}  // namespace
}  // namespace oktett::render_command_test
