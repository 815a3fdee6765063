#pragma once
/// \file The shapes of scene files and their parameters, as docs/scene-format.md lists them.

#include <string>
#include <vector>

#include "core/description.h"

namespace oktett {

struct DescribedParameter {
  Parameter parameter;
  enum class Type : std::uint8_t { number, whole_number, other } type;
  std::string text;   ///< what is allowed, in Markdown
  std::string usual;  ///< the default as it is written in a file; "required" or "none"

  bool operator==(const DescribedParameter& other) const;
};

struct DescribedSurface {
  ShapeInfo surface;
  std::vector<DescribedParameter> parameters;
};

/// The patterns as a Markdown table.
std::string pattern_table();

/// Each shape that describes its parameters.
std::vector<DescribedSurface> described_surfaces();

/// Each kind of pattern of textures, likewise.
std::vector<DescribedSurface> described_patterns();

/// The shapes as a Markdown table. Shapes with the same parameters share their rows.
std::string surface_table();

}  // namespace oktett
