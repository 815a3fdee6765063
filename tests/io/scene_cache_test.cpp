// Meshes and trees from the cache are those of the files; whatever else the folder contains is not used.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "accel/accel_data.h"
#include "accel/build/tree_store.h"
#include "core/error.h"
#include "io/cache/entries.h"
#include "io/cache/scene_cache.h"
#include "io/obj/obj.h"
#include "io/text/files.h"
#include "tests/support/temp_dir.h"

namespace oktett::scene_cache_test {
namespace {

namespace fs = std::filesystem;
using test::TempDir;

/// A wavy square of 2 n^2 triangles with uv, two materials of which one is missing, a line and a polygon.
std::string wavy_square(int n, double height = 0.1) {
  std::string text = "# square\nmtllib a.mtl none.mtl\nl 1 2\n";
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string(height * std::sin(9 * x) * std::cos(7 * y)) + "\n";
      text += "vt " + std::to_string(x) + " " + std::to_string(y) + "\n";
    }
  text += "vn 0 0 1\n";
  for (int j = 0; j < n; ++j) {
    if (j == n / 3) text += "usemtl red\n";
    if (j == n / 2) text += "usemtl gone\n";
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i + 1;
      const auto corner = [](int k) {
        return " " + std::to_string(k) + "/" + std::to_string(k) + (k % 2 ? "/1" : "");
      };
      text += "f" + corner(a) + corner(a + 1) + corner(a + n + 2) + corner(a + n + 1) + "\n";
    }
  }
  return text + "wobble 3\n";
}

constexpr const char* kMaterials = "newmtl red\nKd 1 0 0\nmap_Kd none.png\n";

template <class T>
bool same(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const ObjFile& a, const ObjFile& b) {
  EXPECT_TRUE(same(a.mesh.positions, b.mesh.positions) && same(a.mesh.normals, b.mesh.normals) &&
              same(a.mesh.uvs, b.mesh.uvs) && same(a.mesh.indices, b.mesh.indices) &&
              same(a.mesh.normal_indices, b.mesh.normal_indices) &&
              same(a.mesh.uv_indices, b.mesh.uv_indices) &&
              same(a.mesh.material_slots, b.mesh.material_slots));
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.textures, b.textures);
  EXPECT_EQ(a.texture_places, b.texture_places);
  ASSERT_EQ(a.warnings.size(), b.warnings.size());
  for (std::size_t i = 0; i < a.warnings.size(); ++i)
    EXPECT_EQ(to_string(a.warnings[i]), to_string(b.warnings[i]));
}

// Headers of any length, also where the header ends beside a place at which sections begin.
TEST(CacheFiles, HeadersAndSectionsComeBack) {
  const TempDir dir;
  const std::string path = dir.file("entry");
  Column<std::uint8_t> filled(70000);
  for (std::size_t i = 0; i < filled.size(); ++i) filled[i] = static_cast<std::uint8_t>(i * 31 + i / 251);
  const CacheSection empty, large = section_of(filled), one{filled.data() + 5, 1};
  for (const std::vector<CacheSection>& sections :
       {std::vector<CacheSection>{}, {empty}, {large}, {one, empty, large}}) {
    const std::vector<CacheSection> nothing(sections.size());
    const std::size_t exact = 65536 - cache_file_bytes("", nothing);
    std::vector<std::size_t> lengths{0, 1, 2, 3, 4, 7, 8, 9, 15, 16, 17, 100, 4095, 4096, 4097, 4200};
    for (std::size_t k = 0; k <= 40; ++k) lengths.push_back(exact - 20 + k);
    for (const std::size_t length : lengths) {
      SCOPED_TRACE(std::to_string(sections.size()) + " sections, header of " + std::to_string(length));
      std::string header(length, '\0');
      for (std::size_t i = 0; i < length; ++i) header[i] = static_cast<char>(i * 7 + length);
      write_cache_file(path, header, sections, 1'500'000'000'123'456'789);
      EXPECT_EQ(fs::file_size(path), cache_file_bytes(header, sections));
      try {
        const CacheFile file(path);
        EXPECT_TRUE(file.header() == header);
        EXPECT_EQ(file.time(), 1'500'000'000'123'456'789);
        ASSERT_EQ(file.sections(), sections.size());
        for (std::size_t i = 0; i < sections.size(); ++i) {
          const CacheSection& expected = sections[i];
          ASSERT_EQ(file.count<std::uint8_t>(i), expected.bytes);
          Column<std::uint8_t> copied;
          file.copy(i, copied);
          const VirtualArray<std::uint8_t> mapped = file.map<std::uint8_t>(i);
          if (expected.bytes == 0) continue;
          EXPECT_EQ(std::memcmp(copied.data(), expected.data, expected.bytes), 0) << i;
          EXPECT_EQ(std::memcmp(mapped.data(), expected.data, expected.bytes), 0) << i;
        }
      } catch (const Error& error) {
        ADD_FAILURE() << error.what();
      }
    }
  }
}

/// A folder with a mesh and a cache, and what the cache told.
class SceneCacheTest : public testing::Test {
 protected:
  SceneCacheTest() {
    mesh_ = dir_.write("a.obj", wavy_square(20));
    dir_.write("a.mtl", kMaterials);
    options_.least_file_bytes = 1, options_.least_triangles = 1;
    options_.tell = [this](const std::string& problem) { told_.push_back(problem); };
  }

  std::string folder() const { return dir_.file("cache"); }
  /// Paths of entries of a kind, ".mesh" or ".tree".
  std::vector<std::string> entries(const std::string& kind) const {
    std::vector<std::string> paths;
    if (fs::exists(folder()))
      for (const auto& entry : fs::directory_iterator(folder()))
        if (entry.path().extension() == kind) paths.push_back(entry.path().string());
    return paths;
  }
  /// The mesh by the cache, and whether it came from there.
  ObjFile load(bool* hit = nullptr) {
    SceneCache cache(folder(), options_);
    const FilesRead files;
    ObjFile obj = cache.load_mesh(mesh_);
    if (hit != nullptr) *hit = known_content(mesh_).has_value();
    return obj;
  }
  void expect_hit(bool expected, const char* what) {
    bool hit = !expected;
    expect_same(load(&hit), load_obj(mesh_));
    EXPECT_EQ(hit, expected) << what;
  }

  TempDir dir_;
  std::string mesh_;
  SceneCacheOptions options_;
  std::vector<std::string> told_;
};

std::string content(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}
void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_F(SceneCacheTest, MeshesComeBackWithMaterialsAndWarnings) {
  ASSERT_EQ(load_obj(mesh_).warnings.size(), 2u);
  expect_hit(false, "first");
  expect_hit(true, "second");
  // Materials are read each time.
  dir_.write("a.mtl", "newmtl red\nKd 0 1 0\nnewmtl gone\nKd 0 0 1\n");
  expect_hit(true, "other materials");
  EXPECT_TRUE(told_.empty());
  dir_.write("a.obj", "v 0 0 0\nl 1 1\n");
  expect_hit(false, "no faces");
  expect_hit(true, "no faces");
}

/// What vertices and faces carry, and images that a PLY file names.
TEST_F(SceneCacheTest, AttributesComeBack) {
  std::string text =
      "ply\nformat ascii 1.0\ncomment TextureFile none.png\ncomment TextureFile two.png\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty float flow.0\nproperty float "
      "flow.1\n";
  const std::string body =
      "end_header\n0 0 0 0 0 1 2 3 4\n1 0 0 1 0 5 6 7 8\n0 1 0 0 1 9 8 7 6\n3 0 1 2 0.5 0.25";
  for (const bool numbered : {false, true}) {
    mesh_ = dir_.write(
        "a.ply", text + (numbered ? "property int texnumber\n" : "") + body + (numbered ? " 1\n" : "\n"));
    const MeshFile plain = load_mesh(mesh_);
    for (const bool again : {false, true}) {
      bool hit = !again;
      const MeshFile cached = load(&hit);
      EXPECT_EQ(hit, again);
      expect_same(cached, plain);
      ASSERT_EQ(cached.mesh.attributes.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) {
        const MeshAttribute &a = cached.mesh.attributes[i], &b = plain.mesh.attributes[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.domain, b.domain);
        EXPECT_EQ(a.components, b.components);
        EXPECT_TRUE(same(a.floats, b.floats) && same(a.srgb, b.srgb));
      }
    }
  }
  const std::string entry = entries(".mesh").at(0);
  const std::vector<std::function<void(MeshEntry&)>> changes = {
      [](MeshEntry& e) { e.parsed.mesh.attributes[0].srgb.push_back(1); },
      [](MeshEntry& e) { e.parsed.mesh.attributes[1].floats.clear(); },
      [](MeshEntry& e) { e.parsed.mesh.attributes[1].components = 0; },
      [](MeshEntry& e) { e.parsed.mesh.attributes[2].domain = static_cast<AttributeDomain>(3); },
      [](MeshEntry& e) { e.parsed.mesh.attributes[2].srgb = e.parsed.mesh.attributes[0].srgb; }};
  for (const auto& change : changes) {
    MeshEntry e;
    {
      const CacheFile file(entry);
      e = read_mesh_header(file);
      read_mesh_columns(file, e);
    }
    change(e);
    write_cache_file(entry, mesh_header(e), mesh_sections(e), 2'000'000'000'000'000'000);
    told_.clear();
    bool hit = true;
    load(&hit);
    EXPECT_FALSE(hit);
    EXPECT_EQ(told_.size(), 1u);
  }
}

TEST_F(SceneCacheTest, ChangedFilesAreReadAgain) {
  expect_hit(false, "first");
  struct stat before {};
  stat(mesh_.c_str(), &before);
  const timespec times[2] = {before.st_atim, before.st_mtim};
  // The same size and the same time of the last change of the content, which anybody may set.
  write(mesh_, wavy_square(20, 0.2));
  ASSERT_EQ(fs::file_size(mesh_), static_cast<std::uintmax_t>(before.st_size));
  utimensat(AT_FDCWD, mesh_.c_str(), times, 0);
  expect_hit(false, "other content");
  expect_hit(true, "again");
  // Another file under the same name.
  fs::copy_file(mesh_, dir_.file("b.obj"));
  fs::rename(dir_.file("b.obj"), mesh_);
  expect_hit(false, "another inode");
}

/// An entry as old as the last change of its file may stem from before that change.
TEST_F(SceneCacheTest, FilesThatWereReadJustAfterAChangeAreCompared) {
  expect_hit(false, "first");
  const std::string entry = entries(".mesh").at(0);
  MeshEntry kept;
  std::vector<CacheSection> sections;
  {
    const CacheFile file(entry);
    kept = read_mesh_header(file);
    read_mesh_columns(file, kept);
  }
  const std::int64_t changed = kept.stamp.status_time;
  ++kept.checksum;
  write_cache_file(entry, mesh_header(kept), mesh_sections(kept), changed);
  expect_hit(false, "the content differs");
  --kept.checksum;
  write_cache_file(entry, mesh_header(kept), mesh_sections(kept), changed);
  expect_hit(true, "the content is the same");
  ++kept.checksum;
  write_cache_file(entry, mesh_header(kept), mesh_sections(kept), changed + 3'000'000'000);
  expect_hit(true, "the entry is younger");
}

TEST_F(SceneCacheTest, DamagedMeshesAreReadAgain) {
  load();
  const std::string entry = entries(".mesh").at(0), good = content(entry);
  std::mt19937 random(1);
  const auto expect_ignored = [&](const std::string& bytes, const std::string& what) {
    told_.clear();
    write(entry, bytes);
    expect_hit(false, what.c_str());
    ASSERT_EQ(told_.size(), 1u) << what;
    EXPECT_NE(told_[0].find(entry), std::string::npos) << told_[0];
    EXPECT_EQ(content(entry).size(), good.size()) << what;
  };
  for (int i = 0; i < 60; ++i) {
    std::string bytes = good;
    std::size_t at = i < 40 ? static_cast<std::size_t>(i * 7) : random() % bytes.size();
    // Bytes between sections mean nothing.
    while (at >= 40 * 7 && bytes[at] == 0) at = random() % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
    expect_ignored(bytes, "byte " + std::to_string(at));
  }
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{20}, good.size() / 2, good.size() - 1})
    expect_ignored(good.substr(0, size), "size " + std::to_string(size));
  expect_ignored(good + "x", "longer");
}

/// Files whose checksums are right but that no writer made.
TEST_F(SceneCacheTest, ImpossibleMeshesAreReadAgain) {
  load();
  const std::string entry = entries(".mesh").at(0);
  MeshEntry good;
  const auto read = [&] {
    const CacheFile file(entry);
    MeshEntry e = read_mesh_header(file);
    read_mesh_columns(file, e);
    return e;
  };
  const std::vector<std::function<void(MeshEntry&)>> changes = {
      [](MeshEntry& e) {
        e.parsed.mesh.indices[7] = static_cast<std::uint32_t>(e.parsed.mesh.positions.size());
      },
      [](MeshEntry& e) { e.parsed.mesh.indices[7] = kNoId; },
      [](MeshEntry& e) { e.parsed.mesh.indices.resize_uninitialized(e.parsed.mesh.indices.size() - 1); },
      [](MeshEntry& e) {
        e.parsed.mesh.uv_indices[0] = static_cast<std::uint32_t>(e.parsed.mesh.uvs.size());
      },
      [](MeshEntry& e) { e.parsed.mesh.uv_indices.push_back(0); },
      [](MeshEntry& e) { e.parsed.mesh.normal_indices[3] = 1; },
      [](MeshEntry& e) { e.parsed.mesh.normals.clear(); },
      [](MeshEntry& e) { e.parsed.mesh.positions.clear(); },
      [](MeshEntry& e) { e.parsed.mesh.material_slots.clear(); },
      [](MeshEntry& e) { e.parsed.mesh.material_slots[0] = 3; },
      [](MeshEntry& e) { e.parsed.materials.clear(); }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    MeshEntry e = read();
    changes[i](e);
    write_cache_file(entry, mesh_header(e), mesh_sections(e), 2'000'000'000'000'000'000);
    told_.clear();
    expect_hit(false, "change");
    EXPECT_EQ(told_.size(), 1u) << i;
  }
}

TEST_F(SceneCacheTest, TheLeastUsedEntriesMakeRoom) {
  load();
  const std::uint64_t one = fs::file_size(entries(".mesh").at(0));
  const std::string first = mesh_;
  options_.most_bytes = 5 * one / 2;
  const auto age = [&](const std::string& path, int hours) {
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  const std::string oldest = entries(".mesh").at(0);
  age(oldest, 2);
  mesh_ = dir_.write("b.obj", content(first));
  load();
  EXPECT_EQ(entries(".mesh").size(), 2u);
  for (const std::string& path : entries(".mesh"))
    if (path != oldest) age(path, 1);
  mesh_ = dir_.write("c.obj", content(first));
  load();
  EXPECT_EQ(entries(".mesh").size(), 2u);
  EXPECT_FALSE(fs::exists(oldest));
  // What is larger than all the room is not kept, and nothing makes room for it.
  options_.most_bytes = one / 2;
  mesh_ = dir_.write("d.obj", content(first));
  expect_hit(false, "too large");
  EXPECT_EQ(entries(".mesh").size(), 2u);
  EXPECT_TRUE(told_.empty());
}

TEST_F(SceneCacheTest, FoldersThatCannotBeWrittenAreToldOfOnce) {
  fs::create_directory(folder());
  // A folder in the place of the entry cannot be replaced, not even by root.
  load();
  const std::string entry = entries(".mesh").at(0);
  fs::remove(entry);
  fs::create_directories(entry + "/x");
  SceneCache cache(folder(), options_);
  expect_same(cache.load_mesh(mesh_), load_obj(mesh_));
  expect_same(cache.load_mesh(mesh_), load_obj(mesh_));
  EXPECT_EQ(told_.size(), 2u) << "one about reading, one about writing";
  EXPECT_THROW(SceneCache(mesh_, options_), Error);
}

/// Processes that start at the same time all get the mesh, and exactly one parses it.
TEST_F(SceneCacheTest, ProcessesWaitForEachOther) {
  write(mesh_, wavy_square(300));
  std::vector<pid_t> processes;
  for (int i = 0; i < 4; ++i) {
    const pid_t process = fork();
    if (process == 0) {
      bool hit = false;
      const ObjFile obj = load(&hit);
      _exit(obj.mesh.triangle_count() != 2 * 300 * 300 ? 2 : hit ? 1 : 0);
    }
    processes.push_back(process);
  }
  int parsed = 0, hits = 0;
  for (const pid_t process : processes) {
    int status = 0;
    waitpid(process, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    parsed += WEXITSTATUS(status) == 0, hits += WEXITSTATUS(status) == 1;
  }
  EXPECT_EQ(parsed, 1);
  EXPECT_EQ(hits, 3);
}

}  // namespace
}  // namespace oktett::scene_cache_test
