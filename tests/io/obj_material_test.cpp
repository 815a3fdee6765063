#include "io/obj/parsed_obj.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/io/obj_test_support.h"

namespace oktett::test::obj_material_test {
namespace {

using Slots = std::vector<std::uint16_t>;

std::vector<std::string> names_of(const ObjFile& file) {
  std::vector<std::string> names;
  for (const Material& material : file.materials) names.push_back(material.name);
  return names;
}

const std::string kFace = "f 1 2 3\n";

TEST(ObjMaterials, SlotsFollowTheOrderOfFirstUse) {
  const ObjFiles files;
  files.dir.write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl unused\nnewmtl blue\nKd 0 0 1\n");
  const ObjFile file = files.load("mtllib m.mtl\n" + kSquare + "usemtl blue\n" + kFace + "usemtl red\n" +
                                  kFace + kFace + "usemtl unused\nusemtl blue\nf 1 2 3 4\n");
  EXPECT_EQ(names_of(file), (std::vector<std::string>{"blue", "red"}));
  EXPECT_EQ(file.materials[0].color, (Color{0, 0, 1}));
  EXPECT_EQ(to_vector(file.mesh.material_slots), (Slots{0, 1, 1, 0, 0}));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(ObjMaterials, FacesBeforeTheFirstUseHaveADefault) {
  const ObjFiles files;
  files.dir.write("m.mtl", "newmtl a\n");
  const ObjFile file =
      files.load("mtllib m.mtl\n" + kSquare + kFace + "usemtl a\n" + kFace + "usemtl\n" + kFace);
  EXPECT_EQ(names_of(file), (std::vector<std::string>{"default", "a"}));
  EXPECT_EQ(file.materials[0].color, Material{}.color);
  EXPECT_EQ(to_vector(file.mesh.material_slots), (Slots{0, 1, 0}));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(ObjMaterials, WithoutUseThereAreNone) {
  const ObjFiles files;
  files.dir.write("m.mtl", "newmtl a\n");
  for (const std::string& text :
       {"mtllib m.mtl\n" + kSquare + kFace, kSquare + kFace + "usemtl a\n", kSquare + "usemtl a\n"}) {
    const ObjFile file = files.load(text);
    EXPECT_TRUE(file.materials.empty());
    EXPECT_TRUE(file.mesh.material_slots.empty());
  }
}

TEST(ObjMaterials, CommentsAndEscapedBlanksAreNoPartOfNames) {
  const ObjFiles files;
  files.dir.write("m.mtl",
                  "newmtl red # warm\nKd 1 0 0\nnewmtl dark blue\nKd 0 0 1\nnewmtl a #1\nKd 0 1 0\n");
  files.dir.write("my n.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n");
  const ObjFile file = files.load("mtllib m.mtl # of the house\nmtllib my\\ n.mtl\n" + kSquare +
                                  "usemtl red\n" + kFace + "usemtl dark\\ blue # cold\n" + kFace +
                                  "usemtl a #1\n" + kFace + "usemtl grey # x\n" + kFace);
  EXPECT_EQ(files.as_text(file.warnings), std::vector<std::string>{});
  ASSERT_EQ(file.materials.size(), 4u);
  EXPECT_EQ(file.materials[0].color, (Color{1, 0, 0}));
  EXPECT_EQ(file.materials[1].color, (Color{0, 0, 1}));
  EXPECT_EQ(file.materials[2].color, (Color{0, 1, 0}));
  EXPECT_EQ(file.materials[3].color, (Color{0.5f, 0.5f, 0.5f}));
}

TEST(ObjMaterials, UndefinedOnesAreGreyWithOneWarning) {
  const ObjFiles files;
  const ObjFile file =
      files.load(kSquare + "usemtl my wood\n" + kFace + "usemtl b\n" + kFace + "usemtl my wood \t\n" + kFace);
  EXPECT_EQ(names_of(file), (std::vector<std::string>{"my wood", "b"}));
  EXPECT_EQ(file.materials[0].color, Material{}.color);
  EXPECT_EQ(files.as_text(file.warnings),
            (std::vector<std::string>{
                "mesh.obj:5:1: warning: material 'my wood' is not defined; a grey one is used",
                "mesh.obj:7:1: warning: material 'b' is not defined; a grey one is used"}));
}

TEST(ObjMaterials, AMissingLibraryWarnsOnce) {
  const ObjFiles files;
  const ObjFile file = files.load("# x\nmtllib none.mtl\nmtllib none.mtl\n" + kSquare + "usemtl a\n" + kFace +
                                  "usemtl b\n" + kFace);
  EXPECT_EQ(names_of(file), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(files.as_text(file.warnings),
            (std::vector<std::string>{
                "mesh.obj:2:1: warning: none.mtl: cannot read: No such file or directory; its "
                "materials are replaced by a grey one"}));
}

TEST(ObjMaterials, LibrariesMayBeSeveralWithBlanksInTheirNames) {
  const ObjFiles files;
  files.dir.write("my first.mtl", "newmtl a\nKd 1 0 0\nmap_Kd t.png\n");
  files.dir.write("sub/second.MTL", "newmtl b\nKd 0 1 0\nmap_Kd t.png\nnewmtl a\nKd 0 0 1\n");
  files.dir.write("third", "newmtl c\nKd 0 0 1\n");
  const std::string use = kSquare + "usemtl a\n" + kFace + "usemtl b\n" + kFace + "usemtl c\n" + kFace;
  for (const std::string libraries :
       {"mtllib my first.mtl\nmtllib sub/second.MTL\nmtllib third\n",
        "mtllib my first.mtl sub/second.MTL  third \n", "mtllib\tmy first.mtl sub\\second.MTL third\r\n"}) {
    const ObjFile file = files.load(libraries + use);
    EXPECT_EQ(files.as_text(file.warnings), std::vector<std::string>{}) << libraries;
    ASSERT_EQ(file.materials.size(), 3u);
    EXPECT_EQ(file.materials[0].color, (Color{1, 0, 0}));
    EXPECT_EQ(file.materials[1].color, (Color{0, 1, 0}));
    EXPECT_EQ(file.materials[2].color, (Color{0, 0, 1}));
    ASSERT_EQ(file.textures.size(), 2u);
    EXPECT_EQ(files.without_directory(file.textures[0].path), "t.png");
    EXPECT_EQ(files.without_directory(file.textures[1].path).substr(0, 3), "sub");
  }
}

TEST(ObjMaterials, OnlyTexturesInUseAreKept) {
  const ObjFiles files;
  files.dir.write("m.mtl",
                  "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\nmap_Ks c.png\nnewmtl c\nmap_Kd c.png\n");
  const ObjFile file = files.load("mtllib m.mtl\n" + kSquare + "usemtl c\n" + kFace + "usemtl b\n" + kFace);
  ASSERT_EQ(file.textures.size(), 2u);
  EXPECT_EQ(files.without_directory(file.textures[file.materials[0].color_texture].path), "c.png");
  EXPECT_EQ(files.without_directory(file.textures[file.materials[1].color_texture].path), "b.png");
  EXPECT_EQ(file.materials[1].specular_texture, file.materials[0].color_texture);
}

TEST(ObjMaterials, TexturesKnowWhereTheyAreNamed) {
  const ObjFiles files;
  files.dir.write("m.mtl",
                  "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n  map_Ks c.png\nnewmtl c\nmap_Kd c.png\n");
  const ObjFile file = files.load("mtllib m.mtl\n" + kSquare + "usemtl c\n" + kFace + "usemtl b\n" + kFace);
  ASSERT_EQ(file.texture_places.size(), file.textures.size());
  for (std::size_t i = 0; i < file.textures.size(); ++i)
    EXPECT_EQ(files.without_directory(to_string(file.texture_places[i])),
              files.without_directory(file.textures[i].path) == "b.png" ? "m.mtl:4:1" : "m.mtl:5:3");
}

// The textures of the principled model are renumbered like all others, here and in scenes.
TEST(ObjMaterials, PrincipledTexturesAreRenumbered) {
  const ObjFiles files;
  files.dir.write("m.mtl", "newmtl a\nmap_Kd a.png\nmap_Pr b.png\nnewmtl b\nmap_Pr c.png\nmap_Pm d.png\n");
  const ObjFile file = files.load("mtllib m.mtl\n" + kSquare + "usemtl b\n" + kFace);
  ASSERT_EQ(file.textures.size(), 2u);
  ASSERT_TRUE(file.materials[0].principled);
  const PrincipledMaterial& b = *file.materials[0].principled;
  EXPECT_EQ(files.without_directory(file.textures.at(b.roughness_texture).path), "c.png");
  EXPECT_EQ(files.without_directory(file.textures.at(b.metallic_texture).path), "d.png");
}

TEST(ObjMaterials, WarningsOfLibrariesAreHandedOn) {
  const ObjFiles files;
  files.dir.write("m.mtl", "newmtl a\nNs x\n");
  EXPECT_EQ(files.warnings("mtllib m.mtl\n" + kSquare + "foo\nusemtl a\n" + kFace),
            (std::vector<std::string>{"mesh.obj:6:1: warning: unknown keyword 'foo' is ignored",
                                      "m.mtl:2:4: warning: expected a finite number, found 'x'"}));
}

TEST(ObjMaterials, MoreThanSlotsCanTellApart) {
  const ObjFiles files;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib none.mtl\n";
  for (int i = 0; i < 65535; ++i) text += "usemtl " + std::to_string(i) + "\nf 1 2 3\n";
  const ObjFile file = files.load(text);
  EXPECT_EQ(file.materials.size(), 65535u);
  EXPECT_EQ(file.mesh.material_slots[65534], 65534);
  EXPECT_EQ(files.error(text + "usemtl more\nf 1 2 3\n"), "mesh.obj:131075:1: more than 65535 materials");
}

}  // namespace
}  // namespace oktett::test::obj_material_test
