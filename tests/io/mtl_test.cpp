#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "io/obj/obj.h"
#include "tests/io/obj_test_support.h"

namespace oktett::test::mtl_test {
namespace {

/// What one MTL file holds.
struct Mtl {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<std::string> warnings;
};

Mtl load(const std::string& text, const ObjFiles& files = {}) {
  Mtl mtl;
  std::vector<Warning> warnings;
  load_mtl(files.write("m.mtl", text), mtl.materials, mtl.textures, warnings);
  mtl.warnings = files.as_text(warnings);
  for (Texture& texture : mtl.textures) texture.path = files.without_directory(texture.path);
  return mtl;
}

/// The only material of a file with the given statement. Expects no warning.
Material material(const std::string& statements) {
  const Mtl mtl = load("newmtl a\n" + statements);
  EXPECT_EQ(mtl.warnings, std::vector<std::string>{}) << statements;
  EXPECT_EQ(mtl.materials.size(), 1u);
  return mtl.materials.at(0);
}

TEST(Mtl, SaysNothingMeansTheDefault) {
  Material expected;
  expected.name = "a";
  EXPECT_EQ(material(""), expected);
}

TEST(Mtl, ColorsAndWeights) {
  const Material m = material("Kd 0.1 0.2 0.3\nKs 0.5 0.25 0\nKe 1 2 3\nNs 96.5\nNi 1.33\n");
  EXPECT_EQ(m.color, (Color{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(m.diffuse, 1);
  EXPECT_EQ(m.ambient, 0.1f);
  EXPECT_EQ(m.specular_color, (Color{0.5f, 0.25f, 0}));
  EXPECT_EQ(m.specular, 1);
  EXPECT_EQ(m.reflection, 0);
  EXPECT_EQ(m.emission, (Color{1, 2, 3}));
  EXPECT_EQ(m.phong, 96.5f);
  EXPECT_EQ(m.ior, 1.33f);
  EXPECT_FALSE(m.principled);
  EXPECT_EQ(material("Kd 0.5\n").color, (Color{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(material("Ks 0 0 0\n").specular, 0);
}

TEST(Mtl, StatementsOfPhysicallyBasedRenderingMakeItPrincipled) {
  const Mtl mtl = load(
      "newmtl a\nKd 0.1 0.2 0.3\nNi 1.33\nd 0.25\nPr 0.25\nPm 1\nPs 0.5\nPc 0.125\nPcr 0.75\n"
      "newmtl b\nNs 30\nmap_Pr r.png\nmap_Pm m.png\nPm 0.5\n");
  EXPECT_EQ(mtl.warnings, std::vector<std::string>{});
  ASSERT_TRUE(mtl.materials.at(0).principled);
  const PrincipledParameters& a = mtl.materials[0].principled->parameters;
  EXPECT_EQ(a.base_color, (Color{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(a.ior, 1.33f);
  EXPECT_EQ(a.transmission, 0);
  EXPECT_EQ(mtl.materials[0].opacity, 0.25f);
  EXPECT_EQ(a.roughness, 0.25f);
  EXPECT_EQ(a.metallic, 1);
  EXPECT_EQ(a.sheen, 0.5f);
  EXPECT_EQ(a.coat, 0.125f);
  EXPECT_EQ(a.coat_roughness, 0.75f);
  const Material& b = mtl.materials.at(1);
  ASSERT_TRUE(b.principled);
  EXPECT_EQ(b.principled->parameters.roughness, 1);
  EXPECT_EQ(b.principled->parameters.metallic, 0.5f);
  EXPECT_EQ(mtl.textures.at(b.principled->roughness_texture).path, "r.png");
  EXPECT_EQ(mtl.textures.at(b.principled->metallic_texture).path, "m.png");
  // The exponent 30 has the width alpha = sqrt(2 / 32) = 1/4, and roughness is its root.
  EXPECT_FLOAT_EQ(load("newmtl c\nNs 30\nPm 0\n").materials.at(0).principled->parameters.roughness, 0.5f);
}

TEST(Mtl, AmbientIsRelativeToTheColor) {
  EXPECT_FLOAT_EQ(material("Kd 0.5 0.5 0.5\nKa 0.25 0.25 0.25\n").ambient, 0.5f);
  EXPECT_EQ(material("Kd 0.5 0.5 0.5\nKa 1 1 1\n").ambient, 1);
  EXPECT_EQ(material("Kd 0.5 0.5 0.5\nKa 0 0 0\n").ambient, 0);
  EXPECT_EQ(material("Kd 0 0 0\nKa 1 1 1\n").ambient, 0);
}

TEST(Mtl, TransparencyFromEitherKeyword) {
  EXPECT_EQ(material("d 0.25\n").transparency, 0.75f);
  EXPECT_EQ(material("Tr 0.75\n").transparency, 0.75f);
  EXPECT_EQ(material("d 1\nTr 1\n").transparency, 0);
  EXPECT_EQ(material("d -halo 0.5\n").transparency, 0.5f);
  EXPECT_EQ(material("d 1\n").transparency, 0);
  EXPECT_EQ(material("d 0\n").transparency, 1);
  // What passes is not scattered.
  EXPECT_EQ(material("Kd 1 1 1\nd 0.25\n").diffuse, 0.25f);
}

// Kd colours what is scattered, Tf what passes; exporters write `Tf 1 1 1` of every material.
TEST(Mtl, FilterColorsWhatPasses) {
  const Material m = material("Kd 0.5 0.25 0.125\nTf 0 1 0\nd 0.5\n");
  EXPECT_EQ(m.color, (Color{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(m.diffuse, 0.5f);
  EXPECT_EQ(m.filter, (Color{0, 1, 0}));
  for (const char* text : {"Kd 0 0 0\nd 0.1\n", "Kd 0 0 0\nd 0.1\nTf 1 1 1\n", "Kd 0 0 0\nTr 0.9\nTf 1\n"})
    EXPECT_EQ(material(text).filter, (Color{1, 1, 1})) << text;
  EXPECT_FALSE(material("Kd 0.5 0.5 0.5\nTf 0 1 0\n").filter);
  EXPECT_EQ(material("d 0.5\nTf 9 1 1\n").filter, (Color{1, 1, 1}));
}

// What passes does not bend where no Ni says so.
TEST(Mtl, LightPassesStraightWithoutNi) {
  EXPECT_EQ(material("d 0.5\n").ior, 1);
  EXPECT_EQ(material("d 0.5\nNi 1.45\n").ior, 1.45f);
  EXPECT_EQ(material("d 0.5\nNi 1\n").ior, 1);
}

// MeshLab and VTK write the opacity as Tr, all others the transparency.
TEST(Mtl, TrIsReadAsItsWriterMeansIt) {
  const auto transparency = [](const std::string& text) {
    const Mtl mtl = load(text);
    EXPECT_EQ(mtl.warnings, std::vector<std::string>{}) << text;
    return mtl.materials.at(0).transparency;
  };
  const std::string meshlab = "#\n# Wavefront material file\n# Converted by Meshlab Group\n#\n\nnewmtl m\n";
  const std::string vtk = "# wavefront obj file written by the visualization toolkit\n\nnewmtl m\n";
  EXPECT_EQ(transparency(meshlab + "Kd 1 1 1\nTr 1.000000\n"), 0);
  EXPECT_EQ(transparency(vtk + "Tr 0.25\n"), 0.75f);
  EXPECT_EQ(transparency(vtk + "d 0.25\nTr 0.25\n"), 0.75f);
  EXPECT_EQ(transparency("# another\nnewmtl m\nTr 0.25\n"), 0.25f);
  EXPECT_EQ(transparency("newmtl m\n# Converted by Meshlab Group\nTr 0.25\n"), 0.25f);
  EXPECT_EQ(transparency("newmtl m\nd 0.25\nTr 0.751\n"), 0.75f);
  EXPECT_EQ(
      load("newmtl m\nTr 0.5\nd 0.25\n").warnings,
      std::vector<std::string>{"m.mtl:2:1: warning: Tr 0.5 and d 0.25 contradict each other; d counts"});
}

// Blender writes the alpha of physically based materials as d, and how much light passes as Tf.
TEST(Mtl, PhysicallyBasedMaterialsAreCoveredInParts) {
  const Mtl mtl = load("# Blender 4.3.2 MTL File: 'a.blend'\nnewmtl a\nKd 0 0 0\nd 0.25\nTf 1 1 1\nPr 0\n");
  const Material& m = mtl.materials.at(0);
  EXPECT_EQ(m.opacity, 0.25f);
  EXPECT_EQ(m.principled->parameters.transmission, 1);
  EXPECT_EQ(load("newmtl a\nTf 1 1 1\nPr 0\n").materials.at(0).principled->parameters.transmission, 0);
}

// A white surface whose highlight is as wide as the hemisphere would give back three times what arrives.
TEST(Mtl, NoMoreLightIsGivenBackThanArrives) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(0, 3);
  for (int i = 0; i < 300; ++i) {
    std::string text = "newmtl a\n";
    for (const char* key : {"Kd", "Ks", "Tf"})
      text += key + fmt::format(" {} {} {}\n", any(random), any(random), any(random));
    text += fmt::format("Ns {}\nd {}\nillum {}\n", i % 3 == 0 ? 0 : any(random) * 9, any(random) / 3, i % 10);
    if (i % 2 == 0) text += "map_Kd -mm 0.5 3 a.png\n";
    const Mtl mtl = load(text);
    EXPECT_LE(greatest_albedo(mtl.materials.at(0), mtl.textures), 1.0001f) << text;
  }
  // Only what is too much goes, and a wide highlight before the colour.
  const Material white = material("Kd 1 1 1\nKs 1 1 1\nNs 0\n");
  EXPECT_EQ(white.color, (Color{1, 1, 1}));
  EXPECT_LE(white.specular * white.specular_color.x, 1e-5f);
  EXPECT_EQ(material("Kd 1 1 1\nKs 0.4 0.4 0.4\nNs 1\n").color, (Color{1, 1, 1}));
  const Material shiny = material("Kd 1 0.5 0.5\nKs 1 1 1\nNs 199\n");
  EXPECT_NEAR(shiny.color.x, 1 / 1.01, 1e-5);
  EXPECT_NEAR(shiny.color.y, 0.5 / 1.01, 1e-5);
  EXPECT_EQ(material("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 1\n").color, (Color{0.5f, 0.5f, 0.5f}));
}

TEST(Mtl, IlluminationModelsThatMirror) {
  for (const char* model : {"3", "5"}) {
    const Material m = material(std::string("Ks 0.5 0.5 0.5\nillum ") + model + "\n");
    EXPECT_FLOAT_EQ(m.reflection, 0.5f);
    EXPECT_EQ(m.specular, 1);
  }
  for (const char* model : {"0", "1", "2", "4", "6", "7", "9"})
    EXPECT_EQ(material(std::string("Ks 0.5 0.5 0.5\nillum ") + model + "\n").reflection, 0);
  EXPECT_EQ(material("Kd 0 0 0\nKs 1 1 1\nNs 1e9\nillum 3\n").reflection, 1);
  const Material glass = material("Kd 1 1 1\nKs 0 0 0\nd 0\nNi 1.5\nillum 7\n");
  EXPECT_EQ(glass.transparency, 1);
  EXPECT_EQ(glass.ior, 1.5f);
  EXPECT_EQ(glass.specular_color, (Color{1, 1, 1}));
}

TEST(Mtl, TexturesOfAllKinds) {
  const Mtl mtl = load(
      "newmtl a\nmap_Kd c.png\nmap_Ks s.png\nmap_Ke e.png\nmap_d d.png\nmap_Bump -bm 0.5 b.png\nnorm n.png\n"
      "map_Ka unused.png\nnewmtl b\nbump b.png\nmap_bump -bm 2 b.png\nmap_Kd c.png\n");
  ASSERT_EQ(mtl.textures.size(), 6u);
  const Material& a = mtl.materials.at(0);
  EXPECT_EQ(mtl.textures.at(a.color_texture).path, "c.png");
  EXPECT_EQ(mtl.textures.at(a.specular_texture).path, "s.png");
  EXPECT_EQ(mtl.textures.at(a.emission_texture).path, "e.png");
  EXPECT_EQ(mtl.textures.at(a.opacity_texture).path, "d.png");
  EXPECT_EQ(mtl.textures.at(a.bump_texture).path, "b.png");
  EXPECT_EQ(mtl.textures.at(a.normal_texture).path, "n.png");
  EXPECT_EQ(a.bump_scale, 0.5f);
  // Textures without a colour to multiply show as they are.
  EXPECT_EQ(a.color, (Color{1, 1, 1}));
  EXPECT_EQ(a.diffuse, 1);
  EXPECT_EQ(a.specular, 1);
  EXPECT_EQ(a.emission, (Color{1, 1, 1}));
  const Material& b = mtl.materials.at(1);
  EXPECT_EQ(b.bump_scale, 2);
  EXPECT_EQ(b.color_texture, a.color_texture);
  EXPECT_EQ(b.bump_texture, a.bump_texture);
}

TEST(Mtl, NormalMapsMayBeNamedTwice) {
  const Material m = material("norm n.png\nmap_Bump -bm 2 n.png\n");
  EXPECT_NE(m.normal_texture, kNoId);
  EXPECT_EQ(m.bump_texture, kNoId);
  EXPECT_EQ(m.bump_scale, 1);
  EXPECT_NE(material("norm n.png\nmap_Bump b.png\n").bump_texture, kNoId);
}

TEST(Mtl, TextureOptions) {
  const Mtl mtl = load(
      "newmtl a\nmap_Kd -blendu off -blendv on -cc on -clamp on -o 0.5 0.25 -s 2 3 4 -t 1 -mm 0.1 0.9 "
      "-texres 256 "
      "-imfchan g -type sphere -boost 1.5 my picture 1.png\n"
      "map_Ks -s 2 7\nmap_Ke -o 1 2 3 file\nmap_d -clamp off -front.png\nmap_Bump dir\\sub\\b.png\n");
  EXPECT_EQ(mtl.warnings, std::vector<std::string>{});
  ASSERT_EQ(mtl.textures.size(), 5u);
  Texture expected;
  expected.path = "my picture 1.png";
  expected.lookup = kClampedTexture;
  expected.offset = {0.5f, 0.25f, 0};
  expected.scale = {2, 3, 4};
  expected.base = 0.1f;
  expected.gain = 0.9f;
  expected.channel = ImageChannel::green;
  EXPECT_EQ(mtl.textures[0], expected);
  EXPECT_EQ(mtl.textures[1].path, "7");
  EXPECT_EQ(mtl.textures[1].scale, (Vec3f{2, 1, 1}));
  EXPECT_EQ(mtl.textures[2].path, "file");
  EXPECT_EQ(mtl.textures[2].offset, (Vec3f{1, 2, 3}));
  EXPECT_EQ(mtl.textures[3].path, "-front.png");
  EXPECT_EQ(mtl.textures[4].path, "dir/sub/b.png");
}

TEST(Mtl, NumbersTakeTheChannelThatIsNamed) {
  const Mtl mtl = load(
      "newmtl a\nmap_Pr -imfchan g t.png\nmap_Pm -imfchan b t.png\nmap_d -imfchan m t.png\nmap_Pc -imfchan r "
      "t.png\nmap_Ps -imfchan l t.png\nmap_Pcr -imfchan q t.png\n");
  EXPECT_EQ(mtl.warnings,
            std::vector<std::string>{"m.mtl:7:18: warning: unknown channel 'q'; expected r, g, b, m or l"});
  const Material& m = mtl.materials.at(0);
  const auto channel = [&](std::uint32_t texture) { return mtl.textures.at(texture).channel; };
  EXPECT_EQ(channel(m.principled->roughness_texture), ImageChannel::green);
  EXPECT_EQ(channel(m.principled->metallic_texture), ImageChannel::blue);
  EXPECT_EQ(channel(m.opacity_texture), ImageChannel::alpha);
  EXPECT_EQ(channel(m.principled->coat_texture), ImageChannel::red);
  for (const std::uint32_t texture : {m.principled->sheen_texture, m.principled->coat_roughness_texture})
    EXPECT_EQ(channel(texture), ImageChannel::luminance);
  EXPECT_EQ(load("newmtl a\nmap_Kd -imfchan m t.png\n").textures.at(0).channel, ImageChannel::red);
  const Mtl usual = load("newmtl a\nmap_d t.png\nmap_Bump u.png\nmap_Pr v.png\n");
  for (const Texture& texture : usual.textures) EXPECT_EQ(texture.channel, ImageChannel::luminance);
}

TEST(Mtl, ColorSpacesAreThoseThatAreNamed) {
  const Mtl mtl = load(
      "newmtl a\nmap_Kd -colorspace sRGB a.png\nmap_Ks -colorspace Linear a.png\n"
      "map_Ke -colorspace pq a.png\n");
  EXPECT_EQ(mtl.warnings, std::vector<std::string>{
                              "m.mtl:4:23: warning: unknown colour space 'pq'; expected sRGB or linear"});
  const Material& m = mtl.materials.at(0);
  EXPECT_EQ(mtl.textures.at(m.color_texture).color_space, TextureColors::srgb);
  EXPECT_EQ(mtl.textures.at(m.specular_texture).color_space, TextureColors::linear);
  EXPECT_EQ(mtl.textures.at(m.emission_texture).color_space, TextureColors::of_file);
}

// Of all that a name may mean the first that is a file counts.
TEST(Mtl, NamesOfTexturesMayBeWrittenInManyWays) {
  const ObjFiles files;
  for (const char* name : {"a b.png", "c#d.png", "e #f.png", "g.png"}) files.write(name, "");
  const auto name = [&](const std::string& written) {
    return load("newmtl a\nmap_Kd " + written + "\n", files).textures.at(0).path;
  };
  EXPECT_EQ(name("a\\ b.png"), "a b.png");
  EXPECT_EQ(name("a b.png"), "a b.png");
  EXPECT_EQ(name("\"a b.png\""), "a b.png");
  EXPECT_EQ(name("a\\ b.png # its wood"), "a b.png");
  EXPECT_EQ(name("c#d.png"), "c#d.png");
  EXPECT_EQ(name("e #f.png"), "e #f.png");
  EXPECT_EQ(name("g.png #f.png"), "g.png");
  EXPECT_EQ(name("gone.png # old"), "gone.png");
}

TEST(Mtl, TexturesWithDifferentOptionsDiffer) {
  EXPECT_EQ(load("newmtl a\nmap_Kd t.png\nmap_Ks -clamp on t.png\nmap_Ke t.png\n").textures.size(), 2u);
}

TEST(Mtl, MalformedStatementsWarnAndKeepTheDefault) {
  const Mtl mtl = load(
      "newmtl a\nKd 1 x 0\nNs -1\nNi 0\nNs nan\n  d\nillum 2.5\nKs spectral f.rfl 1\nKe xyz 1 2 3\nillum "
      "99\nPr x\n"
      "map_Kd\nmap_Ks -clamp on\nmap_Ke -foo t.png\nKa -1 0 0\n");
  EXPECT_EQ(mtl.warnings,
            (std::vector<std::string>{
                "m.mtl:2:6: warning: expected a finite number, found 'x'",
                "m.mtl:3:6: warning: Ns must not be negative; the default is kept",
                "m.mtl:4:5: warning: Ni must be greater than 0; the default is kept",
                "m.mtl:5:4: warning: expected a finite number, found 'nan'",
                "m.mtl:6:4: warning: expected a number, found the end of the line",
                "m.mtl:7:10: warning: illum must be a whole number from 0 to 10; the default is kept",
                "m.mtl:8:4: warning: 'spectral' colours are not supported; the default is kept",
                "m.mtl:9:4: warning: 'xyz' colours are not supported; the default is kept",
                "m.mtl:10:9: warning: illum must be a whole number from 0 to 10; the default is kept",
                "m.mtl:11:4: warning: expected a finite number, found 'x'",
                "m.mtl:12:7: warning: expected the name of a texture file",
                "m.mtl:13:17: warning: expected the name of a texture file",
                "m.mtl:14:13: warning: unknown texture option '-foo'",
                "m.mtl:15:10: warning: a colour has a negative part; it counts as 0",
            }));
  const Material& m = mtl.materials.at(0);
  Material expected;
  expected.name = "a";
  expected.ambient = 0;
  expected.emission = {1, 1, 1};
  expected.emission_texture = 0;
  EXPECT_EQ(m, expected);
}

TEST(Mtl, PartsOutsideOfZeroToOneWarnAndAreLimited) {
  const Mtl mtl = load(
      "newmtl a\nPr 7\nPm -1\nPs 1.5\n Pc -0.5\nPcr 1e30\nd -3\nnewmtl b\nTr 2\nKd -0.5\nnewmtl c\nd 7\n");
  EXPECT_EQ(mtl.warnings, (std::vector<std::string>{
                              "m.mtl:2:5: warning: Pr must be from 0 to 1; it counts as 1",
                              "m.mtl:3:6: warning: Pm must be from 0 to 1; it counts as 0",
                              "m.mtl:4:7: warning: Ps must be from 0 to 1; it counts as 1",
                              "m.mtl:5:9: warning: Pc must be from 0 to 1; it counts as 0",
                              "m.mtl:6:9: warning: Pcr must be from 0 to 1; it counts as 1",
                              "m.mtl:7:5: warning: d must be from 0 to 1; it counts as 0",
                              "m.mtl:9:5: warning: Tr must be from 0 to 1; it counts as 1",
                              "m.mtl:10:8: warning: a colour has a negative part; it counts as 0",
                              "m.mtl:12:4: warning: d must be from 0 to 1; it counts as 1",
                          }));
  ASSERT_TRUE(mtl.materials.at(0).principled);
  const PrincipledParameters& p = mtl.materials[0].principled->parameters;
  EXPECT_EQ(p.roughness, 1);
  EXPECT_EQ(p.metallic, 0);
  EXPECT_EQ(p.sheen, 1);
  EXPECT_EQ(p.coat, 0);
  EXPECT_EQ(p.coat_roughness, 1);
  EXPECT_EQ(mtl.materials[0].opacity, 0);
  EXPECT_EQ(mtl.materials.at(1).color, (Color{0, 0, 0}));
  EXPECT_EQ(mtl.materials.at(1).transparency, 1);
  EXPECT_EQ(mtl.materials.at(2).transparency, 0);
}

// Phong's glass has any index; the principled material those that its tables cover.
TEST(Mtl, IndicesOfPrincipledMaterialsWarnAndAreLimited) {
  const Mtl mtl =
      load("newmtl a\nNi 7\nPr 0.5\nnewmtl b\nPm 1\n Ni 0.1\nnewmtl c\nNi 4\nPr 1\nnewmtl d\nNi 7\n");
  EXPECT_EQ(
      mtl.warnings,
      (std::vector<std::string>{
          "m.mtl:2:1: warning: Ni must be from 0.25 to 4 beside Pr, Pm, Ps, Pc or Pcr; it counts as 4",
          "m.mtl:6:2: warning: Ni must be from 0.25 to 4 beside Pr, Pm, Ps, Pc or Pcr; it counts as 0.25",
      }));
  EXPECT_EQ(mtl.materials.at(0).principled->parameters.ior, 4);
  EXPECT_EQ(mtl.materials.at(1).principled->parameters.ior, 0.25f);
  EXPECT_EQ(mtl.materials.at(2).principled->parameters.ior, 4);
  EXPECT_EQ(mtl.materials.at(3).ior, 7);
}

TEST(Mtl, UnknownKeywordsAndStrayStatementsAreIgnored) {
  const Mtl mtl = load("Kd 1 1 1\nnewmtl a\nsharpness 60\nrefl -type sphere x\nfoo bar\n\x01\x02\n");
  EXPECT_EQ(mtl.warnings, std::vector<std::string>{});
  EXPECT_EQ(mtl.materials.at(0).diffuse, Material{}.diffuse);
}

TEST(Mtl, LinesMayEndInAnyWay) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : std::string(
             "\xef\xbb\xbf# c\n\n \tnewmtl a b\n\tKd 0.5 \\\n1 0 # x\nmap_Kd my \\\n  t#1.png\nnewmtl c"))
      text += c == '\n' ? end : std::string(1, c);
    const Mtl mtl = load(text);
    ASSERT_EQ(mtl.materials.size(), 2u);
    EXPECT_EQ(mtl.materials[0].name, "a b");
    EXPECT_EQ(mtl.materials[0].color, (Color{0.5f, 1, 0}));
    EXPECT_EQ(mtl.textures.at(0).path, "my t#1.png");
    EXPECT_EQ(mtl.materials[1].name, "c");
  }
}

TEST(Mtl, DefinitionsAreAppended) {
  const ObjFiles files;
  std::vector<Material> materials(1);
  std::vector<Texture> textures(1);
  std::vector<Warning> warnings;
  textures[0].path = files.dir.file("t.png");
  load_mtl(files.dir.write("m.mtl", "newmtl a\nmap_Kd t.png\nmap_Ks u.png\n"), materials, textures, warnings);
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[1].color_texture, 0u);
  EXPECT_EQ(materials[1].specular_texture, 1u);
  ASSERT_EQ(textures.size(), 2u);
  EXPECT_THROW(load_mtl(files.dir.file("none.mtl"), materials, textures, warnings), Error);
}

TEST(Mtl, EmptyAndRepeatedDefinitionsWarn) {
  EXPECT_EQ(load("# nothing\n").warnings, std::vector<std::string>{"m.mtl: warning: no materials"});
  EXPECT_EQ(load("newmtl a\nnewmtl a\nnewmtl\n").warnings,
            (std::vector<std::string>{
                "m.mtl:2:9: warning: material 'a' is defined again; the first definition counts",
                "m.mtl:3:7: warning: expected the name of the material"}));
}

// Whatever stands in it, a damaged MTL file never keeps a mesh from being loaded.
TEST(Mtl, DamagedFilesLoad) {
  const std::string base =
      "newmtl a\nKd 1 0.5 0\nd -halo 0.5\nmap_Kd -o 1 2 -s 2 -mm 0 1 a b.png\nillum 4\nnewmtl b\nNi "
      "1.5\\\n\n";
  const ObjFiles files;
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::string text = base;
    for (int k = 0; k < 4; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 2)
        text[at] = static_cast<char>(random());
      else
        text.erase(at, random() % 5);
    }
    const Mtl mtl = load(text, files);
    for (const Material& m : mtl.materials) {
      ASSERT_TRUE(is_finite(m.color) && m.diffuse >= 0 && m.ior > 0 && m.transparency >= 0 &&
                  m.transparency <= 1)
          << text;
      ASSERT_TRUE(m.color_texture == kNoId || m.color_texture < mtl.textures.size()) << text;
    }
  }
}

}  // namespace
}  // namespace oktett::test::mtl_test
