#pragma once
/// \file Patterns as textures of scene files. Within io/ only.

#include <string_view>

#include "io/pov/translate/pattern.h"

namespace oktett::pov {

/// The value of `noise_generator` that means a noise of POV-Ray's.
std::string_view generator_name(NoiseGenerator generator);

/// The value of `turbulence`.
Node turbulence_node(Tree& tree, const Place& where, const PovPattern& pattern);

/// Adds an entry [at, value] to the `map` of a pattern.
void push_entry(Tree& tree, const Place& where, Node map, double at, Node value);

/// Adds the key `noise_generator` of a pattern that has to do with random numbers, or is to bend surfaces as
/// in POV-Ray.
void put_generator(Context& context, const PovPattern& pattern, Node keys);

/// The keys of a pattern `over`.
Node over_keys(Tree& tree, const Place& where, Node color, Node filter, Node under);
/// `color`, and `under` as far as `filter` lets it through; each a colour, a number or a texture.
Node over_node(Tree& tree, const Place& where, Node color, Node filter, Node under);

/// The texture of a pattern whose values show `values`: the list `colors` of list patterns, else `map`. Null:
/// its values are numbers.
Node pattern_node(Context& context, const PovPattern& pattern, Node values);

/// The alpha of an image as greys.
PovPattern alpha_of(Tree& tree, const PovPattern& image);

/// An image that is not repeated, as it repeats at places on the image.
PovPattern repeated_image(const PovPattern& once);
/// What it shows: `inside` on its unit square, `outside` beyond.
Node once_node(Context& context, const PovPattern& pattern, Node inside, Node outside);

/// How many times longer a length is in space than in the pattern, in the mean over all directions.
double scale_of(const PovPattern& pattern);

}  // namespace oktett::pov
