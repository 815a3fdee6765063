// The picture that `render --show` prints on a terminal is that of the PNG file.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/run_on_terminal.h"
#include "tests/support/temp_dir.h"
#include "tests/support/terminal_pictures.h"

namespace oktett::show_command_test {
namespace {

using test::CommandProcess;
using test::CommandResult;
using test::contains;
using test::file_count;
using test::run_command;
using test::run_on_terminal;
using test::ShownPicture;
using test::TempDir;
using test::TerminalResult;
using test::TerminalSetting;

/// A ball, whose brightness varies, on a blue background; 96 by 64 pixels.
constexpr const char* kScene =
    "oktett: 1\n"
    "film: {width: 96, height: 64, tone: filmic}\n"
    "integrator: {samples: 4}\n"
    "background: [0.1, 0.3, 0.6]\n"
    "camera: {from: [0, 0, 5], at: [0, 0, 0]}\n"
    "lights:\n"
    "  - directional: {direction: [-1, -1, -1], color: [3, 2, 1]}\n"
    "objects:\n"
    "  - sphere: {radius: 1.5}\n"
    "    material: {color: [0.8, 0.7, 0.2]}\n";

/// The 8-bit pixels of an image file; a missing A is 255.
ShownPicture read_file(const std::string& path) {
  ShownPicture picture;
  OIIO::ImageSpec wanted;
  wanted["oiio:UnassociatedAlpha"] = 1;
  const auto input = OIIO::ImageInput::open(path, &wanted);
  EXPECT_TRUE(input) << path << OIIO::geterror();
  if (!input) return picture;
  const int channels = input->spec().nchannels;
  picture.width = input->spec().width, picture.height = input->spec().height;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(input->spec().image_pixels()) *
                                  static_cast<std::size_t>(channels));
  EXPECT_TRUE(input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, bytes.data()));
  for (std::size_t i = 0; i < bytes.size(); i += static_cast<std::size_t>(channels))
    for (int k = 0; k < 4; ++k)
      picture.rgba.push_back(k < channels ? bytes[i + static_cast<std::size_t>(k)] : 255);
  return picture;
}

/// The average of a channel in a rectangle of pixels.
double average(const ShownPicture& picture, int channel, int x0, int y0, int width, int height) {
  double sum = 0;
  for (int y = y0; y < y0 + height; ++y)
    for (int x = x0; x < x0 + width; ++x) sum += picture.pixel(x, y)[channel];
  return sum / width / height;
}

/// The greatest difference of the averages of `a` in blocks of `size` pixels from those of `b` in blocks
/// `times` as large.
double difference(const ShownPicture& a, const ShownPicture& b, int size, int times = 1) {
  double most = 0;
  for (int y = 0; y + size <= a.height; y += size)
    for (int x = 0; x + size <= a.width; x += size)
      for (int k = 0; k < 4; ++k)
        most = std::max(most, std::abs(average(a, k, x, y, size, size) -
                                       average(b, k, x * times, y * times, size * times, size * times)));
  return most;
}

class Show : public testing::Test {
 protected:
  void SetUp() override {
#ifndef OKTETT_HAVE_CHAFA
    GTEST_SKIP() << "this build has no chafa";
#endif
    dir.write("a.yaml", kScene);
    if (!run_on_terminal(dir, {"--version"}).there) GTEST_SKIP() << "there are no terminals here";
  }

  /// `oktett render a.yaml WORDS` on a terminal.
  TerminalResult render(const std::vector<std::string>& words, const TerminalSetting& setting = {}) {
    std::vector<std::string> all{"render", "a.yaml"};
    all.insert(all.end(), words.begin(), words.end());
    return run_on_terminal(dir, all, setting);
  }

  static TerminalSetting named(std::vector<std::string> environment) {
    TerminalSetting setting;
    setting.environment = {"TERM_PROGRAM", "LC_TERMINAL", "COLORTERM", "KONSOLE_VERSION"};
    setting.environment.insert(setting.environment.end(), environment.begin(), environment.end());
    return setting;
  }

  TempDir dir;
};

TEST_F(Show, KittyGetsThePixelsOfThePng) {
  const TerminalResult result = render({"--show=kitty"});
  ASSERT_EQ(result.status, 0) << result.text;
  const auto shown = test::find_kitty(result.text);
  ASSERT_TRUE(shown) << result.text;
  const ShownPicture png = read_file(dir.file("a.png"));
  EXPECT_EQ(shown->width, 96);
  EXPECT_EQ(shown->height, 64);
  EXPECT_EQ(shown->columns, 12);
  EXPECT_EQ(shown->rows, 4);
  EXPECT_EQ(shown->rgba, png.rgba);
  // The times and the name of the file follow.
  EXPECT_GT(result.text.find("wrote a.png"), result.text.find("\x1b_G"));
}

TEST_F(Show, ItermGetsThePixelsOfThePng) {
  const TerminalResult result = render({"--show=iterm"});
  ASSERT_EQ(result.status, 0) << result.text;
  const std::string file = test::find_iterm(result.text);
  ASSERT_FALSE(file.empty()) << result.text;
  EXPECT_TRUE(contains(result.text, "width=12;height=4;")) << result.text.substr(0, 200);
  dir.write("shown.tif", file);
  EXPECT_EQ(read_file(dir.file("shown.tif")).rgba, read_file(dir.file("a.png")).rgba);
}

// Sixels have 256 colours.
TEST_F(Show, SixelsAreNearThePixelsOfThePng) {
  const TerminalResult result = render({"--show=sixel"});
  ASSERT_EQ(result.status, 0) << result.text;
  auto shown = test::find_sixel(result.text);
  ASSERT_TRUE(shown) << result.text;
  const ShownPicture png = read_file(dir.file("a.png"));
  // Whole rows of six pixels, the last two of which are free.
  ASSERT_EQ(shown->width, 96);
  ASSERT_EQ(shown->height, 66);
  for (int x = 0; x < 96; ++x) EXPECT_EQ(shown->pixel(x, 64)[3], 0);
  shown->height = 64;
  EXPECT_LT(difference(*shown, png, 1), 48);
  EXPECT_LT(difference(*shown, png, 4), 8);
}

// A cell of 96 columns is a pixel wide and two high, two colours a cell.
TEST_F(Show, BlocksHaveTheAveragesOfTheirCells) {
  TerminalSetting setting = named({"TERM=xterm-256color", "COLORTERM=truecolor"});
  setting.columns = 48, setting.rows = 20;
  const TerminalResult result = render({"--show=blocks"}, setting);
  ASSERT_EQ(result.status, 0) << result.text;
  const auto shown = test::find_blocks(result.text);
  ASSERT_TRUE(shown) << result.text;
  // Two pixels of the picture for a column, four for a row: 16 rows at most, as many as there are.
  ASSERT_EQ(shown->columns, 48);
  ASSERT_EQ(shown->rows, 16);
  const ShownPicture png = read_file(dir.file("a.png"));
  double most = 0;
  for (int row = 0; row < shown->rows; ++row)
    for (int column = 0; column < shown->columns; ++column)
      for (int k = 0; k < 4; ++k)
        most = std::max(most, std::abs(average(*shown, k, 2 * column, 2 * row, 2, 2) -
                                       average(png, k, 2 * column, 4 * row, 2, 4)));
  EXPECT_LE(most, 3);
}

TEST_F(Show, SmallPicturesAreNotEnlarged) {
  const TerminalSetting setting = named({"TERM=xterm-256color", "COLORTERM=truecolor"});
  const auto blocks = test::find_blocks(render({"--show=blocks", "--size", "10x7"}, setting).text);
  ASSERT_TRUE(blocks);
  EXPECT_EQ(blocks->columns, 10);
  EXPECT_EQ(blocks->rows, 4);
  const ShownPicture png = read_file(dir.file("a.png"));
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 10; ++x)
      for (int k = 0; k < 4; ++k) ASSERT_NEAR(blocks->pixel(2 * x, y)[k], png.pixel(x, y)[k], 1) << x << y;
  // Half of the last row of cells is left free.
  for (int x = 0; x < 20; ++x) EXPECT_EQ(blocks->pixel(x, 7)[3], 0);

  const auto kitty = test::find_kitty(render({"--show=kitty", "--size", "10x7"}, setting).text);
  ASSERT_TRUE(kitty);
  EXPECT_EQ(kitty->columns, 2);
  EXPECT_EQ(kitty->rows, 1);
  for (int y = 0; y < kitty->height; ++y)
    for (int x = 0; x < kitty->width; ++x) EXPECT_EQ(kitty->pixel(x, y)[3], x < 10 && y < 7 ? 255 : 0);
}

TEST_F(Show, LargePicturesFitIntoTheTerminal) {
  TerminalSetting setting;
  setting.columns = 12, setting.rows = 30;
  const auto wide = test::find_kitty(render({"--show=kitty", "--size", "384x256"}, setting).text);
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->columns, 12);
  EXPECT_EQ(wide->rows, 4);
  EXPECT_LT(difference(*wide, read_file(dir.file("a.png")), 1, 4), 0.6);
  setting.columns = 200, setting.rows = 6;
  const auto high = test::find_kitty(render({"--show=kitty", "--size", "96x64"}, setting).text);
  ASSERT_TRUE(high);
  EXPECT_EQ(high->columns, 6);
  EXPECT_EQ(high->rows, 2);
}

TEST_F(Show, TheTerminalSaysWhatItCanDo) {
  const auto text = [&](std::vector<std::string> environment) {
    const TerminalResult result = render({"--show", "--quiet", "--no-output"}, named(std::move(environment)));
    EXPECT_EQ(result.status, 0) << result.text;
    return result.text;
  };
  EXPECT_TRUE(test::find_kitty(text({"TERM=xterm-kitty"})));
  EXPECT_NE(test::find_iterm(text({"TERM=xterm-256color", "TERM_PROGRAM=iTerm.app"})), "");
  EXPECT_TRUE(test::find_sixel(text({"TERM=foot", "COLORTERM=truecolor"})));
  const std::string direct = text({"TERM=xterm-256color", "COLORTERM=truecolor"});
  EXPECT_TRUE(test::find_blocks(direct)) << direct;
  EXPECT_TRUE(contains(direct, "8;2;")) << direct;
  const std::string indexed = text({"TERM=xterm"});
  EXPECT_TRUE(test::find_blocks(indexed)) << indexed;
  EXPECT_TRUE(contains(indexed, "8;5;")) << indexed;
  EXPECT_FALSE(contains(indexed, "8;2;")) << indexed;
  // Multiplexers show no pictures of the terminal around them.
  EXPECT_TRUE(test::find_blocks(text({"TERM=screen-256color", "LC_TERMINAL=iTerm2"})));
  EXPECT_EQ(file_count(dir), 1u);
}

TEST_F(Show, DumbTerminalsAreRefused) {
  for (const char* kind : {"TERM=dumb", "TERM"}) {
    const TerminalResult result = render({"--show"}, named({kind}));
    EXPECT_EQ(result.status, 2);
    EXPECT_TRUE(contains(result.text, "oktett: --show: a terminal with TERM=")) << result.text;
  }
}

TEST_F(Show, WithoutATerminalAFormatIsNeeded) {
  const CommandResult none = run_command(dir, {"render", "missing.yaml", "--show"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.err,
            "oktett: --show: standard output is no terminal; --show=FORMAT prints to it all the same\n");
  const CommandResult forced =
      run_command(dir, {"render", "a.yaml", "--show=kitty", "--no-output", "--quiet"});
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_TRUE(test::find_kitty(forced.out)) << forced.out;
}

// Standard output is for the JSON object alone.
TEST_F(Show, ThePictureGoesWhereTheSummaryGoes) {
  TerminalSetting setting;
  setting.out = false;
  const TerminalResult result = render({"--show=kitty", "--stats=json"}, setting);
  EXPECT_EQ(result.status, 0) << result.text;
  EXPECT_TRUE(test::find_kitty(result.text)) << result.text;
  EXPECT_EQ(result.other.front(), '{');
  EXPECT_EQ(std::count(result.other.begin(), result.other.end(), '\n'), 1);
  EXPECT_FALSE(contains(result.other, "\x1b"));
}

TEST_F(Show, PicturesWithoutAFileAreDenoisedToo) {
  ASSERT_EQ(render({"--denoise"}).status, 0);
  const auto shown = test::find_kitty(render({"--denoise", "--no-output", "--show=kitty"}).text);
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->rgba, read_file(dir.file("a.png")).rgba);
}

TEST_F(Show, ResumedPicturesAreShownIfAskedFor) {
  ASSERT_EQ(render({"--show=kitty", "--checkpoint", "a.film"}).status, 0);
  const CommandResult silent = run_command(dir, {"render", "--resume", "a.film"});
  EXPECT_EQ(silent.status, 0) << silent.err;
  EXPECT_FALSE(contains(silent.out, "\x1b"));
  EXPECT_TRUE(test::find_kitty(run_command(dir, {"render", "--resume", "a.film", "--show=kitty"}).out));
}

TEST_F(Show, UnknownFormats) {
  const CommandResult result = run_command(dir, {"render", "missing.yaml", "--show=sixels"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, "oktett: --show: unknown format 'sixels'; did you mean 'sixel'?\n");
  EXPECT_TRUE(contains(run_command(dir, {"render", "a.yaml", "--show=png"}).err,
                       "unknown format 'png'; expected kitty, iterm, sixel or blocks"));
}

/// A program that was copied without the libraries of its installation says where it looked for them.
TEST_F(Show, MissingLibraries) {
  const std::filesystem::path bin = dir.path() / "bin", program = bin / "oktett";
  std::filesystem::create_directory(bin);
  std::filesystem::copy_file(OKTETT_COMMAND, program);
  CommandProcess process(dir, {"render", "a.yaml", "--no-output", "--show=blocks"}, program.string());
  EXPECT_EQ(process.wait(), 1);
  const std::string error = process.err();
  EXPECT_TRUE(contains(error, "cannot load liboktett_terminal.so")) << error;
  EXPECT_TRUE(contains(error, "it is neither in " + (dir.path() / "lib").string() + " nor in ")) << error;
}

TEST_F(Show, WhatIsFinishedWhenTimeIsUp) {
  const CommandResult result = run_command(dir, {"render", "a.yaml", "--size", "1024x1024", "--spp", "4096",
                                                 "--timeout", "0.5", "--show=kitty", "--quiet"});
  EXPECT_EQ(result.status, 124) << result.err;
  EXPECT_TRUE(test::find_kitty(result.out));
}

#ifndef OKTETT_HAVE_CHAFA
TEST(ShowWithoutChafa, NamesThePackage) {
  const TempDir dir;
  const CommandResult result = run_command(dir, {"render", "missing.yaml", "--show=blocks"});
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "libchafa-dev")) << result.err;
}
#endif

}  // namespace
}  // namespace oktett::show_command_test
