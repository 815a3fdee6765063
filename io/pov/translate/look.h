#pragma once
/// \file What objects look like: textures and interiors as materials. Within io/ only.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// What an object is dressed with, its own or that of a union around it.
struct Dress {
  std::vector<std::shared_ptr<const Block>>
      textures;  ///< blocks `texture` or `pigment`, the lowest layer first
  std::vector<std::shared_ptr<const Block>> finishes;  ///< blocks `finish` and `normal` that stand alone
  std::shared_ptr<const Block> interior;               ///< or null
  Affine to_texture;  ///< from the space of the object before its transforms to that of the textures

  bool has_texture() const { return !textures.empty() || !finishes.empty(); }
};

/// Makes materials, each once.
class Wardrobe {
 public:
  explicit Wardrobe(Context& context) : context_(context) {}

  /// The name of the material of an object at `where`, as a node.
  Node material(const Dress& dress, const std::shared_ptr<const Block>& default_texture, const Place& where);
  /// One that is not seen, for faces that are cut open.
  Node invisible(const Place& where);

 private:
  Node name_node(const Place& where, const std::string& name) { return context_.tree.text(where, name); }

  Context& context_;
  std::map<std::string, std::string> names_;  ///< by what the material says
  std::map<std::tuple<std::vector<const Block*>, const Block*, const Block*>, std::string> known_;
  std::set<std::string> taken_;
};

Node color_node(Tree& tree, const Place& where, const Vec3d& rgb);

/// A colour that stands for a whole pigment: the mean of its map.
PovColor mean_color(Context& context, const Block& pigment);

}  // namespace oktett::pov
