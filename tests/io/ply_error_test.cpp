#include <algorithm>

#include "tests/io/ply_test_support.h"

namespace oktett::test::ply_error_test {
namespace {

const std::string kHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kBody = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";

/// The error of the good file with `part` replaced.
std::string error_with(const std::string& part, const std::string& other) {
  const PlyFiles files;
  std::string text = kHeader + kBody;
  return files.error(text.replace(text.find(part), part.size(), other));
}

TEST(PlyError, Headers) {
  EXPECT_EQ(error_with("", ""), "no error");
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"ply\n", "plx\n"}, "1:1: expected 'ply', which begins a PLY file, found 'plx'"},
      {{"ply\n", "ply x\n"}, "1:1: expected 'ply', which begins a PLY file, found 'ply'"},
      {{"format ascii 1.0\n", ""}, "8:1: expected a line 'format' before the end of the header"},
      {{"format ascii", "format binary"},
       "2:8: expected 'ascii', 'binary_little_endian' or 'binary_big_endian', found 'binary'"},
      {{"1.0", "1.1"}, "2:14: expected version 1.0, found '1.1'"},
      {{"1.0", ""}, "2:14: expected 'format KIND 1.0', found the end of the line"},
      {{"element vertex", "format ascii 1.0\nelement vertex"}, "3:1: a second line 'format'"},
      {{"element vertex 4", "element vertex -4"}, "3:16: expected the number of elements, found '-4'"},
      {{"element vertex 4", "element vertex 4x"}, "3:16: expected the number of elements, found '4x'"},
      {{"element vertex 4", "element vertex"},
       "3:15: expected 'element NAME COUNT', found the end of the line"},
      {{"element vertex 4\n", ""}, "3:1: expected an 'element' before its properties"},
      {{"element face", "element vertex"}, "7:9: a second element 'vertex'"},
      {{"float y", "float x"}, "3:1: expected the properties x, y and z of element 'vertex'"},
      {{"element face", "elment face"},
       "7:1: expected 'comment', 'obj_info', 'format', 'element', 'property' or 'end_header', found "
       "'elment'"},
      {{"float y", "flat y"},
       "5:10: unknown type 'flat'; expected char, uchar, short, ushort, int, uint, float or double"},
      {{"float y", "float"}, "5:15: expected 'property TYPE NAME', found the end of the line"},
      {{"float y", "float y z"}, "5:18: expected 'property TYPE NAME', found 'z'"},
      {{"float y", "float q"}, "3:1: expected the properties x, y and z of element 'vertex'"},
      {{"element vertex", "element vertices"}, "10:1: expected an element 'vertex' in the header"},
      {{"list uchar int", "list uchar list"}, "8:21: a list of lists is not allowed"},
      {{"list uchar int", "list list int"}, "8:15: a list of lists is not allowed"},
      {{"list uchar int", "list float int"}, "8:15: the length of a list is a whole number, found 'float'"},
      {{"list uchar int", "list uchar float"},
       "8:1: expected a list of whole numbers, the indices of vertices"},
      {{"list uchar int", "int"}, "8:1: expected a list of whole numbers, the indices of vertices"},
      {{"vertex_indices", "corners"}, "7:1: expected a property 'vertex_indices' of element 'face'"},
      {{"end_header\n", ""},
       "9:1: expected 'comment', 'obj_info', 'format', 'element', 'property' or 'end_header', found '0'"},
  };
  for (const auto& [change, message] : cases)
    EXPECT_EQ(error_with(change.first, change.second), std::string("a.ply:") + message);
  const PlyFiles files;
  EXPECT_EQ(files.error(""), "a.ply:1:1: the header does not end; expected 'end_header'");
  EXPECT_EQ(files.error(kHeader.substr(0, 30)),
            "a.ply:3:10: expected 'element NAME COUNT', found the end of the line");
  EXPECT_EQ(files.error(std::string("ply\nformat\0x", 12)), "a.ply:2:7: unexpected zero byte in the header");
  std::string many = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 1001; ++i) many += "element e" + std::to_string(i) + " 0\n";
  EXPECT_EQ(files.error(many), "a.ply:1003:1: more than 1000 elements");
}

TEST(PlyError, Text) {
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"1 0 0", "1 nan 0"}, "11:3: expected a finite number, found 'nan'"},
      {{"1 0 0", "1 2e30 0"}, "11:3: coordinate out of range: '2e30' (magnitude at most 1e30)"},
      {{"1 0 0", "1 0"}, "11:4: expected a value of 'z', found the end of the line"},
      {{"1 0 0", "1 0 0 0"}, "11:7: expected the end of the line, found '0'"},
      {{"1 0 0", "1 0 z"}, "11:5: expected a number, found 'z'"},
      {{"1 0 0", "1 0 0\\\n"}, "11:6: expected the end of the line, found ''"},
      {{"3 0 1 2", "-3 0 1 2"}, "14:1: expected the length of a list, found '-3'"},
      {{"3 0 1 2", "3 0 1 4"}, "14:7: vertex index 4 is out of range: the file has 4 vertices"},
      {{"3 0 1 2", "3 0 -1 2"}, "14:5: vertex index -1 is out of range: the file has 4 vertices"},
      {{"3 0 1 2", "3 0 1.5 2"}, "14:5: expected a vertex index, found '1.5'"},
      {{"3 0 1 2", "3 0 99999999999999999999 2"},
       "14:5: vertex index 4611686018427387904 is out of range: the file has 4 vertices"},
      {{"3 0 1 2", "4 0 1 2"}, "14:1: the line is too short for a list of 4 values"},
      {{"3 0 1 2", "4000000000 0 1 2"}, "14:1: the line is too short for a list of 4000000000 values"},
      {{"3 0 1 2", "3 0 1 2 3"}, "14:9: expected the end of the line, found '3'"},
      {{"4 0 1 2 3\n", ""}, "15:1: expected 2 lines of element 'face', found 1"},
      {{"vertex 4", "vertex 9999999999999"},
       "16:1: expected 9999999999999 lines of element 'vertex', found 6"},
  };
  for (const auto& [change, message] : cases)
    with_little_memory([&, &edit = change, &wanted = message] {
      EXPECT_EQ(error_with(edit.first, edit.second), std::string("a.ply:") + wanted);
    });
}

MeshModel squares() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
          .normals = {},
          .uvs = {},
          .faces = {{{0, 1, 2}, {}}, {{0, 1, 2, 3}, {}}, {{3, 2, 1}, {}}}};
}

// A file that ends too early says so, in every form, wherever it ends.
TEST(PlyError, CutShortAtEveryByte) {
  const PlyFiles files;
  MeshModel textured = squares();
  for (MeshModel::Face& face : textured.faces) face.uvs.resize(face.corners.size());
  for (const PlyFormat format : kPlyFormats)
    for (const bool extras : {false, true})
      for (const MeshModel& model : {squares(), textured}) {
        std::string good = ply_bytes(model, {.format = format, .extras = extras});
        if (format == PlyFormat::ascii) good.pop_back();
        ASSERT_EQ(files.error(good), "no error");
        // The end of a number is a number.
        if (format == PlyFormat::ascii) good.resize(good.find_last_of(' ') + 1);
        for (std::size_t size = 0; size < good.size(); ++size) {
          const std::string error = files.error(good.substr(0, size));
          EXPECT_TRUE(error.starts_with("a.ply:")) << size << ": " << error;
        }
      }
}

TEST(PlyError, Bytes) {
  const PlyFiles files;
  for (const PlyFormat format : {PlyFormat::little_endian, PlyFormat::big_endian}) {
    const bool swap = format == PlyFormat::big_endian;
    MeshModel model = squares();
    std::size_t body = 0;
    const auto error_of = [&](PlyStyle style = {}) {
      style.format = format;
      const std::string bytes = ply_bytes(model, style);
      body = bytes.find("end_header\n") + 11;
      return files.error(bytes);
    };
    ASSERT_EQ(error_of(), "no error");
    const auto expect = [&](const std::string& error, std::size_t offset, const char* message) {
      EXPECT_EQ(error, "a.ply: byte " + std::to_string(body + offset) + ": " + message);
    };
    model.positions[1].y = NAN;
    expect(error_of(), 16, "expected a finite number, found nan");
    model.positions[1].y = -INFINITY;
    expect(error_of(), 16, "expected a finite number, found -inf");
    model.positions[1].y = 0;
    // Faces of one size, and of several.
    for (const std::size_t count : {3u, 1u}) {
      model.faces.resize(count);
      model.faces[0].corners[1] = 4;
      expect(error_of(), 48 + 1 + 4, "vertex index 4 is out of range: the file has 4 vertices");
      model.faces[0].corners[1] = static_cast<std::uint32_t>(-2);
      expect(error_of(), 48 + 1 + 4, "vertex index -2 is out of range: the file has 4 vertices");
      expect(error_of({.index = PlyType::int8}), 48 + 1 + 1,
             "vertex index -2 is out of range: the file has 4 vertices");
      model.faces[0].corners[1] = 1;
    }
    model.faces[0] = {{0, 1, 2}, {{0, 0}, {1, 0}}};
    expect(error_of(), 48 + 13, "expected 6 texture coordinates for 3 corners, or none, found 4");
    // A list of negative length.
    model = squares();
    std::string bytes = ply_bytes(model, {.format = format, .length = PlyType::int16});
    const std::size_t list = bytes.find("end_header\n") + 11 + 48;
    std::string length;
    append_bytes(length, std::int16_t{-3}, swap);
    EXPECT_EQ(files.error(bytes.replace(list, 2, length)),
              "a.ply: byte " + std::to_string(list) + ": a list of length -3");
  }
}

TEST(PlyError, CountsWithNothingBehindThemAllocateNothing) {
  const PlyFiles files;
  for (const char* count : {"1000000000", "99999999999999999999"})
    for (const char* format : {"ascii", "binary_little_endian"}) {
      const std::string vertex = std::string("ply\nformat ") + format + " 1.0\nelement vertex ";
      const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\n";
      const std::string face = "property list uint int vertex_indices\nend_header\n";
      with_little_memory([&] {
        EXPECT_NE(files.error(vertex + count + xyz + "end_header\n"), "no error");
        EXPECT_NE(files.error(vertex + "0" + xyz + "element face " + count + "\n" + face), "no error");
        EXPECT_NE(files.error(vertex + "0" + xyz + "element face 1\n" + face + "\xff\xff\xff\xff"),
                  "no error");
      });
    }
  EXPECT_EQ(files.error(ply_bytes(squares(), {.format = PlyFormat::big_endian}), {.max_elements = 3}),
            "a.ply: 4 vertices, but indices reach only 3");
}

TEST(PlyError, TextureCoordinatesMustBeFinite) {
  const PlyFiles files;
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::little_endian, PlyFormat::big_endian})
    for (const float bad : {NAN, INFINITY, -INFINITY})
      for (const bool lists : {false, true})  // of vertices: in records of one size, and of several
        for (const bool of_faces : {false, true}) {
          PlyWriter out(format);
          out.element("vertex", 3);
          for (const char* name : {"x", "y", "z", "v", "u"}) out.property(PlyType::float32, name);
          if (lists) out.list(PlyType::uint8, PlyType::uint8, "more");
          out.element("face", 1);
          out.list(PlyType::uint8, PlyType::int32, "vertex_indices");
          if (of_faces) out.list(PlyType::uint8, PlyType::float32, "texcoord");
          for (int i = 0; i < 3; ++i) {
            for (const int x : {i == 1 ? 1 : 0, i == 2 ? 1 : 0, 0, 0}) out.value(PlyType::float32, x);
            out.value(PlyType::float32, !of_faces && i == 1 ? bad : 0);
            for (int k = 0; lists && k <= i; ++k) out.value(PlyType::uint8, k == 0 ? i : 0);
            out.end_record();
          }
          for (const int x : {3, 0, 1, 2}) out.value(x == 3 ? PlyType::uint8 : PlyType::int32, x);
          if (of_faces) out.value(PlyType::uint8, 6);
          for (int i = 0; of_faces && i < 6; ++i) out.value(PlyType::float32, i == 4 ? bad : 0);
          out.end_record();
          const std::string error = files.error(out.bytes());
          EXPECT_NE(error.find("expected a finite number, found "), std::string::npos) << error;
        }
}

// Messages are the same wherever the file is cut into chunks.
TEST(PlyError, DoNotDependOnChunks) {
  const PlyFiles files;
  std::mt19937 random(3);
  const MeshModel model = random_model(random, true, true, false);
  for (const PlyFormat format : kPlyFormats) {
    const std::string good = ply_bytes(model, {.format = format});
    const std::size_t body = good.find("end_header\n") + 11;
    for (int i = 0; i < 300; ++i) {
      std::string damaged = good;
      for (int k = 0; k < 2; ++k)
        damaged[body + random() % (good.size() - body)] = static_cast<char>(random());
      const std::string whole = files.error(damaged);
      EXPECT_EQ(files.error(damaged, {.chunk_bytes = 1 + random() % 100}), whole);
    }
  }
}

}  // namespace
}  // namespace oktett::test::ply_error_test
