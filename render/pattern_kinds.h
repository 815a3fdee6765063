#pragma once
/// \file Patterns of the kinds of POV-Ray (its user documentation, 3.7, "Patterns"), of the size that they
/// have there. Those of noise have the same kinds of forms at other places.

#include <cstdint>
#include <memory>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/functions/tape_data.h"
#include "render/medium/density_grid.h"

namespace oktett {

/// An index into Scene::textures.
struct TextureIndex {
  std::uint32_t index = 0xffffffff;
  bool operator==(const TextureIndex&) const = default;
};

/// A colour, or another texture.
struct PatternColor {
  Color color{0, 0, 0};
  TextureIndex texture{};  ///< instead of the colour, if it is given
  bool operator==(const PatternColor&) const = default;
};

/// Defines a pattern without parameters.
#define OKTETT_PLAIN_PATTERN(Name, key, meaning)         \
  struct Name {                                          \
    static constexpr ShapeInfo kShapeInfo{key, meaning}; \
    void describe(auto&) {}                              \
    bool operator==(const Name&) const = default;        \
  }

/// Folded bands along z.
struct AgatePattern {
  double folding = 1;

  static constexpr ShapeInfo kShapeInfo{"agate", "bands along z, folded by noise"};
  void describe(auto& p) { p.field("folding", folding, Range{0, 100}, "how far noise moves them"); }
  bool operator==(const AgatePattern&) const = default;
};

/// Grows by 1 with each turn about the y axis.
OKTETT_PLAIN_PATTERN(AngularPattern, "angular", "by the angle about the y axis, once around");
OKTETT_PLAIN_PATTERN(BoxedPattern, "boxed",
                     "from 1 in the middle of the box from -1 to 1 to 0 at its faces and outside");

/// Mortar has the value 0, bricks 1.
struct BrickPattern {
  Vec3d brick{8, 3, 4.5};
  double mortar = 0.5;

  static constexpr ShapeInfo kShapeInfo{"brick", "mortar of the first colour, and bricks of the last"};
  /// Without values in between.
  static constexpr unsigned kValues = 2;
  void describe(auto& p) {
    p.field("brick", brick, kPositiveLength, "the size of a brick with its mortar");
    p.field("mortar", mortar, kLength, "how thick mortar is");
  }
  bool operator==(const BrickPattern&) const = default;
};

/// A value of its own for each cube of edge 1.
struct CellsPattern {
  static constexpr ShapeInfo kShapeInfo{"cells", "cubes of edge 1, each of a random value"};
  static constexpr bool kSteps = true;
  void describe(auto&) {}
  bool operator==(const CellsPattern&) const = default;
};

/// By the distances from random points, one in each cube of edge 1 (Worley 1996).
struct CracklePattern {
  Vec3d form{-1, 1, 0};
  double metric = 2;
  double offset = 0;
  bool solid = false;

  static constexpr ShapeInfo kShapeInfo{
      "crackle", "by the distances from random points, one in each cube of edge 1: 0 between their cells"};
  void describe(auto& p) {
    p.field("form", form, kAnyNumber, "weights of the distances from the nearest, second and third point");
    p.field("metric", metric, Range{0.1, 100}, "the power in the sum that a distance is the root of");
    p.field("offset", offset, kLength, "a distance from all points along an axis of its own");
    p.field("solid", solid, "one random value for each cell instead");
  }
  bool operator==(const CracklePattern&) const = default;
};

/// The value is noise; surfaces are bent by noise of each axis.
OKTETT_PLAIN_PATTERN(BumpsPattern, "bumps", "noise of one size");

/// 0 to 5, by the axis to which a place is nearest.
struct CubicPattern {
  static constexpr ShapeInfo kShapeInfo{
      "cubic", "six pyramids around the origin, towards x, y, z, -x, -y and -z: one colour each"};
  static constexpr unsigned kValues = 6;
  void describe(auto&) {}
  bool operator==(const CubicPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(CylindricalPattern, "cylindrical",
                     "from 1 on the y axis to 0 at the distance 1 and beyond");
OKTETT_PLAIN_PATTERN(DentsPattern, "dents", "few high places of noise");

/// The colouring of the plane by z -> z^n + c, or by the maps of magnetism after Peitgen (1986).
struct FractalPattern {
  enum class Set : std::uint8_t { mandel, julia };
  enum class Formula : std::uint8_t { power, magnet1, magnet2 };
  /// What a value is made of: a constant, how many steps lead out, the last place, or the place nearest to 0.
  enum class Outside : std::uint8_t { constant, steps, real, imaginary, real_square, imaginary_square, size };
  enum class Inside : std::uint8_t {
    constant,
    least_size,
    real,
    imaginary,
    real_square,
    imaginary_square,
    square
  };
  Set set = Set::mandel;
  Formula formula = Formula::power;
  double real = 0, imaginary = 0;
  std::uint32_t power = 2;
  std::uint32_t iterations = 50;
  Outside exterior = Outside::steps;
  double exterior_factor = 1;
  Inside interior = Inside::constant;
  double interior_factor = 1;

  static constexpr ShapeInfo kShapeInfo{"fractal", "Mandelbrot or Julia set in the plane of x and y"};
  void describe(auto& p) {
    p.choice("set", set, {{"mandel", Set::mandel}, {"julia", Set::julia}},
             "whether the place is the constant, or where the orbit begins");
    p.choice("formula", formula,
             {{"power", Formula::power}, {"magnet1", Formula::magnet1}, {"magnet2", Formula::magnet2}},
             "z^power + c, or a map of magnetism");
    p.field("real", real, Range{-1e3, 1e3}, "the constant c of `julia`");
    p.field("imaginary", imaginary, Range{-1e3, 1e3}, "likewise");
    p.field("power", power, whole(2, 33), "of that formula");
    p.field("iterations", iterations, whole(1, 100000), "how many steps are taken at most");
    p.choice("exterior", exterior,
             {{"constant", Outside::constant},
              {"steps", Outside::steps},
              {"real", Outside::real},
              {"imaginary", Outside::imaginary},
              {"real_square", Outside::real_square},
              {"imaginary_square", Outside::imaginary_square},
              {"size", Outside::size}},
             "of places that leave: the part of the steps, or the last z");
    p.field("exterior_factor", exterior_factor, "multiplies it, but for `steps`");
    p.choice("interior", interior,
             {{"constant", Inside::constant},
              {"least_size", Inside::least_size},
              {"real", Inside::real},
              {"imaginary", Inside::imaginary},
              {"real_square", Inside::real_square},
              {"imaginary_square", Inside::imaginary_square},
              {"square", Inside::square}},
             "of places that stay: the size of the z nearest to 0, or the last z");
    p.field("interior_factor", interior_factor, "multiplies it");
  }
  bool operator==(const FractalPattern&) const = default;
};

/// A function of the place, or of the colour of another texture there.
struct FunctionPattern {
  FunctionTape function;
  TextureIndex texture{};

  static constexpr ShapeInfo kShapeInfo{"function", "by the value of a function"};
  void describe(auto& p) {
    p.required("f", function, "the function; 0 where it is not defined");
    p.optional("of", texture, "a texture whose red, green and blue are x, y and z in place of coordinates");
  }
  bool operator==(const FunctionPattern& other) const;
};

OKTETT_PLAIN_PATTERN(GranitePattern, "granite", "fine noise of many sizes");

/// 0, 1 and 2, for hexagons of edge 1 around the y axis and others.
struct HexagonPattern {
  static constexpr ShapeInfo kShapeInfo{"hexagon",
                                        "hexagonal rods of edge 1 along y, of three colours in turn"};
  static constexpr unsigned kValues = 3;
  void describe(auto&) {}
  bool operator==(const HexagonPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(IncidencePattern, "incidence",
                     "by the angle at which a surface is seen: from 1 head-on to 0.5 at grazing angles");

/// The marble of POV-Ray.
struct LayersPattern {
  static constexpr ShapeInfo kShapeInfo{"layers",
                                        "back and forth along x; turbulence moves layers along x alone"};
  static constexpr bool kTriangle = true;
  void describe(auto&) {}
  bool operator==(const LayersPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(LeopardPattern, "leopard", "soft spots in a cubic grid");

/// The gradient of POV-Ray.
struct LinearPattern {
  Vec3d direction{1, 0, 0};

  static constexpr ShapeInfo kShapeInfo{"linear", "along a line from the origin, again in each length of 1"};
  void describe(auto& p) {
    p.field("direction", direction, "of any length but 0");
    p.check(length(direction) > 0, "direction", "the direction must not be zero");
  }
  bool operator==(const LinearPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(OnionPattern, "onion", "spherical shells around the origin of thickness 1");
OKTETT_PLAIN_PATTERN(PlanarPattern, "planar", "from 1 in the plane y = 0 to 0 at the distance 1 and beyond");

/// Cushions.
struct QuiltedPattern {
  double control0 = 1, control1 = 1;

  static constexpr ShapeInfo kShapeInfo{"quilted", "cubes of edge 1 like cushions, lowest in the middle"};
  void describe(auto& p) {
    p.field("control0", control0, Range{-10, 10}, "how steep they are in the middle");
    p.field("control1", control1, Range{-10, 10}, "and between each other");
  }
  bool operator==(const QuiltedPattern&) const = default;
};

/// The wood of POV-Ray.
struct RingsPattern {
  static constexpr ShapeInfo kShapeInfo{"rings", "back and forth in rings about the z axis"};
  static constexpr bool kTriangle = true;
  void describe(auto&) {}
  bool operator==(const RingsPattern&) const = default;
};

/// Waves of equal length from random points at the distance 1 from the origin.
struct RipplesPattern {
  std::uint32_t sources = 10;

  static constexpr ShapeInfo kShapeInfo{"ripples", "the mean of waves of length 1 from random points"};
  void describe(auto& p) { p.field("sources", sources, whole(1, 100), "how many points"); }
  bool operator==(const RipplesPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(SphericalPattern, "spherical", "from 1 at the origin to 0 at the distance 1 and beyond");

/// By the angle between a direction and the normal of the surface, both in the world, and by height.
struct SlopePattern {
  Vec3d direction{0, 1, 0};
  double low = 0, high = 1;
  Vec3d altitude{0, 0, 0};
  double altitude_low = 0, altitude_high = 1;

  static constexpr ShapeInfo kShapeInfo{
      "slope", "by the angle between a direction and the normal, in the world: 1 along it, 0 against it"};
  void describe(auto& p) {
    p.field("direction", direction, kCoordinate, "in the world, of any length but 0");
    p.check(length(direction) > 0, "direction", "the direction must not be zero");
    p.field("low", low, "what becomes 0");
    p.field("high", high, "what becomes 1");
    p.check(low != high, "high", "'low' and 'high' must differ");
    p.field("altitude", altitude, kCoordinate,
            "instead of 0: the mean with the height along it, each weighted by the length of its direction");
    p.field("altitude_low", altitude_low, "the height that counts as 0");
    p.field("altitude_high", altitude_high, "the height that counts as 1");
    p.check(altitude_low != altitude_high, "altitude_high", "'altitude_low' and 'altitude_high' must differ");
  }
  bool operator==(const SlopePattern&) const = default;
};

/// A screw about z.
struct SpiralPattern {
  double arms = 1;

  static constexpr ShapeInfo kShapeInfo{"spiral", "back and forth between the arms of a screw about z"};
  static constexpr bool kTriangle = true;
  void describe(auto& p) { p.field("arms", arms, Range{-1000, 1000}, "how many; a whole number"); }
  bool operator==(const SpiralPattern&) const = default;
};

/// The same crossed by rings.
struct DoubleSpiralPattern {
  double arms = 1;

  static constexpr ShapeInfo kShapeInfo{"double_spiral", "the sum of a `spiral` and of rings about z"};
  static constexpr bool kTriangle = true;
  void describe(auto& p) { p.field("arms", arms, Range{-1000, 1000}, "how many; a whole number"); }
  bool operator==(const DoubleSpiralPattern&) const = default;
};

/// The brightness of another texture, as video weights colours.
struct TexturePattern {
  TextureIndex texture;

  static constexpr ShapeInfo kShapeInfo{"brightness", "by how bright another texture is"};
  void describe(auto& p) { p.required("of", texture, "the texture"); }
  bool operator==(const TexturePattern&) const = default;
};

/// A texture through which another is seen, as colour + filter * under. It has colours in place of values.
struct OverPattern {
  PatternColor color, filter, under;

  static constexpr ShapeInfo kShapeInfo{"over",
                                        "a texture and what is seen through it: color + filter * under"};
  static constexpr bool kShowsColors = true;
  void describe(auto& p) {
    p.required("color", color, "what lies above: a color, number or texture, less what passes through");
    p.required("filter", filter, "the part of what lies below that passes through");
    p.required("under", under, "what lies below");
  }
  bool operator==(const OverPattern&) const = default;
};

/// An image laid on objects without uv: its left lower corner is at uv (0, 0), the right upper one at (1, 1).
struct ProjectedPattern {
  enum class Projection : std::uint8_t { planar, cylindrical, spherical, toroidal };
  TextureIndex texture;
  Projection projection = Projection::planar;

  static constexpr ShapeInfo kShapeInfo{"projected", "an image by the place in space in place of uv"};
  static constexpr bool kShowsColors = true;
  void describe(auto& p) {
    p.required("of", texture, "the image");
    p.choice(
        "onto", projection,
        {{"planar", Projection::planar},
         {"cylindrical", Projection::cylindrical},
         {"spherical", Projection::spherical},
         {"toroidal", Projection::toroidal}},
        "x and y are u and v; or u is the angle about the y axis and v the height, the angle from below, or "
        "the angle around the ring of radius 1");
  }
  bool operator==(const ProjectedPattern&) const = default;
};

/// A file of densities.
struct VoxelFile {
  std::shared_ptr<const DensityGrid>& grid;
};

/// Densities in the cube from 0 to 1, 0 outside.
struct VoxelPattern {
  std::shared_ptr<const DensityGrid> grid{};
  bool smooth = true;

  static constexpr ShapeInfo kShapeInfo{"voxels", "densities of a file in the cube from 0 to 1, 0 outside"};
  void describe(auto& p) {
    p.required("file", VoxelFile{grid}, "a grid of densities, or a DF3 file of POV-Ray");
    p.field("smooth", smooth, "whether it is interpolated between them");
  }
  bool operator==(const VoxelPattern&) const = default;
};

/// Waves of many lengths from random points at the distance 1 from the origin.
struct WavesPattern {
  std::uint32_t sources = 10;

  static constexpr ShapeInfo kShapeInfo{"waves", "the mean of waves of random lengths from random points"};
  void describe(auto& p) { p.field("sources", sources, whole(1, 100), "how many points"); }
  bool operator==(const WavesPattern&) const = default;
};

OKTETT_PLAIN_PATTERN(WrinklesPattern, "wrinkles",
                     "noise of many sizes, each half as strong as the one before");

#undef OKTETT_PLAIN_PATTERN

}  // namespace oktett
