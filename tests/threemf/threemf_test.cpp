/// \file 3MF files. Their text is written here by hand, and packed by libzip; one is written by lib3mf.

#include "io/threemf/threemf.h"

#include <Model/COM/NMR_DLLInterfaces.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "io/mesh/load/load_mesh.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/scene/scene_file.h"
#include "tests/io/scene_test_support.h"
#include "tests/support/threemf_package.h"

namespace oktett::threemf_test {
namespace {

using test::SceneFiles;
using test::TempDir;

using Parts = test::PackageParts;

void pack(const std::string& path, const Parts& parts) { ASSERT_TRUE(test::pack_parts(path, parts)); }

/// The files of a package with this text between the tags of the model.
Parts package(const std::string& content, const std::string& attributes = "unit=\"millimeter\"") {
  return test::threemf_parts(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model " + attributes +
      " xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
      "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
      "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\">" +
      content + "</model>");
}

/// A tetrahedron with corners at the origin and on the axes; each triangle has these attributes.
std::string tetrahedron(const std::string& object,
                        const std::vector<std::string>& triangles = {"", "", "", ""}) {
  const char* corners[] = {"v1=\"0\" v2=\"2\" v3=\"1\"", "v1=\"0\" v2=\"1\" v3=\"3\"",
                           "v1=\"0\" v2=\"3\" v3=\"2\"", "v1=\"1\" v2=\"2\" v3=\"3\""};
  std::string text =
      "<object " + object +
      "><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"0\" y=\"2\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"3\"/></vertices><triangles>";
  for (std::size_t i = 0; i < 4; ++i)
    text += std::string("<triangle ") + corners[i] + " " + triangles[i] + "/>";
  return text + "</triangles></mesh></object>";
}
std::string built(const std::string& resources, const std::string& items) {
  return "<resources>" + resources + "</resources><build>" + items + "</build>";
}

struct ThreeMf : ::testing::Test {
  FileScene load(const Parts& parts) {
    pack(path, parts);
    return load_threemf_scene(path);
  }
  std::string error(const Parts& parts) {
    pack(path, parts);
    return error_of_file();
  }
  std::string error_of_file() const {
    try {
      load_threemf_scene(path);
    } catch (const Error& e) {
      return files.without_directory(e.what());
    }
    return "no error";
  }

  SceneFiles files;
  std::string path = files.dir.file("a.3mf");
};

void expect_near(const Vec3d& found, const Vec3d& expected) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-6);
}

TEST_F(ThreeMf, MeshesStandWhereTheBuildPlacesThem) {
  // A point (x, y, z, 1) is a row that the matrix of four rows and three columns follows.
  const FileScene scene = load(package(
      built(tetrahedron("id=\"1\" name=\"part\""),
            "<item objectid=\"1\"/><item objectid=\"1\" transform=\"0 2 0 -1 0 0 0 0 1 10 20 30\"/>")));
  EXPECT_TRUE(scene.warnings.empty()) << to_string(scene.warnings[0]);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const TriangleMesh& mesh = *scene.meshes[0].mesh;
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[3], (Vec3f{0, 0, 3}));
  EXPECT_EQ(mesh.triangle_count(), 4u);
  EXPECT_EQ(mesh.indices[4], 1u);
  EXPECT_EQ(mesh.indices[5], 3u);
  EXPECT_TRUE(scene.materials.empty());
  ASSERT_EQ(scene.placements.size(), 2u);
  EXPECT_EQ(scene.placements[0].name, "part");
  EXPECT_TRUE(scene.placements[0].to_world.is_identity());
  expect_near(scene.placements[1].to_world.point({1, 2, 3}), {-2 + 10, 2 + 20, 3 + 30});
}

TEST_F(ThreeMf, ComponentsAreInstances) {
  const FileScene scene = load(package(
      built(tetrahedron("id=\"1\"") +
                "<object id=\"2\" name=\"pair\"><components><component objectid=\"1\"/>"
                "<component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 5 0 0\"/></components></object>"
                "<object id=\"3\"><components>"
                "<component objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 0\"/></components></object>",
            "<item objectid=\"3\" transform=\"2 0 0 0 2 0 0 0 2 0 0 7\"/>")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.placements.size(), 2u);
  EXPECT_EQ(scene.placements[1].name, "pair");
  // Moved by 5 along x, turned by a quarter about z, doubled, moved by 7 along z.
  expect_near(scene.placements[1].to_world.point({1, 0, 0}), {0, 12, 7});
  // As one mesh, and as instances.
  EXPECT_EQ(load_mesh(path).mesh.triangle_count(), 8u);
  const Scene included = files.load_v1("include: [a.3mf]\n");
  EXPECT_EQ(included.prototypes.size(), 1u);
  EXPECT_EQ(included.objects.size(), 2u);
  EXPECT_EQ(included.objects[0].name, "pair");
}

TEST_F(ThreeMf, BaseMaterialsHaveTheirColours) {
  const FileScene scene =
      load(package(built("<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/>"
                         "<base name=\"glassy\" displaycolor=\"#0080FF40\"/></basematerials>" +
                             tetrahedron("id=\"1\" pid=\"5\" pindex=\"1\"",
                                         {"", "pid=\"5\" p1=\"0\"", "", "pid=\"5\" p1=\"0\""}),
                         "<item objectid=\"1\"/>")));
  ASSERT_EQ(scene.materials.size(), 2u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const SharedMesh& shared = scene.meshes[0];
  ASSERT_EQ(shared.mesh->material_slots.size(), 4u);
  const auto material = [&](std::size_t i) -> const Material& {
    return scene.materials.at(shared.slots.at(shared.mesh->material_slots[i]));
  };
  EXPECT_EQ(material(0).name, "glassy");
  EXPECT_EQ(material(2).name, "glassy");
  EXPECT_EQ(material(1).name, "red");
  EXPECT_EQ(material(3).name, "red");
  EXPECT_EQ(material(1).color, (Color{1, 0, 0}));
  EXPECT_EQ(material(1).opacity, 1);
  // By the formula of IEC 61966-2-1.
  EXPECT_NEAR(material(0).color.y, std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_EQ(material(0).color.z, 1);
  EXPECT_FLOAT_EQ(material(0).opacity, 64.0f / 255);
}

TEST_F(ThreeMf, ColourGroupsAreColoursOfCorners) {
  const FileScene scene = load(
      package(built("<m:colorgroup id=\"7\"><m:color color=\"#FF0000\"/><m:color color=\"#00FF00\"/>"
                    "<m:color color=\"#0000FF80\"/></m:colorgroup>" +
                        tetrahedron("id=\"1\" pid=\"7\" pindex=\"0\"",
                                    {"pid=\"7\" p1=\"0\" p2=\"1\" p3=\"2\"", "", "pid=\"7\" p1=\"2\"", ""}),
                    "<item objectid=\"1\"/>")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  const TriangleMesh& mesh = *scene.meshes[0].mesh;
  const MeshAttribute* const color = find_attribute(mesh, kColorAttribute);
  ASSERT_NE(color, nullptr);
  EXPECT_EQ(color->domain, AttributeDomain::corner);
  const auto at = [&](std::size_t triangle, std::size_t corner) {
    std::array<float, 4> c{};
    for (std::uint32_t k = 0; k < 4; ++k) c[k] = corner_value(mesh, *color, triangle, corner, k);
    return c;
  };
  EXPECT_EQ(at(0, 0), (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(at(0, 1), (std::array<float, 4>{0, 1, 0, 1}));
  EXPECT_EQ(at(0, 2), (std::array<float, 4>{0, 0, 1, 128.0f / 255}));
  EXPECT_EQ(at(1, 2), (std::array<float, 4>{1, 0, 0, 1}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(at(2, k), (std::array<float, 4>{0, 0, 1, 128.0f / 255}));
  // They are shown.
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.textures.at(scene.materials[0].color_texture).attribute, kColorAttribute);
  const Texture& opacity = scene.textures.at(scene.materials[0].opacity_texture);
  EXPECT_EQ(opacity.attribute, kColorAttribute);
  EXPECT_EQ(opacity.channel, ImageChannel::alpha);
}

/// The text of a model with an image, of which a triangle shows a part, and one with a colour.
std::string textured() {
  return built(
      "<m:texture2d id=\"3\" path=\"/3D/Textures/wood.png\" contenttype=\"image/png\" tilestyleu=\"mirror\" "
      "tilestylev=\"clamp\" filter=\"nearest\"/>"
      "<m:texture2dgroup id=\"4\" texid=\"3\"><m:tex2coord u=\"0.25\" v=\"0\"/><m:tex2coord u=\"1\" "
      "v=\"0.5\"/>"
      "<m:tex2coord u=\"0\" v=\"2\"/></m:texture2dgroup>"
      "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/></basematerials>" +
          tetrahedron("id=\"1\" pid=\"5\" pindex=\"0\"",
                      {"", "", "", "pid=\"4\" p1=\"0\" p2=\"1\" p3=\"2\""}),
      "<item objectid=\"1\"/>");
}
TEST_F(ThreeMf, ImagesAreTextures) {
  const FileScene scene = load(test::with_image(package(textured()), "bytes of an image"));
  ASSERT_EQ(scene.meshes.size(), 1u);
  const SharedMesh& shared = scene.meshes[0];
  const TriangleMesh& mesh = *shared.mesh;
  const Material& wood = scene.materials.at(shared.slots.at(mesh.material_slots[3]));
  const Texture& texture = scene.textures.at(wood.color_texture);
  EXPECT_EQ(*texture.content, "bytes of an image");
  EXPECT_EQ(texture.lookup, (TextureLookup{TextureWrap::mirror, TextureWrap::clamp, TextureFilter::nearest}));
  EXPECT_EQ(scene.materials.at(shared.slots.at(mesh.material_slots[0])).color_texture, kNoId);
  const auto uvs = corner_uvs(mesh, 3);
  EXPECT_EQ(uvs[0], (Vec2f{0.25f, 0}));
  EXPECT_EQ(uvs[1], (Vec2f{1, 0.5f}));
  EXPECT_EQ(uvs[2], (Vec2f{0, 2}));
  EXPECT_EQ(mesh.uv_indices[0], kNoId);
}

TEST_F(ThreeMf, AloneItStandsUprightAsOneMesh) {
  pack(path, package(built(tetrahedron("id=\"1\""), "<item objectid=\"1\"/>")));
  const Scene scene = load_scene(path);
  EXPECT_EQ(scene.camera.up, (Vec3d{0, 0, 1}));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(std::get<MeshShape>(scene.objects[0].shape).mesh->triangle_count(), 4u);
  const Conversion converted = convert_mesh(path, files.dir.file("b.stl"), {});
  EXPECT_EQ(converted.triangles, 4u);
  EXPECT_EQ(load_mesh(files.dir.file("b.stl")).mesh.triangle_count(), 4u);
}

TEST_F(ThreeMf, TheUnitIsToldUnlessItIsMillimetres) {
  const std::string content = built(tetrahedron("id=\"1\""), "<item objectid=\"1\"/>");
  const FileScene scene = load(package(content, "unit=\"inch\""));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(files.without_directory(to_string(scene.warnings[0])),
            "a.3mf: warning: its unit is the inch; coordinates are taken as they stand");
  EXPECT_EQ(scene.meshes[0].mesh->positions[3].z, 3);
  EXPECT_TRUE(load(package(content, "")).warnings.empty());
}

TEST_F(ThreeMf, WhatIsLeftOutIsTold) {
  std::string lattice = tetrahedron("id=\"1\"");
  lattice.replace(lattice.find("</mesh>"), 0,
                  "<b:beamlattice minlength=\"0.1\" radius=\"0.2\"><b:beams><b:beam v1=\"0\" v2=\"1\"/>"
                  "<b:beam v1=\"1\" v2=\"2\"/></b:beams></b:beamlattice>");
  const FileScene scene = load(package(built(lattice, "<item objectid=\"1\"/>")));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].message, "beam lattices are not read");
  // A matrix that flattens.
  const FileScene flat = load(package(built(tetrahedron("id=\"1\" name=\"a\""),
                                            "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"/>")));
  EXPECT_TRUE(flat.placements.empty());
  ASSERT_EQ(flat.warnings.size(), 1u);
  EXPECT_EQ(flat.warnings[0].message,
            "the transform of object 'a' is singular or out of range; it is skipped");
}

// A short file may ask for any number of meshes, of which lib3mf would visit each.
TEST_F(ThreeMf, ComponentsDoNotMultiplyWithoutEnd) {
  std::string objects = tetrahedron("id=\"1\"");
  for (int i = 2; i < 24; ++i) {
    const std::string inner = "<component objectid=\"" + std::to_string(i - 1) + "\"/>";
    objects +=
        "<object id=\"" + std::to_string(i) + "\"><components>" + inner + inner + "</components></object>";
  }
  EXPECT_EQ(error(package(built(objects, "<item objectid=\"23\"/>"))),
            "a.3mf: its components show more than 1000000 objects");
  objects = tetrahedron("id=\"1\"");
  for (int i = 2; i < 90; ++i)
    objects += "<object id=\"" + std::to_string(i) + "\"><components><component objectid=\"" +
               std::to_string(i - 1) + "\"/></components></object>";
  EXPECT_EQ(error(package(built(objects, "<item objectid=\"89\"/>"))),
            "a.3mf: its components are nested deeper than 64 levels");
}

/// What lib3mf does not take for the number, the part or the owner of a component is not taken for it here.
TEST_F(ThreeMf, ComponentsAreCountedAsTheLibraryReadsThem) {
  const auto objects = [](int count, const std::string& attributes, const std::string& beside) {
    std::string text = tetrahedron("id=\"1\"");
    for (int i = 2; i < count; ++i) {
      const std::string inner = "<component objectid=\"" + std::to_string(i - 1) + "\" " + attributes + "/>";
      text += "<object id=\"" + std::to_string(i) + "\"><components>" + beside + inner + inner +
              "</components></object>";
    }
    return built(text, "<item objectid=\"" + std::to_string(count - 1) + "\"/>");
  };
  const std::string extension = "xmlns:x=\"http://example.com/x\" ";
  for (const std::string& attributes :
       {extension + "x:objectid=\"1\"", extension + "x:path=\"/q\"", std::string("path=\"/q\"")})
    EXPECT_EQ(error(package(objects(24, attributes, ""))),
              "a.3mf: its components show more than 1000000 objects")
        << attributes;
  EXPECT_EQ(error(package(objects(24, "", "<x:object " + extension + "id=\"777\"/>"))),
            "a.3mf: cannot be read as a 3MF file: an object begins inside another one");
}

TEST_F(ThreeMf, FilesThatUnpackToTooMuchAreErrors) {
  Parts parts = package(built(tetrahedron("id=\"1\""), "<item objectid=\"1\"/>"));
  parts["Metadata/zeros.bin"] = std::string(std::size_t{24} << 20, '\0');
  const std::string found = error(parts);
  EXPECT_NE(found.find("a.3mf: cannot be unpacked: it holds more than "), std::string::npos) << found;
  EXPECT_NE(found.find("bytes, too many for a file of "), std::string::npos) << found;
}

TEST_F(ThreeMf, BadFilesAreErrors) {
  const std::string item = "<item objectid=\"1\"/>";
  std::string wrong = tetrahedron("id=\"1\"");
  wrong.replace(wrong.find("v3=\"1\""), 6, "v3=\"9\"");
  EXPECT_EQ(error(package(built(wrong, item))).rfind("a.3mf: cannot be read as a 3MF file: ", 0), 0u);
  EXPECT_EQ(error(package(built(tetrahedron("id=\"1\""), "<item objectid=\"2\"/>")))
                .rfind("a.3mf: cannot be read as a 3MF file: ", 0),
            0u);
  EXPECT_EQ(error(package("<resources>")).rfind("a.3mf: cannot be read as a 3MF file: ", 0), 0u);
  wrong = tetrahedron("id=\"1\" name=\"far\"");
  wrong.replace(wrong.find("z=\"3\""), 5, "z=\"3e35\"");
  EXPECT_EQ(error(package(built(wrong, item))).rfind("a.3mf: cannot be read as a 3MF file: ", 0), 0u);
  EXPECT_EQ(error({{"a.txt", "no 3MF"}}).rfind("a.3mf: cannot be read as a 3MF file: ", 0), 0u);
  files.dir.write("a.3mf", "no archive");
  EXPECT_EQ(error_of_file().rfind("a.3mf: cannot be unpacked: as a ZIP archive: ", 0), 0u) << error_of_file();
  files.dir.write("a.3mf", "");
  EXPECT_EQ(error_of_file().rfind("a.3mf: cannot be read as a 3MF file: ", 0), 0u) << error_of_file();
  // A bit that is wrong in the packed model.
  pack(path, package(built(tetrahedron("id=\"1\""), item)));
  std::string bytes = test::file_content(path);
  bytes[bytes.find("3D/3dmodel.model") + 80] ^= 4;
  files.dir.write("a.3mf", bytes);
  EXPECT_EQ(error_of_file().rfind("a.3mf: cannot be unpacked: 3D/3dmodel.model: ", 0), 0u) << error_of_file();
}

TEST_F(ThreeMf, FilesOfLib3mfAreRead) {
  using namespace NMR;
  PLib3MFModel* model = nullptr;
  ASSERT_EQ(lib3mf_createmodel(&model), 0);
  PLib3MFModelMeshObject* mesh = nullptr;
  ASSERT_EQ(lib3mf_model_addmeshobject(model, &mesh), 0);
  MODELMESHVERTEX vertices[] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1.5f}}};
  MODELMESHTRIANGLE triangles[] = {{{0, 2, 1}}, {{0, 1, 3}}, {{0, 3, 2}}, {{1, 2, 3}}};
  ASSERT_EQ(lib3mf_meshobject_setgeometry(mesh, vertices, 4, triangles, 4), 0);
  ASSERT_EQ(lib3mf_object_setnameutf8(mesh, "tet"), 0);
  PLib3MFPropertyHandler* handler = nullptr;
  ASSERT_EQ(lib3mf_meshobject_createpropertyhandler(mesh, &handler), 0);
  for (DWORD i = 0; i < 4; ++i)
    ASSERT_EQ(lib3mf_propertyhandler_setsinglecolorrgba(handler, i, 255, 0, static_cast<BYTE>(50 * i), 255),
              0);
  PLib3MFDefaultPropertyHandler* usual = nullptr;
  ASSERT_EQ(lib3mf_object_createdefaultpropertyhandler(mesh, &usual), 0);
  ASSERT_EQ(lib3mf_defaultpropertyhandler_setcolorrgba(usual, 255, 0, 0, 255), 0);
  MODELTRANSFORM transform{{{1, 0, 0, 3}, {0, 1, 0, 4}, {0, 0, 1, 5}}};
  PLib3MFModelBuildItem* item = nullptr;
  ASSERT_EQ(lib3mf_model_addbuilditem(model, mesh, &transform, &item), 0);
  PLib3MFModelWriter* writer = nullptr;
  ASSERT_EQ(lib3mf_model_querywriter(model, "3mf", &writer), 0);
  DWORD code = 0;
  LPCSTR why = nullptr;
  const LIB3MFRESULT written = lib3mf_writer_writetofileutf8(writer, path.c_str());
  lib3mf_getlasterror(writer, &code, &why);
  ASSERT_EQ(written, 0) << (why == nullptr ? "" : why);
  for (PLib3MFBase* object : {writer, item, usual, handler, mesh, model}) lib3mf_release(object);

  const FileScene scene = load_threemf_scene(path);
  ASSERT_EQ(scene.placements.size(), 1u);
  EXPECT_EQ(scene.placements[0].name, "tet");
  EXPECT_EQ(scene.placements[0].to_world.point({0, 0, 0}), (Vec3d{3, 4, 5}));
  const TriangleMesh& read = *scene.meshes[0].mesh;
  EXPECT_EQ(read.positions[3].z, 1.5f);
  const MeshAttribute* const color = find_attribute(read, kColorAttribute);
  ASSERT_NE(color, nullptr);
  EXPECT_EQ(corner_value(read, *color, 3, 1, 2), linear_of_srgb_byte(150));
}

}  // namespace
}  // namespace oktett::threemf_test
