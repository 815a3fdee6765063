// Functions of POV-Ray's language as expressions of scene files.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/io/pov_files.h"

namespace oktett::pov_functions_test {
namespace {

using test::PovFiles;

/// As the macro of POV-Ray's includes that corrects the gamma of pigments makes them.
TEST(PovFunctions, FunctionsOfPigments) {
  const PovFiles files;
  const std::string text = files.section(
      "#version 3.7;\n#declare F = function { pigment { gradient x color_map { [0 rgb 0] [1 rgb x] } } }\n"
      "sphere { 0, 1 pigment { function { pow(F(x,y,z).x, 2) } color_map { [0 rgb 0] [1 rgb y] } } }",
      "materials");
  EXPECT_NE(
      text.find("{function: {f: \"pow(x, 2)\", of: {linear: {direction: [1, 0, 0], map: [[0, [0, 0, 0]], [1, "
                "[1, 0, 0]]]}}, map: [[0, [0, 0, 0]], [1, [0, 1, 0]]]}}"),
      std::string::npos)
      << text;
}

/// One colour, where a texture is needed, leaves the function out.
TEST(PovFunctions, FunctionsOfPigmentsThatAreNotRead) {
  const PovFiles files;
  const std::string scene =
      "#version 3.7;\n#declare S = function { pattern { agate } }\n"
      "#declare F = function { pigment { function { S(x,y,z) } } }\n"
      "sphere { 0, 1 pigment { function { F(x,y,z).x } } }";
  EXPECT_EQ(files.error(scene), "no error");
  EXPECT_EQ(files.section(scene, "materials"),
            "{material: {color: [0.5, 0.5, 0.5], ambient: 0.1, diffuse: 0.6}}");
}

TEST(PovFunctions, FunctionsOfFunctionsIncAreFormulas) {
  const PovFiles files;
  const std::string end = " contained_by { box { -1, 1 } } }";
  const auto text = [&](const std::string& declared, const std::string& function) {
    return files.object("#version 3.7;\n" + declared + "isosurface { function { " + function + " }" + end);
  };
  EXPECT_NE(
      text("#declare F = function { internal(17) } ", "F(x, y, z, 1, 2, 3) - 1").find("sqrt(((1) * (x))^2"),
      std::string::npos);
  // A curve that is turned about the y axis, and the same as it is.
  EXPECT_NE(
      text("#declare F = function { internal(15) } ", "F(x, y, z, -1, 0.25, 0.3, 1, 0, 0)").find("hypot"),
      std::string::npos);
  EXPECT_EQ(
      text("#declare F = function { internal(15) } ", "F(x, y, z, -1, 0.25, 0.3, 0, 0, 0)").find("hypot"),
      std::string::npos);
  EXPECT_NE(text("#declare F = function { transform { translate <1, 2, 3> } } ", "F(x, y, z).y")
                .find("(2 + 1 * y)"),
            std::string::npos);
  const std::string torn = "isosurface { function { F(x, y, z) } contained_by { box { -1, 1 } } } ";
  EXPECT_EQ(files.warnings("#version 3.7;\n#declare F = function { internal(6) } " + torn + torn),
            "scene.pov:2:39: warning: this function contains a function of functions.inc that has no formula "
            "here (internal(6)), which expressions here do not have; it is left out\n");
}

TEST(PovFunctions, NoiseInFunctions) {
  const PovFiles files;
  const auto text = [&](const std::string& declared, const std::string& function) {
    const std::string found =
        files.object("#version 3.7;\n#declare F = function { " + declared + " } isosurface { function { " +
                     function + " } contained_by { box { -1, 1 } } }");
    const std::string before = "{implicit: {function: \"", after = "\", bounds: ";
    const std::size_t end = found.find(after);
    return found.starts_with(before) && end != std::string::npos
               ? found.substr(before.size(), end - before.size())
               : "no function: " + found;
  };
  EXPECT_EQ(text("internal(76)", "F(2*x, y, z)"),
            "(max(0, min(1, 0.48985582 * (1.05242 + povray_noise(((2 * x)), (y), (z))))))");
  EXPECT_EQ(text("internal(78)", "F(x, y, z, 1)"), "(max(0, min(1, 0.5 + povray_noise((x), (y), (z)))))");
  EXPECT_EQ(text("internal(78)", "F(x, y, z, 3)"), "(0.5 + 0.5 * noise((x), (y), (z)))");
  EXPECT_EQ(text("pattern { bozo scale <7, 1, 2> translate y }", "F(x, y, z)"),
            "(max(0, min(1, 0.48985582 * (1.05242 + povray_noise(((0.14285714285714285 * x)), ((y + (-1))), "
            "((0.5 * z)))))))");
  EXPECT_EQ(text("pattern { planar rotate 90*z }", "F(x, y, z) - 0.5").substr(0, 16), "(max(0, 1 - abs(");

  // The values are those of the pattern, and those of a ridged multifractal.
  const Scene scene = load_scene(files.dir.write(
      "values.pov",
      "#version 3.7;\n#declare F = function { internal(59) } #declare G = function { pattern { granite scale "
      "3 } }"
      " #declare N = function { internal(76) } #declare W = function { pattern { wrinkles } }"
      " isosurface { function { F(x, y, z, 0.7, 2.1, 2, 0.9, 1.3, 2) } contained_by { box { -9, 9 } } }"
      " isosurface { function { G(x, y, z) } contained_by { box { -9, 9 } } }"
      " isosurface { function { W(x, y, z) } contained_by { box { -9, 9 } } }"
      " sphere { <F(0.3, 0.4, 0.7, 0.7, 2.1, 2, 0.9, 1.3, 2), G(0.3, 0.4, 0.7), W(0.3, 0.4, 0.7)>, 1 }"
      " sphere { <N(0.3, 0.4, 0.7), N(0.63, 0.84, 1.47), 0>, 1 }"));
  ASSERT_EQ(scene.objects.size(), 5u);
  const auto value = [&](std::size_t i) {
    const auto& shape = std::get<ImplicitShape>(std::get<ExactShape>(scene.objects[i].shape).form);
    return value_at(shape.function, 0.3, 0.4, 0.7);
  };
  const auto center = [&](std::size_t i) { return std::get<SphereShape>(scene.objects[i].shape).center; };
  EXPECT_NEAR(value(0), center(3).x, 1e-6);
  EXPECT_NEAR(value(1), center(3).y, 1e-6);
  EXPECT_NEAR(value(2), center(3).z, 1e-6);
  const double first = 0.9 - std::abs(2.0 * center(4).x - 1), second = 0.9 - std::abs(2.0 * center(4).y - 1);
  const double signal = first * first, weight = std::min(1.0, signal * 1.3);
  EXPECT_NEAR(value(0), signal + weight * second * second * std::pow(2.1, -0.7), 1e-6);
}

/// What a function is as an expression at places, and what the language says of it there: the values of
/// splines, and of pigments by the textures that they become.
TEST(PovFunctions, SplinesAndPigmentsInFunctions) {
  const PovFiles files;
  const std::string points =
      " -1, <1, 2, 0>, -0.25, <0.5, -1, 1>, 0, <0, 0, 3>, 0.5, <2, 1, 1>, 0.75, <-1, 1, 1> ";
  const std::string map =
      " color_map { [0 rgb <1, 0, 0.5>] [0.25 rgbt <0, 1, 0.25, 0.5>] [0.25 rgbf <0.5, 0, 0, 1>] "
      "[0.8 rgb 1] [1 rgb <0.25, 0.5, 0.75>] } ";
  struct Asked {
    std::string declared, call;
  };
  std::vector<Asked> cases;
  for (const char* kind : {"linear", "quadratic", "cubic", "natural"})
    for (const char* component : {"x", "y", "z"})
      cases.push_back({std::string("spline { ") + kind + "_spline" + points + "}",
                       std::string("F(Y + 0.2 * X).") + component});
  for (const char* pattern :
       {"planar", "spherical scale 3", "marble", "gradient <1, 2, 0>", "wood scale 0.3", "onion", "radial",
        "cylindrical frequency 3 phase 0.2", "marble scale 0.2 sine_wave",
        "gradient x ramp_wave frequency 2.5", "boxed scallop_wave", "leopard cubic_wave",
        "wood poly_wave 1.5", "gradient y triangle_wave phase -0.7"})
    for (const char* channel : {"red", "green", "blue"})
      cases.push_back(
          {std::string("pigment { ") + pattern + map + "}", std::string("F(X, Y, Z).") + channel});
  cases.push_back({"pigment { checker rgb <1, 0.5, 0>, rgb <0.25, 0, 1> scale 0.4 }", "F(X, Y, Z).red"});
  cases.push_back({"pigment { checker scale 0.4 }", "F(2 * X, Y, Z).green"});
  for (const char* channel : {"red", "green", "blue"}) {
    cases.push_back({"pigment { square scale 0.4 }", std::string("F(X, Y, Z).") + channel});
    cases.push_back({"pigment { triangular scale 0.3 }", std::string("F(X, Y, Z).") + channel});
  }
  cases.push_back({"pigment { rgb <1, 0.5, 0> }", "F(X, Y, Z).green"});
  cases.push_back({"pigment { marble rotate 40*z }", "F(X, Y, Z).gray"});
  cases.push_back({"sum(i, 1, 4, prod(k, 1, i, x + k * y - i)) - prod(i, 2, 1, z)", "F(X, Y, Z)"});
  cases.push_back({"pattern { checker scale 0.3 }", "F(X, Y, Z)"});
  const std::string tiles = "checker rgb <1, 0.5, 0>, rgb <0.25, 0, 1> scale 0.4";
  cases.push_back({"pattern { pigment_pattern { " + tiles + " } rotate 20*y frequency 3 }", "F(X, Y, Z)"});
  for (const char* channel : {"red", "green", "blue"})
    for (const std::string& nested :
         {"average pigment_map { [1 " + tiles + "] [3 rgb <0.5, 1, 0.75>] } translate 0.3*x",
          "planar pigment_map { [0.2 " + tiles + "] [0.4 marble] [0.4 rgb 0.5] [0.7 wood" + map +
              "] } scale 2",
          "checker pigment { " + tiles +
              " } pigment { average pigment_map { [1 onion] [1 rgb x] } } rotate 30*z",
          std::string("boxed pigment_map { [0 planar pigment_map { [0 rgb x] [1 leopard" + map +
                      "] }] [1 rgb y] }")})
      cases.push_back({"pigment { " + nested + " }", std::string("F(X, Y, Z).") + channel});
  std::string text = "#version 3.7;\n";
  const Vec3d places[] = {{0.31, 0.42, 0.73}, {-0.87, 0.13, 0.55}, {0.05, -0.64, -0.21}, {0.9, 0.95, -0.8}};
  const auto filled = [](std::string call, const std::string& x, const std::string& y, const std::string& z) {
    for (const auto& [name, value] : {std::pair{'X', x}, std::pair{'Y', y}, std::pair{'Z', z}})
      for (std::size_t at; (at = call.find(name)) != std::string::npos;) call.replace(at, 1, value);
    return call;
  };
  for (const Asked& c : cases) {
    text += "#declare F = function { " + c.declared + " }\nisosurface { function { " +
            filled(c.call, "x", "y", "z") + " + x * 1e-9 } contained_by { box { -9, 9 } } }\n";
    for (const Vec3d& p : places)
      text += "sphere { <" + filled(c.call, std::to_string(p.x), std::to_string(p.y), std::to_string(p.z)) +
              ", 0, 0>, 1 }\n";
  }
  const Scene scene = load_scene(files.dir.write("values.pov", text));
  constexpr std::size_t kStep = 1 + std::size(places);
  ASSERT_EQ(scene.objects.size(), cases.size() * kStep);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(cases[i].declared + " " + cases[i].call);
    const auto& shape = std::get<ImplicitShape>(std::get<ExactShape>(scene.objects[i * kStep].shape).form);
    for (std::size_t k = 0; k < std::size(places); ++k) {
      const Vec3d& p = places[k];
      const double want = std::get<SphereShape>(scene.objects[i * kStep + 1 + k].shape).center.x;
      EXPECT_NEAR(value_at(shape.function, p.x, p.y, p.z), want, 2e-6);
    }
  }
  // What expressions do not have is left out with its reason.
  const auto warning = [&](const std::string& declared) {
    return files.warnings("#version 3.7;\n#declare F = function { pigment { " + declared +
                          " } }\nisosurface { function { F(x, y, z).red } contained_by { box { -1, 1 } } }");
  };
  EXPECT_NE(warning("agate").find("contains a pattern 'agate', which"), std::string::npos)
      << warning("agate");
  EXPECT_NE(warning("marble turbulence 1").find("a pattern 'marble' with turbulence"), std::string::npos);
  EXPECT_NE(warning("planar pigment_map { [0 agate] [1 rgb 1] }").find("a pattern 'agate', which"),
            std::string::npos);
  EXPECT_NE(warning("average pigment_map { [0 rgb 1] }").find("an average of nothing"), std::string::npos);
}

}  // namespace
}  // namespace oktett::pov_functions_test
