#include "io/off/off.h"

#include <gtest/gtest.h>

#include "core/mesh_geometry.h"
#include "tests/io/mesh_test_support.h"

namespace oktett::test::off_test {
namespace {

struct OffFiles : ParsedFiles<parse_off> {
  OffFiles() : ParsedFiles("a.off") {}
};

const std::string kPoints = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::vector<std::uint32_t> indices_of(const std::string& text) {
  const OffFiles files;
  const MeshFile file = files.load(text);
  EXPECT_EQ(files.warnings(text), std::vector<std::string>{}) << text;
  return to_vector(file.mesh.indices);
}

TEST(Off, AllWaysToBeginAFile) {
  const std::vector<std::uint32_t> expected{0, 1, 2};
  for (const char* header : {"OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF4 1 0\n", "4 1 0\n", "# a\n\nOFF # b\n4 1\n",
                             "\xef\xbb\xbfOFF\r\n4 1 5\r\n"})
    EXPECT_EQ(indices_of(header + kPoints + "3 0 1 2\n"), expected) << header;
  EXPECT_EQ(indices_of("OFF 4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2"), expected);
}

TEST(Off, PolygonsAreCut) {
  EXPECT_EQ(indices_of("OFF\n4 1 0\n" + kPoints + "4 0 1 2 3\n").size(), 6u);
  // A concave one.
  const MeshFile file = OffFiles().load("OFF\n5 1 0\n0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n0 2 0\n5 0 1 2 3 4\n");
  double area = 0;
  for (std::size_t i = 0; i < file.mesh.triangle_count(); ++i) area += area_normal(file.mesh, i).z / 2;
  EXPECT_EQ(file.mesh.triangle_count(), 3u);
  EXPECT_DOUBLE_EQ(area, 2.5);
}

TEST(Off, WhatVerticesHoldStandsInTheHeader) {
  const OffFiles files;
  const MeshFile file = files.load(
      "STCNOFF\n3 1 0\n0 0 0  0 0 1  255 0 0 255  0.25 0.5\n1 0 0  0 1 0  1 0 0  0.75 0.5\n0 1 0  1 0 0  0 1 "
      "0 1  0 1\n"
      "3 0 1 2\n");
  EXPECT_EQ(file.mesh.normals[1], (Vec3f{0, 1, 0}));
  EXPECT_EQ(file.mesh.uvs[0], (Vec2f{0.25f, 0.5f}));
  EXPECT_EQ(file.mesh.uvs[1], (Vec2f{0.75f, 0.5f}));
  EXPECT_EQ(to_vector(file.mesh.normal_indices), to_vector(file.mesh.indices));
  EXPECT_EQ(to_vector(file.mesh.uv_indices), to_vector(file.mesh.indices));
  EXPECT_EQ(file.warnings.size(), 1u);
  EXPECT_TRUE(to_string(file.warnings.at(0)).ends_with("a.off:3:15: warning: colours are not read"));
}

TEST(Off, ColoursOfVerticesNeedNoHeader) {
  const OffFiles files;
  for (const char* color : {" 1.0 0.0 0.5", " 255 0 7 255"}) {
    std::string text = "OFF\n\n4 1\n\n";
    for (const char* point : {"0 0 0", "1 0 0", "1 1 0", "0 1 0"})
      text += std::string(point) + color + "\n# c\n\n";
    const MeshFile file = files.load(text + "4 0 1 2 3\n");
    EXPECT_EQ(file.mesh.positions[3], (Vec3f{0, 1, 0}));
    EXPECT_EQ(file.mesh.triangle_count(), 2u);
    EXPECT_EQ(file.warnings.size(), 1u);
  }
  // Two vertices on a line are none of them, also where faces have as many words.
  EXPECT_EQ(indices_of("OFF\n4 1 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n3 0 1 2\n"),
            (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(indices_of("OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n5 0 1 2 3 0\n5 0 1 2 3 0\n").size(), 18u);
}

TEST(Off, ColorsOfFacesAreNoCorners) {
  const OffFiles files;
  const std::string text =
      "OFF\n4 3 0\n" + kPoints + "3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 0.5 1 # half\n3 1 2 3 7\n";
  EXPECT_EQ(to_vector(files.load(text).mesh.indices),
            (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 1, 2, 3}));
  EXPECT_EQ(files.warnings(text), std::vector<std::string>{"a.off:7:9: warning: colours are not read"});
}

TEST(Off, DamageIsRefusedWithItsPlace) {
  const OffFiles files;
  const std::pair<std::string, const char*> cases[] = {
      {"", "1:1: expected 'OFF', also with ST, C or N before it, found the end of the file"},
      {"solid a", "1:1: expected 'OFF', also with ST, C or N before it, found 'solid'"},
      {"4OFF\n", "1:1: expected the number of vertices, found '4OFF'"},
      {"nOFF\n3\n", "1:1: OFF files of four or more dimensions are not read"},
      {"OFF BINARY\n", "1:5: OFF files of bytes are not read; expected text"},
      {"OFF\n4\n", "3:1: expected the number of faces, found the end of the file"},
      {"OFF\n4 1 0\n0 0 0\n", "2:6: the file is too short for 4 vertices and 1 faces"},
      {"OFF\n9999999999999 1 0\n", "a.off: 9999999999999 vertices, but indices reach only 4294967294"},
      {"OFF\n4 1 0\n" + kPoints, "7:1: expected the number of corners, found the end of the file"},
      {"OFF\n4 1 0\n" + kPoints + "3 0 1 4\n",
       "7:7: vertex index 4 is out of range: the file has 4 vertices"},
      {"OFF\n4 1 0\n" + kPoints + "3 0 1 -1\n", "7:7: expected a vertex index, found '-1'"},
      {"OFF\n4 1 0\n" + kPoints + "99 0 1 2\n", "7:1: the file is too short for a face of 99 corners"},
      {"OFF\n4 1 0\n0 0 x\n" + kPoints + "3 0 1 2\n", "3:5: expected a number, found 'x'"},
      {"OFF\n4 1 0\n0 nan 0\n" + kPoints + "3 0 1 2\n", "3:3: expected a finite number, found 'nan'"},
  };
  for (const auto& [text, message] : cases) {
    const std::string error = files.error(text);
    EXPECT_EQ(error, message[0] == 'a' ? std::string(message) : std::string("a.off:") + message) << text;
  }
}

TEST(Off, CutShortAtEveryByte) {
  const OffFiles files;
  const std::string text = "OFF\n4 2 0\n" + kPoints + "3 0 1 2\n3 0 2 3";
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_NE(files.error(text.substr(0, size)), "no error") << size;
}

}  // namespace
}  // namespace oktett::test::off_test
