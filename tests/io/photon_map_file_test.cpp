#include "io/photon/photon_map_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/random.h"
#include "render/photon/photon_map.h"
#include "tests/support/temp_dir.h"

namespace oktett::photon_map_file_test {
namespace {

PhotonMap small_map() {
  PhotonMap map;
  map.plan = {100, 3, 6, 7, 0.25};
  map.scene = {1, 2, 3};
  for (std::uint32_t pass = 0; pass < 3; ++pass) {
    Column<Photon> photons;
    for (std::uint32_t i = 0; i < 10 * pass; ++i)
      photons.push_back({{random_float(1, i, 0), random_float(1, i, 1), random_float(1, i, 2)},
                         {0.5f, random_float(1, i, 3), 0},
                         static_cast<std::uint32_t>(random_bits(1, i, 4)),
                         static_cast<std::uint16_t>(1 + i % 6)});
    map.passes.emplace_back(std::move(photons), 0.1f / static_cast<float>(pass + 1));
  }
  return map;
}

class PhotonMapFile : public testing::Test {
 protected:
  PhotonMapFile() { write_photon_map(path(), small_map()); }

  std::string path() const { return (dir_.path() / "map.photons").string(); }
  std::string bytes() const { return test::file_content(path()); }
  void put(const std::string& bytes) const {
    std::ofstream(path(), std::ios::binary | std::ios::trunc) << bytes;
  }
  /// Expects an Error that names the file and holds `what`.
  void expect_error(const std::string& what) const {
    try {
      read_photon_map(path());
      ADD_FAILURE() << "accepted: " << what;
    } catch (const Error& e) {
      EXPECT_EQ(e.where().file, path());
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  }

  test::TempDir dir_;
};

TEST_F(PhotonMapFile, WhatIsReadIsWhatWasWritten) {
  const PhotonMap want = small_map();
  const auto got = read_photon_map(path());
  EXPECT_EQ(got->plan, want.plan);
  EXPECT_EQ(got->scene, want.scene);
  ASSERT_EQ(got->passes.size(), 3u);
  for (std::size_t pass = 0; pass < 3; ++pass) {
    EXPECT_EQ(got->passes[pass].radius(), want.passes[pass].radius());
    const auto &a = got->passes[pass].photons(), &b = want.passes[pass].photons();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i], b[i]);
  }
  // Written again, it is the same file.
  const std::string first = bytes();
  write_photon_map(path(), *got);
  EXPECT_EQ(bytes(), first);
}

TEST_F(PhotonMapFile, EveryCutAndEveryChangedByteIsFound) {
  const std::string good = bytes();
  for (std::size_t size = 0; size < good.size(); size += size < 100 ? 3 : 41) {
    put(good.substr(0, size));
    EXPECT_THROW(read_photon_map(path()), Error) << size;
  }
  put(good + "x");
  expect_error("length");
  for (std::size_t i = 0; i < good.size(); i += i < 120 ? 2 : 29)
    for (const int flip : {1, 0x80, 0xff}) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ flip);
      put(bad);
      EXPECT_THROW(read_photon_map(path()), Error) << i;
    }
}

TEST_F(PhotonMapFile, ErrorsSayWhatIsWrong) {
  const std::string good = bytes();
  put("oktett photons 1\n" + good.substr(17));
  expect_error("version 3");
  put("");
  expect_error("version 3");
  put(good.substr(0, good.size() - 9));
  expect_error("cut short");
  std::string bad = good;
  bad[good.size() - 1] ^= 1;
  put(bad);
  expect_error("checksum");
  const auto put_at = [&](std::size_t place, auto number) {
    std::string changed = good;
    std::memcpy(&changed[place], &number, sizeof number);
    put(changed);
  };
  put_at(17, 0u);
  expect_error("out of range");
  put_at(17 + 4, 5000u);
  expect_error("out of range");
  // The first pass is empty; the count of the second one is that of a file of 128 GB.
  put_at(17 + 56 + 8 + 4, 0xffffffffu);
  expect_error("cut short");
  put_at(17 + 56, -1.0f);
  expect_error("radius");
  const std::size_t photon = 17 + 56 + 8 + 8;
  put_at(photon, std::numeric_limits<float>::infinity());
  expect_error("none can have");
  put_at(photon + 12, -1.0f);
  expect_error("none can have");
  put_at(photon + 28, std::uint32_t{0});
  expect_error("none can have");
  std::filesystem::remove(path());
  EXPECT_THROW(read_photon_map(path()), Error);
}

}  // namespace
}  // namespace oktett::photon_map_file_test
