// Files that may have been meant instead of one that does not exist.

#include <filesystem>

#include "io/mesh/load/load_mesh.h"
#include "io/text/files.h"
#include "tests/io/obj_test_support.h"

namespace oktett::test::similar_file_test {
namespace {

struct Files {
  TempDir dir;
  Files(std::initializer_list<const char*> names) {
    for (const char* name : names) dir.write(name, "");
  }
  std::string hint(const std::string& name) const { return did_you_mean_file(dir.file(name)); }
};

TEST(SimilarFile, TypingErrors) {
  const Files files{"bunny.obj", "teapot.ply", "brick wall.png", "a.obj"};
  EXPECT_EQ(files.hint("buny.obj"), "; did you mean 'bunny.obj'?");
  EXPECT_EQ(files.hint("Bunny.OBJ"), "; did you mean 'bunny.obj'?");
  EXPECT_EQ(files.hint("teapots.ply"), "; did you mean 'teapot.ply'?");
  EXPECT_EQ(files.hint("brickwall.png"), "; did you mean 'brick wall.png'?");
  EXPECT_EQ(files.hint("lantern.obj"), "");
  EXPECT_EQ(files.hint("b.obj"), "");
  EXPECT_EQ(files.hint(""), "");
  EXPECT_EQ(files.hint("no folder/bunny.obj"), "");
}

TEST(SimilarFile, OtherEnds) {
  const Files files{"brick.png", "room.yaml", "chair.obj"};
  EXPECT_EQ(files.hint("brick.jpg"), "; did you mean 'brick.png'?");
  EXPECT_EQ(files.hint("room.yml"), "; did you mean 'room.yaml'?");
  // The materials of a mesh are no mesh.
  EXPECT_EQ(files.hint("chair.mtl"), "");
}

TEST(SimilarFile, OnlyFilesThatCanBeRead) {
  const Files files{};
  std::filesystem::create_directory(files.dir.file("bunny.obj"));
  EXPECT_EQ(files.hint("buny.obj"), "");
}

/// Links that lead nowhere are similar to each other, and to themselves.
TEST(SimilarFile, LinksThatLeadNowhere) {
  const Files files{};
  for (const char* name : {"bunny.obj", "bunny2.obj", "buny.obj"})
    std::filesystem::create_symlink("nowhere", files.dir.file(name));
  EXPECT_EQ(files.hint("bunny.obj"), "");
  EXPECT_EQ(files.hint("bunn.obj"), "");
  EXPECT_EQ(why_unreadable(files.dir.file("bunny.obj")), "no such file");
}

/// Equal ones in the order of names, whatever the order of the folder.
TEST(SimilarFile, TheFirstOfEquals) {
  const Files files{"brick4.png", "brick2.png", "brick3.png"};
  EXPECT_EQ(files.hint("brick1.png"), "; did you mean 'brick2.png'?");
}

TEST(SimilarFile, ErrorsOfReadersNameIt) {
  const ObjFiles files;
  files.write("bunny.obj", kSquare + "f 1 2 3\n");
  try {
    load_mesh(files.dir.file("buny.obj"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(files.without_directory(e.what()),
              "buny.obj: cannot read: No such file or directory; did you mean 'bunny.obj'?");
  }
}

TEST(SimilarFile, WarningsOfMaterialsNameThem) {
  const ObjFiles files;
  files.write("colours.mtl", "newmtl gold\nnewmtl silver\n");
  EXPECT_EQ(
      files.warnings("mtllib colors.mtl\n" + kSquare + "f 1 2 3\n"),
      std::vector<std::string>{"mesh.obj:1:1: warning: colors.mtl: cannot read: No such file or directory; "
                               "did you mean 'colours.mtl'?; its materials are replaced by a grey one"});
  EXPECT_EQ(
      files.warnings("mtllib colours.mtl\n" + kSquare + "usemtl glod\nf 1 2 3\nusemtl tin\nf 1 2 4\n"),
      (std::vector<std::string>{
          "mesh.obj:6:1: warning: material 'glod' is not defined; a grey one is used; did you mean 'gold'?",
          "mesh.obj:8:1: warning: material 'tin' is not defined; a grey one is used"}));
}

}  // namespace
}  // namespace oktett::test::similar_file_test
