
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "io/scene/scene_file.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett::stand_ins_test {
namespace {

std::string written(const std::string& name, const std::string& content) {
  const std::string path = (std::filesystem::temp_directory_path() / name).string();
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

// While an object exists, the file of another name is read, also where the first does not exist.
TEST(StandIns, AreReadInPlaceOfFiles) {
  const std::string real = written("oktett_stand_in_real", "real");
  const std::string other = written("oktett_stand_in_other", "other");
  {
    const StandIns files({{real, other}, {"no/such/file", other}});
    EXPECT_EQ(MappedFile(real).text(), "other");
    EXPECT_EQ(MappedFile("no/such/file").text(), "other");
    EXPECT_EQ(why_unreadable("no/such/file"), "");
    EXPECT_NE(why_unreadable("no/such/file2"), "");
  }
  EXPECT_EQ(MappedFile(real).text(), "real");
  EXPECT_NE(why_unreadable("no/such/file"), "");
}

// Files are noted and errors are told by the names that were asked for.
TEST(StandIns, KeepTheNamesOfFiles) {
  const std::string scene = written("oktett_stand_in_scene", "oktett: 1\nobjects: [{mesh: {file: a.obj}}]\n");
  const std::string mesh = written("oktett_stand_in_mesh", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  const StandIns files({{"none/scene.yaml", scene}, {"none/a.obj", mesh}});
  const FilesRead noted;
  try {
    load_scene("none/scene.yaml");
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.where().file, "none/a.obj") << error.what();
    EXPECT_EQ(error.where().line, 4);
  }
  EXPECT_EQ(noted.paths(), (std::vector<std::string>{"none/a.obj", "none/scene.yaml"}));
}

}  // namespace
}  // namespace oktett::stand_ins_test
