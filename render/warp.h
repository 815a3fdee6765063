#pragma once
/// \file What stands between a place and a pattern there, and between the value of a pattern and its colour:
/// warps, turbulence and waves, with the meaning that they have in scenes of POV-Ray.

#include <cstdint>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/noise_generator.h"
#include "core/transform.h"
#include "core/vec3.h"

namespace oktett {

/// Displaces places by noise: that of octave i has lambda^i times the frequency and omega^i times the weight.
struct PatternTurbulence {
  Vec3d amount{0, 0, 0};  ///< along each axis, where noise is greatest; zeros: none
  std::uint32_t octaves = 6;
  double lambda = 2;
  double omega = 0.5;
  NoiseGenerator generator{};  ///< of the pattern that it is part of

  void describe(auto& p) {
    p.field("octaves", octaves, whole(1, 16), "how many sizes of details there are");
    p.field("lambda", lambda, Range{0.01, 100}, "how much smaller each size is than the one before");
    p.field("omega", omega, Range{0, 10}, "how strong it is, relative to the one before");
  }
  void describe_generator(auto& p) {
    p.choice(
        "noise_generator", generator,
        {{"own", NoiseGenerator::own},
         {"povray_1", NoiseGenerator::povray_1},
         {"povray_2", NoiseGenerator::povray_2},
         {"povray_3", NoiseGenerator::povray_3}},
        "the noise that all of it is made of: Perlin's of 2002, or that of POV-Ray of this number, with its "
        "values");
  }
  bool operator==(const PatternTurbulence&) const = default;
};

/// The place to which turbulence moves a place.
Vec3d displaced(const PatternTurbulence& turbulence, const Vec3d& p);

/// What turbulence adds to the value of some patterns, before it is multiplied by an amount: the sum of
/// noise of its octaves, of mean 1 for omega of 1/2.
double value_turbulence(const PatternTurbulence& turbulence, const Vec3d& p);

/// Repeats the slab between 0 and the width along one of the axes.
struct RepeatWarp {
  Vec3d width{1, 0, 0};  ///< along the axis that is not 0
  Vec3d offset{0, 0, 0};
  Vec3d flip{0, 0, 0};

  static constexpr ShapeInfo kShapeInfo{"repeat", "shows the part of the pattern next to 0 again and again"};
  void describe(auto& p) {
    p.required("width", width, kCoordinate, "how wide it is along one axis; 0 along the two others");
    p.field("offset", offset, kCoordinate, "what each copy is moved by from the one before");
    p.field("flip", flip, "which axes are mirrored in every second copy: 0 or 1 each");
    p.check((width.x != 0) + (width.y != 0) + (width.z != 0) == 1, "width",
            "expected one number that is not 0");
  }
  bool operator==(const RepeatWarp&) const = default;
};

/// Moves what lies in a ball away from its centre, so that the pattern there seems to be drawn into it.
struct BlackHoleWarp {
  Vec3d center{0, 0, 0};
  double radius = 1;
  double strength = 1;
  double falloff = 2;
  bool inverse = false;

  static constexpr ShapeInfo kShapeInfo{"black_hole", "draws the pattern in a ball towards its centre"};
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "of the ball");
    p.field("radius", radius, kPositiveLength, "of the ball");
    p.field("strength", strength, "how strong it is at the centre");
    p.field("falloff", falloff, kNonNegative, "the power of the distance from the border that it grows with");
    p.field("inverse", inverse, "pushes away instead");
  }
  bool operator==(const BlackHoleWarp&) const = default;
};

/// Turbulence among other warps.
struct TurbulenceWarp {
  PatternTurbulence turbulence;

  bool operator==(const TurbulenceWarp&) const = default;
};

/// Lays the plane of the pattern around a figure: x along the equator and y along the height from 0 to 1, z
/// away from it.
struct MappingWarp {
  enum class Figure : std::uint8_t { planar, cylindrical, spherical, toroidal };
  Figure figure = Figure::planar;
  Vec3d orientation{0, 0, 1};  ///< the axis of the pattern that becomes the distance; of unit length
  double distance = 0;         ///< planar: what that axis shows everywhere
  double exponent = 0;         ///< multiplies lengths along the figure by this power of the distance
  double major_radius = 1;     ///< toroidal: of the circle in the middle of the ring

  bool operator==(const MappingWarp&) const = default;
};

/// A map between others.
struct TransformWarp {
  Affine to_pattern;  ///< towards the pattern
  bool operator==(const TransformWarp&) const = default;
};

using Warp = std::variant<RepeatWarp, BlackHoleWarp, TurbulenceWarp, MappingWarp, TransformWarp>;

/// The place in the pattern that a place shows.
Vec3d warped(const Warp& warp, const Vec3d& p);
/// The same of several, the last of which is nearest to the object.
Vec3d warped(const std::vector<Warp>& warps, Vec3d p);

/// What becomes of the value of a pattern between 0 and 1.
enum class WaveShape : std::uint8_t { own, ramp, triangle, sine, scallop, cubic, poly };

/// How values of a pattern repeat.
struct Wave {
  WaveShape shape = WaveShape::own;
  double exponent = 1;
  double frequency = 1;
  double phase = 0;

  void describe(auto& p) {
    p.choice("wave", shape,
             {{"own", WaveShape::own},
              {"ramp", WaveShape::ramp},
              {"triangle", WaveShape::triangle},
              {"sine", WaveShape::sine},
              {"scallop", WaveShape::scallop},
              {"cubic", WaveShape::cubic},
              {"poly", WaveShape::poly}},
             "what becomes of values between 0 and 1");
    p.field("exponent", exponent, Range{1e-3, 1e3}, "of `poly`");
    p.field("frequency", frequency, Range{-1e9, 1e9},
            "multiplies values before they are brought into one period; 0: they are not");
    p.field("phase", phase, Range{-1e9, 1e9}, "is added to them then");
  }
  bool operator==(const Wave&) const = default;
};

/// How many periods lie below a value of a pattern.
double period_of(const Wave& wave, double value);

/// The value in [0, 1] of a wave where a pattern has this value; `own` stands for WaveShape::own. As in
/// POV-Ray, a period is 1.00001 long, so that the 1 itself belongs to the first one.
double waved(const Wave& wave, WaveShape own, double value);

/// Whether the wave jumps where a period ends.
bool jumps(const Wave& wave, WaveShape own);

}  // namespace oktett
