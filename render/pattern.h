#pragma once
/// \file Patterns: textures that are computed from the place in the space of the object, so that they need
/// no uv and fit every surface.

#include <cstdint>
#include <variant>
#include <vector>

#include "core/description.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "render/pattern_kinds.h"
#include "render/warp.h"

namespace oktett {

/// Least and greatest size of what repeats in a pattern.
inline constexpr Range kPatternSize{1e-9, 1e9, false, false, Unit::length};
inline constexpr Range kTurbulence{0, 100};

/// Sums of noise of smaller and smaller details.
struct Turbulence {
  std::uint32_t octaves = 5;
  double roughness = 0.5;

  void describe(auto& p) {
    p.field("octaves", octaves, whole(1, 16),
            "how many sizes of details there are, each half of the one before");
    p.field("roughness", roughness, kUnitInterval,
            "how strong details are, relative to those of twice the size");
  }
  bool operator==(const Turbulence&) const = default;
};

/// Cubes of the edge `size` in turn.
struct CheckerPattern {
  double size = 1;

  static constexpr ShapeInfo kShapeInfo{"checker", "cubes of the first and the last colour in turn"};
  void describe(auto& p) { p.field("size", size, kPatternSize, "the edge of a cube"); }
  bool operator==(const CheckerPattern&) const = default;
};

/// Grows from 0 at `from` to 1 at `to`.
struct GradientPattern {
  Vec3d from{0, 0, 0}, to{0, 1, 0};

  static constexpr ShapeInfo kShapeInfo{"gradient", "from the first colour to the last along a line"};
  void describe(auto& p) {
    p.field("from", from, kCoordinate, "where the first colour ends");
    p.field("to", to, kCoordinate, "where the last colour begins");
    p.check(!(from == to), "to", "'from' and 'to' must differ");
  }
  bool operator==(const GradientPattern&) const = default;
};

/// Grows from 0 at the distance `inner` from the centre to 1 at `outer`.
struct RadialPattern {
  Vec3d center{0, 0, 0};
  double inner = 0, outer = 1;

  static constexpr ShapeInfo kShapeInfo{"radial",
                                        "from the first colour to the last by the distance from a point"};
  void describe(auto& p) {
    p.field("center", center, kCoordinate, "the point");
    p.field("inner", inner, kLength, "the distance at which the first colour ends");
    p.field("outer", outer, kLength, "the distance at which the last colour begins");
    p.check(inner < outer, "outer", "'outer' must be greater than 'inner'");
  }
  bool operator==(const RadialPattern&) const = default;
};

/// Clouds.
struct NoisePattern {
  double size = 1;
  Turbulence turbulence{};

  static constexpr ShapeInfo kShapeInfo{"noise", "clouds of all colours"};
  void describe(auto& p) {
    p.field("size", size, kPatternSize, "the greatest details");
    turbulence.describe(p);
  }
  bool operator==(const NoisePattern&) const = default;
};

/// Layers across x, folded by noise.
struct MarblePattern {
  double size = 1;
  double distortion = 1;
  Turbulence turbulence{};

  static constexpr ShapeInfo kShapeInfo{
      "marble", "layers across x, back and forth through the colours, folded by noise"};
  void describe(auto& p) {
    p.field("size", size, kPatternSize, "the distance of two layers");
    p.field("distortion", distortion, kTurbulence, "how far noise moves them, in sizes");
    turbulence.describe(p);
  }
  bool operator==(const MarblePattern&) const = default;
};

/// Rings about the y axis, bent by noise.
struct WoodPattern {
  double size = 0.1;
  double distortion = 0.4;
  Turbulence turbulence{2, 0.4};

  static constexpr ShapeInfo kShapeInfo{
      "wood", "rings about the y axis, each from the first colour to the last, bent by noise"};
  void describe(auto& p) {
    p.field("size", size, kPatternSize, "the width of a ring");
    p.field("distortion", distortion, kTurbulence, "how far noise moves them, in sizes");
    turbulence.describe(p);
  }
  bool operator==(const WoodPattern&) const = default;
};

/// A pattern of any kind. Those of pattern_kinds.h have their place and size by the transform.
using Pattern = std::variant<
    CheckerPattern, GradientPattern, RadialPattern, NoisePattern, MarblePattern, WoodPattern, AgatePattern,
    AngularPattern, BoxedPattern, BrickPattern, BumpsPattern, CellsPattern, CracklePattern, CubicPattern,
    CylindricalPattern, DentsPattern, DoubleSpiralPattern, FractalPattern, FunctionPattern, GranitePattern,
    HexagonPattern, IncidencePattern, LayersPattern, LeopardPattern, LinearPattern, OnionPattern, OverPattern,
    PlanarPattern, ProjectedPattern, QuiltedPattern, RingsPattern, RipplesPattern, SlopePattern,
    SphericalPattern, SpiralPattern, TexturePattern, VoxelPattern, WavesPattern, WrinklesPattern>;

/// What a pattern shows at one of its values.
struct PatternEntry {
  double at = 0;
  Color color{0, 0, 0};
  TextureIndex texture{};  ///< instead of the colour, if it is given
  bool operator==(const PatternEntry&) const = default;
};

/// Most textures of which each is an entry of the one before. A deeper one is black.
inline constexpr unsigned kMostNestedTextures = 16;

/// A pattern with its colours and where it lies.
struct PatternTexture {
  Pattern pattern;
  /// Evenly spaced from 0 to 1, linear in between; at least one.
  std::vector<Color> colors{{0, 0, 0}, {1, 1, 1}};
  Affine to_pattern;  ///< from the object's space to that of the pattern
  /// Instead of `colors`, if there are any: at ascending places, linear in between, constant before the first
  /// and after the last. Of several at one place, the first ends what is before, the last begins what
  /// follows.
  std::vector<PatternEntry> map{};
  Wave wave{};
  PatternTurbulence turbulence{};  ///< nearest to the pattern
  bool by_uv = false;  ///< places are [u, v, 0] of the surface in place of those in the object's space
  std::vector<Warp>
      warps{};  ///< between the turbulence and the transform; the first is nearest to the pattern
  bool operator==(const PatternTexture&) const = default;

  /// Chooses the noise that the pattern, its turbulence and its warps are made of.
  void set_noise_generator(NoiseGenerator generator);
};

/// The textures of a scene, as entries of patterns need them.
class PatternTextures {
 public:
  virtual ~PatternTextures() = default;
  /// The colour of a texture (into Scene::textures) where the object's own place is `position`.
  virtual Color color(std::uint32_t texture, const Vec3d& position) const = 0;
  /// The colour of a texture at these texture coordinates, of an image not filtered.
  virtual Color image(std::uint32_t texture, const Vec2f& uv) const = 0;
  /// pattern_slope of a texture, times its gain, where the object's own place is this position.
  virtual Vec3d slope(std::uint32_t, const Vec3d&) const { return {0, 0, 0}; }
  /// The unit normal of the surface on the side of the viewer, and the unit vector to the viewer, in the
  /// world; zero where there is no surface.
  virtual Vec3d normal() const { return {0, 0, 0}; }
  virtual Vec3d to_viewer() const { return {0, 0, 0}; }
};

/// The value in [0, 1] of the pattern at a point of its own space; 0 where the point is not finite, and for
/// patterns that have colours in place of values.
double pattern_value(const Pattern& pattern, const Vec3d& p);

/// The colour at a point of the object's space. Without `others`, entries that are textures are black.
Color pattern_color(const PatternTexture& texture, const Vec3d& p, const PatternTextures* others = nullptr);

/// The gradient of the first channel of the colour at a point of the object's space, from differences over
/// a thousandth of the smallest detail. Along an axis where the value jumps it is 0. With a noise generator
/// of POV-Ray's it is what POV-Ray bends surfaces by, less the amount: differences to four places 0.02 away
/// in the pattern, turned and scaled with it but not warped; for `bumps`, `dents`, `quilted`, `ripples`,
/// `waves` and `wrinkles` without a map vectors of their own; of entries that are textures a mixture of their
/// slopes.
Vec3d pattern_slope(const PatternTexture& texture, const Vec3d& p, const PatternTextures* others = nullptr);

/// Calls f(index) for each texture that a pattern, which may be const, shows a part of. Indices that are not
/// given are kNoId.
template <class AnyPattern, class F>
void for_each_nested_texture(AnyPattern& pattern, F&& f) {
  for (auto& entry : pattern.map) f(entry.texture.index);
  if (auto* const shown = std::get_if<TexturePattern>(&pattern.pattern)) f(shown->texture.index);
  if (auto* const function = std::get_if<FunctionPattern>(&pattern.pattern)) f(function->texture.index);
  if (auto* const image = std::get_if<ProjectedPattern>(&pattern.pattern)) f(image->texture.index);
  if (auto* const over = std::get_if<OverPattern>(&pattern.pattern))
    f(over->color.texture.index), f(over->filter.texture.index), f(over->under.texture.index);
}

}  // namespace oktett
