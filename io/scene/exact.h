#pragma once
/// \file Exact surfaces in scene files. Within io/ only.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene/load.h"
#include "kernels/exact_form.h"

namespace oktett {

/// A shape key and what reads it: a form, or nothing after a warning. Every reader but most of
/// fractals takes the key `normals` too, which read_exact reads.
struct ExactReader {
  const char* key;
  std::optional<ExactForm> (*read)(SceneLoad&, const YamlNode& key, const YamlNode& node);
};

// One list of readers per family.
/// Cylinders, cones, polyhedra and quadrics.
std::span<const ExactReader> closed_form_readers();
/// Polynomials, blobs of inverse squares and surfaces of revolution.
std::span<const ExactReader> polynomial_readers();
/// Superquadrics and ratioquadrics.
std::span<const ExactReader> superquadric_readers();
/// Metaballs and blob trees.
std::span<const ExactReader> metaball_readers();
/// Functions of the user's own.
std::span<const ExactReader> function_readers();
/// Fractals.
std::span<const ExactReader> fractal_readers();
/// Height fields.
std::span<const ExactReader> height_readers();

/// Warns that the object is left out because of `reason`.
std::nullopt_t skip_exact(SceneLoad& load, const YamlNode& place, const std::string& reason);

/// Throws what is wrong with a text such as an equation, found in `error`, whose column counts bytes in
/// `text`, at its place in the file, and shows it. `text` is what `node` stands for.
[[noreturn]] void fail_in_text(const char* what, const YamlNode& node, const std::string& text,
                               const Error& error);

/// A box with an inside.
void read_bounds(SceneLoad& load, const YamlNode& node, Vec3d& lo, Vec3d& hi);

/// Keys of the exact surfaces.
std::vector<std::string> exact_keys();

/// The exact surface called `key`; nothing if it is degenerate, after a warning, or if there is no such key
/// (`known` says which). Throws Error at the place of what is wrong.
std::optional<ExactShape> read_exact(SceneLoad& load, const YamlNode& key, const YamlNode& node, bool& known);

}  // namespace oktett
