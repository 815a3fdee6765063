#pragma once
/// \file Textures of POV-Ray: pigment, normal and finish, in patterns and layers. Within io/ only.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/pov/translate/finish.h"
#include "io/pov/translate/normal.h"
#include "io/pov/translate/pigment.h"

namespace oktett::pov {

struct TextureEntry;

/// What an object looks like.
struct Look {
  Pigment pigment;
  Normal normal;
  Finish finish;
  std::string name;

  /// Instead: textures in a pattern, or layers, the lowest first.
  PovPattern pattern;
  std::vector<TextureEntry> entries;
  std::vector<Look> layers;

  bool is_plain() const { return entries.empty() && layers.empty(); }
  void move(const Moves& moves);
  /// The same of an object's moves, which what lies by uv does not feel.
  void move_in_space(const Moves& moves);
  /// What lies by uv lies by POV-Ray's u and v of a shape.
  void lay(const UvLayout& uv);
};

struct TextureEntry {
  double at = 0;
  Look look;
};

/// Reads a block `texture`, which begins with the default where it stands, or `pigment`, `normal` or `finish`
/// on top of what is known of a look.
void read_look(Context& context, const Block& block, Look& look);

/// Whether a block of this keyword is one of those.
bool is_look(std::string_view keyword);

/// A block of these of an object.
struct LookItem {
  std::shared_ptr<const Block> block;
  std::shared_ptr<const Block>
      default_texture;  ///< of #default where the object stands; null: the program's own
  Affine to_texture;    ///< from the space of the object before its transforms to that of the block
  bool by_uv = false;   ///< the object says `uv_mapping` before it
};

/// What an object's blocks make of it, one after the other: a texture lies over those before it, the others
/// change the uppermost one. Without any it is the default.
Look look_of(Context& context, const std::vector<LookItem>& items,
             const std::shared_ptr<const Block>& default_texture);

/// Calls f(plain look) for each that is shown somewhere.
template <class F>
void for_each_plain(const Look& look, F&& f) {
  if (look.is_plain()) return f(look);
  for (const Look& layer : look.layers) for_each_plain(layer, f);
  for (const TextureEntry& entry : look.entries) for_each_plain(entry.look, f);
}

}  // namespace oktett::pov
