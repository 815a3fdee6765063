// What scenes in POV-Ray's language ask of their own objects while they are read.

#include "io/scene/pov_queries.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/pov/internal_functions.h"
#include "io/pov/read_pov.h"
#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "tests/support/temp_dir.h"

namespace oktett::pov_queries_test {
namespace {

using test::TempDir;

std::string debug_of(const std::string& text, std::uint64_t steps = 0) {
  const TempDir dir;
  PovQueries queries;
  pov::ReadOptions options;
  options.queries = &queries;
  if (steps > 0) options.limits.steps = steps;
  std::string said;
  options.said = [&said](const std::string& more) { said += more; };
  try {
    pov::read_pov(dir.write("a.pov", "#version 3.7;\n" + text), options);
  } catch (const Error& e) {
    return e.what();
  }
  return said;
}

/// What a trace finds: the place, and the normal.
std::string trace(const std::string& object, const std::string& origin, const std::string& direction) {
  return debug_of("#declare O = " + object + "#declare N = <9, 9, 9>; #declare P = trace(O, " + origin +
                  ", " + direction +
                  ", N);\n#macro V(Q) concat(str(Q.x + 0, 0, 3), \",\", str(Q.y + 0, 0, 3), \",\", "
                  "str(Q.z + 0, 0, 3)) #end #debug concat(V(P), \" \", V(N))");
}

std::string inside(const std::string& object, const std::string& point) {
  return debug_of("#declare O = " + object + "#debug str(inside(O, " + point + "), 0, 0)");
}

std::string extent(const std::string& object) {
  return debug_of(
      "#declare O = " + object +
      "#debug concat(vstr(3, min_extent(O), \",\", 0, 3), \" \", vstr(3, max_extent(O), \",\", 0, 3))");
}

/// Without the signs of zeros.
std::string plain(std::string text) {
  for (std::size_t at; (at = text.find("-0.000")) != std::string::npos;) text.erase(at, 1);
  return text;
}

// The values are those of POV-Ray 3.7.0.10.
TEST(PovQueries, TraceFindsTheNearestSurface) {
  const auto traced = [](const std::string& object, const std::string& origin, const std::string& direction) {
    return plain(trace(object, origin, direction));
  };
  EXPECT_EQ(traced("box { -1, 1 }", "<0.5,0.2,-5>", "z*3"), "0.500,0.200,-1.000 0.000,0.000,-1.000");
  EXPECT_EQ(traced("box { -1, 1 }", "0", "z*3"), "0.000,0.000,1.000 0.000,0.000,1.000");
  EXPECT_EQ(traced("difference { box { -1, 1 } sphere { 0, 0.8 } }", "0", "z*3"),
            "0.000,0.000,0.800 0.000,0.000,-1.000");
  EXPECT_EQ(traced("sphere { 0, 1 inverse }", "-4*z", "z*3"), "0.000,0.000,-1.000 0.000,0.000,1.000");
  EXPECT_EQ(traced("sphere { 0, 1 scale <1,2,3> }", "<0.3,0.1,14>", "-z*3"),
            "0.300,0.100,2.858 0.686,0.057,0.726");
  EXPECT_EQ(traced("plane { y, 0 }", "<0,3,-4>", "<0,-1,1>"), "0.000,0.000,-1.000 0.000,1.000,0.000");
  EXPECT_EQ(traced("plane { -y, 0 }", "<0,3,-4>", "<0,-1,1>"), "0.000,0.000,-1.000 0.000,-1.000,0.000");
  EXPECT_EQ(traced("sphere { 0, 1 }", "-4*z", "-z"), "0.000,0.000,0.000 0.000,0.000,0.000");
  // On the surface, the ray goes on to the other side.
  EXPECT_EQ(traced("sphere { 0, 1 }", "-z", "z"), "0.000,0.000,1.000 0.000,0.000,1.000");
  EXPECT_EQ(traced("sphere { 0, 1 }", "-z", "<0,0,0>"), "0.000,0.000,0.000 0.000,0.000,0.000");
}

TEST(PovQueries, TrianglesHaveTheirOwnNormals) {
  EXPECT_EQ(plain(trace("triangle { -x, x, y }", "<0,0.1,-4>", "z*3")),
            "0.000,0.100,0.000 0.000,0.000,-1.000");
  EXPECT_EQ(plain(trace("triangle { -x, x, y }", "<0,0.1,4>", "-z*3")),
            "0.000,0.100,0.000 0.000,0.000,-1.000");
  EXPECT_EQ(plain(trace("mesh { triangle { -x, y, x } }", "<0,0.1,-4>", "z")),
            "0.000,0.100,0.000 0.000,0.000,1.000");
  EXPECT_EQ(
      plain(trace("mesh2 { vertex_vectors { 3, -x, y, x } face_indices { 1, <0,1,2> } }", "<0,0.1,-4>", "z")),
      "0.000,0.100,0.000 0.000,0.000,1.000");
  EXPECT_EQ(plain(trace("mesh { smooth_triangle { -x, <-1,0,-1>, y, <0,1,-1>, x, <1,0,-1> } }", "<0.3,0.1,4>",
                        "-z")),
            "0.300,0.100,0.000 0.286,0.095,-0.953");
}

TEST(PovQueries, PolygonsHaveTheirFrontsOnTheOtherSide) {
  EXPECT_EQ(plain(trace("polygon { 5, <-1,-1>, <1,-1>, <1,1>, <-1,1>, <-1,-1> }", "<0.1,0.2,-4>", "z")),
            "0.100,0.200,0.000 0.000,0.000,1.000");
  EXPECT_EQ(plain(trace("polygon { 5, <-1,-1>, <-1,1>, <1,1>, <1,-1>, <-1,-1> }", "<0.1,0.2,-4>", "z")),
            "0.100,0.200,0.000 0.000,0.000,-1.000");
}

TEST(PovQueries, SurfacesOfAllKindsAreTraced) {
  EXPECT_EQ(plain(trace("isosurface { function { x*x + y*y + z*z - 0.25 } contained_by { box { -1, 1 } } "
                        "max_gradient 4 }",
                        "<0,3,0>", "-y")),
            "0.000,0.500,0.000 0.000,1.000,0.000");
  EXPECT_EQ(plain(trace("torus { 2, 0.5 }", "<2,3,0>", "-y")), "2.000,0.500,0.000 0.000,1.000,0.000");
  EXPECT_EQ(plain(trace("union { sphere { 0, 1 } box { -1, 1 translate 3*y } }", "<0,9,0>", "-y")),
            "0.000,4.000,0.000 0.000,1.000,0.000");
  EXPECT_EQ(
      plain(trace("union { #local B = sphere { 0, 1 } object { B translate x } object { B translate -x } }",
                  "<1,9,0>", "-y")),
      "1.000,1.000,0.000 0.000,1.000,0.000");
}

TEST(PovQueries, LooksDoNotMatter) {
  EXPECT_EQ(plain(trace("sphere { 0, 1 pigment { image_map { png \"nothing.png\" } } normal { bumps 1 } }",
                        "-4*z", "z")),
            "0.000,0.000,-1.000 0.000,0.000,-1.000");
}

TEST(PovQueries, InsideFollowsCombinations) {
  EXPECT_EQ(inside("sphere { 0, 1 }", "0.5*x"), "1");
  EXPECT_EQ(inside("sphere { 0, 1 inverse }", "0.5*x"), "0");
  EXPECT_EQ(inside("sphere { 0, 1 inverse }", "2*x"), "1");
  EXPECT_EQ(inside("plane { y, 0 }", "<0,-9,0>"), "1");
  EXPECT_EQ(inside("difference { sphere { 0, 1 } plane { y, 0 } }", "<0,-0.2,0>"), "0");
  EXPECT_EQ(inside("sphere { 0, 1 clipped_by { plane { y, 0 } } }", "<0,0.2,0>"), "0");
  EXPECT_EQ(inside("sphere { 0, 1 bounded_by { plane { y, 0 } } }", "<0,0.2,0>"), "1");
  EXPECT_EQ(inside("union { sphere { 0, 1 } sphere { 5*x, 1 inverse } }", "<9,0,0>"), "1");
  EXPECT_EQ(inside("union { sphere { 0, 1 } sphere { 5*x, 1 inverse } }", "<5,0,0>"), "0");
  EXPECT_EQ(inside("union { triangle { 0, x, y } sphere { 0, 1 } }", "0.2*z"), "1");
  EXPECT_EQ(inside("torus { 2, 0.5 rotate 90*x }", "<0,2.2,0>"), "1");
  EXPECT_EQ(inside("ovus { 1, 0.5 }", "<0.93,0.4,0>"), "1");
  EXPECT_EQ(inside("ovus { 1, 0.5 }", "<0.94,0.4,0>"), "0");
  EXPECT_NE(inside("triangle { 0, x, y }", "0.2*z").find("'inside' is not available for this object"),
            std::string::npos);
}

TEST(PovQueries, ExtentsAreBoxes) {
  EXPECT_EQ(extent("box { <-1,-2,-3>, <1,2,3> rotate 45*y }"), "-2.828,-2.000,-2.828 2.828,2.000,2.828");
  EXPECT_EQ(
      extent("plane { y, 0 }"),
      "-10000000000.000,-10000000000.000,-10000000000.000 10000000000.000,10000000000.000,10000000000.000");
  EXPECT_EQ(extent("torus { 2, 0.5 }"), "-2.500,-0.500,-2.500 2.500,0.500,2.500");
  EXPECT_EQ(extent("union { sphere { 0, 1 } sphere { 3*x, 0.5 } }"),
            "-1.000,-1.000,-1.000 3.500,1.000,1.000");
  EXPECT_EQ(extent("intersection { sphere { 0, 1 } plane { y, 0.4 } }"),
            "-1.000,-1.000,-1.000 1.000,0.400,1.000");
  // Numbers are exact where the object states them.
  EXPECT_EQ(debug_of("#declare O = box { 0, 1.1 } #if (max_extent(O).x = 1.1) #debug \"same\" #end"), "same");
}

TEST(PovQueries, PatternsHaveValues) {
  EXPECT_EQ(debug_of("#declare F = function { pattern { checker } } "
                     "#debug concat(str(F(0.5, 0.5, 0.5), 0, 1), str(F(1.5, 0.5, 0.5), 0, 1))"),
            "0.01.0");
  EXPECT_EQ(debug_of("#declare F = function { pigment { checker color rgb <1, 0.5, 0.25>, color rgb 0 } } "
                     "#debug vstr(3, F(0.5, 0.5, 0.5), \",\", 0, 2)"),
            "1.00,0.50,0.25");
}

TEST(PovQueries, TurbulenceIsADisplacement) {
  const std::string here = debug_of("#debug vstr(3, vturbulence(2, 0.5, 6, <0.3,0.4,0.5>), \",\", 0, 4)");
  EXPECT_EQ(here, debug_of("#debug vstr(3, vturbulence(2, 0.5, 6, <0.3,0.4,0.5>), \",\", 0, 4)"));
  EXPECT_NE(here, debug_of("#debug vstr(3, vturbulence(2, 0.5, 6, <0.3,0.4,0.7>), \",\", 0, 4)"));
  EXPECT_NE(here, "0.0000,0.0000,0.0000");
}

// POV-Ray 3.7.0.10 gives f_ridge and f_hetero_mf these values where its noise has the values 0.475871267 at
// the place and 0.615169287 at twice the place; the formulas are those that these values show.
TEST(PovQueries, SumsOfNoiseAreThoseOfTheirNoise) {
  constexpr double kHere = 0.475871266933, kFiner = 0.615169286934;
  const auto ridge = [](double here, double finer, double octaves, double omega, double offset, double top) {
    const auto octave = [&](double n) {
      const double far = std::abs(n - top) / std::max(top, 1 - top);
      return (far - offset) / std::max(offset, 1 - offset);
    };
    return octaves < 2 ? octave(here) : (octave(here) + omega * octave(finer)) / (1 + omega);
  };
  EXPECT_NEAR(ridge(kHere, kFiner, 1, 0.5, 0.2, 0.3), 0.06405583381, 1e-9);
  EXPECT_NEAR(ridge(kHere, kFiner, 2, 0.5, 0.5, 0.5), -0.782097662577, 1e-9);
  EXPECT_NEAR(ridge(kHere, kFiner, 2, 0.25, 0.5, 0.5), -0.83065262464, 1e-9);
  const auto hetero = [](double here, double finer, double octaves, double offset, double power) {
    const double first = 2 * here - 1 + offset;
    return octaves < 2 ? first : first + (2 * finer - 1 + offset) / 2 * std::pow(first, power);
  };
  EXPECT_NEAR(hetero(kHere, kFiner, 1, 0.5, 1), 0.451742533867, 1e-9);
  EXPECT_NEAR(hetero(kHere, kFiner, 2, 0.5, 1), 0.616705032837, 1e-9);
  EXPECT_NEAR(hetero(kHere, kFiner, 2, 0.5, 0), 0.816911820801, 1e-9);
  const double p[] = {0.3, 0.4, 0.7};
  const auto value = [](std::uint32_t number, std::vector<double> operands) {
    return pov::internal_value(number, operands).value_or(std::nan(""));
  };
  const double here = value(76, {p[0], p[1], p[2]}), finer = value(76, {2 * p[0], 2 * p[1], 2 * p[2]});
  for (const double octaves : {1.0, 2.0})
    for (const double offset : {0.2, 0.5})
      for (const double part : {0.0, 0.3, 1.0})
        EXPECT_NEAR(value(58, {p[0], p[1], p[2], 2, octaves, 0.5, offset, part, 2}),
                    ridge(here, finer, octaves, 0.5, offset, part), 1e-12);
  for (const double octaves : {1.0, 2.0})
    for (const double power : {0.0, 1.0, 2.0})
      EXPECT_NEAR(value(29, {p[0], p[1], p[2], 1, 2, octaves, 0.5, power, 2}),
                  hetero(here, finer, octaves, 0.5, power), 1e-12);
}

// Values of POV-Ray 3.7.0.10.
TEST(PovQueries, FunctionsOfTheirOwnNumbersHaveValues) {
  struct Case {
    std::uint32_t number;
    std::vector<double> operands;
    double value;
  };
  const std::vector<Case> cases{
      {0, {0.3, -0.45, 0.7, 0.5, 10, 0, 0.25, 35}, 0.06975},
      {0, {0.3, -0.45, 0.7, 0.5, 10, 1, 0.25, 35}, -0.0711916},
      {6, {0.3, -0.45, 0.7, 0.8, 0.7, 0.9, 0.6, 0.8}, -0.1830092},
      {9, {0.3, -0.45, 0.7, 1}, 0.05392112},
      {9, {-0.4, 0.2, 0.7, 0.8}, 0.03668835},
      {9, {-0.4, 0.2, -0.1, 0.8}, 0.3773565},
      {10, {0.3, -0.45, 0.7, 0.4, 1.2, 0.8, 0.1}, -0.4150231},
      {10, {0.3, -0.45, 0.7, 1.7, 0.9, 1.3, 0.2}, -0.3346405},
      {18, {0.3, -0.45, 0.7, 0.6}, 0.001744942},
      {19, {0.3, -0.45, 0.7, 0.3, 1.4, 0.7, 0.25}, -0.9363629},
      {26, {0.3, -0.45, 0.7, 1, 2.6, 0.15, 0.5, 1, 0.7, 30}, 0.9345858},
      {27, {0.3, -0.45, 0.7, 1}, 0.5397114},
      {28, {0.3, -0.45, 0.7, 1}, 0.03480762},
      {32, {0.3, -0.45, 0.7, 0.4, 1.2, 0.8, 0.1}, -0.2861445},
      {32, {0.3, -0.45, 0.7, 1.7, 0.9, 1.3, 0.2}, -0.2155465},
      {40, {0.3, -0.45, 0.7, 0.45, 0.38, 1.2, 0.11, 0.9}, 0.3627179},
      {52, {0.3, -0.45, 0.7, 3, 0.7, 0.2, -0.3, 0.15, 0.1}, 0.3401498},
      {52, {0.3, -0.45, 0.7, 4, -0.5, 0.3, 0.2, 0.1, 0.05}, 0.3157372},
      {53, {0.3, -0.45, 0.7, 1}, 1.184935},
      {62, {0.3, -0.45, 0.7, 0.4, 0.6, 0.9, 1.1, 1.3}, 1.546132},
      {64, {0.3, -0.45, 0.7, 0.4, 0.1, 1.5, 0, 0, 0.8}, 0.3641416},
      {64, {0.3, -0.45, 0.7, 0.9, 0.1, 0.6, 0, 0, 1.6}, 0.6587165},
      {18, {-0.2, 0.6, 0.1, 0.6}, 0.2662329},
      {64, {-0.2, 0.6, 0.1, 0.9, 0.1, 1.6, 0, 0, 1.6}, 0.5403124},
      {27, {-0.2, 0.6, 0.1, 1}, 0.6196152},
      {28, {-0.2, 0.6, 0.1, 1}, 0.1267949},
      {1, {0.3, -0.45, 0.7, -0.3, 0.85, 0, 0, 0}, 0.1690369},
      {1, {0.3, -0.45, 0.7, -0.3, 0.85, 1, 0.25, 35}, 0.1591568},
      {2, {0.3, -0.45, 0.7, -0.3, 0.96, 0, 0, 0}, 0.0747225},
      {2, {0.3, -0.45, 0.7, -0.3, 0.96, 1, 0.25, 35}, 0.0850952},
      {3, {0.3, -0.45, 0.7, -0.3, 1.32, 0, 0, 0}, 0.0165544},
      {3, {0.3, -0.45, 0.7, -0.3, 1.32, 1, 0.25, 35}, 0.0337442},
      {4, {0.3, -0.45, 0.7, 0.48, 0.5}, -0.038988},
      {5, {0.3, -0.45, 0.7, 0.55, 0.31}, -0.3812689},
      {7, {0.3, -0.45, 0.7, 0.51, 0.58, 0.68, 0.26}, -0.6154951},
      {8, {0.3, -0.45, 0.7, -0.001, 0.5}, 0.0276924},
      {11, {0.3, -0.45, 0.7, 0.38}, 0.187758},
      {12, {0.3, -0.45, 0.7, 0.25}, 0.1454688},
      {13, {0.3, -0.45, 0.7, 0.69}, -0.0681591},
      {14, {0.3, -0.45, 0.7, 0.62}, -0.1944436},
      {15, {0.3, -0.45, 0.7, -0.3, 0.44, 1.38, 0, 0, 0}, 0.1005932},
      {15, {0.3, -0.45, 0.7, -0.3, 0.44, 1.38, 1, 0.25, 35}, 0.0396699},
      {16, {0.3, -0.45, 0.7, -0.1, 0.3, 0.2, 0.4, 0, 0.9}, 0.0274407},
      {17, {0.3, -0.45, 0.7, 0.78, 0.59, 0.57}, 0.533336},
      {20, {0.3, -0.45, 0.7, 0.29, 0.21, 0.52}, 0.2212178},
      {21, {0.3, -0.45, 0.7, -0.3, 0.46, 0.59, 0, 0, 0}, 0.0808988},
      {21, {0.3, -0.45, 0.7, -0.3, 0.46, 0.59, 1, 0.25, 35}, 0.2189925},
      {22, {0.3, -0.45, 0.7, 0.35}, -0.2405323},
      {23, {0.3, -0.45, 0.7, 0.22}, 0.0164158},
      {24, {1.2, 0.3, 0.5, 1, 3, 1, 0.4, 0.1, 0.2, 0.3, 2, 0.5, 0.3}, 0.8959795},
      {24, {-0.7, 0.25, 0.6, 0.8, 5, 2, 0.3, -0.2, 0.15, 0.1, 3, 1, 0}, 0.6463138},
      {24, {0.1, 0.9, -0.2, 0.5, 2, 0, 0.2, 0, 0.3, 0.4, 1, 0.2, 1.5}, 0.4236068},
      {24, {0.9, -0.1, -0.5, 1, 0, 0, 0.5, 0.05, 0.25, 0.5, 1, 1, 1}, -0.143582},
      {25, {0.3, -0.45, 0.7, 2, 5, 0.2, 0.8, 1.5, 0.7, 30}, -0.1300804},
      {30, {0.3, -0.45, 0.7, 0.48}, 10},
      {31, {0.3, -0.45, 0.7, 0.46, 0.71, 0.51}, -0.3720122},
      {33, {0.3, -0.45, 0.7, 0.58, 0.5, 0.6}, -0.4046567},
      {34, {0.3, -0.45, 0.7, -0.3, 0.86, 0.68, 0, 0, 0}, 0.0669275},
      {34, {0.3, -0.45, 0.7, -0.3, 0.86, 0.68, 1, 0.25, 35}, 0.0097265},
      {35, {0.3, -0.45, 0.7, 0.8}, -4.9226092},
      {36, {0.3, -0.45, 0.7, 0.8}, -0.276125},
      {37, {0.3, -0.45, 0.7, -0.1, 0.3, -0.5, 0.7}, -0.0622969},
      {38, {0.3, -0.45, 0.7, 0.7}, -0.42742},
      {39, {0.3, -0.45, 0.7, -0.3, 1.11, 0.72, 0, 0, 0}, 0.0447643},
      {39, {0.3, -0.45, 0.7, -0.3, 1.11, 0.72, 1, 0.25, 35}, -0.053469},
      {41, {0.3, -0.45, 0.7, 0.34}, -0.0746066},
      {42, {0.3, -0.45, 0.7, 0.37}, -0.7924937},
      {43, {0.3, -0.45, 0.7, 0.24}, -0.0237075},
      {44, {0.3, -0.45, 0.7, 0.66, 0.44, 0.71, 0.43}, -0.2642557},
      {45, {0.3, -0.45, 0.7, 0.77}, -0.7931},
      {46, {0.3, -0.45, 0.7, 0.71, 0.2, 0.33}, -0.1758529},
      {47, {0.3, -0.45, 0.7}, 2.1044822},
      {48, {0.3, -0.45, 0.7, 0.75}, -0.3699703},
      {49, {0.3, -0.45, 0.7, 0.48}, 0.323328},
      {50, {0.3, -0.45, 0.7, -0.3, 1.38, 0.8, 0.47, 0, 0, 0}, 0.0578514},
      {50, {0.3, -0.45, 0.7, -0.3, 1.38, 0.8, 0.47, 1, 0.25, 35}, -0.0378499},
      {51, {0.3, -0.45, 0.7, 0.58, 0.67, 0.36, 0.25, 0.4}, 0.4165561},
      {54, {0.3, -0.45, 0.7, 0.78}, -0.544596},
      {55, {0.3, -0.45, 0.7, 0.65}, -0.1417},
      {56, {0.3, -0.45, 0.7, 0.27, 0.35, 0.26}, -0.0400618},
      {57, {0.3, -0.45, 0.7}, 0.8845903},
      {60, {0.3, -0.45, 0.7, 0.24, 0.68, 0.31, 0.54}, 0.3117236},
      {61, {0.3, -0.45, 0.7, 0.47}, 0.4145903},
      {63, {0.3, -0.45, 0.7, 0.31, 0.64, 0.28, 0.59}, -0.6619804},
      {65, {0.3, -0.45, 0.7, 0.27}, -0.0181035},
      {66, {0.3, -0.45, 0.7, 0.45, 0.33, 0.36, 0.78}, -0.0031742},
      {67, {0.3, -0.45, 0.7, -0.3, 1.2, 0.7, 1.28, 0, 0, 0}, -0.0420552},
      {67, {0.3, -0.45, 0.7, -0.3, 1.2, 0.7, 1.28, 1, 0.25, 35}, -0.4230571},
      {68, {0.3, -0.45, 0.7, 0.33, 0.44}, 0.2791466},
      {69, {0.3, -0.45, 0.7}, 0.4048918},
      {70, {0.3, -0.45, 0.7, 0.71, 0.59}, -0.1370538},
      {71, {0.3, -0.45, 0.7, 0.26, 0.79, 0.33}, -0.0613895},
      {72, {0.3, -0.45, 0.7, 0.35}, -1.5260525},
      {73, {0.3, -0.45, 0.7, 0.66}, -0.20493},
      {74, {0.3, -0.45, 0.7, 0.4, 0.38}, 0.3248},
      {75, {0.3, -0.45, 0.7, -0.3, 0.47, 0.49, 0, 0, 0}, -0.1889715},
      {75, {0.3, -0.45, 0.7, -0.3, 0.47, 0.49, 1, 0.25, 35}, -0.1623265},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.number);
    const std::optional<double> value = pov::internal_value(c.number, c.operands);
    ASSERT_TRUE(value);
    EXPECT_NEAR(*value, c.value, 2e-6 * std::max(1.0, std::abs(c.value)));
  }
  EXPECT_FALSE(pov::internal_value(61, std::vector<double>{1, 2}));
  EXPECT_FALSE(pov::internal_value(24, std::vector<double>(12, 0.5)));
  EXPECT_FALSE(pov::internal_value(4'000'000'000, std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(debug_of("#declare F = function { internal(17) } #debug str(F(1, 2, 3, 1, 1, 1), 0, 4)"),
            "3.7417");
}

TEST(PovQueries, ObjectsThatAreAskedHaveALimit) {
  // Each declaration doubles the one before.
  std::string text = "#declare A = union { sphere { 0, 1 } sphere { x, 1 } }";
  for (int i = 0; i < 40; ++i) text += "#declare A = union { object { A } object { A translate x } }\n";
  const std::string answer = debug_of(text + "#debug str(inside(A, 0), 0, 0)");
  EXPECT_TRUE(answer == "1" || answer.find("a.pov:") != std::string::npos) << answer;
  // Each question counts as steps, and the first one more.
  EXPECT_NE(
      debug_of(
          "#declare A = sphere { 0, 1 } #declare I = 0; #while (I < 1000) #declare B = trace(A, -4*z, z); "
          "#declare I = I + 1; #end",
          5000)
          .find("more than 5000 steps"),
      std::string::npos);
}

TEST(PovQueries, FilesAreOpenedWhereAFolderIsNamed) {
  const TempDir dir;
  const std::string path = dir.write("a.pov",
                                     "#fopen F \"out.txt\" write #write (F, \"1, \") #fclose F "
                                     "#fopen F \"out.txt\" read #read (F, A) sphere { 0, A }");
  PovOptions options;
  EXPECT_THROW(read_pov_tree(path, {}, options), Error);
  options.files = dir.path().string();
  read_pov_tree(path, {}, options);
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "out.txt"));
}

}  // namespace
}  // namespace oktett::pov_queries_test
