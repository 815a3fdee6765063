#pragma once
/// \file What a scene in POV-Ray's language says once all its directives have been followed: statements with
/// values in place of expressions, each with its place. Within io/ only; knows nothing of what the statements
/// mean.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/error.h"

namespace oktett::pov {

/// Where something stands. `call` tells which call of a macro it came from: an index into Document::calls.
struct Place {
  std::uint32_t file = 0;  ///< index into Document::files
  std::uint32_t line = 0, column = 0;
  std::uint32_t call = kNoCall;
  static constexpr std::uint32_t kNoCall = ~0u;
};

/// A call of a macro.
struct MacroCall {
  std::string name;
  Place where;  ///< of the call
};

/// A number (size 1), a vector of 2 to 5 numbers, or a colour: red, green, blue, filter, transmit (size 5).
/// Numbers turn into vectors of equal components where one is expected.
struct Numbers {
  std::array<double, 5> v{};
  std::uint8_t size = 1;
  bool is_color = false;
};

/// A keyword of the language that stands alone, such as `translate` before its vector, or a name of a colour
/// channel.
struct Word {
  std::string_view text;  ///< from the table of keywords, which lives as long as the program
};

struct Block;
struct Function;
struct Spline;
struct Element;

using Value = std::variant<Numbers, std::string, Word, std::shared_ptr<const Block>,
                           std::shared_ptr<const Function>, std::shared_ptr<const Spline>>;

/// One thing in a statement, in the order of the file. Commas are left out.
struct Element {
  Place where;
  Value value;
};

/// `keyword { ... }`; of an entry of a map the keyword is "[", of a vector of more than five numbers, such as
/// that of `matrix` or `quartic`, it is "<". Textures that were declared in a row are one `texture` that
/// holds them as layers. A declared name, such as that of a texture, stands for the block that it was
/// declared as: one shared block wherever it is used, with `name`.
struct Block {
  std::string_view keyword;
  Place where;
  std::vector<Element> elements;
  std::string name;         ///< by which it was declared; empty: it has none
  std::uint32_t depth = 1;  ///< how many blocks nest, this one included
  std::shared_ptr<const Block>
      default_texture;  ///< of #default where an object stands; null: the program's own
};

/// A step of a function: an operation on the results of `operands`.
struct FunctionNode {
  enum class Op : std::uint8_t {
    constant,   ///< `number`
    parameter,  ///< number `index`
    call,      ///< `name`: an operator ("+", "-", "*", "/", "neg", "!", "<", "<=", "=", "!=", ">=", ">", "&",
               ///< "|"), a built-in function ("sin", "select", ...), or "sum" or "prod" of `function`, whose
               ///< parameters are a counter and those of this function: operands first, last, and these
    internal,  ///< `function { internal(N) }` with number `index`, as functions.inc declares f_... functions
    user,      ///< another function, `function`
    spline,    ///< `spline`, of one operand; of its vector the component `index`
    pattern,   ///< `function { pattern { ... } }` or a pigment's: `block`, of three operands; component
               ///< `index` of a colour, 0 of a pattern
    transform,  ///< `function { transform { ... } }`: `block`, of three operands; component `index`
  };
  Op op = Op::constant;
  std::uint32_t index = 0;
  double number = 0;
  std::string_view name;
  std::shared_ptr<const Function> function;
  std::shared_ptr<const Spline> spline;
  std::shared_ptr<const Block> block;
  std::vector<std::uint32_t> operands;  ///< indices into Function::nodes, all less than the node's own
};

/// `function(x, y, z) { ... }`. Nodes come after their operands; the last one is the result.
struct Function {
  Place where;
  std::string name;  ///< by which it was declared; empty: it has none
  std::vector<std::string> parameters;
  std::vector<FunctionNode> nodes;
  /// 1; of `function { transform ... }`, `{ spline ... }` and `{ pigment ... }` how many numbers a call
  /// returns.
  std::uint8_t components = 1;
};

struct Spline {
  enum class Kind : std::uint8_t { linear, quadratic, cubic, natural };
  struct Point {
    double at;
    std::array<double, 5> value;
  };
  Kind kind = Kind::linear;
  int size = 3;               ///< components of each value
  std::vector<Point> points;  ///< by ascending `at`
};

/// A whole scene.
struct Document {
  std::vector<std::string> files;  ///< paths; the first is the scene
  std::vector<MacroCall> calls;
  double version = 3.62;  ///< of the last `#version` so far, such as 3.7; 3.62 if none is stated
  /// In the order of the file: objects, `camera`, `light_source`, `global_settings`, `background`, `fog`, ...
  std::vector<Element> statements;
  std::vector<Warning> warnings;  ///< and what #warning said

  /// The file, line and column of a place.
  Location location(const Place& where) const;
  /// An error at a place; names the macros that it came from, the innermost first.
  Error error(const Place& where, const std::string& message) const;
};

}  // namespace oktett::pov
