#include "io/film/film_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/bytes.h"
#include "core/error.h"
#include "io/text/file_content.h"
#include "io/text/files.h"
#include "tests/support/temp_dir.h"

namespace oktett::film_file_test {
namespace {

FilmPlan small_plan() {
  FilmPlan plan;
  plan.format.window = {4, 8, 44, 48};
  plan.format.full_width = 64, plan.format.full_height = 50;
  plan.format.data_layers = plan.format.mattes = plan.format.sample_counts = true;
  plan.format.light_groups = {"default", "key-1"};
  plan.attributes = {{"cryptomatte/1/name", "CryptoObject"}};
  plan.samples = 8;
  return plan;
}

/// Share 2 of 2: two of four tiles, one of them with all samples.
FilmFile small_film() {
  FilmFile file;
  file.fingerprint.settings = {{"--spp", "8"}, {"--seed", "0"}};
  file.fingerprint.files = {{"a.yaml", "0123"}, {"../b.obj", "4567"}};
  file.words = {"render", "a.yaml", ""};
  file.metadata.software = "oktett 1", file.metadata.command_line = "oktett render a.yaml";
  file.metadata.scene = "a.yaml", file.metadata.samples = 24, file.metadata.render_seconds = 1.5;
  file.metadata.origin = {432100.25, 5411000, -300};
  file.metadata.camera.emplace();
  for (std::size_t i = 0; i < 16; ++i)
    file.metadata.camera->world_to_camera[i] = static_cast<float>(i),
    file.metadata.camera->world_to_ndc[i] = -1;
  file.film = std::make_shared<FilmState>(FilmShare{2, 2}, 16);
  file.film->begin(small_plan(), {ToneKind::aces, -1.5});
  for (std::size_t number = 0; number < file.film->tile_count(); ++number) {
    if (!file.film->in_share(number)) continue;
    const FinishedTile tile = file.film->tile(number);
    TileSums sums;
    sums.pixels.resize(std::size_t{tile.width} * tile.height);
    sums.samples.resize(sums.pixels.size(), 8);
    sums.objects.resize(sums.pixels.size()), sums.materials.resize(sums.pixels.size());
    sums.grouped.resize(6 * sums.pixels.size());
    sums.grouped[19] = 0.75;
    sums.pixels[3].color[1] = 0.25, sums.pixels[3].good = 8, sums.pixels[3].has_ids = true;
    sums.objects[3].add(1.5f);
    file.film->set_record(number, {number > 4 ? 16u : 0u, encode_tile(small_plan().format, sums)});
  }
  return file;
}

class FilmFiles : public testing::Test {
 protected:
  FilmFiles() { write_film(path(), small_film()); }

  std::string path() const { return dir_.file("a.film"); }
  std::string bytes() const { return test::file_content(path()); }
  /// The message of the Error of parse_film; empty if there is none.
  static std::string problem(const std::string& bytes) {
    try {
      parse_film(bytes);
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }

  test::TempDir dir_;
};

TEST_F(FilmFiles, WhatIsReadIsWhatWasWritten) {
  const FilmFile is = read_film(path()), was = small_film();
  EXPECT_EQ(difference(is.fingerprint, was.fingerprint), "");
  EXPECT_EQ(is.words, was.words);
  EXPECT_EQ(is.metadata.software, was.metadata.software);
  EXPECT_EQ(is.metadata.command_line, was.metadata.command_line);
  EXPECT_EQ(is.metadata.scene, was.metadata.scene);
  EXPECT_EQ(is.metadata.samples, was.metadata.samples);
  EXPECT_EQ(is.metadata.render_seconds, was.metadata.render_seconds);
  EXPECT_EQ(is.metadata.origin, was.metadata.origin);
  ASSERT_TRUE(is.metadata.camera);
  EXPECT_EQ(is.metadata.camera->world_to_camera, was.metadata.camera->world_to_camera);
  EXPECT_EQ(is.metadata.camera->world_to_ndc, was.metadata.camera->world_to_ndc);
  EXPECT_TRUE(is.film->plan() == was.film->plan());
  EXPECT_EQ(is.film->tone(), was.film->tone());
  EXPECT_EQ(is.film->share(), was.film->share());
  EXPECT_EQ(is.film->added(), was.film->added());
  EXPECT_EQ(is.film->tiles_finished(), was.film->tiles_finished());
  const auto records = is.film->records(), old = was.film->records();
  ASSERT_EQ(records.size(), old.size());
  for (const auto& [number, record] : records) {
    EXPECT_EQ(record->added, old.at(number)->added);
    EXPECT_EQ(record->bytes, old.at(number)->bytes);
  }
  // The same film makes the same file.
  const std::string first = bytes();
  write_film(path(), is);
  EXPECT_EQ(bytes(), first);
}

TEST_F(FilmFiles, ShortFilesAreRefused) {
  const std::string whole = bytes();
  for (std::size_t size = 0; size < whole.size(); size += size < 600 ? 1 : 37) {
    EXPECT_NE(problem(whole.substr(0, size)), "") << size;
  }
  EXPECT_EQ(problem(whole + " "), "the file has not the length that it says");
  EXPECT_EQ(problem("no film"), "is not a film of version 2");
  std::ofstream(path(), std::ios::binary | std::ios::trunc) << "no film";
  try {
    read_film(path());
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), path() + ": is not a film of version 2");
  }
}

TEST_F(FilmFiles, EachChangedBitIsSeen) {
  const std::string whole = bytes();
  for (std::size_t bit = 0; bit < whole.size() * 8; bit += bit < 8 * 600 ? 1 : 61) {
    std::string changed = whole;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
    EXPECT_NE(problem(changed), "") << bit;
  }
}

/// Headers that somebody made, with the right checksum: they are refused or mean something, and memory is
/// not asked for by what they say.
TEST_F(FilmFiles, HeadersThatLieAreSafe) {
  constexpr std::size_t kStart = 14;
  const std::string whole = bytes();
  std::uint64_t size = 0;
  std::memcpy(&size, whole.data() + kStart, sizeof size);
  const std::string header = whole.substr(kStart + 8, size), rest = whole.substr(kStart + 16 + size);
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string other = header;
    if (i % 5 == 0) other.resize(random() % header.size());
    for (unsigned k = random() % 3; k + 1 > 0 && !other.empty(); --k) {
      // Most of what matters stands at the front.
      const std::size_t at = random() % (i % 2 == 0 ? std::min<std::size_t>(60, other.size()) : other.size());
      other[at] = static_cast<char>(i % 3 == 0 ? 0xff : random());
    }
    std::string file = whole.substr(0, kStart);
    append_number(file, std::uint64_t{other.size()});
    file += other;
    append_number(file, checksum(other));
    refused += problem(file + rest).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 1000);
}

// Planes are named after them.
TEST_F(FilmFiles, OddLightGroupsAreRefused) {
  const auto problem_with = [&](const std::vector<std::string>& names, bool layers = true) {
    FilmPlan plan = small_plan();
    plan.format.light_groups = names;
    plan.format.data_layers = plan.format.mattes = plan.format.sample_counts = layers;
    FilmFile file;
    file.film = std::make_shared<FilmState>(FilmShare{});
    file.film->begin(plan, {});
    write_film(path(), file);
    return problem(bytes());
  };
  EXPECT_EQ(problem_with({"default", "key"}), "");
  EXPECT_EQ(problem_with({}), "");
  const std::string odd = "its light groups cannot be";
  EXPECT_EQ(problem_with({"default", "a.b"}), odd);
  EXPECT_EQ(problem_with({"default", ""}), odd);
  EXPECT_EQ(problem_with({"key", "default"}), odd);
  EXPECT_EQ(problem_with({"default", "key", "key"}), odd);
  EXPECT_EQ(problem_with({"default", "key"}, false), odd);
  std::vector<std::string> many{"default"};
  for (int i = 0; i < 64; ++i) many.push_back("g" + std::to_string(i));
  EXPECT_EQ(problem_with(many), odd);
}

TEST_F(FilmFiles, WhatCannotBeWrittenLeavesTheOldFile) {
  const std::string before = bytes();
  EXPECT_THROW(write_film(dir_.file("none/a.film"), small_film()), Error);
  EXPECT_THROW(write_film(dir_.path().string(), small_film()), Error);
  EXPECT_EQ(bytes(), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 1);
}

TEST(FilmFingerprints, DifferencesAreNamed) {
  const FilmFingerprint film{{{"--spp", "8"}, {"-D x", "1"}}, {{"a.yaml", "12"}, {"b.obj", "34"}}};
  FilmFingerprint now = film;
  EXPECT_EQ(difference(film, now), "");
  now.settings[0].second = "16";
  EXPECT_EQ(difference(film, now), "--spp is 8 there and 16 here");
  now = film, now.settings.pop_back();
  EXPECT_EQ(difference(film, now), "-D x is 1 there and not set here");
  EXPECT_EQ(difference(now, film), "-D x is not set there and 1 here");
  now = film, now.files[1].second = "35";
  EXPECT_EQ(difference(film, now), "the file 'b.obj' has another content");
  now = film, now.files.pop_back();
  EXPECT_EQ(difference(film, now), "the file 'b.obj' is read there and not here");
  EXPECT_EQ(difference(now, film), "the file 'b.obj' is read here and not there");
  // Two files whose contents were exchanged.
  now = film, std::swap(now.files[0].second, now.files[1].second);
  EXPECT_NE(difference(film, now), "");
}

TEST(FilmFingerprints, FilesAreNamedFromTheScene) {
  const test::TempDir dir;
  std::filesystem::create_directories(dir.path() / "one" / "scenes");
  std::filesystem::create_directories(dir.path() / "two" / "scenes");
  const auto hashes = [&](const std::string& root) {
    dir.write(root + "/scenes/a.yaml", "scene"), dir.write(root + "/b.obj", "mesh");
    const FilesRead files;
    for (const char* name : {"/scenes/a.yaml", "/scenes/../b.obj"}) MappedFile(dir.file(root + name));
    note_file_read(dir.file(root + "/scenes/none.png"));
    return hash_files(files.paths(), dir.file(root + "/scenes"));
  };
  const auto one = hashes("one");
  EXPECT_EQ(one, hashes("two"));
  ASSERT_EQ(one.size(), 3u);
  EXPECT_EQ(one[0].first, "../b.obj");
  EXPECT_EQ(one[1].first, "a.yaml");
  EXPECT_NE(one[0].second, one[1].second);
  EXPECT_EQ(one[2], (std::pair<std::string, std::string>("none.png", "missing")));
  // Nobody takes notes.
  MappedFile(dir.file("one/b.obj"));
  EXPECT_TRUE(FilesRead().paths().empty());
}

}  // namespace
}  // namespace oktett::film_file_test
