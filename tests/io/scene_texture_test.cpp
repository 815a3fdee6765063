/// \file Textures of scene files: images and patterns in the place of values, and what is wrong with them.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "io/image/texture.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_texture_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

class SceneTexture : public testing::Test {
 protected:
  SceneTexture() { files.dir.write("a.png", ""); }
  Material material(const std::string& keys) {
    scene = files.load_v1("materials: {m: {" + keys + "}}");
    return scene.materials.at(0);
  }
  const Texture& texture(std::uint32_t index) const { return scene.textures.at(index); }

  SceneFiles files;
  Scene scene;
};

TEST_F(SceneTexture, PatternsAreRead) {
  Material m = material(
      "color: {marble: {size: 2, distortion: 0.5, octaves: 3, roughness: 0.25, colors: [[1, 0, 0], "
      "'#000000', [0, 0, 1]], transform: {translate: [1, 2, 3]}}, gain: 2, base: 0.5}");
  const Texture& t = texture(m.color_texture);
  EXPECT_EQ(m.color, (Color{1, 1, 1}));
  EXPECT_EQ(t.gain, 2);
  EXPECT_EQ(t.base, 0.5f);
  ASSERT_TRUE(t.pattern);
  const MarblePattern expected{2, 0.5, {3, 0.25}};
  EXPECT_EQ(t.pattern->pattern, Pattern(expected));
  EXPECT_EQ(t.pattern->colors, (std::vector<Color>{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(t.pattern->to_pattern.point({1, 2, 3}), (Vec3d{0, 0, 0}));

  m = material("map_bump: {wood: }");
  EXPECT_EQ(texture(m.bump_texture).pattern->pattern, Pattern(WoodPattern{}));
}

TEST_F(SceneTexture, AttributesAreRead) {
  const Material m = material(
      "color: {attribute: color}, opacity: {attribute: color, channel: alpha}, map_bump: {attribute: height, "
      "gain: 2, base: 1}");
  EXPECT_EQ(texture(m.color_texture).attribute, "color");
  EXPECT_EQ(texture(m.opacity_texture).channel, ImageChannel::alpha);
  EXPECT_EQ(texture(m.bump_texture).attribute, "height");
  EXPECT_EQ(texture(m.bump_texture).gain, 2);
  const auto error = [&](const std::string& keys) {
    return files.error_v1("materials: {m: {" + keys + "}}");
  };
  expect_starts(error("color: {attribute: color, clamp: true}"),
                "scene.yaml:2:43: 'clamp' has no meaning beside 'attribute'");
  expect_starts(error("color: {attribute: color, file: a.png}"),
                "scene.yaml:2:43: 'file' has no meaning beside 'attribute'");
  expect_starts(error("color: {attribute: ''}"),
                "scene.yaml:2:36: expected the name of an attribute of meshes, found nothing");
  expect_starts(
      error("map_normal: {attribute: n}"),
      "scene.yaml:2:29: an attribute holds no normals; expected an image, or 'map_bump', which takes "
      "an attribute as heights");
}

TEST_F(SceneTexture, AttributesThatAreNotThereAreTold) {
  files.dir.write("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
  EXPECT_EQ(
      files.warnings_v1("materials: {m: {color: {attribute: colour}}, n: {color: {attribute: color}}}\n"
                        "objects: [{mesh: {file: a.obj}, material: m}, {mesh: {file: a.obj}, material: n},"
                        " {sphere: {}, material: n}, {mesh: {file: a.obj}, material: m}]\n"),
      "scene.yaml:2:24: warning: a mesh of this material has no attribute 'colour'; did you mean 'color'?; "
      "white instead\n"
      "scene.yaml:2:57: warning: an object of this material is no mesh, and has no attribute 'color'; white "
      "instead\n");
}

TEST_F(SceneTexture, ScansGivenAloneShowTheirColours) {
  const Scene scan =
      load_scene(files.dir.write("scan.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n"));
  ASSERT_LT(scan.objects.at(0).material, scan.materials.size());
  const Material& m = scan.materials[scan.objects[0].material];
  EXPECT_EQ(scan.textures.at(m.color_texture).attribute, "color");
  EXPECT_EQ(m.color, (Color{1, 1, 1}));
}

TEST_F(SceneTexture, StandInThePlaceOfEveryValue) {
  for (const PhongNumber& number : kPhongNumbers) {
    const Material m = material(std::string(number.name) + ": {noise: }");
    EXPECT_EQ(m.*number.value, 1) << number.name;
    EXPECT_TRUE(texture(m.*number.texture).pattern) << number.name;
  }
  for (const PrincipledNumber& number : kPrincipledNumbers) {
    const Material m = material("principled: {" + std::string(number.name) + ": {file: a.png, gain: 3}}");
    EXPECT_EQ(texture((*m.principled).*number.texture).gain, 3) << number.name;
  }
  EXPECT_NE(material("opacity: {checker: }").opacity_texture, kNoId);
  EXPECT_NE(material("ior: {noise: }").ior_texture, kNoId);
  EXPECT_NE(material("ior: {noise: }, roughness: 0.5").principled->ior_texture, kNoId);
  const Material metal = material("principled: {eta: {noise: }, k: {file: a.png, gain: 3}}");
  EXPECT_TRUE(texture(metal.principled->eta_texture).pattern);
  EXPECT_EQ(texture(metal.principled->k_texture).gain, 3);
  EXPECT_EQ(metal.principled->parameters.conductor->k, (Color{1, 1, 1}));
  EXPECT_NE(material("emission: {file: a.png}").emission_texture, kNoId);
  EXPECT_NE(material("specular_color: {gradient: }").specular_texture, kNoId);
  EXPECT_NE(material("roughness: {radial: }").principled->roughness_texture, kNoId);
  const Material m = material("opacity: 0.25");
  EXPECT_EQ(m.opacity, 0.25f);
  EXPECT_EQ(m.opacity_texture, kNoId);
}

TEST_F(SceneTexture, ErrorsSayWhatIsWrong) {
  const auto error = [&](const std::string& keys) {
    return files.error_v1("materials: {m: {" + keys + "}}");
  };
  const auto expect = [&](const std::string& keys, const std::string& part) {
    EXPECT_NE(error(keys).find(part), std::string::npos) << keys << "\n" << error(keys);
  };
  expect_starts(error("map_color: absent.png"), "scene.yaml:2:28: 'absent.png': no such file");
  expect_starts(error("map_color: ."), "scene.yaml:2:28: ");
  expect("map_color: 3", "no such file");
  expect("map_color: [a.png]", "expected text");
  expect("color: {}", "a texture needs 'file'");
  expect("color: {gain: 2}", "a texture needs 'file'");
  expect("color: {marbel: }", "did you mean 'marble'?");
  expect("color: {marble: , file: a.png}", "'file' has no meaning beside 'marble'");
  expect("color: {marble: , wood: }", "'wood' has no meaning beside 'marble'");
  expect("color: {marble: , scale: 2}", "'scale' has no meaning beside 'marble'");
  expect("color: {marble: {colors: []}}", "expected 1 to 64 colors, found 0");
  expect("color: {marble: {colors: [[1, 1, -1]]}}", "at least 0");
  expect("color: {marble: {colors: [[.nan, 0, 0]]}}", "expected a finite number");
  expect("color: {marble: {transform: {scale: 0}}}", "singular");
  expect("color: {marble: {octaves: 0}}", "whole number from 1 to 16");
  expect("color: {checker: {size: 0}}", "expected a number");
  expect("color: {gradient: {from: [1, 2, 3], to: [1, 2, 3]}}", "must differ");
  expect("color: {radial: {inner: 2}}", "'outer' must be greater than 'inner'");
  expect("color: {file: a.png}, map_color: a.png", "expected one of them");
  expect("opacity: {file: a.png}, map_opacity: a.png", "expected one of them");
  expect("opacity: 1.5", "from 0 to 1");
  expect("principled: {ior: 5}", "from 0.25 to 4");
  expect_starts(error("map_normal: {noise: }"), "scene.yaml:2:29: a pattern holds no normals");
  expect_starts(error("principled: {map_coat_normal: {noise: }}"),
                "scene.yaml:2:47: a pattern holds no normals");
  expect("map_normal: {noise: }", "'map_bump'");
  // A texture cannot hold itself: an alias inside its own anchor is no YAML.
  expect("color: &a {marble: {colors: *a}}", "");
  EXPECT_NE(error("color: &a {marble: {colors: *a}}"), "no error");
}

TEST_F(SceneTexture, WarnsOfMaterialsThatMakeEnergy) {
  const auto warnings = [&](const std::string& kind, const std::string& keys) {
    std::string text;
    for (const Warning& w :
         files.load_v1("integrator: {kind: " + kind + "}\nmaterials: {m: {" + keys + "}}").warnings)
      text += w.message;
    return text;
  };
  EXPECT_EQ(warnings("path", "color: [1, 1, 1], diffuse: 1"), "");
  EXPECT_EQ(warnings("path", "color: [1, 1, 1], diffuse: 0.5, reflection: 0.5"), "");
  EXPECT_NE(warnings("path", "color: [1, 1, 1], diffuse: 0.7, reflection: 0.5").find("1.2 times"),
            std::string::npos);
  EXPECT_NE(warnings("path", "color: [0, 0, 0], specular: 3, phong: 1").find("3 times"), std::string::npos);
  EXPECT_EQ(warnings("path", "color: [0, 0, 0], specular: 3, phong: 5"), "");
  EXPECT_EQ(warnings("whitted", "diffuse: 5"), "");
  // Patterns reach their brightest colour; images count as white.
  const auto expect = [&](const std::string& keys, const std::string& part) {
    EXPECT_NE(warnings("path", keys).find(part), std::string::npos) << keys << warnings("path", keys);
  };
  expect("color: {checker: {colors: [[3, 3, 3], [2, 2, 2]]}}, diffuse: 1", "3 times");
  expect("color: {file: a.png, gain: 2, base: 0.5}, diffuse: 1", "2.5 times");
  expect("color: [0, 0, 0], specular: 1, phong: {gradient: , gain: 9}", "2 times");
  expect("color: [1, 1, 1], diffuse: {noise: , gain: 1.5}", "1.5 times");
  expect("color: [1, 1, 1], map_color: {noise: {colors: [[1, 4, 1]]}}, diffuse: 0.5", "2 times");
  EXPECT_EQ(warnings("path", "color: {file: a.png}, diffuse: {noise: }"), "");
  EXPECT_EQ(warnings("path", "color: {checker: , gain: -3, base: 1}, diffuse: 1"), "");
  EXPECT_EQ(warnings("path", "color: [0, 0, 0], reflection: {noise: , gain: 5}"), "");
  EXPECT_EQ(warnings("path", "principled: {base_color: [1, 1, 1], sheen: 1, coat: 1}"), "");
}

// One warning for each such material of a scene file; those of MTL files are limited.
TEST_F(SceneTexture, MaterialsOfMtlFilesMakeNoEnergy) {
  files.dir.write("m.mtl", "newmtl b\nKd 1 1 1\nKs 1 1 1\nNs 10\n");
  files.dir.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl b\nf 1 2 3\n");
  const std::string objects =
      "materials:\n  x: {diffuse: 2}\n  y: {diffuse: 3}\nobjects: [{mesh: {file: m.obj}}]\n";
  EXPECT_TRUE(files.load_v1(objects).warnings.empty());
  const Scene read = load_scene(files.dir.file("scene.yaml"), {}, IntegratorKind::path);
  EXPECT_EQ(read.integrator.kind, IntegratorKind::path);
  std::vector<std::string> found, at_once;
  for (const Warning& w : read.warnings) found.push_back(files.without_directory(to_string(w)));
  ASSERT_EQ(found.size(), 2u);
  const std::string text = " warning: this material may give back ";
  expect_starts(found[0], "scene.yaml:3:6:" + text + "1.6 times");
  expect_starts(found[1], "scene.yaml:4:6:" + text + "2.4 times");
  for (const Warning& w : files.load_v1("integrator: {kind: path}\n" + objects).warnings)
    at_once.push_back(w.message);
  EXPECT_EQ(at_once.size(), 2u);
  EXPECT_TRUE(load_scene(files.dir.file("scene.yaml"), {}, IntegratorKind::whitted).warnings.empty());
  EXPECT_TRUE(load_scene(files.dir.file("m.obj"), {}, IntegratorKind::path).warnings.empty());
}

// Warnings of images that cannot be used say where the scene names them first.
TEST_F(SceneTexture, UnusableImagesAreToldOfWhereTheyAreNamed) {
  const std::string b = files.dir.write("b.png", "");
  scene = files.load_v1(
      "materials:\n  m: {color: {noise: }, map_opacity: b.png}\n  n: {color: {gain: 2, file: a.png}, "
      "map_bump: b.png}\n");
  ASSERT_EQ(scene.texture_places.size(), scene.textures.size());
  for (const std::string& gone : {files.dir.file("a.png"), b}) std::filesystem::remove(gone);
  const ImageTextures textures(scene.textures, scene.texture_places);
  std::vector<std::string> found;
  for (const Warning& w : textures.warnings()) found.push_back(files.without_directory(to_string(w)));
  std::ranges::sort(found);
  ASSERT_EQ(found.size(), 2u);
  expect_starts(found[0], "scene.yaml:3:38: warning: texture b.png not used: ");
  expect_starts(found[1], "scene.yaml:4:30: warning: texture a.png not used: ");
}

// Lamps without size, light of less than nothing, and impossible optics are errors; a mirror is a roughness.
TEST_F(SceneTexture, ImpossibleValuesAreErrors) {
  for (const char* text :
       {"lights: [{sphere: {center: [0, 0, 0], radius: 0}}]",
        "lights: [{disk: {center: [0, 0, 0], radius: 0}}]",
        "lights: [{rectangle: {corner: [0, 0, 0], u: [0, 0, 0], v: [0, 1, 0]}}]",
        "lights: [{point: {position: [0, 0, 0], color: [1, -1, 1]}}]", "lights: [{sky: {color: [-1, 0, 0]}}]",
        "lights: [{sphere: {center: [0, 0, 0], power: [0, 0, -1]}}]", "materials: {m: {color: [0, 0, -0.1]}}",
        "materials: {m: {emission: [-1, 0, 0]}}", "materials: {m: {ior: 0}}", "materials: {m: {ior: -1}}",
        "materials: {m: {principled: {ior: 0}}}", "materials: {m: {roughness: -0.1}}",
        "materials: {m: {principled: {eta: [0, 1, 1], k: [1, 1, 1]}}}", "materials: {m: {diffuse: -1}}"}) {
    const std::string error = files.error_v1(text);
    expect_starts(error, "scene.yaml:2:");
    EXPECT_TRUE(error.find("expected") != std::string::npos || error.find("must not") != std::string::npos)
        << error;
  }
  EXPECT_EQ(files.error_v1("materials: {m: {roughness: 0}, n: {principled: {roughness: 0}}}"), "no error");
}

// Patterns need no file, so the library of images is not loaded for them.
TEST_F(SceneTexture, PatternsAreNoImages) {
  material("color: {noise: }");
  const ImageTextures textures(scene.textures);
  EXPECT_TRUE(textures.warnings().empty());
  EXPECT_EQ(textures.color(0, {0.5f, 0.5f}, {}, {}), (Color{1, 1, 1}));
}

}  // namespace
}  // namespace oktett::scene_texture_test
