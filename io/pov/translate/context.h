#pragma once
/// \file What all parts of the translation share: the document, the tree that is made of it, and what cannot
/// be said in a scene file. Within io/ only.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/noise_generator.h"
#include "core/transform.h"
#include "io/pov/document.h"
#include "io/pov/translate/tree.h"

namespace oktett::pov {

class ObjectQueries;

/// How the numbers of a scene's colours are meant, in which its light is computed.
struct SceneGamma {
  double power = 1;     ///< light is shown raised to it
  bool is_raw = false;  ///< instead the file holds the numbers, as in scenes of before 3.7 that state none

  /// Whether the numbers are about those that screens take.
  bool is_encoded() const { return is_raw || power > 1.6; }
};

/// A scene file without a file.
struct Context {
  explicit Context(const Document& d) : document(d), tree(d) {}

  const Document& document;
  Tree tree;
  std::vector<Warning> warnings;
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes;

  /// The sections of the tree.
  Node materials = nullptr, define = nullptr, objects = nullptr, lights = nullptr, media = nullptr;
  std::string mesh_prefix;
  ObjectQueries* queries = nullptr;  ///< null: nobody can be asked for values of functions
  SceneGamma gamma;                  ///< in which light is computed
  NoiseGenerator noise_generator = NoiseGenerator::povray_2;  ///< of patterns that choose none
  std::uint32_t samples = 0;     ///< per pixel, that the camera asks for; 0: it asks for none
  bool has_fog = false;          ///< or media: it matters which solids are hollow
  std::vector<Node> light_keys;  ///< what describes each of the lights
  double film_scale = 1;         ///< of the thickness of films
  int light_groups = 0;
  std::vector<std::string> lit_alone;  ///< names of light groups that no other lights light
  /// Corners of the boxes around objects that are declared, each once: objects of objects can double at each
  /// declaration.
  std::map<const Block*, std::array<Vec3d, 2>> extents;
  std::map<std::string, double> bump_strengths;  ///< of images by their files, each read once

  /// Whether an image lets light pass somewhere; false if it cannot be read.
  bool has_alpha(const std::string& file);

  /// Warns of what is not as POV-Ray has it, once for each `kind`.
  void tell(const std::string& kind, const Place& where, const std::string& message) {
    if (told_.insert(kind).second) warn(where, message);
  }
  void warn(const Place& where, const std::string& message) {
    warnings.push_back({document.location(where), message});
  }
  /// Throws Error.
  [[noreturn]] void fail(const Place& where, const std::string& message) const {
    throw document.error(where, message);
  }
  /// A name like `wanted` that no other call has got for the same table.
  std::string unique(std::set<std::string>& taken, std::string_view wanted) const;

 private:
  std::set<std::string> told_;
  std::map<std::string, bool> alphas_;  ///< of images by their files
};

/// A colour with what passes through, as pigments have it.
struct PovColor {
  Vec3d rgb{0, 0, 0};
  double filter = 0, transmit = 0;
  bool operator==(const PovColor&) const = default;
};

/// The elements of a block, one after the other.
class Arguments {
 public:
  Arguments(Context& context, const Block& block) : context_(context), block_(block) {}

  bool at_end() const { return next_ >= block_.elements.size(); }
  const Element& peek() const { return block_.elements[next_]; }
  const Element& take() { return block_.elements[next_++]; }
  /// Where the next element stands; of the block behind the last one.
  const Place& where() const { return at_end() ? block_.where : peek().where; }
  const Block& block() const { return block_; }

  bool is_numbers() const { return !at_end() && std::holds_alternative<Numbers>(peek().value); }
  bool is_vector() const { return is_numbers() && std::get<Numbers>(peek().value).size > 1; }
  /// The next element if it is a block; null otherwise. Does not take it.
  const Block* peek_block() const;
  std::shared_ptr<const Block> peek_shared_block() const;
  /// The next element if it is a word; else empty. Does not take it.
  std::string_view peek_word() const;
  /// Takes the next word if it is this one.
  bool take_word(std::string_view word);

  // Each throws Error if the next element is something else; `what` says what it is for.
  double number(std::string_view what);
  Vec3d vector(std::string_view what);
  /// Two numbers.
  std::array<double, 2> pair(std::string_view what);
  PovColor color(std::string_view what);
  std::string text(std::string_view what);
  /// The components of all numbers that follow.
  std::vector<double> all_numbers();
  /// Whether a flag such as `hollow` is on: it may be followed by a number.
  bool flag();

 private:
  const Numbers& numbers(std::string_view what);

  Context& context_;
  const Block& block_;
  std::size_t next_ = 0;
};

/// One operation of a transform.
struct Move {
  enum class Kind { translate, rotate, scale, matrix } kind;
  Vec3d v;
  Affine matrix;
  Place where;
};

/// Transforms in the order in which they are applied.
struct Moves {
  std::vector<Move> list;
  Affine all;  ///< all of them together

  void add(const Move& move);
  void add(const Moves& more) {
    for (const Move& move : more.list) add(move);
  }
  bool empty() const { return list.empty(); }
};

/// Takes a transform that stands next: a word such as `translate` with its vector, or a block. Returns
/// whether there was one.
bool take_moves(Context& context, Arguments& arguments, Moves& moves);
/// All transforms that stand in a block itself.
Moves moves_in(Context& context, const Block& block);
/// The value of `transform`; null if there are no moves.
Node moves_node(Tree& tree, const Place& where, const Moves& moves);

/// The text of a file of the scene that `name` stands for: beside the file that names it, beside the scene,
/// or in the library. Throws Error if there is none.
std::string find_file(const Context& context, const Place& where, const std::string& name);

}  // namespace oktett::pov
