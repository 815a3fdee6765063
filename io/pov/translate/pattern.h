#pragma once
/// \file Patterns: what pigments, normals and textures have in common. Within io/ only.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// POV-Ray's u and v of a shape: each is `scale` times Oktett's plus `first`, and u begins again at 1.
struct UvLayout {
  std::array<double, 2> scale{1, 1}, first{0, 0};
  bool operator==(const UvLayout&) const = default;
};

/// A pattern with what displaces places in it and what becomes of its values.
struct PovPattern {
  std::string_view word;  ///< that of the language; empty: there is none
  Place where;
  std::string_view key;  ///< the pattern of scene files that means it; empty: there is none
  Node own = nullptr;    ///< a map of the pattern's own keys
  Node image = nullptr;  ///< of an image, its texture by uv
  bool is_list = false;  ///< it has a list of colours in place of a map
  bool uses_uv = false;
  UvLayout uv;
  bool once = false;         ///< of an image: it is not repeated
  bool has_alpha = false;    ///< of an image: light passes somewhere
  bool is_around = false;    ///< of an image: it lies around the y axis
  bool is_ring = false;      ///< and around a ring
  Vec3d direction{0, 1, 0};  ///< of a gradient

  /// Transforms, and warps as items of scene files, in the order in which they are applied to the pattern.
  std::vector<std::variant<Moves, Node>> modifiers;
  Vec3d turbulence{0, 0, 0};
  double octaves = 6, lambda = 2, omega = 0.5;
  std::string_view wave;  ///< empty: the pattern's own
  double exponent = 1, frequency = 1, phase = 0;
  std::optional<NoiseGenerator> noise_generator;  ///< that of the scene if there is none
  bool has_generator = false;                     ///< is written out, also where nothing is random

  bool is_none() const { return word.empty(); }
  bool is_moved() const { return !modifiers.empty() || !(turbulence == Vec3d{0, 0, 0}); }
  void move(const Moves& moves);
};

/// The colours that the pattern has if none are given; `is_list` patterns only.
std::vector<PovColor> default_colors(const PovPattern& pattern);

/// The number of the colour that a pattern with a list of colours shows at the place p, as an expression.
/// Empty if it has no formula.
std::string number_formula(std::string_view pattern, const std::array<std::string, 3>& p);

/// Reads patterns.
class PatternReader {
 public:
  /// The texture that a pigment within a pattern means; null if it has none.
  using PigmentTexture = std::function<Node(const Block&)>;

  PatternReader(Context& context, PigmentTexture pigment_texture)
      : context_(context), pigment_texture_(std::move(pigment_texture)) {}

  /// Takes what stands next if it is a pattern or changes one. Returns whether it is.
  bool take(Arguments& arguments, PovPattern& pattern);
  /// Takes what an `image_map` and the like says.
  void take_image(const Block& block, PovPattern& pattern);

 private:
  /// Null also where one colour stands for the pigment.
  Node texture_of(const Block& pigment);
  bool take_pattern(Arguments& a, PovPattern& p);
  bool take_function(Arguments& a, PovPattern& p);
  bool take_block(Arguments& a, PovPattern& p);
  void take_own_keys(Arguments& a, PovPattern& p);
  void take_fractal(Arguments& a, PovPattern& p);
  void take_slope(Arguments& a, PovPattern& p);
  void take_density(Arguments& a, PovPattern& p);
  void take_object(const Block& block, PovPattern& p);
  bool take_modifier(Arguments& a, PovPattern& p);
  bool take_later_key(Arguments& a, PovPattern& p);
  Node warp(const Block& block);
  void put(PovPattern& p, std::string_view key, double value);
  void put_vector(PovPattern& p, std::string_view key, const Vec3d& value);
  void set(Node map, std::string_view key, Node value);

  Context& context_;
  PigmentTexture pigment_texture_;
};

}  // namespace oktett::pov
