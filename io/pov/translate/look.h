#pragma once
/// \file What objects look like: textures and interiors as materials. Within io/ only.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "io/pov/translate/media.h"
#include "io/pov/translate/texture.h"

namespace oktett::pov {

/// What an object is dressed with, its own or that of a union around it.
struct Dress {
  std::vector<std::shared_ptr<const Block>>
      textures;                                    ///< blocks `texture` or `pigment`, the lowest layer first
  std::vector<std::shared_ptr<const Block>> back;  ///< blocks `interior_texture`; empty: both sides alike
  std::vector<std::shared_ptr<const Block>> finishes;  ///< blocks `finish` and `normal` that stand alone
  std::shared_ptr<const Block> interior;               ///< or null
  std::string_view shape;                              ///< the keyword of what is dressed
  Affine to_texture;  ///< from the space of the object before its transforms to that of the textures

  Affine interior_to_world;  ///< from the space of the interior
  bool hollow = false;       ///< so that media show
  bool solid = true;         ///< else nothing fills it

  bool has_texture() const { return !textures.empty() || !finishes.empty(); }
};

/// Makes materials, each once.
class Wardrobe {
 public:
  explicit Wardrobe(Context& context) : context_(context), media_(context) {}

  /// The name of the material of an object at `where`, as a node.
  Node material(const Dress& dress, const std::shared_ptr<const Block>& default_texture, const Place& where);
  /// What fills the space outside of all solids.
  std::string surrounding(const Interior& interior) { return media_.name(interior, {}, true); }
  /// One that is not seen, for faces that are cut open.
  Node invisible(const Place& where);

 private:
  Look look_of(const Dress& dress, const std::shared_ptr<const Block>& default_texture);
  Node name_node(const Place& where, const std::string& name) { return context_.tree.text(where, name); }

  Context& context_;
  MediaWriter media_;
  std::map<std::string, std::string> names_;  ///< by what the material says
  std::map<std::tuple<std::vector<const Block*>, const Block*, const Block*, std::string_view>, std::string>
      known_;
  std::set<std::string> taken_;
};

/// The pigments of a block `sky_sphere` by the direction, as a value of scene files: a colour or a texture.
/// Null if it has none.
Node sky_node(Context& context, const Block& block);

}  // namespace oktett::pov
