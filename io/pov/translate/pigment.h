#pragma once
/// \file Pigments as textures. Within io/ only.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/pov/translate/pattern.h"

namespace oktett::pov {

struct Pigment;

/// What a pattern shows at one of its values, or in a list: a colour or another pigment.
struct PigmentEntry {
  double at = 0;
  PovColor color;
  std::shared_ptr<const Pigment> pigment;  ///< null: the colour
};

/// What blocks `pigment` say, one after the other.
struct Pigment {
  PovColor solid;
  PovPattern pattern;                       ///< none: one colour
  std::vector<PigmentEntry> entries;        ///< of a map, by ascending places, or of a list
  bool lists_pigments = false;              ///< the entries of a list are pigments, not colours
  bool is_average = false;                  ///< the mean of the entries, whose `at` are weights
  double filter_all = 0, transmit_all = 0;  ///< of an image
  bool is_stated = false;  ///< a block named a colour, a pattern or an image, not only changes
  bool is_black = false;   ///< the colour is what `filter` and `transmit` alone make
  std::string name;
};

/// A map whose places ascend and that shows the same. POV-Ray shows the last entry from its place on. Below
/// it looks for the first place that is not below the value, and blends from the entry before it, wherever
/// that is; so an entry below others shows nothing itself. `entry_at`(place, before, after): one between two.
template <class Entry, class EntryAt>
std::vector<Entry> in_order(const std::vector<Entry>& map, EntryAt&& entry_at) {
  std::vector<Entry> all;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double reached = all.empty() ? map[i].at : all.back().at;
    if (map[i].at < reached) continue;
    if (i > 0 && map[i - 1].at < reached && map[i].at > reached)
      all.push_back(entry_at(reached, map[i - 1], map[i]));
    all.push_back(map[i]);
  }
  if (map.empty() || map.back().at >= all.back().at) return all;
  const double end = map.back().at;
  std::size_t after = 0;
  while (all[after].at <= end) ++after;
  Entry last = entry_at(end, all[after > 0 ? after - 1 : 0], all[after]);
  all.resize(after);
  all.push_back(std::move(last)), all.push_back(map.back());
  return all;
}

/// Reads a pigment on top of what is known of it.
void read_pigment(Context& context, const Block& block, Pigment& pigment);
/// Reads what stands in a block `pigment`, or behind the place in an entry of a map.
void read_pigment(Context& context, Arguments& arguments, Pigment& pigment);

/// What the pattern of a pigment without an image shows: what is given, and what it has without that. Never
/// empty.
std::vector<PigmentEntry> entries_of(const Pigment& pigment);

/// The mean colour of the whole pigment, with what passes through.
PovColor mean_of(const Pigment& pigment);
/// Whether light passes anywhere.
bool is_transparent(const Pigment& pigment);
/// Whether what passes is coloured anywhere.
bool filters(const Pigment& pigment);
/// Whether it has one colour.
bool is_solid(const Pigment& pigment);

/// What of a colour with what passes through is asked for: a colour, or a number in all three channels.
struct ColorPart {
  std::function<Vec3d(const PovColor&)> of;
  bool is_number = false;

  Vec3d operator()(const PovColor& color) const { return of(color); }
};

/// The colours of a pigment as a value of scene files: a colour, or a texture.
Node pigment_node(Context& context, const Place& where, const Pigment& pigment, const ColorPart& part);

/// A value of a material, and how much it counts.
struct WeightedNode {
  double weight;
  Node value;
};
/// The weighted mean of colours, numbers and textures, as textures over each other, moved as `average` is.
/// Null if nothing counts.
Node mean_node(Context& context, const PovPattern& average, const std::vector<WeightedNode>& nodes);

/// The colours of a block `pigment` as a texture or a colour; null if it has one colour.
Node pigment_texture(Context& context, const Block& block);

/// The only value of several that are no textures; null if there are others.
Node only_value(const std::vector<Node>& values);

/// A colour as a value of scene files.
Node color_node(Tree& tree, const Place& where, const Vec3d& rgb);

}  // namespace oktett::pov
