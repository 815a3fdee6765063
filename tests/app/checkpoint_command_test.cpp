/// \file Pictures that are rendered in several runs of the command: checkpoints, shares, added samples.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <filesystem>
#include <random>
#include <thread>

#include "io/film/film_file.h"
#include "io/image/image.h"
#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::checkpoint_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandProcess;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::file_count;
using test::run_command;
using test::TempDir;
using Words = std::vector<std::string>;

constexpr const char* kScene =
    "oktett: 1\n"
    "params: {x: 0}\n"
    "film: {width: 80, height: 60}\n"
    "integrator: {kind: path, samples: 4}\n"
    "camera: {from: [0, 2, 6], at: [0, 0, 0]}\n"
    "materials: {mirror: {reflection: 1, diffuse: 0}}\n"
    "lights: [{point: {position: [3, 5, 4], light_group: key}}]\n"
    "objects:\n"
    "  - {sphere: {radius: 1}, material: mirror}\n"
    "  - {sphere: {radius: 0.1}, name: '${x}'}\n"
    "  - plane: {normal: [0, 1, 0], offset: -1}\n";

/// The first plane in which two picture files differ by a bit; empty: none.
std::string difference(const TempDir& dir, const std::string& a, const std::string& b) {
  const Picture p = read_image(dir.file(a)), q = read_image(dir.file(b));
  if (p.planes.size() != q.planes.size()) return "the number of planes";
  for (std::size_t k = 0; k < p.planes.size(); ++k) {
    const auto same = [](float x, float y) { return std::bit_cast<int>(x) == std::bit_cast<int>(y); };
    const Column<float>&x = p.planes[k].values, &y = q.planes[k].values;
    if (!std::equal(x.begin(), x.end(), y.begin(), y.end(), same)) return p.planes[k].name;
    const Column<std::uint32_t>&i = p.planes[k].ids, &j = q.planes[k].ids;
    if (!std::equal(i.begin(), i.end(), j.begin(), j.end())) return p.planes[k].name;
  }
  return "";
}

class CheckpointCommand : public testing::Test {
 protected:
  CheckpointCommand() { dir_.write("a.yaml", kScene); }

  CommandResult run(const Words& words) const { return run_command(dir_, words); }
  void expect_success(const Words& words) const {
    const CommandResult result = run(words);
    EXPECT_EQ(result.status, 0) << words.back() << "\n" << result.err;
    EXPECT_EQ(result.err, "");
  }
  /// One line that holds `message`.
  void expect_failure(const Words& words, int status, const std::string& message) const {
    const CommandResult result = run(words);
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_TRUE(contains(result.err, message)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  TempDir dir_;
};

TEST_F(CheckpointCommand, FinishedPicturesAreMadeAgain) {
  expect_success({"render", "a.yaml", "-o", "a.exr"});
  expect_success({"render", "a.yaml", "-o", "b.exr", "--checkpoint", "c.film", "--every", "0.01"});
  fs::rename(dir_.path() / "b.exr", dir_.path() / "old.exr");
  expect_success({"render", "--resume", "c.film"});
  EXPECT_EQ(difference(dir_, "a.exr", "old.exr"), "");
  EXPECT_EQ(difference(dir_, "a.exr", "b.exr"), "");
  // Only the tone of 8-bit pictures may be another one.
  expect_success({"render", "--resume", "c.film", "-o", "b.png", "--exposure", "1", "-t", "1"});
  expect_success({"render", "a.yaml", "-o", "a.png", "--exposure", "1"});
  EXPECT_EQ(difference(dir_, "a.png", "b.png"), "");
  EXPECT_EQ(file_count(dir_), 7u);
}

TEST_F(CheckpointCommand, SharesOfAllKindsMakeTheBitsOfOneRun) {
  const Words kinds[] = {{"--spp", "3"},
                         {"--error", "0.05", "--max-spp", "16"},
                         {"--caustics", "--spp", "2"},
                         {"--integrator", "whitted", "--cryptomatte", "--cropwindow", "0.1,0.9,0,0.7"}};
  for (const Words& kind : kinds) {
    const auto with = [&](Words words) {
      words.insert(words.end(), kind.begin(), kind.end());
      return words;
    };
    expect_success(with({"render", "a.yaml", "-o", "whole.exr"}));
    Words films;
    for (const char* k : {"1", "2", "3", "4", "5", "6", "7"}) {
      films.push_back(std::string(k) + ".film");
      expect_success(with({"render", "a.yaml", "-o", films.back(), "--shard", std::string(k) + "/7"}));
    }
    std::mt19937 random(7);
    for (int round = 0; round < 2; ++round) {
      std::shuffle(films.begin(), films.end(), random);
      Words words{"merge", "-o", "merged.exr"};
      words.insert(words.end(), films.begin(), films.end());
      expect_success(words);
      EXPECT_EQ(difference(dir_, "whole.exr", "merged.exr"), "") << kind.front();
    }
  }
}

TEST_F(CheckpointCommand, MergedPicturesAreDenoisedAndToned) {
  const Words options{"--denoise", "--tone", "aces"};
  Words render{"render", "a.yaml", "-o", "whole.png"},
      merge{"merge", "1.film", "a-2-of-2.film", "-o", "b.png"};
  render.insert(render.end(), options.begin(), options.end());
  merge.insert(merge.end(), options.begin(), options.end());
  expect_success(render);
  expect_success({"render", "a.yaml", "--shard", "1/2", "-o", "1.film"});
  expect_success({"render", "a.yaml", "--shard", "2/2"});
  expect_success(merge);
  EXPECT_EQ(difference(dir_, "whole.png", "b.png"), "");
}

TEST_F(CheckpointCommand, SharesThatDoNotFitAreRefused) {
  for (const char* k : {"1", "2", "3"})
    expect_success({"render", "a.yaml", "--shard", std::string(k) + "/3", "-o", std::string(k) + ".film"});
  expect_success({"render", "a.yaml", "--shard", "2/3", "-o", "spp.film", "--spp", "5"});
  expect_success({"render", "a.yaml", "--shard", "2/3", "-o", "more.film", "--add-spp", "5"});
  expect_success({"render", "a.yaml", "--shard", "2/4", "-o", "four.film"});
  dir_.write("a.yaml", kScene + std::string("# other\n"));
  expect_success({"render", "a.yaml", "--shard", "2/3", "-o", "other.film"});
  dir_.write("a.png", "old");
  expect_failure({"merge", "1.film", "3.film", "-o", "a.png"}, 2, "share 2/3 is missing");
  expect_failure({"merge", "3.film", "-o", "a.png"}, 2, "share 1/3 and 1 others are missing");
  expect_failure({"merge", "1.film", "2.film", "3.film", "2.film", "-o", "a.png"}, 2,
                 "2.film: is share 2/3, as '2.film' is");
  expect_failure({"merge", "1.film", "spp.film", "3.film", "-o", "a.png"}, 2,
                 "spp.film: does not belong to '1.film': --spp is 4 there and 5 here");
  expect_failure({"merge", "1.film", "more.film", "3.film", "-o", "a.png"}, 2,
                 "--add-spp is 0 there and 5 here");
  expect_failure({"merge", "1.film", "four.film", "3.film", "-o", "a.png"}, 2,
                 "it is one of 3 shares there and of 4 here");
  expect_failure({"merge", "1.film", "other.film", "3.film", "-o", "a.png"}, 2,
                 "the file 'a.yaml' has another content");
  expect_failure({"merge", "1.film", "a.yaml", "-o", "a.png"}, 2, "a.yaml: is not a film of version 2");
  expect_failure({"merge", "1.film", "none.film", "-o", "a.png"}, 1, "none.film: cannot read");
  expect_failure({"merge", "1.film"}, 2, "expected -o FILE");
  EXPECT_EQ(file_content(dir_.file("a.png")), "old");

  const CommandResult some = run({"merge", "1.film", "3.film", "-o", "some.exr", "--allow-missing"});
  EXPECT_EQ(some.status, 0);
  EXPECT_TRUE(contains(some.err, "tiles are missing and transparent")) << some.err;
  const Picture picture = read_image(dir_.file("some.exr"));
  const FilmFile share = read_film(dir_.file("2.film"));
  std::size_t seen = 0;
  for (std::size_t i = 0; i < share.film->tile_count(); ++i) {
    const FinishedTile tile = share.film->tile(i);
    const std::size_t at = std::size_t{tile.y + tile.height - 1} * picture.width + tile.x;
    if (share.film->in_share(i)) {
      EXPECT_EQ(picture.find("A")->values[at], 0.0f) << i;
      EXPECT_EQ(picture.find("R")->values[at], 0.0f) << i;
    }
    seen += picture.find("A")->values[at] > 0 ? 1 : 0;
  }
  EXPECT_GT(seen, 0u);
}

TEST_F(CheckpointCommand, SamplesAreAdded) {
  expect_success({"render", "a.yaml", "-o", "a.exr", "--checkpoint", "c.film"});
  expect_success({"render", "--resume", "c.film", "--add-spp", "4"});
  expect_success({"render", "--resume", "c.film", "--add-spp", "8"});
  expect_success({"render", "a.yaml", "-o", "b.exr", "--spp", "16"});
  EXPECT_EQ(difference(dir_, "a.exr", "b.exr"), "");
  expect_success({"render", "a.yaml", "-o", "c.exr", "--add-spp", "12"});
  EXPECT_EQ(difference(dir_, "a.exr", "c.exr"), "");
}

TEST_F(CheckpointCommand, AnotherSceneIsRefused) {
  dir_.write("part.yaml", "objects: [{sphere: {radius: 0.5}}]\n");
  expect_success({"render", "a.yaml", "-o", "a.exr", "--checkpoint", "c.film", "-D", "x=1"});
  const std::string before = file_content(dir_.file("c.film"));
  expect_failure({"render", "--resume", "c.film", "--spp", "8"}, 2,
                 "c.film: is of another picture: --spp is 4 there and 8 here");
  expect_failure({"render", "--resume", "c.film", "-D", "x=2"}, 2, "-D x is 1 there and 2 here");
  expect_failure({"render", "--resume", "c.film", "--size", "81x60"}, 2,
                 "--size is 80x60 there and 81x60 here");
  expect_failure({"render", "--resume", "c.film", "--shard", "1/2"}, 2, "c.film: is share 1/1");
  dir_.write("a.yaml", kScene + std::string("# changed\n"));
  expect_failure({"render", "--resume", "c.film"}, 2,
                 "c.film: is of another picture: the file 'a.yaml' has another content");
  dir_.write("a.yaml", kScene);
  // The scene may have moved.
  fs::create_directory(dir_.path() / "moved");
  fs::rename(dir_.path() / "a.yaml", dir_.path() / "moved" / "a.yaml");
  expect_failure({"render", "--resume", "c.film"}, 1, "a.yaml: no such file");
  EXPECT_EQ(file_content(dir_.file("c.film")), before);
  expect_success({"render", "moved/a.yaml", "--resume", "c.film"});
}

TEST_F(CheckpointCommand, ASceneWithAnotherSettingIsRefused) {
  expect_success({"render", "a.yaml", "-o", "a.exr", "--checkpoint", "c.film"});
  const struct {
    std::string before, setting, difference;
  } cases[] = {{"samples: 4", "depth: 7", "'depth' is 6 there and 7 here"},
               {"samples: 4", "clamp: 2", "--clamp is 0 there and 2 here"},
               {"samples: 4", "caustics: {photons: 5}", "'photons' is 0 there and 5 here"},
               {"height: 60", "filter: tent", "--filter is box there and tent here"},
               {"height: 60", "filter_radius: 2", "'filter_radius' is 0 there and 2 here"},
               {"height: 60", "crop: [0, 0.5, 0, 1]", "--cropwindow is 0,1,0,1 there and 0,0.5,0,1 here"}};
  for (const auto& c : cases) {
    std::string scene = kScene;
    scene.insert(scene.find(c.before) + c.before.size(), ", " + c.setting);
    dir_.write("a.yaml", scene);
    expect_failure({"render", "--resume", "c.film"}, 2, "c.film: is of another picture: " + c.difference);
  }
}

TEST_F(CheckpointCommand, WrongWordsAreRefused) {
  struct Case {
    Words words;
    std::string message;
  };
  const Case cases[] = {
      {{"--shard", "0/3"}, "--shard: '0/3' is not of the form k/n"},
      {{"--shard", "4/3"}, "--shard"},
      {{"--shard", "1"}, "--shard"},
      {{"--shard", "1/3x"}, "--shard"},
      {{"--shard", "1/9999999"}, "--shard"},
      {{"--shard", "1/3", "-o", "a.exr"}, "expected -o FILE.film"},
      {{"--shard", "1/3", "--checkpoint", "c.film"}, "is a checkpoint itself"},
      {{"--checkpoint", "c.film", "--every", "0"}, "--every: '0' is out of range"},
      {{"--checkpoint", "c.film", "--every", "soon"}, "--every"},
      {{"--every", "3"}, "--every needs --checkpoint"},
      {{"--add-spp", "0"}, "--add-spp: 0 is out of range"},
      {{"--add-spp", "99999999"}, "--add-spp"},
      {{"--resume", "a.yaml"}, "a.yaml: is not a film of version 2"},
  };
  for (const Case& c : cases) {
    Words words{"render", "a.yaml"};
    words.insert(words.end(), c.words.begin(), c.words.end());
    expect_failure(words, 2, c.message);
  }
  expect_failure({"render", "--resume", "none.film"}, 1, "none.film: cannot read");
  expect_failure({"render", "a.yaml", "--checkpoint", "none/c.film"}, 1, "none/c.film: cannot write");
  expect_failure({"render", "a.yaml", "--checkpoint", "."}, 1, "cannot write");
  EXPECT_EQ(file_count(dir_), 1u);
}

TEST_F(CheckpointCommand, TheTimeBetweenCheckpointsHasLimits) {
  for (const char* seconds : {"86401", "86400.5", "1e300", "inf", "nan", "0.0009", "0", "-1"})
    expect_failure(
        {"render", "a.yaml", "-o", "a.exr", "--checkpoint", "c.film", "--every", seconds}, 2,
        std::string("--every: '") + seconds + "' is out of range; expected seconds from 0.001 to 86400");
  EXPECT_EQ(file_count(dir_), 1u);
  for (const char* seconds : {"86400", "0.001"})
    expect_success({"render", "a.yaml", "-o", "a.exr", "--checkpoint", "c.film", "--every", seconds});
}

/// What would be written last would replace what was written before. Also where the path leads through links.
TEST_F(CheckpointCommand, FilesMustNotReplaceEachOther) {
  fs::create_symlink("a.exr", dir_.path() / "link.exr");
  fs::create_directory(dir_.path() / "sub");
  fs::create_directory_symlink("sub", dir_.path() / "other");
  const std::string full = dir_.file("a.exr");
  const std::pair<Words, std::string> cases[] = {
      {{"-o", "a.exr", "--checkpoint", "a.exr"}, "--outfile and --checkpoint name the same file 'a.exr'"},
      {{"-o", "a.exr", "--checkpoint", "link.exr"}, "--outfile and --checkpoint name"},
      {{"-o", "./a.exr", "--checkpoint", full}, "--outfile and --checkpoint name"},
      {{"-o", "sub/a.exr", "--checkpoint", "other/a.exr"}, "--outfile and --checkpoint name"},
      {{"--checkpoint", "a.png"}, "--outfile and --checkpoint name the same file"},
      {{"-o", "a.exr", "--integrator", "path", "--photon-map", "a.exr"}, "--outfile and --photon-map name"},
      {{"-o", "a.exr", "--integrator", "path", "--checkpoint", "s.film", "--photon-map", "s.film"},
       "--checkpoint and --photon-map name"},
      {{"-o", "s.film", "--integrator", "path", "--photon-map", "s.film"}, "--outfile and --photon-map name"},
      {{"-o", "a.exr", "--checkpoint", "a.yaml"}, "the scene and --checkpoint name"},
  };
  for (const auto& [words, message] : cases) {
    Words all{"render", "a.yaml"};
    all.insert(all.end(), words.begin(), words.end());
    expect_failure(all, 2, message);
  }
  EXPECT_EQ(file_count(dir_), 4u);
  expect_success({"render", "a.yaml", "-o", "sub/a.exr", "--checkpoint", "a.film"});
}

/// A folder that vanishes while the picture is rendered costs the checkpoint, not the picture.
TEST_F(CheckpointCommand, RendersOutliveTheirCheckpoints) {
  fs::create_directory(dir_.path() / "sub");
  CommandProcess process(dir_, {"render", "a.yaml", "-o", "a.exr", "--spp", "300", "-t", "1", "--checkpoint",
                                "sub/c.film", "--every", "0.01"});
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!fs::exists(dir_.path() / "sub" / "c.film") && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  fs::remove_all(dir_.path() / "sub");
  EXPECT_EQ(process.wait(), 1);
  EXPECT_TRUE(contains(process.err(), "sub/c.film: cannot write: no directory 'sub'")) << process.err();
  const std::string err = process.err();
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  expect_success({"render", "a.yaml", "-o", "b.exr", "--spp", "300"});
  EXPECT_EQ(difference(dir_, "a.exr", "b.exr"), "");
}

/// A disk that is full: files may have 4 KiB. What was there before stays, and nothing is left beside it.
TEST_F(CheckpointCommand, FullDisksLeaveTheOldFilm) {
  expect_success({"render", "a.yaml", "-o", "old.exr", "--checkpoint", "c.film"});
  const std::string before = file_content(dir_.file("c.film"));
  ASSERT_GT(before.size(), 8192u);
  const auto limited = [&](const std::string& words) {
    return run_command(dir_, {"-c", "trap '' XFSZ; ulimit -f 8; exec " OKTETT_COMMAND " " + words},
                       "/bin/sh");
  };
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  // The picture is small enough.
  const CommandResult render = limited("render --resume c.film --add-spp 4 -o a.png --every 0.01");
  EXPECT_EQ(render.status, 1) << render.err;
  EXPECT_TRUE(contains(render.err, "c.film: cannot write: File too large")) << render.err;
  EXPECT_EQ(lines(render.err), 1) << render.err;
  EXPECT_TRUE(fs::exists(dir_.file("a.png")));
  EXPECT_EQ(file_content(dir_.file("c.film")), before);
  const CommandResult share = limited("render a.yaml --shard 1/2 -o c.film");
  EXPECT_EQ(share.status, 1) << share.err;
  EXPECT_EQ(lines(share.err), 1) << share.err;
  EXPECT_EQ(file_content(dir_.file("c.film")), before);
  EXPECT_EQ(file_count(dir_), 4u);
}

TEST_F(CheckpointCommand, SignalsLeaveACheckpoint) {
  CommandProcess process(dir_, {"render", "a.yaml", "-o", "a.exr", "--spp", "600", "-t", "1", "--checkpoint",
                                "c.film", "--progress"});
  EXPECT_TRUE(process.wait_for_err("%", 120));
  process.send(SIGTERM);
  EXPECT_EQ(process.wait(), 128 + SIGTERM);
  EXPECT_TRUE(contains(process.err(), "go on with: oktett render --resume c.film")) << process.err();
  expect_success({"render", "--resume", "c.film", "-o", "a.exr"});
  expect_success({"render", "a.yaml", "-o", "b.exr", "--spp", "600"});
  EXPECT_EQ(difference(dir_, "a.exr", "b.exr"), "");
}

/// Damaged films are refused by both commands, whatever is done to them.
TEST_F(CheckpointCommand, DamagedFilmsAreRefused) {
  expect_success({"render", "a.yaml", "-o", "a.film"});
  const std::string whole = file_content(dir_.file("a.film"));
  std::mt19937 random(11);
  for (int i = 0; i < 12; ++i) {
    std::string bytes = whole;
    if (i % 2 == 0)
      bytes.resize(random() % whole.size());
    else
      bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
    dir_.write("bad.film", bytes);
    expect_failure({"merge", "bad.film", "-o", "b.png"}, 2, "bad.film: ");
    expect_failure({"render", "--resume", "bad.film"}, 2, "bad.film: ");
    EXPECT_EQ(file_content(dir_.file("bad.film")), bytes);
  }
  EXPECT_FALSE(fs::exists(dir_.file("b.png")));
}

}  // namespace
}  // namespace oktett::checkpoint_command_test
