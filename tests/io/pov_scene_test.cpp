// Scenes in POV-Ray's language: the scene files that say the same.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "render/geometry.h"
#include "render/picture/render.h"
#include "tests/io/palette_png.h"
#include "tests/io/pov_files.h"

namespace oktett::pov_scene_test {
namespace {

using test::PovFiles;

struct Case {
  std::string pov, yaml;
};
void expect_objects(const std::vector<Case>& cases) {
  const PovFiles files;
  for (const Case& c : cases) {
    SCOPED_TRACE(c.pov);
    EXPECT_EQ(files.object("#version 3.7;\n" + c.pov), c.yaml);
  }
}

TEST(PovScene, ShapesHaveTheirKeys) {
  expect_objects({
      {"sphere { <1,2,3>, 0.5 }", "{sphere: {center: [1, 2, 3], radius: 0.5}}"},
      {"box { <1,2,3>, <0,5,-1> }", "{box: {min: [0, 2, -1], max: [1, 5, 3]}}"},
      {"cylinder { 0, y, 2 }", "{cylinder: {from: [0, 0, 0], to: [0, 1, 0], radius: 2}}"},
      {"cylinder { 0, y, 2 open }", "{cylinder: {from: [0, 0, 0], to: [0, 1, 0], radius: 2, open: true}}"},
      {"cone { 0, 1, y, 0.5 }", "{cone: {from: [0, 0, 0], from_radius: 1, to: [0, 1, 0], to_radius: 0.5}}"},
      {"plane { y, -1 }", "{plane: {normal: [0, 1, 0], offset: -1}}"},
      {"disc { 0, y, 2 }", "{disk: {center: [0, 0, 0], normal: [0, 1, 0], radius: 2}}"},
      {"disc { 0, y, 2, 1 }", "{disk: {center: [0, 0, 0], normal: [0, 1, 0], radius: 2, inner_radius: 1}}"},
      {"prism { 1, 0, 4, <0,0>, <1,0>, <0,1>, <0,0> }",
       "{prism: {outlines: [[[0, 0], [1, 0], [0, 1], [0, 0]]], from: 0, to: 1}}"},
      {"prism { linear_sweep linear_spline 0, 1, 8, <0,0>, <4,0>, <0,4>, <0,0>, <1,1>, <2,1>, <1,2>, <1,1> "
       "open }",
       "{prism: {outlines: [[[0, 0], [4, 0], [0, 4], [0, 0]], [[1, 1], [2, 1], [1, 2], [1, 1]]], from: 0, "
       "to: 1, "
       "open: true}}"},
      {"prism { conic_sweep quadratic_spline 0, 1, 5, <9,9>, <0,0>, <1,0>, <0,1>, <0,0> }",
       "{prism: {outlines: [[[9, 9], [0, 0], [1, 0], [0, 1], [0, 0]]], curve: quadratic, sweep: conic, from: "
       "0, "
       "to: 1}}"},
      {"prism { cubic_spline 0, 1, 12, <9,9>, <0,0>, <1,0>, <0,1>, <0,0>, <8,8>, <7,7>, <2,2>, <3,2>, <2,3>, "
       "<2,2>, "
       "<6,6> }",
       "{prism: {outlines: [[[9, 9], [0, 0], [1, 0], [0, 1], [0, 0], [8, 8]], [[7, 7], [2, 2], [3, 2], [2, "
       "3], [2, "
       "2], [6, 6]]], curve: cubic, from: 0, to: 1}}"},
      {"prism { bezier_spline 0, 1, 8, <0,0>, <1,1>, <2,1>, <3,0>, <3,0>, <2,-1>, <1,-1>, <0,0> }",
       "{prism: {outlines: [[[0, 0], [1, 1], [2, 1], [3, 0], [2, -1], [1, -1], [0, 0]]], curve: bezier, "
       "from: 0, to: "
       "1}}"},
      {"sphere_sweep { b_spline 4, 0, 1, x, 0.5, <2,1,0>, 0.5, 3*x, -1 tolerance 0.1 }",
       "{sphere_sweep: {spheres: [[0, 0, 0, 1], [1, 0, 0, 0.5], [2, 1, 0, 0.5], [3, 0, 0, 1]], curve: "
       "b_spline}}"},
      {"sphere_sweep { linear_spline 2, 0, 1, x, 0.5 }",
       "{sphere_sweep: {spheres: [[0, 0, 0, 1], [1, 0, 0, 0.5]]}}"},
      {"torus { 2, 0.5 }", "{torus: {major: 2, minor: 0.5}, transform: {rotate: [90, 0, 0]}}"},
      {"ovus { 1, 0.5 }", "{ovus: {bottom_radius: 1, top_radius: 0.5}}"},
      {"ovus { 1.5, 0 }", "{sphere: {center: [0, 0, 0], radius: 1.5}}"},
      {"ovus { 1, 2.5 }", "{sphere: {center: [0, 1, 0], radius: 2.5}}"},
      {"ovus { 0, 2 }", "{sphere: {center: [0, 0, 0], radius: 2}}"},
      {"quadric { <1,2,3>, <4,5,6>, <7,8,9>, -1 }",
       "{quadric: {coefficients: [1, 2, 3, 4, 5, 6, 7, 8, 9, -1]}}"},
      {"superellipsoid { <0.5, 0.5> }", "{superellipsoid: {p: 4, q: 4, r: 4}}"},
      {"superellipsoid { <0.5, 0.25> }", "{supertoroid: {m: 4, n: 4, q: 2, r: 1, p: 8, d: 0, e: 1}}"},
      {"bicubic_patch { type 1 flatness 0.01 u_steps 3 v_steps 3 uv_vectors <0,0>, <0.5,0>, <0.5,1>, <0,1> "
       "0, x, 2*x, 3*x, y, x+y, <2,1,1>, <3,1,0>, 2*y, <1,2,0>, <2,2,0>, <3,2,0>, 3*y, <1,3,0>, <2,3,0>, "
       "<3,3,0> }",
       "{bezier_patch: {patches: [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, "
       "1], [3, 1, 0], [0, 2, 0], [1, 2, 0], [2, 2, 0], [3, 2, 0], [0, 3, 0], [1, 3, 0], [2, 3, 0], [3, 3, "
       "0]]], uv: [0, 0, 0.5, 0, 0.5, 1, 0, 1]}}"},
      {"parametric { function { u*cos(v) } function { u*sin(v) } function { v } <0,-1>, <1,2> contained_by { "
       "sphere { 0, 3 } } max_gradient 2 accuracy 0.001 precompute 10 x,y,z }",
       "{parametric: {x: \"(u * cos(v))\", y: \"(u * sin(v))\", z: v, from: [0, -1], to: [1, 2], clip: "
       "{min: [-3, "
       "-3, -3], max: [3, 3, 3]}}}"},
      {"triangle { 0, x, y }", "{mesh: {file: triangle.ply}}"},
      {"sor { 4, <0.5,0>, <1,1>, <0.5,2>, <0.5,3> }",
       "{revolution: {profile: sor, points: [[0.5, 0], [1, 1], [0.5, 2], [0.5, 3]]}}"},
      {"lathe { linear_spline 2, <1,0>, <1,3> }",
       "{revolution: {profile: bezier, points: [[1, 0], [1, 1], [1, 2], [1, 3]], open: true}}"},
      {"blob { threshold 0.6 sphere { x, 2, 1 } cylinder { 0, y, 1, -0.5 } }",
       "{metaballs: {iso: 0.6, elements: [{point: [1, 0, 0], weight: 1, radius: 2}, {segment: {from: [0, 0, "
       "0], to: [0, 1, "
       "0]}, weight: -0.5, radius: 1}]}}"},
      {"blob { sphere { x, 2, 1 scale <1, 2, 3> rotate z*90 translate z } threshold 0.5 }",
       "{metaballs: {iso: 0.5, elements: [{ellipsoid: {center: [0, 1, 1], radii: [2, 1, 3], rotate: [0, 0, "
       "0]}, "
       "weight: 1, radius: 2}]}}"},
      {"isosurface { function { x*x + y - 2 } threshold 0.5 }",
       "{implicit: {function: \"(((x * x) + y) - 2) - 0.5\", bounds: {min: [-1, -1, -1], max: [1, 1, 1]}}}"},
      {"julia_fractal { <-0.1, 0.8, 0, 0> max_iteration 8 }",
       "{julia: {c: [-0.1, 0.8, 0, 0], iterations: 8, escape: 4}}"},
      {"julia_fractal { <-0.1, 0.8, 0, 0> max_iteration 8 hypercomplex cube }",
       "{julia: {c: [-0.1, 0.8, 0, 0], iterations: 8, algebra: hypercomplex, power: 3, escape: 4}}"},
  });
}

// As POV-Ray does with radii that make no egg.
TEST(PovScene, OviThatAreNoneAreSpheresOrErrors) {
  const PovFiles files;
  EXPECT_EQ(
      files.warnings("#version 3.7;\novus { 1, 2 }"),
      "scene.pov:2:1: warning: the top radius of this ovus is not less than twice the bottom radius: it is a "
      "sphere\n");
  EXPECT_EQ(files.warnings("#version 3.7;\novus { 1, 0 }"), "");
  EXPECT_EQ(files.error("#version 3.7;\novus { -1, 0.5 }"),
            "scene.pov:2:1: the radii of an ovus must not be negative");
  EXPECT_NE(files.error("#version 3.7;\novus { 1 }").find("the top radius"), std::string::npos);
  // Its box, which cuts an endless surface.
  const std::string cut = files.object(
      "#version 3.7;\nintersection { poly { 2, <1,0,0,0, 0,0,0, -1,0, 0> } ovus { 1, 1.2 translate 2*y } }");
  EXPECT_NE(cut.find("bounds: {min: [-1."), std::string::npos) << cut;
}

TEST(PovScene, PolynomialsAreCutAtWhatBoundsThem) {
  const PovFiles files;
  const std::string text =
      files.object("#version 3.7;\npoly { 2, <1,0,0,0, 0,0,0, 1,0, -1> clipped_by { sphere { 0, 2 } } }");
  EXPECT_NE(text.find("equation: \"1*x^2 + 1*z^2 - 1\""), std::string::npos) << text;
  EXPECT_NE(text.find("bounds: {min: [-2.04"), std::string::npos) << text;
}

/// What has a bounded zero set is bounded by that; x^2 + x z - 1 goes on for ever. The sphere of radius 2
/// lies in the box that is found, and this is less than a tenth larger.
TEST(PovScene, PolynomialsWithoutBoundsGetSomeIfTheyHaveAny) {
  const PovFiles files;
  const std::string ball = files.object(
      "#version 3.7;\nquartic { <1,0,0,0,2,0,0,2,0,0, 0,0,0,0,0,0,0,0,0,0, "
      "1,0,0,2,0,0,0,0,0,0, 1,0,0,0,-16> }");
  double lo = 0, hi = 0;
  const std::size_t at = ball.find("bounds: {min: [");
  ASSERT_NE(at, std::string::npos) << ball;
  ASSERT_EQ(std::sscanf(ball.c_str() + at, "bounds: {min: [%lf, %*f, %*f], max: [%lf", &lo, &hi), 2) << ball;
  EXPECT_TRUE(-2.2 < lo && lo <= -2 && 2 <= hi && hi < 2.2) << ball;
  const std::string endless =
      files.object("#version 3.7;\ncubic { <0,0,0,1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,0,-1> }");
  EXPECT_NE(endless.find("bounds: {min: [-1000, -1000, -1000], max: [1000, 1000, 1000]}"), std::string::npos)
      << endless;
}

/// What bounds an endless polynomial is what it is seen through, moved by the transforms behind it; in
/// combinations, and of what has an end, it cuts as before.
TEST(PovScene, EndlessPolynomialsAreSeenThroughTheirBounds) {
  const PovFiles files;
  const std::string cubic = "cubic { <0,0,0,1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,0,-1> ";
  const std::string seen =
      files.object("#version 3.7;\n" + cubic + "scale 2 bounded_by { sphere { 0, 3 } } translate x }");
  EXPECT_NE(
      seen.find(
          "seen_through: [{sphere: {center: [0, 0, 0], radius: 3}, transform: {translate: [1, 0, 0]}}]"),
      std::string::npos)
      << seen;
  EXPECT_NE(seen.find("max: [1000, 1000, 1000]"), std::string::npos) << seen;
  EXPECT_NE(seen.find("transform: [{scale: 2}, {translate: [1, 0, 0]}]"), std::string::npos) << seen;
  EXPECT_EQ(seen.find("open"), std::string::npos) << seen;
  for (const std::string& cut :
       {"intersection { sphere { 0, 9 } " + cubic + "bounded_by { sphere { 0, 3 } } } }",
        cubic + "bounded_by { union { sphere { 0, 3 } } } }", cubic + "clipped_by { sphere { 0, 3 } } }",
        std::string("poly { 2, <1,0,0,0, 1,0,0, 1,0, -1> bounded_by { sphere { 0, 3 } } }")}) {
    const std::string text = files.object("#version 3.7;\n" + cut);
    EXPECT_EQ(text.find("seen_through"), std::string::npos) << text;
    EXPECT_NE(text.find("max: [3.06"), std::string::npos) << text;
  }
}

TEST(PovScene, TransformsKeepTheirOrder) {
  expect_objects({
      {"sphere { 0, 1 scale 2 rotate y*30 translate x }",
       "{sphere: {center: [0, 0, 0], radius: 1}, transform: [{scale: 2}, {rotate: [0, 30, 0]}, {translate: "
       "[1, 0, 0]}]}"},
      {"sphere { 0, 1 matrix <1,2,3, 4,5,6, 7,8,10, 11,12,13> }",
       "{sphere: {center: [0, 0, 0], radius: 1}, transform: {matrix: [1, 4, 7, 11, 2, 5, 8, 12, 3, 6, 10, "
       "13]}}"},
      {"#declare T = transform { translate x }\nsphere { 0, 1 transform { T inverse } }",
       "{sphere: {center: [0, 0, 0], radius: 1}, transform: {matrix: [1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1, "
       "0]}}"},
      {"object { sphere { 0, 1 scale 2 } translate y }",
       "{sphere: {center: [0, 0, 0], radius: 1}, transform: [{scale: 2}, {translate: [0, 1, 0]}]}"},
  });
}

TEST(PovScene, CombinationsHaveNoComplements) {
  const std::string a = "sphere: {center: [0, 0, 0], radius: 1}",
                    b = "sphere: {center: [1, 0, 0], radius: 1}";
  const std::string x = "sphere { 0, 1 }", y = "sphere { x, 1 }", y_inverse = "sphere { x, 1 inverse }";
  expect_objects({
      {"intersection {" + x + y + "}", "{intersection: [{" + a + "}, {" + b + "}]}"},
      {"intersection {" + x + y_inverse + "}", "{difference: [{" + a + "}, {" + b + "}]}"},
      {"difference {" + x + y_inverse + "}", "{intersection: [{" + a + "}, {" + b + "}]}"},
      {"merge {" + x + y + "}", "{union: [{" + a + "}, {" + b + "}]}"},
      {"union {" + x + y + "}", "{group: [{" + a + "}, {" + b + "}]}"},
      {"intersection { box { -1, 1 } merge {" + x + y_inverse + "} }",
       "{difference: [{box: {min: [-1, -1, -1], max: [1, 1, 1]}}, {difference: [{" + b + "}, {" + a +
           "}]}]}"},
  });
}

TEST(PovScene, WhatCutsIsNotSeen) {
  const PovFiles files;
  EXPECT_EQ(files.object("#version 3.7;\nsphere { 0, 1 clipped_by { plane { y, 0 } } }"),
            "{intersection: [{sphere: {center: [0, 0, 0], radius: 1}}, {plane: {normal: [0, 1, 0]}, "
            "material: invisible}]}");
}

TEST(PovScene, WhatIsUsedOftenIsAPrototype) {
  const std::string text =
      "#version 3.7;\n#declare Thing = union { sphere { 0, 1 } sphere { x, 1 } box { -1, 1 } cone { 0, 1, y, "
      "0 } pigment { rgb 1 } }\n"
      "object { Thing }\nobject { Thing translate 3*x }\nobject { Thing pigment { rgb x } }\n";
  const PovFiles files;
  const std::string objects = files.section(text, "objects");
  EXPECT_TRUE(objects.starts_with(
      "[{instance: Thing, name: Thing}, {instance: Thing, transform: {translate: [3, 0, 0]}, "))
      << objects;
  EXPECT_TRUE(files.section(text, "define").starts_with("{Thing: {group: ["))
      << files.section(text, "define");
}

TEST(PovScene, LooksBecomeMaterials) {
  const PovFiles files;
  const auto material = [&](const std::string& look) {
    return files.section("#version 3.7;\nsphere { 0, 1 " + look + " }", "materials");
  };
  EXPECT_EQ(material("pigment { rgb <1, 0.5, 0> }"),
            "{material: {color: [1, 0.5, 0], ambient: 0.1, diffuse: 0.6}}");
  EXPECT_EQ(
      material("pigment { rgb 1 } finish { ambient 0 diffuse 1 phong 0.5 phong_size 20 reflection 0.25 }"),
      "{material: {color: [1, 1, 1], ambient: 0, diffuse: 1, specular: 0.5, phong: 20, reflection: 0.25}}");
  EXPECT_EQ(material("pigment { rgb 1 } finish { specular 1 roughness 0.01 }"),
            "{material: {color: [1, 1, 1], ambient: 0.1, diffuse: 0.6, specular_blinn: 1, blinn: 100}}");
  EXPECT_EQ(material("pigment { rgbf <1, 0.5, 1, 0.75> } interior { ior 1.5 }"),
            "{material: {color: [1, 0.5, 1], ambient: 0.025, diffuse: 0.15, transparency: 0.75, filter: [1, "
            "0.5, 1], fresnel: false, ior: 1.5}}");
  EXPECT_EQ(
      material("pigment { checker rgb 0, rgb 1 scale 2 }"),
      "{material: {color: {checker: {colors: [[0, 0, 0], [1, 1, 1]], transform: {scale: 2}}}, ambient: 0.1, "
      "diffuse: 0.6}}");
  // What is moved before it gets its texture.
  EXPECT_NE(
      material("pigment { rgb 1 } scale 2 pigment { checker rgb 0, rgb 1 scale 3 }").find("{matrix: [2, 0,"),
      std::string::npos);
  EXPECT_EQ(material("translate x pigment { checker rgb 0, rgb 1 }"),
            "{material: {color: {checker: {colors: [[0, 0, 0], [1, 1, 1]], transform: {matrix: [1, 0, 0, -1, "
            "0, 1, 0, 0, 0, 0, "
            "1, 0]}}}, ambient: 0.1, diffuse: 0.6}}");
}

TEST(PovScene, PatternsAreTextures) {
  const PovFiles files;
  const auto color = [&](const std::string& pigment) {
    const std::string text =
        files.section("#version 3.7;\nsphere { 0, 1 pigment { " + pigment + " } }", "materials");
    const std::string begin = "{material: {color: ", end = ", ambient: 0.1, diffuse: 0.6}}";
    return text.starts_with(begin) && text.ends_with(end)
               ? text.substr(begin.size(), text.size() - begin.size() - end.size())
               : text;
  };
  EXPECT_EQ(
      color("gradient y color_map { [0 rgb 0] [0.5 rgb x] [1 rgb 1] } scale 2"),
      "{linear: {direction: [0, 1, 0], map: [[0, [0, 0, 0]], [0.5, [1, 0, 0]], [1, [1, 1, 1]]], transform: "
      "{scale: 2}}}");
  EXPECT_EQ(color("spotted"),
            "{noise: {octaves: 1, map: [[0, [0, 0, 0]], [1, [1, 1, 1]]], noise_generator: povray_2}}");
  EXPECT_EQ(
      color("marble turbulence 0.5 octaves 3 color_map { [0, 0.5 rgb 0 rgb x] [0.5, 1 rgb x rgb 1] }"),
      "{layers: {map: [[0, [0, 0, 0]], [0.5, [1, 0, 0]], [0.5, [1, 0, 0]], [1, [1, 1, 1]]], turbulence: "
      "{amount: 0.5, octaves: 3}, noise_generator: povray_2}}");
  // Transforms before a warp are nearer to the pattern.
  EXPECT_EQ(
      color("onion scale 2 warp { repeat 3*x flip x } rotate y*30 frequency 2 phase 0.25 sine_wave"),
      "{onion: {map: [[0, [0, 0, 0]], [1, [1, 1, 1]]], wave: sine, frequency: 2, phase: 0.25, warps: "
      "[{transform: {scale: 2}}, {repeat: {width: [3, 0, 0], flip: [1, 0, 0]}}], transform: {rotate: [0, 30, "
      "0]}}}");
  EXPECT_EQ(color("brick rgb 0, rgb 1 brick_size <4, 1, 2> mortar 0.1"),
            "{brick: {brick: [4, 1, 2], mortar: 0.1, colors: [[0, 0, 0], [1, 1, 1]]}}");
  EXPECT_EQ(color("hexagon rgb 1"), "{hexagon: {colors: [[1, 1, 1], [0, 1, 0], [1, 0, 0]]}}");
  EXPECT_EQ(color("checker pigment { radial color_map { [0 rgb 0] [1 rgb x] } } rgb 1"),
            "{checker: {colors: [{angular: {map: [[0, [0, 0, 0]], [1, [1, 0, 0]]]}}, [1, 1, 1]]}}");
  EXPECT_EQ(color("planar pigment_map { [0 rgb 0] [1 granite scale 3] }"),
            "{planar: {map: [[0, [0, 0, 0]], [1, {granite: {map: [[0, [0, 0, 0]], [1, [1, 1, 1]]], "
            "noise_generator: povray_2, transform: "
            "{scale: 3}}}]]}}");
  EXPECT_EQ(color("average pigment_map { [1 rgb 1] [3 rgb x] }"),
            "{over: {color: [0.75, 0, 0], filter: 1, under: [0.25, 0.25, 0.25]}}");
  EXPECT_EQ(color("average pigment_map { [1 rgb 1] [1 planar] } scale 3"),
            "{over: {color: {planar: {map: [[0, [0, 0, 0]], [1, [1, 1, 1]]]}, gain: 0.5}, filter: 1, under: "
            "[0.5, 0.5, 0.5], transform: {scale: 3}}}");
  EXPECT_EQ(color("radial"),
            "{angular: {map: [[0, [0, 1, 1]], [0.333, [1, 1, 0]], [0.666, [1, 0, 1]], [1, [0, 1, 1]]]}}");
  EXPECT_EQ(color("magnet 2 mandel 30 color_map { [0 rgb 0] [1 rgb 1] }"),
            "{fractal: {iterations: 30, formula: magnet2, map: [[0, [0, 0, 0]], [1, [1, 1, 1]]]}}");
  EXPECT_EQ(
      color("julia <0.25, -0.5>, 20 exponent 3 interior 1, 2"),
      "{fractal: {set: julia, real: 0.25, imaginary: -0.5, iterations: 20, power: 3, interior: least_size, "
      "interior_factor: 2, map: [[0, [0, 0, 0]], [1, [1, 1, 1]]]}}");
  EXPECT_EQ(color("function { x + 0.5 } color_map { [0 rgb 0] [1 rgb x] }"),
            "{function: {f: \"(x + 0.5)\", map: [[0, [0, 0, 0]], [1, [1, 0, 0]]]}}");
  // Out of order, as POV-Ray shows it.
  EXPECT_EQ(color("planar color_map { [0.5 rgb 1] [0 rgb 0] [1 rgb 0.25] }"),
            "{planar: {map: [[0.5, [1, 1, 1]], [0.5, [0.125, 0.125, 0.125]], [1, [0.25, 0.25, 0.25]]]}}");
  // Places outside of 0 to 1 show what lies between them.
  EXPECT_EQ(color("boxed color_map { [-1 rgb 0] [1 rgb 1] }"),
            "{boxed: {map: [[0, [0.5, 0.5, 0.5]], [1, [1, 1, 1]]]}}");
}

// The colours at the middles of cells around the origin, as POV-Ray 3.7.0.10 has them.
TEST(PovScene, SquaresAndTrianglesHaveTheirOrder) {
  const PovFiles files;
  struct Shown {
    const char* pattern;
    double x, z;
    int number;
  };
  const Shown shown[] = {
      {"square", 0.5, 0.5, 0},        {"square", 0.5, 1.5, 1},        {"square", 1.5, 1.5, 2},
      {"square", 1.5, 0.5, 3},        {"square", -0.5, -0.5, 2},      {"square", -1.5, -1.5, 0},
      {"triangular", 0.5, 0.2, 0},    {"triangular", 0.01, 0.6, 1},   {"triangular", -0.5, 0.2, 2},
      {"triangular", -0.5, -0.2, 3},  {"triangular", 0.01, -0.6, 4},  {"triangular", 0.5, -0.2, 5},
      {"triangular", 1.5, 0.2, 4},    {"triangular", 1.01, 0.6, 3},   {"triangular", -1.01, 0.6, 5},
      {"triangular", -1.01, -0.3, 0}, {"triangular", 1.51, -0.05, 1},
  };
  std::string text = "#version 3.7;\n";
  for (const Shown& s : shown)
    text += fmt::format(
        "#declare F = function {{ pigment {{ {} rgb 0 rgb 0.1 rgb 0.2 rgb 0.3 rgb 0.4 rgb 0.5 }} }} "
        "sphere {{ <F({}, 0.3, {}).red, 0, 0>, 1 }}\n",
        s.pattern, s.x, s.z);
  const Scene scene = load_scene(files.dir.write("cells.pov", text));
  ASSERT_EQ(scene.objects.size(), std::size(shown));
  for (std::size_t i = 0; i < std::size(shown); ++i)
    EXPECT_NEAR(std::get<SphereShape>(scene.objects[i].shape).center.x, 0.1 * shown[i].number, 1e-6)
        << shown[i].pattern << " " << shown[i].x << " " << shown[i].z;
}

TEST(PovScene, TexturesInPatternsAndLayers) {
  const PovFiles files;
  const auto material = [&](const std::string& texture) {
    return files.section("#version 3.7;\nsphere { 0, 1 " + texture + " }", "materials");
  };
  // What differs is in the pattern, what does not is not.
  EXPECT_EQ(
      material("texture { gradient x texture_map { [0 pigment { rgb 0 } finish { diffuse 0.5 }] [1 pigment { "
               "rgb x } finish { diffuse 1 }] } scale 2 }"),
      "{material: {color: {linear: {direction: [1, 0, 0], map: [[0, [0, 0, 0]], [1, [1, 0, 0]]], transform: "
      "{scale: 2}}}, ambient: 0.1, diffuse: {linear: {direction: [1, 0, 0], map: [[0, 0.5], [1, 1]], "
      "transform: "
      "{scale: 2}}}}}");
  // A layer that lets half pass, over another.
  EXPECT_EQ(
      material("texture { pigment { rgb 1 } } texture { pigment { rgbt <1, 0, 0, 0.5> } }"),
      "{material: {color: {over: {color: [0.5, 0, 0], filter: [0.5, 0.5, 0.5], under: [1, 1, 1]}}, ambient: "
      "0.1, diffuse: 0.6, transparency: 1, filter: {over: {color: [0, 0, 0], filter: [0.5, 0.5, 0.5], under: "
      "[0, 0, 0]}}, ior: 1}}");
  // What passes differs in a pattern.
  EXPECT_EQ(material("pigment { onion color_map { [0 rgb 1] [1 rgbf 1] } }"),
            "{material: {color: [1, 1, 1], ambient: {onion: {map: [[0, 0.1], [1, 0]]}}, diffuse: {onion: "
            "{map: [[0, 0.6], "
            "[1, 0]]}}, transparency: 1, filter: {onion: {map: [[0, [0, 0, 0]], [1, [1, 1, 1]]]}}, ior: 1}}");
  // A normal: 2/15 of the slope of the pattern, in the size of the pattern.
  EXPECT_EQ(material("pigment { rgb 1 } normal { gradient x 0.75 scale 2 }"),
            "{material: {color: [1, 1, 1], ambient: 0.1, diffuse: 0.6, map_bump: {linear: {direction: [1, 0, "
            "0], noise_generator: povray_2, "
            "transform: {scale: 2}}, gain: 0.2}}}");
  EXPECT_EQ(material("texture { pigment { rgb 1 } scale 2 pigment { checker scale 3 } }"),
            "{material: {color: {checker: {colors: [[0, 0, 1], [0, 1, 0]], transform: [{scale: 2}, {scale: "
            "3}]}}, ambient: 0.1, "
            "diffuse: 0.6}}");
}

TEST(PovScene, MeansOfTexturesAndNormals) {
  const PovFiles files;
  const auto material = [&](const std::string& texture) {
    return files.section("#version 3.7;\nsphere { 0, 1 " + texture + " }", "materials");
  };
  EXPECT_EQ(
      material(
          "texture { average texture_map { [1 pigment { rgb 1 } finish { diffuse 0.5 }] [1 pigment { rgb "
          "x } finish { diffuse 1 }] } }"),
      "{material: {color: {over: {color: [0.5, 0, 0], filter: 1, under: [0.5, 0.5, 0.5]}}, ambient: 0.1, "
      "diffuse: {over: {color: 0.5, filter: 1, under: 0.25}}}}");
  EXPECT_EQ(
      material("pigment { rgb 1 } normal { average normal_map { [1 gradient x 0.75] [1 gradient y 0.75] } }"),
      "{material: {color: [1, 1, 1], ambient: 0.1, diffuse: 0.6, map_bump: {over: {color: {linear: "
      "{direction: [0, 1, 0], noise_generator: povray_2}, gain: 0.05}, filter: 1, under: {linear: "
      "{direction: [1, 0, 0], "
      "noise_generator: povray_2}, gain: 0.05}, noise_generator: povray_2}}}}");
  // What is around normals makes them higher as it makes them wider.
  for (const char* const map : {"average normal_map { [1 gradient y 0.75] }",
                                "gradient x normal_map { [0 gradient y 0.75] [1 gradient y 0.75] }"}) {
    const std::string text = material(std::string("pigment { rgb 1 } normal { ") + map + " scale 2 }");
    EXPECT_NE(text.find("{linear: {direction: [0, 1, 0], noise_generator: povray_2}, gain: 0.2}"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("transform: {scale: 2}"), std::string::npos) << text;
  }
}

TEST(PovScene, SkiesArePatternsOfDirections) {
  const PovFiles files;
  EXPECT_EQ(
      files.section("#version 3.7;\nsky_sphere { pigment { gradient y color_map { [0 rgb 1] [1 rgb z] } } }",
                    "background"),
      "{linear: {direction: [0, 1, 0], map: [[0, [1, 1, 1]], [1, [0, 0, 1]]]}}");
}

TEST(PovScene, CamerasAreFrames) {
  const PovFiles files;
  EXPECT_EQ(files.section("#version 3.7;\nsphere { 0, 1 }", "camera"),
            "{from: [0, 0, 0], frame: {right: [1.33, 0, 0], up: [0, 1, 0], direction: [0, 0, 1]}}");
  EXPECT_EQ(
      files.section("#version 3.7;\ncamera { location -5*z right 2*x up y look_at 0 angle 90 }", "camera"),
      "{from: [0, 0, -5], frame: {right: [2, 0, 0], up: [0, 1, 0], direction: [0, 0, 1.0000000000000002]}}");
}

// As programs of chemistry write cameras.
TEST(PovScene, AnAngleOfZeroIsNone) {
  const PovFiles files;
  const auto camera = [&](const std::string& text) {
    return files.section("#version 3.7;\ncamera { " + text + " }", "camera");
  };
  EXPECT_EQ(camera("location -5*z angle 0 look_at 0"), camera("location -5*z look_at 0"));
  const std::string sized = " right -3*x up 4*y direction 50*z location 100*z look_at 0";
  // With an angle, whichever it is, the picture is as wide as that in perspective at what is looked at.
  EXPECT_EQ(camera("orthographic angle 0" + sized),
            "{projection: orthographic, from: [0, 0, 100], frame: {right: [6, 0, 0], up: [0, 8, 0], "
            "direction: [0, 0, "
            "-50]}}");
  EXPECT_EQ(camera("orthographic" + sized),
            "{projection: orthographic, from: [0, 0, 100], frame: {right: [3, 0, 0], up: [0, 4, 0], "
            "direction: [0, 0, "
            "-50]}}");
  for (const char* angle : {"orthographic angle 180", "angle 180", "angle -1"})
    EXPECT_THROW(camera(angle), Error) << angle;
}

TEST(PovScene, CurvedCamerasKeepTheirVectors) {
  const PovFiles files;
  const auto camera = [&](const std::string& text) {
    return files.section("#version 3.7;\ncamera { " + text + " }", "camera");
  };
  const std::string usual =
      "from: [0, 0, 0], frame: {right: [1.33, 0, 0], up: [0, 1, 0], direction: [0, 0, 1]}}";
  EXPECT_EQ(camera("fisheye"), "{projection: fisheye, angle: 90, " + usual);
  EXPECT_EQ(camera("fisheye angle 200"), "{projection: fisheye, angle: 200, " + usual);
  EXPECT_EQ(camera("ultra_wide_angle angle 0"), "{projection: ultra_wide_angle, angle: 90, " + usual);
  // Whose angles nothing changes.
  EXPECT_EQ(camera("omnimax angle 50"), "{projection: omnimax, " + usual);
  EXPECT_EQ(camera("panoramic angle 50"), "{projection: panoramic, " + usual);
  EXPECT_EQ(camera("cylinder 1 angle 100"), "{projection: cylindrical, angle: 100, axis: up, " + usual);
  EXPECT_EQ(camera("cylinder 2"), "{projection: cylindrical, angle: 90, axis: right, " + usual);
  EXPECT_EQ(camera("cylinder 3"),
            "{projection: cylindrical, angle: 90, axis: up, along_axis: orthographic, " + usual);
  EXPECT_EQ(camera("cylinder 4"),
            "{projection: cylindrical, angle: 90, axis: right, along_axis: orthographic, " + usual);
  EXPECT_EQ(camera("spherical"), "{projection: spherical, angle: [360, 180], " + usual);
  EXPECT_EQ(camera("spherical angle 90"), "{projection: spherical, angle: [90, 45], " + usual);
  EXPECT_EQ(camera("spherical angle 90 60"), "{projection: spherical, angle: [90, 60], " + usual);
  // A spherical picture is not mirrored, but upside down.
  EXPECT_EQ(
      camera("spherical right -x"),
      "{projection: spherical, angle: [360, 180], from: [0, 0, 0], frame: {right: [1, 0, 0], up: [0, -1, "
      "0], direction: [0, 0, 1]}}");
  EXPECT_EQ(files.error("#version 3.7;\ncamera { cylinder 5 }\nsphere { 0, 1 }"),
            "scene.pov:2:10: expected a cylinder from 1 to 4, found 5");
  EXPECT_EQ(
      files.error("#version 3.7;\ncamera { fisheye angle 400 }\nsphere { 0, 1 }"),
      "scene.pov:2:1: a 'fisheye' camera of 400 degrees cannot be shown; expected more than 0, at most 360");
  EXPECT_EQ(files.warnings("#version 3.7;\ncamera { fisheye aperture 1 blur_samples 9 }\nsphere { 0, 1 }"),
            "scene.pov:2:1: warning: all is sharp that a 'fisheye' camera sees\n");
}

TEST(PovScene, LightsHaveTheirShape) {
  const PovFiles files;
  const auto lights = [&](const std::string& text) {
    return files.section("#version 3.7;\nlight_source { <0,5,0>, rgb 1 " + text + " }", "lights");
  };
  EXPECT_EQ(lights("fade_distance 3 fade_power 2"),
            "[{point: {position: [0, 5, 0], color: [1, 1, 1], fade: {distance: 3, power: 2}}}]");
  // One of both alone means nothing.
  EXPECT_EQ(lights("fade_power 2"), "[{point: {position: [0, 5, 0], color: [1, 1, 1]}}]");
  EXPECT_EQ(lights("shadowless"),
            "[{point: {position: [0, 5, 0], color: [1, 1, 1], shadows: false, highlights: false}}]");
  EXPECT_EQ(
      lights("spotlight point_at x tightness 10 fade_distance 3 fade_power 2"),
      "[{spot: {position: [0, 5, 0], at: [1, 0, 0], outer_angle: 45, inner_angle: 30, tightness: 10, color: "
      "[1, 1, 1], fade: {distance: 3, power: 2}}}]");
  // The light ends at the radius, sharply.
  EXPECT_EQ(lights("spotlight point_at x radius 40 falloff 20"),
            "[{spot: {position: [0, 5, 0], at: [1, 0, 0], outer_angle: 40, inner_angle: 40, falloff: false, "
            "color: [1, 1, 1]}}]");
  EXPECT_EQ(lights("area_light 2*x, 4*z, 1, 1"), "[{point: {position: [0, 5, 0], color: [1, 1, 1]}}]");
  // Points at the ends count half.
  EXPECT_EQ(
      lights("area_light 2*x, 4*z, 3, 1"),
      "[{point: {position: [-1, 5, 0], color: [0.25, 0.25, 0.25]}}, {point: {position: [0, 5, 0], color: "
      "[0.5, 0.5, 0.5]}}, {point: {position: [1, 5, 0], color: [0.25, 0.25, 0.25]}}]");
  EXPECT_EQ(
      lights("cylinder point_at 0 radius 2 falloff 3 tightness 1 fade_distance 3 fade_power 2"),
      "[{directional: {direction: [0, -5, 0], from: [0, 5, 0], beam: {outer_radius: 3, inner_radius: 2, "
      "tightness: 1}, color: [1, 1, 1], fade: {distance: 3, power: 2}}}]");
  EXPECT_EQ(lights("cylinder point_at 0"),
            "[{directional: {direction: [0, -5, 0], from: [0, 5, 0], beam: {outer_radius: 1, inner_radius: "
            "0.75}, color: [1, 1, 1]}}]");
  // It points to z unless told otherwise.
  EXPECT_EQ(lights("parallel"),
            "[{directional: {direction: [0, -5, 1], from: [0, 5, 0], color: [1, 1, 1]}}]");
  const std::string round = lights("area_light 2*x, 2*z, 2, 2 circular");
  EXPECT_NE(round.find("position: [0.7071067811865"), std::string::npos) << round;
  EXPECT_EQ(files.warnings("#version 3.7;\nlight_source { <0,5,0>, rgb 1 area_light x, z, 18, 2 }"),
            "scene.pov:2:48: warning: lights have at most 17 points along a side\n");
}

TEST(PovScene, LightsAndSurroundings) {
  const PovFiles files;
  const std::string scene =
      "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 7 ambient_light rgb 2 }\nbackground "
      "{ rgb <0, 0.5, 1> }\n"
      "light_source { <1,2,3>, rgb 1 }\nlight_source { 5*y, rgb 0.5 spotlight point_at 0 radius 10 falloff "
      "20 }\n"
      "light_source { 5*y, rgb 1 parallel point_at x }\n";
  EXPECT_EQ(files.section(scene, "lights"),
            "[{point: {position: [1, 2, 3], color: [1, 1, 1]}}, {spot: {position: [0, 5, 0], at: [0, 0, 0], "
            "outer_angle: 20, inner_angle: 10, falloff: false, color: [0.5, 0.5, 0.5]}}, {directional: "
            "{direction: [1, -5, 0], from: [0, 5, 0], color: [1, 1, 1]}}]");
  EXPECT_EQ(files.section(scene, "background"), "[0, 0.5, 1]");
  EXPECT_EQ(files.section(scene, "ambient_light"), "[2, 2, 2]");
  EXPECT_EQ(files.section(scene, "integrator"), "{kind: whitted, depth: 6, cutoff: 0.00392156862745098}");
}

/// Light that a mirror, one below or above it and the first one again send from a wall to the camera. The
/// levels and the weights at which POV-Ray 3.7 ends were seen by running it.
TEST(PovScene, ReflectionsEndAsInPovRay) {
  const PovFiles files;
  const auto seen = [&](const std::string& settings, double first, double second) {
    Scene scene = load_scene(files.dir.write(
        "scene.pov",
        fmt::format("#version 3.7;\nglobal_settings {{ assumed_gamma 1 {} }}\n"
                    "camera {{ location <0,0,-3> look_at 0 angle 1 }}\n"
                    "plane {{ z, 0 rotate x*-45 finish {{ ambient 0 diffuse 0 reflection {} }} }}\n"
                    "plane {{ y, -5 finish {{ ambient 0 diffuse 0 reflection {} }} }}\n"
                    "plane {{ y, 5 finish {{ ambient 0 diffuse 0 reflection {} }} }}\n"
                    "plane {{ z, -20 pigment {{ rgb 1 }} finish {{ ambient 0.5 diffuse 0 }} }}\n",
                    settings, first, second, second)));
    scene.film.width = scene.film.height = 1, scene.integrator.samples = 1;
    return render(scene, {}).picture.find("R")->values[0];
  };
  const float all = seen("", 1, 1);
  EXPECT_NEAR(all, 0.5, 1e-6);
  EXPECT_EQ(seen("max_trace_level 3", 1, 1), 0);
  EXPECT_EQ(seen("max_trace_level 4", 1, 1), all);
  EXPECT_EQ(seen("", 1, 0.0038), 0);
  EXPECT_NEAR(seen("", 1, 0.0041), 0.5 * 0.0041, 1e-6);
  EXPECT_NEAR(seen("", 0.07, 1), 0.5 * 0.07 * 0.07, 1e-6);
  EXPECT_EQ(seen("", 0.06, 1), 0);
  EXPECT_NEAR(seen("adc_bailout 0", 0.06, 1), 0.5 * 0.06 * 0.06, 1e-6);
}

TEST(PovScene, WhatCannotBeMeantIsToldOnce) {
  const PovFiles files;
  EXPECT_EQ(files.warnings(
                "#version 3.7;\nsphere { 0, 1 normal { facets coords 1 } }\nsphere { x, 1 normal { facets "
                "coords 1 } }\n"
                "intersection { box { -1, 1 } sor { 4 <1, 0> <1, 1> <2, 2> <2, 3> open } }\n"),
            "scene.pov:2:24: warning: 'facets' in 'normal' has no meaning here: surfaces are smooth\n"
            "scene.pov:4:30: warning: in combinations a sor that is 'open' is closed\n");
}

/// Whatever it is, what is cut is open where it was cut.
TEST(PovScene, WhatHasNoInsideIsCut) {
  const PovFiles files;
  const auto hits = [&](const std::string& object, const Vec3f& from) {
    const Scene scene = load_scene(files.dir.write("cut.pov", "#version 3.7;\n" + object));
    const World world = build_world(scene);
    std::vector<Hit> found;
    all_hits(*world.accel, {from, 0, {0, 0, 1}, 100}, found);
    return found.size();
  };
  const Vec3f left{-0.3f, 0.1f, -9}, right{0.3f, 0.1f, -9};
  const std::string wall = "<-1, -1, 0>, <1, -1, 0>, <0, 3, 0>", clip = " clipped_by { plane { x, 0 } }";
  for (const std::string& object :
       {"triangle { " + wall + clip + " }", "disc { 0, z, 1" + clip + " }",
        "polygon { 5, <-1, -1>, <1, -1>, <1, 1>, <-1, 1>, <-1, -1>" + clip + " }",
        "mesh { triangle { " + wall + " } triangle { <5, 5, 5>, <6, 5, 5>, <5, 6, 5> } " + clip + " }",
        "union { triangle { " + wall + " } disc { <5, 0, 0>, z, 1 }" + clip + " }",
        "#declare T = union { triangle { " + wall + " } }\nobject { T" + clip + " }",
        "intersection { triangle { " + wall + " } plane { x, 0 } }",
        "difference { triangle { " + wall + " } plane { -x, 0 } }",
        // Whatever it is taken from is not seen, either.
        "difference { plane { x, 0 } triangle { " + wall + " } }",
        "bicubic_patch { type 1 <-1,-1,0>, <-0.3,-1,0>, <0.3,-1,0>, <1,-1,0> <-1,-0.3,0>, <-0.3,-0.3,0>, "
        "<0.3,-0.3,0>, <1,-0.3,0> <-1,0.3,0>, <-0.3,0.3,0>, <0.3,0.3,0>, <1,0.3,0> <-1,1,0>, <-0.3,1,0>, "
        "<0.3,1,0>, <1,1,0>" +
            clip + " }"}) {
    EXPECT_EQ(hits(object, left), 1u) << object;
    EXPECT_EQ(hits(object, right), 0u) << object;
  }
  // Open tubes stay open, cut at both ends or not.
  EXPECT_EQ(hits("cylinder { -z, z, 1 open clipped_by { plane { z, 0 } } }", left), 0u);
  EXPECT_EQ(hits("cylinder { -x, x, 1 open clipped_by { plane { x, 0 } } }", left), 2u);
  EXPECT_EQ(hits("cylinder { -x, x, 1 open clipped_by { plane { x, 0 } } }", right), 0u);
}

TEST(PovScene, ErrorsHaveTheirPlace) {
  const PovFiles files;
  EXPECT_EQ(files.error("#version 3.7;\nsphere { 0 }"), "scene.pov:2:1: expected the radius in 'sphere'");
  EXPECT_EQ(files.error("#version 3.7;\nquartic { <1, 2> }"),
            "scene.pov:2:1: a polynomial of order 4 has 35 coefficients, found 2");
  EXPECT_EQ(files.error("#version 3.7;\njulia_fractal { }"),
            "scene.pov:2:1: expected a vector of 4 numbers in 'julia_fractal'");
}

/// Both ways show the same bits.
TEST(PovScene, ConvertedScenesShowTheSame) {
  const std::string scene =
      "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location <1, 2, -5> look_at 0 }\n"
      "light_source { <3, 5, -4>, rgb 1 }\nplane { y, -1 pigment { checker rgb 0.2, rgb 0.8 } }\n"
      "difference { sphere { 0, 1 } box { -0.5, <0.5, 2, 0.5> } pigment { rgb <1, 0.2, 0.1> } finish { phong "
      "1 } }\n"
      "mesh { triangle { <-2,-1,0>, <-1,-1,0>, <-1.5,0.3,0.1> } triangle { <-2,-1,0>, <-1,-1,0>, "
      "<-1.5,-0.3,1.1> } pigment { rgb y } }\n"
      "prism { cubic_spline 0, 1, 7, <0.3,0.3>, <0,0>, <0.5,0>, <0.5,0.5>, <0,0.5>, <0,0>, <0.5,0> translate "
      "x pigment { rgb z } }\n";
  const PovFiles files;
  const std::string input = files.dir.write("scene.pov", scene), output = files.dir.file("scene.yaml");
  const PovConversion done = convert_pov(input, output, {});
  EXPECT_EQ(done.meshes.size(), 1u);
  const auto picture = [](const std::string& path) {
    Scene loaded = load_scene(path);
    loaded.film.width = 80, loaded.film.height = 60;
    return render(std::move(loaded), {}).picture;
  };
  const Picture a = picture(input), b = picture(output);
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (const PicturePlane& plane : a.planes) {
    const PicturePlane* const other = b.find(plane.name);
    ASSERT_NE(other, nullptr);
    EXPECT_TRUE(std::ranges::equal(plane.values, other->values)) << plane.name;
  }
}

TEST(PovScene, HeightsOfPalettesAreNumbers) {
  const PovFiles files;
  files.dir.write("a.png", test::PalettePng{}.file());
  EXPECT_NE(
      files.object("#version 3.7;\nheight_field { png \"a.png\" }").find("a.png\", palette: true, size: "),
      std::string::npos);
  // With sides and a bottom only where it is cut.
  const std::string base = ", base: -0.0001}";
  EXPECT_EQ(files.object("#version 3.7;\nheight_field { png \"a.png\" }").find(base), std::string::npos);
  EXPECT_NE(files.object("#version 3.7;\nheight_field { png \"a.png\" smooth }").find("smooth: true"),
            std::string::npos);
  EXPECT_NE(files.object("#version 3.7;\nintersection { height_field { png \"a.png\" } sphere { 0, 1 } }")
                .find(base),
            std::string::npos);
}

TEST(PovScene, WhatIsAskedStandsWhereItWasFound) {
  const PovFiles files;
  EXPECT_EQ(files.object("#version 3.7;\n#declare B = box { -1, 1 } #declare N = <0,0,0>;\n"
                         "#declare P = trace(B, <0.5,9,0.25>, -y, N); sphere { P + N, 0.5 }"),
            "{sphere: {center: [0.5, 2, 0.25], radius: 0.5}}");
}

TEST(PovScene, CombinationsOfNothingAreLeftOut) {
  const PovFiles files;
  EXPECT_EQ(files.warnings("#version 3.7;\nunion { } sphere { 0, 1 }"),
            "scene.pov:2:1: warning: 'union' contains no object, and is left out\n");
}

}  // namespace
}  // namespace oktett::pov_scene_test
