#pragma once
/// \file The JSON Schema of scene files.

#include <string>

namespace oktett {

/// A JSON Schema (draft 2020-12) of scene files for editors. It is found by asking the readers of scene
/// files: they read trees of made-up values, one key at a time, and what they take each value for is noted.
/// So it knows every key, type, range and word that they know. It allows more than they do where a rule joins
/// several keys, and in expressions.
std::string scene_schema();

}  // namespace oktett
