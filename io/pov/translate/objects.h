#pragma once
/// \file Objects with their modifiers, combinations, and what is declared once and shown often. Within io/
/// only.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/pov/translate/context.h"
#include "io/pov/translate/extent.h"
#include "io/pov/translate/look.h"

namespace oktett::pov {

/// Adds objects to the tree.
class ObjectWriter {
 public:
  explicit ObjectWriter(Context& context);
  /// `shown`: all that will be added, which tells what is shown more than once.
  ObjectWriter(Context& context, std::span<const Element> shown);

  /// Adds an object of the scene, `moves` after its own transforms. `casts_shadow` of false hides it from
  /// rays to lights.
  void add(const std::shared_ptr<const Block>& block, const Moves& moves = {}, bool casts_shadow = true);
  void add_light(const std::shared_ptr<const Block>& block, const Affine& to_world);
  /// The name of what fills the space outside of solids, by blocks `media`; empty if nothing does.
  std::string surrounding(const Interior& interior) { return wardrobe_.surrounding(interior); }

  /// What became of an object that is asked and not seen.
  struct Asked {
    bool is_there = false;  ///< something of it is left
    bool solid = false;     ///< it has an inside
    bool negative = false;  ///< it stands for all but what was added
  };
  /// Adds an object for questions, without its looks. `as_solid`: what has no inside is left out.
  Asked add_asked(const std::shared_ptr<const Block>& block, bool as_solid);

 private:
  /// What an object stands in.
  struct Outer {
    Dress dress;
    std::shared_ptr<const Block> default_texture;
    Extent within;
    Affine to_world;
    bool operand = false;    ///< a part of a combination
    bool prototype = false;  ///< or of what stands in several places
  };
  /// An object of scene files. One that is `negative` stands for all but it.
  struct Built {
    Node node = nullptr;
    bool solid = true, negative = false;
    bool surfaces = false;  ///< an operand without an inside, which has no opposite
  };
  /// What stands behind the arguments of an object.
  struct Modifiers;
  using Maybe = std::optional<Built>;

  Maybe build(const std::shared_ptr<const Block>& block, const Outer& outer);
  Maybe build_object(const Block& block, const Outer& outer);
  Maybe build_shape(const Block& block, const Outer& outer, Arguments& arguments);
  Maybe build_children(const Block& block, const std::vector<std::shared_ptr<const Block>>& children,
                       const Modifiers& m, const Outer& outer);
  /// In POV-Ray faces of a difference that coincide leave a skin, as what is subtracted ends where they lie.
  /// Moves such faces apart as far as skins are seen.
  void leave_skins(const std::vector<std::shared_ptr<const Block>>& children, std::vector<Built>& parts);
  /// A union whose lights light nothing else.
  Maybe build_light_group(const Block& block, const std::vector<std::shared_ptr<const Block>>& children,
                          const Modifiers& m, const Outer& outer);
  Maybe build_instance(const std::shared_ptr<const Block>& block, const Outer& outer);
  std::vector<Built> build_all(const std::vector<std::shared_ptr<const Block>>& children, const Outer& outer);
  void read_material(const Block& block, const std::shared_ptr<const Block>& default_texture,
                     Modifiers& modifiers);
  void add_moves(Node object, const Moves& moves, const Place& where);
  void extend_transform(Node object, const Moves& moves);
  /// The object, moved, as seen only through what `bounded_by` names.
  Built seen_through_bounds(const Block& block, const Modifiers& m, const Outer& outer, Built built);
  void set_hollow(Node object, const Place& where);
  Modifiers read_modifiers(const Block& block, Arguments& arguments);
  Dress dress_of(const Modifiers& m, const Outer& outer) const;
  Built finish(const Block& block, const Modifiers& m, const Outer& outer, Built built, bool moved);

  Built combine(const Place& where, std::string_view op, std::vector<Built> parts);
  Built surfaces_of(const Place& where, const Built& built);
  Node list_node(const Place& where, std::string_view key, const std::vector<Node>& items);

  void count_uses(const std::shared_ptr<const Block>& block);
  /// How much a declared object is worth standing once: the number of shapes in it, many for meshes.
  int weight(const Block& block);
  /// Whether all of an object has a texture of its own.
  bool is_dressed(const Block& block);
  /// Whether a block of this keyword is in an object; `known`: of what is declared.
  static bool holds(std::map<const Block*, bool>& known, const Block& block, std::string_view keyword);

  Context& context_;
  bool hidden_ = false;  ///< what is built is not seen: it only cuts
  bool asked_ = false;   ///< nothing is seen, so that looks do not matter
  Wardrobe wardrobe_;
  std::map<const Block*, int> uses_;
  std::map<const Block*, int> weights_;
  std::map<const Block*, bool> dressed_, lit_, media_in_;  ///< of what is declared
  struct Prototype {
    std::string name;  ///< empty: nothing is left of it
    bool solid = true;
  };
  std::map<const Block*, Prototype> prototypes_;
  std::set<std::string> prototype_names_, object_names_;
};

}  // namespace oktett::pov
