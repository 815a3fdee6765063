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
  std::vector<LookItem> items;            ///< in order
  std::vector<LookItem> back;             ///< blocks `interior_texture`, as textures; empty: both sides alike
  std::shared_ptr<const Block> interior;  ///< or null
  std::string_view shape;                 ///< the keyword of what is dressed

  Affine interior_to_world;  ///< from the space of the interior
  bool hollow = false;       ///< so that media show
  bool solid = true;         ///< else nothing fills it
  bool lit_behind = false;   ///< lamps light both sides

  bool has_texture() const { return !items.empty(); }
  /// A map from a space before that of the object to it.
  void put_before(const Affine& map) {
    for (LookItem& item : items) item.to_texture = item.to_texture * map;
    for (LookItem& item : back) item.to_texture = item.to_texture * map;
  }
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
  Node name_node(const Place& where, const std::string& name) { return context_.tree.text(where, name); }

  Context& context_;
  MediaWriter media_;
  std::map<std::string, std::string> names_;  ///< by what the material says
  std::map<std::tuple<std::vector<const Block*>, const Block*, const Block*, std::string_view, bool>,
           std::string>
      known_;
  std::set<std::string> taken_;
};

/// The pigments of a block `sky_sphere` by the direction, over `background`, as a value of scene files: a
/// colour or a texture. Null if it has none.
Node sky_node(Context& context, const Block& block, const Vec3d& background);

}  // namespace oktett::pov
