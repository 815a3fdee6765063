#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/image/encode.h"
#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "io/yaml/write_yaml.h"
#include "render/picture/render.h"
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
  Scene scene =
      load_scene(dir.write("scene.pov", version + "camera { location -9*z look_at 0 angle 1 }\n" + text));
  scene.film.width = scene.film.height = 1, scene.integrator.samples = 1;
  const Picture picture = render(scene, {}).picture;
  Vec3f color;
  int k = 0;
  for (const char* channel : {"R", "G", "B"}) color[k++] = picture.find(channel)->values[0];
  return color;
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

}  // namespace
}  // namespace oktett::pov_modifiers_test
