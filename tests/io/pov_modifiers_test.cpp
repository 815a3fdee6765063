#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/image/encode.h"
#include "io/image/texture.h"
#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "io/yaml/write_yaml.h"
#include "render/picture/render.h"
#include "tests/io/pov_pixel.h"
#include "tests/support/temp_dir.h"

namespace oktett::pov_modifiers_test {
namespace {

using test::TempDir;

/// What a scene of version 3.7 becomes.
std::string scene_of(const std::string& text) {
  const TempDir dir;
  return yaml_text(*read_pov_tree(dir.write("scene.pov", "#version 3.7;\n" + text), {}, {}).root);
}

/// What is seen of an object from the side.
std::vector<float> picture_of(const std::string& text) {
  const TempDir dir;
  Scene scene =
      load_scene(dir.write("scene.pov",
                           "#version 3.7;\nglobal_settings { assumed_gamma 1 }\nbackground { rgb 0.3 }\n"
                           "camera { location <7, 9, -14> look_at 0 angle 30 }\n"
                           "light_source { <9, 9, -9>, 1 }\n" +
                               text));
  scene.film.width = scene.film.height = 24, scene.integrator.samples = 1;
  const Picture picture = render(scene, {}).picture;
  std::vector<float> all;
  for (const char* channel : {"R", "G", "B"})
    for (const float value : picture.find(channel)->values) all.push_back(value);
  return all;
}

/// Whether both texts show the same, and something.
void expect_same_picture(const std::string& text, const std::string& means) {
  const std::vector<float> seen = picture_of(text), wanted = picture_of(means);
  EXPECT_NE(wanted, picture_of("")) << means;
  ASSERT_EQ(seen.size(), wanted.size());
  float most = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) most = std::max(most, std::abs(seen[i] - wanted[i]));
  EXPECT_LT(most, 1e-4f) << text;
}

/// The colour of the middle of a picture that looks along z. What was seen by running POV-Ray 3.7.0.10 stands
/// in the tests below.
Vec3f middle(const std::string& text,
             const std::string& version = "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n") {
  const TempDir dir;
  return test::pixel_of(
      dir.write("scene.pov", version + "camera { location -9*z look_at 0 angle 1 }\n" + text));
}

struct Same {
  const char *text, *means;
};
void expect_same(const std::vector<Same>& cases) {
  for (const Same& c : cases) expect_same_picture(c.text, c.means);
}

// What stands behind a declared object goes on with what it has.
TEST(PovModifiers, ACopyGoesOn) {
  const std::string ball = "#declare B = sphere { 0, 1 pigment { rgb x } finish { phong 1 } scale 2 }\n";
  const auto means = [&](const std::string& behind) {
    expect_same_picture(ball + "object { B " + behind + " }",
                        "sphere { 0, 1 pigment { rgb x } finish { phong 1 } scale 2 " + behind + " }");
  };
  means("pigment { rgb y }");
  means("finish { ambient 1 }");
  means("texture { pigment { rgbt <0, 1, 0, 0.5> } }");
  means("scale 3 pigment { gradient y } translate x");
  means("interior { ior 1.5 }");
  expect_same({
      {"object { object { sphere { 0, 1 pigment { rgb x } } } pigment { rgb y } }",
       "sphere { 0, 1 pigment { rgb y } }"},
      {"#declare B = union { sphere { 0, 1 } sphere { x, 1 } pigment { rgb x } } object { B pigment { rgb y "
       "} }",
       "union { sphere { 0, 1 } sphere { x, 1 } pigment { rgb y } }"},
      // Parts of it keep theirs.
      {"#declare B = union { sphere { 0, 1 pigment { rgb x } } sphere { x, 1 } } object { B pigment { rgb y "
       "} }",
       "union { sphere { 0, 1 pigment { rgb x } } sphere { x, 1 } pigment { rgb y } }"},
      {"#declare B = sphere { 0, 1 pigment { rgb x } } union { object { B } sphere { x, 1 } pigment { rgb y "
       "} }",
       "union { sphere { 0, 1 pigment { rgb x } } sphere { x, 1 } pigment { rgb y } }"},
  });
}

// What bounds a copy bounds what has no end.
TEST(PovModifiers, CopiesAreBounded) {
  const std::string whole = scene_of(
      "#declare S = quartic { <0,0,0,0,0,0,0,0,0,0,0,1,0,0,1,0,0,0,1,0,0,0,0,0,0,0,1,"
      "0,0,0,0,0,0,0,0> }\nobject { S pigment { rgb x } scale 2 bounded_by { sphere { 0, 2 } } }");
  EXPECT_NE(whole.find("max: [1.02"), std::string::npos) << whole;
  EXPECT_EQ(whole.find("seen_through"), std::string::npos) << whole;
}

// Each item of a look feels the transforms behind it, and no other part of the look changes.
TEST(PovModifiers, ItemsOfALookFollowEachOther) {
  expect_same({
      {"sphere { 0, 1 pigment { gradient y } scale 3 finish { ambient 0.5 } }",
       "sphere { 0, 1 pigment { gradient y } finish { ambient 0.5 } scale 3 }"},
      {"sphere { 0, 1 texture { pigment { gradient y } } scale 3 normal { bumps 0.1 scale 1/3 } }",
       "sphere { 0, 1 texture { pigment { gradient y } normal { bumps 0.1 scale 1/9 } } scale 3 }"},
      {"sphere { 0, 1 texture { pigment { rgb x } finish { ambient 0.7 } } pigment { rgb y } }",
       "sphere { 0, 1 texture { pigment { rgb y } finish { ambient 0.7 } } }"},
      {"union { sphere { 0, 1 } pigment { gradient y } scale 3 finish { ambient 0.5 } }",
       "union { sphere { 0, 1 } pigment { gradient y } finish { ambient 0.5 } scale 3 }"},
      {"box { -1, 1 material { texture { pigment { gradient y } } scale 3 } }",
       "box { -1, 1 texture { pigment { gradient y } scale 3 } }"},
      {"#declare M = material { texture { pigment { gradient y } } }\nbox { -1, 1 material { M scale 3 } "
       "scale 2 }",
       "box { -1, 1 texture { pigment { gradient y } scale 3 } scale 2 }"},
      {"box { -1, 1 pigment { checker pigment { rgb y } } }",
       "box { -1, 1 pigment { checker rgb y, rgb 0 } }"},
  });
}

TEST(PovModifiers, TexturesBeginWithTheDefaultWhereTheyStand) {
  expect_same({
      {"#declare T = texture { pigment { rgb 1 } } #default { finish { ambient 0.9 } } sphere { 0, 1 texture "
       "{ T } }",
       "sphere { 0, 1 texture { pigment { rgb 1 } } }"},
      {"#declare B = sphere { 0, 1 pigment { rgb 1 } } #default { finish { ambient 0.9 } } object { B }",
       "sphere { 0, 1 pigment { rgb 1 } }"},
      {"#default { finish { ambient 0.9 } } #default { texture { pigment { rgb x } } } sphere { 0, 1 }",
       "sphere { 0, 1 pigment { rgb x } finish { ambient 0.9 } }"},
      // Pigments and what has no texture take the later one.
      {"#declare P = pigment { rgb 1 } #default { finish { ambient 0.9 } } sphere { 0, 1 pigment { P } }",
       "sphere { 0, 1 pigment { rgb 1 } finish { ambient 0.9 } }"},
      {"#declare B = sphere { 0, 1 } #default { finish { ambient 0.9 } pigment { rgb x } } object { B }",
       "sphere { 0, 1 pigment { rgb x } finish { ambient 0.9 } }"},
  });
}

// Only what is said behind the point moves it.
TEST(PovModifiers, LightsKeepWhatIsSetLater) {
  for (const Same& c : std::vector<Same>{
           {"light_source { 0 rgb 1 spotlight translate <0, 4, -3> point_at 0 }",
            "light_source { <0, 4, -3> rgb 1 spotlight point_at 0 }"},
           {"light_source { 0 rgb 1 spotlight point_at 0 translate <0, 4, -3> }",
            "light_source { <0, 4, -3> rgb 1 spotlight point_at <0, 4, -3> }"},
           {"light_source { 0 rgb 1 rotate 90*z area_light x, z, 2, 2 translate y }",
            "light_source { y rgb 1 area_light x, z, 2, 2 }"},
       })
    EXPECT_EQ(scene_of(c.text), scene_of(c.means)) << c.text;
}

TEST(PovModifiers, BackgroundsLetLightPass) {
  EXPECT_EQ(middle("background { rgb <1, 0.5, 0.25> transmit 0.5 }"), (Vec3f{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(middle("background { rgb <1, 0.5, 0.25> filter 0.5 }"), (Vec3f{1, 0.5f, 0.25f}));
  EXPECT_EQ(middle("background { rgb <1, 0.5, 0.25> transmit 0.5 }", "#version 3.6;\n"),
            (Vec3f{1, 0.5f, 0.25f}));
  EXPECT_EQ(middle("sky_sphere { pigment { rgbt <1, 1, 1, 0.5> } } background { rgb z }"),
            (Vec3f{0.5f, 0.5f, 1}));
}

// What neither bends nor colours light is no level of reflections and refractions.
TEST(PovModifiers, LightPassesManyClearSurfaces) {
  const std::string boxes =
      "background { rgb 1 } #for (i, 0, 40) box { <-1, -1, i>, <1, 1, i + 0.01> "
      "pigment { rgbt 1 } finish { ambient 0 diffuse 0 } ";
  EXPECT_EQ(middle(boxes + "} #end"), (Vec3f{1, 1, 1}));
  EXPECT_EQ(middle(boxes + "interior { ior 1.3 } } #end"), (Vec3f{0, 0, 0}));
}

TEST(PovModifiers, FlatBoxesAreSeen) {
  const std::string look = " pigment { rgb x } finish { ambient 1 diffuse 0 } ";
  EXPECT_EQ(middle("box { <-1, -1, 0>, <1, 1, 0>" + look + "}"), (Vec3f{1, 0, 0}));
  EXPECT_EQ(middle("box { <-1, 0, -1>, <1, 0, 1>" + look + "rotate 90*x }"), (Vec3f{1, 0, 0}));
  EXPECT_EQ(middle("difference { sphere { 0, 1" + look + "} box { <-1, -1, 0>, <1, 1, 0> } }"),
            (Vec3f{1, 0, 0}));
}

// Scenes of before 3.7 that state no gamma, or no version at all, name the numbers of the file.
TEST(PovModifiers, OldScenesNameTheNumbersOfTheFile) {
  const TempDir dir;
  const auto film = [&](const std::string& text) {
    return load_scene(dir.write("scene.pov", text + "\nsphere { 0, 1 }")).film.tone;
  };
  const Tone raw{ToneKind::raw};
  EXPECT_EQ(film(""), raw);
  EXPECT_EQ(film("#version 3.6;"), raw);
  EXPECT_EQ(film("#version 3.7; global_settings { assumed_gamma srgb }"), raw);
  EXPECT_EQ(film("#version 3.7;"), Tone{});
  // Until one is stated `version` is 3.7, as include files find that put it back.
  EXPECT_EQ(film("#declare Before = version; #version 3.5; #version Before;"), Tone{});
  EXPECT_EQ(film("#version 3.6; #declare Before = version; #version 3.5; #version Before;"), raw);
  EXPECT_EQ(film("global_settings { assumed_gamma 1 }"), Tone{});
  EXPECT_EQ(film("global_settings { assumed_gamma 2.2 }"), (Tone{ToneKind::srgb, 0, 2.2}));
  Scene scene = load_scene(dir.write("scene.pov", "background { rgb <0.2, 0.6, 1.5> }"));
  scene.film.width = scene.film.height = 1, scene.integrator.samples = 1;
  const FlatImage image = flatten(render(scene, {}).picture, PixelLayout::srgb8);
  EXPECT_EQ(image.bytes, (std::vector<std::uint8_t>{51, 153, 255}));
}

/// Three numbers that POV-Ray gave for the middle of a scene.
struct Measured {
  const char* text;
  Vec3f color;
};
void expect_measured(const std::vector<Measured>& cases) {
  for (const Measured& c : cases) {
    const Vec3f seen = middle(c.text);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], c.color[k], 4e-5f) << c.text;
  }
}

// What passes unbent is no level of max_trace_level, by a pattern, with a colour and beside a mirror, too.
TEST(PovModifiers, LightPassesManySurfaces) {
  expect_measured({
      {"background { rgb <.4, .6, .9> } #for (I, 1, 9) disc { 0, z, 1 pigment { rgbf <1, .9, .8, .9> } "
       "finish { ambient .3 diffuse 0 } translate -I*z/9 } #end",
       {0.338735f, 0.2108339f, 0.1280537f}},
      {"background { rgb <.4, .6, .9> } #for (I, 1, 9) disc { 0, z, 1 pigment { rgbt <.2, .5, 1, .8> } "
       "finish { ambient .3 diffuse 0 reflection .1 } translate -I*z/9 } #end",
       {0.2239719f, 0.3982605f, 0.6752728f}},
      {"background { rgb <.4, .6, .9> } #for (I, 1, 9) disc { 0, z, 1 pigment { planar color_map { [0 rgbt "
       "<1, "
       "0, 0, .9>] [1 rgbt <0, 0, 1, .8>] } } finish { ambient <.2, .1, .4> diffuse 0 } translate -I*z/9 } "
       "#end",
       {0.0536812f, 0.0805371f, 0.4671092f}},
      {"background { rgb <.4, .6, .9> } #for (I, 1, 9) disc { 0, z, 1 pigment { checker rgbt <1, .5, 0, .9> "
       "rgbt <0, 0, 1, .8> } finish { ambient .5 diffuse 0 } translate <.3, .3, -I/9> } #end",
       {0.461265f, 0.3855955f, 0.3486839f}},
  });
}

TEST(PovModifiers, SetsOfMandelbrotAreGreyWithAnExponent) {
  const std::string set = "disc { 0, z, 1 finish { ambient 1 diffuse 0 } pigment { mandel 50 ";
  expect_measured({{(set + "translate <-.3, -.2, 0> } }").c_str(), {0, 1, 1}},
                   {(set + "exponent 3 translate <-.3, -.2, 0> } }").c_str(), {1, 1, 1}}});
}

// What is subtracted ends where its faces coincide with others, as seen in POV-Ray.
TEST(PovModifiers, FacesThatCoincideLeaveSkins) {
  const std::string look = " pigment { rgb <1, .6, .3> } }";
  expect_same({
      {("difference { box { -1, 1 } box { <-.5, 0, -.5>, <.5, 1, .5> }" + look).c_str(),
       ("box { -1, 1" + look).c_str()},
      {("difference { cylinder { -y, y, 1.5 } cylinder { -y, y, 1 }" + look).c_str(),
       ("cylinder { -y, y, 1.5" + look).c_str()},
      {("difference { union { box { -1, 1 } box { 0, <2, 1.5, 1> } } "
        "object { box { <-1, 0, -1>, 1 } scale <.5, 1, .5> } rotate 20*y" +
        look)
           .c_str(),
       ("union { box { -1, 1 } box { 0, <2, 1.5, 1> } rotate 20*y" + look).c_str()},
  });
  // Those that do not are open.
  EXPECT_NE(picture_of("difference { box { -1, 1 } box { <-.5, 0, -.5>, <.5, 1.001, .5> }" + look),
            picture_of("box { -1, 1" + look));
}

TEST(PovModifiers, LampsLightTheBack) {
  expect_measured({
      {"light_source { <3, 2, 9> rgb 1 } disc { 0, <.3, .2, -1>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse .6, .4 brilliance 2 } }",
       {0.22327f, 0.111635f, 0.0558175f}},
      {"light_source { <3, 2, 9> rgb 1 } disc { 0, <.3, .2, -1>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse .6 } double_illuminate }",
       {0.4482643f, 0.2241398f, 0.1120623f}},
      {"light_source { <3, 2, 9> rgb 1 } union { disc { 0, <.3, .2, -1>, 1 } double_illuminate "
       "pigment { rgb <1, .5, .25> } finish { ambient 0 diffuse .6 } }",
       {0.4482643f, 0.2241398f, 0.1120623f}},
      {"light_source { <3, 2, 9> rgb 1 } disc { 0, <.3, .2, -1>, 1 finish { diffuse .6 ambient 0 } }",
       {0, 0, 0}},
  });
}

TEST(PovModifiers, MetalsAreWhiteAtGrazingAngles) {
  expect_measured({
      {"light_source { <9, 0, .9> rgb 1 } disc { 0, <1, 0, -1.1>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse 0 phong 1 phong_size 1 metallic } }",
       {0.9810788f, 0.5106432f, 0.2754253f}},
      {"light_source { <9, 0, 4> rgb 1 } disc { 0, <1, 0, -.6>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse 0 specular .8 roughness 1 metallic .5 } }",
       {0.7994812f, 0.6084993f, 0.5130083f}},
      {"background { rgb .8 } disc { 0, <1, 0, -.2>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse 0 reflection { .9 metallic } } }",
       {0.7199969f, 0.44271f, 0.3040665f}},
  });
}

TEST(PovModifiers, FilmsColourLampsAndMirrors) {
  const char* const lit =
      "light_source { <0, 0, -9> rgb 1 } disc { 0, <.6, 0, -1>, 1 pigment { rgb <1, .5, .25> } "
      "finish { ambient 0 diffuse .5 irid { .4 thickness .3 } } }";
  expect_measured({
      {lit, {0.4126039f, 0.2999314f, 0.1457694f}},
      {"global_settings { irid_wavelength <.35, .26, .24> } light_source { <0, 0, -9> rgb 1 } "
       "disc { 0, <.6, 0, -1>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse .5 irid { .4 thickness .15 } } }",
       {0.4126039f, 0.2999314f, 0.1457694f}},
      {"background { rgb .5 } disc { 0, <.6, 0, -1>, 1 pigment { rgb <1, .5, .25> } "
       "finish { ambient 0 diffuse 0 reflection .5 irid { .4 thickness .3 } } }",
       {0.240589f, 0.3497826f, 0.339971f}},
  });
  const std::string turbulent =
      std::string(lit).replace(std::string(lit).find(".3 }"), 4, ".3 turbulence 1 }");
  EXPECT_NE(middle(turbulent), middle(lit));
}

TEST(PovModifiers, LightGroupsKeepTheirLight) {
  const char* const disc = "disc { 0, -z, 1 pigment { rgb 1 } finish { ambient 0 diffuse .5 } }";
  const std::string red = "light_source { <0, 0, -9> rgb x } ", green = "light_source { <3, 0, -9> rgb y } ";
  const auto expect = [&](const std::string& text, const Vec3f& color) {
    const Vec3f seen = middle(text);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], color[k], 4e-5f) << text;
  };
  expect(red + "light_group { " + green + disc + " }", {0, 0.474342f, 0});
  expect(red + "light_group { " + green + disc + " global_lights on }", {0.5f, 0.474342f, 0});
  expect(red + "light_group { " + green + "sphere { <5, 0, 0>, 1 } } " + disc, {0.5f, 0, 0});
  expect(red + "union { light_group { " + green + disc + " } rotate 360*z }", {0, 0.474342f, 0});
  // The transforms of a group move its lights.
  expect("light_group { light_source { <3, 0, 9> rgb y } " + std::string(disc) + " rotate 180*y }",
         {0, 0.474342f, 0});
  // One without objects has nothing to light.
  expect(red + disc + " light_group { " + green + "}", {0.5f, 0, 0});
}

// What is open keeps its inside in combinations, and its ends are not seen.
TEST(PovModifiers, OpenPartsOfCombinations) {
  const std::string look = " pigment { rgb x } finish { ambient 1 diffuse 0 } ";
  const std::string wall = "disc { 5*z, -z, 9 pigment { rgb z } finish { ambient 1 diffuse 0 } } ";
  for (const std::string tube :
       {"cylinder { -z, z, 1 open", "cone { -z, .5, z, 1 open",
        "isosurface { function { x*x + y*y - 1 } contained_by { box { -1.5, 1.5 } } open"})
    for (const std::string around : {"merge { ", "difference { "}) {
      EXPECT_EQ(middle(wall + around + tube + look + "} box { <3, -1, -1>, <4, 1, 1> } }"), (Vec3f{0, 0, 1}))
          << tube;
      EXPECT_EQ(
          middle(wall + around + tube + look + "} sphere { <0, 0, 1.5>, .2 " + look + "} rotate 90*y }"),
          (Vec3f{1, 0, 0}))
          << tube;
    }
  // What is taken away there shows its own surface.
  EXPECT_EQ(middle("difference { sphere { 0, 1 } cylinder { -2*z, 0, .5 open" + look + "} }").x, 0);
  EXPECT_EQ(middle("difference { cylinder { -z, z, 1 open pigment { rgb y } } sphere { -z, 1" + look + "} }"),
            (Vec3f{1, 0, 0}));
}

// The middles of six faces.
TEST(PovModifiers, BoxesUnfoldTheirImage) {
  const auto face = [](const std::string& turn) {
    const Vec3f color = middle(
        "box { -1, <1, 2, 3> pigment { uv_mapping gradient x color_map { [0 rgb 0] [1 rgb x] } } "
        "finish { ambient 1 diffuse 0 } translate <0, -.5, -1> " +
        turn + " }");
    return std::round(color.x * 1000) / 1000;
  };
  EXPECT_EQ(face("rotate 90*y"), 0.625f);
  EXPECT_EQ(face("rotate 180*y"), 0.375f);
  EXPECT_EQ(face("rotate -90*y"), 0.125f);
  EXPECT_EQ(face(""), 0.875f);
  EXPECT_EQ(face("rotate 90*x"), 0.375f);
  EXPECT_EQ(face("rotate -90*x"), 0.375f);
  // What is mirrored before it is turned shows the same image.
  const auto left = [](const std::string& moves) {
    const Vec3f color = middle(
        "box { -1, 1 pigment { uv_mapping gradient x color_map { [0 rgb 0] [1 rgb x] } } "
        "finish { ambient 1 diffuse 0 } " +
        moves + " translate x/2 }");
    return std::round(color.x * 10000) / 10000;
  };
  EXPECT_EQ(left(""), 0.9375f);
  EXPECT_EQ(left("scale <-1, 1, 1>"), 0.9375f);
  EXPECT_EQ(left("rotate 180*x scale <-1, 1, 1>"), 0.4375f);
  EXPECT_EQ(left("scale <-1, 1, 1> rotate 180*x"), 0.3125f);
}

TEST(PovModifiers, BlobsBlendManyLooks) {
  std::string blob = "blob { threshold .4 ";
  for (int i = 0; i < 40; ++i)
    blob += "sphere { <" + std::to_string(i - 20) + ", 0, 0>, 1.5, 1 pigment { rgb " +
            (i == 20              ? "<1, 0, 0>"
             : i == 19 || i == 21 ? "<0, 1, 0>"
                                  : "<0, 0, 1>") +
            " } finish { ambient 1 diffuse 0 } } ";
  blob += "}";
  expect_measured({{blob.c_str(), {0.8861219f, 0.1138781f, 0}}});
}

// Loops and recursive macros add to a union by declaring it again.
TEST(PovModifiers, UnionsGrowInLoops) {
  const std::string loop =
      "#declare All = sphere { 0, 1 } #for (i, 1, 3000) #declare All = union { object { All } ";
  const std::string grown = scene_of(loop + "sphere { i, 1 } } #end object { All translate x }");
  std::size_t spheres = 0;
  for (std::size_t at = 0; (at = grown.find("sphere:", at)) != std::string::npos; ++at) ++spheres;
  EXPECT_EQ(spheres, 3001u);
  // One with a look of its own is more than its objects.
  EXPECT_THROW(scene_of(loop + "sphere { i, 1 } pigment { rgb x } } #end object { All }"), Error);
}

// A pigment that names none changes the one that is there; of layers the uppermost is changed.
TEST(PovModifiers, PigmentsAreChanged) {
  const std::string shown = " finish { ambient 1 diffuse 0 } ";
  const std::string ramp =
      "#declare M = texture { pigment { gradient z color_map { [0 rgb x] [1 rgb z] } }" + shown + "} ";
  const std::string layers =
      "#declare T = texture { pigment { rgb x } finish { ambient .1 diffuse 0 } } "
      "texture { pigment { rgbt <0, 1, 0, .5> } finish { ambient .1 diffuse 0 } } ";
  expect_measured({
      {(ramp + "#declare S = sphere { 0, 1 texture { M } } object { S pigment { scale .3 } }").c_str(),
       {0.3333028f, 0, 0.6666972f}},
      {(ramp + "sphere { 0, 1.1 texture { M pigment { color_map { [0 rgb y] [1 rgb 1] } } } }").c_str(),
       {0.9000076f, 1, 0.9000076f}},
      {(ramp + "sphere { 0, 1.1 texture { M } pigment { scale 3 } translate -.2*z }").c_str(),
       {0.3666743f, 0, 0.6333410f}},
      {(layers + "sphere { 0, 1 texture { T finish { ambient .9 } } }").c_str(), {0.0500038f, 0.4500038f, 0}},
      {("background { rgb .5 } #declare P = pigment { rgb x }; sphere { 0, 1 pigment { P transmit .6 }" +
        shown + "}")
           .c_str(),
       {0.1799954f, 0.1799954f, 0.1799954f}},
  });
}

// From the place of the last entry on a map shows that; below it the first place that is not below the value.
TEST(PovModifiers, PlacesOfMapsMayDescend) {
  const std::string shown = " finish { ambient 1 diffuse 0 } ";
  expect_measured({
      {("plane { -z, 0 pigment { gradient x color_map { [.5 rgb x] [.3 rgb y] } } translate -.4*x" + shown +
        "}")
           .c_str(),
       {0, 1, 0}},
      {("plane { -z, 0 pigment { gradient x color_map { [.2 rgb 0] [.5 rgb x] [.3 rgb y] } translate -.25*x "
        "}" +
        shown + "}")
           .c_str(),
       {0.1666590f, 0, 0}},
      {("plane { -z, 0 texture { gradient x texture_map { [.7 pigment { rgb x }" + shown +
        "] [.3 pigment { rgb y }" + shown + "] } translate -.5*x } }")
           .c_str(),
       {0, 1, 0}},
  });
}

TEST(PovModifiers, BlocksMoveWhatStandsInThem) {
  const std::string shown = " finish { ambient 1 diffuse 0 } ";
  EXPECT_EQ(middle("#declare C = cylinder { -9*z, 9*z, 1 } plane { -z, 0 pigment { rgb y } "
                   "clipped_by { C scale 2 } translate 1.5*x" +
                   shown + "}"),
            (Vec3f{0, 1, 0}));
  expect_measured({
      {"#declare L = union { light_source { <-20, 10, -30> rgb .5 } light_source { <0, 30, -1> rgb x } } "
       "light_source { L } plane { -z, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }",
       {0.4342107f, 0.4008850f, 0.4008850f}},
  });
}

// As high as it is far from <0, 0, 1>, to where it looks.
TEST(PovModifiers, AnOrthographicViewIsAsHighAsItIsFar) {
  EXPECT_EQ(scene_of("camera { orthographic location -8*z } sphere { 0, 1 }"),
            scene_of("camera { orthographic location -8*z right 11.97*x up 9*y } sphere { 0, 1 }"));
}

// The slope of a bump_map is the difference of neighbouring pixels, at any size.
TEST(PovModifiers, PixelsOfBumpMapsAreSteps) {
  const TempDir dir;
  const auto gain = [&](int side, const std::string& moves) {
    std::string pixels;
    for (int i = 0; i < side * side; ++i) pixels += std::to_string(i % side) + " ";
    const std::string size = std::to_string(side);
    dir.write("ramp.pgm", "P2 " + size + " " + size + " 255 " + pixels);
    const std::string text =
        "#version 3.7; sphere { 0, 1 normal { bump_map { pgm \"ramp.pgm\" bump_size 6 } " + moves + " } }";
    const std::string scene = yaml_text(*read_pov_tree(dir.write("scene.pov", text), {}, {}).root);
    return std::stod(scene.substr(scene.find("gain: ") + 6));
  };
  EXPECT_NEAR(gain(16, ""), 6.0 / 16, 1e-6);
  EXPECT_NEAR(gain(64, ""), 6.0 / 64, 1e-6);
  EXPECT_NEAR(gain(64, "scale 3"), 6.0 / 64 * 3, 1e-6);
}

// Each layer has its own finish; light of those below is seen through those above.
TEST(PovModifiers, LayersShineThroughEachOther) {
  const std::string room =
      "sphere { -20*z, 3 inverse hollow pigment { rgb 1 } finish { ambient .4 diffuse 0 } no_shadow } ";
  const std::string lamp = "light_source { <0, 0, -9> rgb 1 } ";
  const std::string coated =
      "sphere { 0, 1 texture { pigment { rgb <1, 0, 0> } finish { ambient 0 diffuse .2 } } "
      "texture { pigment { rgbt <0, 1, 0, .8> } finish { ambient 0 diffuse .2 phong .5 phong_size 3 ";
  const std::string painted =
      "sphere { 0, 1 texture { pigment { rgb <1, 0, 0> } finish { ambient 0 diffuse .2 specular .5 roughness "
      ".1 } } "
      "texture { pigment { rgbt <0, 1, 0, .8> } finish { ambient 0 diffuse .2 } } "
      "texture { pigment { rgbf <.2, .5, 1, .5> } finish { ambient 0 diffuse .1 } } }";
  expect_measured({
      {(lamp + coated + "} } }").c_str(), {0.66f, 0.54f, 0.5f}},
      {(lamp + room + coated + "reflection .25 } } }").c_str(), {0.76f, 0.64f, 0.6f}},
      {(lamp + painted).c_str(), {0.0660f, 0.1350f, 0.25f}},
  });
}

// Where an image that stands once ends, and where it lies on a ring.
TEST(PovModifiers, ImagesLieWherePovRayLaysThem) {
  const TempDir dir;
  dir.write("ramp.ppm",
            "P3 4 4 255 0 0 0 60 0 0 120 0 0 180 0 0 0 60 0 60 60 0 120 60 0 180 60 0 "
            "0 120 0 60 120 0 120 120 0 180 120 0 0 180 0 60 180 0 120 180 0 180 180 0");
  // Red and green, in steps of 60/255, at a place.
  const auto texel = [&](const std::string& image, const std::string& place) {
    const Vec3f color = test::pixel_of(
        dir.write("scene.pov", "#version 3.7; global_settings { assumed_gamma 1 } camera { location " +
                                   place + " - 9*z look_at " + place + " angle 0.05 } sphere { " + place +
                                   ", 0.02 pigment { image_map { ppm \"ramp.ppm\" " + image +
                                   " } finish { ambient 1 diffuse 0 } }"));
    const auto steps = [](float value) { return static_cast<int>(std::lround(double{value} * 255 / 60)); };
    return std::pair(steps(color.x), steps(color.y));
  };
  using Texel = std::pair<int, int>;
  const char* const flat = "once } rotate 90*x scale 2";
  EXPECT_EQ(texel(flat, "<1.3, -1, .7>"), Texel(2, 2));
  EXPECT_EQ(texel(flat, "<.3, -1, 1.8>"), Texel(0, 0));
  EXPECT_EQ(texel(flat, "<2.1, -1, 1>"), Texel(0, 0));
  const char* const around = "once map_type 2 } translate -y/2";
  EXPECT_EQ(texel(around, "<-1, -.4, .5>"), Texel(1, 3));
  EXPECT_EQ(texel(around, "<1, .6, .5>"), Texel(0, 0));
  EXPECT_EQ(texel("map_type 5 }", "<1.4, .1, .1>"), Texel(0, 1));
  EXPECT_EQ(texel("map_type 5 }", "<-.7, .2, -.1>"), Texel(2, 0));
  EXPECT_EQ(texel("map_type 5 }", "<-.9, -.3, .1>"), Texel(1, 3));
}

}  // namespace
}  // namespace oktett::pov_modifiers_test
