/// \file Functions of the user's own in scene files.

#include "io/scene/exact.h"
#include "kernels/functions/function_tape.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

FunctionTape read_function(SceneLoad& load, const YamlNode& node) {
  const std::string text = load.values.text(node);
  try {
    return compile_function(text);
  } catch (const Error& e) {
    fail_in_text("function", node, text, e);
  }
}

MaybeForm read_implicit(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "implicit", {"function", "bounds", "open", "normals"});
  ImplicitShape shape;
  shape.function = read_function(load, fields.require("function"));
  read_bounds(load, fields.require("bounds"), shape.lo, shape.hi);
  load.values.read(fields["open"], shape.open);
  if (!shape.function.varies) return skip_exact(load, key, "the function does not depend on x, y or z");
  return shape;
}

constexpr ExactReader kReaders[] = {{"implicit", read_implicit}};

}  // namespace

std::span<const ExactReader> function_readers() { return kReaders; }

}  // namespace oktett
