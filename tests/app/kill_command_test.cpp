/// \file Processes that are killed while they render: nothing is lost but what was in progress.
///
/// OKTETT_KILLS is the number of kills, over all scenes; without it there are few.

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include "io/film/film_file.h"
#include "io/image/image.h"
#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::kill_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandProcess;
using test::run_command;
using test::TempDir;
using Words = std::vector<std::string>;
using Seconds = std::chrono::duration<double>;

struct Case {
  const char* scene;
  Words options;
};

const Case kCases[] = {
    {"room.yaml", {"--integrator", "path", "--spp", "64"}},
    {"whitted.yaml", {"--spp", "100"}},
    {"lantern.yaml", {"--spp", "32"}},
    {"caustics.yaml", {"--integrator", "path", "--caustics", "--spp", "2"}},
    {"motion.yaml", {"--spp", "64"}},
    {"shapes.yaml", {"--spp", "100", "--cryptomatte"}},
    {"dusk.yaml", {"--integrator", "path", "--spp", "16", "--error", "0.05", "--max-spp", "128"}},
    {"torus.yaml", {"--integrator", "ao", "--spp", "128"}},
    {"menger.yaml", {"--spp", "128"}},
    {"smoke.yaml", {"--spp", "16"}},
};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool same_bits(const TempDir& dir, const std::string& a, const std::string& b) {
  const Picture p = read_image(dir.file(a)), q = read_image(dir.file(b));
  if (p.planes.size() != q.planes.size()) return false;
  for (std::size_t k = 0; k < p.planes.size(); ++k) {
    const auto same = [](float x, float y) { return std::bit_cast<int>(x) == std::bit_cast<int>(y); };
    const PicturePlane &x = p.planes[k], &y = q.planes[k];
    if (!std::equal(x.values.begin(), x.values.end(), y.values.begin(), y.values.end(), same) ||
        !std::equal(x.ids.begin(), x.ids.end(), y.ids.begin(), y.ids.end()))
      return false;
  }
  return true;
}

/// Starts the command and kills it after a random time of at most `most` seconds; false if it ended before.
bool kill_at_random(const TempDir& dir, const Words& words, double most, std::mt19937& random) {
  CommandProcess process(dir, words);
  std::this_thread::sleep_for(Seconds(std::uniform_real_distribution<double>(0, most)(random)));
  process.send(SIGKILL);
  const int status = process.wait();
  EXPECT_TRUE(status == -SIGKILL || status == 0) << status << process.err();
  return status == -SIGKILL;
}

TEST(KilledRenders, GoOnToTheSameBits) {
  const char* wanted = std::getenv("OKTETT_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 10;
  std::mt19937 random(static_cast<unsigned>(kills));
  const std::size_t count = std::size(kCases);
  int done = 0, unfinished = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const TempDir dir;
    const std::string scene = std::string(OKTETT_SOURCE_DIR) + "/scenes/" + kCases[c].scene;
    const Words render = with({"render", scene, "--size", "96x64", "--quiet"}, kCases[c].options);
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(run_command(dir, with(render, {"-o", "whole.exr"})).status, 0) << scene;
    const double seconds = Seconds(std::chrono::steady_clock::now() - start).count();
    const int end = kills * static_cast<int>(c + 1) / static_cast<int>(count);
    while (done < end) {
      fs::remove(dir.file("c.film"));
      fs::remove(dir.file("a.exr"));
      const Words first = with(render, {"-o", "a.exr", "--checkpoint", "c.film", "--every", "0.005"});
      const Words again{"render", "--resume", "c.film", "--every", "0.005", "--quiet"};
      // A picture is killed until it is finished, up to three times.
      for (int round = 0; round < 3 && done < end; ++round) {
        const bool begun = fs::exists(dir.file("c.film"));
        done += kill_at_random(dir, begun ? again : first, seconds, random) ? 1 : 0;
        if (!fs::exists(dir.file("c.film"))) continue;
        const FilmFile film = read_film(dir.file("c.film"));
        unfinished += film.film->tiles_finished() < film.film->tiles_wanted() ? 1 : 0;
        EXPECT_TRUE(!fs::exists(dir.file("a.exr")) || same_bits(dir, "whole.exr", "a.exr")) << scene;
      }
      const auto last = run_command(dir, fs::exists(dir.file("c.film")) ? again : first);
      EXPECT_EQ(last.status, 0) << last.err;
      EXPECT_TRUE(same_bits(dir, "whole.exr", "a.exr")) << scene;
    }
    // The pictures, the film, and nothing else.
    for (const auto& entry : fs::directory_iterator(dir.path()))
      EXPECT_TRUE(entry.path().extension() == ".exr" || entry.path().extension() == ".film") << entry;
  }
  EXPECT_GT(unfinished, 0);
}

}  // namespace
}  // namespace oktett::kill_command_test
