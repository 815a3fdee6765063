#pragma once
/// \file Options of `oktett render` for a folder that keeps meshes and trees.

#include <memory>
#include <string>

#include "app/command_line.h"
#include "io/cache/scene_cache.h"

namespace oktett {

/// The words of the command line, not checked yet. Empty: not given.
struct CacheArguments {
  std::string folder, size;
};

void add_cache_options(Verb& verb, CacheArguments& arguments);

/// Null if no cache is asked for. If the folder cannot be used, says so and returns null. Throws Error for a
/// size that cannot be read.
std::unique_ptr<SceneCache> open_cache(const CacheArguments& arguments);

}  // namespace oktett
