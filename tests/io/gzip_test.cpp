#include <zlib.h>

#include "io/text/file_content.h"
#include "tests/io/gltf_test_support.h"
#include "tests/io/ply_test_support.h"
#include "tests/support/gzip.h"

namespace oktett::test::gzip_test {
namespace {

std::string unpack(const std::string& packed) {
  const UnpackedBytes bytes = unpack_gzip("a.gz", packed, 64);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(bytes.data()[bytes.size + i], 0);
  return {bytes.data(), bytes.size};
}

std::string error(const std::string& packed) {
  try {
    unpack(packed);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Gzip, AllSizes) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 300'000; size = size * 3 + 1) {
    std::string text(size, 'x');
    for (char& c : text) c = static_cast<char>(random() % (random() % 3 == 0 ? 256 : 2));
    EXPECT_EQ(unpack(gzip(text)), text);
  }
}

TEST(Gzip, MembersFollowEachOther) {
  EXPECT_EQ(unpack(gzip("one ") + gzip("") + gzip("two")), "one two");
  EXPECT_EQ(unpack(gzip("one") + std::string(100, '\0')), "one");
}

TEST(Gzip, DamageIsSaid) {
  const std::string good = gzip(std::string(1000, 'x') + "y");
  EXPECT_EQ(error(good), "no error");
  EXPECT_EQ(error(""), "a.gz: cannot be unpacked: the file is empty");
  EXPECT_EQ(error("text"), "a.gz: cannot be unpacked: byte 2: incorrect header check");
  EXPECT_EQ(error(good + "text"),
            "a.gz: cannot be unpacked: byte " + std::to_string(good.size() + 2) + ": incorrect header check");
  EXPECT_EQ(error(good + std::string(5, '\0') + "x"), "a.gz: cannot be unpacked: byte " +
                                                          std::to_string(good.size() + 5) +
                                                          ": something else follows the data");
  for (std::size_t size = 1; size < good.size(); ++size)
    EXPECT_EQ(error(good.substr(0, size)), "a.gz: cannot be unpacked: the file ends at byte " +
                                               std::to_string(size) + ", before its data do");
  std::string wrong = good;
  wrong[good.size() - 8] ^= 1;
  EXPECT_NE(error(wrong).find("incorrect data check"), std::string::npos);
  wrong = good;
  wrong[good.size() - 1] ^= 1;
  EXPECT_NE(error(wrong).find("incorrect length check"), std::string::npos);
}

// A hundred kilobytes that would become a hundred megabytes.
TEST(Gzip, BombsAreRefused) {
  const std::string packed = gzip(std::string(100'000'000, '\0'));
  ASSERT_LT(packed.size(), 200'000u);
  with_little_memory([&] {
    EXPECT_EQ(error(packed), "a.gz: cannot be unpacked: it holds more than " +
                                 std::to_string(most_unpacked(packed.size())) +
                                 " bytes, too many for a file of " + std::to_string(packed.size()));
  });
  EXPECT_EQ(unpack(gzip(std::string(16'000'000, '\0'))).size(), 16'000'000u);
}

// Meshes of all formats are the same packed and unpacked, and errors name the line in the text.
TEST(Gzip, MeshesOfAllFormats) {
  const ObjFiles files;
  std::mt19937 random(2);
  MeshModel model = random_model(random, true, true, false);
  while (model.faces.empty()) model = random_model(random, true, true, false);
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\nendsolid a\n";
  GltfWriter gltf;
  gltf.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::pair<const char*, std::string> meshes[] = {
      {"a.obj", obj_text(model)},
      {"a.ply", ply_bytes(model)},
      {"b.PLY", ply_bytes(model, {.format = PlyFormat::big_endian})},
      {"a.stl", stl},
      {"a.glb", gltf.glb(one_node("{\"attributes\":{\"POSITION\":0}}"))},
      {"a.gltf", gltf.text(one_node("{\"attributes\":{\"POSITION\":0}}"))}};
  for (const auto& [name, bytes] : meshes) {
    const MeshFile plain = load_mesh(files.write(name, bytes));
    EXPECT_GT(plain.mesh.triangle_count(), 0u);
    expect_same_mesh(load_mesh(files.write(std::string(name) + ".gz", gzip(bytes))).mesh, plain.mesh);
  }
  try {
    load_mesh(files.write("bad.obj.GZ", gzip("v 0 0 0\nv 1 x 0\n")));
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(files.without_directory(e.what()), "bad.obj.GZ:2:5: expected a number, found 'x'");
  }
  EXPECT_TRUE(is_mesh_file("a.stl.gz"));
  EXPECT_FALSE(is_mesh_file("a.gz"));
  EXPECT_TRUE(repeats_vertices("a.stl.gz"));
}

}  // namespace
}  // namespace oktett::test::gzip_test
