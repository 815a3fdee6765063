#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <utility>
#include <vector>

#include "io/obj/obj.h"
#include "tests/io/obj_test_support.h"

namespace oktett::test::obj_error_test {
namespace {

void expect_starts(const std::string& message, const std::string& part) {
  EXPECT_EQ(message.substr(0, part.size()), part) << "the whole: " << message;
}

using Cases = std::vector<std::pair<std::string, std::string>>;

/// Each text, behind the four lines of the square, fails with a message that starts like this.
void expect_errors(const Cases& cases) {
  const ObjFiles files;
  for (const auto& [text, message] : cases) expect_starts(files.error(kSquare + text), "mesh.obj:" + message);
}

TEST(ObjError, IndicesOutOfRange) {
  expect_errors({
      {"f 1 2 5", "5:7: vertex index 5 is out of range: the file defines 4"},
      {"f 1 2 0", "5:7: vertex index 0 is not allowed; indices count from 1"},
      {"f -0 1 2", "5:3: vertex index -0 is not allowed"},
      {"f 1 2 -5", "5:7: vertex index -5 is out of range: only 4 defined before it"},
      {"f 1 2 -5\nv 1 1 1", "5:7: vertex index -5 is out of range: only 4 defined before it"},
      {"vt 0 0\nf 1/1 2/0 3", "6:9: uv index 0 is not allowed; indices count from 1"},
      {"vt 0 0\nf 1/2 2 3", "6:5: uv index 2 is out of range: the file defines 1"},
      {"vn 0 0 1\nf 1//2 2 3", "6:6: normal index 2 is out of range: the file defines 1"},
      {"vn 0 0 1\nf 1//-2 2 3", "6:6: normal index -2 is out of range: only 1 defined before it"},
      {"f 1 2 4294967297", "5:7: vertex index 4294967297 is out of range"},
      {"f 1 2 18446744073709551617", "5:7: vertex index 18446744073709551617 is out of range"},
      {"f 1 2 -4294967295", "5:7: vertex index -4294967295 is out of range"},
      {"f 1 2 " + std::string(100, '9'), "5:7: vertex index " + std::string(40, '9') + "... is out of range"},
  });
}

TEST(ObjError, MalformedCorners) {
  const std::string expected = "expected a corner such as 1, 1/2, 1//3 or 1/2/3, found ";
  expect_errors({
      {"f 1 2 x", "5:7: " + expected + "'x'"},
      {"f 1 2 3x", "5:7: " + expected + "'3x'"},
      {"f 1 2 3.0", "5:7: " + expected + "'3.0'"},
      {"f 1 2 /3", "5:7: " + expected + "'/3'"},
      {"f 1 2 -", "5:7: " + expected + "'-'"},
      {"f 1 2 --3", "5:7: " + expected + "'--3'"},
      {"vt 0 0\nvn 0 0 1\nf 1 2 3/1/1/1", "7:7: " + expected + "'3/1/1/1'"},
      {"f 1 2\v3", "5:5: " + expected + "'2?3'"},
      {"f 1,2,3", "5:3: " + expected + "'1,2,3'"},
  });
}

TEST(ObjError, MalformedNumbers) {
  expect_errors({
      {"v 1 2", "5:6: expected a number, found the end of the line"},
      {"v", "5:2: expected a number, found the end of the line"},
      {"v 1 2 # 3", "5:7: expected a number, found the end of the line"},
      {"v 1 2 x", "5:7: expected a number, found 'x'"},
      {"v 1 2,5 3", "5:5: expected a number, found '2,5'"},
      {"v 1 0x10 3", "5:5: expected a number, found '0x10'"},
      {"v 1 - 3", "5:5: expected a number, found '-'"},
      {"v 1 +-2 3", "5:5: expected a number, found '+-2'"},
      {"v 1 . 3", "5:5: expected a number, found '.'"},
      {"v 1 1e 3", "5:5: expected a number, found '1e'"},
      {"v 1 1e+ 3", "5:5: expected a number, found '1e+'"},
      {"v 1 1.2.3 3", "5:5: expected a number, found '1.2.3'"},
      {"v 1 2f 3", "5:5: expected a number, found '2f'"},
      {"vt", "5:3: expected a number, found the end of the line"},
      {"vt 1 x", "5:6: expected a number, found 'x'"},
      {"vn 1 2", "5:7: expected a number, found the end of the line"},
      {"v 1 \xff 3", "5:5: expected a number, found '?'"},
  });
}

TEST(ObjError, PositionsMustBeFinite) {
  expect_errors({
      {"v 1 nan 3", "5:5: expected a finite number, found 'nan'"},
      {"v 1 -NaN 3", "5:5: expected a finite number, found '-NaN'"},
      {"v inf 2 3", "5:3: expected a finite number, found 'inf'"},
      {"v 1 2 -Infinity", "5:7: expected a finite number, found '-Infinity'"},
      {"v 1.#INF 2 3", "5:3: expected a finite number, found '1."},
      {"v 1 1e39 3", "5:5: expected a finite number, but '1e39' is out of range"},
      {"v 1 -1e999999999999999999999 3", "5:5: expected a finite number, but '-1e999999999999999999999' is"},
      {"v 1 3.4028236e38 3", "5:5: expected a finite number, but '3.4028236e38' is out of range"},
      {"v " + std::string(60, '9') + " 2 3",
       "5:3: expected a finite number, but '" + std::string(40, '9') + "...'"},
  });
}

// What is not finite would spoil every data layer of the samples that see it.
TEST(ObjError, TextureCoordinatesMustBeFinite) {
  expect_errors({
      {"vt nan 0", "5:4: expected a finite number, found 'nan'"},
      {"vt 0 -inf", "5:6: expected a finite number, found '-inf'"},
      {"vt 0 1e39", "5:6: expected a finite number, but '1e39' is out of range"},
  });
}

TEST(ObjError, BracesMustPair) {
  expect_errors({
      {"triangles {\nf 1 2 3\n", "5:1: a block is not closed; expected '}' before the end of the file"},
      {"}\n", "5:1: '}' without a block before it"},
      {"vertices {\ntriangles {\n}\n}\n", "6:1: a block starts within a block"},
      {"vertices { v 1 2 3 }\n}\n", "5:12: expected the end of the line, found 'v'"},
      {"{\n} f 1 2 3\n", "6:3: expected the end of the line, found 'f'"},
      {"vertices {\n}\n}\n", "7:1: '}' without a block before it"},
  });
}

TEST(ObjError, BinaryContent) {
  const ObjFiles files;
  expect_starts(files.error(std::string("\x7f"
                                        "ELF\x02\x01\x01\0\0\0",
                                        10)),
                "mesh.obj:1:1: expected an OBJ keyword, found '?ELF");
  expect_starts(files.error("\xff\xd8\xff\xe0 JFIF"),
                "mesh.obj:1:1: expected an OBJ keyword, found '???"
                "?'");
  expect_starts(files.error(kSquare + std::string("# comment\0 f 1 2 3\n", 19)),
                "mesh.obj:5:10: unexpected zero byte");
  expect_starts(files.error(kSquare + std::string("f 1 2 3\0\n", 9)), "mesh.obj:5:8: unexpected zero byte");
  expect_starts(files.error(std::string(100000, '\0')), "mesh.obj:1:1: unexpected zero byte");
  expect_starts(files.error("v 1 2 3\nf 1\n\x01\x02\x03\n"),
                "mesh.obj:3:1: expected an OBJ keyword, found '"
                "???"
                "'");
}

TEST(ObjError, PositionsCountAllWaysToEndALine) {
  const ObjFiles files;
  expect_starts(files.error("\r\n\r\nv 1 2 3\r\n\r\n f 1 1 2\r\n"), "mesh.obj:5:8: vertex index 2");
  expect_starts(files.error("\r\rv 1 2 3\r\r f 1 1 2\r"), "mesh.obj:5:8: vertex index 2");
  expect_starts(files.error("v 1 2 \\\n3\nf 1 \\\r\n1 2\n"), "mesh.obj:4:3: vertex index 2");
}

// Whatever the number of tasks, and whichever pass finds it.
TEST(ObjError, TheFirstErrorInTheFileIsReported) {
  const ObjFiles files;
  const std::vector<std::string> bad{"v 1 2 x\n", "f 1 2 99999\n", "}\n", "\x01\n", "f 1 2 x\n"};
  for (std::size_t first = 0; first < bad.size(); ++first) {
    std::string text = kSquare;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      for (int filler = 0; filler < 50; ++filler) text += "f 1 2 3\nv 0 0 0\n";
      text += bad[(first + i) % bad.size()];
    }
    const std::string whole = files.error(text);
    expect_starts(whole, "mesh.obj:105:");
    for (const std::size_t chunk_bytes : {1u, 7u, 64u, 300u, 1000u})
      EXPECT_EQ(files.error(text, {.chunk_bytes = chunk_bytes}), whole);
  }
}

TEST(ObjError, MoreElementsThanIndicesReach) {
  const ObjFiles files;
  const ObjOptions options{.max_elements = 3};
  expect_starts(files.error(kSquare, options), "mesh.obj: 4 vertices, but indices reach only 3");
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(files.error(three + "f 1 2 3\nf 1 2 3\nf 1 2 3\n", options), "no error");
  expect_starts(files.error(three + "f 1 2 3\nf 1 2 3 1\nf 1 2 3\n", options), "mesh.obj: 4 triangles");
  expect_starts(files.error("vt 0\nvt 0\nvt 0\nvt 0\n", options), "mesh.obj: 4 uvs");
  expect_starts(files.error("vn 0 0 0\nvn 0 0 0\nvn 0 0 0\nvn 0 0 0\n", options), "mesh.obj: 4 normals");
}

TEST(ObjError, UnreadableFilesAreInputOutputErrors) {
  const ObjFiles files;
  const auto kind_of = [](const std::string& path) {
    try {
      load_obj(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.where().file, path);
      EXPECT_EQ(e.where().line, 0);
      return e.kind();
    }
    ADD_FAILURE() << "no error for " << path;
    return ErrorKind::bad_input;
  };
  EXPECT_EQ(kind_of(files.dir.file("missing.obj")), ErrorKind::io);
  EXPECT_EQ(kind_of(files.dir.path().string()), ErrorKind::io);
  EXPECT_EQ(kind_of("/dev/null"), ErrorKind::io);
  // They look like regular files, but reading them may never end, or change something. An emulator of another
  // processor puts ordinary files in the place of some, as of /proc/self/maps (qemu-user 7.2).
  for (const char* special :
       {"/proc/self/mem", "/proc/self/status", "/proc/version", "/sys/kernel/uevent_seqnum"})
    if (std::filesystem::exists(special)) {
      EXPECT_EQ(kind_of(special), ErrorKind::io) << special;
    }
  const std::string pipe = files.dir.file("pipe.obj");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(kind_of(pipe), ErrorKind::io);
  if (geteuid() != 0) {
    const std::string secret = files.dir.write("secret.obj", kSquare);
    ASSERT_EQ(chmod(secret.c_str(), 0), 0);
    EXPECT_EQ(kind_of(secret), ErrorKind::io);
  }
}

TEST(ObjError, CoordinatesHaveADomain) {
  const ObjFiles files;
  EXPECT_EQ(files.error("v 1e30 -1e30 0\n"), "no error");
  EXPECT_EQ(files.error("v 0 0 0\nv 1 -1e36 0\n"),
            "mesh.obj:2:5: coordinate out of range: '-1e36' (magnitude at most 1e30)");
  EXPECT_EQ(files.error("v 1.001e30 0 0\n"),
            "mesh.obj:1:3: coordinate out of range: '1.001e30' (magnitude at most 1e30)");
}

TEST(ObjError, BadInputIsToldFromInputOutput) {
  try {
    ObjFiles().load("f 1 2 3\n");
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::bad_input);
    EXPECT_EQ(e.where().line, 1);
    EXPECT_EQ(e.where().column, 3);
  }
}

}  // namespace
}  // namespace oktett::test::obj_error_test
